// The law image: what the law of each axis of a node needs, as bytes in a fixed order and without padding, for programs
// that do not compile a generated header.
//
// "brkL", version, kind (0: the coasts "pd" and "brake", 1: "work"), number of axes, 0; of each axis the number of
// bytes that follow (32 bits), the entries of its kick table (8 bits), and the numbers that visit_law_numbers() visits;
// a CRC-32 of all that. Least significant bytes first, numbers with a point as IEEE 754 binary32.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "breakaway/firmware/flashed_node.hpp"

namespace breakaway::firmware {

inline constexpr std::array<std::uint8_t, 4> law_image_magic{'b', 'r', 'k', 'L'};
inline constexpr std::uint8_t law_image_version = 3;
inline constexpr std::size_t law_image_header_bytes = 8;
inline constexpr std::size_t law_image_checksum_bytes = 4;

enum class LawImageKind : std::uint8_t { rigid, by_work };

// A word of the checksum is a byte here.
constexpr std::uint32_t checksum_of_bytes(std::span<const std::uint8_t> bytes) noexcept {
  Crc32 crc;
  for (const std::uint8_t byte : bytes) crc.add(byte);
  return crc.value();
}

constexpr std::uint32_t word_at(std::span<const std::uint8_t, 4> bytes) noexcept {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8U | bytes[i];
  return word;
}

// Takes the numbers of one axis out of its bytes, and says whether they were all there and no more.
class LawImageReader {
 public:
  explicit constexpr LawImageReader(std::span<const std::uint8_t> bytes) noexcept : left_{bytes} {}

  template <class T>
  constexpr void value(const char*, T& number, const char* = "") noexcept {
    if constexpr (std::is_floating_point_v<T>) {
      number = static_cast<T>(std::bit_cast<float>(static_cast<std::uint32_t>(take(4))));
    } else if constexpr (std::is_same_v<T, AxisName>) {
      for (char& c : number.characters) c = static_cast<char>(take(1));
    } else if constexpr (std::is_same_v<T, bool>) {
      const std::uint64_t bits = take(1);
      whole_ = whole_ && bits <= 1;
      number = bits == 1;
    } else {
      number = static_cast<T>(take(sizeof(T)));
    }
  }
  template <class Body>
  constexpr void group(const char*, const Body& body) noexcept {
    body();
  }
  template <class Items, class Body>
  constexpr void list(const char*, Items&& items, const Body& body) noexcept {
    for (auto& item : items) body(item);
  }
  template <class Items>
  constexpr void row(const char*, Items&& items) noexcept {
    for (auto& item : items) value("", item);
  }

  constexpr bool read_all() const noexcept { return whole_ && left_.empty(); }

 private:
  constexpr std::uint64_t take(std::size_t bytes) noexcept {
    if (bytes > left_.size()) {
      whole_ = false;
      left_ = {};
      return 0;
    }
    std::uint64_t bits = 0;
    for (std::size_t i = bytes; i-- > 0;) bits = bits << 8U | left_[i];
    left_ = left_.subspan(bytes);
    return bits;
  }

  std::span<const std::uint8_t> left_;
  bool whole_ = true;
};

}  // namespace breakaway::firmware
