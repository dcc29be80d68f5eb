#include "guard_roots.hpp"

#include <array>

namespace breakaway::campaign {
namespace {

template <class Real>
Real evaluate(const Vector<Real>& p, Real t) {
  Real sum = 0;
  for (std::size_t k = p.size(); k-- > 0;) sum = sum * t + p[k];
  return sum;
}

template <class Real>
Vector<Real> derivative(const Vector<Real>& p) {
  Vector<Real> result;
  for (std::size_t k = 1; k < p.size(); ++k) result.push_back(p[k] * static_cast<double>(k));
  return result;
}

// p(low) and p(high) differ in sign. Bisection, then Newton's method.
template <class Real>
Real bracketed_zero(const Vector<Real>& p, Real low, Real high) {
  const bool rises = evaluate(p, low) < 0;
  for (int i = 0; i < 12; ++i) {
    const Real middle = (low + high) / 2;
    ((evaluate(p, middle) < 0) == rises ? low : high) = middle;
  }
  const Vector<Real> slope = derivative(p);
  Real at = (low + high) / 2;
  for (int i = 0; i < 60; ++i) {
    const Real value = evaluate(p, at);
    ((value < 0) == rises ? low : high) = at;
    Real next = at - value / evaluate(slope, at);
    if (!(next >= low && next <= high)) next = (low + high) / 2;
    if (magnitude(next - at) <= Real(Rounding<Real>::unit) * high) return next;
    at = next;
  }
  return at;
}

}  // namespace

template <class Real>
std::optional<Real> first_zero(Vector<Real> p, Real end, Real noise) {
  Real power = 1;
  while (!p.empty() && magnitude(p.front()) * power <= noise) {
    p.erase(p.begin());
    power *= end;
  }
  if (p.empty()) return std::nullopt;
  if (p.front() < 0) return Real(0);
  if (evaluate(p, end) <= 0) return bracketed_zero(p, Real(0), end);
  const Vector<Real> slope = derivative(p);
  if (slope.empty() || !(evaluate(slope, Real(0)) < 0 && evaluate(slope, end) > 0)) return std::nullopt;
  const Real lowest = bracketed_zero(slope, Real(0), end);
  if (evaluate(p, lowest) > 0) return std::nullopt;
  return bracketed_zero(p, Real(0), lowest);
}

template <class Real>
bool stays_positive(const Jet<Real>& begin, const Jet<Real>& middle, const Jet<Real>& end, Real length) {
  const Real h = length;
  const Real begin_first = begin.first * h / 5, begin_second = begin.second * h * h / 20;
  const Real end_first = end.first * h / 5, end_second = end.second * h * h / 20;
  // Bernstein's coefficients of the interpolation, then six times those of degree six.
  const std::array<Real, 6> b{begin.value,
                              begin.value + begin_first,
                              begin.value + 2 * begin_first + begin_second,
                              end.value - 2 * end_first + end_second,
                              end.value - end_first,
                              end.value};
  const Real at_middle = (b[0] + 5 * b[1] + 10 * b[2] + 10 * b[3] + 5 * b[4] + b[5]) / 32;
  const Real slope = 5 * ((b[5] - b[0]) + 3 * (b[4] - b[1]) + 2 * (b[3] - b[2])) / 16;  // times h
  const Real error = larger(magnitude(at_middle - middle.value), magnitude(slope - middle.first * h) / 8);
  for (int i = 0; i <= 6; ++i) {
    const auto at = static_cast<std::size_t>(i);
    Real c = (i < 6 ? (6 - i) * b[at] : Real(0)) + (i > 0 ? i * b[at - 1] : Real(0));
    if (i > 0 && i < 6) c -= (i == 3 ? 6 * 33 : 6) * error;
    if (!(c > 0)) return false;
  }
  return true;
}

template std::optional<Fast> first_zero(Vector<Fast>, Fast, Fast);
template std::optional<Quad> first_zero(Vector<Quad>, Quad, Quad);
template bool stays_positive(const Jet<Fast>&, const Jet<Fast>&, const Jet<Fast>&, Fast);
template bool stays_positive(const Jet<Quad>&, const Jet<Quad>&, const Jet<Quad>&, Quad);

}  // namespace breakaway::campaign
