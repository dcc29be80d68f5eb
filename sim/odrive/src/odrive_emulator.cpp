#include "breakaway/odrive_emulator/odrive_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "breakaway/odrive/fault_code.hpp"

namespace breakaway::odrive_emulator {

using odrive::AxisState;
using odrive::Command;

namespace {

constexpr std::uint8_t result_not_calibrated = 14, result_disarmed = 3, result_success = 0;

}  // namespace

OdriveEmulator::OdriveEmulator(const EmulatorConfig& config, drive_emulator::Mechanism& mechanism, Send send)
    : config_{config},
      mechanism_{mechanism},
      send_{std::move(send)},
      motor_{config.max_torque_Nm * config.force_per_torque_N_per_Nm, config.current_loop_time_constant_s} {}

void OdriveEmulator::power_on(hal::Time time) {
  advance_to(time);
  restart();
  timers_.set(boot, now_ + config_.boot_duration);
}

void OdriveEmulator::power_off(hal::Time time) {
  advance_to(time);
  restart();
}

void OdriveEmulator::restart() {
  timers_.cancel_all();
  outgoing_.clear();
  running_ = false;
  state_ = AxisState::undefined;
  errors_ = 0;
  result_ = result_success;
  control_mode_ = 3;
  input_torque_Nm_ = 0;
  current_limit_A_.reset();
  settle();
}

void OdriveEmulator::start() {
  running_ = true;
  state_ = AxisState::idle;
  if (config_.counts_from_power_on) {
    advance_mechanism_to(now_);
    origin_m_ = mechanism_.position_m();
  }
  again(heartbeat_due, config_.heartbeat_period);
  again(estimate_due, config_.estimate_period);
  again(torque_due, config_.torque_period);
}

void OdriveEmulator::again(Timer timer, hal::Duration period) {
  if (period.count() <= 0) return;
  const double late_ns = static_cast<double>(period.count()) * (1 + config_.clock_error);
  timers_.set(timer, now_ + hal::Duration{std::llround(late_ns)});
}

void OdriveEmulator::advance_to(hal::Time time) {
  while (true) {
    const hal::Time next = next_event().value_or(hal::Time::max());
    if (next > time) break;
    now_ = std::max(now_, next);
    if (const auto timer = timers_.first(); timer && *timers_.due(*timer) <= now_) {
      timers_.cancel(*timer);
      on_time(*timer);
    }
    flush();
  }
  now_ = std::max(now_, time);
}

std::optional<hal::Time> OdriveEmulator::next_event() const {
  hal::Time next = timers_.first_due();
  if (!outgoing_.empty()) next = std::min(next, outgoing_.begin()->first);
  if (next == hal::Time::max()) return {};
  return next;
}

void OdriveEmulator::advance_mechanism_to(hal::Time time) {
  mechanism_.advance_to(hal::seconds(time), motor_.segment());
}

void OdriveEmulator::on_time(std::size_t timer) {
  switch (timer) {
    case boot:
      return start();
    case heartbeat_due:
      if (!heartbeat_suppressed_) post(heartbeat());
      return again(heartbeat_due, config_.heartbeat_period);
    case estimate_due:
      if (!estimates_suppressed_) post(estimates());
      return again(estimate_due, config_.estimate_period);
    case torque_due:
      if (!estimates_suppressed_ && !torques_suppressed_) post(torques());
      return again(torque_due, config_.torque_period);
    case watchdog:
      return disarm(odrive::error::watchdog_timer_expired);
  }
}

void OdriveEmulator::on_frame(const hal::CanFrame& frame, hal::Time time) {
  advance_to(time);
  if (!running_ || silent_ || odrive::node_id_of(frame.id) != config_.node_id) return;
  if (frame.remote)
    answer(odrive::command_of(frame.id));
  else
    obey(frame);
  flush();
}

void OdriveEmulator::obey(const hal::CanFrame& frame) {
  switch (odrive::command_of(frame.id)) {
    case Command::estop:
      if (!config_.ignores_estop) disarm(odrive::error::estop_requested);
      return;
    case Command::set_axis_state:
      return request_state(static_cast<AxisState>(odrive::load(frame, 0)));
    case Command::set_controller_mode:
      control_mode_ = odrive::load(frame, 0);
      return settle();
    case Command::set_input_torque:
      input_torque_Nm_ = static_cast<double>(odrive::load_float(frame, 0));
      if (!std::isfinite(input_torque_Nm_)) input_torque_Nm_ = 0;
      feed_watchdog();
      return settle();
    case Command::set_limits:
      current_limit_A_ = static_cast<double>(odrive::load_float(frame, 4));
      return settle();
    case Command::reboot:
      return power_on(now_);
    case Command::clear_errors:
      errors_ = 0;
      return;
    default:
      return;
  }
}

void OdriveEmulator::answer(Command command) {
  if (!config_.answers_questions) return;
  switch (command) {
    case Command::get_version: {
      auto frame = odrive::frame_of(config_.node_id, command, std::uint32_t{2}, std::uint32_t{0});
      frame.data[5] = config_.firmware_minor;
      return post(frame, config_.response_delay);
    }
    case Command::heartbeat:
      if (!heartbeat_suppressed_) post(heartbeat(), config_.response_delay);
      return;
    case Command::get_error:
      return post(odrive::frame_of(config_.node_id, command, errors_, errors_), config_.response_delay);
    case Command::get_encoder_estimates:
      if (!estimates_suppressed_) post(estimates(), config_.response_delay);
      return;
    case Command::get_torques:
      if (!estimates_suppressed_ && !torques_suppressed_) post(torques(), config_.response_delay);
      return;
    default:
      return;
  }
}

void OdriveEmulator::request_state(AxisState asked) {
  if (asked == AxisState::idle && !config_.ignores_idle) {
    state_ = AxisState::idle;
    result_ = result_success;
  }
  if (asked == AxisState::closed_loop_control && state_ != asked) {
    if (!config_.calibrated) {
      result_ = result_not_calibrated;
    } else if (errors_ != 0) {
      result_ = result_disarmed;
    } else {
      state_ = asked;
      result_ = result_success;
      feed_watchdog();
    }
  }
  settle();
}

void OdriveEmulator::disarm(std::uint32_t errors) {
  errors_ |= errors;
  if (!odrive::is_without_torque(state_)) {
    state_ = AxisState::idle;
    result_ = result_disarmed;
  }
  settle();
}

void OdriveEmulator::trip(std::uint32_t errors, hal::Time time) {
  advance_to(time);
  if (running_) disarm(errors);
}

void OdriveEmulator::disarm_silently(hal::Time time) {
  advance_to(time);
  if (!running_) return;
  state_ = AxisState::idle;
  settle();
}

void OdriveEmulator::feed_watchdog() {
  if (config_.watchdog_timeout.count() > 0) timers_.set(watchdog, now_ + config_.watchdog_timeout);
}

double OdriveEmulator::torque_limit_Nm() const {
  const double limit_Nm = current_limit_A_ ? *current_limit_A_ * config_.torque_constant_Nm_per_A : HUGE_VAL;
  return limit_Nm >= 0 ? std::min(limit_Nm, config_.max_torque_Nm) : 0;
}

// The watchdog is of an armed axis.
void OdriveEmulator::settle() {
  const bool armed = state_ == AxisState::closed_loop_control;
  if (!armed) timers_.cancel(watchdog);
  const bool follows = armed && control_mode_ == static_cast<std::uint32_t>(odrive::ControlMode::torque);
  const double torque_Nm = follows ? std::clamp(input_torque_Nm_, -torque_limit_Nm(), torque_limit_Nm()) : 0;
  const double force_N = motor_.clamped(torque_Nm * config_.force_per_torque_N_per_Nm);
  if (force_N == motor_.commanded_N()) return;
  advance_mechanism_to(now_);
  motor_.command(force_N, hal::seconds(now_));
  mechanism_.change_force(motor_.segment());
}

hal::CanFrame OdriveEmulator::heartbeat() const {
  auto frame = odrive::frame_of(config_.node_id, Command::heartbeat, errors_, std::uint32_t{0});
  frame.data[4] = static_cast<std::uint8_t>(state_);
  frame.data[5] = result_;
  return frame;
}

hal::CanFrame OdriveEmulator::estimates() {
  advance_mechanism_to(now_);
  double travel_m = mechanism_.position_m() - origin_m_;
  if (config_.encoder_resolution_m > 0)
    travel_m = std::round(travel_m / config_.encoder_resolution_m) * config_.encoder_resolution_m;
  const double elapsed_s = hal::seconds(now_ - sampled_at_);
  const double speed_m_s = elapsed_s > 0 ? (travel_m - sampled_m_) / elapsed_s : 0;
  sampled_m_ = travel_m;
  sampled_at_ = now_;
  const auto turns = static_cast<float>(travel_m / config_.travel_per_turn_m);
  return odrive::frame_of(config_.node_id, Command::get_encoder_estimates, shown_turns_.value_or(turns),
                          static_cast<float>(speed_m_s / config_.travel_per_turn_m));
}

hal::CanFrame OdriveEmulator::torques() {
  const double force_N = motor_.force_at_N(hal::seconds(now_));
  const auto torque_Nm = static_cast<float>(force_N / config_.force_per_torque_N_per_Nm);
  return odrive::frame_of(config_.node_id, Command::get_torques, static_cast<float>(input_torque_Nm_),
                          shown_torque_Nm_.value_or(torque_Nm));
}

void OdriveEmulator::post(const hal::CanFrame& frame, hal::Duration delay) { outgoing_.emplace(now_ + delay, frame); }

void OdriveEmulator::flush() {
  while (!outgoing_.empty() && outgoing_.begin()->first <= now_) {
    const hal::CanFrame frame = outgoing_.begin()->second;
    outgoing_.erase(outgoing_.begin());
    if (!silent_) send_(frame, now_);
  }
}

}  // namespace breakaway::odrive_emulator
