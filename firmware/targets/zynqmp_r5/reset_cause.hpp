// What reset the processing system last (UG1085, chapter 38; UG1087: CRL_APB.RESET_REASON, PMU_GLOBAL.ERROR_STATUS_1).
#pragma once

#include <cstdint>
#include <string_view>

#include "breakaway/bare_metal/mmio.hpp"

namespace breakaway::zynqmp_r5 {

enum class ResetCause : std::uint8_t { unknown, power, pin, software, watchdog, system_error, debugger };

constexpr std::string_view to_string(ResetCause cause) noexcept {
  switch (cause) {
    case ResetCause::unknown:
      return "unknown: a boot loader took the flags, or this core alone was started anew";
    case ResetCause::power:
      return "power came, or PS_POR_B";
    case ResetCause::pin:
      return "PS_SRST_B";
    case ResetCause::software:
      return "software";
    case ResetCause::watchdog:
      return "the watchdog: the loop stood still, or a step took longer than its period, again and again";
    case ResetCause::system_error:
      return "an error of the system: the PMU's firmware took the flag that says which, the watchdog's too";
    case ResetCause::debugger:
      return "a debugger";
  }
  return "unknown reset cause";
}

// Reads it and forgets it, so that the next reset is told from this one. The core must be allowed to reach both
// registers, where a protection unit (XPPU) is set up.
template <bare_metal::Registers R>
ResetCause take_reset_cause(R& registers) noexcept {
  constexpr std::uintptr_t reset_reason = 0xFF5E'0220, error_status = 0xFFD8'0530;
  constexpr std::uint32_t external_power = 1U << 0, internal_power = 1U << 1, system = 1U << 2, system_only = 1U << 3,
                          pin = 1U << 4, software = 1U << 5, debugger = 1U << 6, all = 0x7F;
  constexpr std::uint32_t watchdog_of_low_power_domain = 1U << 12;
  const std::uint32_t reasons = registers.read(reset_reason) & all;
  const bool watchdog = (registers.read(error_status) & watchdog_of_low_power_domain) != 0;
  // A flag is cleared by a one.
  registers.write(reset_reason, reasons);
  registers.write(error_status, watchdog_of_low_power_domain);
  // The watchdog's flag outlasts every reset but that by power, also one that reached this core alone.
  if ((reasons & external_power) != 0) return ResetCause::power;
  if (watchdog) return ResetCause::watchdog;
  if ((reasons & (internal_power | system)) != 0) return ResetCause::system_error;
  if ((reasons & (software | system_only)) != 0) return ResetCause::software;
  if ((reasons & pin) != 0) return ResetCause::pin;
  return (reasons & debugger) != 0 ? ResetCause::debugger : ResetCause::unknown;
}

}  // namespace breakaway::zynqmp_r5
