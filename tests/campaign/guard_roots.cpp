#include "guard_roots.hpp"

#include <array>

namespace breakaway::campaign {
namespace {

Real evaluate(const Vector& p, Real t) {
  Real sum = 0;
  for (std::size_t k = p.size(); k-- > 0;) sum = sum * t + p[k];
  return sum;
}

Vector derivative(const Vector& p) {
  Vector result;
  for (std::size_t k = 1; k < p.size(); ++k) result.push_back(p[k] * static_cast<double>(k));
  return result;
}

// p(low) and p(high) differ in sign. Bisection, then Newton's method.
Real bracketed_zero(const Vector& p, Real low, Real high) {
  const bool rises = evaluate(p, low) < 0;
  for (int i = 0; i < 12; ++i) {
    const Real middle = (low + high) / 2;
    ((evaluate(p, middle) < 0) == rises ? low : high) = middle;
  }
  const Vector slope = derivative(p);
  Real at = (low + high) / 2;
  for (int i = 0; i < 60; ++i) {
    const Real value = evaluate(p, at);
    ((value < 0) == rises ? low : high) = at;
    Real next = at - value / evaluate(slope, at);
    if (!(next >= low && next <= high)) next = (low + high) / 2;
    if (magnitude(next - at) <= Real(1e-33) * high) return next;
    at = next;
  }
  return at;
}

}  // namespace

std::optional<Real> first_zero(Vector p, Real end, Real noise) {
  Real power = 1;
  while (!p.empty() && magnitude(p.front()) * power <= noise) {
    p.erase(p.begin());
    power *= end;
  }
  if (p.empty()) return std::nullopt;
  if (p.front() < 0) return Real(0);
  if (evaluate(p, end) <= 0) return bracketed_zero(p, 0, end);
  const Vector slope = derivative(p);
  if (slope.empty() || !(evaluate(slope, 0) < 0 && evaluate(slope, end) > 0)) return std::nullopt;
  const Real lowest = bracketed_zero(slope, 0, end);
  if (evaluate(p, lowest) > 0) return std::nullopt;
  return bracketed_zero(p, 0, lowest);
}

bool stays_positive(const Jet& begin, const Jet& middle, const Jet& end, Real length) {
  const Real h = length;
  // Bernstein's coefficients of the interpolation, then those of degree six.
  const std::array<Real, 6> b{begin.value,
                              begin.value + begin.first * h / 5,
                              begin.value + 2 * begin.first * h / 5 + begin.second * h * h / 20,
                              end.value - 2 * end.first * h / 5 + end.second * h * h / 20,
                              end.value - end.first * h / 5,
                              end.value};
  const Real at_middle = (b[0] + 5 * b[1] + 10 * b[2] + 10 * b[3] + 5 * b[4] + b[5]) / 32;
  const Real slope = 5 * ((b[5] - b[0]) + 3 * (b[4] - b[1]) + 2 * (b[3] - b[2])) / (16 * h);
  const Real error = larger(magnitude(at_middle - middle.value), magnitude(slope - middle.first) * h / 8);
  for (std::size_t i = 0; i <= 6; ++i) {
    const Real share = Real(static_cast<double>(i)) / 6;
    Real c = (i < 6 ? (1 - share) * b[i] : Real(0)) + (i > 0 ? share * b[i - 1] : Real(0));
    if (i == 3) c -= 32 * error;
    if (i > 0 && i < 6) c -= error;
    if (!(c > 0)) return false;
  }
  return true;
}

}  // namespace breakaway::campaign
