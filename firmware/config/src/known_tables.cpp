#include "breakaway/config/known_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {
namespace {

using Type = Form::Type;

bool is_table(const Form& form) { return form.type == Type::table || form.type == Type::tables; }

KnownKey known(const std::string& table, const Key& row) {
  KnownKey key{std::string{row.name}, row.presence != Presence::optional, row.value.expects, row.value.form,
               row.presence == Presence::optional ? row.value.usual : Usual{}};
  if (is_table(key.form) && key.form.table.empty()) key.form.table = inner_name(table, row.name);
  return key;
}

bool same_but_usual(const KnownKey& a, const KnownKey& b) {
  return a.name == b.name && a.required == b.required && a.form == b.form;
}

// What differs from file to file is not usual.
void keep_common_usuals(KnownRows& rows, const KnownRows& others) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].usual != others[i].usual) rows[i].usual.reset();
}

}  // namespace

void KnownTables::add(const std::string& table, const std::vector<Key>& rows) {
  KnownRows read;
  for (const Key& row : rows)
    if (row.value.form.type != Type::refused) read.push_back(known(table, row));
  std::ranges::sort(read, {}, &KnownKey::name);
  for (KnownRows& before : tables_[table])
    if (std::ranges::equal(before, read, same_but_usual)) return keep_common_usuals(before, read);
  tables_[table].push_back(std::move(read));
}

void KnownTables::add_decisive(const std::string& table, const Key& row) {
  decisive_[table].push_back(known(table, row));
}

std::vector<std::string> KnownTables::unread() const {
  std::set<std::string> missing;
  for (const auto& [table, variants] : tables_)
    for (const KnownRows& rows : variants)
      for (const KnownKey& key : rows)
        if (is_table(key.form) && !tables_.contains(key.form.table)) missing.insert("[" + key.form.table + "]");
  for (const auto& [table, keys] : decisive_) {
    for (const KnownKey& key : keys) {
      const auto found = tables_.find(table);
      for (const std::string& word : key.form.words) {
        const auto reads = [&](const KnownRows& rows) {
          return std::ranges::any_of(rows, [&](const KnownKey& read) {
            return read.name == key.name && std::ranges::count(read.form.words, word) > 0;
          });
        };
        if (found == tables_.end() || std::ranges::none_of(found->second, reads))
          missing.insert(fmt::format("[{}] {} = \"{}\"", table, key.name, word));
      }
    }
  }
  return {missing.begin(), missing.end()};
}

}  // namespace breakaway::config
