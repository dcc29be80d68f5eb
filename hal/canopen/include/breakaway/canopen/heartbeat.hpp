// Heartbeats (CiA 301, 7.2.8.3.2): a consumer that knows a remote node's NMT state and notices its silence, and a
// producer for our own.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::canopen {

constexpr hal::CanFrame heartbeat_frame(NmtState state, std::uint8_t node_id) noexcept {
  return {.id = heartbeat_cob_id(node_id), .size = 1, .remote = false, .data = {static_cast<std::uint8_t>(state)}};
}

// Tracks one remote node.
class HeartbeatConsumer {
 public:
  // timeout: above 0; the longest silence that is not a loss.
  constexpr HeartbeatConsumer(std::uint8_t node_id, hal::Duration timeout) noexcept
      : cob_id_{heartbeat_cob_id(node_id)}, timeout_{timeout} {}

  // From `now` on the node must be heard within the timeout. Before, silence is no loss: a node that just booted may
  // not produce heartbeats until it is told to.
  constexpr void start(hal::Time now) noexcept {
    supervised_ = true;
    lost_ = false;
    last_time_ = now;
  }
  constexpr void stop() noexcept { supervised_ = lost_ = false; }

  constexpr void on_frame(const hal::CanFrame& frame, hal::Time time) noexcept {
    if (frame.id != cob_id_ || frame.remote || frame.size != 1) return;
    const auto value = static_cast<std::uint8_t>(frame.data[0] & 0x7FU);  // bit 7 is the toggle of old node guarding
    if (!is_nmt_state(value)) return;
    state_ = static_cast<NmtState>(value);
    booted_ = booted_ || state_ == NmtState::boot_up;
    last_time_ = time;
    lost_ = false;
  }
  constexpr void update(hal::Time now) noexcept {
    if (supervised_ && now - last_time_ > timeout_) lost_ = true;
  }

  // Holds nothing until the node was heard.
  constexpr std::optional<NmtState> state() const noexcept { return state_; }
  // The node has been silent for longer than the timeout and still is.
  constexpr bool lost() const noexcept { return lost_; }
  // Returns true once for every boot-up, at which the node lost its configuration.
  constexpr bool take_boot_up() noexcept { return std::exchange(booted_, false); }
  constexpr void forget_state() noexcept { state_.reset(); }

 private:
  std::uint16_t cob_id_;
  hal::Duration timeout_;
  std::optional<NmtState> state_;
  bool supervised_ = false;
  bool lost_ = false;
  bool booted_ = false;
  hal::Time last_time_{};
};

class HeartbeatProducer {
 public:
  // period: 0 produces none.
  constexpr HeartbeatProducer(std::uint8_t node_id, hal::Duration period) noexcept
      : node_id_{node_id}, period_{period} {}

  // Returns true and fills `frame` when a heartbeat is due; the first is due at once. A late call does not make the
  // following ones early.
  constexpr bool next_frame(hal::CanFrame& frame, NmtState state, hal::Time now) noexcept {
    if (period_ <= hal::Duration::zero() || (due_ && now < *due_)) return false;
    due_ = now + period_;
    frame = heartbeat_frame(state, node_id_);
    return true;
  }

 private:
  std::uint8_t node_id_;
  hal::Duration period_;
  std::optional<hal::Time> due_;
};

}  // namespace breakaway::canopen
