// The clock tree of the STM32F405 (RM0090, chapters 3.5, 5 to 7 and 19.4): 168 MHz from the crystal, or 16 MHz from the
// internal oscillator when the crystal is none, is not what it is said to be, or the PLL does not come up.
#pragma once

#include <cstdint>

#include "breakaway/bare_metal/mmio.hpp"
#include "rcc.hpp"

namespace breakaway::stm32f405 {

enum class Crystal : std::uint8_t { runs, none, wrong_frequency, no_lock };

struct Clocks {
  std::uint32_t core_Hz = rcc::internal_Hz;
  std::uint32_t apb1_Hz = rcc::internal_Hz;  // CAN
  std::uint32_t apb2_Hz = rcc::internal_Hz;  // USART1, USART6
  Crystal crystal = Crystal::runs;           // otherwise the internal oscillator, 1 % accurate at room temperature
};

template <bare_metal::Registers R>
class ClockTree {
 public:
  explicit ClockTree(R& registers) noexcept : registers_{&registers} {}

  // From the state after a reset. Every wait in it is bounded: it returns after about a quarter of a second at worst.
  // crystal_Hz: 4 to 26 MHz, a whole number of MHz.
  Clocks start(std::uint32_t crystal_Hz) noexcept {
    bare_metal::set_bits(*registers_, rcc::control, rcc::crystal_on);
    if (!await(rcc::control, rcc::crystal_ready, rcc::crystal_ready)) return internal(Crystal::none);
    if (!is_plausible(crystal_Hz)) return internal(Crystal::wrong_frequency);
    if (!start_pll(crystal_Hz) || !set_flash_wait_states()) return internal(Crystal::no_lock);
    return use_pll();
  }

 private:
  bool await(std::uintptr_t address, std::uint32_t bits, std::uint32_t wanted) noexcept {
    return bare_metal::await_bits(*registers_, address, bits, wanted, rcc::polls);
  }

  // Nothing that does not run the core is left on.
  Clocks internal(Crystal why) noexcept {
    bare_metal::change_bits(*registers_, rcc::control, rcc::crystal_on | rcc::pll_on, 0);
    return {.crystal = why};
  }

  // Measures the crystal against the internal oscillator, before the PLL multiplies it. That oscillator is off by 8 %
  // to the one side and 4.5 % to the other over all temperatures, so a tenth is allowed: what passes is off by 15 % at
  // most, and keeps the PLL in its range.
  bool is_plausible(std::uint32_t crystal_Hz) noexcept {
    const std::uint64_t counts = counts_of_crystal();
    constexpr std::uint64_t edges = captures * edges_a_capture * crystal_divider, in_all = edges * rcc::internal_Hz;
    const std::uint64_t stated = counts * crystal_Hz;  // in_all, were both exact
    return 9 * stated <= 10 * in_all && 11 * stated >= 10 * in_all;
  }

  // How many cycles of the internal oscillator, by timer 11, a known number of the crystal's takes; 0: it has no edges.
  std::uint32_t counts_of_crystal() noexcept {
    constexpr std::uint32_t timer_clock = 1U << 18, divider_mask = 0b11111U << 16;
    constexpr std::uint32_t crystal_is_input = 0b10, input = 0b01, every_eighth_edge = 0b11U << 2, enable = 1;
    bare_metal::set_bits(*registers_, rcc::apb2_enable, timer_clock);
    bare_metal::change_bits(*registers_, rcc::configuration, divider_mask, crystal_divider << 16);
    registers_->write(timer + option, crystal_is_input);
    registers_->write(timer + capture_mode, input | every_eighth_edge);
    registers_->write(timer + capture_enable, enable);
    registers_->write(timer + timer_control, enable);
    const std::uint32_t counts = sum_of_captures();
    bare_metal::set_bits(*registers_, rcc::apb2_reset, timer_clock);
    bare_metal::change_bits(*registers_, rcc::apb2_reset, timer_clock, 0);
    bare_metal::change_bits(*registers_, rcc::apb2_enable, timer_clock, 0);
    bare_metal::change_bits(*registers_, rcc::configuration, divider_mask, 0);
    return counts;
  }

  // The first capture begins the time, and says nothing of the crystal.
  std::uint32_t sum_of_captures() noexcept {
    constexpr std::uint32_t captured = 1U << 1, missed = 1U << 9;
    std::uint32_t sum = 0;
    std::uint16_t last = 0;
    for (std::uint32_t n = 0; n <= captures; ++n) {
      if (!bare_metal::await_bits(*registers_, timer + timer_status, captured, captured, capture_polls)) return 0;
      const auto at = static_cast<std::uint16_t>(registers_->read(timer + capture));  // reading clears `captured`
      if (n > 0) sum += static_cast<std::uint16_t>(at - last);
      last = at;
    }
    return (registers_->read(timer + timer_status) & missed) != 0 ? 0 : sum;
  }

  // VCO input 1 MHz, VCO 336 MHz, system clock half of that, 48 MHz for USB.
  bool start_pll(std::uint32_t crystal_Hz) noexcept {
    constexpr std::uint32_t n = 336, p_half = 0b00, from_crystal = 1, q = 7;
    constexpr std::uint32_t power_interface = 1U << 28, full_speed_voltage = 1U << 14;
    constexpr std::uintptr_t power_control = 0x40007000;
    bare_metal::set_bits(*registers_, rcc::apb1_enable, power_interface);
    bare_metal::set_bits(*registers_, power_control, full_speed_voltage);
    registers_->write(rcc::pll, crystal_Hz / 1'000'000 | n << 6 | p_half << 16 | from_crystal << 22 | q << 24);
    bare_metal::set_bits(*registers_, rcc::control, rcc::pll_on);
    return await(rcc::control, rcc::pll_ready, rcc::pll_ready);
  }

  // At 168 MHz and 3.3 V a read takes five wait states; caches and prefetch hide them. A bootloader's caches may hold
  // what was there before the image was written: they are emptied, which they are only while they are off.
  bool set_flash_wait_states() noexcept {
    constexpr std::uintptr_t flash_access = 0x40023C00;
    constexpr std::uint32_t latency_5 = 5, prefetch = 1U << 8, instruction_cache = 1U << 9, data_cache = 1U << 10;
    constexpr std::uint32_t empty_caches = 0b11U << 11;
    registers_->write(flash_access, latency_5);
    registers_->write(flash_access, latency_5 | empty_caches);
    registers_->write(flash_access, latency_5 | prefetch | instruction_cache | data_cache);
    return await(flash_access, 0xF, latency_5);
  }

  // A crystal that ends later raises a non-maskable interrupt, which halts the node, until the watchdog resets it.
  Clocks use_pll() noexcept {
    constexpr std::uint32_t apb1_quarter = 0b101U << 10, apb2_half = 0b100U << 13, dividers = 0xFCF0;
    constexpr std::uint32_t switch_mask = 0b11, to_pll = 0b10, pll_used = 0b10U << 2;
    bare_metal::change_bits(*registers_, rcc::configuration, dividers, apb1_quarter | apb2_half);
    bare_metal::change_bits(*registers_, rcc::configuration, switch_mask, to_pll);
    if (!await(rcc::configuration, rcc::used_clock, pll_used)) {
      bare_metal::change_bits(*registers_, rcc::configuration, switch_mask | dividers, 0);
      return internal(Crystal::no_lock);
    }
    bare_metal::set_bits(*registers_, rcc::control, rcc::crystal_watch);
    return {168'000'000, 42'000'000, 84'000'000, Crystal::runs};
  }

  // Timer 11, whose input can be the crystal, divided by 31: 129 to 839 kHz.
  static constexpr std::uintptr_t timer = 0x40014800, timer_control = 0x00, timer_status = 0x10, capture_mode = 0x18,
                                  capture_enable = 0x20, capture = 0x34, option = 0x50;
  static constexpr std::uint32_t crystal_divider = 31, edges_a_capture = 8, captures = 32;
  // Ten cycles a poll: the counter goes round once.
  static constexpr std::uint32_t capture_polls = 6'500;

  R* registers_;
};

}  // namespace breakaway::stm32f405
