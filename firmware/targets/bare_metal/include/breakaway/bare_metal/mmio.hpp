// Memory-mapped registers.
#pragma once

#include <concepts>
#include <cstdint>

namespace breakaway::bare_metal {

inline volatile std::uint32_t& reg32(std::uintptr_t address) noexcept {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

// A chip's registers by their addresses: Memory on the chip, and a model of them in tests.
template <class R>
concept Registers = requires(R& registers, std::uintptr_t address, std::uint32_t value) {
  { registers.read(address) }
  noexcept->std::same_as<std::uint32_t>;
  { registers.write(address, value) }
  noexcept->std::same_as<void>;
};

struct Memory {
  static std::uint32_t read(std::uintptr_t address) noexcept { return reg32(address); }
  static void write(std::uintptr_t address, std::uint32_t value) noexcept { reg32(address) = value; }
};

template <Registers R>
void change_bits(R& registers, std::uintptr_t address, std::uint32_t mask, std::uint32_t bits) noexcept {
  registers.write(address, (registers.read(address) & ~mask) | bits);
}

template <Registers R>
void set_bits(R& registers, std::uintptr_t address, std::uint32_t bits) noexcept {
  change_bits(registers, address, 0, bits);
}

// Polls until `bits` read as in `wanted`, at most `polls` times. Returns false if they never did.
template <Registers R>
bool await_bits(R& registers, std::uintptr_t address, std::uint32_t bits, std::uint32_t wanted,
                std::uint32_t polls) noexcept {
  for (std::uint32_t i = 0; i < polls; ++i) {
    if ((registers.read(address) & bits) == (wanted & bits)) return true;
  }
  return false;
}

// The same on the chip itself.

inline void set_bits(std::uintptr_t address, std::uint32_t bits) noexcept {
  Memory memory;
  set_bits(memory, address, bits);
}

inline void change_bits(std::uintptr_t address, std::uint32_t mask, std::uint32_t bits) noexcept {
  Memory memory;
  change_bits(memory, address, mask, bits);
}

inline bool await_bits(std::uintptr_t address, std::uint32_t bits, std::uint32_t wanted, std::uint32_t polls) noexcept {
  Memory memory;
  return await_bits(memory, address, bits, wanted, polls);
}

}  // namespace breakaway::bare_metal
