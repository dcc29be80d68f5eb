// Moreau's time stepping of the 1-DOF impulsive closed loop of van de Wouw & Leine, "Impulsive Control of Mechanical
// Motion Systems with Uncertain Friction" ([I]): eqs. (1)-(5), (8) and (16), as in the simulations of its section V.
//
// It never settles. A kick from y gives the speed sqrt(2 A y), A = f_lower / m, which friction takes away within the
// next step once y < A h^2 / 2; the midpoint rule then moves the axis by h/2 sqrt(2 A y) instead of y. That map has the
// two-cycle +-A h^2 / 8, into which all small errors fall: a kick a step, for ever. The outcome is that ball.
#pragma once

#include <cmath>
#include <cstdint>

#include "breakaway/input/input_error.hpp"

namespace breakaway::hybrid {

struct ImpulsivePlant {
  double mass_kg;
  double stiffness_N_per_m;          // k1
  double approach_damping_Ns_per_m;  // k21, until the first kick
  double kick_damping_Ns_per_m;      // k22, from then on
  double friction_lower_N;           // m g mu_lower
  double friction_upper_N;           // m g mu_upper: kicks are given where k1 |x| does not exceed it, (5)
};

struct ImpulsiveOutcome {
  double first_rest_s = 0;       // end of the step of the first kick, t1; NaN: never
  double ball_m = 0;             // largest |x| from ball_from_s on
  double predicted_ball_m = 0;   // f_lower h^2 / (8 m)
  std::uint64_t kicks = 0;       // in all
  std::uint64_t late_kicks = 0;  // from ball_from_s on
  std::uint64_t late_steps = 0;
};

// level_N(time_s, x_m, speed_m_s): the friction force level; impulse_Ns(x_m): the impulse law k3. All mechanical
// numbers and step_s must be positive and finite; the ball is that of the time from ball_from_s to end_s.
template <class Level, class Impulse>
ImpulsiveOutcome run_impulsive(const ImpulsivePlant& plant, double x_m, double v_m_s, double step_s, double ball_from_s,
                               double end_s, Level level_N, Impulse impulse_Ns) {
  if (!(step_s > 0) || !std::isfinite(end_s / step_s))
    throw InputError{"step_s and end_s must be finite and step_s above 0"};
  const double m = plant.mass_kg, h = step_s, k1 = plant.stiffness_N_per_m;
  ImpulsiveOutcome outcome;
  outcome.first_rest_s = std::nan("");
  outcome.predicted_ball_m = plant.friction_lower_N * h * h / (8 * m);
  const auto steps = static_cast<std::uint64_t>(std::ceil(end_s / h));
  for (std::uint64_t i = 1; i <= steps; ++i) {
    const double time_s = static_cast<double>(i) * h;
    const double k2 = outcome.kicks > 0 ? plant.kick_damping_Ns_per_m : plant.approach_damping_Ns_per_m;
    const double middle_m = x_m + h / 2 * v_m_s;
    const double free_m_s = v_m_s + h / m * (-k1 * middle_m - k2 * v_m_s);
    const double taken_m_s = h / m * level_N(time_s, middle_m, std::fabs(v_m_s));
    const bool rests = std::fabs(free_m_s) <= taken_m_s;
    v_m_s = rests ? 0 : free_m_s - std::copysign(taken_m_s, free_m_s);
    x_m = middle_m + h / 2 * v_m_s;
    const bool late = time_s >= ball_from_s;
    if (late) {
      ++outcome.late_steps;
      outcome.ball_m = std::fmax(outcome.ball_m, std::fabs(x_m));
    }
    if (!rests || k1 * std::fabs(x_m) > plant.friction_upper_N || x_m == 0) continue;
    if (outcome.kicks == 0) outcome.first_rest_s = time_s;
    ++outcome.kicks;
    if (late) ++outcome.late_kicks;
    v_m_s = impulse_Ns(x_m) / m;
  }
  return outcome;
}

}  // namespace breakaway::hybrid
