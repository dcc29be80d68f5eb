#include "breakaway/eds/to_eds.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

#include "object_names.hpp"

namespace breakaway::eds {
namespace {

// Writes INI text: sections in brackets, and a line "key=value" each. A value stays one line of printable ASCII without
// what readers take for the begin of a comment.
class IniWriter {
 public:
  void section(std::string_view name) { fmt::format_to(std::back_inserter(text_), "\n[{}]\n", name); }
  void value(std::string_view key, std::string_view text) {
    text_.append(key).append("=");
    for (const char c : text) text_ += c >= ' ' && c <= '~' && c != ';' && c != '#' ? c : '_';
    text_ += '\n';
  }
  void value(std::string_view key, std::uint64_t number) { value(key, std::to_string(number)); }
  void hexadecimal(std::string_view key, std::uint64_t number) { value(key, fmt::format("0x{:X}", number)); }

  std::string take() { return text_.substr(1); }

 private:
  std::string text_;
};

using Objects = std::span<const Object>;

void write_file_info(IniWriter& ini, const Device& device, const std::string& file_name,
                     std::chrono::system_clock::time_point made_at) {
  const std::tm utc = fmt::gmtime(std::chrono::system_clock::to_time_t(made_at));
  ini.section("FileInfo");
  ini.value("FileName", file_name);
  ini.value("FileVersion", 1);
  ini.value("FileRevision", 0);
  ini.value("EDSVersion", "4.0");
  ini.value("Description", device.description);
  for (const auto* const what : {"Creation", "Modification"}) {
    ini.value(fmt::format("{}Time", what), fmt::format("{:%I:%M%p}", utc));
    ini.value(fmt::format("{}Date", what), fmt::format("{:%m-%d-%Y}", utc));
  }
  ini.value("CreatedBy", "breakaway");
  ini.value("ModifiedBy", "breakaway");
}

void write_device_info(IniWriter& ini, const Device& device) {
  ini.section("DeviceInfo");
  ini.value("VendorName", "breakaway");
  ini.hexadecimal("VendorNumber", device.vendor);
  ini.value("ProductName", device.name);
  ini.hexadecimal("ProductNumber", device.product);
  ini.hexadecimal("RevisionNumber", device.revision);
  ini.value("OrderCode", "0");
  for (const unsigned rate : bit_rates_kHz)
    ini.value(fmt::format("BaudRate_{}", rate), std::ranges::count(device.bit_rates_kHz, rate) > 0 ? 1 : 0);
  ini.value("SimpleBootUpMaster", 0);
  ini.value("SimpleBootUpSlave", 1);
  ini.value("Granularity", device.rpdos + device.tpdos > 0 ? 8 : 0);  // bits of the smallest object that is mapped
  ini.value("DynamicChannelsSupported", 0);
  ini.value("CompactPDO", 0);
  ini.value("GroupMessaging", 0);
  ini.value("NrOfRXPDO", device.rpdos);
  ini.value("NrOfTXPDO", device.tpdos);
  ini.value("LSS_Supported", 0);
}

// No PDO of these devices takes the place holders of 0001h to 0007h.
void write_dummies_and_comments(IniWriter& ini, const Device& device) {
  ini.section("DummyUsage");
  for (unsigned type = 1; type <= 7; ++type) ini.value(fmt::format("Dummy{:04}", type), 0);
  ini.section("Comments");
  ini.value("Lines", device.comments.size());
  for (std::size_t i = 0; i < device.comments.size(); ++i) ini.value(fmt::format("Line{}", i + 1), device.comments[i]);
}

enum class List { mandatory, optional, manufacturer };

List list_of(std::uint16_t index) {
  if (index == 0x1000 || index == 0x1001 || index == 0x1018) return List::mandatory;
  return index >= 0x2000 && index <= 0x5FFF ? List::manufacturer : List::optional;
}

void write_list(IniWriter& ini, const char* name, Objects objects, List list) {
  std::vector<std::uint16_t> listed;
  for (const Object& object : objects)
    if (list_of(object.index) == list && (listed.empty() || listed.back() != object.index))
      listed.push_back(object.index);
  ini.section(name);
  ini.value("SupportedObjects", listed.size());
  for (std::size_t i = 0; i < listed.size(); ++i) ini.hexadecimal(std::to_string(i + 1), listed[i]);
}

std::string access_text(const Object& object) {
  if (object.access == Access::write_only) return "wo";
  if (object.access == Access::read_only) return "ro";
  if (object.mappable_to_rpdo == object.mappable_to_tpdo) return "rw";
  return object.mappable_to_rpdo ? "rww" : "rwr";
}

void write_entry(IniWriter& ini, const std::string& section, const std::string& name, const Object& object) {
  ini.section(section);
  ini.value("ParameterName", name);
  ini.hexadecimal("ObjectType", static_cast<unsigned>(Kind::variable));
  ini.value("DataType", fmt::format("0x{:04X}", static_cast<unsigned>(object.type)));
  if (object.low) ini.value("LowLimit", std::to_string(*object.low));
  if (object.high) ini.value("HighLimit", std::to_string(*object.high));
  ini.value("AccessType", access_text(object));
  if (object.power_on_value) ini.value("DefaultValue", *object.power_on_value);
  ini.value("PDOMapping", object.mappable_to_rpdo || object.mappable_to_tpdo ? 1 : 0);
}

// entries: all of one index.
void write_object(IniWriter& ini, Objects entries) {
  const std::uint16_t index = entries.front().index;
  const ObjectName known = object_name(index);
  const std::string section = fmt::format("{:04X}", index);
  if (known.kind == Kind::variable) return write_entry(ini, section, known.name, entries.front());
  ini.section(section);
  ini.value("ParameterName", known.name);
  ini.hexadecimal("ObjectType", static_cast<unsigned>(known.kind));
  ini.value("SubNumber", entries.size());
  for (const Object& entry : entries)
    write_entry(ini, fmt::format("{}sub{:X}", section, entry.sub), entry_name(index, entry.sub), entry);
}

}  // namespace

std::string to_eds(const Device& device, const std::string& file_name, std::chrono::system_clock::time_point made_at) {
  IniWriter ini;
  write_file_info(ini, device, file_name, made_at);
  write_device_info(ini, device);
  write_dummies_and_comments(ini, device);
  const std::pair<const char*, List> lists[] = {{"MandatoryObjects", List::mandatory},
                                                {"OptionalObjects", List::optional},
                                                {"ManufacturerObjects", List::manufacturer}};
  for (const auto& [name, list] : lists) {
    write_list(ini, name, device.objects, list);
    for (auto left = Objects{device.objects}; !left.empty();) {
      const auto next = std::ranges::find_if(left, [&](const Object& o) { return o.index != left.front().index; });
      const auto entries = left.first(static_cast<std::size_t>(next - left.begin()));
      if (list_of(entries.front().index) == list) write_object(ini, entries);
      left = left.subspan(entries.size());
    }
  }
  return ini.take();
}

}  // namespace breakaway::eds
