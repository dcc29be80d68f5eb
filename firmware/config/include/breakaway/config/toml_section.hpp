// A table of a TOML file, read by rows: each row says what a key is called, what it may hold and where that goes. All
// errors about keys, types and ranges come from here, as InputError.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "breakaway/config/toml.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::config {

class Section;

struct Range {
  double least = -std::numeric_limits<double>::max();
  double most = std::numeric_limits<double>::max();
  bool excludes_least = false;

  bool holds(double value) const { return (excludes_least ? value > least : value >= least) && value <= most; }
};

inline constexpr Range positive{0, 1e12, true};

struct Entry {
  const toml::node& node;
  const Section& parent;
  std::string_view key;
};

// Says what a key may hold. `take` stores the value, or returns false when it does not fit `expects`.
struct Value {
  std::string expects;
  std::function<bool(const Entry&)> take;
  bool belongs_here = true;   // false: see elsewhere()
  bool takes_arrays = false;  // where one is right, but not this one, an error shows its entries
};

struct Key {
  std::string_view name;
  bool required;
  Value value;
};

inline Key required(std::string_view name, Value value) { return {name, true, std::move(value)}; }
inline Key optional(std::string_view name, Value value) { return {name, false, std::move(value)}; }

Value number(std::function<void(double)> store, std::string_view unit, Range range = {});
Value number(double& to, std::string_view unit, Range range = {});
Value number(std::optional<double>& to, std::string_view unit, Range range = {});
Value duration_s(hal::Duration& to, Range range);
Value integer(std::function<void(std::int64_t)> store, std::int64_t least, std::int64_t most);
Value boolean(bool& to);
Value text(std::string& to);
Value numbers(std::vector<double>& to, std::string_view unit, Range range = {});
Value table(std::function<void(const Section&)> read);
Value tables(std::function<void(const Section&)> read_entry);  // an array of tables

// The key must hold one of the names of `choices`.
template <class T>
Value choice(T& to, std::vector<std::pair<std::string_view, T>> choices) {
  std::string names;
  for (const auto& [name, value] : choices) names += (names.empty() ? "\"" : " or \"") + std::string{name} + "\"";
  return {names, [&to, choices = std::move(choices)](const Entry& entry) {
            const auto given = entry.node.value_exact<std::string_view>();
            for (const auto& [name, value] : choices) {
              if (given != name) continue;
              to = value;
              return true;
            }
            return false;
          }};
}

// Rows for keys that another kind of file has: whoever writes one here is told so, "is not a key here: why". They are
// not offered to whoever misspells another key.
std::vector<Key> elsewhere(std::initializer_list<std::string_view> names, const std::string& why);

// Joins two lists of rows.
inline std::vector<Key> operator+(std::vector<Key> rows, std::vector<Key> others) {
  std::ranges::move(others, std::back_inserter(rows));
  return rows;
}

class Section {
 public:
  Section(const toml::table& table, std::string file, std::string path)
      : table_{&table}, file_{std::move(file)}, path_{std::move(path)} {}

  // Reads every row. Throws InputError on a key that no row names, a required one that is absent, a value that does not
  // fit.
  void read(const std::vector<Key>& keys) const;

  // Reads one row, whatever else is there: for a key that decides which others are valid.
  void read(const Key& row) const;

  // Returns the section of a nested table, as [outer.inner].
  Section nested(const toml::table& inner, std::string_view key) const;

  bool has(std::string_view key) const { return table_->contains(key); }

  // Returns the text under `key` if there is any, for a key that decides which other keys are valid.
  std::optional<std::string_view> word(std::string_view key) const { return (*table_)[key].value<std::string_view>(); }

  // These look at what another reader checks, without a word about it: nothing where there is no such thing.
  std::vector<std::string_view> keys() const;
  std::optional<double> number_at(std::string_view key) const { return (*table_)[key].value<double>(); }
  std::vector<double> numbers_at(std::string_view key) const;
  std::optional<Section> table_at(std::string_view key) const;
  std::vector<Section> tables_at(std::string_view key) const;

  // Throws InputError with the place of `key` here, or of the section if it is absent.
  [[noreturn]] void fail(std::string_view key, const std::string& what) const;

 private:
  void refuse_unknown_keys(const std::vector<Key>& keys) const;

  const toml::table* table_;
  std::string file_;
  std::string path_;
};

}  // namespace breakaway::config
