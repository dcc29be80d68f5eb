// Where a quantity that must stay positive reaches zero, on one short step and on a long one.
#pragma once

#include <optional>

#include "quad_algebra.hpp"

namespace breakaway::campaign {

// The first zero in (0, end] of a polynomial that bends at most once there; a zero at 0 itself, up to `noise`, is left
// out. Returns 0 where it leaves that zero downwards.
std::optional<Real> first_zero(Vector coefficients, Real end, Real noise);

// Value and first two derivatives.
struct Jet {
  Real value, first, second;
};

// Says whether the quantity surely stays above zero over a step of this length, judged from its ends and its middle.
// The interpolation of fifth order through the ends is held against the middle.
bool stays_positive(const Jet& begin, const Jet& middle, const Jet& end, Real length);

}  // namespace breakaway::campaign
