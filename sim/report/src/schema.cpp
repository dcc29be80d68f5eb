#include "breakaway/report/schema.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <variant>
#include <vector>

#include "breakaway/format/json_writer.hpp"

namespace breakaway::report {
namespace {

using config::Form;
using config::KnownKey;
using config::KnownRows;
using format::JsonWriter;
using Type = Form::Type;

// What the different sets of rows of a table say of one key, joined.
struct Property {
  std::vector<Form> forms;            // different ones
  std::vector<std::string> expects;   // different ones
  std::vector<config::Usual> usuals;  // one a set that has the key
  std::size_t requiring = 0;          // sets that require it
};

using Properties = std::map<std::string, Property>;

template <class T>
void add_new(std::vector<T>& to, const T& entry) {
  if (std::ranges::find(to, entry) == to.end()) to.push_back(entry);
}

Properties joined(const std::vector<KnownRows>& sets) {
  Properties all;
  for (const KnownRows& rows : sets) {
    for (const KnownKey& key : rows) {
      Property& property = all[key.name];
      add_new(property.forms, key.form);
      add_new(property.expects, key.expects);
      add_new(property.usuals, key.usual);
      if (key.required) ++property.requiring;
    }
  }
  return all;
}

// Several lists of words are one; other forms stay as they are.
std::vector<Form> simplified(const std::vector<Form>& forms) {
  if (!std::ranges::all_of(forms, [](const Form& form) { return !form.words.empty(); })) return forms;
  Form one = forms.front();
  for (const Form& form : forms)
    for (const std::string& word : form.words) add_new(one.words, word);
  return {one};
}

void write_range(JsonWriter& json, const config::Range& range) {
  constexpr double largest = std::numeric_limits<double>::max();
  if (range.least > -largest) json.member(range.excludes_least ? "exclusiveMinimum" : "minimum", range.least);
  if (range.most < largest) json.member("maximum", range.most);
}

void write_words(JsonWriter& json, std::string_view name, const std::vector<std::string>& words) {
  json.array(name, [&] {
    for (const std::string& word : words) json.value(word);
  });
}

void write_text(JsonWriter& json, const Form& form) {
  json.member("type", "string");
  if (!form.words.empty()) write_words(json, "enum", form.words);
  if (!form.pattern.empty()) json.member("pattern", form.pattern);
}

void write_reference(JsonWriter& json, const std::string& table) { json.member("$ref", "#/$defs/" + table); }

void write_either(JsonWriter& json, const std::vector<Form>& forms);
void write_array(JsonWriter& json, const Form& form);

// The members of the schema of one value.
void write_form(JsonWriter& json, const Form& form) {
  switch (form.type) {
    case Type::number:
    case Type::integer:
      json.member("type", form.type == Type::number ? "number" : "integer");
      return write_range(json, form.range);
    case Type::boolean:
      return json.member("type", "boolean");
    case Type::text:
      return write_text(json, form);
    case Type::array:
      return write_array(json, form);
    case Type::either:
      return write_either(json, form.parts);
    case Type::table:
      return write_reference(json, form.table);
    case Type::tables:
      json.member("type", "array");
      json.member("minItems", 1);
      return json.object("items", [&] { write_reference(json, form.table); });
    case Type::anything:
    case Type::refused:
      return;
  }
}

void write_array(JsonWriter& json, const Form& form) {
  json.member("type", "array");
  if (form.least_entries > 0) json.member("minItems", form.least_entries);
  if (form.most_entries < SIZE_MAX) json.member("maxItems", form.most_entries);
  json.object("items", [&] { write_form(json, form.parts.front()); });
}

void write_either(JsonWriter& json, const std::vector<Form>& forms) {
  if (forms.size() == 1) return write_form(json, forms.front());
  json.array("anyOf", [&] {
    for (const Form& form : forms) json.object([&] { write_form(json, form); });
  });
}

void write_property(JsonWriter& json, const std::string& name, const Property& property) {
  json.object(name, [&] {
    write_either(json, simplified(property.forms));
    const Type type = property.forms.front().type;
    if (property.expects.size() == 1 && type != Type::table && type != Type::tables)
      json.member("description", property.expects.front());
    if (property.usuals.size() == 1 && property.usuals.front())
      std::visit([&](const auto& usual) { json.member("default", usual); }, *property.usuals.front());
  });
}

void write_required(JsonWriter& json, const KnownRows& rows) {
  json.array("required", [&] {
    for (const KnownKey& key : rows)
      if (key.required) json.value(key.name);
  });
}

// One set of rows: which keys it has, and the words that tell it from other sets.
void write_set(JsonWriter& json, const KnownRows& rows, const Properties& all) {
  json.object([&] {
    write_required(json, rows);
    json.object("propertyNames", [&] {
      json.array("enum", [&] {
        for (const KnownKey& key : rows) json.value(key.name);
      });
    });
    json.object("properties", [&] {
      for (const KnownKey& key : rows)
        if (!key.form.words.empty() && all.at(key.name).forms.size() > 1)
          json.object(key.name, [&] { write_words(json, "enum", key.form.words); });
    });
  });
}

// Whether two sets of rows differ in more than what a value may be.
bool told_apart(const KnownRows& a, const KnownRows& b) {
  return !std::ranges::equal(a, b, [](const KnownKey& one, const KnownKey& other) {
    return one.name == other.name && one.required == other.required && one.form.words == other.form.words;
  });
}

// Every key is named once, so that an editor points at the one that is wrong; which go together comes last.
void write_table(JsonWriter& json, const std::vector<KnownRows>& sets) {
  const Properties all = joined(sets);
  json.member("type", "object");
  json.object("properties", [&] {
    for (const auto& [name, property] : all) write_property(json, name, property);
  });
  json.array("required", [&] {
    for (const auto& [name, property] : all)
      if (property.requiring == sets.size()) json.value(name);
  });
  json.member("additionalProperties", false);
  std::vector<KnownRows> apart;
  for (const KnownRows& rows : sets)
    if (std::ranges::all_of(apart, [&](const KnownRows& other) { return told_apart(rows, other); }))
      apart.push_back(rows);
  if (apart.size() == 1) return;
  json.array("anyOf", [&] {
    for (const KnownRows& rows : apart) write_set(json, rows, all);
  });
}

}  // namespace

std::string to_json_schema(const config::KnownTables& known) {
  JsonWriter json;
  json.object([&] {
    json.member("$schema", "https://json-schema.org/draft/2020-12/schema");
    json.member("title", "A node of breakaway, its axes, and the world around them");
    write_table(json, known.tables().at(""));
    json.object("$defs", [&] {
      for (const auto& table : known.tables())
        if (!table.first.empty()) json.object(table.first, [&] { write_table(json, table.second); });
    });
  });
  return json.text();
}

}  // namespace breakaway::report
