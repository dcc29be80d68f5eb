// CAN over a serial line in printable characters (the command set of the LAWICEL CAN232, which Linux calls slcan).
//
//   tiiildd..<CR>  data frame: 11-bit identifier, length, bytes      riiil<CR>  remote frame
//   S8<CR> bit rate  O<CR> open  C<CR> close  F<CR> status flags     answers: <CR> done, <BEL> refused,
//                                                                    z<CR> frame taken, Fxx<CR> flags
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "breakaway/hal/can_frame.hpp"

namespace breakaway::slcan {

inline constexpr char carriage_return = '\r';
inline constexpr char bell = '\a';

// The longest line that means anything: a frame of 8 bytes with the time stamp that some adapters append.
inline constexpr std::size_t longest_line = 1 + 3 + 1 + 16 + 4;

// EncodedFrame: a frame as a command, with its carriage return.
class EncodedFrame {
 public:
  // An identifier above 7FFh is cut to 11 bits, and a size above 8 to 8.
  explicit EncodedFrame(const hal::CanFrame& frame) noexcept;
  std::span<const char> text() const noexcept { return std::span{text_}.first(size_); }

 private:
  void append_hex(std::uint32_t value, unsigned digits) noexcept;
  std::array<char, longest_line + 1> text_{};
  std::size_t size_ = 0;
};

// Returns the digit of CAN232's S command, or nothing for a bit rate that it does not know.
std::optional<char> bit_rate_digit(std::uint32_t bit_rate) noexcept;

// The bits of the status flags.
namespace status_flag {
inline constexpr std::uint8_t receive_queue_full = 0x01;
inline constexpr std::uint8_t transmit_queue_full = 0x02;
inline constexpr std::uint8_t error_warning = 0x04;
inline constexpr std::uint8_t data_overrun = 0x08;
inline constexpr std::uint8_t error_passive = 0x20;
inline constexpr std::uint8_t arbitration_lost = 0x40;
inline constexpr std::uint8_t bus_error = 0x80;
}  // namespace status_flag

struct Message {
  enum class Kind : std::uint8_t {
    frame,
    taken,      // the adapter queued a frame of ours
    done,       // it carried a command out
    refused,    // it did not take a command or a frame
    status,     // it tells its flags
    unknown,    // well-formed, but of no use here: a version, a frame with a 29-bit identifier
    malformed,  // noise, or a line that lost bytes
  };
  Kind kind = Kind::unknown;
  std::uint8_t status = 0;
  hal::CanFrame frame{};
};

// Decoder: makes messages of characters, whatever bytes come.
class Decoder {
 public:
  // Returns a message when the character ends one.
  std::optional<Message> take(char character) noexcept;
  void reset() noexcept { size_ = 0; }

 private:
  Message finish_line() noexcept;
  std::array<char, longest_line> line_{};
  std::size_t size_ = 0;  // of the line so far; longest_line + 1 for one that is too long already
};

}  // namespace breakaway::slcan
