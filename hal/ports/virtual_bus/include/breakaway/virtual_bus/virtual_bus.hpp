// VirtualBus: a CAN bus in memory and in simulated time, with arbitration by identifier, frame lengths exact to the
// stuff bit, and, on request, lost and delayed frames. The constructor and add_port allocate; nothing else does. All
// calls are for one thread.
//
// Time passes in advance_to only. A frame sent at now() takes part in the arbitration at now() if the bus is idle then,
// so that the order of sends at one instant does not decide. Frames are delivered with the last bit of their end of
// frame, that is one intermission (3 bits) before the bus is idle again. A frame counts as acknowledged even on a bus
// of one node, and of two ports that send one identifier at once the one opened first goes first: the bus has no errors
// but those asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/virtual_bus/ring.hpp"

namespace breakaway::virtual_bus {

struct VirtualBusConfig {
  std::uint32_t bit_rate = 1'000'000;   // bit/s, above 0
  std::size_t transmit_capacity = 64;   // frames a port can queue, above 0
  std::size_t receive_capacity = 256;   // frames a port can hold until receive(), above 0
  std::size_t in_flight_capacity = 64;  // frames between the wire and delivery, above 0
  // 0..1. A frame that is lost is delivered to nobody, but takes its time on the wire.
  double loss_probability = 0;
  // Frames are delivered late by a time that is uniform between the two; they do not overtake one another.
  hal::Duration min_delay{0};
  hal::Duration max_delay{0};
  std::uint64_t seed = 1;  // of losses and delays
};

struct VirtualBusCounters {
  std::uint64_t frames = 0;     // frames that were on the wire
  hal::Duration busy_time{0};   // from start of frame to the end of the intermission, summed
  std::uint64_t lost = 0;       // by loss_probability
  std::uint64_t stale = 0;      // dropped at their deadline
  std::uint64_t overflows = 0;  // refused or dropped because a queue was full
};

class VirtualBus {
 public:
  class Port;
  // Called at the instant of delivery, when bus.now() is the frame's time. It may send, but must not advance the bus.
  using Listener = void (*)(void* context, const hal::ReceivedFrame& received) noexcept;
  // Called when a frame leaves the wire, lost or not. `start` is the time of its first bit, `end` that of its last,
  // without the intermission.
  using Tap = void (*)(void* context, const hal::CanFrame& frame, hal::Time start, hal::Time end) noexcept;

  explicit VirtualBus(const VirtualBusConfig& config);
  VirtualBus(const VirtualBus&) = delete;
  VirtualBus& operator=(const VirtualBus&) = delete;

  // Adds a node to the bus. The port lives as long as the bus.
  Port& add_port();
  void set_tap(Tap tap, void* context) noexcept;

  hal::Time now() const noexcept { return now_; }
  // Runs the bus up to and including `time`. A time in the past changes nothing.
  void advance_to(hal::Time time) noexcept;
  // Returns when advance_to has something to do next, as things stand, or Time::max() when nothing is to come. This is
  // for a caller that brings several machines forward together.
  hal::Time next_event() const noexcept;

  const VirtualBusCounters& counters() const noexcept { return counters_; }

 private:
  struct Delivery {
    hal::ReceivedFrame received;
    const Port* sender = nullptr;
  };

  bool start_next_frame() noexcept;
  void finish_frame() noexcept;
  void deliver_due() noexcept;
  double random_unit() noexcept;
  hal::Duration random_delay() noexcept;

  VirtualBusConfig config_;
  std::vector<std::unique_ptr<Port>> ports_;
  Ring<Delivery> deliveries_;
  VirtualBusCounters counters_;
  Tap tap_ = nullptr;
  void* tap_context_ = nullptr;
  hal::Time now_{};
  std::uint64_t random_state_;
  hal::Time last_delivery_{};

  bool on_wire_ = false;  // a frame is between its first bit and its end of frame
  hal::CanFrame frame_;
  const Port* sender_ = nullptr;
  hal::Time frame_start_{};
  hal::Time frame_end_{};
  hal::Time idle_from_{};
};

// Port: one node's door to the bus, as hal/can_port.hpp describes it. It has no poll(): the bus does everything in
// advance_to.
class VirtualBus::Port {
 public:
  Port(VirtualBus& bus, const VirtualBusConfig& config);

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept;
  bool receive(hal::ReceivedFrame& received) noexcept;
  void purge_transmit_queue() noexcept { transmit_.clear(); }
  hal::BusState bus_state() const noexcept { return state_; }

  // Sends frames to the listener from now on, instead of keeping them for receive(). nullptr undoes that.
  void set_listener(Listener listener, void* context) noexcept;
  // Injects a fault. In bus_off queued frames are gone, sends are refused and nothing is received until another state
  // is set.
  void set_bus_state(hal::BusState state) noexcept;

 private:
  friend class VirtualBus;
  struct Queued {
    hal::CanFrame frame;
    hal::Time deadline{};
  };

  void drop_stale(hal::Time now) noexcept;
  void deliver(const hal::ReceivedFrame& received) noexcept;

  VirtualBus& bus_;
  Ring<Queued> transmit_;
  Ring<hal::ReceivedFrame> receive_;
  Listener listener_ = nullptr;
  void* listener_context_ = nullptr;
  hal::BusState state_ = hal::BusState::error_active;
};

static_assert(hal::CanPort<VirtualBus::Port>);

}  // namespace breakaway::virtual_bus
