// The fixed rate, from the processor's cycle counter. Nothing interrupts: the loop polls until the next tick is due.
#pragma once

#include <cstdint>

#include "breakaway/hal/time.hpp"

namespace breakaway::zynqmp_r5 {

// Counts the core's clock cycles, from 0 to 2^32 and over again (DDI 0460, 6.3.6).
class CycleCounter {
 public:
  static void start() noexcept {
    constexpr std::uint32_t enable = 1U << 0, reset = 1U << 2, divided_by_64 = 1U << 3, counter = 1U << 31;
    std::uint32_t control;
    asm volatile("mrc p15, 0, %0, c9, c12, 0" : "=r"(control));
    asm volatile("mcr p15, 0, %0, c9, c12, 0" ::"r"((control | enable | reset) & ~divided_by_64));
    asm volatile("mcr p15, 0, %0, c9, c12, 1" ::"r"(counter));
  }
  static std::uint32_t read() noexcept {
    std::uint32_t cycles;
    asm volatile("mrc p15, 0, %0, c9, c13, 0" : "=r"(cycles)::"memory");
    return cycles;
  }
};

// A few microseconds between two looks at the bus, so that they leave the peripherals to others. An emulator runs the
// other core at `yield`, and so many instructions that do nothing in no time.
[[gnu::noinline]] inline void pause() noexcept {
  asm volatile("yield" ::: "memory");
  for (int i = 0; i < 10; ++i) asm volatile(".rept 400\n nop\n .endr");
}

class Ticker {
 public:
  // period: a whole number of cycles, less than 2^31 of them. False: it is not, and nothing was started.
  bool start(std::uint32_t core_Hz, hal::Duration period) noexcept {
    const std::int64_t scaled = static_cast<std::int64_t>(core_Hz) * (period / std::chrono::microseconds{1});
    if (period % std::chrono::microseconds{1} != hal::Duration{0} || scaled % 1'000'000 != 0) return false;
    if (scaled < 1'000'000 || scaled / 1'000'000 >= 0x8000'0000) return false;
    cycles_ = static_cast<std::uint32_t>(scaled / 1'000'000);
    period_ = period;
    CycleCounter::start();
    tick_ = CycleCounter::read();
    return true;
  }

  // Calls idle(now) until the next tick is near, waits for it to a few cycles, and returns its time. When ticks were
  // missed, the time is that of the newest.
  template <class Idle>
  hal::Time wait(const Idle& idle) noexcept {
    while (since_tick() < cycles_ - cycles_ / 64) idle(now());
    while (since_tick() < cycles_) {
    }
    do {
      tick_ += cycles_;
      ++ticks_;
    } while (since_tick() >= cycles_);
    return hal::Time{period_ * ticks_};
  }

  // Within a period: calls idle(now) until that time is near, and waits for it to a few cycles; at the latest the next
  // tick ends it.
  template <class Idle>
  void wait_until(hal::Time time, const Idle& idle) const noexcept {
    const hal::Duration near = period_ / 64;
    while (now() + near < time && in_time()) idle(now());
    while (now() < time && in_time()) {
    }
  }

  // To a few cycles. At least once in 2^31 cycles there must be a wait().
  hal::Time now() const noexcept {
    return hal::Time{period_ * ticks_ + hal::Duration{period_.count() * since_tick() / cycles_}};
  }

  // Whether the step that the last tick began is over before the next one is due.
  bool in_time() const noexcept { return since_tick() < cycles_; }

 private:
  std::uint32_t since_tick() const noexcept { return CycleCounter::read() - tick_; }

  std::uint32_t tick_ = 0, cycles_ = 1;
  std::int64_t ticks_ = 0;
  hal::Duration period_{};
};

}  // namespace breakaway::zynqmp_r5
