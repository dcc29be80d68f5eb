// The fourth derivative of the impulse law is bounded here, as a bound on its interpolation error needs it.
#pragma once

#include <vector>

#include "breakaway/design/unit_kick.hpp"

namespace breakaway::design {

struct Range {
  double least;
  double greatest;
};

// Bounds of d^4 psi / dr^4 on [i h, (i + 1) h] for i = 0 .. intervals - 1, with h = spacing > 0 in units of r.
//
// psi(r) solves psi (psi + r psi') = r psi + E, psi E' = rho E (from dW/dsigma = W + E, E = e^(rho sigma), r dr = W
// dsigma), which gives its Taylor coefficients at any r0. They are used to order 16 on discs that cover the range. The
// remainder is bounded by Cauchy's estimate: G = W/sigma and P = 2Q/sigma^2 are power series in sigma with positive
// coefficients whose logarithmic derivatives do not exceed 1, so on |sigma - sigma0| <= q, q < ln 2,
//   |G|, |P| lie between (2 - e^q) and e^q times their values at sigma0, and psi = G / sqrt(P),
// hence psi is analytic on |r - r0| < q (2 - e^q) e^(-q/2) psi(r0) and below e^q / sqrt(2 - e^q) psi(r0) there.
std::vector<Range> fourth_derivative_ranges(const UnitKick<double>& kick, double spacing, std::size_t intervals);

}  // namespace breakaway::design
