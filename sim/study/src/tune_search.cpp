#include "tune_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <thread>
#include <utility>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/design/report.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "parallel.hpp"
#include "tune_candidates.hpp"

namespace breakaway::study {
namespace {

constexpr int few_random_laws = 8;
constexpr double lost_cause =
    1.6;  // times the worst settling time of the first gains: what takes longer is not the best
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

unsigned threads_of(const TuneOptions& options) {
  return options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
}

double least_tolerance_m(const design::DesignReport& report, const config::Axis& axis) {
  if (report.braked) return report.braked->least_tolerance_m;
  if (report.work) return report.work->least_tolerance_m;
  return std::max(report.accuracy_floor_m, axis.drive ? axis.drive->encoder_resolution_m : 0.0);
}

double certified_error_m(const design::DesignReport& report) {
  if (report.pd) return report.pd->error_m;
  return report.braked ? report.braked->error_m : report.work ? report.work->error_m : nan;
}

// By how much more than its tolerance the axis may be off its target.
double beside_m(const TunedAxis& axis) {
  return config::reading_error_m(axis.axis()) + config::furthest_off_count(axis.axis()).m();
}

// What counts as settled, where the file says that; of its other axes, too, for which it is never lowered.
double settle_tolerance_m(const TunedAxis& axis, double position_m) {
  const double own_m = rounded_up(position_m + beside_m(axis), 3), stated_m = axis.gains().settle_tolerance_m;
  return stated_m == 0 || axis.alone() ? own_m : std::max(own_m, stated_m);
}

// The gains with a tolerance, and what then counts as settled where the file says that.
Gains with_tolerance(Gains gains, const TunedAxis& axis, double position_m, double settle_m) {
  gains.position_tolerance_m = position_m;
  if (axis.gains().settle_tolerance_m > 0) gains.settle_tolerance_m = settle_m;
  return gains;
}
Gains with_tolerance(const Gains& gains, const TunedAxis& axis, double position_m) {
  return with_tolerance(gains, axis, position_m, settle_tolerance_m(axis, position_m));
}

struct Certificate {
  std::string why_not;
  double error_m = nan, least_tolerance_m = nan;
};

Certificate certificate(const scenario::Scenario& s) {
  const config::Axis& axis = s.node.axes.front();
  const design::DesignReport report = config::examine(s.node).front();
  Certificate c{report.certified ? std::string{} : report.reasons.front(), certified_error_m(report), nan};
  const bool possible = report.braked || report.work || axis.controller.impulsive->coast == law::Coast::pd;
  if (possible) c.least_tolerance_m = least_tolerance_m(report, axis);
  return c;
}

Certificate certificate(const TunedAxis& axis, const Gains& gains) try {
  return certificate(axis.with(gains));
} catch (const InputError& error) {
  return {error.problem(), nan, nan};
}

// The least tolerance of two digits that is certified with the gains; NaN, and why, where none is.
Certificate least_certified(const TunedAxis& axis, const Gains& gains) {
  const double wide_m = rounded_down(std::min(axis.distance_m(), axis.axis().limits.following_error_m), 2);
  Certificate c = certificate(axis, with_tolerance(gains, axis, wide_m));
  if (!c.why_not.empty() || !(c.least_tolerance_m > 0)) return {c.why_not, nan, nan};
  constexpr double step = 1.25;
  for (double tolerance_m = rounded_up(c.least_tolerance_m, 2); tolerance_m < wide_m;
       tolerance_m = rounded_up(step * tolerance_m, 2)) {
    c = certificate(axis, with_tolerance(gains, axis, tolerance_m));
    if (c.why_not.empty()) return {"", c.error_m, tolerance_m};
  }
  return {c.why_not.empty() ? "no tolerance below the longest move is certified" : c.why_not, nan, nan};
}

// The reason of the coast that the file has comes first.
std::vector<law::Coast> coasts_for(const TunedAxis& axis) {
  using law::Coast;
  if (axis.ideal()) return {Coast::pd};
  std::vector<Coast> coasts{axis.gains().coast};
  for (const Coast coast : {Coast::brake, Coast::work, Coast::pd})
    if (coast != coasts.front()) coasts.push_back(coast);
  return coasts;
}

bool faster(const TunedPoint& a, const TunedPoint& b) {
  return a.good() != b.good() ? a.good() : a.worst_settling_s < b.worst_settling_s;
}

// Written so that the ideal law, whose overshoot is not looked at, does.
bool stays_within(const TunedPoint& p) { return !(p.overshoot_m > p.gains.position_tolerance_m); }

std::string unsettled(const StudyRow& row) {
  for (const StudyRun& run : row.runs) {
    if (run.settled) continue;
    return "not settled under the law \"" + run.law + "\"" +
           (run.faults.empty() ? ": a longer [run] duration_s may do" : ": " + run.faults.front().name);
  }
  return {};
}

}  // namespace

Search::Search(const TunedAxis& axis, const TuneOptions& options, std::function<void(double share)> progress)
    : axis_{axis}, options_{options}, progress_{std::move(progress)} {}

Tolerance Search::tolerance() const {
  Tolerance t{.settle_m = axis_.gains().settle_tolerance_m, .coasts = {}};
  if (axis_.ideal()) return {.settle_m = t.settle_m, .coasts = {law::Coast::pd}};
  std::vector<std::pair<double, law::Coast>> possible;
  std::string why_not;
  for (const law::Coast coast : coasts_for(axis_)) {
    Certificate best{"", nan, nan};
    for (const Gains& gains : fast_gains(axis_, coast, GainGrid::coarse)) {
      best = least_certified(axis_, gains);
      if (best.why_not.empty()) break;
    }
    if (!best.why_not.empty() && coast == axis_.gains().coast) {
      if (const Certificate own = least_certified(axis_, axis_.gains()); own.why_not.empty()) best = own;
    }
    if (best.why_not.empty() && best.least_tolerance_m > 0) possible.emplace_back(best.least_tolerance_m, coast);
    if (why_not.empty()) why_not = best.why_not;
  }
  if (possible.empty()) throw InputError{"not certified: " + why_not}.in_file(axis_.name());
  t.least_m = std::ranges::min_element(possible)->first;
  // What the axes of a file have in common says little of one of them.
  const bool common = !axis_.alone() && axis_.gains().position_tolerance_m > 0;
  const double asked_m = t.settle_m > 0 && !common ? t.settle_m - beside_m(axis_) : axis_.gains().position_tolerance_m;
  const bool as_asked = options_.objective != Objective::accuracy && asked_m >= t.least_m * (1 - 1e-9);
  t.position_m = as_asked ? std::max(rounded_down(asked_m, 3), t.least_m) : t.least_m;
  if (!as_asked) t.settle_m = settle_tolerance_m(axis_, t.position_m);
  for (const auto& [least_m, coast] : possible)
    if (least_m <= t.position_m * (1 + 1e-9)) t.coasts.push_back(coast);
  return t;
}

double Search::settle_time_s() const { return axis_.scenario().run->settle_time_s; }

double Search::first_duration_s() const {
  const double given_s = axis_.scenario().run->duration_s;
  if (axis_.ideal()) return given_s;
  return std::max(given_s, 2 + 20 * axis_.distance_m() / axis_.fastest_m_s());
}

TunedPoint Search::judged(const Gains& gains, int random_laws, double longest_s, unsigned threads,
                          const std::function<void(int, int)>& progress) const {
  TunedPoint point{.gains = gains, .why_not = {}};
  try {
    scenario::Scenario s = axis_.with(gains);
    const Certificate c = certificate(s);
    point.why_not = c.why_not;
    point.error_m = c.error_m;
    if (!point.good()) return point;
    s.run->duration_s = longest_s;
    // What is said is how long the longest move takes. Another target would be a move of its own, from which its time
    // is counted, or come after all that is tried.
    s.node.axes.front().controller.targets.clear();
    const StudyRow row = run_study(s, {{axis_.start()}, random_laws, options_.seed, threads, progress}).front();
    point.laws = row.runs.size();
    point.why_not = unsettled(row);
    point.worst_settling_s = worst_settling_time_s(row);
    point.median_settling_s = median_settling_time_s(row);
    point.overshoot_m = axis_.ideal() ? nan : worst_excursions(row).overshoot_m;
    point.peak_force_N = axis_.ideal() ? nan : largest_force_N(row);
  } catch (const InputError& error) {
    point.why_not = error.problem();
  }
  return point;
}

TunedPoint Search::judged_alone(const Gains& gains, int random_laws, double longest_s) const {
  return judged(gains, random_laws, longest_s, threads_of(options_), [this](int, int) { progress_(share_); });
}

TunedPoint Search::best_of(const std::vector<Gains>& gains, double longest_s) {
  const int few = std::min(few_random_laws, options_.random_laws);
  std::vector<TunedPoint> points(gains.size());
  std::mutex mutex;
  std::size_t done = 0;
  in_parallel(gains.size(), static_cast<int>(threads_of(options_)), 1, [&](int) {
    return [&](std::size_t i) {
      points[i] = judged(gains[i], few, longest_s, 1);
      const std::scoped_lock lock{mutex};
      tell(0.6 * static_cast<double>(++done) / static_cast<double>(gains.size()));
    };
  });
  std::ranges::stable_sort(points, faster);
  TunedPoint best{.gains = {}, .why_not = points.empty() ? "there is nothing to try" : points.front().why_not};
  for (TunedPoint& point : points) {
    if (!point.good() || (best.good() && !faster(point, best))) continue;
    if (few < options_.random_laws) {
      const double enough_s = best.good() ? 1.01 * best.worst_settling_s + settle_time_s() : longest_s;
      const TunedPoint all = judged_alone(point.gains, options_.random_laws, std::min(longest_s, enough_s));
      if (!all.good() && !best.good()) best.why_not = all.why_not;
      // What was cut short at the best time so far is no better: of that, what a few laws have shown stays.
      if (all.good() || !best.good()) point = all;
      if (!all.good() || (best.good() && !faster(all, best))) continue;
    }
    best = point;
  }
  tell(1);
  std::ranges::move(points, std::back_inserter(tried_));
  return best;
}

TunedPoint Search::fastest(const Tolerance& tolerance) {
  const auto toleranced = [&](const Gains& gains) {
    return with_tolerance(gains, axis_, tolerance.position_m, tolerance.settle_m);
  };
  std::vector<Gains> all;
  if (std::ranges::find(tolerance.coasts, axis_.gains().coast) != tolerance.coasts.end())
    all.push_back(toleranced(axis_.gains()));  // it is not to become slower than it was
  for (const law::Coast coast : tolerance.coasts)
    for (const Gains& gains : fast_gains(axis_, coast, GainGrid::fine)) all.push_back(toleranced(gains));
  double longest_s = first_duration_s();
  for (const Gains& gains : all) {
    const TunedPoint first = judged_alone(gains, 0, longest_s);
    if (!first.good()) continue;
    longest_s = std::min(longest_s, lost_cause * first.worst_settling_s + settle_time_s());
    break;
  }
  const TunedPoint best = best_of(all, longest_s);
  if (!best.good()) throw InputError{"no gains are certified and settle: " + best.why_not}.in_file(axis_.name());
  return without_overshoot(best);
}

TunedPoint Search::without_overshoot(const TunedPoint& fastest) {
  const double longest_s = overshoot_costs * fastest.worst_settling_s;
  if (stays_within(fastest)) return fastest;
  for (TunedPoint& point : tried_) {  // the fastest first
    if (!point.good() || point.worst_settling_s > longest_s || !stays_within(point)) continue;
    if (point.laws < fastest.laws) point = judged_alone(point.gains, options_.random_laws, longest_s + settle_time_s());
    if (point.good() && point.worst_settling_s <= longest_s && stays_within(point)) return point;
  }
  return fastest;
}

TunedPoint Search::gentlest(const TunedPoint& fastest, double longest_s) {
  if (axis_.ideal()) return fastest;
  constexpr double shown = 1.5;  // times the longest, so that a picture has what was too slow
  const auto run = [&](double share, int random_laws) {
    const Gains gains = with_force(axis_, fastest.gains, share);
    tried_.push_back(judged_alone(gains, random_laws, shown * longest_s + settle_time_s()));
    return tried_.back();
  };
  const auto allowed = [=](const TunedPoint& p) { return p.good() && p.worst_settling_s <= longest_s; };
  constexpr double least_share = 0.05, fine = 1.02;
  double slow = least_share, enough = 1;
  while (enough > fine * slow) {
    const double middle = std::sqrt(slow * enough);
    (allowed(run(middle, std::min(few_random_laws, options_.random_laws))) ? enough : slow) = middle;
  }
  // All laws may ask for a little more than a few do. Of two that are as gentle, the one is taken that stays within
  // its tolerance.
  TunedPoint gentlest = fastest;
  for (double last = 1; enough < last; enough *= std::sqrt(fine)) {
    const TunedPoint point = run(enough, options_.random_laws);
    if (!allowed(point)) continue;
    const bool first = last == 1;
    if (first) last = std::min(1.0, fine * enough);
    if (first || stays_within(point)) gentlest = point;
    if (stays_within(point)) break;
  }
  return gentlest;
}

}  // namespace breakaway::study
