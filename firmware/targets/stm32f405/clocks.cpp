#include "clocks.hpp"

#include "breakaway/bare_metal/mmio.hpp"

namespace breakaway::stm32f405 {
namespace {

using bare_metal::await_bits;
using bare_metal::change_bits;
using bare_metal::reg32;
using bare_metal::set_bits;

constexpr std::uintptr_t rcc = 0x40023800, rcc_cr = rcc, rcc_pllcfgr = rcc + 0x04, rcc_cfgr = rcc + 0x08;
constexpr std::uintptr_t rcc_apb1enr = rcc + 0x40;
constexpr std::uintptr_t pwr_cr = 0x40007000, flash_acr = 0x40023C00;

constexpr std::uint32_t hse_on = 1U << 16, hse_ready = 1U << 17, pll_on = 1U << 24, pll_ready = 1U << 25;
constexpr std::uint32_t internal_Hz = 16'000'000;

// Some 12 cycles of 16 MHz a poll: 50 ms, ten times what a crystal takes to start.
constexpr std::uint32_t polls = 65'000;

constexpr Clocks internal{internal_Hz, internal_Hz, internal_Hz, false};

// VCO input 1 MHz, VCO 336 MHz, system clock half of that, 48 MHz for USB.
constexpr std::uint32_t pll_settings(std::uint32_t crystal_Hz) noexcept {
  constexpr std::uint32_t n = 336, p_half = 0b00, from_crystal = 1, q = 7;
  return crystal_Hz / 1'000'000 | n << 6 | p_half << 16 | from_crystal << 22 | q << 24;
}

// At 168 MHz and 3.3 V a read takes five wait states; caches and prefetch hide them.
bool set_flash_wait_states() noexcept {
  constexpr std::uint32_t latency_5 = 5, prefetch = 1U << 8, instruction_cache = 1U << 9, data_cache = 1U << 10;
  reg32(flash_acr) = latency_5 | prefetch | instruction_cache | data_cache;
  return await_bits(flash_acr, 0xF, latency_5, polls);
}

}  // namespace

Clocks start_clocks(std::uint32_t crystal_Hz) noexcept {
  set_bits(rcc_cr, hse_on);
  if (!await_bits(rcc_cr, hse_ready, hse_ready, polls)) return internal;

  constexpr std::uint32_t power_interface = 1U << 28, full_speed_voltage = 1U << 14;
  set_bits(rcc_apb1enr, power_interface);
  set_bits(pwr_cr, full_speed_voltage);
  reg32(rcc_pllcfgr) = pll_settings(crystal_Hz);
  set_bits(rcc_cr, pll_on);
  if (!await_bits(rcc_cr, pll_ready, pll_ready, polls) || !set_flash_wait_states()) return internal;

  constexpr std::uint32_t apb1_quarter = 0b101U << 10, apb2_half = 0b100U << 13, dividers = 0xFCF0;
  change_bits(rcc_cfgr, dividers, apb1_quarter | apb2_half);
  constexpr std::uint32_t switch_mask = 0b11, use_pll = 0b10, used_mask = 0b11U << 2, pll_used = 0b10U << 2;
  change_bits(rcc_cfgr, switch_mask, use_pll);
  if (!await_bits(rcc_cfgr, used_mask, pll_used, polls)) {
    change_bits(rcc_cfgr, switch_mask | dividers, 0);
    return internal;
  }
  return {168'000'000, 42'000'000, 84'000'000, true};
}

}  // namespace breakaway::stm32f405
