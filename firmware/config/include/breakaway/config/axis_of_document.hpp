// Where an axis stands in the TOML of a node.
#pragma once

#include <string_view>

#include "breakaway/config/toml.hpp"

namespace breakaway::config {

// The table that holds [plant] and the rest of the axis of this name: an entry of [[axis]], or the document itself. A
// name is not looked at where there is one axis. nullptr: no axis has it.
inline const toml::table* axis_of_document(const toml::table& document, std::string_view name) {
  const toml::array* const axes = document["axis"].as_array();
  if (axes == nullptr) return &document;
  for (const toml::node& entry : *axes)
    if (entry.is_table() && (axes->size() == 1 || (*entry.as_table())["name"].value<std::string_view>() == name))
      return entry.as_table();
  return nullptr;
}

}  // namespace breakaway::config
