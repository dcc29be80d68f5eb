// Memory-mapped registers.
#pragma once

#include <cstdint>

namespace breakaway::bare_metal {

inline volatile std::uint32_t& reg32(std::uintptr_t address) noexcept {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

inline void set_bits(std::uintptr_t address, std::uint32_t bits) noexcept { reg32(address) = reg32(address) | bits; }

inline void change_bits(std::uintptr_t address, std::uint32_t mask, std::uint32_t bits) noexcept {
  reg32(address) = (reg32(address) & ~mask) | bits;
}

// Polls until `bits` read as in `wanted`, at most `polls` times. Returns false if they never did.
inline bool await_bits(std::uintptr_t address, std::uint32_t bits, std::uint32_t wanted, std::uint32_t polls) noexcept {
  for (std::uint32_t i = 0; i < polls; ++i) {
    if ((reg32(address) & bits) == (wanted & bits)) return true;
  }
  return false;
}

}  // namespace breakaway::bare_metal
