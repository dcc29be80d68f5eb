// Pins and interrupts (RM0090, chapters 8 and 12).
#pragma once

#include <cstdint>

#include "breakaway/bare_metal/mmio.hpp"

namespace breakaway::stm32f405 {

enum class Gpio : std::uint32_t { a, b, c };

// Gives a pin (0..15) to a peripheral, at high speed. function: the alternate function's number.
inline void connect_pin(Gpio port, unsigned pin, std::uint32_t function) noexcept {
  using bare_metal::change_bits;
  constexpr std::uintptr_t rcc_ahb1enr = 0x40023830;
  const auto index = static_cast<std::uint32_t>(port);
  const std::uintptr_t base = 0x40020000 + 0x400 * index;
  bare_metal::set_bits(rcc_ahb1enr, 1U << index);
  constexpr std::uintptr_t speed = 0x08, alternate_low = 0x20;
  const unsigned place = 4 * (pin % 8);
  change_bits(base + alternate_low + 4 * (pin / 8), 0xFU << place, function << place);
  change_bits(base + speed, 0b11U << (2 * pin), 0b10U << (2 * pin));
  change_bits(base, 0b11U << (2 * pin), 0b10U << (2 * pin));
}

// All at one priority, the reset value: no handler interrupts another.
inline void enable_interrupt(unsigned number) noexcept {
  constexpr std::uintptr_t nvic_enable = 0xE000E100;
  bare_metal::reg32(nvic_enable + 4 * (number / 32)) = 1U << (number % 32);
}

}  // namespace breakaway::stm32f405
