// The reader of a law image: what is missing, too much or no truth value shows, and no number of a law is left out.
#include "breakaway/firmware/law_image.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "certified_node.hpp"

namespace breakaway::firmware::law_image {
namespace {

TEST(LawImageReader, HasReadAllWhenEveryByteIsANumberAndNoneIsLeft) {
  constexpr std::array<std::uint8_t, 6> bytes{0x78, 0x56, 0x34, 0x12, 1, 0};
  LawImageReader reader{bytes};
  std::uint32_t word = 0;
  bool yes = false, no = true;
  reader.value("", word);
  reader.value("", yes);
  EXPECT_FALSE(reader.read_all()) << "a byte is left";
  reader.value("", no);
  EXPECT_TRUE(reader.read_all());
  EXPECT_EQ(word, 0x12345678U);
  EXPECT_TRUE(yes);
  EXPECT_FALSE(no);
}

TEST(LawImageReader, ANumberThatIsCutOffIsZeroAndSoIsEveryOneAfterIt) {
  constexpr std::array<std::uint8_t, 3> bytes{7, 8, 9};
  LawImageReader reader{bytes};
  std::uint32_t cut_off = 5;
  std::uint8_t after = 5;
  reader.value("", cut_off);
  reader.value("", after);
  EXPECT_EQ(cut_off, 0U);
  EXPECT_EQ(after, 0);
  EXPECT_FALSE(reader.read_all());
}

TEST(LawImageReader, AByteThatIsNoTruthValueIsRefusedWhateverComesAfterIt) {
  constexpr std::array<std::uint8_t, 2> bytes{2, 1};
  LawImageReader reader{bytes};
  bool flag = true;
  reader.value("", flag);
  reader.value("", flag);
  EXPECT_FALSE(reader.read_all());
}

TEST(LawNumbers, AreThoseOfNameTableLawAndKicks) {
  using Axis = FlashedAxis<float>;
  const auto checksum = [](const Axis& axis) {
    internal::ChecksumVisitor visit;
    visit_law_numbers(axis, visit);
    return visit.crc.value();
  };
  const Axis axis = testing::certified_axis('x', 1);
  EXPECT_EQ(checksum(axis), checksum(testing::certified_axis('x', 2))) << "the drive is the program's";
  EXPECT_NE(checksum(axis), checksum(testing::certified_axis('y', 1)));
  Axis other = axis;
  other.k3_table.nodes[0].value += 1;
  EXPECT_NE(checksum(axis), checksum(other)) << "table";
  other = axis;
  other.law.mass_kg += 1;
  EXPECT_NE(checksum(axis), checksum(other)) << "law";
  other = axis;
  other.kicks.brake_N += 1;
  EXPECT_NE(checksum(axis), checksum(other)) << "kicks";
  other = axis;
  other.certified = false;
  EXPECT_NE(checksum(axis), checksum(other)) << "certificate";
}

}  // namespace
}  // namespace breakaway::firmware::law_image
