// From any state in which a bootloader left the chip to the state after a reset (RM0090, 7.3; PM0214, 4.3 and 4.4).
#pragma once

#include <cstdint>

#include "breakaway/bare_metal/mmio.hpp"
#include "rcc.hpp"

namespace breakaway::stm32f405 {

// Nothing interrupts any more, nothing is pending, and exceptions enter at `vectors` (a multiple of 512).
template <bare_metal::Registers R>
void take_interrupts(R& registers, std::uintptr_t vectors) noexcept {
  constexpr std::uintptr_t systick_control = 0xE000E010, nvic_disable = 0xE000E180, nvic_unpend = 0xE000E280;
  constexpr std::uintptr_t interrupt_control = 0xE000ED04, vector_table = 0xE000ED08;
  constexpr std::uint32_t unpend_systick = 1U << 25, unpend_pendsv = 1U << 27;
  registers.write(systick_control, 0);
  for (std::uintptr_t word = 0; word < 3; ++word) {  // 82 interrupts
    registers.write(nvic_disable + 4 * word, 0xFFFF'FFFF);
    registers.write(nvic_unpend + 4 * word, 0xFFFF'FFFF);
  }
  registers.write(interrupt_control, unpend_systick | unpend_pendsv);
  registers.write(vector_table, static_cast<std::uint32_t>(vectors));
}

// The internal oscillator runs the core, the PLLs and the crystal are off, and no clock interrupts. A PLL cannot be
// switched off while it runs the core, so the core leaves it first.
template <bare_metal::Registers R>
void reset_clocks(R& registers) noexcept {
  using namespace rcc;
  constexpr std::uint32_t trim = 16U << 3, pll_after_reset = 0x2400'3010, clear_all_flags = 0x9F'0000;
  bare_metal::set_bits(registers, control, internal_on);
  bare_metal::await_bits(registers, control, internal_ready, internal_ready, polls);
  registers.write(configuration, 0);
  bare_metal::await_bits(registers, configuration, used_clock, 0, polls);
  // The crystal's bypass, bit 18, can be cleared only once the crystal is off.
  constexpr std::uint32_t bypass = 1U << 18;
  registers.write(control, (registers.read(control) & bypass) | trim | internal_on);
  bare_metal::await_bits(registers, control, pll_ready | crystal_ready, 0, polls);
  registers.write(control, trim | internal_on);
  registers.write(pll, pll_after_reset);
  registers.write(interrupts, clear_all_flags);
}

// No peripheral runs, whatever it was told: no timer, no DMA into our memory, no CAN controller that acknowledges.
template <bare_metal::Registers R>
void reset_peripherals(R& registers) noexcept {
  using namespace rcc;
  constexpr std::uint32_t core_coupled_memory = 1U << 20;  // the one clock that is on after a reset
  for (const std::uintptr_t reset : {ahb1_reset, ahb2_reset, ahb3_reset, apb1_reset, apb2_reset}) {
    registers.write(reset, 0xFFFF'FFFF);
    registers.write(reset, 0);
  }
  registers.write(ahb1_enable, core_coupled_memory);
  for (const std::uintptr_t enable : {ahb2_enable, ahb3_enable, apb1_enable, apb2_enable}) registers.write(enable, 0);
}

}  // namespace breakaway::stm32f405
