#include "method_cost.hpp"

#include <cmath>

#include "breakaway/hybrid/time_stepping.hpp"

namespace breakaway::sil {
namespace {

// Nanoseconds for one step of a machine of this size.

// A segment and its share of the modes that are met for the first time, whose factorisation goes with the cube.
double segment_ns(double size) { return 800 + 700 * size + 30 * size * size * size; }

double time_step_ns(double size) { return 85 + 10 * size + 0.35 * size * size; }

// What finding the impulses of all directions at once adds, which nearly dependent ones need.
double impulses_ns(double frictions) { return 600 * frictions * frictions; }

double adaptive_step_ns(double size, double tolerance) {
  const double order = 1 - 0.04 * std::log10(tolerance / 1e-12);  // smaller tolerances take more rows of the tableau
  return order * (5000 + 2000 * size + 200 * size * size);
}

double step_ns(const hybrid::LinearMachine<>& machine, const Method& method) {
  const double size = static_cast<double>(machine.coordinates() + machine.frictions()) / 2;
  switch (method.integrator) {
    case scenario::Integrator::event_driven:
      return segment_ns(size);
    case scenario::Integrator::adaptive:
      return adaptive_step_ns(size, method.tolerance);
    case scenario::Integrator::time_stepping:
      break;
  }
  const bool at_once = hybrid::nearly_dependent(machine);
  return time_step_ns(size) + (at_once ? impulses_ns(static_cast<double>(machine.frictions())) : 0);
}

constexpr double set_up_ns = 1500;

}  // namespace

double run_cost_s(const scenario::MachineScenario& scenario, const Method& method, double steps) {
  return 1e-9 * (set_up_ns + steps * step_ns(scenario.machine, method));
}

}  // namespace breakaway::sil
