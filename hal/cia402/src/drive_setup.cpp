// The set-up of a DriveNode: the transfers of its plan, and what is made of their answers.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/drive_node.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/patience.hpp"
#include "breakaway/cia402/state.hpp"
#include "breakaway/cia402/torque_scale.hpp"

namespace breakaway::cia402 {
namespace {

using canopen::SdoResult;

constexpr std::uint32_t reverses_position = 0x80;  // in 607Eh
constexpr std::uint32_t lowest_position = 0x8000'0000, highest_position = 0x7FFF'FFFF;
// Ends of 607Bh that are 0 both are no range, and one that is 0 makes a range of half the counts of the other.
constexpr std::uint8_t end_is_zero = 1, end_is_widest = 2, half_a_range = end_is_zero | end_is_widest;

// Bit 31 of 1005h says nothing; bit 30 is that of another producer of SYNC.
constexpr std::uint32_t meant_bits(std::uint16_t index) noexcept {
  return index == object::sync_cob_id ? ~canopen::cob_id_invalid : ~std::uint32_t{0};
}

}  // namespace

void DriveNode::begin_configuration(hal::Time now) noexcept {
  enter(SetupPhase::configuring, now);
  known_ = true;
  status_ = SetupStatus::in_progress;
  drop_transfer();
  heartbeat_.stop();
  nmt_command_.reset();
  error_code_wanted_ = false;
  error_code_ = 0;
  restarts_ = leaves_ = false;
  position_factor_ = {};
  position_ends_ = 0;
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
  if (result == SdoResult::aborted && may_pass(sdo_.abort_code()) && refusals_ < most_refusals) {
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
  if (step.kind == SetupStep::Kind::note) recalls_ = answered && shows_value_of(step);
  if (step.kind == SetupStep::Kind::recall && on_recalled(answered && shows_value_of(step), now))
    return begin_start(now);
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

// A drive that lost what it was set up with has booted, though nobody heard that. Returns true where all that it needs
// is to be started again.
bool DriveNode::on_recalled(bool as_it_was, hal::Time now) noexcept {
  if (recalls_ && !as_it_was) on_boot();
  restarts_ = restarts_ && recalls_;
  if (restarts_)
    heartbeat_.start(now);
  else
    rating_ = {.found_max_torque_per_mille = rating_.found_max_torque_per_mille};
  return restarts_;
}

bool DriveNode::holds(const SetupStep& step) const noexcept {
  return (step.kind != SetupStep::Kind::check && step.kind != SetupStep::Kind::confirm) || shows_value_of(step);
}

bool DriveNode::shows_value_of(const SetupStep& step) const noexcept {
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

void DriveNode::be_patient() noexcept {
  patience_ = grown(patience_);
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
      position_ends_ |= value == 0 ? end_is_zero : end_is_widest;
      if ((value != 0 && value != lowest_position && value != highest_position) || position_ends_ == half_a_range)
        refuse(SetupStatus::position_wraps);
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

}  // namespace breakaway::cia402
