// UnitKick: the impulse law of [I] without dimensions, in a form that loses no digits.
//
// [I] = van de Wouw & Leine, "Impulsive Control of Mechanical Motion Systems with Uncertain Friction", (12)-(15). The
// printed formulas subtract nearly equal numbers when the error is small or the two poles are close together. Here:
//   poles       lambda1 = -a, lambda2 = -b, 0 < a < b; rho = a/b; epsilon = 1 - rho
//   time to go  sigma = b (t_{j+1} - t)
//   distance    Q = |x1| b^2 / A = sum_{n>=2} h_{n-2} sigma^n / n!,  A = f_lo / m,  h_j = 1 + rho + ... + rho^j
//   speed       W = |x2| b / A = dQ/dsigma = sum_{n>=1} h_{n-1} sigma^n / n! = e^sigma (1 - e^(-epsilon sigma)) /
//   epsilon
// and Q = W - (e^(rho sigma) - 1) / rho. With the root r = sqrt(2 Q) the law is W = r psi(r), where psi is analytic and
// psi(0) = 1.
#pragma once

#include <cmath>
#include <limits>

namespace breakaway::design {

template <class Scalar>
struct UnitKick {
  Scalar rho;      // a / b, in (0, 1)
  Scalar epsilon;  // 1 - a / b, computed without the subtraction

  struct Point {
    Scalar psi;        // W / r
    Scalar psi_slope;  // dpsi/dr
    Scalar growth;     // e^(rho sigma)
    Scalar sigma;      // time to go, in units of 1/b
  };

  // The point of the curve with root r = sqrt(2 Q) in [0, sqrt(max Scalar)]. NaN stays NaN.
  //
  // Newton's method on ln Q(sigma) from the exact solution's two limits joined; the last step is applied to W as well
  // as to sigma, so W is not limited by the spacing of floating-point numbers near sigma.
  Point at_root(Scalar r) const noexcept {
    if (r == 0) return {1, slope_at_rest(), 1, 0};
    Scalar sigma = std::log1p(r * r / 2 + r);
    for (int step = 0; step < max_steps; ++step) {
      const Curve curve = evaluate(sigma);
      const Scalar ratio = sigma / r;
      const Scalar excess = std::log(ratio * ratio * curve.distance);  // ln(Q(sigma) / Q)
      if (std::fabs(excess) < linear_below) return corrected(r, sigma, curve, excess);
      sigma -= sigma * excess * curve.distance / (2 * curve.speed);
    }
    const Scalar none = std::numeric_limits<Scalar>::quiet_NaN();
    return {none, none, none, none};
  }

  // dpsi/dr at r = 0.
  Scalar slope_at_rest() const noexcept { return (1 + rho) / 3; }

 private:
  // At most 5 evaluations are needed over r in [1e-150, 1e150] and zeta - 1 in [1e-15, 1e8] (measured); the limit stops
  // a NaN.
  static constexpr int max_steps = 10;
  // Below this |ln(Q(sigma)/Q)| the neglected square is under a tenth of the rounding unit.
  static constexpr Scalar linear_below = sizeof(Scalar) == sizeof(float) ? Scalar(7e-5) : Scalar(3e-9);

  struct Curve {
    Scalar distance;  // 2 Q / sigma^2
    Scalar speed;     // W / sigma
    Scalar growth;    // e^(rho sigma)
  };

  Curve evaluate(Scalar sigma) const noexcept { return sigma < 1 ? by_series(sigma) : by_exponentials(sigma); }

  Curve by_series(Scalar sigma) const noexcept {
    Scalar distance = 0, speed = 0, power = 1, h = 1;  // power = sigma^j / (j+1)!
    for (int j = 0; power * h > speed * std::numeric_limits<Scalar>::epsilon() / 8; ++j) {
      speed += power * h;
      distance += 2 * power * h / static_cast<Scalar>(j + 2);
      power *= sigma / static_cast<Scalar>(j + 2);
      h = 1 + rho * h;
    }
    return {distance, speed, std::exp(rho * sigma)};
  }

  Curve by_exponentials(Scalar sigma) const noexcept {
    const Scalar slow = mean_growth(rho * sigma);
    const Scalar speed = std::exp(sigma) * mean_growth(-epsilon * sigma);
    return {2 * (speed - slow) / sigma, speed, 1 + rho * sigma * slow};
  }

  // (e^x - 1) / x
  static Scalar mean_growth(Scalar x) noexcept { return x == 0 ? 1 : std::expm1(x) / x; }

  Point corrected(Scalar r, Scalar sigma, const Curve& curve, Scalar excess) const noexcept {
    const Scalar step = excess * curve.distance / (2 * curve.speed);  // relative step of sigma: Q / (sigma W) excess
    const Scalar acceleration = sigma * curve.speed + curve.growth;   // dW/dsigma
    const Scalar psi = sigma / r * curve.speed * (1 - step * acceleration / curve.speed);
    const Scalar growth = curve.growth * (1 - rho * sigma * step);
    const bool near_rest = r < std::sqrt(std::numeric_limits<Scalar>::epsilon());
    const Scalar slope = near_rest ? slope_at_rest() : 1 + (growth / psi - psi) / r;
    return {psi, slope, growth, sigma * (1 - step)};
  }
};

}  // namespace breakaway::design
