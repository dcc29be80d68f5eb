#include "breakaway/motion/constant_friction_motion.hpp"

#include <algorithm>
#include <cmath>

#include "breakaway/motion/roots.hpp"

namespace breakaway::motion {
namespace {

// (1 - e^-z) / z and (1 - (1 - e^-z) / z) / z: mean value of e^-z over the time so far, and its own complement's mean.
struct Decay {
  double first;
  double second;
};

Decay decay_means(double z) {
  if (z > 0.5) {
    const double first = -std::expm1(-z) / z;
    return {first, (1 - first) / z};
  }
  double second = 0;  // sum of (-z)^n / (n + 2)!
  for (int n = 14; n >= 0; --n) second = (1 - z * second) / (n + 2);
  return {1 - z * second, second};
}

// Fundamental solution of y'' + 2 p y' + q y = 0, y(0) = 0, y'(0) = 1: its slope, itself, its integral.
struct Fundamental {
  double slope;
  double value;
  double integral;
};

// With a, b the roots times tau: value / tau and integral / tau^2 are divided differences of exp at {a, b} and {0, a,
// b}, sums over n of h_n(a, b) / (n + 1)! and / (n + 2)!, where the complete homogeneous polynomials h_n follow from a
// + b and a b alone. So real, double and complex roots are one case, and nothing cancels.
Fundamental fundamental_by_series(double p, double q, double tau) {
  const double sum = -2 * p * tau, product = q * tau * tau;
  double previous = 0, h = 1, factorial = 1;
  Fundamental f{0, 0, 0};
  for (int n = 0; n < 22; ++n) {
    f.slope += h / factorial;
    factorial *= n + 1;
    f.value += h / factorial;
    f.integral += h / (factorial * (n + 2));
    const double next = sum * h - product * previous;
    previous = h;
    h = next;
    if (std::abs(h) + std::abs(previous) < 1e-18 * factorial) break;
  }
  return {f.slope, f.value * tau, f.integral * tau * tau};
}

Fundamental fundamental(double p, double q, double tau) {
  const double product = q * tau * tau;
  if (std::abs(2 * p * tau) < 1 && std::abs(product) < 0.1) return fundamental_by_series(p, q, tau);
  const double squared = p * p - q;
  const double w = std::sqrt(std::abs(squared));
  double cosine, sine;  // e^(-p tau) cosh(w tau) and e^(-p tau) sinh(w tau) / w, or with cos and sin
  double slow = 0, fast = 0;
  if (squared > 0) {
    fast = p > 0 ? -(p + w) : w - p;  // the root of greater magnitude; the other from the product of both
    slow = q / fast;
    const double greater = std::fmax(slow, fast);
    cosine = 0.5 * (std::exp(slow * tau) + std::exp(fast * tau));
    sine = -std::exp(greater * tau) * std::expm1(-2 * w * tau) / (2 * w);
  } else {
    const double envelope = std::exp(-p * tau);
    cosine = envelope * std::cos(w * tau);
    sine = w > 0 ? envelope * std::sin(w * tau) / w : envelope * tau;
  }
  const double slope = cosine - p * sine;
  if (std::abs(product) >= 0.1) return {slope, sine, (1 - cosine - p * sine) / q};
  // A weak spring and a strong damper: the roots are far apart, and the small one may vanish.
  const double slow_mean = slow == 0 ? tau : std::expm1(slow * tau) / slow;
  return {slope, sine, (slow_mean - std::expm1(fast * tau) / fast) / (slow - fast)};
}

}  // namespace

double ConstantFrictionMotion::speed_at(double tau) const {
  if (has_feedback()) {
    const auto f = fundamental(decay_per_s, stiffness_per_s2, tau);
    return speed_m_s * f.slope + acceleration_m_s2 * f.value;
  }
  const double speed = speed_m_s + acceleration_m_s2 * tau;
  return transient_m_s2 == 0 ? speed : speed + transient_m_s2 * tau * decay_means(tau / time_constant_s).first;
}

double ConstantFrictionMotion::distance_at(double tau) const {
  if (has_feedback()) {
    const auto f = fundamental(decay_per_s, stiffness_per_s2, tau);
    return speed_m_s * f.value + acceleration_m_s2 * f.integral;
  }
  const double distance = tau * (speed_m_s + 0.5 * acceleration_m_s2 * tau);
  return transient_m_s2 == 0 ? distance
                             : distance + transient_m_s2 * tau * tau * decay_means(tau / time_constant_s).second;
}

double ConstantFrictionMotion::acceleration_at(double tau) const {
  const double transient = transient_m_s2 == 0 ? 0 : transient_m_s2 * std::exp(-tau / time_constant_s);
  const double feedback = has_feedback() ? 2 * decay_per_s * speed_at(tau) + stiffness_per_s2 * distance_at(tau) : 0;
  return acceleration_m_s2 + transient - feedback;
}

double ConstantFrictionMotion::first_rest_s(double horizon_s) const {
  double rest_s = never;
  if (has_feedback()) {
    // speed e^(p tau) = speed cosh(w tau) + (acceleration - p speed) sinh(w tau) / w, or with cos and sin.
    const double squared = decay_per_s * decay_per_s - stiffness_per_s2;
    const double w = std::sqrt(std::abs(squared));
    if (squared < 0) {
      rest_s = std::atan2(w * speed_m_s, decay_per_s * speed_m_s - acceleration_m_s2) / w;
    } else {
      const double slow = decay_per_s > 0 ? -stiffness_per_s2 / (decay_per_s + w) : w - decay_per_s;
      const double along_slow = -(acceleration_m_s2 + slow * speed_m_s);
      if (along_slow > 0) {
        const double ratio = speed_m_s / along_slow;
        rest_s = w * ratio > 0 ? std::log1p(2 * w * ratio) / (2 * w) : ratio;
      }
    }
    return rest_s <= horizon_s ? rest_s : never;
  }
  if (transient_m_s2 == 0) {
    if (acceleration_m_s2 < 0) rest_s = -speed_m_s / acceleration_m_s2;
    return rest_s <= horizon_s ? rest_s : never;
  }
  // The acceleration is monotone: its extremes are at the ends, and the speed has at most one extremum.
  const double least = std::min({0.0, acceleration_at(0), acceleration_at(horizon_s)});
  if (speed_m_s + least * horizon_s > 0) return never;
  const auto speed = [this](double tau) { return motion::ValueAndSlope{speed_at(tau), acceleration_at(tau)}; };
  const double turn_s = time_constant_s * std::log(-transient_m_s2 / acceleration_m_s2);  // NaN without a turn
  const bool turns = turn_s > 0 && turn_s < horizon_s;
  if (turns && speed_at(turn_s) <= 0) return motion::bracketed_newton(speed, 0, turn_s, false);
  if (speed_at(horizon_s) > 0) return never;
  return motion::bracketed_newton(speed, turns ? turn_s : 0, horizon_s, false);
}

double ConstantFrictionMotion::time_to_distance_s(double distance_m, double horizon_s) const {
  const auto excess = [&](double tau) { return motion::ValueAndSlope{distance_at(tau) - distance_m, speed_at(tau)}; };
  return motion::bracketed_newton(excess, 0, horizon_s, true);
}

}  // namespace breakaway::motion
