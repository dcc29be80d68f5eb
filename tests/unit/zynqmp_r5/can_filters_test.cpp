#include "can_filters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace {

using breakaway::firmware::FlashedNode;
using breakaway::zynqmp_r5::Filters;
using breakaway::zynqmp_r5::filters_for;

constexpr std::uint16_t identifiers = 0x800, sync = 0x080;

FlashedNode<float, 8> node_of(const std::vector<std::uint8_t>& drives, std::uint8_t own_id = 127) {
  FlashedNode<float, 8> node;
  node.loop.network.node_id = own_id;
  node.count = static_cast<std::uint8_t>(drives.size());
  for (std::size_t i = 0; i < drives.size(); ++i) node.axes[i].drive.node_id = drives[i];
  return node;
}

bool passes(const Filters& filters, std::uint16_t id) {
  return std::any_of(filters.begin(), filters.end(),
                     [id](const auto& filter) { return filter && (id & filter->mask) == (filter->id & filter->mask); });
}

bool is_wanted(const std::vector<std::uint8_t>& drives, std::uint8_t own_id, std::uint16_t id) {
  const auto node = static_cast<std::uint8_t>(id & 0x7F);
  return id == sync || node == own_id || std::find(drives.begin(), drives.end(), node) != drives.end();
}

TEST(CanFilters, LetNothingElseInForUpToTwoDrives) {
  for (const std::vector<std::uint8_t>& drives : {std::vector<std::uint8_t>{1}, {1, 2}, {5, 90}}) {
    const Filters filters = filters_for(node_of(drives));
    for (std::uint16_t id = 0; id < identifiers; ++id) EXPECT_EQ(passes(filters, id), is_wanted(drives, 127, id)) << id;
  }
}

TEST(CanFilters, LetAllThatIsWantedInForAnyNode) {
  std::mt19937_64 random{17};
  std::vector<std::uint8_t> ids(127);
  std::iota(ids.begin(), ids.end(), std::uint8_t{1});
  for (int i = 0; i < 300; ++i) {
    std::shuffle(ids.begin(), ids.end(), random);
    const std::vector<std::uint8_t> drives(ids.begin() + 1, ids.begin() + 2 + i % 8);
    const Filters filters = filters_for(node_of(drives, ids.front()));
    for (std::uint16_t id = 0; id < identifiers; ++id) {
      if (is_wanted(drives, ids.front(), id)) {
        EXPECT_TRUE(passes(filters, id)) << id;
      }
    }
  }
}

TEST(CanFilters, KeepMostOfAForeignBusOutForEightDrivesInARow) {
  const Filters filters = filters_for(node_of({1, 2, 3, 4, 5, 6, 7, 8}));
  int passed = 0;
  for (std::uint16_t id = 0; id < identifiers; ++id) passed += passes(filters, id) ? 1 : 0;
  EXPECT_LE(passed, identifiers / 8);
}

}  // namespace
