// DriveConfig holds what is one drive's own. What a drive shares with the other nodes on its bus is in
// hal::NetworkConfig, and what it shares with its axis' controller is in hal::AxisScale. check() tells whether the
// three can be used together.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/emcy.hpp"
#include "breakaway/cia402/homing_config.hpp"
#include "breakaway/cia402/torque_scale.hpp"
#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/hal/network_config.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

template <class Scalar>
struct DriveConfig {
  std::uint8_t node_id = 1;            // 1..127, and not the master's
  Scalar force_per_torque_N_per_Nm{};  // force at the axis for one Nm at the motor (1 / lever), above 0

  // What 6076h must show, to a hundredth; 0: whatever it shows is taken.
  std::uint32_t rated_torque_mNm = 0;

  hal::Duration heartbeat_period = std::chrono::milliseconds{100};  // of the drive's own, 1..65535 ms
  // Drive and master each take the other for lost after so long without a heartbeat. It is longer than the period of
  // either, and at most 65535 ms.
  hal::Duration heartbeat_timeout = std::chrono::milliseconds{250};
  hal::Duration sdo_timeout = std::chrono::milliseconds{50};  // for a single answer, above 0

  // What the drive counts a target torque (6071h) in. Nothing that can be read tells before the drive gives torque.
  TorqueBase torque_base = TorqueBase::rated;
  // The drive may scale its position (608Fh, 6091h, 6092h): encoder_resolution_m is then the travel of a unit of 6064h.
  bool user_position_unit = false;
  bool invert_direction = false;  // the drive's positive direction is the axis' negative one
  bool absolute_encoder = false;  // its counts mean the same after a reboot
  HomingConfig homing{};          // of an encoder that is not absolute
  // EMCY messages with one of these codes are information, and stop nothing. The drive's own state Fault does all the
  // same.
  canopen::EmcyCodes emcy_information{};
};

// The period of SYNC as 60C2h wants it: units x 10^exponent seconds.
struct InterpolationPeriod {
  std::uint8_t units = 0;
  std::int8_t exponent = 0;  // -6..0

  friend constexpr bool operator==(InterpolationPeriod, InterpolationPeriod) = default;
};

// Finds the pair that says the period exactly, or nothing. Whole milliseconds have exponent -3 where they fit, because
// some drives accept no other.
constexpr std::optional<InterpolationPeriod> interpolation_period(hal::Duration period) noexcept {
  if (period <= hal::Duration::zero()) return std::nullopt;
  const auto in_units_of = [period](hal::Duration unit) {
    return period % unit == hal::Duration::zero() ? period / unit : 0;
  };
  hal::Duration unit = std::chrono::milliseconds{1};
  for (std::int8_t exponent = -3; exponent >= -6; --exponent, unit /= 10)
    if (const auto units = in_units_of(unit); units >= 1 && units <= 255)
      return InterpolationPeriod{static_cast<std::uint8_t>(units), exponent};
  unit = std::chrono::milliseconds{10};
  for (std::int8_t exponent = -2; exponent <= 0; ++exponent, unit *= 10)
    if (const auto units = in_units_of(unit); units >= 1 && units <= 255)
      return InterpolationPeriod{static_cast<std::uint8_t>(units), exponent};
  return std::nullopt;
}

// The first field that cannot be used.
enum class DriveConfigError : std::uint8_t {
  none,
  node_id,
  master_node_id,
  heartbeat_period,
  heartbeat_timeout,
  master_heartbeat_period,
  sdo_timeout,
  homing_timeout,
  emcy_information,
  period,
  encoder_resolution,
  force_per_torque,
  max_force,
};

constexpr std::string_view to_string(DriveConfigError error) noexcept {
  switch (error) {
    case DriveConfigError::none:
      return "the drive's configuration can be used";
    case DriveConfigError::node_id:
      return "the drive's node_id must be 1 to 127";
    case DriveConfigError::master_node_id:
      return "the master's node_id must be 1 to 127 and another than the drive's";
    case DriveConfigError::heartbeat_period:
      return "the drive's heartbeat_period must be 1 to 65535 ms";
    case DriveConfigError::heartbeat_timeout:
      return "heartbeat_timeout must be longer than the drive's and the master's heartbeat_period, and at most 65535 "
             "ms";
    case DriveConfigError::master_heartbeat_period:
      return "the master's heartbeat_period must be 0 or at least two periods: a heartbeat takes the place of an SDO "
             "or NMT frame";
    case DriveConfigError::sdo_timeout:
      return "sdo_timeout must be above 0";
    case DriveConfigError::homing_timeout:
      return "homing.timeout must be above 0";
    case DriveConfigError::emcy_information:
      return "emcy_information must hold codes of 0100h to FFFFh, each alone or the 256 of its class";
    case DriveConfigError::period:
      return "period must be 1 to 255 times 1 us, 10 us, 100 us, 1 ms, 10 ms, 100 ms or 1 s: a drive can be told no "
             "other";
    case DriveConfigError::encoder_resolution:
      return "encoder_resolution_m must be a finite number above 0";
    case DriveConfigError::force_per_torque:
      return "force_per_torque_N_per_Nm must be a finite number above 0";
    case DriveConfigError::max_force:
      return "max_force_N must be a finite number above 0";
  }
  return "unknown error";
}

namespace internal {

constexpr bool fits_16_bit_milliseconds(hal::Duration duration) noexcept {
  return duration >= std::chrono::milliseconds{1} && duration <= std::chrono::milliseconds{0xFFFF};
}

// Returns false for a NaN, too.
template <class Scalar>
constexpr bool positive_and_finite(Scalar value) noexcept {
  return value > 0 && value <= std::numeric_limits<Scalar>::max();
}

// Checks what the CANopen side of the drive needs; the rest is for the conversion of units.
template <class Scalar>
[[gnu::cold]] constexpr DriveConfigError check_node(const DriveConfig<Scalar>& drive,
                                                    const hal::NetworkConfig& network) noexcept {
  if (!canopen::is_node_id(drive.node_id)) return DriveConfigError::node_id;
  if (!canopen::is_node_id(network.node_id) || network.node_id == drive.node_id)
    return DriveConfigError::master_node_id;
  if (!fits_16_bit_milliseconds(drive.heartbeat_period)) return DriveConfigError::heartbeat_period;
  if (!fits_16_bit_milliseconds(drive.heartbeat_timeout) || drive.heartbeat_timeout <= drive.heartbeat_period ||
      drive.heartbeat_timeout <= network.heartbeat_period)
    return DriveConfigError::heartbeat_timeout;
  if (network.heartbeat_period != hal::Duration::zero() && network.heartbeat_period < 2 * network.period)
    return DriveConfigError::master_heartbeat_period;
  if (drive.sdo_timeout <= hal::Duration::zero()) return DriveConfigError::sdo_timeout;
  if (drive.homing.timeout <= hal::Duration::zero()) return DriveConfigError::homing_timeout;
  if (!are_possible(drive.emcy_information)) return DriveConfigError::emcy_information;
  if (!interpolation_period(network.period)) return DriveConfigError::period;
  return DriveConfigError::none;
}

}  // namespace internal

// Returns `none`, or the first field that cannot be used. The bit rate is not looked at: the CAN controller's set-up
// and canopen::check_bus_budget() do that.
template <class Scalar>
[[nodiscard, gnu::cold]] constexpr DriveConfigError check(const DriveConfig<Scalar>& drive,
                                                          const hal::NetworkConfig& network,
                                                          const hal::AxisScale<Scalar>& scale) noexcept {
  const DriveConfigError node = internal::check_node(drive, network);
  if (node != DriveConfigError::none) return node;
  if (!internal::positive_and_finite(scale.encoder_resolution_m)) return DriveConfigError::encoder_resolution;
  if (!internal::positive_and_finite(drive.force_per_torque_N_per_Nm)) return DriveConfigError::force_per_torque;
  if (!internal::positive_and_finite(scale.max_force_N)) return DriveConfigError::max_force;
  return DriveConfigError::none;
}

}  // namespace breakaway::cia402
