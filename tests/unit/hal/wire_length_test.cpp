#include "breakaway/hal/wire_length.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bitset>
#include <random>
#include <string>

namespace {

using breakaway::hal::CanFrame;
using breakaway::hal::wire_bits;
using breakaway::hal::worst_case_wire_bits;

// The frame's bits as text, from the standard's figure of a base frame; slow, and written apart from the library's way.
std::string unstuffed(const CanFrame& frame) {
  std::string bits{"0"};
  bits += std::bitset<11>(frame.id).to_string();
  bits += frame.remote ? "1" : "0";
  bits += "00";
  bits += std::bitset<4>(frame.size).to_string();
  if (!frame.remote)
    for (unsigned i = 0; i < frame.size; ++i) bits += std::bitset<8>(frame.data[i]).to_string();
  // Polynomial long division by x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1.
  const std::string divisor = "1100010110011001";
  std::string rest = bits + std::string(15, '0');
  for (std::size_t i = 0; i + divisor.size() <= rest.size(); ++i)
    if (rest[i] == '1')
      for (std::size_t j = 0; j < divisor.size(); ++j) rest[i + j] = rest[i + j] == divisor[j] ? '0' : '1';
  return bits + rest.substr(rest.size() - 15);
}

unsigned reference_bits(const CanFrame& frame) {
  std::string sent;
  for (const char bit : unstuffed(frame)) {
    sent += bit;
    if (sent.size() >= 5 && sent.find_first_not_of(bit, sent.size() - 5) == std::string::npos)
      sent += bit == '0' ? '1' : '0';
  }
  // CRC delimiter, ACK slot, ACK delimiter, 7 bits end of frame, 3 bits intermission
  return static_cast<unsigned>(sent.size()) + 1 + 1 + 1 + 7 + 3;
}

CanFrame random_frame(std::mt19937& random) {
  CanFrame frame;
  frame.id = static_cast<std::uint16_t>(random() & 0x7FF);
  frame.size = static_cast<std::uint8_t>(random() % 9);
  frame.remote = random() % 16 == 0;
  // Half of the frames of runs of equal bits, where stuffing happens.
  for (auto& byte : frame.data)
    byte = random() % 2 == 0 ? static_cast<std::uint8_t>(random())
                             : std::array<std::uint8_t, 6>{0x00, 0xFF, 0x0F, 0xF0, 0x1E, 0xC3}[random() % 6];
  return frame;
}

TEST(WireLength, FrameOfZerosHasAStuffBitAfterEveryFive) {
  // Identifier 0 without data: 34 zeros up to and with the checksum (which is 0), so 6 stuff bits and a tail of 13.
  EXPECT_EQ(wire_bits({}), 34U + 6U + 13U);
  // 8 zero bytes: length code 1000 breaks the run: 15 zeros before it (3 stuff bits).
  EXPECT_EQ(reference_bits({.size = 8}), wire_bits({.size = 8}));
}

TEST(WireLength, FrameWithoutRunsHasNoStuffBits) {
  unsigned found = 0;
  for (std::uint16_t id = 0; id <= 0x7FF; ++id) {
    const CanFrame frame{.id = id, .size = 4, .data = {0x55, 0x55, 0x55, 0x55}};
    const std::string bits = unstuffed(frame);
    if (bits.find("00000") != std::string::npos || bits.find("11111") != std::string::npos) continue;
    ++found;
    ASSERT_EQ(wire_bits(frame), 47U + 8U * 4U);
  }
  EXPECT_GT(found, 100U);
}

TEST(WireLength, EqualsTheBitStringOfTheStandard) {
  std::mt19937 random{20240501};
  for (int i = 0; i < 20'000; ++i) {
    const CanFrame frame = random_frame(random);
    ASSERT_EQ(wire_bits(frame), reference_bits(frame)) << "frame " << i << " id " << frame.id;
  }
}

TEST(WireLength, NeverExceedsTheWorstCase) {
  std::mt19937 random{7};
  for (int i = 0; i < 500'000; ++i) {
    const CanFrame frame = random_frame(random);
    ASSERT_LE(wire_bits(frame), worst_case_wire_bits(frame.remote ? 0 : frame.size));
    ASSERT_GE(wire_bits(frame), 47U + (frame.remote ? 0U : 8U * frame.size));
  }
}

// All frames of 0 and 1 bytes. The bound counts a stuff bit for every four bits after the first run of five; the two
// dominant bits behind the identifier and the code of the length keep a real frame from reaching it.
TEST(WireLength, WorstCaseIsTightToThreeBits) {
  unsigned longest_empty = 0;
  unsigned longest_byte = 0;
  for (std::uint16_t id = 0; id <= 0x7FF; ++id) {
    longest_empty = std::max(longest_empty, wire_bits({.id = id}));
    for (unsigned byte = 0; byte < 256; ++byte)
      longest_byte =
          std::max(longest_byte, wire_bits({.id = id, .size = 1, .data = {static_cast<std::uint8_t>(byte)}}));
  }
  EXPECT_EQ(longest_empty, worst_case_wire_bits(0) - 2);
  EXPECT_EQ(longest_byte, worst_case_wire_bits(1) - 3);
}

TEST(WireLength, WorstCaseOfTheClassicEightByteFrameIs135Bits) {
  EXPECT_EQ(worst_case_wire_bits(0), 55U);
  EXPECT_EQ(worst_case_wire_bits(4), 95U);
  EXPECT_EQ(worst_case_wire_bits(8), 135U);
}

TEST(WireLength, ASizeAboveEightCountsAsEight) {
  for (const bool remote : {false, true}) {
    const CanFrame eight{.id = 0x181, .size = 8, .remote = remote, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
    CanFrame longer = eight;
    for (const int size : {9, 12, 15, 255}) {
      longer.size = static_cast<std::uint8_t>(size);
      EXPECT_EQ(wire_bits(longer), wire_bits(eight)) << size;
      EXPECT_EQ(longer.payload().size(), 8U) << size;
    }
  }
}

TEST(WireLength, TimeIsRoundedUpToWholeNanoseconds) {
  using breakaway::hal::wire_time;
  EXPECT_EQ(wire_time(135, 1'000'000).count(), 135'000);
  EXPECT_EQ(wire_time(1, 800'000).count(), 1250);
  EXPECT_EQ(wire_time(1, 300'000).count(), 3334);
}

}  // namespace
