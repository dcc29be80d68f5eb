// The independent watchdog (RM0090, chapter 21), which has a clock of its own: it resets the chip also when the others
// stand still.
#pragma once

#include <cstdint>

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::stm32f405 {

template <bare_metal::Registers R>
class Watchdog {
 public:
  explicit Watchdog(R& registers) noexcept : registers_{&registers} {}

  // From here on the chip is reset unless serve() comes in time; nothing but a reset ends that. Its oscillator has 17
  // to 47 kHz, so that a reset comes after 1 to 2.8 times the timeout and 0.5 ms (more above 0.34 s, where it counts in
  // larger steps). A core that a debugger halts stops the watchdog. False: the timeout is none or more than 22 s, or
  // the watchdog does not take it; then it may have been started, and resets the chip.
  bool start(hal::Duration timeout) noexcept {
    constexpr std::int64_t fastest_Hz = 47'000, most_counts = 0x1000, margin = 2;
    const std::int64_t clocks = (timeout / std::chrono::microseconds{1} * fastest_Hz + 999'999) / 1'000'000;
    std::uint32_t divider = 0;  // by 4 << divider
    const auto counts = [&] { return (clocks >> (2 + divider)) + margin; };
    while (divider < largest_divider && counts() > most_counts) ++divider;
    if (clocks < 1 || counts() > most_counts) return false;
    bare_metal::set_bits(*registers_, debug_freeze, stop_watchdog);
    registers_->write(key, start_key);
    registers_->write(key, access_key);
    registers_->write(prescaler, divider);
    registers_->write(reload, static_cast<std::uint32_t>(counts() - 1));
    const bool taken = bare_metal::await_bits(*registers_, status, updating, 0, polls);
    serve();
    return taken;
  }
  void serve() noexcept { registers_->write(key, serve_key); }

 private:
  static constexpr std::uintptr_t base = 0x40003000, key = base, prescaler = base + 0x04, reload = base + 0x08,
                                  status = base + 0x0C, debug_freeze = 0xE0042008;
  static constexpr std::uint32_t start_key = 0xCCCC, access_key = 0x5555, serve_key = 0xAAAA;
  static constexpr std::uint32_t updating = 0b11, stop_watchdog = 1U << 12, largest_divider = 6;
  // A register is taken within five cycles of 17 kHz, which are 50000 cycles of the core.
  static constexpr std::uint32_t polls = 100'000;

  R* registers_;
};

}  // namespace breakaway::stm32f405
