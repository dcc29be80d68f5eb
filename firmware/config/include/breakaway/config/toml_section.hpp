// A table of a TOML file, read by rows: each row says what a key is called, what it may hold and where that goes. All
// errors about keys, types and ranges come from here, as InputError.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "breakaway/config/form.hpp"
#include "breakaway/config/known_tables.hpp"
#include "breakaway/config/toml.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::config {

class Section;

inline constexpr Range positive{0, 1e12, true};
// Of springs [N/m] and dampers [N s/m].
inline constexpr Range spring{1, 1e10};
inline constexpr Range damping{0, 1e10};

struct Entry {
  const toml::node& node;
  const Section& parent;
  std::string_view key;
};

// Says what a key may hold. `take` stores the value, or returns false when it does not fit `expects`.
struct Value {
  std::string expects;
  std::function<bool(const Entry&)> take;
  Form form{};
  Usual usual{};
};

enum class Presence : std::uint8_t {
  optional,
  required,
  required_later,  // whoever reads the row misses it after other rows
};

struct Key {
  std::string_view name;
  Presence presence;
  Value value;
};

inline Key required(std::string_view name, Value value) { return {name, Presence::required, std::move(value)}; }
inline Key required_later(std::string_view name, Value value) {
  return {name, Presence::required_later, std::move(value)};
}
inline Key optional(std::string_view name, Value value) { return {name, Presence::optional, std::move(value)}; }

Value number(std::function<void(double)> store, std::string_view unit, Range range = {});
Value number(double& to, std::string_view unit, Range range = {});
Value number(std::optional<double>& to, std::string_view unit, Range range = {});
Value duration_s(hal::Duration& to, Range range);
Value integer(std::function<void(std::int64_t)> store, std::int64_t least, std::int64_t most);
Value boolean(bool& to);
Value text(std::string& to);
Value numbers(std::vector<double>& to, std::string_view unit, Range range = {});
// A table, or an array of tables. `name` is that of the table in KnownTables, for a table that stands in several
// places.
Value table(std::function<void(const Section&)> read, const std::string& name = {});
Value tables(std::function<void(const Section&)> read_entry, const std::string& name = {});

// The key must hold one of the names of `choices`.
template <class T>
Value choice(T& to, std::vector<std::pair<std::string_view, T>> choices) {
  std::string names;
  Form form{.type = Form::Type::text};
  Usual usual;
  for (const auto& [name, value] : choices) {
    names += (names.empty() ? "\"" : " or \"") + std::string{name} + "\"";
    form.words.emplace_back(name);
    if (value == to) usual = std::string{name};
  }
  return {names,
          [&to, choices = std::move(choices)](const Entry& entry) {
            const auto given = entry.node.value_exact<std::string_view>();
            for (const auto& [name, value] : choices) {
              if (given != name) continue;
              to = value;
              return true;
            }
            return false;
          },
          std::move(form), std::move(usual)};
}

// Rows for keys that another kind of file has: whoever writes one here is told so, "is not a key here: why". They are
// not offered to whoever misspells another key.
std::vector<Key> elsewhere(std::initializer_list<std::string_view> names, const std::string& why);

// Joins two lists of rows.
inline std::vector<Key> operator+(std::vector<Key> rows, std::vector<Key> others) {
  std::ranges::move(others, std::back_inserter(rows));
  return rows;
}

// The name of a table in KnownTables, unless its row gives it another.
std::string inner_name(const std::string& table, std::string_view key);

class Section {
 public:
  // `known` gathers what is read of this table and of those in it; nullptr: nobody does. It must outlive them.
  Section(const toml::table& table, std::string file, std::string path, KnownTables* known = nullptr)
      : table_{&table}, file_{std::move(file)}, path_{std::move(path)}, known_{known} {}

  // Reads every row. Throws InputError on a key that no row names, a required one that is absent, a value that does not
  // fit.
  void read(const std::vector<Key>& keys) const;

  // Reads one row, whatever else is there: for a key that decides which others are valid. It has a name of its own,
  // because read({row}) must refuse the keys beside that one.
  void read_alone(const Key& row) const;

  // Returns the section of a nested table, as [outer.inner]. `name`: see table().
  Section nested(const toml::table& inner, std::string_view key, const std::string& name = {}) const;

  bool has(std::string_view key) const { return table_->contains(key); }

  // From where the file names other files.
  std::filesystem::path folder() const { return std::filesystem::path{file_}.parent_path(); }

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
  void refuse_keys_of_other_tables(const std::vector<Key>& keys) const;
  void read_row(const Key& row) const;

  const toml::table* table_;
  std::string file_;
  std::string path_;
  KnownTables* known_;
  std::string name_{};  // in known_
};

}  // namespace breakaway::config
