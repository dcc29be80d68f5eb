#include "breakaway/sil/axis_accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "breakaway/motion/slide.hpp"
#include "breakaway/sil/run_scenario.hpp"

namespace breakaway::sil {
namespace {

using scenario::AxisWorld;
using scenario::Integrator;
using scenario::Scenario;

constexpr double finest = motion::Slide::usual_tolerance;
constexpr std::array axis_tolerances{1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, finest};
// Near enough to the finest for the same rounding, and far enough to take other steps.
constexpr std::array axis_nearby{2.2e-13, 4.7e-13, 1e-12};
// Of a start that is moved to see what rounding makes of it, relative.
constexpr std::array moves{-8 * std::numeric_limits<double>::epsilon(), 8 * std::numeric_limits<double>::epsilon()};

// All runs together may take so many times the work of one.
constexpr double most_budgets = 4;

// The best run, those by which its error is judged, and one for each tolerance.
constexpr std::size_t runs_to_judge(bool closed_form) {
  return 1 + moves.size() + (closed_form ? 0 : axis_nearby.size() + axis_tolerances.size());
}

bool is_closed_form(const AxisWorld& world) {
  return world.friction.constant_between_events() && world.plant.rigid() && !world.drift;
}

// Processor time of one core, measured on an x86-64 PC: setting an axis up, mostly its table of kicks, one period of
// loop, bus and drive, and one evaluation of the forces on a rigid axis and on one that is more.
constexpr double set_up_s = 5e-3, period_cost_s = 2.5e-6, rigid_evaluation_s = 4e-8, evaluation_s = 1e-7;

double cost_s(const Scenario& s, const Result& result) {
  const bool rigid = std::ranges::all_of(s.worlds, [](const AxisWorld& world) { return world.plant.rigid(); });
  const double periods = s.ideal() ? 0 : result.duration_s / s.node.period_s();
  return static_cast<double>(s.axes()) * (set_up_s + periods * period_cost_s) +
         result.work * (rigid ? rigid_evaluation_s : evaluation_s);
}

Scenario moved(Scenario s, double share) {
  if (s.machine) s.machine->start.q *= 1 + share, s.machine->start.v *= 1 + share;
  for (AxisWorld& world : s.worlds) {
    world.position_m *= 1 + share;
    world.velocity_m_s *= 1 + share;
  }
  return s;
}

class AxisMethodSearch {
 public:
  explicit AxisMethodSearch(const Scenario& s)
      : s_{s},
        closed_form_{s.machine || std::ranges::all_of(s.worlds, is_closed_form)},
        best_{run(with_method(s_, method(finest)))} {
    const std::size_t runs = runs_to_judge(closed_form_);
    if (best_.work_share * static_cast<double>(runs) > most_budgets)
      throw InputError{fmt::format("judging the error would take {} runs, and one takes {:.0f} % of the work that a "
                                   "run may cost: shorten [run] duration_s, or leave accuracy_m out",
                                   runs, 100 * best_.work_share)}
          .in_file(s_.node.file);
    best_error_m_ = error_of_best_m();
  }

  Accuracy choose() {
    const double asked_m = *s_.run->accuracy_m;
    for (const MethodTrial& trial : all()) {
      if (trial.holds) return {asked_m, trial.method, trial.error_m, trial.cost_s, {}, trials_};
    }
    const MethodTrial& last = trials_.back();
    throw AccuracyRefused{s_.node.file,
                          asked_m,
                          {{last.method, fmt::format("errs by {:.2g} m from rounding", last.error_m), last.cost_s}}};
  }

  // From the cheapest on.
  const std::vector<MethodTrial>& all() {
    if (closed_form_) add(method(finest), best_, 0);
    for (std::size_t i = 0; i < axis_tolerances.size() && !closed_form_; ++i) {
      const Result result = run(with_method(s_, method(axis_tolerances[i])));
      add(method(axis_tolerances[i]), result, distance_m(result, best_, s_.ideal()));
      if (trials_.back().holds && !wants_all_) break;
    }
    return trials_;
  }
  void want_all() { wants_all_ = true; }

 private:
  Method method(double tolerance) const {
    if (closed_form_) return {};
    return {.integrator = Integrator::adaptive, .tolerance = tolerance};
  }

  Result run(const Scenario& s) const { return run_scenario(s, {.trace = !s.ideal()}); }

  double error_of_best_m() const {
    double scatter_m = 0;
    const auto look = [&](const Scenario& pilot) {
      scatter_m = std::max(scatter_m, distance_m(run(pilot), best_, s_.ideal()));
    };
    for (const double share : moves) look(with_method(moved(s_, share), method(finest)));
    for (const double tolerance : axis_nearby) {
      if (!closed_form_) look(with_method(s_, method(tolerance)));
    }
    return scatter_m;
  }

  void add(const Method& method, const Result& result, double apart_m) {
    const double error_m = apart_m + best_error_m_;
    const bool holds = s_.run->accuracy_m && error_m <= *s_.run->accuracy_m;
    trials_.push_back({method, error_m, error_m, cost_s(s_, result), holds});
  }

  const Scenario& s_;
  bool closed_form_, wants_all_ = false;
  Result best_;
  double best_error_m_ = 0;
  std::vector<MethodTrial> trials_;
};

}  // namespace

std::vector<double> compared_positions_m(const AxisResult& axis, bool ideal) {
  std::vector<double> positions_m;
  if (ideal) {
    for (const KickRecord& kick : axis.kicks) positions_m.push_back(kick.position_m);
  } else {
    for (const Sample& sample : axis.trace) positions_m.push_back(sample.position_m);
  }
  return positions_m;
}

double distance_m(const Result& a, const Result& b, bool ideal) {
  double largest_m = 0;
  for (std::size_t axis = 0; axis < a.axes.size(); ++axis) {
    const auto of_a = compared_positions_m(a.axes[axis], ideal), of_b = compared_positions_m(b.axes[axis], ideal);
    largest_m = std::max(largest_m, std::abs(a.axes[axis].final_error_m - b.axes[axis].final_error_m));
    const std::size_t shorter = std::min(of_a.size(), of_b.size()), longer = std::max(of_a.size(), of_b.size());
    for (std::size_t i = 0; shorter > 0 && i < (ideal ? shorter : longer); ++i) {
      largest_m =
          std::max(largest_m, std::abs(of_a[std::min(i, of_a.size() - 1)] - of_b[std::min(i, of_b.size() - 1)]));
    }
  }
  return largest_m;
}

Accuracy choose_method(const Scenario& scenario) { return AxisMethodSearch{scenario}.choose(); }

std::vector<MethodTrial> try_methods(const Scenario& scenario) {
  AxisMethodSearch search{scenario};
  search.want_all();
  return search.all();
}

Scenario with_method(Scenario scenario, const Method& method) {
  scenario.run->accuracy_m.reset();
  for (AxisWorld& world : scenario.worlds) {
    if (method.tolerance > 0) world.tolerance = method.tolerance;
  }
  return scenario;
}

}  // namespace breakaway::sil
