// The example on the first page of a port's author, and models that break the concept in one thing each.
#include "breakaway/hal/can_port.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <optional>

#include "../explained_enum.hpp"
#include "page_example.hpp"

namespace breakaway::hal {
namespace {

using namespace std::chrono_literals;

// [page]
template <class Controller>
class OneFramePort {
 public:
  explicit OneFramePort(Controller& controller) noexcept : controller_{&controller} {}
  void poll(Time now) noexcept {
    if (controller_->sending() && now >= deadline_) controller_->abort();
  }
  [[nodiscard]] SendResult send(const CanFrame& frame, Time deadline) noexcept {
    if (!is_sendable(frame)) return SendResult::not_sendable;
    if (controller_->off_bus()) return SendResult::bus_off;
    if (controller_->sending()) return SendResult::queue_full;
    deadline_ = deadline;
    controller_->load(frame);
    return SendResult::queued;
  }
  bool receive(ReceivedFrame& received) noexcept { return controller_->take(received); }
  void purge_transmit_queue() noexcept { controller_->abort(); }
  BusState bus_state() const noexcept {
    if (controller_->off_bus()) return BusState::bus_off;
    return BusState::error_active;
  }

 private:
  Controller* controller_;
  Time deadline_{};
};
// [page]

// A controller with one mailbox in each direction.
struct TestController {
  std::optional<CanFrame> outgoing;
  std::deque<ReceivedFrame> incoming;
  bool off = false;

  bool sending() const noexcept { return outgoing.has_value(); }
  bool off_bus() const noexcept { return off; }
  void load(const CanFrame& frame) noexcept { outgoing = frame; }
  void abort() noexcept { outgoing.reset(); }
  bool take(ReceivedFrame& received) noexcept {
    if (incoming.empty()) return false;
    received = incoming.front();
    incoming.pop_front();
    return true;
  }
};

static_assert(CanPort<OneFramePort<TestController>>);

// A port that models the concept; each of the others breaks it in one thing.
struct Model {
  SendResult send(const CanFrame&, Time) noexcept { return SendResult::queued; }
  bool receive(ReceivedFrame&) noexcept { return false; }
  void purge_transmit_queue() noexcept {}
  BusState bus_state() const noexcept { return BusState::error_active; }
};
static_assert(CanPort<Model>);

struct SendMayThrow : Model {
  SendResult send(const CanFrame&, Time) { return SendResult::queued; }
};
struct SendSaysYesOrNo : Model {
  bool send(const CanFrame&, Time) noexcept { return true; }
};
struct SendWantsADuration : Model {
  SendResult send(const CanFrame&, Duration) noexcept { return SendResult::queued; }
};
struct SendChangesTheFrame : Model {
  SendResult send(CanFrame&, Time) noexcept { return SendResult::queued; }
};
struct ReceivesWithoutTime : Model {
  bool receive(CanFrame&) noexcept { return false; }
};
struct ReceiveMayThrow : Model {
  bool receive(ReceivedFrame&) { return false; }
};
struct DoesNotPurge : Model {
  void purge_transmit_queue() noexcept = delete;
};
struct PurgeMayFail : Model {
  bool purge_transmit_queue() noexcept { return false; }
};
struct AskingForTheStateChangesIt : Model {
  BusState bus_state() noexcept { return BusState::error_active; }
};
static_assert(!CanPort<SendMayThrow>);
static_assert(!CanPort<SendSaysYesOrNo>);
static_assert(!CanPort<SendWantsADuration>);
static_assert(!CanPort<SendChangesTheFrame>);
static_assert(!CanPort<ReceivesWithoutTime>);
static_assert(!CanPort<ReceiveMayThrow>);
static_assert(!CanPort<DoesNotPurge>);
static_assert(!CanPort<PurgeMayFail>);
static_assert(!CanPort<AskingForTheStateChangesIt>);

TEST(CanPortPage, ShowsTheCodeThatIsTestedHere) {
  test::expect_page_shows_example("hal/include/breakaway/hal/can_port.hpp", "tests/unit/hal/can_port_test.cpp");
}

TEST(CanPortPage, ExampleKeepsWhatThePageSays) {
  TestController controller;
  OneFramePort port{controller};
  const CanFrame frame{.id = 0x201, .size = 2, .data = {1, 2}};
  EXPECT_EQ(port.send({.id = 0x800}, Time{1ms}), SendResult::not_sendable);
  EXPECT_EQ(port.send({.size = 9}, Time{1ms}), SendResult::not_sendable);
  ASSERT_EQ(port.send(frame, Time{1ms}), SendResult::queued);
  EXPECT_EQ(controller.outgoing, frame);
  EXPECT_EQ(port.send(frame, Time{1ms}), SendResult::queue_full);
  port.poll(Time{1ms} - 1ns);
  EXPECT_TRUE(controller.sending());
  port.poll(Time{1ms});
  EXPECT_FALSE(controller.sending()) << "a stale command is not executed";
  ASSERT_EQ(port.send(frame, Time{2ms}), SendResult::queued);
  port.purge_transmit_queue();
  EXPECT_FALSE(controller.sending());

  controller.incoming = {{frame, Time{5ms}}};
  ReceivedFrame received;
  ASSERT_TRUE(port.receive(received));
  EXPECT_EQ(received.frame, frame);
  EXPECT_EQ(received.time, Time{5ms});
  EXPECT_FALSE(port.receive(received));

  EXPECT_EQ(port.bus_state(), BusState::error_active);
  controller.off = true;
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  EXPECT_EQ(port.send(frame, Time{1s}), SendResult::bus_off);
}

TEST(SendResult, SaysWhatIsWrongAndWhatToDo) {
  test::expect_sentences<SendResult>({{SendResult::queued, {"queued"}},
                                      {SendResult::queue_full, {"transmit queue", "send fewer frames"}},
                                      {SendResult::bus_off, {"off the bus", "check wiring", "bit rate", "bus_state()"}},
                                      {SendResult::not_sendable, {"id must be at most 7FFh", "size at most 8"}}});
}

TEST(CanFrame, IsSendableUpToTheHighestIdentifierAndSize) {
  EXPECT_TRUE(is_sendable({.id = 0x7FF, .size = 8, .remote = true}));
  EXPECT_FALSE(is_sendable({.id = 0x800, .size = 0}));
  EXPECT_FALSE(is_sendable({.id = 0, .size = 9}));
  EXPECT_EQ((CanFrame{.size = 15}).payload().size(), 8U) << "as a receiver takes it";
}

}  // namespace
}  // namespace breakaway::hal
