// Checks a whole axis: every assumption of [I] with its margin, and what sampling, encoder and drive add to them.
//
// [I] = van de Wouw & Leine, "Impulsive Control of Mechanical Motion Systems with Uncertain Friction".
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/design/assumptions.hpp"
#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design {

struct AxisDesign {
  double mass_kg{};                         // moving mass, > 0
  double stiffness_N_per_m{};               // k1 > 0
  double approach_damping_Ns_per_m{};       // k21 > 0, phase 1
  double kick_damping_Ns_per_m{};           // k22, phases 2 and 3: zeta > 1
  law::FrictionBounds<double> friction{};   // of the dry friction force
  double smooth_friction_slope_Ns_per_m{};  // dF_sm/dv at rest of a smooth friction beside the dry one (Proposition 3)
  double max_force_N{};                     // of the drive, > 0
  double force_step_N{};                    // in which it gives force; 0: none
  double period_s{};                        // control period; 0: ideal impulses, nothing sampled
  double encoder_resolution_m{};            // one count; 0: exact
  int latency_ticks{};                      // from a sample to the force that answers it, in periods
  double current_loop_lag_s{};              // time constant of the drive's current loop
  double position_tolerance_m{};            // the accuracy asked for, > 0
  double max_approach_speed_m_s = std::numeric_limits<double>::infinity();
  double least_period_s{};  // a shorter one is of no use as a remedy: its frames would not fit the bus
  double longest_way_m{};   // from a target to the next one; 0: none is stated
  double following_error_m = std::numeric_limits<double>::infinity();  // beyond which the axis is stopped
  double sag_m{};  // from rest until the drive gives what it is to carry, at most; 0: friction holds the axis
  double settle_tolerance_m{};          // true error that will do where that is below the floor; 0: none will
  std::optional<BrakedClass> braked{};  // the axes it stands for, where the coast is "brake",
  std::optional<BrakedClass> work{};    // and where it is "work"
  std::vector<std::string> outside{};   // what is known of the machine and no check covers, a sentence each
};

// What a certificate of the coast "brake" says in figures.
struct BrakedPromise {
  double floor_m;            // from this error on each kick takes at least least_share of it away
  double least_tolerance_m;  // that can be certified
  double error_m;            // true error at rest, at most
  double beyond_m;           // true distance beyond the target that a kick may reach, at most
  double reach_m;            // the distance up to which one kick aims at the target
  double hand_over_m;        // the distance from the target at which the approach gives way to brake and kicks
  int most_kicks;            // from where kicks begin, reach_m or hand_over_m, to within the tolerance
  double kicks_s;            // that those kicks take at most, from the first one's decision to the hold
  bool fine_stage;           // error_m is that of the floor; below it kicks go beyond the target
  double brake_N;
  double kick_peak_m_s;  // which no kick exceeds
  double rest_s;         // without a count of motion, that proves rest after a kick
  double aim_lost;       // share of the distance by which the table aims short
  std::size_t table_bytes;
  double approach_beyond_m;  // that an approach may go past its target, tested
  double approach_peak_m_s;  // that it may reach where its speed is limited, tested; else infinite
  double turning_m;          // that an approach may go on for when its target comes to lie behind it
  double farthest_m;         // a target that the law is certified to reach
  double least_move_s;       // that the longest move takes under any law; 0: none is stated
  double longest_way_m;      // from rest over which
  double approach_s;         // the approach takes at most, up to the first kick or the hold, tested; 0: nothing is said
  std::string promise;       // the above in a sentence
};

// What a certificate of the coast "work" says in figures.
struct WorkPromise {
  double floor_m;            // nearer than this an axis is not kicked
  double least_tolerance_m;  // that can be certified
  double error_m;            // true error of the side with the encoder at rest, at most
  double beyond_m;           // true distance of that side beyond the target that a kick may reach, at most
  double spring_m;           // what the spring may add to a kick, by which each aims short
  double unseen_m;           // that the other side may rest off where this one says, whatever the law
  double resonance_Hz;       // at the least stiffness
  double reach_m;            // the distance up to which a kick aims at the target
  double hand_over_m;        // an axis that rests further away is approached, not kicked
  double farthest_m;         // a target that one approach is certain to lead to
  int most_kicks;            // after which the run ends by name
  double rest_s;             // without a count of motion, that proves rest
  double kick_peak_m_s;      // of the motor, which no kick exceeds
  std::size_t table_bytes;
  double approach_beyond_m;  // that an approach may go past its target, tested
  double approach_peak_m_s;  // that it may reach where its speed is limited, tested; else infinite
  std::string promise;       // the above in a sentence
};

// What a certificate of the coast "pd" says in figures, for an axis with a period. All of it is tested. Where nothing
// limits the speed, way and time of the approach are 0.
struct PdPromise {
  double beyond_m;  // that an approach or a kick may go past the target; infinite where nothing limits its speed
  double approach_peak_m_s;   // that an approach may reach
  int most_kicks;             // to the target, under any friction
  double aim_lost;            // largest share of the distance by which a kick aims short under the least
  double error_m;             // true error at rest, at most
  double longest_way_m;       // from rest over which
  double approach_s;          // the approach takes at most, up to the first kick or the hold
  double kicks_s;             // the kicks from where friction may hold the axis take at most
  double without_progress_s;  // in which the axis may come no nearer to its target, until it holds
  double left_m;              // from the target, at which an approach ended in its trial, at most
  bool is_tried;              // every trial came to its end; else nothing is certified
};

struct Check {
  std::string name;
  bool required;  // the certificate depends on it; the others are sufficient conditions, for information
  bool holds;
  double margin;       // not negative when it holds; in the unit of the compared quantities
  std::string source;  // where the condition comes from
  std::string reason;  // the comparison in numbers, and the remedy when it fails
};

struct DesignReport {
  double zeta_approach;           // k21 / (2 sqrt(k1 m))
  double zeta_kick;               // k22 / (2 sqrt(k1 m))
  double c_lower_m;               // (9): the axis stays at rest within this error for every admissible friction
  double c_upper_m;               // (9): it may rest within this error
  double largest_impulse_Ns;      // |k3(c_upper)|
  double accuracy_floor_m;        // for pulses of one period; 0 for ideal impulses
  double finite_time_bound_s;     // (19) for the largest |y2| = c_lower
  double contraction_per_kick;    // |error| after a kick is at most this times that before it: 1 - f_lower / f_upper
  double ratio;                   // f_lower / f_upper
  double ratio_threshold_18;      // (18)
  double exact_ratio_threshold;   // least ratio for which Assumption 3 holds
  double least_damping_Ns_per_m;  // Remark 1; NaN when no number is large enough
  std::size_t table_bytes;        // flashed k3 table in float
  double table_proved_error;      // relative
  double table_measured_error;    // relative
  std::vector<Check> checks;
  std::optional<BrakedPromise> braked;  // of the coast "brake"
  std::optional<WorkPromise> work;      // of the coast "work"
  std::optional<PdPromise> pd;          // of the coast "pd"
  bool certified;                       // every required check holds
  std::vector<std::string> reasons;     // why not, one line each; empty when certified
  std::vector<std::string> conditions;  // what must be true of the machine for the certificate to mean anything
};

// Refuses inputs outside the ranges stated at AxisDesign and friction bounds that break Assumption 1, by name. What is
// a possible axis but a bad one comes back as a report that is not certified.
DesignReport design_axis(const AxisDesign& axis);

}  // namespace breakaway::design
