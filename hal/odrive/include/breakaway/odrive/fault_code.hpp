// What an ODrive axis stops for, as one number of 16 bits that the loop, its status frames and its displays pass on:
// an error bit of the drive, the result of a procedure that it refused, or what was found here.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string_view>

namespace breakaway::odrive {

// Bits of active_errors and disarm_reason.
namespace error {

inline constexpr std::uint32_t initializing = 1U << 0U;
inline constexpr std::uint32_t missing_input = 1U << 6U;
inline constexpr std::uint32_t watchdog_timer_expired = 1U << 24U;
inline constexpr std::uint32_t estop_requested = 1U << 25U;

}  // namespace error

// The number of the lowest error bit, from 1 on; 0: there is none.
constexpr std::uint16_t error_code(std::uint32_t errors) noexcept {
  return errors == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(std::countr_zero(errors) + 1);
}

inline constexpr std::uint16_t first_procedure_code = 0x100;
constexpr std::uint16_t procedure_code(std::uint8_t result) noexcept {
  return static_cast<std::uint16_t>(first_procedure_code + result);
}

// Found here, because nothing in the protocol says it.
enum class OwnFault : std::uint16_t {
  none = 0,
  position_not_a_number = 0x201,
  position_too_coarse = 0x202,
  torque_not_a_number = 0x203,
  torque_not_reported = 0x204,
};

// Results of a procedure that are no failure.
inline constexpr std::uint8_t procedure_succeeded = 0, procedure_busy = 1, procedure_cancelled = 2;

namespace internal {

inline constexpr std::array<std::string_view, 32> error_names{
    "the drive still starts",
    "an error of the whole drive, such as a corrupt memory",
    "a timing error inside the drive",
    "no position estimate: look at the encoder",
    "a bad configuration: see the drive's own tool",
    "a fault of the gate driver: look for a short circuit",
    "an input is missing that the mode needs",
    "",
    "voltage of the supply too high: look at the brake resistor",
    "voltage of the supply too low",
    "current from the supply too high",
    "current back into the supply too high: look at the brake resistor",
    "a motor current beyond its limit",
    "the motor is too hot",
    "the inverter is too hot",
    "faster than the drive's velocity limit",
    "beyond the drive's position limit",
    "",
    "",
    "",
    "",
    "",
    "",
    "",
    "the drive's watchdog expired: no torque command came in time",
    "an emergency stop was requested",
    "the motor spins out: calibrate its encoder again",
    "the brake resistor is disarmed",
    "a temperature sensor is disconnected",
    "",
    "an error of the calibration",
    "",
};

inline constexpr std::array<std::string_view, 16> result_names{
    "",  // 0, 1 and 2 are no failures
    "",
    "",
    "the drive disarmed while it enabled",
    "the motor or encoder does not respond",
    "pole pairs and encoder counts do not match",
    "the phase resistance is out of range",
    "the phase inductance is out of range",
    "the phases are unbalanced",
    "the motor type does not allow it",
    "the Hall sensors show what they must not",
    "the drive's procedure timed out",
    "homing without an end stop",
    "the drive cannot be enabled from the state that it is in",
    "the drive is not calibrated: calibrate motor and encoder, and save it",
    "the drive's calibration does not converge",
};

}  // namespace internal

constexpr std::string_view fault_text(std::uint16_t code) noexcept {
  if (code == 0) return "no error";
  if (code <= internal::error_names.size()) {
    const std::string_view name = internal::error_names[code - 1U];
    return name.empty() ? "an error that this version does not know: see the drive's manual" : name;
  }
  if (code >= first_procedure_code && code < first_procedure_code + 0x100U) {
    const unsigned result = code - first_procedure_code;
    const std::string_view name =
        result < internal::result_names.size() ? internal::result_names[result] : std::string_view{};
    return name.empty() ? "the drive refuses to be enabled: see procedure_result in its manual" : name;
  }
  switch (static_cast<OwnFault>(code)) {
    case OwnFault::none:
      break;
    case OwnFault::position_not_a_number:
      return "the drive reports a position that is not a number";
    case OwnFault::position_too_coarse:
      return "the drive is so far from its zero that its position, a float, is coarser than encoder_resolution_m: set "
             "its zero nearer";
    case OwnFault::torque_not_a_number:
      return "the drive reports a torque that is not a number, or beyond any";
    case OwnFault::torque_not_reported:
      return "the drive reports its position and not its torque, so that nothing shows what force it gives: set its "
             "torques_msg_rate_ms as encoder_msg_rate_ms";
  }
  return "unknown error";
}

}  // namespace breakaway::odrive
