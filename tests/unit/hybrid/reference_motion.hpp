// Motions computed elsewhere in numbers of many digits (tests/reference), and how far one of ours is from them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "breakaway/hybrid/types.hpp"

namespace breakaway::hybrid {

struct ReferenceMotion {
  std::vector<Event> events;
  double end_s = 0;
  std::map<int, double> q, v;  // at the end, by coordinate
};

inline EventKind event_kind(const std::string& name) {
  if (name == "stick") return EventKind::stick;
  return name == "slip" ? EventKind::slip : EventKind::reversal;
}

// The case of that name in a table of tests/reference with the columns case, what, index and value.
inline ReferenceMotion read_reference_motion(const std::string& table, const std::string& name) {
  std::ifstream file(BREAKAWAY_SOURCE_DIR "/tests/reference/" + table);
  ReferenceMotion reference;
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string what[4];
    for (std::string& field : what) std::getline(fields, field, ',');
    if (what[0] != name) continue;
    const int index = std::stoi(what[2]);
    const double value = std::stod(what[3]);
    if (what[1] == "end") {
      reference.end_s = value;
    } else if (what[1] == "q" || what[1] == "v") {
      (what[1] == "q" ? reference.q : reference.v)[index] = value;
    } else {
      reference.events.push_back({value, event_kind(what[1]), index});
    }
  }
  return reference;
}

// The largest error in event times and in the state at the end; the events must be the same ones.
template <int N>
double largest_error(const ReferenceMotion& reference, const std::vector<Event>& log, const MachineState<N>& end) {
  EXPECT_FALSE(reference.q.empty());
  EXPECT_EQ(log.size(), reference.events.size());
  double error = std::abs(end.time_s - reference.end_s);
  for (std::size_t i = 0; i < std::min(log.size(), reference.events.size()); ++i) {
    EXPECT_EQ(log[i].kind, reference.events[i].kind) << "event " << i;
    EXPECT_EQ(log[i].direction, reference.events[i].direction) << "event " << i;
    error = std::max(error, std::abs(log[i].time_s - reference.events[i].time_s));
  }
  for (const auto& [i, q] : reference.q) error = std::max(error, std::abs(end.q[i] - q));
  for (const auto& [i, v] : reference.v) error = std::max(error, std::abs(end.v[i] - v));
  return error;
}

}  // namespace breakaway::hybrid
