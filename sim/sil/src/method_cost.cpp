#include "method_cost.hpp"

#include <cmath>

namespace breakaway::sil {
namespace {

// Nanoseconds for one step of a machine of this size.

// A segment and its share of the modes that are met for the first time, whose factorisation goes with the cube.
double segment_ns(double size) { return 800 + 700 * size + 30 * size * size * size; }

double time_step_ns(double size) { return 85 + 10 * size + 0.35 * size * size; }

double adaptive_step_ns(double size, double tolerance) {
  const double order = 1 - 0.04 * std::log10(tolerance / 1e-12);  // smaller tolerances take more rows of the tableau
  return order * (5000 + 2000 * size + 200 * size * size);
}

double step_ns(const Method& method, double size) {
  switch (method.integrator) {
    case scenario::Integrator::event_driven:
      return segment_ns(size);
    case scenario::Integrator::adaptive:
      return adaptive_step_ns(size, method.tolerance);
    case scenario::Integrator::time_stepping:
      break;
  }
  return time_step_ns(size);
}

constexpr double set_up_ns = 1500;

}  // namespace

double run_cost_s(const scenario::MachineScenario& scenario, const Method& method, double steps) {
  const auto& machine = scenario.machine;
  const double size = static_cast<double>(machine.coordinates() + machine.frictions()) / 2;
  return 1e-9 * (set_up_ns + steps * step_ns(method, size));
}

}  // namespace breakaway::sil
