// What the record of an experiment says of its axis: mass, friction, latency and the lag of the current loop.
//
// Mass and friction are in units of the force that was commanded: a drive that gives a tenth more than it says makes
// both a tenth too small, and every force that a design computes from them comes out right again.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "breakaway/evaluation/record.hpp"

namespace breakaway::evaluation {

struct Interval {
  double least = 0, most = 0;
};

// Friction as it was seen once. At rest it is what a ramp took to break away.
struct FrictionSample {
  double position_m = 0;
  double speed_m_s = 0;    // 0: it broke away here
  int direction = 1;       // of the motion
  Interval friction_N;     // the true value lies between, as far as count, step of force and period let one see
  std::size_t motion = 0;  // samples of one motion, from rest to rest, share a number
};

struct MassEstimate {
  double mass_kg = 0;
  Interval seen_kg;  // of the greatest switches of force
  std::size_t switches = 0;
  double spread = 0;  // the greatest share by which any switch is off mass_kg; smaller ones count in proportion
  double spread_of_lengths = 0;  // share by which longer and shorter looks at the switches differ

  double spread_of_greatest() const { return std::max(seen_kg.most - mass_kg, mass_kg - seen_kg.least) / mass_kg; }
};

struct LatencyEstimate {
  int periods = 0;           // from a sample to the first force computed from it
  int fewest_periods = 0;    // where readings scatter so much that they do not tell latency from lag, ...
  int most_periods = 0;      // ... periods is one of these, the usual 1 if it is among them
  double lag_s = 0;          // time constant of the current loop
  double lag_error_s = 0;    // what the switches differ by, and what may be common to them
  bool lag_is_seen = false;  // told apart, and above its error
  double delay_s = 0;        // of both together
  Interval delay_seen_s;

  bool is_told_apart() const { return fewest_periods == most_periods; }
};

// What is added to what was seen.
struct Margins {
  double friction = 0.1;   // share of the least and of the greatest friction
  double mass = 0.01;      // least relative uncertainty of the mass
  double masses = 0.03;    // the same of motor and load
  double side = 0.25;      // share of the friction of motor or load alone
  double stiffness = 0.1;  // of the least stiffness seen
  double damping = 0.5;    // of the damping seen
};

// A load on a spring, as the motor's swings about switches of the force showed it.
struct SpringEstimate {
  double motor_kg = 0, load_kg = 0;  // within Identification::mass_uncertainty, each
  Interval resonance_Hz;             // of the single switches
  Interval stiffness_seen_N_per_m;
  double stiffness_N_per_m = 0;  // at least: with the margin
  double damping_Ns_per_m = 0;   // at least
  Interval motor_N, load_N;      // friction of either side, with the margin
  std::size_t switches = 0, bends = 0;

  // No more likely is another switch to show less stiffness than any that was seen: 1 / (n + 1). The margin comes on
  // top.
  double chance_softer() const { return 1.0 / (static_cast<double>(switches) + 1); }
};

struct Identification {
  MassEstimate mass;
  LatencyEstimate latency;
  std::vector<FrictionSample> friction;
  Interval friction_seen_N;                    // the least and the greatest of all samples
  Interval bounds_N;                           // with the margin
  double mass_uncertainty = 0;                 // relative, either way
  Interval travel_seen_m;                      // where friction was seen
  std::size_t motions = 0;                     // n, from rest to rest
  std::optional<double> presliding_N_per_m{};  // where the axis bends before it slides
  std::optional<SpringEstimate> spring{};      // between motor and load
  double duration_s = 0;
  Margins margins{};  // that bounds_N and mass_uncertainty have

  // No more likely is the friction of the next motion outside what was seen, whatever its distribution, if motions
  // come in no order: 2 / (n + 1).
  double chance_outside() const { return 2.0 / (static_cast<double>(motions) + 1); }
};

enum class Mechanism {
  one_mass,
  load_on_spring,  // behind the motor, whose encoder is read
};

// Throws InputError with the remedy where the record does not show what is needed: too short, no motion, fewer
// than six switches of the force in motion, or a mechanism that is another one.
Identification evaluate(const Record& record, const Margins& margins = {}, Mechanism mechanism = Mechanism::one_mass);

}  // namespace breakaway::evaluation
