// Length on the wire of a classic CAN frame with an 11-bit identifier (ISO 11898-1): every bit from start of frame to
// the end of the intermission counts, stuff bits included.
#pragma once

#include <array>
#include <cstddef>
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

// Follows the stuffed part of a frame: after five equal bits the sender inserts one of the other value, which itself
// counts towards the next run. Whole groups of four bits are looked up.
class StuffedBits {
 public:
  // Sends the lowest `count` bits of `value`, highest first.
  constexpr void send(std::uint32_t value, unsigned count) noexcept;
  constexpr void send_crc() noexcept { send(crc_, 15); }
  constexpr unsigned bits() const noexcept { return bits_; }

 private:
  static constexpr unsigned longest_run = 5;

  // What four bits do to the length and to the run, and to the checksum.
  struct Group {
    std::uint8_t bits = 0, run = 0;
    bool last = false;
  };
  struct Groups {
    std::array<Group, std::size_t{2} * longest_run * 16> stuffing{};  // by last bit, run and the four bits
    std::array<std::uint16_t, 16> crc{};  // by the highest four bits of the checksum, with those sent
  };
  static constexpr std::size_t place(bool last, unsigned run, unsigned four) noexcept {
    return (((last ? longest_run : 0) + run) << 4U) + four;
  }
  static consteval Groups make_groups() noexcept;
  static const Groups groups_;

  constexpr void send_bit(bool bit) noexcept {
    crc_ = crc15_step(crc_, bit);
    run_ = bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    ++bits_;
    if (run_ == longest_run) {
      last_ = !bit;
      run_ = 1;
      ++bits_;
    }
  }

  std::uint16_t crc_ = 0;
  unsigned bits_ = 0;
  unsigned run_ = 0;  // 0 to 4; the idle bus, which is recessive, counts towards none
  bool last_ = true;
};

consteval StuffedBits::Groups StuffedBits::make_groups() noexcept {
  Groups groups;
  for (unsigned four = 0; four < 16; ++four) {
    for (const bool last : {false, true}) {
      for (unsigned run = 0; run < longest_run; ++run) {
        StuffedBits sent;
        sent.last_ = last;
        sent.run_ = run;
        for (unsigned i = 4; i-- > 0;) sent.send_bit(((four >> i) & 1U) != 0);
        groups.stuffing[place(last, run, four)] = {static_cast<std::uint8_t>(sent.bits_),
                                                   static_cast<std::uint8_t>(sent.run_), sent.last_};
      }
    }
    std::uint16_t crc = 0;
    for (unsigned i = 4; i-- > 0;) crc = crc15_step(crc, ((four >> i) & 1U) != 0);
    groups.crc[four] = crc;
  }
  return groups;
}

inline constexpr StuffedBits::Groups StuffedBits::groups_ = make_groups();

constexpr void StuffedBits::send(std::uint32_t value, unsigned count) noexcept {
  for (; count % 4 != 0; --count) send_bit(((value >> (count - 1)) & 1U) != 0);
  while (count > 0) {
    count -= 4;
    const unsigned four = (value >> count) & 0xFU;
    const Group& group = groups_.stuffing[place(last_, run_, four)];
    bits_ += group.bits;
    run_ = group.run;
    last_ = group.last;
    crc_ = static_cast<std::uint16_t>(((unsigned{crc_} << 4U) & 0x7FFFU) ^
                                      groups_.crc[((unsigned{crc_} >> 11U) & 0xFU) ^ four]);
  }
}

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
