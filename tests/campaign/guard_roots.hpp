// Where a quantity that must stay positive reaches zero, on one short step and on a long one.
#pragma once

#include <optional>

#include "dense_algebra.hpp"

namespace breakaway::campaign {

// The first zero in (0, end] of a polynomial that bends at most once there; a zero at 0 itself, up to `noise`, is left
// out. Returns 0 where it leaves that zero downwards.
template <class Real>
std::optional<Real> first_zero(Vector<Real> coefficients, Real end, Real noise);

// Value and first two derivatives.
template <class Real>
struct Jet {
  Real value, first, second;
};

// Says whether the quantity surely stays above zero over a step of this length, judged from its ends and its middle.
// The interpolation of fifth order through the ends is held against the middle.
template <class Real>
bool stays_positive(const Jet<Real>& begin, const Jet<Real>& middle, const Jet<Real>& end, Real length);

}  // namespace breakaway::campaign
