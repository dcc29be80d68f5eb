#include "tune_reasons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace breakaway::study {
namespace {

std::string seconds(double time_s) { return fmt::format("{:.3g} s", time_s); }

// The fastest of those that were tried and are of a kind; nothing where none of them settled.
template <class Kind>
std::optional<TunedPoint> best_of(const Tuning& tuning, Kind is_of_kind) {
  std::optional<TunedPoint> best;
  for (const TunedPoint& point : tuning.tried) {
    if (point.good() && is_of_kind(point) && (!best || point.worst_settling_s < best->worst_settling_s)) best = point;
  }
  return best;
}

// Why this coast, of those that are certified.
std::string best_by(Objective objective) {
  switch (objective) {
    case Objective::accuracy:
      return "certified to the least tolerance, and the fastest that is";
    case Objective::gentle:
      return "certified, and the fastest that is before the force is lowered";
    case Objective::time:
      break;
  }
  return "certified, and the fastest that is";
}

class Reasons {
 public:
  Reasons(const TunedAxis& axis, const Tolerance& tolerance, const Tuning& tuning)
      : axis_{axis}, tolerance_{tolerance}, tuning_{tuning}, gains_{tuning.chosen.gains} {}

  std::vector<ChosenNumber> all() {
    say_coast();
    if (gains_.coast == law::Coast::pd) say_feedback();
    if (!axis_.ideal()) say_force();
    if (std::isfinite(gains_.max_approach_speed_m_s)) say_speed();
    if (gains_.move) say_move();
    if (!axis_.ideal()) say_tolerance();
    say_duration();
    return std::move(numbers_);
  }

 private:
  void say(std::string key, std::string value, std::string why) {
    numbers_.push_back({std::move(key), std::move(value), std::move(why)});
  }
  void say(std::string key, double value, std::string why) {
    say(std::move(key), fmt::format("{:g}", value), std::move(why));
  }

  void say_coast() {
    if (axis_.ideal()) return say("coast", quoted(gains_.coast), "the ideal law has no other");
    std::string why;
    for (const law::Coast other : {law::Coast::brake, law::Coast::work, law::Coast::pd}) {
      if (other == gains_.coast) continue;
      const auto best = best_of(tuning_, [&](const TunedPoint& p) { return p.gains.coast == other; });
      if (best)
        why += fmt::format("; {} takes {} at best", quoted(other), seconds(best->worst_settling_s));
      else
        why += fmt::format("; {} {}", quoted(other),
                           tried(other) ? "does not settle" : "cannot be certified to this tolerance");
    }
    say("coast", quoted(gains_.coast), best_by(tuning_.objective) + why);
  }

  bool tried(law::Coast coast) const { return std::ranges::find(tolerance_.coasts, coast) != tolerance_.coasts.end(); }

  void say_feedback() {
    const double critical = 2 * std::sqrt(gains_.stiffness_N_per_m * axis_.axis().mass_kg);
    say("k1_N_per_m", gains_.stiffness_N_per_m,
        axis_.ideal() ? "as the file has it: without a drive a stiffer one is always faster"
                      : "of those that were tried, whose dampings the delay of the loop bears, the fastest");
    say("k21_Ns_per_m", gains_.approach_damping_Ns_per_m,
        fmt::format("zeta = {:.3g} in the approach, below 1 so that it comes to rest, and the fastest",
                    gains_.approach_damping_Ns_per_m / critical));
    say("k22_Ns_per_m", gains_.kick_damping_Ns_per_m,
        fmt::format("zeta = {:.3g} in kicks, above 1 so that none goes beyond, and the fastest",
                    gains_.kick_damping_Ns_per_m / critical));
  }

  void say_force() {
    const bool less = gains_.max_force_N < axis_.gains().max_force_N;
    if (less)
      return say("max_force_N", gains_.max_force_N,
                 fmt::format("the least that settles within {}, {:g} times the least time",
                             seconds(gentle_share * tuning_.least_time_s), gentle_share));
    if (std::isfinite(gains_.max_force_N))
      say("max_force_N", gains_.max_force_N,
          tuning_.objective == Objective::gentle ? "as the file has it: with less it does not settle in time"
                                                 : "as the file has it: less would be slower");
  }

  void say_speed() {
    const double now_m_s = gains_.max_approach_speed_m_s;
    const auto of_coast = [&](const TunedPoint& p) { return p.gains.coast == gains_.coast; };
    double fastest_m_s = 0, slowest_m_s = config::unlimited;
    for (const TunedPoint& p : tuning_.tried) {
      if (!of_coast(p) || !std::isfinite(p.gains.max_approach_speed_m_s)) continue;
      fastest_m_s = std::max(fastest_m_s, p.gains.max_approach_speed_m_s);
      slowest_m_s = std::min(slowest_m_s, p.gains.max_approach_speed_m_s);
    }
    if (gains_.move || fastest_m_s == slowest_m_s) return say("max_approach_speed_m_s", now_m_s, "as the file has it");
    if (now_m_s >= tuning_.fastest_m_s)
      return say(
          "max_approach_speed_m_s", now_m_s,
          fmt::format("no limit: the force reaches {:.3g} m/s in {:g} m, and lower ones, down to {:.3g} m/s, are "
                      "slower",
                      tuning_.fastest_m_s, tuning_.distance_m, slowest_m_s));
    const bool fastest = tuning_.chosen.worst_settling_s <= tuning_.least_time_s;
    say("max_approach_speed_m_s", now_m_s,
        fmt::format("of speeds between {:.3g} and {:.3g} m/s the {}", slowest_m_s, fastest_m_s,
                    fastest ? "one with the least worst settling time"
                            : "fastest one that overshoots by no more than the tolerance"));
  }

  void say_move() {
    const bool given = axis_.axis().move.has_value();
    const auto without = best_of(tuning_, [](const TunedPoint& p) { return !p.gains.move; });
    const std::string otherwise =
        given     ? "; more than the file has is not tried"
        : without ? fmt::format("; without limits of the move it takes {}", seconds(without->worst_settling_s))
                  : "; without limits of the move it does not settle";
    say("[move] speed_m_s", gains_.move->speed_m_s, "the fastest of those that were tried" + otherwise);
    say("[move] acceleration_m_s2", gains_.move->acceleration_m_s2, "likewise");
  }

  void say_tolerance() {
    const bool least = tolerance_.position_m <= tolerance_.least_m * (1 + 1e-9);
    say("position_tolerance_m", gains_.position_tolerance_m,
        least ? "the least that is certified, to two digits"
              : fmt::format("{}; certified can be {:g}",
                            axis_.alone() ? "what the file's settle_tolerance_m allows, as a wider one is faster"
                                          : "as the file has it",
                            tolerance_.least_m));
    if (gains_.settle_tolerance_m > 0)
      say("settle_tolerance_m", gains_.settle_tolerance_m,
          !axis_.alone() && gains_.settle_tolerance_m == axis_.gains().settle_tolerance_m
              ? "of all axes, as the file has it"
              : "the tolerance, and by how much a reading may be off");
  }

  void say_duration() {
    const double duration_s = axis_.duration_s(tuning_.chosen.worst_settling_s);
    if (duration_s > axis_.scenario().run->duration_s)
      say("duration_s", duration_s, "the slowest run settles in it, and did not in that of the file");
  }

  const TunedAxis& axis_;
  const Tolerance& tolerance_;
  const Tuning& tuning_;
  const Gains& gains_;
  std::vector<ChosenNumber> numbers_;
};

}  // namespace

std::vector<ChosenNumber> reasons(const TunedAxis& axis, const Tolerance& tolerance, const Tuning& tuning) {
  return Reasons{axis, tolerance, tuning}.all();
}

}  // namespace breakaway::study
