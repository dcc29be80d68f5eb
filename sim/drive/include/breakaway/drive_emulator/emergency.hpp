// EmergencyProducer: sends EMCY (CiA 301, 7.2.7), and keeps the error register 1001h and the error history 1003h.
#pragma once

#include <cstdint>
#include <functional>
#include <set>

#include "breakaway/drive_emulator/object_dictionary.hpp"
#include "breakaway/hal/can_frame.hpp"

namespace breakaway::drive_emulator {

namespace emcy {
inline constexpr std::uint16_t no_error = 0x0000;
inline constexpr std::uint16_t heartbeat = 0x8130;
inline constexpr std::uint16_t pdo_too_short = 0x8210;
inline constexpr std::uint16_t pdo_too_long = 0x8220;
inline constexpr std::uint16_t sync_length = 0x8240;
inline constexpr std::uint16_t rpdo_timeout = 0x8250;
inline constexpr std::uint16_t sync_late = 0x8700;  // CiA 402: sync controller
}  // namespace emcy

class EmergencyProducer {
 public:
  // `dictionary` must hold 1001h, 1003h and 1014h and outlive the producer.
  EmergencyProducer(ObjectDictionary& dictionary, std::function<void(const hal::CanFrame&)> post)
      : dictionary_(dictionary), post_(std::move(post)) {}

  // Sends the code, unless it was raised already and is not cleared yet.
  void raise(std::uint16_t code);
  // Sends 0000h with what remains in the error register, if the code was raised.
  void clear(std::uint16_t code);
  // Sends the code of what is no error: neither 1001h nor 1003h knows of it.
  void inform(std::uint16_t code);
  void reset() { active_.clear(); }
  bool any() const { return !active_.empty(); }

 private:
  void tell(std::uint16_t code);
  void send(std::uint16_t code);
  void remember(std::uint16_t code);

  ObjectDictionary& dictionary_;
  std::function<void(const hal::CanFrame&)> post_;
  std::set<std::uint16_t> active_;
};

}  // namespace breakaway::drive_emulator
