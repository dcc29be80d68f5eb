// Switches of the force while the axis moves: mass, latency and lag.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "breakaway/evaluation/identification.hpp"
#include "constant_force.hpp"

namespace breakaway::evaluation {

// What acts late: readings from a command on that do not show it yet, or not wholly.
struct Settling {
  std::size_t latency = 0;  // readings until the first of it is seen
  std::size_t all = 12;     // and until all of it is
};

// The force went from before to after in reading `at`, and the axis went on in its direction.
struct Switch {
  std::size_t at = 0;
  std::size_t readings = 0;  // of the shorter of the two parabolas
  double change_N = 0;       // of the command
  Parabola before, after;

  double change_m_s2() const { return after.acceleration_m_s2 - before.acceleration_m_s2; }
  double error_m_s2() const { return std::hypot(after.error_m_s2, before.error_m_s2); }
  double mass_kg() const { return change_N / change_m_s2(); }
};

// If a switch is as likely to show too little as too much, the truth is beyond all of six with a chance of 1 in 32.
constexpr std::size_t least_switches = 6;

// Require one value.
Interval range_of(const std::vector<double>& values);
double median(std::vector<double> values);

std::vector<Switch> switches_in(const Record& record, const std::vector<Stretch>& stretches, const Settling& settling);

// Friction cancels out where it is the same before and after: m = 2 F / (a1 - a2) for a change from F to -F. The
// switches of the greatest change err least. Requires one switch.
MassEstimate mass_of(const std::vector<Switch>& switches, const Record& record);
LatencyEstimate latency_of(const std::vector<Switch>& switches, const Record& record);

}  // namespace breakaway::evaluation
