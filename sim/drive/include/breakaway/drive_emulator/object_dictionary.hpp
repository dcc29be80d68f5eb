// ObjectDictionary: the entries of a CANopen device (CiA 301, 7.4) by index and sub-index, with type, access and range.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "breakaway/canopen/sdo_abort.hpp"

namespace breakaway::drive_emulator {

struct Address {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  friend constexpr auto operator<=>(const Address&, const Address&) = default;
};

enum class Type : std::uint8_t { i8, i16, i32, u8, u16, u32, text };
enum class Access : std::uint8_t { read_only, write_only, read_write };
enum class Mapping : std::uint8_t { none, receive, transmit, both };

// Returns the size of a number; 0 for text.
std::size_t size_bytes(Type type);

struct Entry {
  Type type = Type::u32;
  Access access = Access::read_only;
  std::int64_t value = 0;
  Mapping mapping = Mapping::none;
  // Values below `low` and above `high` are refused, and so are those outside the type's own range.
  std::int64_t low = std::numeric_limits<std::int64_t>::min();
  std::int64_t high = std::numeric_limits<std::int64_t>::max();
  std::string text{};               // the value of Type::text
  std::size_t max_text_bytes = 64;  // a longer text is refused
};

class ObjectDictionary {
 public:
  using Bytes = std::vector<std::uint8_t>;
  // A rule is asked before a number is stored. An abort code refuses the number.
  using Rule = std::function<std::optional<canopen::SdoAbort>(Address, std::int64_t)>;

  // The entry's value becomes its power-on value. The reference stays valid as long as the dictionary lives.
  Entry& add(Address address, Entry entry);
  void set_rule(std::uint16_t index, Rule rule) { rules_[index] = std::move(rule); }
  void on_written(std::function<void(Address)> listener) { listener_ = std::move(listener); }

  // Access from the bus, with every check. An abort code is returned, or nothing when it is done.
  std::optional<canopen::SdoAbort> read(Address address, Bytes& data) const;
  std::optional<canopen::SdoAbort> write(Address address, std::span<const std::uint8_t> data);

  // Access from the device itself, unchecked: rules and listener are not asked. Throws std::out_of_range if there is no
  // such entry.
  std::int64_t get(Address address) const { return existing(address).value; }
  void set(Address address, std::int64_t value) { existing(address).value = value; }
  const Entry* find(Address address) const { return look_up(address); }
  // All of them, by address.
  const std::map<Address, Entry>& entries() const { return entries_; }

  void restore_power_on_values(std::uint16_t first_index, std::uint16_t last_index);

 private:
  std::optional<canopen::SdoAbort> refusal(Address address) const;
  std::optional<canopen::SdoAbort> write_text(Entry& entry, std::span<const std::uint8_t> data);

  // A drive asks for the same few objects in every period, so that where they were found last is remembered.
  struct Found {
    Address address;
    Entry* entry = nullptr;
  };
  static constexpr std::size_t remembered = 256;

  Entry* look_up(Address address) const {
    Found& found = found_[(address.index ^ (address.index >> 7U) ^ (address.sub * 37U)) % remembered];
    if (found.entry == nullptr || found.address != address) found = {address, search(address)};
    return found.entry;
  }
  Entry& existing(Address address) const {
    Entry* const entry = look_up(address);
    return entry != nullptr ? *entry : missing();
  }
  Entry* search(Address address) const;
  [[noreturn]] static Entry& missing();

  mutable std::map<Address, Entry> entries_;
  mutable std::array<Found, remembered> found_{};
  std::map<Address, Entry> power_on_;
  std::map<std::uint16_t, Rule> rules_;
  std::function<void(Address)> listener_ = [](Address) {};
};

}  // namespace breakaway::drive_emulator
