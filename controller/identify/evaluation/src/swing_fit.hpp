// The motion of a motor whose load swings on a spring, about a switch of the force while both slide.
//
// Let M = m1 + m2, rho = m2/m1 and w the resonance. While both slide the friction of either side is a force that
// changes slowly, so that the motor moves by a cubic of time and a swing; a step dF of the force adds
//   dF (t^2 / (2 M) + rho / (M w^2) (1 - the swing that begins at 1 and at rest)),
// which tells the mass and rho from one switch, and with w the spring, K = w^2 M rho / (1 + rho)^2.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "breakaway/evaluation/record.hpp"
#include "constant_force.hpp"

namespace breakaway::evaluation {

// Of all switches of a record.
struct Swing {
  double rate_rad_s = 0, decay_1_s = 0;
  double delay_s = 0;  // from a command to its force
};

// Readings first .. last - 1, all in one motion; from `at` on the force is another.
struct SwitchInMotion {
  std::size_t first = 0, at = 0, last = 0;
  double before_N = 0, after_N = 0;
  int direction = 1;

  std::size_t readings() const { return last - first; }
};

std::vector<SwitchInMotion> switches_in_motion(const Record& record, const std::vector<Stretch>& stretches);

struct SwingFit {
  std::array<double, 4> cubic{};         // of t from the switch on
  std::array<double, 2> ringing{};       // cosine and sine of the swing that was there before
  double per_kg = 0, swing_m_per_N = 0;  // 1/M and rho/(M w^2)
  double residual_m = 0;                 // root mean square, by the degrees of freedom

  double mass_kg() const { return 1 / per_kg; }
  double mass_ratio(double rate_rad_s) const { return swing_m_per_N * rate_rad_s * rate_rad_s / per_kg; }
  double stiffness_N_per_m(double rate_rad_s) const;
};

// Least squares. Nothing where the readings do not tell the coefficients.
std::optional<SwingFit> fit_swing(const Record& record, const SwitchInMotion& one, const Swing& swing);

// Motor and load go one way throughout, as far as the fit says.
bool both_slide(const SwingFit& fit, const SwitchInMotion& one, const Swing& swing, double period_s);

// A parabola and a swing through readings first .. last - 1 under one force: the acceleration of both together, in the
// middle. Requires eight readings.
struct MeanMotion {
  double position_m = 0, speed_m_s = 0, acceleration_m_s2 = 0, residual_m = 0;
};
std::optional<MeanMotion> mean_motion(const Record& record, std::size_t first, std::size_t last, const Swing& swing);

}  // namespace breakaway::evaluation
