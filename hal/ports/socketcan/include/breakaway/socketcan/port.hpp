// A CanPort on Linux SocketCAN.
//
// poll(now) comes first in every period.
//
// The kernel gives no frame back. Frames therefore wait here, with their deadlines, and the kernel gets those of a new
// period only when it has put all earlier ones on the wire: after a jam or bus-off it holds one period's frames at
// most. While the interface is down or its controller off the bus, bus_state() is bus_off, sends are refused and what
// waited is forgotten; how the controller joins the bus again is the interface's configuration (restart-ms) or an
// operator's decision (ip link), and the port notices.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "breakaway/hal/can_port.hpp"
#include "breakaway/socketcan/frames.hpp"
#include "breakaway/socketcan/outgoing_queue.hpp"

namespace breakaway::socketcan {

enum class Io : std::uint8_t {
  done,
  again,    // nothing to read, or no room to write
  down,     // the interface is down
  gone,     // the interface is no more: open the socket again
  refused,  // the kernel does not take this frame
};

// The formatter would tear the requirements and their comments apart.
// clang-format off

// RawSocket: a CAN_RAW socket. No call waits.
template <class S>
concept RawSocket = requires(S& socket, const can_frame& to_send, can_frame& frame, hal::Time& received) {
  { socket.write(to_send) } noexcept -> std::same_as<Io>;
  // Reads the oldest frame, and when it was received on CLOCK_MONOTONIC.
  { socket.read(frame, received) } noexcept -> std::same_as<Io>;
  // Counts the bytes that are in the kernel and not yet on the wire.
  { socket.unsent_bytes() } noexcept -> std::same_as<std::size_t>;
  // Returns true while the interface is up and its controller not in bus-off.
  { socket.on_bus() } noexcept -> std::same_as<bool>;
  // Opens the interface once more, after Io::gone. Returns true when it is open.
  { socket.reopen() } noexcept -> std::same_as<bool>;
  // Counts the frames that were received when it was full, also those before it was opened once more.
  { socket.lost_frames() } noexcept -> std::same_as<std::uint64_t>;
};

// clang-format on

struct Counters {
  std::uint64_t stale = 0;      // frames dropped at their deadline
  std::uint64_t jams = 0;       // times that the kernel took no more frames (ENOBUFS)
  std::uint64_t overflows = 0;  // frames lost by the controller, the socket or the queue here
  std::uint64_t refused = 0;    // frames that the kernel does not take
  std::uint64_t bus_offs = 0;   // of the controller
  std::uint64_t link_losses = 0;
};

template <RawSocket Socket>
class Port {
 public:
  explicit Port(Socket& socket) noexcept : socket_{&socket} {}

  void poll(hal::Time now) noexcept {
    now_ = now;
    if (link_ != Link::up) return look_for_link();
    jammed_ = socket_->unsent_bytes() > 0;
    pump();
  }

  // CanPort; see hal/can_port.hpp for what the calls promise.

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    if (!hal::is_sendable(frame)) return hal::SendResult::not_sendable;
    if (link_ != Link::up) return hal::SendResult::bus_off;
    if (!queue_.push({frame, deadline})) {
      ++counters_.overflows;
      return hal::SendResult::queue_full;
    }
    pump();
    return hal::SendResult::queued;
  }

  bool receive(hal::ReceivedFrame& received) noexcept {
    can_frame kernel_frame;
    for (int n = 0; n < most_reads; ++n) {
      const Io result = socket_->read(kernel_frame, received.time);
      if (result != Io::done) return lose_link_on(result);
      if ((kernel_frame.can_id & CAN_ERR_FLAG) != 0) {
        follow(error_report(kernel_frame));
      } else if (const auto frame = from_kernel(kernel_frame)) {
        received.frame = *frame;
        return true;
      }
    }
    return false;
  }
  void purge_transmit_queue() noexcept { queue_.clear(); }
  hal::BusState bus_state() const noexcept { return link_ == Link::up ? state_ : hal::BusState::bus_off; }

  // Returns true when the interface itself is down or gone; otherwise bus_off is the controller's.
  bool link_lost() const noexcept { return link_ == Link::down || link_ == Link::gone; }
  Counters counters() const noexcept {
    Counters all = counters_;
    all.overflows += socket_->lost_frames();
    return all;
  }

 private:
  enum class Link : std::uint8_t { up, bus_off, down, gone };
  // One call passes over no more error frames: a disturbed bus brings thousands a second.
  static constexpr int most_reads = 64;
  static constexpr hal::Duration reopen_interval = std::chrono::milliseconds{100};

  // Deadlines count on the wire, but a frame that the kernel has taken leaves within the period.
  void pump() noexcept {
    for (; !queue_.empty() && queue_.front().deadline < now_; queue_.pop()) ++counters_.stale;
    jammed_ = jammed_ && socket_->unsent_bytes() > 0;
    while (!jammed_ && !queue_.empty()) {  // a lost link empties it
      const Io result = socket_->write(to_kernel(queue_.front().frame));
      jammed_ = result == Io::again;
      if (jammed_) ++counters_.jams;
      if (result == Io::refused) ++counters_.refused;
      if (!jammed_) queue_.pop();
      lose_link_on(result);
    }
  }

  // Returns false always, which is what receive() is to return then.
  bool lose_link_on(Io result) noexcept {
    if (result == Io::down) lose_link(Link::down);
    if (result == Io::gone) lose_link(Link::gone);
    return false;
  }
  void lose_link(Link link) noexcept {
    if (!link_lost()) ++counters_.link_losses;
    link_ = link;
    lost_at_ = now_;
    queue_.clear();
  }

  void follow(const ErrorReport& report) noexcept {
    if (report.overflow) ++counters_.overflows;
    if (!report.state) return;
    state_ = *report.state;
    if (state_ != hal::BusState::bus_off || link_ != Link::up) return;
    ++counters_.bus_offs;
    link_ = Link::bus_off;
    lost_at_ = now_;
    queue_.clear();
  }

  // A link is found again at the earliest in the period after its loss: whoever supervises the port has seen it by
  // then.
  void look_for_link() noexcept {
    if (now_ <= lost_at_) return;
    if (link_ == Link::gone) {
      if (now_ - lost_at_ < reopen_interval) return;
      lost_at_ = now_;
      if (!socket_->reopen()) return;
    }
    if (!socket_->on_bus()) return;
    link_ = Link::up;
    state_ = hal::BusState::error_active;
    jammed_ = true;  // until the kernel has let go of what it held
  }

  Socket* socket_;
  OutgoingQueue<32> queue_;
  Counters counters_;
  hal::Time now_{};
  hal::Time lost_at_{};
  hal::BusState state_ = hal::BusState::error_active;
  Link link_ = Link::up;
  bool jammed_ = false;
};

}  // namespace breakaway::socketcan
