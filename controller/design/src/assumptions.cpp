#include "breakaway/design/assumptions.hpp"

#include <cmath>

namespace breakaway::design {
namespace {

// ln(lambda2 / lambda1) = ln(b / a), also for nearly equal poles.
double log_pole_ratio(const UnitKick<double>& kick) noexcept {
  return kick.rho > 0.5 ? -std::log1p(-kick.epsilon) : -std::log(kick.rho);
}

// (a / (b - a)) ln(b / a) = u / (e^u - 1) with u = ln(b / a): falls from 1 at u = 0 to 0.
double settling_exponent(double u) noexcept { return u == 0 ? 1 : u / std::expm1(u); }

// The u > 0 with settling_exponent(u) = exponent in (0, 1), by bisection.
double log_pole_ratio_for(double exponent) noexcept {
  double low = 0, high = 800;
  while (true) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return high;
    (settling_exponent(middle) > exponent ? low : high) = middle;
  }
}

// It is false for a damping at which there is no kick, too.
bool satisfies_18(const KickPlant<double>& plant, const law::FrictionBounds<double>& friction) try {
  return friction.ratio() > ratio_threshold_18(K3<double>::make(plant).unit());
} catch (const InputError&) {
  return false;
}

}  // namespace

void require_valid(const law::FrictionBounds<double>& friction) {
  require_positive("friction_lower_N", friction.lower_N);
  require_positive("friction_upper_N", friction.upper_N);
  if (friction.lower_N <= friction.upper_N) return;
  throw InputError{"friction_lower_N", "is " + to_text(friction.lower_N) +
                                           ", above friction_upper_N = " + to_text(friction.upper_N) +
                                           "; Assumption 1 needs lower <= upper: exchange or correct them"};
}

double ratio_threshold_18(const UnitKick<double>& kick) noexcept {
  return -std::expm1(-settling_exponent(log_pole_ratio(kick)));
}

double exact_ratio_threshold(const UnitKick<double>& kick) noexcept {
  // In units of c_lower, with Y = c_upper / c_lower: short(Y) = Y - z - 1 is convex, negative at Y = 1 and positive for
  // large Y, so it changes sign once.
  const double share = kick.rho * std::exp(-settling_exponent(log_pole_ratio(kick)));  // z / W
  const auto falls_short = [&](double log_Y) {
    const double root = std::sqrt(2 / kick.rho) * std::exp(log_Y / 2);
    return std::expm1(log_Y) > share * root * kick.at_root(root).psi;
  };
  double low = 0, high = 36;  // e^-36 is where doubles near 1 end: Y and Y - 1 are the same beyond
  while (true) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return std::exp(-low);
    (falls_short(middle) ? high : low) = middle;
  }
}

std::optional<double> least_damping_for_18(double mass_kg, double stiffness_N_per_m,
                                           const law::FrictionBounds<double>& friction) {
  require_positive("mass_kg", mass_kg);
  require_positive("stiffness k1", stiffness_N_per_m);
  require_valid(friction);
  // (18) reads settling_exponent(u) < -ln(1 - ratio), with zeta = cosh(u / 2).
  const double exponent = friction.ratio() < 0.5 ? -std::log1p(-friction.ratio()) : -std::log(friction.gap());
  const double u = exponent >= 1 ? 0 : log_pole_ratio_for(exponent);
  double damping = 2 * std::sqrt(mass_kg) * std::sqrt(stiffness_N_per_m) * std::cosh(u / 2);
  // That is a few roundings from the first number that passes.
  for (int i = 0; i < 4; ++i) damping = std::nextafter(damping, 0);
  for (int i = 0; i < 1000 && std::isfinite(damping); ++i, damping = std::nextafter(damping, HUGE_VAL)) {
    if (satisfies_18({mass_kg, stiffness_N_per_m, damping, friction.lower_N}, friction)) return damping;
  }
  return std::nullopt;
}

double finite_time_bound_s(double mass_kg, const law::FrictionBounds<double>& friction,
                           double position_error_m) noexcept {
  // 1 / (1 - sqrt(1 - ratio)) = (1 + sqrt(1 - ratio)) / ratio
  const double kicks = (1 + std::sqrt(friction.gap())) / friction.ratio();
  return std::sqrt(2 * std::fabs(position_error_m) * mass_kg / friction.lower_N) * kicks;
}

double accuracy_floor_m(double mass_kg, const law::FrictionBounds<double>& friction, double period_s) noexcept {
  return friction.upper_N * (friction.upper_N - friction.lower_N) / (2 * mass_kg * friction.lower_N) * period_s *
         period_s;
}

}  // namespace breakaway::design
