// Emergency messages (CiA 301, 7.2.7): what a node says when an error comes or goes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
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

// Remembers what one node reported last.
class EmcyConsumer {
 public:
  explicit constexpr EmcyConsumer(std::uint8_t node_id) noexcept : cob_id_{emcy_cob_id(node_id)} {}

  // Returns true when the frame was this node's emergency.
  constexpr bool on_frame(const hal::CanFrame& frame) noexcept {
    if (frame.id != cob_id_ || frame.remote || frame.size != 8) return false;
    last_.code = load_little_endian<std::uint16_t>(frame.data);
    last_.error_register = frame.data[2];
    std::copy(frame.data.begin() + 3, frame.data.end(), last_.manufacturer.begin());
    if (unseen_error_ == 0) unseen_error_ = last_.code;
    return true;
  }
  constexpr void forget() noexcept { last_ = {}; }

  constexpr const Emcy& last() const noexcept { return last_; }
  constexpr bool active() const noexcept { return last_.code != 0; }
  // Returns the first error code that came since the last call, also where the node has taken it back; 0: none came.
  constexpr std::uint16_t take_error() noexcept { return std::exchange(unseen_error_, std::uint16_t{0}); }

 private:
  std::uint16_t cob_id_;
  Emcy last_;
  std::uint16_t unseen_error_ = 0;
};

}  // namespace breakaway::canopen
