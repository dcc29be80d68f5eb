#pragma once

#include <vector>

#include "breakaway/design/attractivity.hpp"
#include "breakaway/report/json_writer.hpp"

namespace breakaway::cli {

inline void write_conditions(report::JsonWriter& json, const std::vector<design::Condition>& conditions) {
  json.array("conditions", [&] {
    for (const design::Condition& condition : conditions) {
      json.object([&] {
        json.member("name", condition.name);
        json.member("holds", condition.holds);
        json.member("margin", condition.margin);
        json.member("reason", condition.reason);
      });
    }
  });
}

}  // namespace breakaway::cli
