// CanPort: a node's door to one CAN bus. This is the page to read before writing a port.
//
// Roles. The port owns the controller (a peripheral, a socket, a serial adapter), a transmit queue and a receive queue.
// Frames are copied on their way in and out, so nobody ever holds a pointer into a queue. The loop
// (firmware::ControlLoop) keeps a reference to the port and makes the four calls of the concept. Whatever else a port
// needs, such as start(), poll(now), flush(now) and counters(), is between it and the main() that wires it up.
//
// Life cycle. main() constructs the port, which is the last time that it may allocate; starts it; and gives it to the
// loop, which it must outlive. Then, once a period and in one thread:
//
//   port.poll(now);     // the port's own: takes frames in, drops stale ones, leads the controller back from bus-off
//   loop.command(now);  // calls receive() until it says false, then send() for every command
//   loop.sync(later);   // at loop.sync_due(): send() for SYNC and what follows it in the period
//
// All four calls have in common that they never block, allocate, throw or wait for a lock, and that their work is
// bounded. They are made in the thread of the loop only, and the port does not call back. A port with interrupts shares
// its queues with them by itself, for which there is hal::SharedRing.
//
// A minimal port, for a controller that holds one frame in each direction:
//
//   template <class Controller>
//   class OneFramePort {
//    public:
//     explicit OneFramePort(Controller& controller) noexcept : controller_{&controller} {}
//     void poll(Time now) noexcept {
//       if (controller_->sending() && now >= deadline_) controller_->abort();
//     }
//     [[nodiscard]] SendResult send(const CanFrame& frame, Time deadline) noexcept {
//       if (!is_sendable(frame)) return SendResult::not_sendable;
//       if (controller_->off_bus()) return SendResult::bus_off;
//       if (controller_->sending()) return SendResult::queue_full;
//       deadline_ = deadline;
//       controller_->load(frame);
//       return SendResult::queued;
//     }
//     bool receive(ReceivedFrame& received) noexcept { return controller_->take(received); }
//     void purge_transmit_queue() noexcept { controller_->abort(); }
//     BusState bus_state() const noexcept {
//       if (controller_->off_bus()) return BusState::bus_off;
//       return BusState::error_active;
//     }
//
//    private:
//     Controller* controller_;
//     Time deadline_{};
//   };
//
// hal/ports holds five real ones. virtual_bus is a bus in memory that fails on demand; the tests of the others hold a
// model of their controller against what is said here.
#pragma once

#include <concepts>
#include <cstdint>
#include <string_view>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

// The fault confinement of ISO 11898-1, as the controller sees itself.
enum class BusState : std::uint8_t {
  error_active,
  error_warning,  // 96 errors counted or more; still takes part like any other node
  error_passive,  // 128 or more; still takes part, but may no longer stop others' frames
  bus_off,        // takes no part: nothing is sent or received until the port has led the controller back
};

enum class SendResult : std::uint8_t {
  queued,        // the port has a copy of the frame and sends it, unless its deadline passes first
  queue_full,    // nothing was kept; there may be room in the next period
  bus_off,       // nothing was kept, and what had been queued is gone
  not_sendable,  // nothing was kept: is_sendable() is false
};

constexpr std::string_view to_string(SendResult result) noexcept {
  switch (result) {
    case SendResult::queued:
      return "the frame is queued";
    case SendResult::queue_full:
      return "the transmit queue is full: send fewer frames a period, or the frame again in the next one";
    case SendResult::bus_off:
      return "the CAN controller is off the bus: check wiring, termination and bit rate, and wait until bus_state() "
             "says otherwise";
    case SendResult::not_sendable:
      return "this is no classic CAN frame: its id must be at most 7FFh and its size at most 8 bytes";
  }
  return "unknown send result";
}

// Returns true for what a port can send at all: a classic frame with an 11-bit identifier and at most 8 bytes.
constexpr bool is_sendable(const CanFrame& frame) noexcept {
  return frame.id <= CanFrame::max_id && frame.size <= CanFrame::max_size;
}

// The formatter would tear the calls and their comments apart.
// clang-format off

template <class P>
concept CanPort = requires(P& port, const P& constant, const CanFrame& frame, ReceivedFrame& received, Time deadline) {
  // Copies the frame behind those of earlier calls: first in, first out, whatever the identifiers. Returns `queued`, or
  // why the frame was not taken; then the caller decides whether to try again in the next period, and the port keeps
  // nothing.
  // A frame that is not on the wire by `deadline` is dropped by the port, because a stale command must not be executed;
  // one that is on the wire by then need not be called back. The caller is not told: the port counts what it dropped.
  // The frame stays the caller's. Never blocks; for the loop's thread.
  { port.send(frame, deadline) } noexcept -> std::same_as<SendResult>;

  // Moves the oldest received frame, with its time, to `received` and returns true; returns false when there is none,
  // and what `received` holds then means nothing. Classic data and remote frames with 11-bit identifiers come out, in
  // the order in which they were on the wire. The port's own frames and those that its filters refuse do not.
  // When the receive queue is full, the port loses frames and counts them.
  // `received` is the caller's, and a copy: the port keeps nothing of it. Never blocks; for the loop's thread.
  { port.receive(received) } noexcept -> std::same_as<bool>;

  // Forgets every frame that is not on the wire yet. It cannot fail. The loop calls it when an axis faults; the port
  // does the same by itself when its controller goes bus-off.
  // Never blocks; for the loop's thread.
  { port.purge_transmit_queue() } noexcept -> std::same_as<void>;

  // Returns the controller's state as of the last poll or later. The loop asks once a period and axis, so a port keeps
  // it where it is cheap to read. An adapter or an interface that is gone reads as bus_off.
  // Changes nothing and never blocks; for the loop's thread.
  { constant.bus_state() } noexcept -> std::same_as<BusState>;
};

// clang-format on

}  // namespace breakaway::hal
