// The fixed rate: SysTick interrupts once a period, and the loop sleeps in between.
#pragma once

#include <atomic>
#include <cstdint>

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::stm32f405 {

class Ticker {
 public:
  // period: up to 2^24 cycles of the core, 99 ms at 168 MHz. False: it is longer, and nothing was started.
  bool start(std::uint32_t core_Hz, hal::Duration period) noexcept {
    const std::int64_t cycles =
        static_cast<std::int64_t>(core_Hz / 1000) * (period / std::chrono::microseconds{1}) / 1000;
    if (cycles < 1 || cycles > 0x100'0000) return false;
    period_ = period;
    bare_metal::reg32(systick_load) = static_cast<std::uint32_t>(cycles - 1);
    bare_metal::reg32(systick_value) = 0;
    resume();
    return true;
  }

  // Sleeps until the next tick and returns its time. When ticks were missed, the time is that of the newest.
  hal::Time wait() noexcept {
    // Interrupts are masked between the look and the sleep: one that comes in between still ends the sleep.
    for (;;) {
      asm volatile("cpsid i" ::: "memory");
      const std::uint32_t new_ticks = ticks_.load(std::memory_order_relaxed) - static_cast<std::uint32_t>(seen_);
      if (new_ticks == 0) asm volatile("wfi");
      seen_ += new_ticks;  // 64 bits, which an interrupt must not read in between
      asm volatile("cpsie i" ::: "memory");
      if (new_ticks > 0) return hal::Time{period_ * seen_};
    }
  }

  // Whether no tick came since the newest wait().
  bool in_time() const noexcept { return ticks_.load(std::memory_order_relaxed) == static_cast<std::uint32_t>(seen_); }

  // When the next tick will be.
  hal::Time next() const noexcept { return hal::Time{period_ * (seen_ + 1)}; }

  // To a few cycles; also in an interrupt handler, all of which have one priority.
  hal::Time now() const noexcept {
    constexpr std::uintptr_t interrupt_control = 0xE000ED04;
    constexpr std::uint32_t systick_pending = 1U << 26;
    std::uint32_t left = bare_metal::reg32(systick_value);
    std::uint32_t ticks = ticks_.load(std::memory_order_relaxed);
    // A tick whose handler has not run yet: the counter may have been read before or after it began anew.
    if ((bare_metal::reg32(interrupt_control) & systick_pending) != 0) {
      left = bare_metal::reg32(systick_value);
      ++ticks;
    }
    const std::uint32_t cycles = bare_metal::reg32(systick_load) - left;
    const auto newer = static_cast<std::int32_t>(ticks - static_cast<std::uint32_t>(seen_));
    return hal::Time{period_ * (seen_ + newer) + hal::Duration{(static_cast<std::int64_t>(cycles) * period_.count()) /
                                                               (bare_metal::reg32(systick_load) + 1)}};
  }

  // Within a period: returns at that time, to a few cycles, or at the next tick if that comes first.
  void wait_until(hal::Time time) const noexcept {
    while (now() < time && in_time()) {
    }
  }

  // For emulation: time stands still while the rest of the world catches up.
  void hold() noexcept { bare_metal::reg32(systick_control) = from_core; }
  void resume() noexcept { bare_metal::reg32(systick_control) = from_core | interrupt | enable; }

  void on_interrupt() noexcept { ticks_.fetch_add(1, std::memory_order_relaxed); }

 private:
  static constexpr std::uintptr_t systick_control = 0xE000E010, systick_load = 0xE000E014, systick_value = 0xE000E018;
  static constexpr std::uint32_t enable = 1, interrupt = 2, from_core = 4;

  std::atomic<std::uint32_t> ticks_{0};
  std::int64_t seen_ = 0;  // 32 bits of milliseconds would end after 49 days
  hal::Duration period_{};
};

}  // namespace breakaway::stm32f405
