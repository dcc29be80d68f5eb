#include "breakaway/cia402/setup_plan.hpp"

#include "breakaway/canopen/pdo.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/pdo_layout.hpp"

namespace breakaway::cia402 {
namespace {

constexpr bool may_be_missing = true;
constexpr bool must_exist = false;

std::uint32_t whole_milliseconds(hal::Duration duration) noexcept {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

}  // namespace

SetupPlan::SetupPlan(std::uint8_t node_id, hal::Duration heartbeat_period, hal::Duration heartbeat_timeout,
                     const canopen::NetworkConfig& network) noexcept {
  read(object::device_type, 0, must_exist);
  read(object::supported_modes, 0, must_exist);
  read(object::rated_current, 0, may_be_missing);
  read(object::rated_torque, 0, must_exist);
  read(object::max_torque, 0, may_be_missing);

  const std::uint32_t master = static_cast<std::uint32_t>(network.node_id) << 16;
  write(object::consumer_heartbeat, 1, 4, master | whole_milliseconds(heartbeat_timeout), may_be_missing);
  write(object::producer_heartbeat, 0, 2, whole_milliseconds(heartbeat_period), must_exist);

  const auto period_us = std::chrono::duration_cast<std::chrono::microseconds>(network.period).count();
  write(object::sync_period, 0, 4, static_cast<std::uint32_t>(period_us), may_be_missing);
  const auto interpolation = interpolation_period(network.period).value_or(InterpolationPeriod{});
  write(object::interpolation_period, 1, 1, interpolation.units, may_be_missing);
  write(object::interpolation_period, 2, 1, static_cast<std::uint8_t>(interpolation.exponent), may_be_missing);

  for (const canopen::PdoMapping& pdo : {command_pdo(node_id), feedback_pdo(node_id)}) {
    for (std::size_t i = 0; i < canopen::remap_step_count(pdo); ++i) {
      const canopen::ObjectWrite step = canopen::remap_step(pdo, i);
      write(step.index, step.subindex, step.size, step.value, must_exist);
    }
  }
  // A drive that hears no command any more, because the cable is cut, say, must not hold its last torque until the
  // heartbeat is missed. Two commands lost in a row are not yet a cut cable.
  write(object::rpdo1_parameter, 5, 2, whole_milliseconds(3 * network.period + std::chrono::microseconds{999}),
        may_be_missing);
  // Losing the master is a malfunction: what the drive then does is not left to its vendor's default.
  write(object::abort_connection_option, 0, 2, 1, may_be_missing);
  write(object::mode, 0, 1, static_cast<std::uint8_t>(Mode::cyclic_torque), must_exist);
}

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

void SetupPlan::add(const SetupStep& step) noexcept {
  if (count_ < steps_.size()) steps_[count_++] = step;
}

}  // namespace breakaway::cia402
