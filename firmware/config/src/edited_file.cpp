#include "breakaway/config/edited_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <sstream>

#include "breakaway/config/parse_toml.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

bool of_the_node(std::string_view table) {
  constexpr std::array tables{"loop", "bus", "run"};
  return std::ranges::find(tables, table) != tables.end();
}

// The table in which those of the axis stand: an entry of [[axis]], or the file itself.
toml::table& tables_of(toml::table& document, const std::string& axis, const Setting& setting) {
  toml::array* const entries = document["axis"].as_array();
  if (entries == nullptr || of_the_node(setting.table)) return document;
  for (toml::node& node : *entries) {
    toml::table* const entry = node.as_table();
    if (entry != nullptr && (axis.empty() || (*entry)["name"].value<std::string_view>() == axis)) return *entry;
  }
  throw InputError{fmt::format("has no axis \"{}\"", axis)};
}

// `load` of `plant.load`.
std::string last_name(const std::string& table) { return table.substr(table.rfind('.') + 1); }

// Of `plant.load` that is [plant], which the file must have.
toml::table& table_above(toml::table& document, const std::string& axis, const Setting& setting) {
  toml::table* above = &tables_of(document, axis, setting);
  std::string_view path = setting.table;
  for (std::size_t dot = path.find('.'); dot != path.npos; dot = path.find('.')) {
    above = (*above)[path.substr(0, dot)].as_table();
    if (above == nullptr) throw InputError{fmt::format("has no table of which [{}] is a part", setting.table)};
    path.remove_prefix(dot + 1);
  }
  return *above;
}

// toml++ counts lines and characters, both from 1.
std::size_t offset_of(std::string_view text, const toml::source_position& place) {
  std::size_t at = 0;
  for (toml::source_index line = 1; line < place.line; ++line) at = text.find('\n', at) + 1;
  const auto begins_character = [&](std::size_t i) { return (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80; };
  for (toml::source_index column = 1; column < place.column && at < text.size(); ++column) {
    do ++at;
    while (at < text.size() && !begins_character(at));
  }
  return at;
}

std::size_t line_after(std::string_view text, toml::source_index line) {
  const std::size_t end = text.find('\n', offset_of(text, {line, 1}));
  return end == text.npos ? text.size() : end + 1;
}

std::string inserted(std::string_view text, std::size_t at, const std::string& what) {
  std::string edited{text};
  return edited.insert(at, what);
}

// Puts a line behind the last value of the table, or else behind its header.
std::string with_line(std::string_view text, const toml::table& table, const std::string& line) {
  toml::source_index last = table.source().begin.line;
  for (const auto& [key, value] : table) {
    const toml::table* const nested = value.as_table();
    if (value.is_array_of_tables() || (nested != nullptr && !nested->is_inline())) continue;
    last = std::max(last, value.source().end.line);
  }
  const std::size_t at = line_after(text, last);
  return inserted(text, at, (at > 0 && text[at - 1] != '\n' ? "\n" : "") + line + "\n");
}

std::string with_table(std::string_view text, const toml::table& above, bool at_top, const Setting& setting) {
  if (at_top) {
    const char* const gap = text.empty() || text.back() == '\n' ? "" : "\n";
    return fmt::format("{}{}\n[{}]\n{} = {}\n", text, gap, setting.table, setting.key, setting.value);
  }
  return with_line(text, above,
                   fmt::format("{} = {{ {} = {} }}", last_name(setting.table), setting.key, setting.value));
}

std::string edited(std::string_view text, const std::string& file, const std::string& axis, const Setting& setting) {
  toml::table document = parse_toml(text, file);  // a copy would not know where its values stand
  const toml::table& above = table_above(document, axis, setting);
  const toml::table* const table = above[last_name(setting.table)].as_table();
  if (table == nullptr) return with_table(text, above, &above == &document, setting);
  if (const toml::node* const value = table->get(setting.key)) {
    const std::size_t begin = offset_of(text, value->source().begin), end = offset_of(text, value->source().end);
    return std::string{text}.replace(begin, end - begin, setting.value);
  }
  const std::string assignment = setting.key + " = " + setting.value;
  if (!table->is_inline()) return with_line(text, *table, assignment);
  const std::size_t brace = offset_of(text, table->source().end) - 1;
  const std::size_t last = text.find_last_not_of(" \t", brace - 1);
  return inserted(text, last + 1, (table->empty() ? " " : ", ") + assignment);
}

// What the settings make of the file, whatever its spelling.
toml::table set_anew(toml::table document, const std::string& axis, const Setting& setting) {
  toml::table& above = table_above(document, axis, setting);
  const std::string name = last_name(setting.table);
  if (!above.contains(name)) above.insert(name, toml::table{});
  const toml::table value = toml::parse("value = " + setting.value);
  above[name].as_table()->insert_or_assign(setting.key, *value.get("value"));
  return document;
}

std::optional<toml::table> parsed_if_valid(const std::string& text) try {
  return toml::parse(text);
} catch (const toml::parse_error&) {
  return {};
}

std::string without_byte_order_mark(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  return std::string{text};
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return std::filesystem::weakly_canonical(file.has_parent_path() ? file.parent_path() : ".");
}

// Links on the way to the sheet's folder are followed, because ".." leads out of where they end; the sheet may be one.
std::string sheet_from(const std::filesystem::path& folder, const std::filesystem::path& sheet) {
  const std::filesystem::path path = (folder_of(sheet) / sheet.filename()).lexically_relative(folder);
  std::ostringstream quoted;
  quoted << toml::value<std::string>{path.string()};
  return quoted.str();
}

}  // namespace

std::string with_settings(std::string_view text, const std::string& file, const std::string& axis,
                          const std::vector<Setting>& settings) try {
  std::string now = without_byte_order_mark(text);
  for (const Setting& setting : settings) {
    const toml::table wanted = set_anew(parse_toml(now, file), axis, setting);
    std::string next = edited(now, file, axis, setting);
    if (parsed_if_valid(next) != wanted) {
      std::ostringstream anew;
      anew << toml::toml_formatter{wanted} << '\n';
      next = anew.str();
    }
    now = std::move(next);
  }
  return now;
} catch (const InputError& error) {
  throw error.file().empty() ? error.in_file(file) : error;
}

std::string moved_text(std::string_view text, const std::filesystem::path& from, const std::filesystem::path& to) {
  std::string moved{text};
  if (to == "-" || folder_of(from) == folder_of(to)) return moved;
  toml::table document = parse_toml(text, from.string());
  const auto move = [&](const toml::table& axis, const std::string& name) {
    const auto sheet = axis["drive"]["eds"].value<std::string>();
    if (!sheet || std::filesystem::path{*sheet}.is_absolute()) return;
    const std::string there = sheet_from(folder_of(to), from.parent_path() / *sheet);
    moved = with_settings(moved, from.string(), name, {{"drive", "eds", there}});
  };
  const toml::array* const entries = document["axis"].as_array();
  if (entries == nullptr) move(document, "");
  for (std::size_t i = 0; entries != nullptr && i < entries->size(); ++i)
    if (const toml::table* const axis = entries->get_as<toml::table>(i)) move(*axis, (*axis)["name"].value_or(""));
  return moved;
}

}  // namespace breakaway::config
