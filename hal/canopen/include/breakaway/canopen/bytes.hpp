// Little-endian packing: the byte order of every CANopen payload, whatever the processor's own is.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace breakaway::canopen {

// Writes the bytes of `value` at `offset`, least significant first. Bytes that would fall outside are not written.
template <std::integral T>
constexpr void store_little_endian(std::span<std::uint8_t> bytes, T value, std::size_t offset = 0) noexcept {
  const auto bits = static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<T>>(value));
  for (std::size_t i = 0; i < sizeof(T) && offset + i < bytes.size(); ++i)
    bytes[offset + i] = static_cast<std::uint8_t>(bits >> (8 * i));
}

// Reads a T at `offset`, least significant byte first. Bytes outside read as zero.
template <std::integral T>
constexpr T load_little_endian(std::span<const std::uint8_t> bytes, std::size_t offset = 0) noexcept {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(T) && offset + i < bytes.size(); ++i)
    bits |= static_cast<std::uint64_t>(bytes[offset + i]) << (8 * i);
  return static_cast<T>(static_cast<std::make_unsigned_t<T>>(bits));
}

}  // namespace breakaway::canopen
