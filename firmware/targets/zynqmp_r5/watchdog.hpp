// The system watchdog of the low-power domain, which guards the RPU (UG1085, chapter 14; UG1087, module SWDT).
#pragma once

#include <concepts>
#include <cstdint>

#include "breakaway/hal/time.hpp"

namespace breakaway::zynqmp_r5 {

// By offset from the base address of the watchdog.
template <class R>
concept WatchdogRegisters = requires(R& registers, std::uint32_t offset, std::uint32_t value) {
  { registers.write(offset, value) }
  noexcept->std::same_as<void>;
};

// From start() on it counts down, and resets the processor unless it is served in time. Nothing but a reset stops it.
template <WatchdogRegisters R>
class Watchdog {
 public:
  explicit Watchdog(R& registers) noexcept : registers_{&registers} {}

  // The timeout is rounded up to a multiple of 4096 counts of an eighth of the clock: 328 us at 100 MHz. False: more
  // than the counter holds (1.3 s at 100 MHz) or nothing, and the watchdog was left alone.
  bool start(std::uint32_t clock_Hz, hal::Duration timeout) noexcept {
    constexpr std::int64_t unit = 8 * 4096, most_units = 0x1000;
    const std::int64_t scaled = static_cast<std::int64_t>(clock_Hz) * (timeout / std::chrono::microseconds{1});
    const std::int64_t units = (scaled + unit * 1'000'000 - 1) / (unit * 1'000'000);
    if (timeout <= hal::Duration{0} || units < 1 || units > most_units) return false;
    registers_->write(mode, mode_key);
    registers_->write(control, control_key | static_cast<std::uint32_t>(units - 1) << 2 | clock_by_8);
    serve();
    registers_->write(mode, mode_key | reset_of_16_cycles | reset_enable | enable);
    return true;
  }
  void serve() noexcept { registers_->write(restart, restart_key); }

 private:
  static constexpr std::uint32_t mode = 0x0, control = 0x4, restart = 0x8;
  static constexpr std::uint32_t mode_key = 0xABCU << 12, control_key = 0x248U << 14, restart_key = 0x1999;
  static constexpr std::uint32_t enable = 1U << 0, reset_enable = 1U << 1, reset_of_16_cycles = 0b011U << 4;
  static constexpr std::uint32_t clock_by_8 = 0;

  R* registers_;
};

}  // namespace breakaway::zynqmp_r5
