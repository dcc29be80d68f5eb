#include "breakaway/cia402/drive_node.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/patience.hpp"
#include "breakaway/cia402/state.hpp"

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
    leaves_ = false;
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

// What it was set up with is gone.
void DriveNode::on_boot() noexcept {
  if (known_) ++reboots_;
  rating_ = {};
  recalls_ = false;
}

// The word may be another node's of the same id. Until an answer shows that the drive is new, its PDO tells it, too, to
// be without force.
void DriveNode::on_boot_up(hal::Time now) noexcept {
  const bool operated = operational() || restarts();
  on_boot();
  if (held() || forcing_stop()) {
    enter_held(now);
  } else {
    begin_configuration(now);
    restarts_ = operated;
  }
  // A node that starts by itself would refuse to have its PDOs mapped.
  nmt_command_ = NmtCommand::enter_pre_operational;
}

void DriveNode::enter(SetupPhase phase, hal::Time now) noexcept {
  phase_ = phase;
  since_ = now;
  last_command_.reset();
  last_poll_.reset();
  boot_time_ = boot_time;
  look_patience_ = usual_patience();
}

void DriveNode::drop_transfer() noexcept {
  sdo_.cancel();
  transfer_running_ = false;
}

void DriveNode::refuse(SetupStatus status) noexcept {
  phase_ = SetupPhase::refused;
  status_ = status;
  abort_code_ = sdo_.abort_code();
}

// A node that was up before us is taken back to Pre-operational, one that says nothing is made to say its boot-up. What
// a node said before it was told something is no sign that it is still there: it may have rebooted unheard, and a node
// that boots without heartbeats says nothing more.
void DriveNode::wait_for_node(hal::Time now) noexcept {
  const std::optional<NmtState> state = heartbeat_.state();
  // What booted while it was held says no more before it is told how often.
  if (state == NmtState::pre_operational || state == NmtState::boot_up) return begin_configuration(now);
  const bool heard = state.has_value(), boots = last_command_ && !heard;
  const hal::Duration waited = now - last_command_.value_or(*since_);
  const bool at_once = heard && !last_command_;
  if (last_command_) {
    if (!answers_)
      ask_again(now);
    else
      look_now_and_then(now);
  }
  if (!at_once && waited < (boots ? boot_time : heartbeat_timeout_)) return;
  // Some nodes say no boot-up, but answer.
  if (reset_told_ && !heard && answers_) return on_boot_up(now);
  if (boots && waited < boot_time_) return;
  tell_while_waiting(heard ? NmtCommand::enter_pre_operational : NmtCommand::reset_communication, now);
}

void DriveNode::tell_while_waiting(NmtCommand command, hal::Time now) noexcept {
  nmt_command_ = command;
  if (last_command_) boot_time_ = std::min<hal::Duration>(2 * boot_time_, longest_boot_time);
  last_command_ = now;
  reset_told_ = command == NmtCommand::reset_communication;
  answers_ = false;
  heartbeat_.forget_state();
  switch_off();
}

// Not every drive leaves Operation enabled with NMT operational, and until it says that it did its heartbeat may take
// its time. Nobody waits for the answer. What is told while a node boots is lost, so it is told often: the answer of
// one that is slow is taken for the newest.
void DriveNode::switch_off() noexcept {
  constexpr std::array<std::uint8_t, 2> disable_voltage{};
  drop_transfer();
  sdo_.set_timeout(boot_time_ > boot_time ? grown(sdo_timeout_) : sdo_timeout_);
  static_cast<void>(sdo_.start_write(object::controlword, 0, disable_voltage));
}

// The controlword, until it is answered, be it by a refusal.
void DriveNode::ask_again(hal::Time now) noexcept {
  const SdoResult result = sdo_.poll(now);
  answers_ = result == SdoResult::done || result == SdoResult::aborted;
  if (result == SdoResult::timeout) switch_off();
}

void DriveNode::begin_start(hal::Time now) noexcept {
  enter(SetupPhase::starting, now);
  mode_ = Mode::cyclic_torque;
  setup_object_ = {};
  heartbeat_.forget_state();  // only a state heard after the command counts
}

void DriveNode::start_node(hal::Time now) noexcept {
  if (!is_looking(now)) look(object::statusword);
  if (heartbeat_.state() == NmtState::operational) {
    drop_transfer();
    enter(SetupPhase::verifying_mode, now);
    last_mode_request_ = now;
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
  if (!transfer_running_) on_look(result, now);
  return transfer_running_;
}

// One that does not answer may be in NMT Stopped, where it hears no SDO and keeps what force it has. A drive that has
// no 6041h to be read is quiet as far as anybody can know. The state of one that was forced to a stop says little
// beside torque.
void DriveNode::on_look(SdoResult result, hal::Time now) noexcept {
  const bool done = result == SdoResult::done;
  if (looks_at_torque_) {
    const bool no_torque = forced_stop_.shows_no_torque(sdo_, result, now);
    if (done && !no_torque) return force_stop(now);
    return end_look(result, no_torque && quiet_state_);
  }
  if (done) on_value_read(object::statusword);
  quiet_state_ = done ? statusword_ && shows_no_force(*statusword_) : forced_stop_.is_refused(sdo_, result, now);
  const bool nothing_against_it = quiet_state_ || result == SdoResult::aborted;
  if (nothing_against_it && (held() || quietens()) && forced_stop_.reads_torque()) return look(object::torque_actual);
  end_look(result, quiet_state_);
}

void DriveNode::end_look(SdoResult result, bool quiet) noexcept {
  if (quiet && looks_wanted_ > 0) --looks_wanted_;
  look_patience_ = result == SdoResult::timeout ? grown(look_patience_) : usual_patience();
  if (result != SdoResult::timeout) return;
  if (held() || phase_ == SetupPhase::refused) nmt_command_ = NmtCommand::enter_pre_operational;
}

void DriveNode::look(std::uint16_t index) noexcept {
  sdo_.set_timeout(look_patience_);
  looks_at_torque_ = index == object::torque_actual;
  transfer_running_ = sdo_.start_read(index, 0) == canopen::SdoStart::started;
}

// Whoever else leads it may start it again.
void DriveNode::hold(hal::Time now) noexcept {
  if (heartbeat_.state() == NmtState::operational || heartbeat_.state() == NmtState::stopped) {
    nmt_command_ = NmtCommand::enter_pre_operational;
    heartbeat_.forget_state();
  }
  look_now_and_then(now);
}

// At a drive that is of no use to us, too, which nobody keeps busy for ever.
void DriveNode::look_now_and_then(hal::Time now) noexcept {
  if (is_looking(now) || forcing_stop() || (last_poll_ && now - *last_poll_ < poll_time)) return;
  last_poll_ = now;
  look(object::statusword);
}

// It may have booted unheard. In NMT Stopped it could not be asked.
bool DriveNode::stopped_operating(hal::Time now) noexcept {
  if (heartbeat_.state() == NmtState::operational) return false;
  begin_configuration(now);
  restarts_ = true;
  nmt_command_ = NmtCommand::enter_pre_operational;
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
  mode_write_ = !mode_write_ && now - last_mode_request_ >= mode_request_time;
  if (mode_write_) last_mode_request_ = now;
  start_transfer(mode_write_ ? write_mode(mode_) : read_mode);
}

void DriveNode::on_mode_transfer(SdoResult result, hal::Time now) noexcept {
  if (!mode_write_ && result == SdoResult::done &&
      canopen::load_little_endian<std::int8_t>(sdo_.data()) == static_cast<std::int8_t>(mode_)) {
    enter(SetupPhase::ready, now);
    status_ = SetupStatus::ready;
    setup_object_ = {};
    looks_wanted_ = 0;
  } else if (!mode_write_ && now - *since_ > mode_timeout) {
    refuse(mode_ == Mode::homing ? SetupStatus::no_homing_mode : SetupStatus::mode_refused);
  }
}

void DriveNode::select_mode(Mode mode, hal::Time now) noexcept {
  if (!ready()) return;
  drop_transfer();
  enter(SetupPhase::verifying_mode, now);
  status_ = SetupStatus::in_progress;
  mode_ = mode;
  last_mode_request_ = now - mode_request_time;
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
  refused_for_ = phase_ == SetupPhase::refused ? std::optional{status_} : std::nullopt;
  enter(SetupPhase::forcing_stop, now);
  status_ = SetupStatus::stop_not_obeyed;
  drop_transfer();
  if (looks_wanted_ > 0) return forced_stop_.resume(sdo_, now);
  forced_stop_.begin(sdo_, usual_patience(), now);
}

void DriveNode::update_forced_stop(hal::Time now) noexcept {
  if (forced_stop_.update(sdo_, now)) return end_forced_stop(now);
  if (const auto command = forced_stop_.take_command()) nmt_command_ = command;
}

void DriveNode::on_quiet_pdo(hal::Time now) noexcept {
  if (forcing_stop() && operational()) end_forced_stop(now);
}

void DriveNode::end_forced_stop(hal::Time now) noexcept {
  enter_held(now);
  if (!refused_for_) return;
  phase_ = SetupPhase::refused;
  status_ = *refused_for_;
}

// Somebody else led it, and would again as soon as its PDOs pass.
void DriveNode::enter_held(hal::Time now) noexcept {
  drop_transfer();
  heartbeat_.stop();
  heartbeat_.forget_state();
  enter(SetupPhase::held, now);
  looks_wanted_ = quiet_looks;
  nmt_command_ = NmtCommand::enter_pre_operational;
}

// Of several drives one a period is told. One that heard no PDO until then would miss it.
void DriveNode::set_up_anew(hal::Time now) noexcept {
  leaves_ = operational();
  drop_transfer();
  nmt_command_.reset();
  enter(SetupPhase::waiting, now);
  status_ = SetupStatus::in_progress;
}

void DriveNode::forget_errors() noexcept {
  emcy_.forget();
  error_code_ = 0;
  error_code_wanted_ = false;
}

}  // namespace breakaway::cia402
