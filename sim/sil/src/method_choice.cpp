#include "breakaway/sil/method_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "best_end.hpp"
#include "method_cost.hpp"

namespace breakaway::sil {
namespace {

using scenario::Integrator;
using scenario::MachineScenario;

constexpr std::array tolerances{1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13};
constexpr double fewest_time_steps = 8;
constexpr double dearest_run_s = 1;  // beyond this a run is refused and not tried
constexpr double dearest_shown_s = 0.05;

class MethodSearch {
 public:
  explicit MethodSearch(const MachineScenario& s)
      : s_{s}, asked_m_{*s.accuracy_m}, best_{best_end(s, asked_m_, refused_)} {}

  Accuracy choose() {
    if (!s_.laws.empty() && !s_.integrator_is_named) refuse_friction_laws();
    if (best_) try_all();
    std::optional<MethodTrial> chosen;
    for (const MethodTrial& trial : trials_) {
      if (trial.holds && (!chosen || trial.cost_s < chosen->cost_s)) chosen = trial;
    }
    if (!chosen) throw AccuracyRefused{s_.file, asked_m_, refused_};
    return {asked_m_, chosen->method, chosen->estimate_m, chosen->cost_s, refused_, trials_};
  }

  std::vector<MethodTrial> all() {
    if (!best_) return {};
    if (best_->method.integrator == Integrator::event_driven) try_events();
    show_tolerances();
    if (s_.laws.empty()) show_time_steps();
    return trials_;
  }

 private:
  bool may_take(Integrator integrator) const { return !s_.integrator_is_named || s_.integrator == integrator; }

  void refuse(const Method& method, std::string reason, double cost_s) {
    refused_.push_back({method, std::move(reason), cost_s});
  }
  void refuse_friction_laws() {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    for (const Integrator other : {Integrator::event_driven, Integrator::time_stepping}) {
      refused_.push_back({{other}, "knows constant friction only", none, false});
    }
  }

  void try_all() {
    const Integrator best = best_->method.integrator;
    if (best == Integrator::event_driven && may_take(Integrator::event_driven)) try_events();
    // A step of the adaptive method costs several segments of the event-driven one and there are more of them, so that
    // it cannot be the cheapest where that one holds.
    if (best != Integrator::time_stepping && may_take(Integrator::adaptive) && !cheapest_s()) climb_tolerances();
    if (may_take(Integrator::time_stepping) && s_.laws.empty()) climb_time_steps();
  }

  std::optional<double> cheapest_s() const {
    std::optional<double> least;
    for (const MethodTrial& trial : trials_) {
      if (trial.holds) least = std::min(trial.cost_s, least.value_or(trial.cost_s));
    }
    return least;
  }

  const MethodTrial& add(const Method& method, double error_m, double estimate_m, double cost_s) {
    trials_.push_back({method, error_m, estimate_m, cost_s, error_m <= asked_m_});
    return trials_.back();
  }
  double error_m(const MachineEnd& end) const { return end.distance_m(best_->end) + best_->error_m; }

  void try_events() {
    const double cost_s = run_cost_s(s_, best_->method, best_->end), error_m = best_->error_m;
    if (add(best_->method, error_m, error_m, cost_s).holds) return;
    refuse(best_->method, fmt::format("errs by {:.2g} m from rounding", error_m), cost_s);
  }

  const MethodTrial& try_tolerance(double tolerance) {
    const Method method{.integrator = Integrator::adaptive, .tolerance = tolerance};
    const MachineEnd end = machine_end(s_, method);
    return add(method, error_m(end), error_m(end), run_cost_s(s_, method, end));
  }

  void climb_tolerances() {
    std::optional<MethodTrial> last;
    try {
      for (const double tolerance : tolerances) {
        last = try_tolerance(tolerance);
        if (last->holds) return;
      }
    } catch (const InputError& error) {
      refused_.push_back(cannot_follow(Integrator::adaptive, error));
      return;
    }
    refuse(last->method, fmt::format("errs by {:.2g} m at its finest tolerance", last->error_m), last->cost_s);
  }

  // Time steps may see rest later than the best end has it: the share of the duration that the last ones took counts.
  double cost_of_time_steps_s(double steps) const {
    const double rested_share = std::min(1.0, best_->end.time_s / s_.duration_s);
    return run_cost_s(s_, {.integrator = Integrator::time_stepping}, std::max(rested_share, stepped_share_) * steps);
  }

  // The error is infinite where the steps are too long for the machine.
  double try_time_steps(double steps) {
    const Method method{.integrator = Integrator::time_stepping, .step_s = step_of(s_, steps)};
    try {
      const std::vector<MachineEnd> ends = ends_by_time_steps(s_, method.step_s);
      stepped_share_ = static_cast<double>(ends.back().steps) / steps;
      double largest_m = 0;
      for (const MachineEnd& end : ends) largest_m = std::max(largest_m, error_m(end));
      return add(method, largest_m, error_m(ends.back()), run_cost_s(s_, method, ends.back())).error_m;
    } catch (const InputError&) {
      return std::numeric_limits<double>::infinity();
    }
  }

  void show_tolerances() {
    try {
      for (const double tolerance : tolerances) try_tolerance(tolerance);
    } catch (const InputError&) {  // finer ones are refused too
    }
  }

  // A machine that rests at once is the same to steps of any length, and so is their cost.
  bool rests_at_once() const { return best_->end.time_s == 0; }

  void show_time_steps() {
    for (double steps = fewest_time_steps; cost_of_time_steps_s(steps) < dearest_shown_s; steps *= 2) {
      try_time_steps(steps);
      if (rests_at_once()) return;
    }
  }

  // Steps shrink by sqrt(2): some machines end at the same place after any step below one that is hard to foretell.
  // Only where no other method bounds the search by its cost they shrink by more while the error, which is of the first
  // order, is far from the one asked for.
  void climb_time_steps() {
    const std::optional<double> limit_s = cheapest_s();
    if (best_->error_m > asked_m_) {
      return refuse({Integrator::time_stepping},
                    fmt::format("cannot be judged to better than {:.2g} m", best_->error_m), NAN);
    }
    for (double steps = fewest_time_steps;;) {
      const double cost_s = cost_of_time_steps_s(steps);
      if (limit_s && cost_s >= *limit_s) return;
      const Method method{.integrator = Integrator::time_stepping, .step_s = step_of(s_, steps)};
      if (cost_s > dearest_run_s)
        return refuse(method, fmt::format("would need steps of {:.2g} s", method.step_s), cost_s);
      const double error_m = try_time_steps(steps);
      if (error_m <= asked_m_) return;
      if (rests_at_once()) return refuse(method, "does not see that the machine rests at once", cost_s);
      const double lacking = limit_s || !std::isfinite(error_m) ? 1 : error_m / asked_m_;
      steps = std::round(steps * std::max(std::numbers::sqrt2, lacking / 4));
    }
  }

  const MachineScenario& s_;
  double asked_m_;
  std::vector<MethodRefusal> refused_;
  std::optional<BestEnd> best_;
  std::vector<MethodTrial> trials_;
  double stepped_share_ = 0;
};

}  // namespace

Accuracy choose_method(const MachineScenario& scenario) { return MethodSearch{scenario}.choose(); }

std::vector<MethodTrial> try_methods(const MachineScenario& scenario) { return MethodSearch{scenario}.all(); }

}  // namespace breakaway::sil
