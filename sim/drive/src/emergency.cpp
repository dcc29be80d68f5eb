#include "breakaway/drive_emulator/emergency.hpp"

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/drive_emulator/objects.hpp"

namespace breakaway::drive_emulator {

namespace {

using own_object::error_history;
constexpr Address error_register_entry{cia402::object::error_register, 0};
constexpr Address emcy_cob_id_entry{cia402::object::emcy_cob_id, 0};

// Returns the bit of 1001h for an error code. Bit 0, for any error, comes besides.
unsigned register_bit(std::uint16_t code) {
  switch (code >> 12) {
    case 0x2:
      return 1U << 1;  // current
    case 0x3:
      return 1U << 2;  // voltage
    case 0x4:
      return 1U << 3;  // temperature
    case 0x8:
      return code < 0x8300 ? 1U << 4 : 1U << 5;  // communication; device profile
    default:
      return 0;
  }
}

}  // namespace

void EmergencyProducer::raise(std::uint16_t code) {
  if (active_.insert(code).second) tell(code);
}

void EmergencyProducer::clear(std::uint16_t code) {
  if (active_.erase(code) != 0) tell(emcy::no_error);
}

void EmergencyProducer::inform(std::uint16_t code) { send(code); }

void EmergencyProducer::tell(std::uint16_t code) {
  unsigned error_register = 0;
  for (const std::uint16_t active : active_) error_register |= 1U | register_bit(active);
  dictionary_.set(error_register_entry, error_register);
  if (code != emcy::no_error) remember(code);
  send(code);
}

void EmergencyProducer::send(std::uint16_t code) {
  const auto cob_id = static_cast<std::uint32_t>(dictionary_.get(emcy_cob_id_entry));
  if ((cob_id & canopen::cob_id_invalid) != 0) return;
  hal::CanFrame frame{.id = static_cast<std::uint16_t>(cob_id & 0x7FFU), .size = 8};
  canopen::store_little_endian(frame.data, code);
  frame.data[2] = static_cast<std::uint8_t>(dictionary_.get(error_register_entry));
  post_(frame);
}

void EmergencyProducer::remember(std::uint16_t code) {
  std::uint8_t depth = 1;
  while (dictionary_.find({error_history, static_cast<std::uint8_t>(depth + 1)}) != nullptr) ++depth;
  for (std::uint8_t sub = depth; sub > 1; --sub)
    dictionary_.set({error_history, sub}, dictionary_.get({error_history, static_cast<std::uint8_t>(sub - 1)}));
  dictionary_.set({error_history, 1}, code);
  const std::int64_t count = dictionary_.get({error_history, 0});
  dictionary_.set({error_history, 0}, std::min<std::int64_t>(count + 1, depth));
}

}  // namespace breakaway::drive_emulator
