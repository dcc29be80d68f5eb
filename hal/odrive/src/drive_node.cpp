#include "breakaway/odrive/drive_node.hpp"

#include <algorithm>

namespace breakaway::odrive {
namespace {

// Returns true, and notes the time, when it is the first time or long enough ago.
bool due(std::optional<hal::Time>& last, hal::Duration interval, hal::Time now) noexcept {
  if (last && now - *last < interval) return false;
  last = now;
  return true;
}

bool older(const std::optional<hal::Time>& time, hal::Duration age, hal::Time now) noexcept {
  return !time || now - *time > age;
}

}  // namespace

void DriveNode::on_frame(const hal::ReceivedFrame& received) noexcept {
  if (const auto heartbeat = as_heartbeat(received.frame)) return on_heartbeat(*heartbeat, received.time);
  if (const auto version = as_version(received.frame)) return on_version(*version);
  if (const auto errors = as_errors(received.frame)) on_errors(*errors);
}

void DriveNode::on_heartbeat(const Heartbeat& heartbeat, hal::Time time) noexcept {
  const bool says_so = (heartbeat.errors & error::initializing) != 0;
  if (!says_so) initializing_since_.reset();
  if (says_so && !initializing_since_) initializing_since_ = time;
  const bool initializing = says_so && time - *initializing_since_ <= start_time;
  const bool starts =
      heartbeat.state == AxisState::undefined || heartbeat.state == AxisState::startup_sequence || initializing;
  if (starts && !starting_ && std::exchange(known_, false)) {
    rebooted_ = true;
    restart();
  }
  starting_ = starts;
  heartbeat_time_ = time;
  lost_ = false;
  state_ = heartbeat.state;
  result_ = heartbeat.procedure_result;
  errors_ = initializing ? heartbeat.errors & ~error::initializing : heartbeat.errors;
  const hal::Duration on_its_way = std::max<hal::Duration>(settings_.period, std::chrono::milliseconds{2});
  const bool younger_than_stop = idle_told_at_ && time >= *idle_told_at_ + on_its_way;
  if (!is_without_torque(state_) || younger_than_stop) unsure_ = false;
  if (phase_ == Phase::waiting && !starts) phase_ = Phase::asking;
}

void DriveNode::on_version(Version version) noexcept {
  constexpr std::uint8_t least_minor = 6;
  if (phase_ != Phase::asking) return;
  const bool known = version.major > 0 || version.minor >= least_minor;
  phase_ = known ? Phase::telling : Phase::refused;
  told_ = 0;
}

// The reason of a disarming counts where it is looked for; an old one may be from before.
void DriveNode::on_errors(Errors errors) noexcept {
  const std::uint32_t all = (errors.active | errors.disarm_reason) & ~error::initializing;
  if (explaining_ > 0 && all != 0) stop_for(error_code(all));
}

void DriveNode::stop_for(std::uint16_t code) noexcept {
  if (kept_ == 0) kept_ = code;
  if (new_code_ == 0) new_code_ = code;
  explaining_ = 0;
  request_stop();
}

void DriveNode::fail(OwnFault fault) noexcept {
  if (own_fault_ != OwnFault::none) return;
  own_fault_ = fault;
  stop_for(static_cast<std::uint16_t>(fault));
}

void DriveNode::update(hal::Time now) noexcept {
  // One that is asked for them reports once a period.
  const hal::Duration young = std::max<hal::Duration>(retell_time, 3 * settings_.period);
  const bool reports_torque = gives_torque_ && !older(torque_time_, young, now);
  has_force_ = !is_without_torque(state_) || reports_torque;
  watch_silence(now);
  if (std::exchange(reset_asked_, false)) begin_reset();
  watch_wish();
  watch_stop(now);
  if (phase_ == Phase::listening && !older(estimate_time_, settings_.heartbeat_timeout, now)) {
    phase_ = Phase::ready;
    known_ = true;
  }
}

// A drive that fell silent may have rebooted unheard, and then neither its mode nor its position is what it was. Its
// position may count while it is still set up, and even before its first heartbeat.
void DriveNode::watch_silence(hal::Time now) noexcept {
  const bool silent = older(heartbeat_time_, settings_.heartbeat_timeout, now);
  const bool blind = older(position_time_, boots_within(), now);
  if (((silent && heartbeat_time_) || blind) && std::exchange(known_, false)) rebooted_ = true;
  if (phase_ == Phase::waiting || phase_ == Phase::refused) return;
  if (!silent && !(blind && phase_ == Phase::ready)) return;
  if (silent) lost_ = true;
  request_stop();
  if (!has_force()) restart();
}

// The set-up begins again with the next heartbeat.
void DriveNode::restart() noexcept {
  request_stop();
  phase_ = Phase::waiting;
  estimate_time_.reset();
  version_asked_at_.reset();
}

// An axis that is enabled or on its way has no fault to reset.
void DriveNode::begin_reset() noexcept {
  if (has_force() || wished_) return;
  own_fault_ = OwnFault::none;
  kept_ = new_code_ = 0;
  errors_ = 0;
  lost_ = false;
  clear_wanted_ = true;
  if (phase_ == Phase::refused) restart();
  if (phase_ == Phase::ready) phase_ = Phase::telling;
  told_ = 0;
}

void DriveNode::watch_wish() noexcept {
  if (!wished_) return;
  if (errors_ != 0) return stop_for(error_code(errors_));
  if (state_ == AxisState::closed_loop_control) {
    running_ = true;
    explaining_ = 0;
    return;
  }
  if (!running_) {
    if (attempts_ > enable_attempts && result_ > procedure_cancelled) stop_for(procedure_code(result_));
    return;
  }
  // It left by itself. Not every heartbeat tells why, and then Get_Error does.
  if (explaining_ == 0) {
    explaining_ = explaining_periods;
  } else if (--explaining_ == 0) {
    request_stop();
  }
}

hal::Duration DriveNode::boots_within() const noexcept {
  return std::min(settings_.heartbeat_timeout, std::max<hal::Duration>(boot_time, 10 * settings_.period));
}

hal::Duration DriveNode::obeys_within() const noexcept {
  return settings_.heartbeat_period + std::max(retell_time, 10 * settings_.period);
}

// The heartbeat that shows it may be a period of its own away.
hal::Duration DriveNode::enable_interval() const noexcept {
  return std::max<hal::Duration>(2 * settings_.heartbeat_period, std::chrono::milliseconds{100});
}

void DriveNode::watch_stop(hal::Time now) noexcept {
  if (wished_ || !has_force()) {
    unwished_since_.reset();
    if (std::exchange(forced_, false)) restart();
    return;
  }
  if (!unwished_since_) unwished_since_ = now;
  if (now - *unwished_since_ > obeys_within()) forced_ = true;
}

SetupStatus DriveNode::status() const noexcept {
  if (forced_) return SetupStatus::stop_not_obeyed;
  switch (phase_) {
    case Phase::waiting:
      return starting_ && !lost_ ? SetupStatus::starting : SetupStatus::no_heartbeat;
    case Phase::asking:
      return SetupStatus::no_version;
    case Phase::telling:
      return SetupStatus::being_told;
    case Phase::listening:
      return SetupStatus::no_estimates;
    case Phase::ready:
      return SetupStatus::ready;
    case Phase::refused:
      return SetupStatus::firmware_too_old;
  }
  return SetupStatus::no_heartbeat;
}

bool DriveNode::next_frame(hal::CanFrame& frame, hal::Time now) noexcept {
  // Reports of torque come sooner than heartbeats, and where those are switched off they are all that tells of it.
  if (has_force() && !wished_) return next_stop_frame(frame, now) || next_question(frame, now);
  if (!heartbeat_time_) return false;
  if (phase_ != Phase::waiting && std::exchange(clear_wanted_, false)) {
    frame = clear_errors_frame(settings_.node_id);
    return true;
  }
  return next_setup_frame(frame, now) || next_enable_frame(frame, now) || next_question(frame, now);
}

bool DriveNode::next_stop_frame(hal::CanFrame& frame, hal::Time now) noexcept {
  if (!due(told_at_, retell_time, now)) return false;
  if (forced_ && std::exchange(estop_next_, !estop_next_)) {
    frame = estop_frame(settings_.node_id);
    return true;
  }
  // A heartbeat that comes between tellings is as good: only before the first may one show what was before the
  // enabling.
  if (!idle_told_at_) idle_told_at_ = now;
  frame = axis_state_frame(settings_.node_id, AxisState::idle);
  return true;
}

bool DriveNode::next_setup_frame(hal::CanFrame& frame, hal::Time now) noexcept {
  if (phase_ == Phase::asking && due(version_asked_at_, version_time, now)) {
    frame = request_frame(settings_.node_id, Command::get_version);
    return true;
  }
  if (phase_ != Phase::telling) return false;
  const bool mode = told_++ == 0;
  const bool limited = settings_.current_limit_A > 0;
  if (!mode || !limited) phase_ = Phase::listening;
  frame = mode ? torque_mode_frame(settings_.node_id)
               : limits_frame(settings_.node_id, settings_.velocity_limit_turns_s, settings_.current_limit_A);
  return true;
}

// The mode is told again before each attempt, because nothing shows that it was taken.
bool DriveNode::next_enable_frame(hal::CanFrame& frame, hal::Time now) noexcept {
  if (!wished_ || running_) return false;
  if (told_ == 0) {
    if (!due(told_at_, enable_interval(), now)) return false;
    told_ = 1;
    ++attempts_;
    frame = torque_mode_frame(settings_.node_id);
    return true;
  }
  told_ = 0;
  unsure_ = true;
  idle_told_at_.reset();
  frame = axis_state_frame(settings_.node_id, AxisState::closed_loop_control);
  return true;
}

bool DriveNode::next_question(hal::CanFrame& frame, hal::Time now) noexcept {
  if (explaining_ > 0) {
    frame = request_frame(settings_.node_id, Command::get_error);
    return true;
  }
  const bool waits_for_state = wished_ && !running_;
  if (!settings_.polled && !waits_for_state) return false;
  if (!due(asked_at_, poll_time, now)) return false;
  frame = request_frame(settings_.node_id, Command::heartbeat);
  return true;
}

}  // namespace breakaway::odrive
