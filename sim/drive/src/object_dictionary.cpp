#include "breakaway/drive_emulator/object_dictionary.hpp"

#include <stdexcept>
#include <utility>

namespace breakaway::drive_emulator {

using canopen::SdoAbort;

namespace {

bool is_signed(Type type) { return type == Type::i8 || type == Type::i16 || type == Type::i32; }

std::int64_t decode(Type type, std::span<const std::uint8_t> data) {
  std::int64_t value = 0;
  for (std::size_t i = data.size(); i-- > 0;) value = value * 256 + data[i];
  const std::int64_t span = std::int64_t{1} << (8 * data.size());
  return is_signed(type) && value >= span / 2 ? value - span : value;
}

}  // namespace

std::size_t size_bytes(Type type) {
  switch (type) {
    case Type::i8:
    case Type::u8:
      return 1;
    case Type::i16:
    case Type::u16:
      return 2;
    case Type::i32:
    case Type::u32:
      return 4;
    case Type::text:
      break;
  }
  return 0;
}

Entry& ObjectDictionary::add(Address address, Entry entry) {
  power_on_[address] = entry;
  return entries_[address] = std::move(entry);
}

Entry* ObjectDictionary::search(Address address) const {
  const auto found = entries_.find(address);
  return found == entries_.end() ? nullptr : &found->second;
}

Entry& ObjectDictionary::missing() { throw std::out_of_range{"no such object in the dictionary"}; }

std::optional<SdoAbort> ObjectDictionary::refusal(Address address) const {
  if (look_up(address) != nullptr) return std::nullopt;
  const auto next = entries_.lower_bound({address.index, 0});
  const bool object_exists = next != entries_.end() && next->first.index == address.index;
  return object_exists ? SdoAbort::no_such_subindex : SdoAbort::no_such_object;
}

std::optional<SdoAbort> ObjectDictionary::read(Address address, Bytes& data) const {
  if (const auto refused = refusal(address)) return refused;
  const Entry& entry = existing(address);
  if (entry.access == Access::write_only) return SdoAbort::write_only;
  if (entry.type == Type::text) {
    data.assign(entry.text.begin(), entry.text.end());
    return std::nullopt;
  }
  data.resize(size_bytes(entry.type));
  for (std::size_t i = 0; i < data.size(); ++i)
    data[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(entry.value) >> (8 * i));
  return std::nullopt;
}

std::optional<SdoAbort> ObjectDictionary::write(Address address, std::span<const std::uint8_t> data) {
  if (const auto refused = refusal(address)) return refused;
  Entry& entry = existing(address);
  if (entry.access == Access::read_only) return SdoAbort::read_only;
  if (entry.type == Type::text) return write_text(entry, data);
  if (data.size() != size_bytes(entry.type)) return SdoAbort::length_mismatch;
  const std::int64_t value = decode(entry.type, data);
  if (value > entry.high) return SdoAbort::value_too_high;
  if (value < entry.low) return SdoAbort::value_too_low;
  if (const auto rule = rules_.find(address.index); rule != rules_.end())
    if (const auto refused = rule->second(address, value)) return refused;
  entry.value = value;
  listener_(address);
  return std::nullopt;
}

std::optional<SdoAbort> ObjectDictionary::write_text(Entry& entry, std::span<const std::uint8_t> data) {
  if (data.size() > entry.max_text_bytes) return SdoAbort::length_mismatch;
  entry.text.assign(data.begin(), data.end());
  return std::nullopt;
}

void ObjectDictionary::restore_power_on_values(std::uint16_t first_index, std::uint16_t last_index) {
  for (const auto& [address, entry] : power_on_)
    if (address.index >= first_index && address.index <= last_index) entries_[address] = entry;
}

}  // namespace breakaway::drive_emulator
