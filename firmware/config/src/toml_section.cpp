#include "breakaway/config/toml_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

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

// Where an array is right, but not this one, its entries tell why.
std::string shown_beside(const Value& value, const toml::node& node) {
  return node.is_array() && value.takes_arrays ? entries_of(*node.as_array()) : shown(node);
}

}  // namespace

Value number(std::function<void(double)> store, std::string_view unit, Range range) {
  return {describe(range, unit), [store = std::move(store), range](const Entry& entry) {
            const auto value = entry.node.is_number() ? entry.node.value<double>() : std::nullopt;
            if (!value || !std::isfinite(*value) || !range.holds(*value)) return false;
            store(*value);
            return true;
          }};
}

Value number(double& to, std::string_view unit, Range range) {
  return number([&to](double value) { to = value; }, unit, range);
}

Value number(std::optional<double>& to, std::string_view unit, Range range) {
  return number([&to](double value) { to = value; }, unit, range);
}

Value duration_s(hal::Duration& to, Range range) {
  return number([&to](double value) { to = hal::Duration{std::llround(value * 1e9)}; }, "s", range);
}

Value integer(std::function<void(std::int64_t)> store, std::int64_t least, std::int64_t most) {
  return {fmt::format("an integer in [{}, {}]", least, most),
          [store = std::move(store), least, most](const Entry& entry) {
            const auto value = entry.node.value_exact<std::int64_t>();
            if (!value || *value < least || *value > most) return false;
            store(*value);
            return true;
          }};
}

Value boolean(bool& to) {
  return {"true or false", [&to](const Entry& entry) {
            const auto value = entry.node.value_exact<bool>();
            to = value.value_or(to);
            return value.has_value();
          }};
}

Value text(std::string& to) {
  return {"text in quotes", [&to](const Entry& entry) {
            const auto value = entry.node.value_exact<std::string>();
            to = value.value_or(to);
            return value.has_value();
          }};
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
          .takes_arrays = true};
}

Value table(std::function<void(const Section&)> read) {
  return {"a table", [read = std::move(read)](const Entry& entry) {
            if (!entry.node.is_table()) return false;
            read(entry.parent.nested(*entry.node.as_table(), entry.key));
            return true;
          }};
}

Value tables(std::function<void(const Section&)> read_entry) {
  return {"an array of one or more tables", [read_entry = std::move(read_entry)](const Entry& entry) {
            if (!entry.node.is_array() || !entry.node.as_array()->is_homogeneous(toml::node_type::table)) return false;
            for (const toml::node& part : *entry.node.as_array()) {
              read_entry(entry.parent.nested(*part.as_table(), entry.key));
            }
            return true;
          }};
}

std::vector<Key> elsewhere(std::initializer_list<std::string_view> names, const std::string& why) {
  const Value refused{
      "", [why](const Entry& entry) -> bool { entry.parent.fail(entry.key, "is not a key here: " + why); }, false};
  std::vector<Key> rows;
  for (const std::string_view name : names) rows.push_back(optional(name, refused));
  return rows;
}

Section Section::nested(const toml::table& inner, std::string_view key) const {
  return {inner, file_, path_.empty() ? std::string{key} : fmt::format("{}.{}", path_, key)};
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
  throw InputError{fmt::format("{}:{}: {}{} {}", file_, std::max(line, 1u), place, key, what)};
}

// Of several unknown keys, the one most like a valid key is named, because a misspelt `kind` makes the keys of that
// kind unknown, too.
void Section::refuse_unknown_keys(const std::vector<Key>& keys) const {
  std::string_view unknown, nearest;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const auto& [key, node] : *table_) {
    if (std::ranges::find(keys, key.str(), &Key::name) != keys.end()) continue;
    for (const Key& row : keys) {
      if (!row.value.belongs_here) continue;
      const std::size_t distance = edit_distance(row.name, key.str());
      if (distance >= least) continue;
      unknown = key.str(), nearest = row.name, least = distance;
    }
  }
  if (least < std::numeric_limits<std::size_t>::max())
    fail(unknown, fmt::format("is not a key here; the nearest valid key is {}", nearest));
}

void Section::read(const Key& row) const {
  const toml::node* node = table_->get(row.name);
  if (node == nullptr && row.required) fail(row.name, fmt::format("is missing; give it {}", row.value.expects));
  if (node != nullptr && !row.value.take({*node, *this, row.name})) {
    fail(row.name, fmt::format("is {}, must be {}", shown_beside(row.value, *node), row.value.expects));
  }
}

void Section::read(const std::vector<Key>& keys) const {
  refuse_unknown_keys(keys);
  for (const Key& row : keys) read(row);
}

}  // namespace breakaway::config
