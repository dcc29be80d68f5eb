#include "breakaway/drive_emulator/pdo.hpp"

#include "breakaway/canopen/cob_id.hpp"

namespace breakaway::drive_emulator {

using canopen::SdoAbort;

namespace {

constexpr std::uint32_t extended_frame = 1U << 29;
constexpr unsigned max_bits = 64;

Address mapped_address(std::uint32_t entry) {
  return {static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8)};
}
unsigned mapped_bits(std::uint32_t entry) { return entry & 0xFFU; }

// Returns true for the identifiers that CiA 301 (table "restricted CAN-IDs") keeps from PDOs.
bool restricted(std::uint32_t id) {
  return id <= 0x07F || (id >= 0x101 && id <= 0x180) || (id >= 0x581 && id <= 0x5FF) || (id >= 0x601 && id <= 0x67F) ||
         (id >= 0x6E0 && id <= 0x6FF) || id >= 0x701;
}

}  // namespace

Pdo::Pdo(ObjectDictionary& dictionary, PdoDirection direction, unsigned number, std::uint32_t cob_id,
         std::initializer_list<Address> mapped)
    : dictionary_(&dictionary),
      direction_(direction),
      parameter_(static_cast<std::uint16_t>((direction == PdoDirection::receive ? 0x1400 : 0x1800) + number - 1)),
      mapping_(static_cast<std::uint16_t>(parameter_ + 0x200)) {
  constexpr auto rw = Access::read_write;
  dictionary.add({parameter_, 0}, {.type = Type::u8, .value = 5});
  dictionary.add({parameter_, 1}, {.type = Type::u32, .access = rw, .value = cob_id});
  dictionary.add({parameter_, 2}, {.type = Type::u8, .access = rw, .value = 255});
  if (direction == PdoDirection::transmit) dictionary.add({parameter_, 3}, {.type = Type::u16, .access = rw});
  dictionary.add({parameter_, 5}, {.type = Type::u16, .access = rw});
  dictionary.add({mapping_, 0}, {.type = Type::u8, .access = rw, .value = static_cast<std::int64_t>(mapped.size())});
  for (std::uint8_t sub = 1; sub <= max_entries; ++sub) {
    std::uint32_t entry = 0;
    if (sub <= mapped.size()) {
      const Address object = *(mapped.begin() + sub - 1);
      const Entry* known = dictionary.find(object);
      const auto bits = known == nullptr ? 0U : static_cast<std::uint32_t>(8 * drive_emulator::size_bytes(known->type));
      entry = static_cast<std::uint32_t>(object.index) << 16 | static_cast<std::uint32_t>(object.sub) << 8 | bits;
    }
    dictionary.add({mapping_, sub}, {.type = Type::u32, .access = rw, .value = entry});
  }
  dictionary.set_rule(parameter_, [this](Address a, std::int64_t v) { return check_parameter(a, v); });
  dictionary.set_rule(mapping_, [this](Address a, std::int64_t v) { return check_mapping(a, v); });
}

std::optional<SdoAbort> Pdo::check_parameter(Address address, std::int64_t value) const {
  if (locked_) return SdoAbort::device_state;
  if (address.sub == 2 && value > 240 && value < 254) return SdoAbort::invalid_value;
  if (address.sub == 3 && valid()) return SdoAbort::device_state;
  if (address.sub != 1) return std::nullopt;
  const auto cob_id = static_cast<std::uint32_t>(value);
  if ((cob_id & canopen::cob_id_invalid) != 0) return std::nullopt;
  if ((cob_id & extended_frame) != 0 || restricted(cob_id & 0x7FFU)) return SdoAbort::invalid_value;
  if (valid() && (cob_id & 0x7FFU) != can_id()) return SdoAbort::device_state;
  return std::nullopt;
}

std::optional<SdoAbort> Pdo::check_mapping(Address address, std::int64_t value) const {
  if (fixed_) return SdoAbort::read_only;
  if (locked_ || valid()) return SdoAbort::device_state;
  if (address.sub != 0) {
    if (get(mapping_, 0) != 0) return SdoAbort::device_state;
    return check_mapped_object(static_cast<std::uint32_t>(value));
  }
  if (value > max_entries) return SdoAbort::mapping_too_long;
  const auto count = static_cast<std::uint8_t>(value);
  unsigned bits = 0;
  for (std::uint8_t sub = 1; sub <= count; ++sub) {
    if (const auto refused = check_mapped_object(mapping_entry(sub))) return refused;
    bits += mapped_bits(mapping_entry(sub));
  }
  if (bits > max_bits) return SdoAbort::mapping_too_long;
  return std::nullopt;
}

std::optional<SdoAbort> Pdo::check_mapped_object(std::uint32_t entry) const {
  const Entry* object = dictionary_->find(mapped_address(entry));
  if (object == nullptr) return SdoAbort::no_such_object;
  const Mapping needed = direction_ == PdoDirection::receive ? Mapping::receive : Mapping::transmit;
  if (object->mapping != needed && object->mapping != Mapping::both) return SdoAbort::not_mappable;
  if (mapped_bits(entry) != 8 * drive_emulator::size_bytes(object->type)) return SdoAbort::not_mappable;
  return std::nullopt;
}

std::size_t Pdo::size_bytes() const {
  unsigned bits = 0;
  for (std::uint8_t sub = 1, count = mapped_count(); sub <= count; ++sub) bits += mapped_bits(mapping_entry(sub));
  return bits / 8;
}

bool Pdo::maps(std::uint16_t index) const {
  for (std::uint8_t sub = 1; sub <= mapped_count(); ++sub)
    if (mapped_address(mapping_entry(sub)).index == index) return true;
  return false;
}

ObjectDictionary::Bytes Pdo::pack() const {
  ObjectDictionary::Bytes data;
  data.reserve(max_bits / 8);
  for (std::uint8_t sub = 1, count = mapped_count(); sub <= count; ++sub) {
    const std::uint32_t entry = mapping_entry(sub);
    const auto value = static_cast<std::uint64_t>(dictionary_->get(mapped_address(entry)));
    for (unsigned bit = 0; bit < mapped_bits(entry); bit += 8) data.push_back(static_cast<std::uint8_t>(value >> bit));
  }
  return data;
}

void Pdo::unpack(std::span<const std::uint8_t> data) {
  for (std::uint8_t sub = 1; sub <= mapped_count(); ++sub) {
    const std::size_t size = mapped_bits(mapping_entry(sub)) / 8;
    static_cast<void>(dictionary_->write(mapped_address(mapping_entry(sub)), data.first(size)));
    data = data.subspan(size);
  }
}

}  // namespace breakaway::drive_emulator
