// What the controller image may touch: its own code and data and the peripherals; anything else faults. Code is never
// written, and what is written is never executed; constants are neither.
#pragma once

#include <cstdint>

extern "C" const char image_upper_code[];  // of the linker script: where code begins in the upper half of TCM B

namespace breakaway::zynqmp_r5 {

// Regions of the memory protection unit (DDI 0460, 7; DDI 0406, B5.2): a later one wins where two overlap.
struct Region {
  std::uint32_t base = 0;
  std::uint32_t log2_size = 0;  // 5..32; the base is a multiple of the size
  std::uint32_t access = 0;     // as the region access control register has it
  std::uint32_t eighths = 0;    // of the region, from its begin on, for which it does not hold
};

inline constexpr std::uint32_t read_only = 0b110U << 8, read_write = 0b011U << 8, no_execute = 1U << 12;
inline constexpr std::uint32_t normal_uncached = 0b001U << 3, strongly_ordered = 0;

inline constexpr std::uint32_t upper_half = 0x0002'8000, eighth_of_upper_half = 0x1000;

inline constexpr Region regions[] = {
    {0x0000'0000, 16, read_only | normal_uncached},                 // TCM A: vectors, code
    {0x0002'0000, 16, read_write | no_execute | normal_uncached},   // TCM B: stack, data
    {upper_half, 15, read_only | no_execute | normal_uncached},     // its upper half: constants
    {0xFF00'0000, 24, read_write | no_execute | strongly_ordered},  // peripherals of the low-power domain
};

inline void protect(std::uint32_t number, const Region& region) noexcept {
  constexpr std::uint32_t enable = 1, subregions = 8;         // place of their bits
  const std::uint32_t left_out = (1U << region.eighths) - 1;  // a bit for each
  asm volatile("mcr p15, 0, %0, c6, c2, 0" ::"r"(number));
  asm volatile("mcr p15, 0, %0, c6, c1, 0" ::"r"(region.base));
  asm volatile("mcr p15, 0, %0, c6, c1, 4" ::"r"(region.access));
  asm volatile("mcr p15, 0, %0, c6, c1, 2" ::"r"(left_out << subregions | (region.log2_size - 1) << 1 | enable));
}

// Once, before the loop. TCM is as fast as a cache, so the caches stay off: nothing cacheable is in reach.
inline void protect_memory() noexcept {
  std::uint32_t number = 0;
  for (const Region& region : regions) protect(number++, region);
  // The code behind the constants.
  const auto code = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(image_upper_code));
  protect(number, {upper_half, 15, read_only | normal_uncached, (code - upper_half) / eighth_of_upper_half});
  constexpr std::uint32_t protection = 1U << 0, background = 1U << 17;
  std::uint32_t control;
  asm volatile("mrc p15, 0, %0, c1, c0, 0" : "=r"(control));
  asm volatile("dsb\n mcr p15, 0, %0, c1, c0, 0\n isb" ::"r"((control & ~background) | protection) : "memory");
}

}  // namespace breakaway::zynqmp_r5
