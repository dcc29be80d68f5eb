#include "breakaway/canopen/pdo.hpp"

#include <gtest/gtest.h>

#include <random>

#include "breakaway/canopen/object_address.hpp"

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

TEST(Pdo, AnObjectThatIsNotNamedIsNone) {
  const ObjectWrite write{};
  EXPECT_EQ(write.index + write.subindex + write.size, 0);
  EXPECT_EQ(write.value, 0U);
  const ObjectAddress address{};
  EXPECT_EQ(address.index + address.subindex, 0);
}

// A mapping of nine bytes, which fits no frame.
TEST(Pdo, PacksNoMoreThanEightBytesAndNoMoreThanIsMapped) {
  constexpr PdoMapping nine{.parameter_index = 0x1400,
                            .mapping_index = 0x1600,
                            .cob_id = 0x205,
                            .transmission_type = 1,
                            .count = 3,
                            .objects = {{{0x2000, 1, 32}, {0x2000, 2, 32}, {0x2000, 3, 8}}}};
  const std::array<std::uint64_t, 12> values{0x44332211, 0x88776655, 0x99, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  const auto frame = pack_pdo(nine, values);
  EXPECT_EQ(frame.size, 8);
  EXPECT_EQ(frame.data, (std::array<std::uint8_t, 8>{0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}));
  PdoMapping full = nine;
  full.count = PdoMapping::max_objects;
  for (auto& object : full.objects) object = {0x2000, 1, 4};
  std::array<std::uint64_t, 12> unpacked{};
  unpacked.fill(0xEE);
  ASSERT_TRUE(unpack_pdo(full, frame, unpacked));
  for (std::size_t i = 0; i < unpacked.size(); ++i) EXPECT_EQ(unpacked[i] != 0xEE, i < PdoMapping::max_objects) << i;
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

TEST(Pdo, StartsEmptyAndValidWithEverySync) {
  const PdoMapping pdo{};
  EXPECT_EQ(pdo.parameter_index, 0);
  EXPECT_EQ(pdo.mapping_index, 0);
  EXPECT_EQ(pdo.cob_id, 0U);
  EXPECT_EQ(pdo.transmission_type, 1);
  EXPECT_TRUE(pdo.mapped().empty());
  EXPECT_EQ(MappedObject{}, (MappedObject{0, 0, 0}));
  const auto frame = pack_pdo(pdo, {});
  EXPECT_EQ(frame, breakaway::hal::CanFrame{});
}

// Eight objects of a byte, and one more than there is room for.
TEST(Pdo, HoldsEightObjects) {
  PdoMapping pdo{.cob_id = 0x185, .count = PdoMapping::max_objects};
  for (auto& object : pdo.objects) object = {0x2000, 1, 8};
  EXPECT_EQ(pdo.mapped().size(), PdoMapping::max_objects);
  pdo.count = PdoMapping::max_objects + 1;
  EXPECT_EQ(pdo.mapped().size(), PdoMapping::max_objects) << "a count that is damaged reads no further";
}

TEST(Pdo, ObjectsBehindTheLastAreNotPacked) {
  PdoMapping pdo{.cob_id = 0x200, .count = 1};
  pdo.objects[0] = pdo.objects[1] = {0x2000, 1, 8};
  const std::array<std::uint64_t, 2> values{0x11, 0x22};
  EXPECT_EQ(pack_pdo(pdo, values), (breakaway::hal::CanFrame{.id = 0x200, .size = 1, .data = {0x11}}));
}

TEST(Pdo, IsInvalidatedByTheHighestBitOfItsIdentifierAlone) {
  EXPECT_EQ(remap_step({.cob_id = 0x200}, 0).value, 0x8000'0200U);
}

TEST(Pdo, PacksNoMoreThanAFrameHolds) {
  PdoMapping pdo{.cob_id = 0x185, .count = 3};
  pdo.objects[0] = pdo.objects[1] = pdo.objects[2] = {0x2000, 1, 32};
  const std::array<std::uint64_t, 3> values{0x11111111, 0x22222222, 0x33333333};
  const auto frame = pack_pdo(pdo, values);
  EXPECT_EQ(frame.size, 8);
  EXPECT_EQ(frame.data, (std::array<std::uint8_t, 8>{0x11, 0x11, 0x11, 0x11, 0x22, 0x22, 0x22, 0x22}));
  const auto whole = pack_pdo(feedback_mapping, values);
  std::array<std::uint64_t, 3> more{7, 7, 7};
  EXPECT_FALSE(unpack_pdo(pdo, whole, more)) << "no frame is so long";
}

TEST(Pdo, ValuesThatAreMissingCountAsZeroAndThoseTooManyAsNone) {
  const auto frame = pack_pdo(feedback_mapping, std::array<std::uint64_t, 1>{0xFFFFF1237});
  EXPECT_EQ(frame.size, 8);
  EXPECT_EQ(frame.data, (std::array<std::uint8_t, 8>{0x37, 0x12})) << "and no bit of it beyond its own";
  EXPECT_EQ(pack_pdo(feedback_mapping, std::array<std::uint64_t, 4>{0, 0, 0, 0xFF}).data,
            (std::array<std::uint8_t, 8>{}));
  std::array<std::uint64_t, 4> values{1, 1, 1, 1};
  EXPECT_TRUE(unpack_pdo(feedback_mapping, frame, values));
  EXPECT_EQ(values, (std::array<std::uint64_t, 4>{0x1237, 0, 0, 1})) << "the fourth is not mapped";
  std::array<std::uint64_t, 1> first{};
  EXPECT_TRUE(unpack_pdo(feedback_mapping, frame, first));
  EXPECT_EQ(first[0], 0x1237U);
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
