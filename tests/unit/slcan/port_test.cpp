#include "breakaway/slcan/port.hpp"

#include <gtest/gtest.h>

#include <string>

namespace {

using namespace std::chrono_literals;
using breakaway::hal::BusState;
using breakaway::hal::CanFrame;
using breakaway::hal::ReceivedFrame;
using breakaway::hal::SendResult;
using breakaway::hal::Time;

class Wire {
 public:
  bool read(char& character) noexcept {
    if (next_ == to_port.size()) return false;
    character = to_port[next_++];
    return true;
  }
  bool write(std::span<const char> text) noexcept {
    if (full) return false;
    from_port.append(text.data(), text.size());
    return true;
  }
  std::string to_port, from_port;
  bool full = false;

 private:
  std::size_t next_ = 0;
};

constexpr CanFrame sync{.id = 0x080};

class SlcanPortTest : public testing::Test {
 protected:
  // A period in which the adapter says `answer` after what the port asked.
  std::string period(const std::string& answer) {
    now += 1ms;
    port.poll(now);
    wire.from_port.clear();
    port.flush(now);
    wire.to_port += answer;
    return wire.from_port;
  }
  // What the port says while it takes in the adapter's words.
  std::string asked() {
    wire.from_port.clear();
    port.poll(now += 1ms);
    return wire.from_port;
  }
  void open() {
    for (int i = 0; i < 100 && port.bus_state() == BusState::bus_off; ++i) {
      if (!asked().empty()) wire.to_port += "\r";
      port.flush(now);
    }
    wire.to_port += "F00\r";
    port.poll(now);
    ASSERT_EQ(port.bus_state(), BusState::error_active);
  }

  Wire wire;
  breakaway::slcan::Port<Wire> port{wire, 500'000};
  Time now{};
};

TEST_F(SlcanPortTest, OpensTheAdapterAtItsBitRate) {
  EXPECT_EQ(port.send(sync, Time{1s}), SendResult::bus_off);
  EXPECT_EQ(period("\a\a\a\r"), "\r\r\rC\r") << "what came before may have left half a line";
  for (int i = 0; i < 9; ++i) EXPECT_EQ(period(""), "") << "the answers to that are waited out";
  EXPECT_EQ(asked(), "S6\r");
  wire.to_port += "\r";
  EXPECT_EQ(asked(), "O\r");
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  wire.to_port += "\r";
  EXPECT_EQ(asked(), "");
  EXPECT_EQ(port.bus_state(), BusState::error_active);
}

TEST_F(SlcanPortTest, HandsFramesOverInOrderAndAsksForTheFlags) {
  open();
  ASSERT_EQ(port.send({.id = 0x201, .size = 1, .data = {7}}, now + 1ms), SendResult::queued);
  ASSERT_EQ(port.send(sync, now + 1ms), SendResult::queued);
  wire.from_port.clear();
  port.flush(now);
  EXPECT_EQ(wire.from_port, "t201107\rt0800\rF\r");
}

TEST_F(SlcanPortTest, StampsReceivedFramesWithThePollThatBroughtThem) {
  open();
  wire.to_port += "z\rt1811AA\r";
  port.poll(Time{7s});
  ReceivedFrame received;
  ASSERT_TRUE(port.receive(received));
  EXPECT_EQ(received.frame, (CanFrame{.id = 0x181, .size = 1, .data = {0xAA}}));
  EXPECT_EQ(received.time, Time{7s});
  EXPECT_FALSE(port.receive(received));
}

TEST_F(SlcanPortTest, DropsAFrameAtItsDeadline) {
  open();
  wire.full = true;
  ASSERT_EQ(port.send(sync, now + 1ms), SendResult::queued);
  port.flush(now + 1ms);
  wire.full = false;
  wire.from_port.clear();
  port.flush(now + 1ms + 1ns);
  EXPECT_EQ(wire.from_port, "F\r");
  EXPECT_EQ(port.counters().stale, 1U);
}

TEST_F(SlcanPortTest, ForgetsPurgedFrames) {
  open();
  ASSERT_EQ(port.send(sync, now + 1ms), SendResult::queued);
  port.purge_transmit_queue();
  wire.from_port.clear();
  port.flush(now);
  EXPECT_EQ(wire.from_port, "F\r");
}

TEST_F(SlcanPortTest, SaysThatTheQueueIsFull) {
  open();
  int accepted = 0;
  while (port.send(sync, now + 1s) == SendResult::queued) ++accepted;
  EXPECT_EQ(accepted, 16);
  EXPECT_EQ(port.send(sync, now + 1s), SendResult::queue_full);
}

TEST_F(SlcanPortTest, RefusesWhatIsNoClassicFrame) {
  open();
  EXPECT_EQ(port.send({.id = 0x800}, Time{1s}), SendResult::not_sendable);
  EXPECT_EQ(port.send({.id = 1, .size = 9}, Time{1s}), SendResult::not_sendable);
}

TEST_F(SlcanPortTest, ReadsTheBusStateFromTheFlags) {
  open();
  for (const auto& [answer, state] :
       {std::pair{"F04\r", BusState::error_warning}, std::pair{"F24\r", BusState::error_passive},
        std::pair{"F80\r", BusState::error_warning}, std::pair{"F00\r", BusState::error_active}}) {
    period(answer);
    port.poll(now);
    EXPECT_EQ(port.bus_state(), state) << answer;
  }
}

TEST_F(SlcanPortTest, OutlivesOneLostAnswer) {
  open();
  period("");
  for (int i = 0; i < 5; ++i) period("F00\r");
  EXPECT_EQ(port.bus_state(), BusState::error_active);
}

TEST_F(SlcanPortTest, CountsASilentAdapterAsBusOffAndOpensItAgainWithoutStaleFrames) {
  open();
  for (int i = 0; i < 22; ++i) period("");
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  EXPECT_EQ(port.send(sync, now + 1s), SendResult::bus_off);
  open();
  EXPECT_EQ(port.counters().openings, 2U);
  EXPECT_EQ(period(""), "F\r");
}

TEST_F(SlcanPortTest, StaysOpenAsLongAsItIsAnswered) {
  open();
  for (int i = 0; i < 200; ++i) period("F00\r");
  EXPECT_EQ(port.bus_state(), BusState::error_active);
  EXPECT_EQ(port.counters().openings, 1U);
}

TEST_F(SlcanPortTest, KeepsNothingOfTheTimeBeforeAnAdapterWasLost) {
  open();
  period("F24\r");
  wire.full = true;
  port.poll(now);
  ASSERT_EQ(port.send(sync, now + 3600s), SendResult::queued);
  wire.to_port += "t18";
  for (int i = 0; i < 22; ++i) period("");
  wire.full = false;
  const Time lost = now;
  open();
  EXPECT_LT(now - lost, 15ms) << "half a line does not swallow an answer";
  EXPECT_EQ(wire.from_port, "F\r") << "no stale frame";
}

TEST_F(SlcanPortTest, StartsWithCleanFlagsAfterOpening) {
  open();
  period("F24\r");
  for (int i = 0; i < 22; ++i) period("");
  while (port.bus_state() == BusState::bus_off) {
    if (!asked().empty()) wire.to_port += "\r";
    port.flush(now);
  }
  EXPECT_EQ(port.bus_state(), BusState::error_active);
}

TEST_F(SlcanPortTest, CountsFramesThatTheAdapterRefused) {
  open();
  period("\a");
  port.poll(now);
  EXPECT_EQ(port.counters().overflows, 1U);
}

TEST_F(SlcanPortTest, TriesAgainWhenTheAdapterRefusesTheBitRate) {
  for (int i = 0; i < 60; ++i) period("\a");
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  open();
}

TEST(SlcanPort, NeverOpensAtAnUnknownBitRate) {
  Wire wire;
  breakaway::slcan::Port<Wire> port{wire, 333'333};
  for (Time now{}; now < Time{100ms}; now += 1ms) {
    port.poll(now);
    port.flush(now);
  }
  EXPECT_EQ(wire.from_port, "");
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
}

}  // namespace
