// KnownTables: what a reader reads, gathered while it reads.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "breakaway/config/form.hpp"

namespace breakaway::config {

struct Key;

// A key that may be left out has this value then, where that is one and the same in every file.
using Usual = std::optional<std::variant<bool, double, std::string>>;

struct KnownKey {
  std::string name;
  bool required = false;
  std::string expects;  // in words, as errors have it
  Form form;
  Usual usual;
};

// The rows that a reader read of a table. It may read others where the file says something else.
using KnownRows = std::vector<KnownKey>;

// Gathers the rows of every Section that it is given to. A table goes by the keys that lead to it, joined by points, or
// by the name that its row gives it: the file itself by "".
class KnownTables {
 public:
  // Rows that are read together, all that the table may hold.
  void add(const std::string& table, const std::vector<Key>& rows);

  // A row that is read before the others, because its value decides which others there are.
  void add_decisive(const std::string& table, const Key& row);

  // The different sets of rows of each table, in the order in which they were read.
  const std::map<std::string, std::vector<KnownRows>>& tables() const { return tables_; }

  // Names what was not read though a row that was read speaks of it: a table, or a word that decides on other rows.
  std::vector<std::string> unread() const;

 private:
  std::map<std::string, std::vector<KnownRows>> tables_;
  std::map<std::string, std::vector<KnownKey>> decisive_;
};

}  // namespace breakaway::config
