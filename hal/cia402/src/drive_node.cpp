#include "breakaway/cia402/drive_node.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/state.hpp"
#include "breakaway/cia402/torque_scale.hpp"

namespace breakaway::cia402 {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;
using canopen::SdoResult;

constexpr SetupStep read_mode{.kind = SetupStep::Kind::read, .index = object::mode_display};
constexpr SetupStep read_error_code{.kind = SetupStep::Kind::read, .index = object::error_code};
constexpr SetupStep write_mode(Mode mode) noexcept {
  return {.kind = SetupStep::Kind::write,
          .index = object::mode,
          .size = 1,
          .value = static_cast<std::uint32_t>(static_cast<std::uint8_t>(mode))};
}

constexpr std::uint32_t reverses_position = 0x80;  // in 607Eh
constexpr std::uint32_t lowest_position = 0x8000'0000, highest_position = 0x7FFF'FFFF;

// Bit 31 of 1005h says nothing; bit 30 is that of another producer of SYNC.
constexpr std::uint32_t meant_bits(std::uint16_t index) noexcept {
  return index == object::sync_cob_id ? ~canopen::cob_id_invalid : ~std::uint32_t{0};
}

}  // namespace

void DriveNode::on_frame(const hal::ReceivedFrame& received, const canopen::EmcyCodes& information) noexcept {
  heartbeat_.on_frame(received.frame, received.time);
  emcy_.on_frame(received.frame, information);
  sdo_.on_frame(received.frame);
}

bool DriveNode::next_frame(hal::CanFrame& frame, hal::Time now) noexcept {
  if (!config_valid_) return false;
  if (nmt_command_) {
    frame = canopen::nmt_frame(*nmt_command_, node_id_);
    nmt_command_.reset();
    return true;
  }
  return sdo_.next_frame(frame, now);
}

void DriveNode::update(hal::Time now) noexcept {
  if (!config_valid_) return;
  if (!since_) {
    since_ = now;
    switch_off();
  }
  heartbeat_.update(now);
  if (heartbeat_.take_boot_up()) on_boot_up(now);
  switch (phase_) {
    case SetupPhase::waiting:
      return wait_for_node(now);
    case SetupPhase::configuring:
      return configure(now);
    case SetupPhase::starting:
      return start_node(now);
    case SetupPhase::verifying_mode:
      return verify_mode(now);
    case SetupPhase::ready:
      return watch(now);
    case SetupPhase::forcing_stop:
      return update_forced_stop(now);
    case SetupPhase::held:
      return hold(now);
    case SetupPhase::refused:
      return look_now_and_then(now);
  }
}

void DriveNode::on_boot_up(hal::Time now) noexcept {
  if (known_) ++reboots_;
  rating_ = {};
  if (held() || forcing_stop())
    enter_held(now);
  else
    begin_configuration(now);
  // A node that starts by itself would refuse to have its PDOs mapped.
  nmt_command_ = NmtCommand::enter_pre_operational;
}

void DriveNode::enter(SetupPhase phase, hal::Time now) noexcept {
  phase_ = phase;
  since_ = now;
  last_command_.reset();
}

void DriveNode::refuse(SetupStatus status) noexcept {
  phase_ = SetupPhase::refused;
  status_ = status;
  abort_code_ = sdo_.abort_code();
  transfer_running_ = false;
  last_poll_.reset();
}

// A node that was up before us is taken back to Pre-operational, one that says nothing is made to say its boot-up. What
// a node said before it was told something is no sign that it is still there: it may have rebooted unheard, and a node
// that boots without heartbeats says nothing more.
void DriveNode::wait_for_node(hal::Time now) noexcept {
  const std::optional<NmtState> state = heartbeat_.state();
  // What booted while it was held says no more before it is told how often.
  if (state == NmtState::pre_operational || state == NmtState::boot_up) return begin_configuration(now);
  const bool heard = state.has_value();
  const hal::Duration patience = last_command_ && !heard ? boot_time : heartbeat_timeout_;
  const bool at_once = heard && !last_command_;
  if (last_command_) {
    if (!answers_)
      ask_again(now);
    else
      look_now_and_then(now);
  }
  if (!at_once && now - last_command_.value_or(*since_) < patience) return;
  // Some nodes say no boot-up, but answer.
  if (reset_told_ && !heard && answers_) return on_boot_up(now);
  tell_while_waiting(heard ? NmtCommand::enter_pre_operational : NmtCommand::reset_communication, now);
}

void DriveNode::tell_while_waiting(NmtCommand command, hal::Time now) noexcept {
  nmt_command_ = command;
  last_command_ = now;
  reset_told_ = command == NmtCommand::reset_communication;
  answers_ = transfer_running_ = false;
  heartbeat_.forget_state();
  switch_off();
}

// Not every drive leaves Operation enabled with NMT operational, and until it says that it did its heartbeat may take
// its time. Nobody waits for the answer.
void DriveNode::switch_off() noexcept {
  constexpr std::array<std::uint8_t, 2> disable_voltage{};
  sdo_.cancel();
  sdo_.set_timeout(usual_patience());
  static_cast<void>(sdo_.start_write(object::controlword, 0, disable_voltage));
}

// The controlword, until it is answered, be it by a refusal.
void DriveNode::ask_again(hal::Time now) noexcept {
  const SdoResult result = sdo_.poll(now);
  answers_ = result == SdoResult::done || result == SdoResult::aborted;
  if (result == SdoResult::timeout) switch_off();
}

void DriveNode::begin_configuration(hal::Time now) noexcept {
  enter(SetupPhase::configuring, now);
  known_ = true;
  status_ = SetupStatus::in_progress;
  sdo_.cancel();
  heartbeat_.stop();
  nmt_command_.reset();
  transfer_running_ = false;
  error_code_wanted_ = false;
  error_code_ = 0;
  position_factor_ = {};
  rating_ = {.found_max_torque_per_mille = rating_.found_max_torque_per_mille};
  step_ = 0;
  fixed_mapping_ = 0;
  attempts_ = 0;
  refusals_ = 0;
  pause_end_ = now;
  sdo_.set_timeout(patience_);
}

void DriveNode::configure(hal::Time now) noexcept {
  const SetupStep step = current_step();
  if (now < pause_end_) return;
  if (!transfer_running_) return start_transfer(step);
  const SdoResult result = sdo_.poll(now);
  if (result == SdoResult::busy) return;
  transfer_running_ = false;
  const bool answered = result == SdoResult::done;
  if (may_pass(result)) {
    ++refusals_;
    pause_end_ = now + refusal_pause;
    return;
  }
  const bool fixed = result == SdoResult::aborted && clears_mapping(step);
  if (fixed) fixed_mapping_ = step.index;
  if (answered || fixed || (step.optional && result == SdoResult::aborted))
    on_step_done(step, answered, now);
  else
    on_step_failed(result, now);
  if (phase_ == SetupPhase::configuring) start_transfer(current_step());
}

// A PDO whose mapping cannot be changed must have what would be mapped.
SetupStep DriveNode::current_step() const noexcept {
  SetupStep step = plan_.steps()[step_];
  if (step.index == fixed_mapping_) step.kind = SetupStep::Kind::check;
  return step;
}

bool DriveNode::clears_mapping(const SetupStep& step) noexcept {
  const bool mapping = step.index == object::rpdo1_mapping || step.index == object::tpdo1_mapping;
  return mapping && step.kind == SetupStep::Kind::write && step.subindex == 0 && step.value == 0;
}

void DriveNode::start_transfer(const SetupStep& step) noexcept {
  setup_object_ = {step.index, step.subindex};
  std::array<std::uint8_t, 4> bytes{};
  canopen::store_little_endian(
      bytes, step.index == object::max_torque ? torque_limit_per_mille(rating_.max_torque_per_mille) : step.value);
  const canopen::SdoStart started = step.kind == SetupStep::Kind::write
                                        ? sdo_.start_write(step.index, step.subindex, std::span{bytes}.first(step.size))
                                        : sdo_.start_read(step.index, step.subindex);
  transfer_running_ = started == canopen::SdoStart::started;
}

void DriveNode::on_step_done(const SetupStep& step, bool answered, hal::Time now) noexcept {
  attempts_ = 0;
  is_slow_ = is_slow_ || patience_ > sdo_timeout_;
  if (step.kind == SetupStep::Kind::write) write_taken_ = answered;
  if (step.kind == SetupStep::Kind::read && answered) on_value_read(step.index);
  if (step.index == object::feed_constant && step.subindex == 2) judge_position_factor();
  if (answered && !holds(step)) refuse(SetupStatus::value_not_kept);
  if (phase_ == SetupPhase::refused) return;
  if (step.index == object::producer_heartbeat) heartbeat_.start(now);
  if (step.index == object::statusword && statusword_ && shows_force(*statusword_)) return;  // it is looked at again
  const auto steps = plan_.steps();
  do {
    ++step_;
  } while (step_ < steps.size() && is_needless(steps[step_]));
  if (step_ < steps.size()) return;
  if (torque_base_is_as_designed()) return begin_start(now);
  setup_object_ = {object::max_torque, 0};
  refuse(SetupStatus::torque_base_differs);
}

bool DriveNode::holds(const SetupStep& step) const noexcept {
  if (step.kind != SetupStep::Kind::check && step.kind != SetupStep::Kind::confirm) return true;
  const auto value = canopen::load_little_endian<std::uint32_t>(sdo_.data());
  return ((value ^ step.value) & meant_bits(step.index)) == 0;
}

bool DriveNode::is_needless(const SetupStep& step) const noexcept {
  if (step.kind == SetupStep::Kind::confirm) return !write_taken_;
  return step.kind == SetupStep::Kind::write && step.index == object::max_torque &&
         torque_limit_per_mille(rating_.max_torque_per_mille) >= rating_.max_torque_per_mille;
}

// The axis' limit in the drive's own unit, for a drive whose rating is known. What one step of force already exceeds is
// refused later, with a reason of its own.
std::uint16_t DriveNode::torque_limit_per_mille(std::uint16_t most) const noexcept {
  const TorqueScale<float> scale{rating_.rated_torque_mNm, most, force_per_torque_N_per_Nm_, max_force_N_};
  return static_cast<std::uint16_t>(std::max<std::int16_t>(scale.limit_per_mille(), 1));
}

// Where a target torque counts in per mille of 6072h, the step of force is what the axis was designed for only if 6072h
// is the axis' limit.
bool DriveNode::torque_base_is_as_designed() const noexcept {
  return torque_base_ == TorqueBase::rated ||
         rating_.max_torque_per_mille == torque_limit_per_mille(TorqueScale<float>::highest_per_mille);
}

// Whether a drive may take later what it refuses now: its server is not ready, or somebody else still uses it.
bool DriveNode::may_pass(SdoResult result) const noexcept {
  if (result != SdoResult::aborted || refusals_ == most_refusals) return false;
  switch (sdo_.abort_code()) {
    case canopen::SdoAbort::timeout:
    case canopen::SdoAbort::out_of_memory:
    case canopen::SdoAbort::cannot_store:
    case canopen::SdoAbort::local_control:
    case canopen::SdoAbort::device_state:
      return true;
    default:
      return false;
  }
}

void DriveNode::be_patient() noexcept {
  patience_ = std::max(sdo_timeout_, std::min<hal::Duration>(patience_ * growth_of_patience, longest_patience));
  sdo_.set_timeout(patience_);
}

void DriveNode::on_step_failed(SdoResult result, hal::Time now) noexcept {
  if (result == SdoResult::aborted) return refuse(SetupStatus::object_refused);
  if (result != SdoResult::timeout) return refuse(SetupStatus::protocol_error);
  if (++attempts_ < sdo_attempts) return be_patient();
  patience_ = sdo_timeout_;
  is_slow_ = false;
  enter(SetupPhase::waiting, now);
  heartbeat_.stop();
  heartbeat_.forget_state();
  status_ = SetupStatus::no_answer;
}

void DriveNode::on_value_read(std::uint16_t index) noexcept {
  const auto value = canopen::load_little_endian<std::uint32_t>(sdo_.data());
  switch (index) {
    case object::device_type:
      if ((value & 0xFFFFU) != device_profile) refuse(SetupStatus::not_a_cia402_drive);
      break;
    case object::supported_modes:
      if ((value & supports_cyclic_torque) == 0) return refuse(SetupStatus::no_torque_mode);
      if (homes_ && (value & supports_homing) == 0) refuse(SetupStatus::no_homing_mode);
      break;
    case object::rated_current:
      rating_.rated_current_mA = value;
      break;
    case object::rated_torque:
      on_rated_torque(value);
      break;
    case object::polarity:
      if ((value & reverses_position) != 0) refuse(SetupStatus::position_reversed);
      break;
    case object::position_range:
      if (value != 0 && value != lowest_position && value != highest_position) refuse(SetupStatus::position_wraps);
      break;
    case object::encoder_resolution:
    case object::gear_ratio:
    case object::feed_constant:
      position_factor_.note(setup_object_, value);
      break;
    case object::statusword:
      statusword_ = static_cast<std::uint16_t>(value);
      break;
    case object::max_torque:
      rating_.max_torque_per_mille = static_cast<std::uint16_t>(value);
      rating_.found_max_torque_per_mille = std::max(rating_.found_max_torque_per_mille, rating_.max_torque_per_mille);
      if (rating_.max_torque_per_mille == 0) refuse(SetupStatus::no_max_torque);
      break;
    default:
      break;
  }
}

// A resolution that is coarser than the encoder's is one all the same; one that is finer would be believed, and is not.
void DriveNode::judge_position_factor() noexcept {
  if (position_factor_.is_one_to_one()) return;
  if (!user_position_unit_) return refuse(SetupStatus::position_scaled);
  if (position_factor_.is_finer_than_encoder()) refuse(SetupStatus::position_too_fine);
}

// A factor of a thousand is somebody's unit; the hundredth is for figures that were rounded.
void DriveNode::on_rated_torque(std::uint32_t rated_torque_mNm) noexcept {
  rating_.rated_torque_mNm = rated_torque_mNm;
  if (rated_torque_mNm == 0) return refuse(SetupStatus::no_rated_torque);
  if (rated_torque_mNm_ == 0) return;
  const auto agree = [](std::uint64_t a, std::uint64_t b) {
    return std::max(a, b) - std::min(a, b) <= std::max<std::uint64_t>(std::max(a, b) / 100, 1);
  };
  const std::uint64_t shown = rated_torque_mNm, told = rated_torque_mNm_;
  if (agree(shown, told)) return;
  const bool other_unit = agree(shown, 1000 * told) || agree(1000 * shown, told);
  refuse(other_unit ? SetupStatus::rated_torque_unit : SetupStatus::rated_torque_differs);
}

void DriveNode::begin_start(hal::Time now) noexcept {
  enter(SetupPhase::starting, now);
  restarts_ = false;
  mode_ = Mode::cyclic_torque;
  status_ = SetupStatus::in_progress;
  setup_object_ = {};
  heartbeat_.forget_state();  // only a state heard after the command counts
}

void DriveNode::start_node(hal::Time now) noexcept {
  if (!is_looking(now)) look();
  if (heartbeat_.state() == NmtState::operational) {
    sdo_.cancel();
    transfer_running_ = false;
    enter(SetupPhase::verifying_mode, now);
    last_mode_request_ = now;
    last_poll_.reset();
    return;
  }
  if (now - *since_ > std::max(boot_time, 2 * heartbeat_timeout_)) return set_up_anew(now);
  if (last_command_ && now - *last_command_ < heartbeat_timeout_) return;
  nmt_command_ = NmtCommand::start;
  last_command_ = now;
}

// Reads the statusword, because somebody else may switch the drive on, and no PDO tells of it before the node is
// started. The set-up does not stand at this object. Returns true until it is answered.
bool DriveNode::is_looking(hal::Time now) noexcept {
  if (!transfer_running_) return false;
  const SdoResult result = sdo_.poll(now);
  transfer_running_ = result == SdoResult::busy;
  if (result == SdoResult::done) on_value_read(object::statusword);
  return transfer_running_;
}

void DriveNode::look() noexcept {
  transfer_running_ = sdo_.start_read(object::statusword, 0) == canopen::SdoStart::started;
}

// Whoever else leads it may start it again.
void DriveNode::hold(hal::Time now) noexcept {
  if (heartbeat_.state() == NmtState::operational) {
    nmt_command_ = NmtCommand::enter_pre_operational;
    heartbeat_.forget_state();
  }
  look_now_and_then(now);
}

// At a drive that is of no use to us, too, which nobody keeps busy for ever.
void DriveNode::look_now_and_then(hal::Time now) noexcept {
  if (is_looking(now) || (last_poll_ && now - *last_poll_ < poll_time)) return;
  last_poll_ = now;
  look();
}

bool DriveNode::stopped_operating(hal::Time now) noexcept {
  if (heartbeat_.state() == NmtState::operational) return false;
  sdo_.cancel();
  transfer_running_ = false;
  begin_start(now);
  restarts_ = true;
  return true;
}

void DriveNode::verify_mode(hal::Time now) noexcept {
  if (stopped_operating(now)) return;
  if (transfer_running_) {
    const SdoResult result = sdo_.poll(now);
    if (result == SdoResult::busy) return;
    transfer_running_ = false;
    return on_mode_transfer(result, now);
  }
  if (last_poll_ && now - *last_poll_ < poll_time) return;
  last_poll_ = now;
  mode_write_ = now - last_mode_request_ >= mode_request_time;
  if (mode_write_) last_mode_request_ = now;
  start_transfer(mode_write_ ? write_mode(mode_) : read_mode);
}

void DriveNode::on_mode_transfer(SdoResult result, hal::Time now) noexcept {
  if (!mode_write_ && result == SdoResult::done &&
      canopen::load_little_endian<std::int8_t>(sdo_.data()) == static_cast<std::int8_t>(mode_)) {
    enter(SetupPhase::ready, now);
    status_ = SetupStatus::ready;
    setup_object_ = {};
  } else if (now - *since_ > mode_timeout) {
    setup_object_ = {object::mode_display, 0};
    refuse(mode_ == Mode::homing ? SetupStatus::no_homing_mode : SetupStatus::mode_refused);
  }
}

void DriveNode::select_mode(Mode mode, hal::Time now) noexcept {
  if (!ready()) return;
  sdo_.cancel();
  transfer_running_ = false;
  enter(SetupPhase::verifying_mode, now);
  status_ = SetupStatus::in_progress;
  mode_ = mode;
  last_mode_request_ = now - mode_request_time;
  last_poll_.reset();
}

void DriveNode::watch(hal::Time now) noexcept {
  if (stopped_operating(now)) return;
  if (transfer_running_) {
    const SdoResult result = sdo_.poll(now);
    if (result == SdoResult::busy) return;
    transfer_running_ = false;
    if (result == SdoResult::done) error_code_ = canopen::load_little_endian<std::uint16_t>(sdo_.data());
  } else if (error_code_wanted_) {
    error_code_wanted_ = false;
    start_transfer(read_error_code);
    setup_object_ = {};  // this object is none of the set-up's
  }
}

void DriveNode::force_stop(hal::Time now) noexcept {
  if (!config_valid_ || forcing_stop()) return;
  forced_while_operational_ = operational();
  if (phase_ == SetupPhase::refused)
    refused_for_ = status_;
  else
    refused_for_.reset();
  enter(SetupPhase::forcing_stop, now);
  status_ = SetupStatus::stop_not_obeyed;
  sdo_.cancel();
  sdo_.set_timeout(usual_patience());
  transfer_running_ = false;
  forced_stop_.begin(now);
}

void DriveNode::update_forced_stop(hal::Time now) noexcept {
  if (forced_stop_.update(sdo_, now)) return end_forced_stop(now);
  if (const auto command = forced_stop_.take_command()) nmt_command_ = command;
}

void DriveNode::end_forced_stop(hal::Time now) noexcept {
  if (!forcing_stop()) return;
  enter_held(now);
  if (!refused_for_) return;
  phase_ = SetupPhase::refused;
  status_ = *refused_for_;
}

// Somebody else led it, and would again as soon as its PDOs pass.
void DriveNode::enter_held(hal::Time now) noexcept {
  sdo_.cancel();
  transfer_running_ = false;
  heartbeat_.stop();
  heartbeat_.forget_state();
  last_poll_.reset();
  enter(SetupPhase::held, now);
  status_ = SetupStatus::stop_not_obeyed;
  nmt_command_ = NmtCommand::enter_pre_operational;
}

void DriveNode::set_up_anew(hal::Time now) noexcept {
  sdo_.cancel();
  transfer_running_ = false;
  nmt_command_.reset();
  last_poll_.reset();
  enter(SetupPhase::waiting, now);
  status_ = SetupStatus::in_progress;
}

void DriveNode::forget_errors() noexcept {
  emcy_.forget();
  error_code_ = 0;
  error_code_wanted_ = false;
}

}  // namespace breakaway::cia402
