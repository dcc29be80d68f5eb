#include "breakaway/virtual_bus/virtual_bus.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "breakaway/hal/wire_length.hpp"

namespace {

using namespace std::chrono_literals;
using breakaway::hal::BusState;
using breakaway::hal::CanFrame;
using breakaway::hal::Duration;
using breakaway::hal::ReceivedFrame;
using breakaway::hal::SendResult;
using breakaway::hal::Time;
using breakaway::hal::wire_bits;
using breakaway::hal::wire_time;
using breakaway::virtual_bus::VirtualBus;
using breakaway::virtual_bus::VirtualBusConfig;

constexpr Time never = Time::max();

CanFrame frame_of(std::uint16_t id, std::uint8_t byte = 0) { return {.id = id, .size = 1, .data = {byte}}; }

std::vector<ReceivedFrame> drain(VirtualBus::Port& port) {
  std::vector<ReceivedFrame> frames;
  for (ReceivedFrame received; port.receive(received);) frames.push_back(received);
  return frames;
}

std::vector<unsigned> ids(const std::vector<ReceivedFrame>& frames) {
  std::vector<unsigned> result;
  for (const auto& received : frames) result.push_back(received.frame.id);
  return result;
}

TEST(VirtualBus, DeliversToAllOthersWithTheLastBitOfTheFrame) {
  for (const std::uint32_t bit_rate : {125'000U, 500'000U, 1'000'000U}) {
    VirtualBus bus{{.bit_rate = bit_rate}};
    auto& a = bus.add_port();
    auto& b = bus.add_port();
    auto& c = bus.add_port();
    const CanFrame frame = frame_of(0x123, 0x45);
    bus.advance_to(Time{10us});
    ASSERT_EQ(a.send(frame, never), SendResult::queued);
    const Time end{10us + wire_time(wire_bits(frame) - 3, bit_rate)};
    bus.advance_to(end - 1ns);
    EXPECT_TRUE(drain(b).empty());
    bus.advance_to(end);
    for (auto* port : {&b, &c}) {
      const auto received = drain(*port);
      ASSERT_EQ(received.size(), 1U);
      EXPECT_EQ(received[0].frame, frame);
      EXPECT_EQ(received[0].time, end);
    }
    EXPECT_TRUE(drain(a).empty());
    EXPECT_EQ(bus.counters().busy_time, wire_time(wire_bits(frame), bit_rate));
  }
}

TEST(VirtualBus, LowestIdentifierWinsWhateverTheOrderOfSends) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  auto& listener = bus.add_port();
  ASSERT_EQ(a.send(frame_of(0x300), never), SendResult::queued);
  ASSERT_EQ(b.send(frame_of(0x181), never), SendResult::queued);
  ASSERT_EQ(a.send(frame_of(0x080), never), SendResult::queued);  // behind 300h in the same queue: first in, first out
  bus.advance_to(Time{1ms});
  EXPECT_EQ(ids(drain(listener)), (std::vector<unsigned>{0x181, 0x300, 0x080}));
}

TEST(VirtualBus, DataFrameWinsAgainstRemoteFrameOfTheSameIdentifier) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  auto& listener = bus.add_port();
  ASSERT_EQ(a.send({.id = 0x201, .size = 1, .remote = true}, never), SendResult::queued);
  ASSERT_EQ(b.send(frame_of(0x201), never), SendResult::queued);
  bus.advance_to(Time{1ms});
  const auto received = drain(listener);
  ASSERT_EQ(received.size(), 2U);
  EXPECT_FALSE(received[0].frame.remote);
  EXPECT_TRUE(received[1].frame.remote);
}

TEST(VirtualBus, RunningFrameIsNotInterrupted) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  auto& listener = bus.add_port();
  ASSERT_EQ(a.send(frame_of(0x700), never), SendResult::queued);
  bus.advance_to(Time{1us});
  ASSERT_EQ(b.send(frame_of(0x080), never), SendResult::queued);
  bus.advance_to(Time{1ms});
  const auto received = drain(listener);
  ASSERT_EQ(ids(received), (std::vector<unsigned>{0x700, 0x080}));
  // The second starts when the first's intermission is over.
  EXPECT_EQ(received[1].time, Time{wire_time(wire_bits(frame_of(0x700)) + wire_bits(frame_of(0x080)) - 3, 1'000'000)});
}

TEST(VirtualBus, EachPortIsFirstInFirstOut) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  std::vector<unsigned> sent;
  for (std::uint16_t i = 0; i < 40; ++i) {
    const auto id = static_cast<std::uint16_t>((i * 733U) & 0x7FFU);
    sent.push_back(id);
    ASSERT_EQ(a.send(frame_of(id), never), SendResult::queued);
  }
  bus.advance_to(Time{10ms});
  EXPECT_EQ(ids(drain(b)), sent);
}

TEST(VirtualBus, RefusesWhenTheQueueIsFullAndKeepsWhatIsIn) {
  VirtualBus bus{{.transmit_capacity = 2}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  ASSERT_EQ(a.send(frame_of(1), never), SendResult::queued);
  ASSERT_EQ(a.send(frame_of(2), never), SendResult::queued);
  EXPECT_EQ(a.send(frame_of(3), never), SendResult::queue_full);
  EXPECT_EQ(bus.counters().overflows, 1U);
  bus.advance_to(Time{1ms});
  EXPECT_EQ(ids(drain(b)), (std::vector<unsigned>{1, 2}));
}

TEST(VirtualBus, APortThatIsNotReadKeepsTheOldestFrames) {
  VirtualBus bus{{.receive_capacity = 2}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  for (std::uint16_t id = 1; id <= 3; ++id) ASSERT_EQ(a.send(frame_of(id), never), SendResult::queued);
  bus.advance_to(Time{1ms});
  EXPECT_EQ(bus.counters().overflows, 1U);
  EXPECT_EQ(ids(drain(b)), (std::vector<unsigned>{1, 2}));
}

TEST(VirtualBus, DropsFramesThatAreTooManyOnTheirWay) {
  VirtualBus bus{{.in_flight_capacity = 2, .min_delay = 10ms, .max_delay = 10ms}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  for (std::uint16_t id = 1; id <= 3; ++id) ASSERT_EQ(a.send(frame_of(id), never), SendResult::queued);
  bus.advance_to(Time{30ms});
  EXPECT_EQ(bus.counters().overflows, 1U);
  EXPECT_EQ(bus.counters().frames, 3U);
  EXPECT_EQ(ids(drain(b)), (std::vector<unsigned>{1, 2}));
}

TEST(VirtualBus, ATimeThatIsPastChangesNothing) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  bus.advance_to(Time{1ms});
  ASSERT_EQ(a.send(frame_of(1), never), SendResult::queued);
  bus.advance_to(Time{500us});
  EXPECT_EQ(bus.now(), Time{1ms});
  EXPECT_TRUE(drain(b).empty());
  bus.advance_to(Time{2ms});
  EXPECT_EQ(drain(b).size(), 1U);
}

TEST(VirtualBus, RefusesWhatIsNoClassicFrame) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  EXPECT_EQ(a.send({.id = 0x800}, never), SendResult::not_sendable);
  EXPECT_EQ(a.send({.id = 1, .size = 9}, never), SendResult::not_sendable);
}

TEST(VirtualBus, DropsAFrameThatIsNotOnTheWireByItsDeadline) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  ASSERT_EQ(a.send(frame_of(1), never), SendResult::queued);  // keeps the wire busy for more than 50 us
  ASSERT_EQ(a.send(frame_of(2), Time{50us}), SendResult::queued);
  ASSERT_EQ(a.send(frame_of(3), Time{1ms}), SendResult::queued);
  bus.advance_to(Time{2ms});
  EXPECT_EQ(ids(drain(b)), (std::vector<unsigned>{1, 3}));
  EXPECT_EQ(bus.counters().stale, 1U);
}

TEST(VirtualBus, ListenerMayAnswerAtTheInstantOfDelivery) {
  VirtualBus bus{{}};
  auto& master = bus.add_port();
  struct Node {
    VirtualBus* bus;
    VirtualBus::Port* port;
    Time heard_at{};
  } node{&bus, &bus.add_port()};
  node.port->set_listener(
      [](void* context, const ReceivedFrame& received) noexcept {
        auto& self = *static_cast<Node*>(context);
        self.heard_at = self.bus->now();
        EXPECT_EQ(received.time, self.heard_at);
        EXPECT_EQ(self.port->send(frame_of(0x181), never), SendResult::queued);
      },
      &node);
  const CanFrame sync{.id = 0x080};
  ASSERT_EQ(master.send(sync, never), SendResult::queued);
  bus.advance_to(Time{1ms});
  EXPECT_EQ(node.heard_at, Time{wire_time(wire_bits(sync) - 3, 1'000'000)});
  const auto received = drain(master);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].time, Time{wire_time(wire_bits(sync) + wire_bits(frame_of(0x181)) - 3, 1'000'000)});
}

TEST(VirtualBus, TapSeesEveryFrameWithItsTimes) {
  struct Entry {
    unsigned id;
    Time start, end;
  };
  std::vector<Entry> log;
  VirtualBus bus{{.loss_probability = 1.0}};
  bus.set_tap(
      [](void* context, const CanFrame& frame, Time start, Time end) noexcept {
        static_cast<std::vector<Entry>*>(context)->push_back({frame.id, start, end});
      },
      &log);
  auto& a = bus.add_port();
  bus.add_port();
  ASSERT_EQ(a.send(frame_of(5), never), SendResult::queued);
  ASSERT_EQ(a.send(frame_of(6), never), SendResult::queued);
  bus.advance_to(Time{1ms});
  ASSERT_EQ(log.size(), 2U);
  EXPECT_EQ(log[0].start, Time{});
  EXPECT_EQ(log[0].end, Time{wire_time(wire_bits(frame_of(5)) - 3, 1'000'000)});
  EXPECT_EQ(log[1].start, log[0].end + 3us);
}

std::vector<ReceivedFrame> run_lossy(std::uint64_t seed) {
  VirtualBus bus{{.receive_capacity = 20'000, .loss_probability = 0.1, .max_delay = 300us, .seed = seed}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  for (unsigned i = 0; i < 10'000; ++i) {
    EXPECT_EQ(a.send(frame_of(static_cast<std::uint16_t>(i & 0x7FF)), never), SendResult::queued);
    bus.advance_to(Time{std::chrono::milliseconds{i + 1}});
  }
  return drain(b);
}

TEST(VirtualBus, LosesTheAskedShareAndTheSameFramesForTheSameSeed) {
  const auto first = run_lossy(1);
  const auto again = run_lossy(1);
  const auto other = run_lossy(2);
  // 1000 of 10000 expected, standard deviation 30: five of them.
  EXPECT_NEAR(10'000.0 - static_cast<double>(first.size()), 1000.0, 150.0);
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].frame, again[i].frame);
    ASSERT_EQ(first[i].time, again[i].time);
  }
  EXPECT_NE(ids(first), ids(other));
}

TEST(VirtualBus, DelaysWithinBoundsAndInOrder) {
  VirtualBus bus{{.min_delay = 100us, .max_delay = 400us, .seed = 3}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  Duration shortest = Duration::max();
  Duration longest{};
  for (int i = 0; i < 1000; ++i) {
    const Time sent = bus.now();
    ASSERT_EQ(a.send(frame_of(1), never), SendResult::queued);
    bus.advance_to(sent + 1ms);
    const auto received = drain(b);
    ASSERT_EQ(received.size(), 1U);
    const Duration delay = received[0].time - sent - wire_time(wire_bits(frame_of(1)) - 3, 1'000'000);
    shortest = std::min(shortest, delay);
    longest = std::max(longest, delay);
  }
  EXPECT_GE(shortest, 100us);
  EXPECT_LT(shortest, 110us);
  EXPECT_LE(longest, 400us);
  EXPECT_GT(longest, 390us);
}

TEST(VirtualBus, DelayedFramesDoNotOvertake) {
  VirtualBus bus{{.max_delay = 1ms, .seed = 4}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  std::vector<unsigned> sent;
  for (std::uint16_t i = 0; i < 60; ++i) {
    sent.push_back(i);
    ASSERT_EQ(a.send(frame_of(i), never), SendResult::queued);
  }
  bus.advance_to(Time{20ms});
  const auto received = drain(b);
  ASSERT_EQ(ids(received), sent);
  for (std::size_t i = 1; i < received.size(); ++i) EXPECT_GE(received[i].time, received[i - 1].time);
}

TEST(VirtualBus, BusOffRefusesSendsAndForgetsTheQueue) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  ASSERT_EQ(a.send(frame_of(1), never), SendResult::queued);
  a.set_bus_state(BusState::bus_off);
  EXPECT_EQ(a.bus_state(), BusState::bus_off);
  EXPECT_EQ(a.send(frame_of(2), never), SendResult::bus_off);
  ASSERT_EQ(b.send(frame_of(3), never), SendResult::queued);
  bus.advance_to(Time{1ms});
  EXPECT_TRUE(drain(a).empty());
  EXPECT_TRUE(drain(b).empty());
  a.set_bus_state(BusState::error_active);
  ASSERT_EQ(a.send(frame_of(4), never), SendResult::queued);
  bus.advance_to(Time{2ms});
  EXPECT_EQ(ids(drain(b)), (std::vector<unsigned>{4}));
}

TEST(VirtualBus, PurgeForgetsWhatIsNotOnTheWire) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  ASSERT_EQ(a.send(frame_of(1), never), SendResult::queued);
  ASSERT_EQ(a.send(frame_of(2), never), SendResult::queued);
  bus.advance_to(Time{1us});
  a.purge_transmit_queue();
  bus.advance_to(Time{1ms});
  EXPECT_EQ(ids(drain(b)), (std::vector<unsigned>{1}));
}

TEST(VirtualBus, TellsWhenItHasSomethingToDoNext) {
  VirtualBus bus{{}};
  auto& a = bus.add_port();
  auto& b = bus.add_port();
  bus.advance_to(Time{5us});
  EXPECT_EQ(bus.next_event(), never);
  ASSERT_EQ(a.send(frame_of(1), never), SendResult::queued);
  ASSERT_EQ(a.send(frame_of(2), never), SendResult::queued);
  std::vector<ReceivedFrame> received;
  for (int events = 0; bus.next_event() != never; ++events) {
    ASSERT_LT(events, 10);
    bus.advance_to(bus.next_event());
    for (const auto& frame : drain(b)) {
      EXPECT_EQ(frame.time, bus.now());
      received.push_back(frame);
    }
  }
  EXPECT_EQ(ids(received), (std::vector<unsigned>{1, 2}));
}

TEST(VirtualBus, TheSameFramesPassHoweverTimeIsCutUp) {
  const auto run = [](Duration step) {
    VirtualBus bus{{.loss_probability = 0.2, .max_delay = 70us, .seed = 9}};
    auto& a = bus.add_port();
    auto& b = bus.add_port();
    auto& c = bus.add_port();
    for (std::uint16_t i = 0; i < 30; ++i) {
      EXPECT_EQ(a.send(frame_of(static_cast<std::uint16_t>(0x100 + i)), never), SendResult::queued);
      EXPECT_EQ(b.send(frame_of(static_cast<std::uint16_t>(0x110 - i)), never), SendResult::queued);
    }
    for (Time time{}; time < Time{10ms}; time += step) bus.advance_to(time);
    bus.advance_to(Time{10ms});
    return drain(c);
  };
  const auto coarse = run(10ms);
  const auto fine = run(777ns);
  ASSERT_EQ(ids(coarse), ids(fine));
  for (std::size_t i = 0; i < coarse.size(); ++i) EXPECT_EQ(coarse[i].time, fine[i].time);
}

}  // namespace
