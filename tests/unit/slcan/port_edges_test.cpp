// Every flag, every refusal, and the ties of the port's times.
#include <gtest/gtest.h>

#include <string>

#include "breakaway/slcan/port.hpp"

namespace breakaway::slcan::port_edges {
namespace {

using namespace std::chrono_literals;
using hal::BusState;
using hal::CanFrame;
using hal::ReceivedFrame;
using hal::SendResult;
using hal::Time;

struct Line {
  std::string to_port, from_port;

  bool read(char& character) noexcept {
    if (to_port.empty()) return false;
    character = to_port.front();
    to_port.erase(0, 1);
    return true;
  }
  bool write(std::span<const char> text) noexcept {
    from_port.append(text.data(), text.size());
    return true;
  }
};

class SlcanEdgesTest : public testing::Test {
 protected:
  // What the port says in a period in which the adapter said this.
  std::string period(const std::string& said) {
    line.to_port += said;
    line.from_port.clear();
    port.poll(now += 1ms);
    port.flush(now);
    return line.from_port;
  }
  void run_until_asked(const std::string& question) {
    for (int i = 0; i < 100 && line.from_port.find(question) == std::string::npos; ++i) period("");
    ASSERT_NE(line.from_port.find(question), std::string::npos) << question;
  }
  void open() {
    run_until_asked("S6\r");
    ASSERT_EQ(period("\r"), "O\r");
    ASSERT_EQ(period("\r"), "F\r");
    ASSERT_EQ(port.bus_state(), BusState::error_active);
  }

  Line line;
  Port<Line> port{line, 500'000};
  Time now{5s};
};

TEST_F(SlcanEdgesTest, EachFlagHasItsBusState) {
  open();
  for (unsigned bit = 0; bit < 8; ++bit) {
    const unsigned flags = 1U << bit;
    period(std::string{"F"} + "0123456789ABCDEF"[flags >> 4U] + "0123456789ABCDEF"[flags & 15U] + "\r");
    const BusState expected = flags == 0x20                    ? BusState::error_passive
                              : flags == 0x04 || flags == 0x80 ? BusState::error_warning
                                                               : BusState::error_active;
    EXPECT_EQ(port.bus_state(), expected) << bit;
  }
}

TEST_F(SlcanEdgesTest, AnAdapterThatRefusesIsClosedAndOpenedAgainAtOnce) {
  run_until_asked("S6\r");
  EXPECT_TRUE(port.awaits_answer());
  EXPECT_EQ(period("\a"), "\r\r\rC\r") << "the rate";
  EXPECT_FALSE(port.awaits_answer());
  run_until_asked("S6\r");
  EXPECT_EQ(period("\r"), "O\r");
  EXPECT_TRUE(port.awaits_answer());
  EXPECT_EQ(period("\a"), "\r\r\rC\r") << "to open";
  open();
  EXPECT_EQ(port.counters().openings, 1U);
}

TEST_F(SlcanEdgesTest, AwaitsAnAnswerAfterAQuestionOnly) {
  EXPECT_FALSE(port.awaits_answer()) << "closed";
  period("");
  EXPECT_FALSE(port.awaits_answer()) << "what it said before is passed over";
  open();
  EXPECT_TRUE(port.awaits_answer()) << "the flags";
  line.to_port = "F00\r";
  port.poll(now += 1ms);
  EXPECT_FALSE(port.awaits_answer());
}

TEST_F(SlcanEdgesTest, AQuestionMayGoUnansweredForTwentyMillisecondsFromWhenItWasAsked) {
  open();
  for (int i = 0; i < 100; ++i) period("F00\r");
  port.poll(now + 20ms);
  EXPECT_EQ(port.bus_state(), BusState::error_active);
  port.poll(now + 20ms + 1ns);
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
}

TEST_F(SlcanEdgesTest, TheRateMayGoUnansweredForTwentyMilliseconds) {
  run_until_asked("S6\r");
  port.poll(now + 20ms);
  EXPECT_TRUE(port.awaits_answer());
  port.poll(now + 20ms + 1ns);
  EXPECT_FALSE(port.awaits_answer());
}

TEST_F(SlcanEdgesTest, AFrameMayLeaveAtItsDeadlineAndNotLater) {
  open();
  ASSERT_EQ(port.send({.id = 0x080}, now + 1ms), SendResult::queued);
  EXPECT_EQ(period("F00\r"), "t0800\rF\r");
  ASSERT_EQ(port.send({.id = 0x080}, now + 1ms - 1ns), SendResult::queued);
  EXPECT_EQ(period("F00\r"), "F\r");
  EXPECT_EQ(port.counters().stale, 1U);
}

TEST_F(SlcanEdgesTest, LinesThatMakeNoSenseAreCountedAndOthersAreNot) {
  EXPECT_EQ(port.counters().malformed, 0U);
  open();
  EXPECT_EQ(port.counters().malformed, 0U);
  period("x\rt1811AA\rF00\rz\rt18\r");
  EXPECT_EQ(port.counters().malformed, 2U);
  EXPECT_EQ(port.counters().overflows, 0U);
}

TEST_F(SlcanEdgesTest, FramesThatNoQueueHasRoomForAreCounted) {
  open();
  std::string frames;
  for (int i = 0; i < 40; ++i) frames += "t1810\r";
  period(frames);
  EXPECT_EQ(port.counters().overflows, 8U) << "of those that came";
  for (int i = 0; i < 20; ++i) static_cast<void>(port.send({.id = 1}, now + 1s));
  EXPECT_EQ(port.counters().overflows, 12U) << "and of those that were to leave";
  int received = 0;
  for (ReceivedFrame r; port.receive(r);) ++received;
  EXPECT_EQ(received, 32);
}

TEST_F(SlcanEdgesTest, OnePollTakesFiveHundredAndTwelveCharacters) {
  open();
  line.to_port.assign(600, '\r');
  port.poll(now += 1ms);
  EXPECT_EQ(line.to_port.size(), 88U);
}

TEST_F(SlcanEdgesTest, AnAdapterThatIsOpenedAgainHasItsTimeToAnswer) {
  open();
  for (int i = 0; i < 22; ++i) period("");
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  open();
  const Time opened = now;
  port.poll(opened + 20ms);
  EXPECT_EQ(port.bus_state(), BusState::error_active);
}

TEST(SlcanDecoder, KnowsTheFirstAndTheLastLineThatFits) {
  Decoder decoder;
  const auto decoded = [&decoder](const std::string& text) {
    std::optional<Message> last;
    for (const char c : text) {
      if (const auto message = decoder.take(c)) last = message;
    }
    return last.value_or(Message{});
  };
  EXPECT_EQ(decoded("t18181122334455667788FFFF\r").frame.data[7], 0x88);
  EXPECT_EQ(decoded("t1812abcdEf01\r").frame.data[1], 0xCD);
  EXPECT_EQ(decoded("t1812afFa\r").frame.data[0], 0xAF);
  EXPECT_EQ(decoded("t18191122334455667788FF\r").kind, Message::Kind::malformed) << "nine bytes";
  EXPECT_EQ(decoded("t18191122334455667788\r").kind, Message::Kind::malformed) << "of which eight came";
  EXPECT_EQ(decoded("t1810\r").status, 0);
  EXPECT_EQ(Message{}.status, 0);
}

}  // namespace
}  // namespace breakaway::slcan::port_edges
