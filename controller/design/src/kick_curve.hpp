// What the tables of kicks have in common where they hold a curve.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "breakaway/law/kick_table.hpp"

namespace breakaway::design::detail {

// The cubic through four points of a curve over the root, at Chebyshev's places between left and right.
template <class Real, class Curve>
typename law::KickTable<Real>::Entry cubic_through(double left, double right, const Curve& at_root) {
  std::array<double, 4> t{}, d{};
  for (std::size_t j = 0; j < 4; ++j) {
    t[j] = 0.5 - 0.5 * std::cos((2.0 * static_cast<double>(j) + 1) * 0.39269908169872414);
    d[j] = at_root(left + t[j] * (right - left));
  }
  for (std::size_t order = 1; order < 4; ++order) {
    for (std::size_t j = 3; j >= order; --j) d[j] = (d[j] - d[j - 1]) / (t[j] - t[j - order]);
  }
  // From Newton's form to powers of t, from the innermost bracket outwards.
  const double b0 = d[2] - t[2] * d[3];
  const double c0 = d[1] - t[1] * b0, c1 = b0 - t[1] * d[3];
  const double a0 = d[0] - t[0] * c0, a1 = c0 - t[0] * c1, a2 = c1 - t[0] * d[3], a3 = d[3];
  return {static_cast<Real>(a0), static_cast<Real>(a1), static_cast<Real>(a2), static_cast<Real>(a3)};
}

}  // namespace breakaway::design::detail
