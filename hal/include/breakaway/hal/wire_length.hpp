// Length on the wire of a classic CAN frame with an 11-bit identifier (ISO 11898-1): every bit from start of frame to
// the end of the intermission counts, stuff bits included.
#pragma once

#include <cstdint>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

inline constexpr unsigned intermission_bits = 3;
// CRC delimiter, ACK slot and delimiter, and end of frame (7) are sent without stuffing, and so is the intermission.
inline constexpr unsigned unstuffed_tail_bits = 1 + 2 + 7 + intermission_bits;

// Takes one bit into CRC-15-CAN, whose polynomial is x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1.
constexpr std::uint16_t crc15_step(std::uint16_t crc, bool bit) noexcept {
  const bool feedback = bit != ((crc & 0x4000U) != 0);
  const unsigned shifted = (crc * 2U) & 0x7FFFU;
  return static_cast<std::uint16_t>(feedback ? shifted ^ 0x4599U : shifted);
}

// Follows the stuffed part of a frame bit by bit: after five equal bits the sender inserts one of the other value,
// which itself counts towards the next run.
class StuffedBits {
 public:
  // Sends the lowest `count` bits of `value`, highest first.
  constexpr void send(std::uint32_t value, unsigned count) noexcept {
    for (unsigned i = count; i-- > 0;) send_bit(((value >> i) & 1U) != 0);
  }
  constexpr void send_crc() noexcept { send(crc_, 15); }
  constexpr std::uint16_t crc() const noexcept { return crc_; }
  constexpr unsigned bits() const noexcept { return bits_; }

 private:
  constexpr void send_bit(bool bit) noexcept {
    crc_ = crc15_step(crc_, bit);
    run_ = (bits_ > 0 && bit == last_) ? run_ + 1 : 1;
    last_ = bit;
    ++bits_;
    if (run_ == 5) {
      last_ = !bit;
      run_ = 1;
      ++bits_;
    }
  }

  std::uint16_t crc_ = 0;
  unsigned bits_ = 0;
  unsigned run_ = 0;
  bool last_ = true;  // the idle bus is recessive
};

// Counts the bits of this very frame. A size above 8 counts as 8, as a receiver takes it.
constexpr unsigned wire_bits(const CanFrame& frame) noexcept {
  StuffedBits stuffed;
  stuffed.send(0, 1);  // start of frame
  stuffed.send(frame.id & 0x7FFU, 11);
  stuffed.send(frame.remote ? 1U : 0U, 1);
  stuffed.send(0, 2);  // identifier extension and reserved bit
  stuffed.send(frame.size <= 8 ? frame.size : 8U, 4);
  if (!frame.remote)
    for (const std::uint8_t byte : frame.payload()) stuffed.send(byte, 8);
  stuffed.send_crc();
  return stuffed.bits() + unstuffed_tail_bits;
}

// Bounds the bits of every data frame of `data_bytes` (0..8) from above: 47 + 8 s bits, and a stuff bit for every four
// of the 33 + 8 s that follow the first of the stuffed ones.
constexpr unsigned worst_case_wire_bits(unsigned data_bytes) noexcept { return 55 + 10 * data_bytes; }

// Returns the time of so many bits, rounded up to whole nanoseconds. bit_rate: bit/s, above 0.
constexpr Duration wire_time(unsigned bits, std::uint32_t bit_rate) noexcept {
  return Duration{(static_cast<std::int64_t>(bits) * 1'000'000'000 + bit_rate - 1) / bit_rate};
}

}  // namespace breakaway::hal
