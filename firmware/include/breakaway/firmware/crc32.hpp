// CRC-32 of IEEE 802.3 (reflected polynomial EDB88320) over words, least significant byte first.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

namespace breakaway::firmware {

class Crc32 {
 public:
  // Not inlined: the checksum of a node adds at a hundred places, and a copy at each costs an image 2 KB.
  [[gnu::noinline]] constexpr void add(std::uint32_t word) noexcept {
    state_ ^= word;
    for (int bit = 0; bit < 32; ++bit) state_ = (state_ >> 1U) ^ ((state_ & 1U) != 0 ? 0xEDB88320U : 0U);
  }

  // Adds all bits of a number, an enumerator or a truth value of up to 64 bits, whether they mean something or not.
  template <class T>
  constexpr void add_bits_of(const T& value) noexcept {
    static_assert(std::is_trivially_copyable_v<T> &&
                  (sizeof(T) == 1 || sizeof(T) == 2 || sizeof(T) == 4 || sizeof(T) == 8));
    if constexpr (sizeof(T) == 1) add(std::bit_cast<std::uint8_t>(value));
    if constexpr (sizeof(T) == 2) add(std::bit_cast<std::uint16_t>(value));
    if constexpr (sizeof(T) == 4) add(std::bit_cast<std::uint32_t>(value));
    if constexpr (sizeof(T) == 8) {
      const auto bits = std::bit_cast<std::uint64_t>(value);
      add(static_cast<std::uint32_t>(bits));
      add(static_cast<std::uint32_t>(bits >> 32U));
    }
  }

  constexpr std::uint32_t value() const noexcept { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFU;
};

}  // namespace breakaway::firmware
