#include "breakaway/slcan/codec.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace {

using breakaway::hal::CanFrame;
using namespace breakaway::slcan;
using Kind = Message::Kind;

std::string encoded(const CanFrame& frame) {
  const EncodedFrame line{frame};
  return {line.text().begin(), line.text().end()};
}

std::vector<Message> decoded(const std::string& text) {
  Decoder decoder;
  std::vector<Message> messages;
  for (const char c : text) {
    if (const auto message = decoder.take(c)) messages.push_back(*message);
  }
  return messages;
}

Message only(const std::string& text) {
  const auto messages = decoded(text);
  EXPECT_EQ(messages.size(), 1U) << text;
  return messages.empty() ? Message{} : messages[0];
}

TEST(SlcanCodec, EncodesAsTheCommandSetPrescribes) {
  EXPECT_EQ(encoded({.id = 0x080, .size = 0}), "t0800\r");
  EXPECT_EQ(encoded({.id = 0x201, .size = 4, .data = {0x0F, 0x00, 0xFE, 0xA5}}), "t20140F00FEA5\r");
  EXPECT_EQ(encoded({.id = 0x7FF, .size = 8, .remote = true}), "r7FF8\r");
}

TEST(SlcanCodec, BringsBackEveryFrame) {
  std::mt19937 random{3};
  for (int i = 0; i < 20000; ++i) {
    CanFrame frame{.id = static_cast<std::uint16_t>(random() % 0x800),
                   .size = static_cast<std::uint8_t>(random() % 9),
                   .remote = random() % 8 == 0};
    if (!frame.remote)
      for (std::size_t k = 0; k < frame.size; ++k) frame.data[k] = static_cast<std::uint8_t>(random());
    const Message message = only(encoded(frame));
    EXPECT_EQ(message.kind, Kind::frame);
    EXPECT_EQ(message.frame, frame);
  }
}

TEST(SlcanCodec, TakesTimeStampsAndSmallLetters) {
  EXPECT_EQ(only("t1812ab0c1F40\r").frame, (CanFrame{.id = 0x181, .size = 2, .data = {0xAB, 0x0C}}));
  EXPECT_EQ(only("r1230FFFF\r").frame, (CanFrame{.id = 0x123, .size = 0, .remote = true}));
}

TEST(SlcanCodec, TellsAnswersApart) {
  EXPECT_EQ(only("\r").kind, Kind::done);
  EXPECT_EQ(only("\a").kind, Kind::refused);
  EXPECT_EQ(only("z\r").kind, Kind::taken);
  EXPECT_EQ(only("F24\r").kind, Kind::status);
  EXPECT_EQ(only("F24\r").status, 0x24);
  for (const char* text : {"V1013\r", "NA123\r", "T1234567800\r", "R123456780\r"})
    EXPECT_EQ(only(text).kind, Kind::unknown) << text;
}

TEST(SlcanCodec, RefusesWhatIsNoLine) {
  EXPECT_EQ(only("t181g\r").kind, Kind::malformed);
  for (const char* text : {"t\r", "t18\r", "t8000\r", "t1819\r", "t1812AB\r", "t1811G0\r", "t1810123\r", "t1810zzzz\r",
                           "t181011111\r", "t18g0\r", "F\r", "F1\r", "Fxx\r", "F000\r", "zz\r", "x\r", "t-110\r",
                           "t181400112233445\r", "t1818001122334455667712345678901234567890\r"})
    EXPECT_EQ(only(text).kind, Kind::malformed) << text;
}

TEST(SlcanCodec, IsInStepAgainAfterAnOverlongLine) {
  std::string text(1000, 't');
  text += "\rt0800\r";
  const auto messages = decoded(text);
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0].kind, Kind::malformed);
  EXPECT_EQ(messages[1].frame.id, 0x080);
}

TEST(SlcanCodec, DropsTheLineThatABellEnds) {
  const auto messages = decoded("t18\at0800\r");
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0].kind, Kind::refused);
  EXPECT_EQ(messages[1].kind, Kind::frame);
}

TEST(SlcanCodec, KnowsTheBitRatesOfTheCommandSet) {
  EXPECT_EQ(bit_rate_digit(10'000), '0');
  EXPECT_EQ(bit_rate_digit(125'000), '4');
  EXPECT_EQ(bit_rate_digit(1'000'000), '8');
  EXPECT_EQ(bit_rate_digit(333'333), std::nullopt);
}

}  // namespace
