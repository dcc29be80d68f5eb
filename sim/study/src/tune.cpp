#include "breakaway/study/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "tune_limits.hpp"
#include "tune_reasons.hpp"
#include "tune_search.hpp"
#include "tuned_axis.hpp"

namespace breakaway::study {
namespace {

// The shares of one stage of the way, as those of all of it.
std::function<void(double)> stage(const TuneOptions& options, double from, double to) {
  return [&options, from, to](double share) {
    if (options.progress) options.progress(from + share * (to - from));
  };
}

struct Found {
  Tolerance tolerance;
  TunedPoint chosen;
  double least_s = 0;  // worst settling time of the fastest gains
  std::vector<TunedPoint> tried;
};

// allowed_s: of the gentle gains; 0: a share more than the fastest take.
Found search(const TunedAxis& axis, const TuneOptions& options, double allowed_s,
             const std::function<void(double)>& progress) {
  Search search{axis, options, progress};
  Found found{.tolerance = search.tolerance(), .chosen = {}, .tried = {}};
  found.chosen = search.fastest(found.tolerance);
  found.least_s = found.chosen.worst_settling_s;
  for (const TunedPoint& p : search.tried())
    if (p.good() && p.laws == found.chosen.laws) found.least_s = std::min(found.least_s, p.worst_settling_s);
  if (options.objective == Objective::gentle)
    found.chosen = search.gentlest(found.chosen, allowed_s > 0 ? allowed_s : gentle_share * found.least_s);
  found.tried = search.tried();
  return found;
}

// What an objective is measured by: less is better.
double measure(Objective objective, const TunedPoint& point) {
  if (objective == Objective::accuracy) return point.gains.position_tolerance_m;
  return objective == Objective::gentle ? point.peak_force_N : point.worst_settling_s;
}

// What has to be written into the file for it.
std::string typed(const Improvement& better) {
  std::string all;
  for (const config::Setting& s : better.settings)
    all += fmt::format("{}[{}] {} = {:.6g}", all.empty() ? "" : ", ", s.table, s.key, std::stod(s.value));
  return all;
}

DoubledLimit doubled(const TunedAxis& axis, const Improvement& better, const TuneOptions& options, const Found& now,
                     const std::function<void(double)>& progress) {
  DoubledLimit limit{.name = better.name,
                     .change = fmt::format("{} instead of {:.4g}", typed(better), better.before),
                     .settings = better.settings,
                     .why_not = {},
                     .best = {}};
  try {
    const TunedAxis changed = axis.changed(better.settings);
    const Found found = search(changed, options, gentle_share * now.least_s, progress);
    limit.best = found.chosen;
    limit.least_tolerance_m = found.tolerance.least_m;
    limit.gain = 1 - measure(options.objective, limit.best) / measure(options.objective, now.chosen);
  } catch (const InputError& error) {
    limit.why_not = error.problem();
  }
  return limit;
}

TunedAxis read(std::string_view text, const std::string& name, const TuneOptions& options) {
  return {std::string{text}, name, options.axis};
}

// The error of an axis that cannot be tuned, with what would make it possible.
InputError impossible(const TunedAxis& axis, const TuneOptions& options, const InputError& why) {
  const std::string what = axis.ideal() ? std::string{} : remedy(axis, options);
  return InputError{what.empty() ? why.problem() : what + " (" + why.problem() + ")"}.in_file(axis.name());
}

}  // namespace

Objective objective_of(std::string_view name) {
  for (const Objective objective : {Objective::time, Objective::accuracy, Objective::gentle})
    if (to_string(objective) == name) return objective;
  throw InputError{"objective", fmt::format("\"{}\": give time, accuracy or gentle", name)};
}

std::string_view to_string(Objective objective) {
  return objective == Objective::time ? "time" : objective == Objective::accuracy ? "accuracy" : "gentle";
}

Tuning tune(std::string_view text, const std::string& name, const TuneOptions& options) {
  const TunedAxis axis = read(text, name, options);
  const std::vector<Improvement> better = options.double_limits ? improvements(axis, 2) : std::vector<Improvement>{};
  const double first = 1 / (1 + 0.4 * static_cast<double>(better.size()));  // of the way
  Found found;
  try {
    found = search(axis, options, 0, stage(options, 0, first));
  } catch (const InputError& error) {
    throw impossible(axis, options, error);
  }
  Tuning tuning{.objective = options.objective,
                .text = axis.text_with(found.chosen.gains, axis.duration_s(found.chosen.worst_settling_s)),
                .distance_m = axis.distance_m(),
                .least_tolerance_m = found.tolerance.least_m,
                .least_time_s = found.least_s,
                .fastest_m_s = axis.fastest_m_s(),
                .chosen = found.chosen,
                .tried = found.tried,
                .limits = {},
                .numbers = {}};
  tuning.numbers = reasons(axis, found.tolerance, tuning);
  const double each = (1 - first) / static_cast<double>(std::max<std::size_t>(better.size(), 1));
  for (std::size_t i = 0; i < better.size(); ++i) {
    const double from = first + each * static_cast<double>(i);
    tuning.limits.push_back(doubled(axis, better[i], options, found, stage(options, from, from + each)));
  }
  std::ranges::stable_sort(tuning.limits, std::ranges::greater{}, &DoubledLimit::gain);
  return tuning;
}

}  // namespace breakaway::study
