// K3: the exact impulse law of van de Wouw & Leine, "Impulsive Control of Mechanical Motion Systems with Uncertain
// Friction" ([I]), eqs. (12)-(15) and Proposition 1, for any zeta > 1.
//
// The kick k3(y) sends an axis that rests at position error y back to its target: under the lower friction bound it
// comes to rest exactly there. Signs: y = position - target; the impulse opposes y.
#pragma once

#include <cmath>

#include "breakaway/design/unit_kick.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::design {

// All must be finite and positive, and damping^2 > 4 mass stiffness (zeta > 1).
template <class Scalar>
struct KickPlant {
  Scalar mass_kg{};
  Scalar stiffness_N_per_m{};  // k1
  Scalar damping_Ns_per_m{};   // k22
  Scalar friction_lower_N{};   // m g mu_lower
};

// Relative error of impulse, speed and time to go: below 1e-14 in double for zeta - 1 in [1e-14, 1e8] and
// |y| / c_lower in [1e-300, 1e6], wherever the result is a normal number. Inputs are taken as exact.
template <class Scalar>
class K3 {
 public:
  static K3 make(const KickPlant<Scalar>& plant);

  // k3(y) [N s] at position error y [m]; odd in y, NaN for NaN.
  Scalar impulse_Ns(Scalar position_error_m) const noexcept {
    const Scalar root = std::sqrt(std::fabs(position_error_m));
    return std::copysign(reduced_at_rest_ * root * point(root).psi, -position_error_m);
  }

  // Speed right after the kick, |k3(y)| / m [m/s].
  Scalar speed_m_s(Scalar position_error_m) const noexcept {
    const Scalar root = std::sqrt(std::fabs(position_error_m));
    return speed_per_root_ * root * point(root).psi;
  }

  // Time from the kick to rest on the target under the lower friction bound, t_{j+1} - t_j of (13) [s].
  Scalar time_to_go_s(Scalar position_error_m) const noexcept {
    return point(std::sqrt(std::fabs(position_error_m))).sigma / fast_rate_per_s_;
  }

  // R = |k3| / s at s = sqrt|y| [sqrt(m)], and dR/ds. R(0) = sqrt(2 m f_lower).
  Scalar reduced(Scalar root) const noexcept { return reduced_at_rest_ * point(root).psi; }
  Scalar reduced_slope(Scalar root) const noexcept { return reduced_at_rest_ * unit_per_root_ * point(root).psi_slope; }

  // The law without dimensions, and r = unit_per_root() s.
  const UnitKick<Scalar>& unit() const noexcept { return unit_; }
  Scalar unit_per_root() const noexcept { return unit_per_root_; }

 private:
  K3() = default;
  typename UnitKick<Scalar>::Point point(Scalar root) const noexcept { return unit_.at_root(unit_per_root_ * root); }

  UnitKick<Scalar> unit_{};
  Scalar unit_per_root_{};    // b sqrt(2 m / f_lower) [1/sqrt(m)]
  Scalar reduced_at_rest_{};  // sqrt(2 m f_lower) [N s / sqrt(m)]
  Scalar speed_per_root_{};   // sqrt(2 f_lower / m)
  Scalar fast_rate_per_s_{};  // b = -lambda2
};

// zeta = k / (2 sqrt(k1 m)) without overflow on the way.
template <class Scalar>
Scalar damping_ratio(Scalar mass_kg, Scalar stiffness_N_per_m, Scalar damping_Ns_per_m) noexcept {
  return damping_Ns_per_m / (2 * std::sqrt(stiffness_N_per_m) * std::sqrt(mass_kg));
}

// Returns the error that refuses zeta <= 1.
InputError too_little_damping(double mass_kg, double stiffness_N_per_m, double damping_Ns_per_m);

template <class Scalar>
K3<Scalar> K3<Scalar>::make(const KickPlant<Scalar>& plant) {
  const auto& [m, k1, k22, f] = plant;
  require_positive("mass_kg", static_cast<double>(m));
  require_positive("stiffness k1", static_cast<double>(k1));
  require_positive("damping k22", static_cast<double>(k22));
  require_positive("friction_lower_N", static_cast<double>(f));
  // k22^2 - 4 k1 m, scaled to k22 in [1/2, 1), with the rounding errors of both products (fma): exact to the last bit
  // even when the two are equal in all their leading digits.
  int k22_exponent = 0, k1_exponent = 0, m_exponent = 0;
  const Scalar d = std::frexp(k22, &k22_exponent);
  const Scalar k = std::frexp(k1, &k1_exponent);
  const Scalar mantissa = std::frexp(m, &m_exponent);
  const Scalar scaled_mass = std::ldexp(mantissa, m_exponent + k1_exponent + 2 - 2 * k22_exponent);
  const Scalar d2 = d * d, four_km = k * scaled_mass;
  const Scalar discriminant = (d2 - four_km) + (std::fma(d, d, -d2) - std::fma(k, scaled_mass, -four_km));
  if (!(discriminant > 0))
    throw too_little_damping(static_cast<double>(m), static_cast<double>(k1), static_cast<double>(k22));
  const Scalar split = std::sqrt(discriminant) / d;  // (b - a) / (b + a)
  const Scalar fast = d * (1 + split);
  K3 law;
  law.unit_ = {four_km / (fast * fast), 2 * split / (1 + split)};
  law.unit_per_root_ = k22 * (1 + split) / (std::sqrt(2 * m) * std::sqrt(f));
  law.reduced_at_rest_ = std::sqrt(2 * m) * std::sqrt(f);
  law.speed_per_root_ = std::sqrt(2 * f) / std::sqrt(m);
  law.fast_rate_per_s_ = k22 * (1 + split) / (2 * m);
  return law;
}

}  // namespace breakaway::design
