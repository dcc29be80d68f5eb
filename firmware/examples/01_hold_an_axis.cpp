// Example 1: bring an axis that sticks to its target, and hold it there.
//
// The controller below is the class that is flashed. It sees the axis as a controller does, by encoder counts once a
// period, and its force acts one period later. The axis is a mass on dry friction that the simulation follows exactly.
// Friction follows a Stribeck curve that the controller is not told: it knows two bounds.
//
// A PD alone would leave this axis up to f_upper / k1 = 11 mm from its target.
#include <cmath>
#include <cstdio>
#include <exception>

#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/design/pd_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/slide.hpp"

using namespace breakaway;

int main() try {
  constexpr double mass_kg = 1, count_m = 1e-6, period_s = 1e-3;
  law::AxisParameters<float> p;
  p.mass_kg = mass_kg;
  p.stiffness_N_per_m = 400;         // k1
  p.approach_damping_Ns_per_m = 32;  // k21: on the way to the first rest, zeta < 1
  p.kick_damping_Ns_per_m = 60;      // k22: from the first kick on, zeta > 1
  p.friction = {2.5F, 4.5F};         // newtons; nothing else is known of the friction
  p.max_force_N = 50;
  p.encoder_resolution_m = static_cast<float>(count_m);
  p.period_s = static_cast<float>(period_s);
  p.position_tolerance_m = p.accuracy_floor_m();  // what a pulse of one period can still correct

  // On a PC, once: the kicks that end on the target under the least friction, as tables over the distance. k3 is the
  // ideal one, an impulse; the pulses are what comes to the same in this loop.
  const auto k3 = design::build_k3_table<float>(
      {p.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N}, p.stick_radius_upper_m());
  const auto pulses = design::design_pd_kicks(p);
  law::AxisController<float> controller{p, k3.table, pulses.table};

  // The axis, 10 mm short of its target at 0.
  motion::Slide axis{mass_kg, {{2.5, 4.5}, model::shape::stribeck(0.01)}, {0, -0.01, 0}};

  const auto show = [&](int period, const char* what) {
    std::printf("%6g ms  %11.2f um  %s\n", 1e3 * period_s * period, 1e6 * axis.state().position_m, what);
  };
  const int periods = static_cast<int>(0.5 / period_s);
  std::printf("%9s  %14s\n", "time", "error");
  double acting_N = 0;
  for (int period = 0; period < periods; ++period) {
    const double counts = std::floor(axis.state().position_m / count_m);
    const auto output = controller.update({static_cast<float>(counts * count_m)});
    if (output.kicked) show(period, "kick");

    axis.advance_to(period_s * (period + 1), {.constant_N = acting_N});
    acting_N = static_cast<double>(output.force_N);
  }
  const bool held = controller.mode() == law::Mode::hold;
  show(periods, held ? "held" : "not held");
  // What counts round down shows up to a count less.
  const double promised_m = static_cast<double>(p.position_tolerance_m) + count_m;
  return held && std::abs(axis.state().position_m) <= promised_m ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
