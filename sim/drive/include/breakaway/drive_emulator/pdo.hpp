// Pdo: a process data object of the device, with its communication parameter (14xxh, 18xxh), its mapping (16xxh,
// 1Axxh), and the rules by which a client may change them (CiA 301, 7.5.2.35 to 7.5.2.38).
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>

#include "breakaway/drive_emulator/object_dictionary.hpp"

namespace breakaway::drive_emulator {

enum class PdoDirection : std::uint8_t { receive, transmit };

class Pdo {
 public:
  static constexpr std::uint8_t max_entries = 8;

  // Adds the PDO's objects to the dictionary, which must outlive it. number: 1..4. mapped: the objects that it carries
  // at power-on.
  Pdo(ObjectDictionary& dictionary, PdoDirection direction, unsigned number, std::uint32_t cob_id,
      std::initializer_list<Address> mapped);
  Pdo(const Pdo&) = delete;  // the dictionary's rules point here
  Pdo& operator=(const Pdo&) = delete;

  bool valid() const { return (get(parameter_, 1) >> 31) == 0; }
  std::uint16_t can_id() const { return static_cast<std::uint16_t>(get(parameter_, 1) & 0x7FF); }
  unsigned transmission_type() const { return static_cast<unsigned>(get(parameter_, 2)); }
  bool synchronous() const { return transmission_type() <= 240; }
  std::int64_t inhibit_time_100us() const { return get(parameter_, 3); }
  std::int64_t event_time_ms() const { return get(parameter_, 5); }
  // Returns the size of the mapped objects.
  std::size_t size_bytes() const;

  bool maps(std::uint16_t index) const;
  ObjectDictionary::Bytes pack() const;
  // Writes the mapped objects. `data` has size_bytes() at least; values out of range are left out.
  void unpack(std::span<const std::uint8_t> data);

  // While it is locked nothing of it may be changed.
  void lock(bool locked) { locked_ = locked; }
  // Its mapping stays what it is.
  void fix_mapping() { fixed_ = true; }

  std::uint16_t parameter_index() const { return parameter_; }

 private:
  std::optional<canopen::SdoAbort> check_parameter(Address address, std::int64_t value) const;
  std::optional<canopen::SdoAbort> check_mapping(Address address, std::int64_t value) const;
  std::optional<canopen::SdoAbort> check_mapped_object(std::uint32_t entry) const;
  std::int64_t get(std::uint16_t index, std::uint8_t sub) const { return dictionary_->get({index, sub}); }
  std::uint8_t mapped_count() const { return static_cast<std::uint8_t>(get(mapping_, 0)); }
  std::uint32_t mapping_entry(std::uint8_t sub) const { return static_cast<std::uint32_t>(get(mapping_, sub)); }

  ObjectDictionary* dictionary_;
  PdoDirection direction_;
  std::uint16_t parameter_;
  std::uint16_t mapping_;
  bool locked_ = false, fixed_ = false;
};

}  // namespace breakaway::drive_emulator
