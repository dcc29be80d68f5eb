#include "machine_end.hpp"

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/time_stepping.hpp"
#include "impulse_walk.hpp"

namespace breakaway::sil {
namespace {

using scenario::Integrator;
using scenario::MachineScenario;
using Outcome = hybrid::Outcome<Eigen::Dynamic>;
using State = hybrid::MachineState<Eigen::Dynamic>;

constexpr auto nothing = [](const State&) {};

Outcome end_by_events(const MachineScenario& s) {
  const hybrid::EventDriven<> integrator{s.machine};
  return walk_impulses(
      s, [&](const State& start, double end_s) { return integrator.run(start, end_s); }, nothing);
}

Outcome end_by_adaptive_steps(const MachineScenario& s, double tolerance) {
  const hybrid::AdaptiveOptions options{.tolerance = tolerance};
  const hybrid::Adaptive integrator =
      s.laws.empty() ? hybrid::Adaptive{s.machine, options} : hybrid::Adaptive{s.machine, s.laws, options};
  auto laws = integrator.laws();
  return walk_impulses(
      s, [&](const State& start, double end_s) { return integrator.resume(laws, start, end_s); }, nothing);
}

Outcome end_by_time_steps(const MachineScenario& s, double step_s, double first_step) {
  const hybrid::TimeStepping<> first{s.machine, {.step_s = first_step * step_s, .theta = s.theta}};
  const hybrid::TimeStepping<> others{s.machine, {.step_s = step_s, .theta = s.theta}};
  bool begun = first_step == 1;
  return walk_impulses(
      s,
      [&](State start, double end_s) {
        if (!begun && end_s > start.time_s) {
          begun = true;
          auto memory = first.memory();
          first.step(start, memory);
        }
        return others.run(start, end_s);
      },
      nothing);
}

Outcome end_by(const MachineScenario& s, const Method& method, double first_step) {
  switch (method.integrator) {
    case Integrator::event_driven:
      return end_by_events(s);
    case Integrator::adaptive:
      return end_by_adaptive_steps(s, method.tolerance);
    case Integrator::time_stepping:
      break;
  }
  return end_by_time_steps(s, method.step_s, first_step);
}

}  // namespace

MachineEnd machine_end(const MachineScenario& scenario, const Method& method, double first_step) {
  const Outcome outcome = end_by(scenario, method, first_step);
  if (!outcome.end.q.allFinite()) throw InputError{"its coordinates leave the range of numbers: shorten duration_s"};
  return {outcome.end.q, outcome.end.time_s, outcome.steps, outcome.events};
}

double step_of(const MachineScenario& scenario, double steps) {
  return scenario.duration_s / steps * (1 + 2 * std::numeric_limits<double>::epsilon());
}

MachineScenario with_method(MachineScenario scenario, const Method& method) {
  scenario.accuracy_m.reset();
  scenario.integrator = method.integrator;
  if (method.step_s > 0) scenario.step_s = method.step_s;
  if (method.tolerance > 0) scenario.tolerance = method.tolerance;
  return scenario;
}

}  // namespace breakaway::sil
