// Reset and clock control of the STM32F405 (RM0090, chapter 7): the registers that more than one file needs.
#pragma once

#include <cstdint>

namespace breakaway::stm32f405::rcc {

inline constexpr std::uintptr_t base = 0x40023800;
inline constexpr std::uintptr_t control = base, pll = base + 0x04, configuration = base + 0x08,
                                interrupts = base + 0x0C;
inline constexpr std::uintptr_t ahb1_reset = base + 0x10, ahb2_reset = base + 0x14, ahb3_reset = base + 0x18,
                                apb1_reset = base + 0x20, apb2_reset = base + 0x24;
inline constexpr std::uintptr_t ahb1_enable = base + 0x30, ahb2_enable = base + 0x34, ahb3_enable = base + 0x38,
                                apb1_enable = base + 0x40, apb2_enable = base + 0x44;
inline constexpr std::uintptr_t status = base + 0x74;

// Of `control`.
inline constexpr std::uint32_t internal_on = 1U << 0, internal_ready = 1U << 1, crystal_on = 1U << 16,
                               crystal_ready = 1U << 17, crystal_watch = 1U << 19, pll_on = 1U << 24,
                               pll_ready = 1U << 25;
// Of `configuration`.
inline constexpr std::uint32_t used_clock = 0b11U << 2;

inline constexpr std::uint32_t internal_Hz = 16'000'000;

// Some 12 cycles of 16 MHz a poll: 50 ms, ten times what a crystal takes to start.
inline constexpr std::uint32_t polls = 65'000;

}  // namespace breakaway::stm32f405::rcc
