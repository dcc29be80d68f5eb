#include "breakaway/cia402/state_machine.hpp"

namespace breakaway::cia402 {

void StateMachine::request_enable() noexcept {
  if (state_ != State::fault && state_ != State::fault_reaction_active) enable_ = true;
}

void StateMachine::reset_fault() noexcept {
  if (state_ == State::fault && reset_ == Reset::none) {
    reset_ = Reset::low;
    reset_since_.reset();
  }
}

void StateMachine::on_statusword(std::uint16_t statusword) noexcept {
  const std::optional<State> state = state_of(statusword);
  if (!state) return;
  const bool left_operation = state_ == State::operation_enabled && state != State::operation_enabled;
  const bool failed = state == State::fault || state == State::fault_reaction_active;
  if (left_operation || failed) enable_ = false;
  if (state != State::fault) reset_ = Reset::none;
  if (state != State::quick_stop_active) quick_stop_since_.reset();
  state_ = state;
}

void StateMachine::update(hal::Time now) noexcept { controlword_ = next_controlword(now); }

std::uint16_t StateMachine::next_controlword(hal::Time now) noexcept {
  if (!state_) return control::disable_voltage;
  switch (*state_) {
    case State::not_ready_to_switch_on:
    case State::fault_reaction_active:
      return control::disable_voltage;
    case State::switch_on_disabled:
      return enable_ ? control::shutdown : control::disable_voltage;
    case State::ready_to_switch_on:
      return enable_ ? control::switch_on : control::disable_voltage;
    case State::switched_on:
      return enable_ ? control::enable_operation : control::disable_voltage;
    case State::operation_enabled:
      return enable_ ? control::enable_operation : control::quick_stop;
    case State::quick_stop_active: {
      if (!quick_stop_since_) quick_stop_since_ = now;
      const bool leave = enable_ || now - *quick_stop_since_ > quick_stop_time;
      return leave ? control::disable_voltage : control::quick_stop;
    }
    case State::fault:
      return reset_controlword(now);
  }
  return control::disable_voltage;
}

// The edge counts, so the bit is shown low, then high, then low again. One wish is one edge: a drive that stays in
// Fault still has the cause.
std::uint16_t StateMachine::reset_controlword(hal::Time now) noexcept {
  if (reset_ == Reset::none) return control::disable_voltage;
  if (reset_since_ && reset_updates_ == reset_level_updates && now - *reset_since_ >= reset_level_time) {
    reset_ = reset_ == Reset::low ? Reset::high : Reset::none;
    reset_since_.reset();
  }
  if (!reset_since_) {
    reset_since_ = now;
    reset_updates_ = 0;
  }
  if (reset_updates_ < reset_level_updates) ++reset_updates_;
  return reset_ == Reset::high ? control::fault_reset : control::disable_voltage;
}

}  // namespace breakaway::cia402
