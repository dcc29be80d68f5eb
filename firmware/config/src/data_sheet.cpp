#include "breakaway/config/data_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <vector>

#include "breakaway/config/file_contents.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

constexpr std::size_t most_of_a_sheet = std::size_t{4} << 20;
constexpr std::uint32_t array = 8, record = 9;

std::string lower(std::string_view text) {
  std::string low{text};
  std::ranges::transform(low, low.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return low;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r\f\v";
  const std::size_t first = text.find_first_not_of(blank);
  return first == std::string_view::npos ? std::string_view{}
                                         : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

// Decimal, hexadecimal after 0x, octal after 0 (CiA 306-1, 4.1).
std::optional<std::int64_t> whole_number(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.remove_prefix(2);
  } else if (text.size() > 1 && text.front() == '0') {
    base = 8;
  }
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (text.empty() || text.front() == '-' || error != std::errc{} || end != text.data() + text.size()) return {};
  return negative ? -value : value;
}

// The number of hexadecimal digits that a section's name is, of at most so many.
std::optional<std::uint32_t> hexadecimal(std::string_view text, std::size_t digits) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.empty() || text.size() > digits || error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

class DataSheetReader {
 public:
  explicit DataSheetReader(const std::string& name) { sheet_.name_ = name; }

  DataSheet read(std::string_view text) {
    take_apart(text);
    if (!sections_.contains("deviceinfo"))
      throw InputError{"has no [DeviceInfo]: give the EDS or DCF file of the drive"}.in_file(sheet_.name_);
    read_device();
    for (const auto& [name, section] : sections_) read_object(name, section);
    note_what_is_listed();
    return std::move(sheet_);
  }

 private:
  struct Section {
    std::size_t line = 0;
    std::map<std::string, std::string> values;  // keys in lower case
  };

  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    throw InputError{fmt::format("{}:{}: {}", sheet_.name_, line, what)};
  }

  void take_apart(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    Section* section = nullptr;
    for (std::size_t number = 1; !text.empty(); ++number) {
      const std::size_t end = text.find('\n');
      take_line(trimmed(text.substr(0, end)), number, section);
      text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    }
  }

  // A line that is neither section nor key belongs to a comment that somebody broke: makers' files have those.
  void take_line(std::string_view line, std::size_t number, Section*& section) {
    if (line.empty() || line.front() == ';' || line.front() == '#') return;
    if (line.front() == '[') {
      const std::size_t end = line.find(']');
      if (end == std::string_view::npos) fail(number, "a section's name does not end: close it by ]");
      const std::string name = lower(trimmed(line.substr(1, end - 1)));
      if (sections_.contains(name))
        fail(number, fmt::format("[{}] stands twice, first in line {}: which one holds? Leave one out", name,
                                 sections_[name].line));
      section = &sections_[name];
      section->line = number;
      return;
    }
    const std::size_t equals = line.find('=');
    if (!section || equals == std::string_view::npos) return;
    section->values.insert_or_assign(lower(trimmed(line.substr(0, equals))),
                                     std::string{trimmed(line.substr(equals + 1))});
  }

  static std::optional<std::string_view> text_of(const Section& section, const std::string& key) {
    const auto found = section.values.find(key);
    if (found == section.values.end() || found->second.empty()) return {};
    return found->second;
  }

  std::int64_t number_of(const Section& section, const std::string& key, std::int64_t usual, std::int64_t most) const {
    const auto text = text_of(section, key);
    if (!text) return usual;
    const auto value = whole_number(*text);
    if (!value || *value < 0 || *value > most)
      fail(section.line, fmt::format("{} = {} is no whole number from 0 to {}", key, *text, most));
    return *value;
  }

  void read_device() {
    const Section& device = sections_["deviceinfo"];
    sheet_.product_ = text_of(device, "productname").value_or("");
    for (const std::uint32_t rate : {10U, 20U, 50U, 125U, 250U, 500U, 800U, 1000U}) {
      if (number_of(device, fmt::format("baudrate_{}", rate), 0, 1) == 1) sheet_.bit_rates_.insert(1000 * rate);
    }
    const auto set = sections_.find("devicecomissioning");  // as CiA 306 spells it
    if (set == sections_.end()) return;
    if (const auto id = number_of(set->second, "nodeid", 0, 127); id != 0)
      sheet_.node_id_ = static_cast<std::uint8_t>(id);
    if (const auto rate = number_of(set->second, "baudrate", 0, 1000); rate != 0)
      sheet_.bit_rate_ = static_cast<std::uint32_t>(1000 * rate);
  }

  // "6040", "1018sub1"; whatever else a section is called is no entry.
  void read_object(const std::string& name, const Section& section) {
    const std::size_t sub = name.find("sub");
    const auto index = hexadecimal(name.substr(0, sub), 4);
    if (!index || *index < 0x1000) return;
    const auto number = static_cast<std::uint16_t>(*index);
    if (sub != std::string::npos) {
      const auto subindex = hexadecimal(name.substr(sub + 3), 2);
      if (!subindex) fail(section.line, fmt::format("[{}]: a sub-index is one or two hexadecimal digits", name));
      sheet_.entries_[{number, static_cast<std::uint8_t>(*subindex)}] = entry_of(section);
      return;
    }
    const auto kind = number_of(section, "objecttype", 7, 0xFF);
    const auto compact = number_of(section, "compactsubobj", 0, 254);
    if (compact > 0) return read_compact(number, section, static_cast<std::uint8_t>(compact));
    if (kind != array && kind != record) sheet_.entries_[{number, std::uint8_t{0}}] = entry_of(section);
  }

  // Entries 1 to n that are alike, and the number of them; [xxxxValue] has their values.
  void read_compact(std::uint16_t index, const Section& section, std::uint8_t count) {
    const auto values = sections_.find(fmt::format("{:x}value", index));
    const SheetEntry alike = entry_of(section);
    sheet_.entries_[{index, std::uint8_t{0}}] = {.type = 5, .readable = true, .value = count};
    for (unsigned i = 1; i <= count; ++i) {
      SheetEntry& entry = sheet_.entries_[{index, static_cast<std::uint8_t>(i)}] = alike;
      if (values == sections_.end()) continue;
      if (const auto text = text_of(values->second, fmt::format("{}", i))) entry.value = value_of(*text, entry);
    }
  }

  SheetEntry entry_of(const Section& section) const {
    SheetEntry entry;
    entry.type = static_cast<std::uint16_t>(number_of(section, "datatype", 0, 0xFFFF));
    const std::string access = lower(text_of(section, "accesstype").value_or("rw"));
    constexpr std::array known{"ro", "wo", "rw", "rwr", "rww", "const"};
    if (std::ranges::find(known, access) == known.end())
      fail(section.line, fmt::format("AccessType = {} is none of ro, wo, rw, rwr, rww and const", access));
    entry.readable = access != "wo";
    entry.writable = access != "ro" && access != "const";
    entry.mappable = number_of(section, "pdomapping", 0, 1) == 1;
    for (const char* key : {"parametervalue", "defaultvalue"}) {
      const auto text = text_of(section, key);
      if (!text) continue;
      entry.value = value_of(*text, entry);
      break;
    }
    entry.least = limit_of(section, "lowlimit");
    entry.most = limit_of(section, "highlimit");
    return entry;
  }

  static std::optional<std::int64_t> limit_of(const Section& section, const char* key) {
    const auto text = text_of(section, key);
    return text ? whole_number(*text) : std::nullopt;
  }

  // "$NODEID+0x180" is so much more than the node id.
  std::optional<std::uint32_t> value_of(std::string_view text, const SheetEntry& entry) const {
    constexpr std::string_view node_id = "$nodeid";
    std::string rest = lower(text);
    std::int64_t added = 0;
    if (const std::size_t at = rest.find(node_id); at != std::string::npos) {
      rest.erase(at, node_id.size());
      std::erase_if(rest, [](char c) { return c == '+' || c == ' ' || c == '\t'; });
      if (rest.empty()) rest = "0";
      added = sheet_.node_id_.value_or(0);
    }
    const auto value = whole_number(rest);
    const bool fits = value && *value >= -0x8000'0000LL && *value + added <= 0xFFFF'FFFFLL;
    if (!fits || entry.bytes() > 4) return {};
    return static_cast<std::uint32_t>(*value + added);
  }

  void note_what_is_listed() {
    for (const char* list : {"mandatoryobjects", "optionalobjects", "manufacturerobjects"}) {
      const auto found = sections_.find(list);
      if (found == sections_.end()) continue;
      for (const auto& [key, text] : found->second.values) {
        const auto index = whole_number(text);
        if (whole_number(key) && index && *index >= 0x1000 && *index <= 0xFFFF)
          sheet_.listed_.insert(static_cast<std::uint16_t>(*index));
      }
    }
  }

  DataSheet sheet_;
  std::map<std::string, Section> sections_;
};

unsigned SheetEntry::bytes() const {
  switch (type) {
    case 0x1:
    case 0x2:
    case 0x5:
      return 1;
    case 0x3:
    case 0x6:
      return 2;
    case 0x4:
    case 0x7:
    case 0x8:
      return 4;
    case 0x10:
    case 0x16:
      return 3;
    case 0x12:
    case 0x18:
      return 5;
    case 0x13:
    case 0x19:
      return 6;
    case 0x14:
    case 0x1A:
      return 7;
    case 0x11:
    case 0x15:
    case 0x1B:
      return 8;
    default:
      return 0;
  }
}

DataSheet DataSheet::parse(std::string_view text, const std::string& name) { return DataSheetReader{name}.read(text); }

DataSheet DataSheet::read(const std::filesystem::path& file) {
  return parse(file_contents(file, most_of_a_sheet), shown_name(file));
}

const SheetEntry* DataSheet::find(std::uint16_t index, std::uint8_t subindex) const {
  const auto found = entries_.find({index, subindex});
  return found == entries_.end() ? nullptr : &found->second;
}

std::optional<std::uint32_t> DataSheet::value(std::uint16_t index, std::uint8_t subindex) const {
  const SheetEntry* entry = find(index, subindex);
  return entry ? entry->value : std::nullopt;
}

bool DataSheet::only_lists(std::uint16_t index) const {
  const auto first = entries_.lower_bound({index, std::uint8_t{0}});
  return listed_.contains(index) && (first == entries_.end() || first->first.first != index);
}

bool DataSheet::has_bit_rate(std::uint32_t bits_per_second) const {
  return bit_rates_.empty() || bit_rates_.contains(bits_per_second);
}

}  // namespace breakaway::config
