// What a key of a TOML file may hold, as data: what the schema for editors is made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace breakaway::config {

struct Range {
  double least = -std::numeric_limits<double>::max();
  double most = std::numeric_limits<double>::max();
  bool excludes_least = false;

  bool holds(double value) const { return (excludes_least ? value > least : value >= least) && value <= most; }
  bool operator==(const Range&) const = default;
};

struct Form {
  enum class Type : std::uint8_t {
    anything,
    number,
    integer,
    boolean,
    text,
    array,    // every entry has the form parts[0]
    either,   // one of the forms in `parts`
    table,    // `table` names it
    tables,   // one or more of these
    refused,  // the key belongs elsewhere, and nothing fits
  };

  Type type = Type::anything;
  Range range{};                        // of a number or an integer
  std::vector<std::string> words{};     // a text must be one of these; empty: any text
  std::string pattern{};                // a text must match this regular expression; empty: any
  std::vector<Form> parts{};            // see Type
  std::size_t least_entries = 0;        // of an array
  std::size_t most_entries = SIZE_MAX;  // of an array
  std::string table{};                  // its name in KnownTables; empty: that of the table it stands in, and its key

  bool operator==(const Form&) const = default;
};

}  // namespace breakaway::config
