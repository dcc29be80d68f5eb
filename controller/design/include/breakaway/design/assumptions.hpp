// The assumptions of van de Wouw & Leine, "Impulsive Control of Mechanical Motion Systems with Uncertain Friction"
// ([I]), as numbers: what friction uncertainty a choice of gains tolerates, and the reverse.
//
// Forces instead of coefficients: f_lower = m g mu_lower and f_upper = m g mu_upper bound the dry friction, so
// mu_lower / mu_upper = f_lower / f_upper (Assumption 1: 0 < f_lower <= f_upper).
#pragma once

#include <optional>
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"

#include "breakaway/design/k3.hpp"
#include "breakaway/law/friction_bounds.hpp"

namespace breakaway::design {

// Throws InputError when Assumption 1 does not hold, or a bound is not finite.
void require_valid(const law::FrictionBounds<double>& friction);

// Assumption 3 holds when f_lower / f_upper exceeds one of these.
constexpr double ratio_threshold_17 = 0.5;                         // (17)
double ratio_threshold_18(const UnitKick<double>& kick) noexcept;  // (18): 1 - (lambda1 / lambda2)^(-a1)

// The least f_lower / f_upper for which Assumption 3 really holds, (17) and (18) being sufficient only: at the outer
// edge -c_upper spring and f_upper cancel, so a kick is followed by the free overdamped response
//   z(t) = V0 (e^(-a t) - e^(-b t)) / (b - a), largest z = (V0 / b) (a / b)^(a / (b - a)),
// and it must reach the inner stick set: c_upper - z <= c_lower. Absolute error below 1e-14; at least e^-36.
double exact_ratio_threshold(const UnitKick<double>& kick) noexcept;

// Remark 1: the smallest damping k22 [N s/m] for which (18) holds. (18) is a strict inequality, so the infimum itself
// is not a solution: the answer is the next number above it for which the check succeeds. For f_lower / f_upper >=
// 1 - 1/e every zeta > 1 will do, and the answer is the first number above 2 sqrt(k1 m).
//
// Nothing for ratios that would need more damping than a number can hold. Throws InputError for a mass or stiffness
// that is not positive and for bounds that break Assumption 1.
std::optional<double> least_damping_for_18(double mass_kg, double stiffness_N_per_m,
                                           const law::FrictionBounds<double>& friction);

// Returns (19), the longest time from rest at y2, |y2| <= c_lower, to rest on the target [s].
double finite_time_bound_s(double mass_kg, const law::FrictionBounds<double>& friction,
                           double position_error_m) noexcept;

// Least displacement that a force pulse of one period is sure to cause: the pulse must exceed f_upper to move the axis
// at all, and moves it by f_upper (f_upper - f_lower) / (2 m f_lower) Ts^2 when the friction is f_lower [m].
double accuracy_floor_m(double mass_kg, const law::FrictionBounds<double>& friction, double period_s) noexcept;

}  // namespace breakaway::design
