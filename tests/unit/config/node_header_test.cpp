// The header that `breakaway design --header` writes, compiled as an image compiles it.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "flashed_node.hpp"
#include "two_axes.hpp"

namespace breakaway {
namespace {

using config::testing::two_axes;
using config::testing::with;

const std::string source = BREAKAWAY_SOURCE_DIR "/sim/scenarios/three_axes.toml";

static_assert(flashed::node.count == 3 && firmware::verify(flashed::node).ok());

// The compiler refuses what was edited: with one number changed, what the header asserts is false.
constexpr bool asserts_hold_after(auto edit) {
  auto node = flashed::node;
  edit(node);
  return checksum_of(node) == node.checksum;
}
static_assert(asserts_hold_after([](auto&) {}));
static_assert(!asserts_hold_after([](auto& node) { node.axes[2].law.stiffness_N_per_m += 1; }));
static_assert(!asserts_hold_after([](auto& node) { node.axes[0].drive.invert_direction = true; }));
static_assert(!asserts_hold_after([](auto& node) { node.axes[1].name.characters[0] = 'S'; }));
static_assert(!asserts_hold_after([](auto& node) { node.loop.network.bit_rate = 500'000; }));
static_assert(!asserts_hold_after([](auto& node) { node.checksum ^= 1U; }));

// All bits of all numbers of a node, in order.
struct BitsOf {
  std::string bits;
  explicit BitsOf(const auto& node) { firmware::visit_numbers(node, *this); }
  template <class T>
  void value(const char* name, const T& number, const char*) {
    bits.append(name).append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void group(const char*, const auto& body) { body(); }
  void list(const char*, const auto& items, const auto& body) {
    for (const auto& item : items) body(item);
  }
  void row(const char* name, const auto& items) {
    for (const auto& item : items) value(name, item, "");
  }
};

TEST(NodeHeader, CompilesToTheVeryNodeThatWasCertified) {
  const config::Node node = config::read_node(source);
  const auto certified = config::certified(node, config::examine(node));
  EXPECT_EQ(BitsOf{flashed::node}.bits, BitsOf{certified}.bits);
  EXPECT_EQ(flashed::node.checksum, certified.checksum);
}

std::string header_of(const std::string& text, const std::string& file) {
  const config::Node node = config::parse_node(text, file);
  const auto reports = config::examine(node);
  return config::node_header(config::certified(node, reports), node, reports);
}

// Of an axis under the coast "brake", for which 3 um at rest will do.
std::string braked_header(double tolerance_m) {
  config::Node node = config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/braked_axis.toml");
  node.axes[0].controller.position_tolerance_m = tolerance_m;
  node.settle_tolerance_m = 3e-6;
  const auto reports = config::examine(node);
  return config::node_header(config::certified(node, reports), node, reports);
}

TEST(NodeHeader, IsRefusedForAnAxisThatIsNotCertifiedAndNamesIt) {
  const std::string coarse = with(two_axes, "1.8e-6\n[axis.limits]\nspeed_m_s = 20\n[axis.drive]\nnode_id = 2",
                                  "1e-9\n[axis.limits]\nspeed_m_s = 20\n[axis.drive]\nnode_id = 2");
  const std::string message = testing::refusal([&] { header_of(coarse, "node.toml"); });
  for (const char* part : {"node.toml: ", "axis y: ", "not certified", "tolerance", "breakaway design node.toml"})
    EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
}

TEST(NodeHeader, NamesItsSourceInOneLineWhateverTheName) {
  const std::string text = header_of(two_axes, "a\nint x;\\");
  EXPECT_NE(text.find("from a?int x;?; do not edit"), std::string::npos);
}

TEST(NodeHeader, StatesForEveryAxisOnWhichConditionsItIsCertified) {
  const std::string text = header_of(two_axes, "node.toml");
  const auto first = text.find("// Axis x is certified"), second = text.find("// Axis y is certified");
  ASSERT_NE(first, std::string::npos);
  ASSERT_NE(second, std::string::npos);
  EXPECT_GT(second, first);
}

TEST(NodeHeader, SaysOfTheReadingWhatTheToleranceHoldsAndOfTheTrueErrorWhatIsMore) {
  const std::string by_pd = header_of(two_axes, "node.toml");
  EXPECT_NE(by_pd.find("at rest its reading is within position_tolerance_m of its target, the true error at most "
                       "2.3e-06 m, provided that"),
            std::string::npos)
      << by_pd.substr(0, 500);
  const std::string braked = braked_header(2e-6);
  EXPECT_NE(
      braked.find(
          "is certified: at rest it is within position_tolerance_m, and what a reading may be off, of its target, "
          "provided that"),
      std::string::npos)
      << braked.substr(0, 500);
  EXPECT_NE(braked.find("the true error is at most 2.5e-06 m"), std::string::npos);
}

TEST(NodeHeader, PromisesNoToleranceThatIsOnlyAimedAt) {
  const std::string text = braked_header(0.6e-6);
  EXPECT_NE(text.find("at rest it is within fine_floor_m, and what a reading may be off, of its target, and "
                      "position_tolerance_m, which is less, is only aimed at, provided that"),
            std::string::npos)
      << text.substr(0, 500);
}

}  // namespace
}  // namespace breakaway
