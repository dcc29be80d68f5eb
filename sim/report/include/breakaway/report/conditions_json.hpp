// The conditions of a certificate, each with its margin.
#pragma once

#include <vector>

#include "breakaway/format/json_writer.hpp"
#include "breakaway/stability/attractivity.hpp"

namespace breakaway::report {

inline void write_conditions(format::JsonWriter& json, const std::vector<stability::Condition>& conditions) {
  json.array("conditions", [&] {
    for (const stability::Condition& condition : conditions) {
      json.object([&] {
        json.member("name", condition.name);
        json.member("holds", condition.holds);
        json.member("margin", condition.margin);
        json.member("reason", condition.reason);
      });
    }
  });
}

}  // namespace breakaway::report
