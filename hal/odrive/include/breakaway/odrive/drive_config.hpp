// DriveConfig holds what is one drive's own. What it shares with its bus is in hal::NetworkConfig, and what it shares
// with its axis' controller in hal::AxisScale. check() tells whether the three can be used together.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <string_view>

#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/hal/network_config.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/odrive/messages.hpp"

namespace breakaway::odrive {

// How the loop gets the drive's estimates of position and torque.
enum class Estimates : std::uint8_t {
  cyclic,  // the drive sends them by itself, by its own clock
  polled,  // the loop asks for them once a period
};

template <class Scalar>
struct DriveConfig {
  std::uint8_t node_id = 1;            // 0..62
  Scalar force_per_torque_N_per_Nm{};  // force at the axis for one Nm at the motor (1 / lever), above 0
  Scalar max_torque_Nm{};              // of the motor, above 0
  double counts_per_turn{};            // travel of a turn over encoder_resolution_m, above 0

  // What Set_Limits is told; 0: the drive keeps its own. Either both are given or none.
  float velocity_limit_turns_s = 0;
  float current_limit_A = 0;

  Estimates estimates = Estimates::cyclic;
  hal::Duration estimate_period = std::chrono::milliseconds{1};  // of cyclic estimates

  hal::Duration heartbeat_period = std::chrono::milliseconds{100};  // of the drive's own
  // Silence of heartbeats or estimates for longer is a loss, and may be a reboot.
  hal::Duration heartbeat_timeout = std::chrono::milliseconds{250};

  bool invert_direction = false;  // the drive's positive direction is the axis' negative one
  bool absolute_encoder = false;  // its position means the same after a reboot
  bool home_here = false;         // when it is enabled first, the axis stands at home_counts
  std::int32_t home_counts = 0;
};

// The first field that cannot be used.
enum class DriveConfigError : std::uint8_t {
  none,
  node_id,
  heartbeat_timeout,
  estimate_period,
  period,
  encoder_resolution,
  counts_per_turn,
  force_per_torque,
  max_torque,
  max_force,
  limits,
};

constexpr std::string_view to_string(DriveConfigError error) noexcept {
  switch (error) {
    case DriveConfigError::none:
      return "the drive's configuration can be used";
    case DriveConfigError::node_id:
      return "the drive's node_id must be 0 to 62";
    case DriveConfigError::heartbeat_timeout:
      return "heartbeat_timeout must be longer than the drive's heartbeat_period, and that above 0";
    case DriveConfigError::estimate_period:
      return "estimate_period must be above 0 and at most the loop's period";
    case DriveConfigError::period:
      return "period must be above 0";
    case DriveConfigError::encoder_resolution:
      return "encoder_resolution_m must be a finite number above 0";
    case DriveConfigError::counts_per_turn:
      return "counts_per_turn must be a finite number above 0";
    case DriveConfigError::force_per_torque:
      return "force_per_torque_N_per_Nm must be a finite number above 0";
    case DriveConfigError::max_torque:
      return "max_torque_Nm must be a finite number above 0";
    case DriveConfigError::max_force:
      return "max_force_N must be a finite number above 0";
    case DriveConfigError::limits:
      return "velocity_limit_turns_s and current_limit_A must both be finite numbers above 0, or both be 0";
  }
  return "unknown error";
}

namespace internal {

// Returns false for a NaN, too.
template <class Number>
constexpr bool positive_and_finite(Number value) noexcept {
  return value > 0 && value <= std::numeric_limits<Number>::max();
}

}  // namespace internal

template <class Scalar>
[[nodiscard, gnu::cold]] constexpr DriveConfigError check(const DriveConfig<Scalar>& drive,
                                                          const hal::NetworkConfig& network,
                                                          const hal::AxisScale<Scalar>& scale) noexcept {
  using internal::positive_and_finite;
  constexpr hal::Duration none{};
  if (drive.node_id > most_node_id) return DriveConfigError::node_id;
  if (drive.heartbeat_period <= none || drive.heartbeat_timeout <= drive.heartbeat_period)
    return DriveConfigError::heartbeat_timeout;
  if (network.period <= none) return DriveConfigError::period;
  if (drive.estimates == Estimates::cyclic && (drive.estimate_period <= none || drive.estimate_period > network.period))
    return DriveConfigError::estimate_period;
  if (!positive_and_finite(scale.encoder_resolution_m)) return DriveConfigError::encoder_resolution;
  if (!positive_and_finite(drive.counts_per_turn)) return DriveConfigError::counts_per_turn;
  if (!positive_and_finite(drive.force_per_torque_N_per_Nm)) return DriveConfigError::force_per_torque;
  if (!positive_and_finite(drive.max_torque_Nm)) return DriveConfigError::max_torque;
  if (!positive_and_finite(scale.max_force_N)) return DriveConfigError::max_force;
  const bool no_limits = drive.velocity_limit_turns_s == 0 && drive.current_limit_A == 0;
  if (!no_limits && !(positive_and_finite(drive.velocity_limit_turns_s) && positive_and_finite(drive.current_limit_A)))
    return DriveConfigError::limits;
  return DriveConfigError::none;
}

}  // namespace breakaway::odrive
