// What reset the chip last (RM0090, 7.3.21).
#pragma once

#include <cstdint>
#include <string_view>

#include "breakaway/bare_metal/mmio.hpp"
#include "rcc.hpp"

namespace breakaway::stm32f405 {

enum class ResetCause : std::uint8_t { unknown, power, pin, software, watchdog, low_power };

constexpr std::string_view to_string(ResetCause cause) noexcept {
  switch (cause) {
    case ResetCause::unknown:
      return "unknown: a bootloader took the flags";
    case ResetCause::power:
      return "power came";
    case ResetCause::pin:
      return "the reset pin";
    case ResetCause::software:
      return "software, or a debugger";
    case ResetCause::watchdog:
      return "the watchdog: the loop stood still, or a step took longer than its period, again and again";
    case ResetCause::low_power:
      return "a low-power mode that is forbidden";
  }
  return "unknown reset cause";
}

// Reads it and forgets it, so that the next reset is told from this one. Every reset inside the chip pulls the pin,
// too.
template <bare_metal::Registers R>
ResetCause take_reset_cause(R& registers) noexcept {
  constexpr std::uint32_t forget = 1U << 24, brown_out = 1U << 25, pin = 1U << 26, power = 1U << 27,
                          software = 1U << 28, independent_watchdog = 1U << 29, window_watchdog = 1U << 30,
                          low_power = 1U << 31;
  const std::uint32_t flags = registers.read(rcc::status);
  bare_metal::set_bits(registers, rcc::status, forget);
  // Power first: what is left in the other flags when it comes says nothing.
  if ((flags & (power | brown_out)) != 0) return ResetCause::power;
  if ((flags & (independent_watchdog | window_watchdog)) != 0) return ResetCause::watchdog;
  if ((flags & software) != 0) return ResetCause::software;
  if ((flags & low_power) != 0) return ResetCause::low_power;
  return (flags & pin) != 0 ? ResetCause::pin : ResetCause::unknown;
}

}  // namespace breakaway::stm32f405
