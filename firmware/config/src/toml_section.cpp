#include "breakaway/config/toml_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "breakaway/config/certificate_keys.hpp"
#include "breakaway/input/edit_distance.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

std::string with_unit(const std::string& expects, std::string_view unit) {
  return unit.empty() ? expects : fmt::format("{} {}", expects, unit);
}

std::string describe(Range range, std::string_view unit) {
  constexpr double largest = std::numeric_limits<double>::max();
  const bool open_above = range.most >= largest;
  if (range.least <= -largest && open_above) return with_unit("a finite number", unit);
  if (open_above)
    return with_unit(fmt::format("a finite number {} {:g}", range.excludes_least ? ">" : ">=", range.least), unit);
  return with_unit(fmt::format("a number in {}{:g}, {:g}]", range.excludes_least ? '(' : '[', range.least, range.most),
                   unit);
}

std::string shown(const toml::node& node);

std::string entries_of(const toml::array& array) {
  std::string entries;
  for (const toml::node& entry : array) {
    constexpr std::size_t most_characters = 60;
    if (entries.size() > most_characters) return "[" + entries + ", ...]";
    const toml::array* nested = entry.as_array();
    entries += (entries.empty() ? "" : ", ") + (nested != nullptr ? entries_of(*nested) : shown(entry));
  }
  return "[" + entries + "]";
}

std::string shown(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "an array";
  if (node.is_floating_point()) return fmt::format("{}", node.value<double>().value());
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return out.str();
}

bool takes(Form::Type type, const Form& form) {
  return form.type == type || (form.type == Form::Type::either &&
                               std::ranges::any_of(form.parts, [&](const Form& part) { return takes(type, part); }));
}

// What holds where the key is left out, if it could be written.
Usual usual_number(double value, Range range) {
  return std::isfinite(value) && range.holds(value) ? Usual{value} : Usual{};
}

Value with_usual(Value value, Usual usual) {
  value.usual = std::move(usual);
  return value;
}

// Where an array is right, but not this one, its entries tell why. Where an integer is, 1.0 is shown to be none.
std::string shown_beside(const Value& value, const toml::node& node) {
  if (node.is_array() && takes(Form::Type::array, value.form)) return entries_of(*node.as_array());
  std::string text = shown(node);
  if (node.is_floating_point() && takes(Form::Type::integer, value.form) &&
      text.find_first_not_of("-0123456789") == text.npos)
    text += ".0";
  return text;
}

struct NearestKey {
  std::string_view name{};
  std::size_t distance = std::numeric_limits<std::size_t>::max();
};

// A key without its unit, as `mass` for `mass_kg` or the papers' `k1`, is like it whatever else is as short.
std::size_t unlikeness(std::string_view name, std::string_view key) {
  const bool lacks_unit = name.size() > key.size() && name.starts_with(key) && name[key.size()] == '_';
  return lacks_unit ? 1 : edit_distance(name, key);
}

// The first of the rows that are most like this key; rows that only refuse are not offered.
NearestKey nearest_key(const std::vector<Key>& rows, std::string_view key) {
  NearestKey nearest;
  for (const Key& row : rows) {
    if (row.value.form.type == Form::Type::refused) continue;
    const std::size_t distance = unlikeness(row.name, key);
    if (distance < nearest.distance) nearest = {row.name, distance};
  }
  return nearest;
}

// How a node's file writes the header of the table that a certificate calls so.
std::string table_header(std::string_view table, bool in_axis) {
  static const std::map<std::string_view, std::string_view> outer{{"targets", "controller.targets"},
                                                                  {"quirks", "drive.quirks"},
                                                                  {"stm32f405", "target.stm32f405"},
                                                                  {"zynqmp_r5", "target.zynqmp_r5"}};
  static const std::set<std::string_view> of_the_node{"loop", "bus", "run", "stm32f405", "zynqmp_r5"};
  const auto nested = outer.find(table);
  return fmt::format("[{}{}]", in_axis && !of_the_node.contains(table) ? "axis." : "",
                     nested == outer.end() ? table : nested->second);
}

// The tables of a node's file that have this key, in words; nothing where the table that stands at `path` has it, or
// is none of a node.
std::string tables_that_have(std::string_view key, const std::string& path, bool in_axis) {
  const std::string here = path.substr(path.rfind('.') + 1);
  const auto rows = certificate_keys();
  if (std::ranges::find(rows, here, &CertificateKey::table) == rows.end()) return {};
  std::string names;
  for (const CertificateKey& row : rows) {
    if (row.key != key || row.table.empty() || row.table == "axis") continue;
    if (row.table == here) return {};
    names += (names.empty() ? "" : " or ") + table_header(row.table, in_axis);
  }
  return names;
}

}  // namespace

Value number(std::function<void(double)> store, std::string_view unit, Range range) {
  return {describe(range, unit),
          [store = std::move(store), range](const Entry& entry) {
            const auto value = entry.node.is_number() ? entry.node.value<double>() : std::nullopt;
            if (!value || !std::isfinite(*value) || !range.holds(*value)) return false;
            store(*value);
            return true;
          },
          {.type = Form::Type::number, .range = range}};
}

Value number(double& to, std::string_view unit, Range range) {
  return with_usual(number([&to](double value) { to = value; }, unit, range), usual_number(to, range));
}

Value number(std::optional<double>& to, std::string_view unit, Range range) {
  return number([&to](double value) { to = value; }, unit, range);
}

Value duration_s(hal::Duration& to, Range range) {
  return with_usual(number([&to](double value) { to = hal::Duration{std::llround(value * 1e9)}; }, "s", range),
                    usual_number(hal::seconds(to), range));
}

Value integer(std::function<void(std::int64_t)> store, std::int64_t least, std::int64_t most) {
  return {fmt::format("an integer in [{}, {}]", least, most),
          [store = std::move(store), least, most](const Entry& entry) {
            const auto value = entry.node.value_exact<std::int64_t>();
            if (!value || *value < least || *value > most) return false;
            store(*value);
            return true;
          },
          {.type = Form::Type::integer,
           .range = {static_cast<double>(least), most < INT64_MAX ? static_cast<double>(most) : Range{}.most}}};
}

Value boolean(bool& to) {
  return {"true or false",
          [&to](const Entry& entry) {
            const auto value = entry.node.value_exact<bool>();
            to = value.value_or(to);
            return value.has_value();
          },
          {.type = Form::Type::boolean},
          to};
}

Value text(std::string& to) {
  return {"text in quotes",
          [&to](const Entry& entry) {
            const auto value = entry.node.value_exact<std::string>();
            to = value.value_or(to);
            return value.has_value();
          },
          {.type = Form::Type::text}};
}

Value numbers(std::vector<double>& to, std::string_view unit, Range range) {
  return {.expects = "an array, each entry " + describe(range, unit),
          .take =
              [&to, range](const Entry& entry) {
                if (!entry.node.is_array()) return false;
                for (const toml::node& part : *entry.node.as_array()) {
                  const Value one = number([&to](double value) { to.push_back(value); }, "", range);
                  if (!one.take({part, entry.parent, entry.key})) return false;
                }
                return true;
              },
          .form = {.type = Form::Type::array, .parts = {{.type = Form::Type::number, .range = range}}}};
}

Value table(std::function<void(const Section&)> read, const std::string& name) {
  return {"a table",
          [read = std::move(read), name](const Entry& entry) {
            if (!entry.node.is_table()) return false;
            read(entry.parent.nested(*entry.node.as_table(), entry.key, name));
            return true;
          },
          {.type = Form::Type::table, .table = name}};
}

Value tables(std::function<void(const Section&)> read_entry, const std::string& name) {
  return {"an array of one or more tables",
          [read_entry = std::move(read_entry), name](const Entry& entry) {
            if (!entry.node.is_array() || !entry.node.as_array()->is_homogeneous(toml::node_type::table)) return false;
            for (const toml::node& part : *entry.node.as_array()) {
              read_entry(entry.parent.nested(*part.as_table(), entry.key, name));
            }
            return true;
          },
          {.type = Form::Type::tables, .table = name}};
}

std::vector<Key> elsewhere(std::initializer_list<std::string_view> names, const std::string& why) {
  const Value refused{"",
                      [why](const Entry& entry) -> bool { entry.parent.fail(entry.key, "is not a key here: " + why); },
                      {.type = Form::Type::refused}};
  std::vector<Key> rows;
  for (const std::string_view name : names) rows.push_back(optional(name, refused));
  return rows;
}

std::string inner_name(const std::string& table, std::string_view key) {
  return table.empty() ? std::string{key} : fmt::format("{}.{}", table, key);
}

Section Section::nested(const toml::table& inner, std::string_view key, const std::string& name) const {
  Section section{inner, file_, inner_name(path_, key), known_};
  section.name_ = name.empty() ? inner_name(name_, key) : name;
  return section;
}

std::vector<std::string_view> Section::keys() const {
  std::vector<std::string_view> names;
  for (const auto& [key, node] : *table_) names.push_back(key.str());
  return names;
}

std::vector<double> Section::numbers_at(std::string_view key) const {
  std::vector<double> all;
  if (const toml::array* array = (*table_)[key].as_array(); array != nullptr)
    for (const toml::node& entry : *array)
      if (const auto value = entry.value<double>()) all.push_back(*value);
  return all;
}

std::optional<Section> Section::table_at(std::string_view key) const {
  const toml::table* inner = (*table_)[key].as_table();
  return inner != nullptr ? std::optional{nested(*inner, key)} : std::nullopt;
}

std::vector<Section> Section::tables_at(std::string_view key) const {
  std::vector<Section> entries;
  if (const toml::array* array = (*table_)[key].as_array(); array != nullptr)
    for (const toml::node& entry : *array)
      if (entry.is_table()) entries.push_back(nested(*entry.as_table(), key));
  return entries;
}

void Section::fail(std::string_view key, const std::string& what) const {
  const toml::node* at = table_->get(key);
  const auto line = (at != nullptr ? at : table_)->source().begin.line;
  const std::string place = path_.empty() ? "" : fmt::format("[{}] ", path_);
  throw InputError{fmt::format("{}{} {}", place, key, what)}.in_file(fmt::format("{}:{}", file_, std::max(line, 1u)));
}

void Section::refuse_keys_of_other_tables(const std::vector<Key>& keys) const {
  const bool in_axis = path_.starts_with("axis") || has("axis");
  for (const auto& [key, node] : *table_) {
    if (std::ranges::find(keys, key.str(), &Key::name) != keys.end()) continue;
    const std::string tables = tables_that_have(key.str(), path_, in_axis);
    if (tables.empty()) continue;
    const auto [nearest, distance] = nearest_key(keys, key.str());
    const bool near = !nearest.empty() && 2 * distance <= std::max(nearest.size(), key.str().size());
    fail(key.str(), fmt::format("is not a key here; it stands below {}: move it there, or write that header above it{}",
                                tables, near ? fmt::format("; the nearest valid key here is {}", nearest) : ""));
  }
}

// Of several unknown keys, the one most like a valid key is named, because a misspelt `kind` makes the keys of that
// kind unknown, too.
void Section::refuse_unknown_keys(const std::vector<Key>& keys) const {
  refuse_keys_of_other_tables(keys);
  std::string_view unknown;
  NearestKey nearest;
  for (const auto& [key, node] : *table_) {
    if (std::ranges::find(keys, key.str(), &Key::name) != keys.end()) continue;
    const NearestKey found = nearest_key(keys, key.str());
    if (found.distance < nearest.distance) unknown = key.str(), nearest = found;
  }
  if (!nearest.name.empty()) fail(unknown, fmt::format("is not a key here; the nearest valid key is {}", nearest.name));
}

void Section::read_alone(const Key& row) const {
  if (known_ != nullptr) known_->add_decisive(name_, row);
  read_row(row);
}

void Section::read_row(const Key& row) const {
  const toml::node* node = table_->get(row.name);
  if (node == nullptr && row.presence == Presence::required)
    fail(row.name, fmt::format("is missing; give it {}", row.value.expects));
  if (node != nullptr && !row.value.take({*node, *this, row.name})) {
    fail(row.name, fmt::format("is {}, must be {}", shown_beside(row.value, *node), row.value.expects));
  }
}

void Section::read(const std::vector<Key>& keys) const {
  if (known_ != nullptr) known_->add(name_, keys);
  refuse_unknown_keys(keys);
  for (const Key& row : keys) read_row(row);
}

}  // namespace breakaway::config
