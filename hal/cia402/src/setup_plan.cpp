#include "breakaway/cia402/setup_plan.hpp"

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/pdo.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/pdo_layout.hpp"
#include "breakaway/cia402/state.hpp"

namespace breakaway::cia402 {
namespace {

constexpr bool may_be_missing = true;
constexpr bool must_exist = false;

std::uint32_t whole_milliseconds(hal::Duration duration) noexcept {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

}  // namespace

SetupPlan::SetupPlan(std::uint8_t node_id, hal::Duration heartbeat_period, hal::Duration heartbeat_timeout,
                     const hal::NetworkConfig& network) noexcept {
  const std::uint32_t master = static_cast<std::uint32_t>(network.node_id) << 16;
  const std::uint32_t consumer_heartbeat = master | whole_milliseconds(heartbeat_timeout);
  take_force_off();
  // Who its master is and for how long it may be silent a drive knows from its set-up alone, unless somebody saved it.
  read_again(SetupStep::Kind::recall, consumer_heartbeat);
  read_rating();
  look();
  bound_force();
  look();

  write(object::consumer_heartbeat, 1, 4, consumer_heartbeat, may_be_missing);
  read_again(SetupStep::Kind::note, consumer_heartbeat);
  write(object::producer_heartbeat, 0, 2, whole_milliseconds(heartbeat_period), must_exist);
  add_clock(network);

  for (const canopen::PdoMapping& pdo : {command_pdo(node_id), feedback_pdo(node_id)}) {
    for (std::size_t i = 0; i < canopen::remap_step_count(pdo); ++i) {
      const canopen::ObjectWrite step = canopen::remap_step(pdo, i);
      write(step.index, step.subindex, step.size, step.value, must_exist);
    }
    look();
  }
  // A drive that hears no command any more, because the cable is cut, say, must not hold its last torque until the
  // heartbeat is missed. Two commands lost in a row are not yet a cut cable, and the one after them may come later
  // than three periods by what bits are stuffed into it: so the deadline is longer, by the least that can be told.
  write(object::rpdo1_parameter, 5, 2, whole_milliseconds(3 * network.period + std::chrono::milliseconds{1}),
        may_be_missing);
  // Losing the master is a malfunction: what the drive then does is not left to its vendor's default.
  write(object::abort_connection_option, 0, 2, 1, may_be_missing);
}

// A drive takes what it is not told from its own set-up. Where home is must be as the file says.
void SetupPlan::add_homing(const HomingConfig& homing, bool inverted) noexcept {
  write(object::homing_method, 0, 1, static_cast<std::uint8_t>(homing.method), must_exist);
  if (homing.search_counts_s != 0) write(object::homing_speeds, 1, 4, homing.search_counts_s, must_exist);
  if (homing.zero_counts_s != 0) write(object::homing_speeds, 2, 4, homing.zero_counts_s, must_exist);
  if (homing.acceleration_counts_s2 != 0)
    write(object::homing_acceleration, 0, 4, homing.acceleration_counts_s2, must_exist);
  const auto position = static_cast<std::uint32_t>(homing.position_counts);
  write(object::home_offset, 0, 4, inverted ? 0U - position : position, homing.position_counts == 0);
  read_back(SetupStep::Kind::confirm);
  look();
}

void SetupPlan::add_mode() noexcept {
  write(object::mode, 0, 1, static_cast<std::uint8_t>(Mode::cyclic_torque), must_exist);
}

void SetupPlan::take_force_off() noexcept {
  write(object::controlword, 0, 2, control::disable_voltage, may_be_missing);
  write(object::target_torque, 0, 2, 0, may_be_missing);
  look();
}

void SetupPlan::read_again(SetupStep::Kind kind, std::uint32_t consumer_heartbeat) noexcept {
  add({.kind = kind,
       .optional = may_be_missing,
       .index = object::consumer_heartbeat,
       .subindex = 1,
       .value = consumer_heartbeat});
}

void SetupPlan::read_rating() noexcept {
  read(object::device_type, 0, must_exist);
  read(object::supported_modes, 0, must_exist);
  read(object::rated_current, 0, may_be_missing);
  read(object::rated_torque, 0, must_exist);
  read(object::max_torque, 0, may_be_missing);
  read(object::polarity, 0, may_be_missing);
  read(object::position_range, 1, may_be_missing);
  read(object::position_range, 2, may_be_missing);
  // DriveNode judges them when the last was asked for.
  for (const std::uint16_t index : {object::encoder_resolution, object::gear_ratio, object::feed_constant}) {
    read(index, 1, may_be_missing);
    read(index, 2, may_be_missing);
  }
}

void SetupPlan::bound_force() noexcept {
  // Force that is added to what is commanded.
  write(object::torque_offset, 0, 2, 0, may_be_missing);
  read_back(SetupStep::Kind::check);
  // The value is the axis' limit, which takes the rating to know; DriveNode puts it in.
  write(object::max_torque, 0, 2, 0, may_be_missing);
  read(object::max_torque, 0, may_be_missing);
  // However a stop begins, the drive function is switched off: a ramp would be force that nobody commanded.
  for (const std::uint16_t option :
       {object::quick_stop_option, object::shutdown_option, object::disable_option, object::fault_reaction_option}) {
    write(option, 0, 2, disable_drive_function, may_be_missing);
    read_back(SetupStep::Kind::confirm);
  }
}

void SetupPlan::add_clock(const hal::NetworkConfig& network) noexcept {
  // A drive that listens for another SYNC would never act.
  write(object::sync_cob_id, 0, 4, canopen::sync_cob_id, may_be_missing);
  read_back(SetupStep::Kind::check);
  const auto period_us = std::chrono::duration_cast<std::chrono::microseconds>(network.period).count();
  write(object::sync_period, 0, 4, static_cast<std::uint32_t>(period_us), may_be_missing);
  // A window that somebody set would have commands dropped that come before their SYNC.
  write(object::sync_window, 0, 4, 0, may_be_missing);
  const auto interpolation = interpolation_period(network.period).value_or(InterpolationPeriod{});
  write(object::interpolation_period, 1, 1, interpolation.units, may_be_missing);
  write(object::interpolation_period, 2, 1, static_cast<std::uint8_t>(interpolation.exponent), may_be_missing);
}

void SetupPlan::look() noexcept { read(object::statusword, 0, may_be_missing); }

void SetupPlan::read(std::uint16_t index, std::uint8_t subindex, bool optional) noexcept {
  add({.kind = SetupStep::Kind::read, .optional = optional, .index = index, .subindex = subindex});
}

void SetupPlan::write(std::uint16_t index, std::uint8_t subindex, std::uint8_t size, std::uint32_t value,
                      bool optional) noexcept {
  add({.kind = SetupStep::Kind::write,
       .optional = optional,
       .index = index,
       .subindex = subindex,
       .size = size,
       .value = value});
}

// Of what was written last.
void SetupPlan::read_back(SetupStep::Kind kind) noexcept {
  SetupStep step = steps_[count_ - 1];
  step.kind = kind;
  add(step);
}

void SetupPlan::add(const SetupStep& step) noexcept {
  if (count_ < steps_.size()) steps_[count_++] = step;
}

}  // namespace breakaway::cia402
