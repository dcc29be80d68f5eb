// ForceWatch: what was seen of a drive's force, whatever brought it.
//
// A statusword of a state that moves the motor is force until one shows a state that proves the drive function switched
// off; one that says nothing, such as zeros, leaves what was seen before. Such a proof says nothing, either, where the
// torque beside it stays: what lasts for longer than a quick stop is no filter of the report.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <utility>

#include "breakaway/cia402/forced_stop.hpp"
#include "breakaway/cia402/state.hpp"
#include "breakaway/cia402/state_machine.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

class ForceWatch {
 public:
  void on_statusword(std::uint16_t statusword) noexcept {
    if (shows_force(statusword)) has_force_ = shown_ = true;
    if (state_of(statusword) == State::operation_enabled) enabled_shown_ = true;
    if (shows_no_force(statusword)) has_force_ = false;
  }
  // 6077h, per mille of the rated torque, beside a statusword that was given before. That the torque is gone is for
  // 6077h to say by SDO, or for a state that says more: one sample may be anybody's.
  void on_torque(std::uint16_t statusword, std::int16_t torque, hal::Time now) noexcept {
    if (shows_force(statusword)) return forget_torque();
    if (std::abs(torque) <= ForcedStop::most_idle_torque) return idle_torque_since_.reset();
    if (!idle_torque_since_) idle_torque_since_ = now;
    if (now - *idle_torque_since_ > StateMachine::quick_stop_time) torque_stays_ = true;
  }
  // Once a period, after what it brought.
  void update() noexcept {
    if (shown_ || !has_force_) stops_by_itself_ = shown_ && !enabled_shown_;
    enabled_shown_ = false;
    may_have_force_ = std::exchange(shown_, false) || has_force_ || torque_stays_;
  }
  // The drive booted, or proved to be without force.
  void forget() noexcept {
    has_force_ = shown_ = false;
    forget_torque();
  }

  bool may_have_force() const noexcept { return may_have_force_; }  // in this period
  // Of the states that move the motor its statuswords showed none in this period but Quick stop active and Fault
  // reaction active; or it was so when it was heard last.
  bool stops_by_itself() const noexcept { return stops_by_itself_; }

 private:
  void forget_torque() noexcept {
    torque_stays_ = false;
    idle_torque_since_.reset();
  }

  bool has_force_ = false;  // as it was seen last
  bool shown_ = false;      // by any statusword since the last period
  bool torque_stays_ = false;
  bool may_have_force_ = false;
  bool enabled_shown_ = false;
  bool stops_by_itself_ = false;
  std::optional<hal::Time> idle_torque_since_;
};

}  // namespace breakaway::cia402
