#include "breakaway/canopen/pdo.hpp"

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace breakaway::canopen;

constexpr PdoMapping feedback_mapping{.parameter_index = 0x1800,
                                      .mapping_index = 0x1A00,
                                      .cob_id = 0x185 | no_remote_request,
                                      .transmission_type = 1,
                                      .count = 3,
                                      .objects = {{{0x6041, 0, 16}, {0x6064, 0, 32}, {0x6077, 0, 16}}}};

TEST(Pdo, EntryIsIndexSubIndexAndLength) {
  EXPECT_EQ((MappedObject{0x6064, 0, 32}.entry()), 0x60640020U);
  EXPECT_EQ((MappedObject{0x60C2, 1, 8}.entry()), 0x60C20108U);
  EXPECT_EQ(MappedObject::from_entry(0x60C20108U), (MappedObject{0x60C2, 1, 8}));
}

TEST(Pdo, RemapInvalidatesEmptiesMapsFillsAndValidates) {
  struct Row {
    unsigned index, subindex, size;
    std::uint32_t value;
  };
  const Row rows[] = {{0x1800, 1, 4, 0xC0000185}, {0x1A00, 0, 1, 0},          {0x1A00, 1, 4, 0x60410010},
                      {0x1A00, 2, 4, 0x60640020}, {0x1A00, 3, 4, 0x60770010}, {0x1A00, 0, 1, 3},
                      {0x1800, 2, 1, 1},          {0x1800, 1, 4, 0x40000185}};
  ASSERT_EQ(remap_step_count(feedback_mapping), std::size(rows));
  for (std::size_t i = 0; i < std::size(rows); ++i) {
    const ObjectWrite step = remap_step(feedback_mapping, i);
    EXPECT_EQ(step.index, rows[i].index) << "step " << i;
    EXPECT_EQ(step.subindex, rows[i].subindex) << "step " << i;
    EXPECT_EQ(step.size, rows[i].size) << "step " << i;
    EXPECT_EQ(step.value, rows[i].value) << "step " << i;
  }
}

TEST(Pdo, PacksInTheOrderOfTheMapping) {
  const std::array<std::uint64_t, 3> values{0x1237, static_cast<std::uint32_t>(-2), 0xABCD};
  const auto frame = pack_pdo(feedback_mapping, values);
  EXPECT_EQ(frame, (breakaway::hal::CanFrame{
                       .id = 0x185, .size = 8, .data = {0x37, 0x12, 0xFE, 0xFF, 0xFF, 0xFF, 0xCD, 0xAB}}));
}

TEST(Pdo, RandomMappingsSurviveTheRoundTrip) {
  std::mt19937_64 random{11};
  for (int run = 0; run < 20'000; ++run) {
    PdoMapping pdo{.cob_id = 0x200 + static_cast<std::uint32_t>(random() % 127)};
    std::array<std::uint64_t, PdoMapping::max_objects> values{};
    unsigned left = 64;
    while (pdo.count < PdoMapping::max_objects && left > 0) {
      const auto bits = static_cast<std::uint8_t>(1 + random() % left);
      values[pdo.count] = bits < 64 ? random() & ((std::uint64_t{1} << bits) - 1) : random();
      pdo.objects[pdo.count++] = {0x2000, 1, bits};
      left -= bits;
    }
    std::array<std::uint64_t, PdoMapping::max_objects> result{};
    ASSERT_TRUE(unpack_pdo(pdo, pack_pdo(pdo, values), result));
    ASSERT_EQ(result, values);
  }
}

TEST(Pdo, WrongIdentifierRemoteOrShortFrameIsNotUnpacked) {
  std::array<std::uint64_t, 3> values{7, 7, 7};
  auto frame = pack_pdo(feedback_mapping, values);
  auto other = frame;
  other.id = 0x186;
  EXPECT_FALSE(unpack_pdo(feedback_mapping, other, values));
  other = frame;
  other.remote = true;
  EXPECT_FALSE(unpack_pdo(feedback_mapping, other, values));
  other = frame;
  other.size = 7;
  EXPECT_FALSE(unpack_pdo(feedback_mapping, other, values));
  EXPECT_EQ(values, (std::array<std::uint64_t, 3>{7, 7, 7}));
  EXPECT_TRUE(unpack_pdo(feedback_mapping, frame, values));
}

}  // namespace
