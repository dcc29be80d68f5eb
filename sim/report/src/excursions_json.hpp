// How far and how fast an axis went, and what it left of its limits.
#pragma once

#include <vector>

#include "breakaway/format/json_writer.hpp"
#include "breakaway/sil/margins.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::report {

inline void write_excursions(format::JsonWriter& json, const sil::Excursions& e) {
  json.member("overshoot_m", e.overshoot_m);
  json.member("beyond_m", e.beyond_m);
  json.member("peak_speed_m_s", e.peak_speed_m_s);
  json.member("lowest_m", e.lowest_m);
  json.member("highest_m", e.highest_m);
}

inline void write_margins(format::JsonWriter& json, const std::vector<sil::Margin>& margins) {
  json.object("margins", [&] {
    for (const sil::Margin& margin : margins) json.member(margin.name, margin.left);
  });
}

}  // namespace breakaway::report
