// Switches of the force while the axis moves: mass, latency and lag.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "breakaway/evaluation/identification.hpp"
#include "constant_force.hpp"

namespace breakaway::evaluation {

// How a record is looked at.
struct Look {
  std::size_t settling = 12;  // readings from a command on that do not show it yet, or not wholly
  bool uneven = false;        // the readings scatter by more than counts do, as those at uneven times

  // Of the readings first .. last - 1.
  double scatter_m(const Record& record, std::size_t first, std::size_t last) const {
    return uneven ? evaluation::scatter_m(record, first, last) : rounding_m(record);
  }
};

// The force went from before to after in reading `at`, and the axis went on in its direction.
struct Switch {
  std::size_t at = 0;
  std::size_t readings = 0;  // of the shorter of the two parabolas
  std::size_t from = 0;      // the axis goes its way from this reading to ...
  std::size_t to = 0;        // ... the one before this
  double change_N = 0;       // of the command
  Parabola before, after;

  double change_m_s2() const { return after.acceleration_m_s2 - before.acceleration_m_s2; }
  double error_m_s2() const { return std::hypot(after.error_m_s2, before.error_m_s2); }
  double mass_kg() const { return change_N / change_m_s2(); }
};

// If a switch is as likely to show too little as too much, the truth is beyond all of six with a chance of 1 in 32.
constexpr std::size_t least_switches = 6;

// Requires one value.
Interval range_of(const std::vector<double>& values);

std::vector<Switch> switches_in(const Record& record, const std::vector<Stretch>& stretches, const Look& look);

// Friction cancels out where it is the same before and after: m = 2 F / (a1 - a2) for a change from F to -F. The
// switches of the greatest change err least. Requires one switch.
MassEstimate mass_of(const std::vector<Switch>& switches, const Record& record);
LatencyEstimate latency_of(const std::vector<Switch>& switches, const Record& record);

}  // namespace breakaway::evaluation
