// Emergency messages (CiA 301, 7.2.7): what a node says when an error comes or goes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/hal/can_frame.hpp"

namespace breakaway::canopen {

struct Emcy {
  std::uint16_t code = 0;           // 0000h: the error is gone
  std::uint8_t error_register = 0;  // 1001h
  std::array<std::uint8_t, 5> manufacturer{};

  friend constexpr bool operator==(const Emcy&, const Emcy&) = default;
};

constexpr hal::CanFrame emcy_frame(const Emcy& emcy, std::uint8_t node_id) noexcept {
  hal::CanFrame frame{.id = emcy_cob_id(node_id), .size = 8, .remote = false, .data = {}};
  store_little_endian(frame.data, emcy.code);
  frame.data[2] = emcy.error_register;
  std::copy(emcy.manufacturer.begin(), emcy.manufacturer.end(), frame.data.begin() + 3);
  return frame;
}

// Returns what an error code is about (CiA 301, table of emergency error codes, and CiA 402-2): the vendor's manual
// says the rest.
constexpr std::string_view error_class(std::uint16_t code) noexcept {
  struct Name {
    unsigned first, last;  // bits 8..15
    std::string_view text;
  };
  constexpr Name names[] = {
      {0x00, 0x00, "no error"},
      {0x10, 0x1F, "generic error"},
      {0x20, 0x20, "current"},
      {0x21, 0x21, "current on the input side"},
      {0x22, 0x22, "current inside the device"},
      {0x23, 0x2F, "current on the output side"},
      {0x30, 0x30, "voltage"},
      {0x31, 0x31, "mains voltage"},
      {0x32, 0x32, "voltage inside the device"},
      {0x33, 0x3F, "output voltage"},
      {0x40, 0x40, "temperature"},
      {0x41, 0x41, "ambient temperature"},
      {0x42, 0x4F, "temperature of the device"},
      {0x50, 0x5F, "hardware of the device"},
      {0x60, 0x6F, "software or data set of the device"},
      {0x71, 0x72, "power electronics or motor"},
      {0x73, 0x73, "encoder or another sensor"},
      {0x70, 0x7F, "a module of the device"},
      {0x81, 0x81, "communication"},
      {0x82, 0x82, "length or deadline of a PDO"},
      {0x83, 0x83, "torque control"},
      {0x84, 0x84, "velocity control"},
      {0x85, 0x86, "position control"},
      {0x87, 0x87, "SYNC"},
      {0x80, 0x8F, "monitoring"},
      {0x90, 0x9F, "external error"},
      {0xF0, 0xFE, "an additional function of the device"},
      {0xFF, 0xFF, "the vendor's own"},
  };
  const unsigned high = code >> 8U;
  for (const Name& name : names) {
    if (high >= name.first && high <= name.last) return name.text;
  }
  return "not of the standard";
}

// The names of the bits of 1001h, from bit 0.
inline constexpr std::array<std::string_view, 8> error_register_bits{
    "generic", "current", "voltage", "temperature", "communication", "device profile", "reserved", "manufacturer"};

// Codes below this are the class 00xxh, by which a node says that errors are gone (CiA 301, 7.2.7.1).
inline constexpr std::uint16_t first_error_code = 0x100;

// A few error codes, each one alone (FF01h) or with all of its class (42xxh).
struct EmcyCodes {
  static constexpr std::size_t most = 8;
  // 4200h and 42FFh of a class, twice the same of a code alone; 0 and 0: there is no more.
  std::array<std::uint16_t, most> first{}, last{};

  // 0000h is no error code, and held by none.
  constexpr bool hold(std::uint16_t code) const noexcept {
    if (code == 0) return false;
    for (std::size_t i = 0; i < most; ++i)
      if (first[i] <= code && code <= last[i]) return true;
    return false;
  }

  friend constexpr bool operator==(const EmcyCodes&, const EmcyCodes&) = default;
};

// Returns false where one is neither a code nor a class, or of 00xxh, by which a node says that errors are gone.
constexpr bool are_possible(const EmcyCodes& codes) noexcept {
  for (std::size_t i = 0; i < EmcyCodes::most; ++i) {
    const unsigned first = codes.first[i], last = codes.last[i];
    const bool whole_class = (first & 0xFFU) == 0 && last == (first | 0xFFU);
    if (last != 0 && first < first_error_code) return false;
    if (first != last && !whole_class) return false;
  }
  return true;
}

// Remembers what one node reported last. A message that is information only is the newest one for people to read: it
// is no error, and neither hides nor ends one.
class EmcyConsumer {
 public:
  explicit constexpr EmcyConsumer(std::uint8_t node_id) noexcept : cob_id_{emcy_cob_id(node_id)} {}

  // Returns true when the frame was this node's emergency. `information`: the codes that are no errors.
  constexpr bool on_frame(const hal::CanFrame& frame, const EmcyCodes& information = {}) noexcept {
    if (frame.id != cob_id_ || frame.remote || frame.size != 8) return false;
    last_.code = load_little_endian<std::uint16_t>(frame.data);
    last_.error_register = frame.data[2];
    std::copy(frame.data.begin() + 3, frame.data.end(), last_.manufacturer.begin());
    if (information.hold(last_.code)) return true;
    error_ = last_;
    if (error_.code < first_error_code) error_.code = 0;
    if (unseen_error_ == 0) unseen_error_ = error_.code;
    return true;
  }
  constexpr void forget() noexcept { last_ = error_ = {}; }

  // The newest message, whatever it says, and the newest that is no information: code 0000h where that error is gone,
  // which any code of 00xxh says.
  constexpr const Emcy& last() const noexcept { return last_; }
  constexpr const Emcy& error() const noexcept { return error_; }
  constexpr bool active() const noexcept { return error_.code != 0; }
  // Returns the first error code that came since the last call, also where the node has taken it back; 0: none came.
  constexpr std::uint16_t take_error() noexcept { return std::exchange(unseen_error_, std::uint16_t{0}); }

 private:
  std::uint16_t cob_id_;
  Emcy last_, error_;
  std::uint16_t unseen_error_ = 0;
};

}  // namespace breakaway::canopen
