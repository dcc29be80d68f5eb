// Random axes whose load hangs on a spring, of which an experiment knows nothing.
#pragma once

#include <array>
#include <cmath>
#include <string>

#include "../two_mass_axis.hpp"
#include "random_unknown_axis.hpp"

namespace breakaway::campaign {

// motor: mass and friction of its side only, and all that is not of the spring.
struct UnknownJoint {
  UnknownAxis motor, load;
  design::SpringLoad spring;
  double damping = 0;  // share of the critical

  double mass_kg() const { return motor.mass_kg + load.mass_kg; }
  double damping_Ns_per_m() const {
    const double reduced_kg = motor.mass_kg * load.mass_kg / mass_kg();
    return 2 * damping * std::sqrt(spring.stiffness_N_per_m * reduced_kg);
  }
};

inline UnknownJoint random_unknown_joint(Random& r, double least_Hz = 50, double most_Hz = 300) {
  UnknownJoint axis;
  const UnknownAxis whole = random_unknown_axis(r);
  const double rho = r.decades(0.2, 5), share = r.between(0.2, 0.8);
  axis.motor = axis.load = whole;
  axis.load.mass_kg = whole.mass_kg * rho / (1 + rho);
  axis.motor.mass_kg = whole.mass_kg - axis.load.mass_kg;
  axis.motor.friction_N *= share;
  axis.load.friction_N *= 1 - share;
  for (UnknownAxis* side : {&axis.motor, &axis.load}) {
    side->wave = r.between(0, 0.15);
    side->tilt = (0.15 - side->wave) * r.between(-1, 1);
    side->phase = r.between(0, 6.3);
    side->rise_at_rest = r.share() < 0.3 ? r.between(0, 0.1) : 0;
    side->lag_s = r.share() < 0.5 ? 0 : 0.2e-3 * r.share();
  }
  axis.load.lag_s = axis.motor.lag_s;
  axis.spring.motor_kg = axis.motor.mass_kg;
  axis.spring.load_kg = axis.load.mass_kg;
  axis.spring.stiffness_N_per_m = 1;
  axis.spring.stiffness_N_per_m = std::pow(r.decades(least_Hz, most_Hz) / axis.spring.resonance_Hz(), 2);
  axis.damping = r.decades(0.003, 0.05);
  return axis;
}

// told_of_load: the experiment is the one for a load on a spring.
template <class Scalar>
testing::ExperimentRun run_experiment(const UnknownJoint& axis, const testing::Trouble& trouble = {},
                                      bool told_of_load = true) {
  const auto friction_of = [](const UnknownAxis& side) {
    return [&side](const testing::Moment& now) {
      const double v = now.velocity_m_s;
      return side.friction_at(now.position_m, (v != 0 ? v : now.force_N) < 0 ? -1 : 1, v);
    };
  };
  double load_m = axis.motor.start_m;
  testing::TwoMassAxis plant{axis.spring,
                             axis.damping,
                             {.mass_kg = axis.mass_kg(), .lag_s = axis.motor.lag_s},
                             {friction_of(axis.motor), friction_of(axis.load)},
                             axis.motor.start_m,
                             &load_m};
  auto told = testing::told<Scalar>(axis.motor);
  told.load_on_spring = told_of_load;
  return testing::run_experiment_on(plant, told, axis.motor.latency_periods, trouble, &load_m);
}

}  // namespace breakaway::campaign
