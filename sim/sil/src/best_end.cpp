#include "best_end.hpp"

#include <algorithm>
#include <array>

#include "breakaway/hybrid/refused.hpp"
#include "method_cost.hpp"
#include "rounding_pilot.hpp"

namespace breakaway::sil {
namespace {

using scenario::Integrator;
using scenario::MachineScenario;

constexpr std::array first_steps{0.25, 0.5, 0.75, 1.0};

constexpr double tight = 1e-13;
// Near enough to `tight` for the same rounding, and far enough to take other steps.
constexpr std::array nearby{2.2e-13, 4.7e-13, 1e-12};

BestEnd by_events(const MachineScenario& s) {
  const Method method{Integrator::event_driven};
  const MachineEnd end = machine_end(s, method);
  return {end, rounding_error_m(s, end), method};
}

BestEnd by_adaptive_steps(const MachineScenario& s) {
  const Method method{.integrator = Integrator::adaptive, .tolerance = tight};
  const MachineEnd end = machine_end(s, method);
  double scatter_m = 0;
  for (const double tolerance : nearby) {
    const MachineEnd other = machine_end(s, {.integrator = Integrator::adaptive, .tolerance = tolerance});
    scatter_m = std::max(scatter_m, other.distance_m(end));
  }
  return {end, scatter_m + std::numeric_limits<double>::epsilon() * end.q_m.cwiseAbs().maxCoeff(), method};
}

// The mean over the phases has an error of the first order in the step without the scatter of a single run.
Eigen::VectorXd mean_m(const std::vector<MachineEnd>& ends) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(ends.front().q_m.size());
  for (const MachineEnd& end : ends) sum += end.q_m;
  return sum / static_cast<double>(ends.size());
}

// Extrapolates two steps to none, until two such results agree or the next run would be too dear.
BestEnd by_time_steps(const MachineScenario& s, double accuracy_m) {
  constexpr double dearest_run_s = 0.25;  // runs begin in four phases, and those before cost as much again in all
  BestEnd best{{}, std::numeric_limits<double>::infinity(), {.integrator = Integrator::time_stepping}};
  Eigen::VectorXd coarser_m, extrapolated_m;
  const auto cost_s = [&](double steps) { return run_cost_s(s, best.method, steps); };
  for (double steps = 64; cost_s(steps) <= dearest_run_s && best.error_m > accuracy_m / 8; steps *= 2) {
    const double step_s = step_of(s, steps);
    const std::vector<MachineEnd> ends = ends_by_time_steps(s, step_s);
    const Eigen::VectorXd here_m = mean_m(ends);
    const Eigen::VectorXd before_m = extrapolated_m;
    if (coarser_m.size() > 0) extrapolated_m = 2 * here_m - coarser_m;
    coarser_m = here_m;
    if (before_m.size() == 0) continue;
    best.end = ends.back();
    best.end.q_m = extrapolated_m;
    best.error_m = (extrapolated_m - before_m).cwiseAbs().maxCoeff();
    best.method.step_s = step_s;
  }
  return best;
}

}  // namespace

// The remedies are for whoever chose the method.
MethodRefusal cannot_follow(Integrator integrator, const InputError& error) {
  const auto* refused = dynamic_cast<const hybrid::Refused*>(&error);
  const std::string cause = refused != nullptr ? refused->cause() : error.what();
  return {.method = {.integrator = integrator}, .reason = "cannot follow this machine: " + cause, .follows = false};
}

std::vector<MachineEnd> ends_by_time_steps(const MachineScenario& scenario, double step_s) {
  std::vector<MachineEnd> ends;
  ends.reserve(std::size(first_steps));
  for (const double first : first_steps) {
    ends.push_back(machine_end(scenario, {.integrator = Integrator::time_stepping, .step_s = step_s}, first));
  }
  return ends;
}

std::optional<BestEnd> best_end(const MachineScenario& scenario, double accuracy_m,
                                std::vector<MethodRefusal>& refused) {
  const auto attempt = [&](Integrator integrator, const auto& run) -> std::optional<BestEnd> {
    try {
      return run();
    } catch (const InputError& error) {
      refused.push_back(cannot_follow(integrator, error));
      return std::nullopt;
    }
  };
  std::optional<BestEnd> best;
  if (scenario.laws.empty()) best = attempt(Integrator::event_driven, [&] { return by_events(scenario); });
  if (!best) best = attempt(Integrator::adaptive, [&] { return by_adaptive_steps(scenario); });
  if (!best && scenario.laws.empty()) {
    best = attempt(Integrator::time_stepping, [&] { return by_time_steps(scenario, accuracy_m); });
  }
  return best;
}

}  // namespace breakaway::sil
