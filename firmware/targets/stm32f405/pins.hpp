// Pins and interrupts (RM0090, chapters 8 and 12).
#pragma once

#include <cstdint>

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/firmware/wiring.hpp"
#include "rcc.hpp"

namespace breakaway::stm32f405 {

inline constexpr std::uint32_t usart1_function = 7, can_function = 9;

inline constexpr std::uintptr_t gpio_speed = 0x08, gpio_set = 0x18, gpio_alternate = 0x20;

// The registers of a pin's port, whose clock then runs.
template <bare_metal::Registers R>
std::uintptr_t start_port(R& registers, firmware::Pin pin) noexcept {
  bare_metal::set_bits(registers, rcc::ahb1_enable, 1U << port_of(pin));
  return 0x40020000 + 0x400 * port_of(pin);
}

// Gives a pin to a peripheral, at high speed. function: the alternate function's number.
template <bare_metal::Registers R>
void connect_pin(R& registers, firmware::Pin pin, std::uint32_t function) noexcept {
  const std::uintptr_t port = start_port(registers, pin);
  const unsigned number = number_of(pin), place = 4 * (number % 8);
  const std::uint32_t two_bits = 0b11U << (2 * number), high_speed = 0b10U << (2 * number), alternate = high_speed;
  bare_metal::change_bits(registers, port + gpio_alternate + 4 * (number / 8), 0xFU << place, function << place);
  bare_metal::change_bits(registers, port + gpio_speed, two_bits, high_speed);
  bare_metal::change_bits(registers, port, two_bits, alternate);
}

// Drives a pin to a level, which it has from the first moment on. No pin: nothing happens.
template <bare_metal::Registers R>
void drive_pin(R& registers, firmware::Pin pin, bool high) noexcept {
  if (pin == firmware::Pin::none) return;
  const std::uintptr_t port = start_port(registers, pin);
  const unsigned number = number_of(pin);
  registers.write(port + gpio_set, 1U << (high ? number : number + 16));
  bare_metal::change_bits(registers, port, 0b11U << (2 * number), 0b01U << (2 * number));
}

// All at one priority, the reset value: no handler interrupts another.
template <bare_metal::Registers R>
void enable_interrupt(R& registers, unsigned number) noexcept {
  constexpr std::uintptr_t nvic_enable = 0xE000E100;
  registers.write(nvic_enable + 4 * (number / 32), 1U << (number % 32));
}

}  // namespace breakaway::stm32f405
