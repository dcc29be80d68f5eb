// DataSheet: what a maker says of a CANopen device, in an electronic data sheet (EDS) or a device configuration file
// (DCF), CiA 306-1.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace breakaway::config {

// One entry of the object dictionary.
struct SheetEntry {
  std::uint16_t type = 0;  // the data type's number, CiA 301, 7.4.7
  bool readable = false;
  bool writable = false;
  bool mappable = false;
  // ParameterValue of a DCF, or else DefaultValue, as 32 bits; nothing where there is none, or none that is a whole
  // number.
  std::optional<std::uint32_t> value{};
  std::optional<std::int64_t> least{}, most{};  // LowLimit, HighLimit

  // 0: a type that is no number of 1 to 8 bytes.
  unsigned bytes() const;
};

class DataSheet {
 public:
  // `name` is for errors. Throws InputError with file and line for what is no data sheet, and for an entry that cannot
  // be read or stands twice.
  static DataSheet parse(std::string_view text, const std::string& name);
  static DataSheet read(const std::filesystem::path& file);

  const std::string& name() const { return name_; }
  const std::string& product() const { return product_; }

  // nullptr: the device has no such entry.
  const SheetEntry* find(std::uint16_t index, std::uint8_t subindex) const;
  std::optional<std::uint32_t> value(std::uint16_t index, std::uint8_t subindex) const;

  // Whether it stands in a list of objects and has no section.
  bool only_lists(std::uint16_t index) const;

  // Whether the device can; every bit rate where the sheet names none.
  bool has_bit_rate(std::uint32_t bits_per_second) const;
  // Of a DCF: how this device is set.
  std::optional<std::uint8_t> node_id() const { return node_id_; }
  std::optional<std::uint32_t> bit_rate() const { return bit_rate_; }

 private:
  friend class DataSheetReader;

  std::string name_, product_;
  std::map<std::pair<std::uint16_t, std::uint8_t>, SheetEntry> entries_;
  std::set<std::uint16_t> listed_;
  std::set<std::uint32_t> bit_rates_;
  std::optional<std::uint8_t> node_id_;
  std::optional<std::uint32_t> bit_rate_;
};

}  // namespace breakaway::config
