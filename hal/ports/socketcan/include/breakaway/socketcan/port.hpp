// A CanPort on Linux SocketCAN.
//
// Each period: poll(now) first.
//
// What the kernel was given cannot be taken back. So frames wait here, with their deadlines, and the kernel gets those
// of a new period only when it has put all earlier ones on the wire: after a jam or bus-off it holds one period's
// frames at most. While the interface is down or its controller off the bus, bus_state() is bus_off, sends are refused
// and what waited is forgotten; how the controller joins the bus again is the interface's configuration (restart-ms) or
// an operator's decision (ip link), and the port notices.
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

// clang-format off

// A CAN_RAW socket. No call waits.
template <class S>
concept RawSocket = requires(S& socket, const can_frame& out, can_frame& in, hal::Time& received) {
  { socket.write(out) } noexcept -> std::same_as<Io>;
  { socket.read(in, received) } noexcept -> std::same_as<Io>;  // received: on CLOCK_MONOTONIC
  { socket.unsent_bytes() } noexcept -> std::same_as<std::size_t>;  // in the kernel, not yet on the wire
  { socket.on_bus() } noexcept -> std::same_as<bool>;  // the interface is up, its controller not in bus-off
  { socket.reopen() } noexcept -> std::same_as<bool>;
  { socket.lost_frames() } noexcept -> std::same_as<std::uint32_t>;  // received, but the socket was full; a total
};

// clang-format on

struct Counters {
  std::uint32_t stale = 0;      // frames dropped at their deadline
  std::uint32_t jams = 0;       // times that the kernel took no more frames (ENOBUFS)
  std::uint32_t overflows = 0;  // frames lost by the controller, the socket or the queue here
  std::uint32_t refused = 0;    // frames that the kernel does not take
  std::uint32_t bus_offs = 0;   // of the controller
  std::uint32_t link_losses = 0;
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

  // CanPort

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
    can_frame in;
    for (int n = 0; n < most_reads; ++n) {
      const Io result = socket_->read(in, received.time);
      if (result != Io::done) return lose_link_on(result);
      if ((in.can_id & CAN_ERR_FLAG) != 0) {
        follow(error_report(in));
      } else if (const auto frame = from_kernel(in)) {
        received.frame = *frame;
        return true;
      }
    }
    return false;
  }
  void purge_transmit_queue() noexcept { queue_.clear(); }
  hal::BusState bus_state() const noexcept { return link_ == Link::up ? state_ : hal::BusState::bus_off; }

  // The interface itself is down or gone; otherwise bus_off means the controller.
  bool link_lost() const noexcept { return link_ == Link::down || link_ == Link::gone; }
  Counters counters() const noexcept {
    Counters all = counters_;
    all.overflows += socket_->lost_frames();
    return all;
  }

 private:
  enum class Link : std::uint8_t { up, bus_off, down, gone };
  // Error frames that one call passes over: a disturbed bus brings thousands a second.
  static constexpr int most_reads = 64;
  static constexpr hal::Duration reopen_interval = std::chrono::milliseconds{100};

  // Deadlines count on the wire, but a frame that the kernel has taken leaves within the period.
  void pump() noexcept {
    for (; !queue_.empty() && queue_.front().deadline < now_; queue_.pop()) ++counters_.stale;
    jammed_ = jammed_ && socket_->unsent_bytes() > 0;
    while (!jammed_ && !queue_.empty() && link_ == Link::up) {
      const Io result = socket_->write(to_kernel(queue_.front().frame));
      jammed_ = result == Io::again;
      if (jammed_) ++counters_.jams;
      if (result == Io::refused) ++counters_.refused;
      if (!jammed_) queue_.pop();
      lose_link_on(result);
    }
  }

  // Always false, for receive().
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

  // At the earliest in the period after the loss: whoever supervises the port has seen it by then.
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
