// The port against a kernel that does what the test says.
#include "breakaway/socketcan/port.hpp"

#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <deque>
#include <vector>

namespace {

using namespace std::chrono_literals;
using namespace breakaway::socketcan;
using breakaway::hal::BusState;
using breakaway::hal::CanFrame;
using breakaway::hal::ReceivedFrame;
using breakaway::hal::SendResult;
using breakaway::hal::Time;

struct FakeSocket {
  Io answer = Io::done;    // to write()
  Io no_more = Io::again;  // from read(), when nothing is left
  bool carrier = true, reopens = false;
  bool drains = true;       // what was written is on the wire at once
  std::size_t pending = 0;  // frames in the kernel
  int reopenings = 0;
  std::uint32_t lost = 0;
  std::deque<can_frame> incoming;
  std::vector<std::uint32_t> written;

  Io write(const can_frame& frame) noexcept {
    if (answer == Io::done) {
      written.push_back(frame.can_id);
      if (!drains) ++pending;
    }
    return answer;
  }
  Io read(can_frame& frame, Time& received) noexcept {
    received = Time{7us};
    if (incoming.empty()) return no_more;
    frame = incoming.front();
    incoming.pop_front();
    return Io::done;
  }
  std::size_t unsent_bytes() const noexcept { return pending * 768; }
  bool on_bus() const noexcept { return carrier; }
  bool reopen() noexcept {
    ++reopenings;
    return reopens;
  }
  std::uint64_t lost_frames() const noexcept { return lost; }
};

can_frame bus_off_frame() {
  can_frame frame{};
  frame.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
  return frame;
}

constexpr CanFrame command{.id = 0x201, .size = 4}, sync{.id = 0x080};

class SocketcanPort : public testing::Test {
 protected:
  FakeSocket socket;
  Port<FakeSocket> port{socket};
  Time now{100ms};

  void SetUp() override { port.poll(now); }
  void next_period() { port.poll(now += 1ms); }
  SendResult send(const CanFrame& frame) { return port.send(frame, now + 1ms - 1ns); }
  bool receive_any() {
    ReceivedFrame received;
    return port.receive(received);
  }
  using Ids = std::vector<std::uint32_t>;
};

TEST_F(SocketcanPort, GivesFramesToTheKernelInOrder) {
  EXPECT_EQ(send(command), SendResult::queued);
  EXPECT_EQ(send(sync), SendResult::queued);
  EXPECT_EQ(socket.written, (Ids{0x201, 0x080}));
}

TEST_F(SocketcanPort, RefusesWhatIsNoClassicFrame) {
  EXPECT_EQ(port.send({.id = 0x800}, now), SendResult::not_sendable);
  EXPECT_EQ(port.send({.id = 1, .size = 9}, now), SendResult::not_sendable);
  EXPECT_TRUE(socket.written.empty());
}

TEST_F(SocketcanPort, KeepsFramesInOrderWhileTheKernelHasNoRoom) {
  socket.answer = Io::again;
  EXPECT_EQ(send(command), SendResult::queued);
  EXPECT_EQ(send(sync), SendResult::queued);
  EXPECT_EQ(port.counters().jams, 2U);
  socket.answer = Io::done;
  EXPECT_EQ(port.send({.id = 0x601}, now + 1ms), SendResult::queued);
  EXPECT_EQ(socket.written, (Ids{0x201, 0x080, 0x601}));
}

TEST_F(SocketcanPort, DropsAndCountsWhatTheKernelDidNotTakeInTime) {
  socket.answer = Io::again;
  EXPECT_EQ(send(command), SendResult::queued);
  socket.answer = Io::done;
  next_period();
  EXPECT_TRUE(socket.written.empty());
  EXPECT_EQ(port.counters().stale, 1U);
}

TEST_F(SocketcanPort, AFrameIsInTimeUntilItsDeadlineIsOver) {
  socket.answer = Io::again;
  EXPECT_EQ(port.send(command, now + 1ms), SendResult::queued);
  socket.answer = Io::done;
  next_period();
  EXPECT_EQ(socket.written, (Ids{0x201}));
  EXPECT_EQ(port.counters().stale, 0U);
}

// A bus on which nothing moves: the kernel gets one period's frames, and no more before they are gone.
TEST_F(SocketcanPort, TheKernelNeverHoldsFramesOfTwoPeriods) {
  socket.drains = false;
  EXPECT_EQ(send(command), SendResult::queued);
  EXPECT_EQ(send(sync), SendResult::queued);
  for (int period = 0; period < 10; ++period) {
    next_period();
    EXPECT_EQ(send(command), SendResult::queued);
    EXPECT_EQ(send(sync), SendResult::queued);
  }
  EXPECT_EQ(socket.written.size(), 2U);
  EXPECT_EQ(port.counters().stale, 18U);
  socket.pending = 0;
  socket.drains = true;
  next_period();
  EXPECT_EQ(send(command), SendResult::queued);
  EXPECT_EQ(socket.written.size(), 3U) << "the two of the period before are stale";
}

TEST_F(SocketcanPort, AFullQueueSaysSo) {
  socket.answer = Io::again;
  for (int i = 0; i < 32; ++i) EXPECT_EQ(send(sync), SendResult::queued);
  EXPECT_EQ(send(sync), SendResult::queue_full);
  EXPECT_EQ(port.counters().overflows, 1U);
}

TEST_F(SocketcanPort, PurgeForgetsWhatWaits) {
  socket.answer = Io::again;
  EXPECT_EQ(send(command), SendResult::queued);
  port.purge_transmit_queue();
  socket.answer = Io::done;
  EXPECT_EQ(send(sync), SendResult::queued);
  EXPECT_EQ(socket.written, (Ids{0x080}));
}

TEST_F(SocketcanPort, PassesFramesOnWithTheirTime) {
  socket.incoming.push_back(to_kernel(command));
  ReceivedFrame received;
  ASSERT_TRUE(port.receive(received));
  EXPECT_EQ(received.frame, command);
  EXPECT_EQ(received.time, Time{7us});
  EXPECT_FALSE(port.receive(received));
}

TEST_F(SocketcanPort, ErrorFramesAreNotFramesOfTheBus) {
  socket.incoming.assign(2, bus_off_frame());
  socket.incoming.push_back(to_kernel(sync));
  ReceivedFrame received;
  ASSERT_TRUE(port.receive(received));
  EXPECT_EQ(received.frame, sync);
}

TEST_F(SocketcanPort, FramesOf29BitsArePassedOver) {
  can_frame foreign{}, ours{};
  foreign.can_id = CAN_EFF_FLAG | 0x181;
  ours.can_id = 0x181;
  socket.incoming = {foreign, ours, foreign};
  EXPECT_TRUE(receive_any());
  EXPECT_FALSE(receive_any());
  EXPECT_TRUE(socket.incoming.empty());
}

TEST_F(SocketcanPort, AFloodOfErrorFramesDoesNotHoldTheLoop) {
  socket.incoming.assign(1000, bus_off_frame());
  EXPECT_FALSE(receive_any());
  EXPECT_GE(socket.incoming.size(), 900U);
}

TEST_F(SocketcanPort, InBusOffNothingIsSentAndWhatWaitedIsForgotten) {
  socket.answer = Io::again;
  EXPECT_EQ(send(command), SendResult::queued);
  socket.incoming.push_back(bus_off_frame());
  socket.carrier = false;
  EXPECT_FALSE(receive_any());
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  EXPECT_FALSE(port.link_lost());
  EXPECT_EQ(send(sync), SendResult::bus_off);
  socket.answer = Io::done;
  for (int period = 0; period < 5; ++period) next_period();
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  EXPECT_TRUE(socket.written.empty());
  socket.carrier = true;
  next_period();
  EXPECT_EQ(port.bus_state(), BusState::error_active);
  EXPECT_TRUE(socket.written.empty());
  EXPECT_EQ(port.counters().bus_offs, 1U);
}

TEST_F(SocketcanPort, BusOffIsSeenForThePeriodEvenIfTheControllerIsBackAtOnce) {
  socket.incoming.push_back(bus_off_frame());
  EXPECT_FALSE(receive_any());
  port.poll(now);
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  next_period();
  EXPECT_EQ(port.bus_state(), BusState::error_active);
}

TEST_F(SocketcanPort, AfterBusOffTheKernelFirstEmptiesItself) {
  socket.drains = false;
  EXPECT_EQ(send(command), SendResult::queued);
  socket.incoming.push_back(bus_off_frame());
  EXPECT_FALSE(receive_any());
  next_period();
  EXPECT_EQ(send(sync), SendResult::queued);
  EXPECT_EQ(socket.written, (Ids{0x201}));
  socket.pending = 0;
  EXPECT_EQ(port.send({.id = 0x601}, now + 1ms), SendResult::queued);
  EXPECT_EQ(socket.written, (Ids{0x201, 0x080, 0x601}));
}

TEST_F(SocketcanPort, AnInterfaceThatGoesDownIsBusOffUntilItIsUp) {
  socket.answer = Io::down;
  EXPECT_EQ(send(command), SendResult::queued) << "queued before the kernel was asked";
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  EXPECT_TRUE(port.link_lost());
  EXPECT_EQ(send(sync), SendResult::bus_off);
  socket.carrier = false;
  next_period();
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  socket.carrier = true;
  socket.answer = Io::done;
  next_period();
  EXPECT_EQ(port.bus_state(), BusState::error_active);
  EXPECT_TRUE(socket.written.empty());
  EXPECT_EQ(port.counters().link_losses, 1U);
}

// Reading and writing both tell of it, again and again.
TEST_F(SocketcanPort, ALinkThatIsLostIsCountedOnce) {
  for (const Io lost : {Io::down, Io::gone}) {
    socket.no_more = lost;
    EXPECT_FALSE(receive_any());
    EXPECT_TRUE(port.link_lost());
    EXPECT_FALSE(receive_any());
    EXPECT_TRUE(port.link_lost());
    EXPECT_EQ(port.counters().link_losses, 1U);
  }
}

TEST_F(SocketcanPort, AnInterfaceThatIsGoneIsOpenedAgainNowAndThen) {
  socket.no_more = Io::gone;
  EXPECT_FALSE(receive_any());
  for (int period = 0; period < 1000; ++period) next_period();
  EXPECT_NEAR(socket.reopenings, 10, 1);
  socket.reopens = true;
  for (int period = 0; period < 101; ++period) next_period();
  EXPECT_EQ(port.bus_state(), BusState::error_active);
}

TEST_F(SocketcanPort, ControllerStatesAreShown) {
  can_frame frame{};
  frame.can_id = CAN_ERR_FLAG | CAN_ERR_CRTL;
  frame.data[1] = CAN_ERR_CRTL_TX_PASSIVE;
  socket.incoming.push_back(frame);
  EXPECT_FALSE(receive_any());
  EXPECT_EQ(port.bus_state(), BusState::error_passive);
  EXPECT_EQ(send(sync), SendResult::queued);
}

TEST_F(SocketcanPort, CountsWhatTheKernelRefusesAndGoesOn) {
  EXPECT_EQ(send(sync), SendResult::queued);
  EXPECT_EQ(port.counters().refused, 0U);
  socket.answer = Io::refused;
  EXPECT_EQ(send(command), SendResult::queued);
  socket.answer = Io::done;
  EXPECT_EQ(send(sync), SendResult::queued);
  EXPECT_EQ(socket.written, (Ids{0x080, 0x080})) << "the refused one is not tried again";
  EXPECT_EQ(port.counters().refused, 1U);
}

TEST_F(SocketcanPort, CountsFramesThatTheControllerAndTheSocketLost) {
  can_frame overflow{};
  overflow.can_id = CAN_ERR_FLAG | CAN_ERR_CRTL;
  overflow.data[1] = CAN_ERR_CRTL_RX_OVERFLOW;
  socket.incoming = {overflow, overflow};
  EXPECT_FALSE(receive_any());
  EXPECT_EQ(port.counters().overflows, 2U);
  can_frame passive = overflow;
  passive.data[1] = CAN_ERR_CRTL_TX_PASSIVE;
  socket.incoming = {passive};
  EXPECT_FALSE(receive_any());
  EXPECT_EQ(port.counters().overflows, 2U);
  socket.lost = 5;
  EXPECT_EQ(port.counters().overflows, 7U);
}

TEST_F(SocketcanPort, OneCallPassesOverSixtyFourErrorFrames) {
  socket.incoming.assign(100, bus_off_frame());
  EXPECT_FALSE(receive_any());
  EXPECT_EQ(socket.incoming.size(), 36U);
}

TEST_F(SocketcanPort, WhatWaitedWhenTheLinkWasLostIsForgotten) {
  for (const bool off_bus : {false, true}) {
    socket.answer = Io::again;
    EXPECT_EQ(port.send(command, now + 1s), SendResult::queued);
    if (off_bus) {
      socket.incoming.push_back(bus_off_frame());
    } else {
      socket.no_more = Io::down;
    }
    EXPECT_FALSE(receive_any());
    EXPECT_EQ(port.bus_state(), BusState::bus_off);
    port.poll(now);
    EXPECT_EQ(port.bus_state(), BusState::bus_off) << "for the whole period";
    socket.no_more = Io::again;
    socket.answer = Io::done;
    next_period();
    next_period();
    EXPECT_EQ(port.bus_state(), BusState::error_active);
    EXPECT_TRUE(socket.written.empty());
  }
}

TEST_F(SocketcanPort, AnInterfaceThatIsGoneIsOpenedAgainAfterATenthOfASecond) {
  socket.no_more = Io::gone;
  EXPECT_FALSE(receive_any());
  port.poll(now + 100ms - 1ns);
  EXPECT_EQ(socket.reopenings, 0);
  port.poll(now + 100ms);
  EXPECT_EQ(socket.reopenings, 1);
  port.poll(now + 200ms - 1ns);
  EXPECT_EQ(socket.reopenings, 1);
  port.poll(now + 200ms);
  EXPECT_EQ(socket.reopenings, 2);
}

}  // namespace
