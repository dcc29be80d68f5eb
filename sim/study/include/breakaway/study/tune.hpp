// Tuning: all that a file lets one choose of an axis' controller, from what the axis is.
//
// What the axis is stays as the file has it: mass, friction, uncertainties, period, drive, bus, limits, and the longest
// move. Chosen are coast, gains, limits of the approach, force limit and tolerance. No limit that the file states is
// exceeded: not [limits], nor max_force_N, max_approach_speed_m_s or [move], which may be those of the machine.
//
// Every set of gains that is tried must be certified as `design` certifies it. It is then run from rest over the
// longest move under the friction laws of a study: first under the fixed and a few random laws, whose worst settling
// time can only grow with more of them, and, in the order of those times, under all, until no other can be better.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "breakaway/config/edited_file.hpp"
#include "breakaway/config/node.hpp"
#include "breakaway/law/axis_parameters.hpp"

namespace breakaway::study {

// What is wanted of the gains. A tolerance is the widest that [run] settle_tolerance_m, or else position_tolerance_m,
// allows, where that can be certified, and otherwise the least that can; for accuracy it is always the least.
enum class Objective : std::uint8_t {
  time,      // the least worst settling time, or overshoot_costs times it without overshoot beyond the tolerance
  accuracy,  // the least tolerance, and at that the least time
  gentle,    // the least peak force, and at that the least overshoot, in gentle_share of the least time
};
std::string_view to_string(Objective objective);
// Throws InputError for another name than those.
Objective objective_of(std::string_view name);

inline constexpr double gentle_share = 1.5, overshoot_costs = 1.05;

struct Gains {
  law::Coast coast = law::Coast::pd;
  double stiffness_N_per_m = 0;                       // k1
  double approach_damping_Ns_per_m = 0;               // k21
  double kick_damping_Ns_per_m = 0;                   // k22
  double max_force_N = config::unlimited;             // of [controller]; unlimited: the file states none
  double max_approach_speed_m_s = config::unlimited;  // likewise
  std::optional<config::Move> move{};
  double position_tolerance_m = 0;
  double settle_tolerance_m = 0;  // of [run]; 0: the file states none
};

// Gains that were tried.
struct TunedPoint {
  Gains gains;
  std::string why_not;   // it is not certified, or did not settle under every law; empty where it is and did
  std::size_t laws = 0;  // that it was run under
  double error_m = 0;    // true error at rest that is certified; NaN where no figure is
  double worst_settling_s = std::numeric_limits<double>::infinity();
  double median_settling_s = std::numeric_limits<double>::infinity();
  double overshoot_m = 0;   // NaN for the ideal law
  double peak_force_N = 0;  // likewise

  bool good() const { return why_not.empty(); }
};

// One number of the axis, twice as good, and what the axis tuned again is then capable of.
struct DoubledLimit {
  std::string name;                         // "the period"
  std::string change;                       // "[loop] period_s = 0.00025 instead of 0.0005"
  std::vector<config::Setting> settings{};  // what has to stand in the file for it
  std::string why_not;                      // no such axis can be tuned; empty where it can
  TunedPoint best;
  double least_tolerance_m = 0;
  double gain = 0;  // share of settling time, tolerance or peak force, as the objective is, that is saved
};

// A number that was chosen, and why, in a sentence.
struct ChosenNumber {
  std::string key, value, why;
};

struct Tuning {
  Objective objective = Objective::time;
  std::string text;              // of the file, with the numbers that were chosen
  double distance_m = 0;         // of the longest move
  double least_tolerance_m = 0;  // that can be certified
  double least_time_s = 0;       // worst settling time of the fastest gains
  double fastest_m_s = 0;        // speed that the force reaches in the longest move, at most
  TunedPoint chosen;
  std::vector<TunedPoint> tried;
  std::vector<DoubledLimit> limits;  // the one that saves most comes first
  std::vector<ChosenNumber> numbers;
};

struct TuneOptions {
  Objective objective = Objective::time;
  std::string axis;       // its name, where the file has several
  int random_laws = 100;  // beside the four fixed ones
  std::uint64_t seed = 1;
  unsigned threads = 0;                          // 0: one for each processor. The result does not depend on it.
  bool double_limits = true;                     // as well, which takes as much time again
  std::function<void(double share)> progress{};  // told the share of the way that is behind, from one thread at a time
};

// What is chosen may be missing in the file, or wrong there.
// Throws InputError as read_scenario() and sil::require_complete() do for the rest, and, where no gains can be
// certified, with the number of the axis that forbids it and the value of it that would do. `name` stands for the file
// in errors.
Tuning tune(std::string_view text, const std::string& name, const TuneOptions& options);

}  // namespace breakaway::study
