#include "breakaway/design/k3_smoothness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace breakaway::design {
namespace {

constexpr int order = 16;

struct Series {
  std::array<double, order + 1> coefficients{};
  double& operator[](int k) { return coefficients[static_cast<std::size_t>(k)]; }
  const double& operator[](int k) const { return coefficients[static_cast<std::size_t>(k)]; }
};

// The terms of (f g')_k without the newest coefficient of g: sum_{j=1}^{k} f_j (k - j + 1) g_{k-j+1}.
double older_terms(const Series& f, const Series& g, int k) {
  double sum = 0;
  for (int j = 1; j <= k; ++j) sum += f[j] * (k - j + 1) * g[k - j + 1];
  return sum;
}

// sum_{j=first}^{k-first} f_j f_{k-j}
double square(const Series& f, int first, int k) {
  double sum = 0;
  for (int j = first; j <= k - first; ++j) sum += f[j] * f[k - j];
  return sum;
}

// psi_k about r = 0, a regular singular point, from the terms in r^k of r psi psi' = r psi + E - psi^2.
double next_at_rest(const Series& psi, const Series& growth, int k) {
  return (psi[k - 1] + growth[k] - square(psi, 1, k) - older_terms(psi, psi, k - 1)) / (k + 2);
}

// psi_k about r0 > 0, from the terms in (r - r0)^(k-1) of the same equation.
double next_at(double r0, const Series& psi, const Series& growth, int k) {
  const int n = k - 1;
  double terms = growth[n] - square(psi, 0, n);
  if (n > 0) terms += psi[n - 1] - older_terms(psi, psi, n - 1) - psi[0] * n * psi[n];
  return (psi[n] + terms / r0 - older_terms(psi, psi, n)) / (k * psi[0]);
}

// Taylor coefficients of psi about r0.
Series taylor(const UnitKick<double>& kick, double r0) {
  const auto point = kick.at_root(r0);
  Series psi{}, growth{};
  psi[0] = point.psi;
  growth[0] = point.growth;
  for (int k = 1; k <= order; ++k) {
    growth[k] = (kick.rho * growth[k - 1] - older_terms(psi, growth, k - 1)) / (k * psi[0]);
    psi[k] = r0 == 0 ? next_at_rest(psi, growth, k) : next_at(r0, psi, growth, k);
  }
  return psi;
}

double falling_4(double k) { return k * (k - 1) * (k - 2) * (k - 3); }

// The disc of Cauchy's estimate for q = 0.31, near which the estimate is least, in units of psi(r0).
constexpr double q = 0.31;
const double analytic_radius = q * (2 - std::exp(q)) * std::exp(-q / 2);
const double analytic_bound = std::exp(q) / std::sqrt(2 - std::exp(q));
constexpr double used_share = 0.1;  // of the analytic radius that one expansion serves

// Bounds of psi'''' within `reach` of r0.
Range range_around(const UnitKick<double>& kick, double r0, double reach) {
  const Series psi = taylor(kick, r0);
  const double middle = falling_4(4) * psi[4];
  double deviation = 1e-3 * std::fabs(middle), power = reach;  // 1e-3: the coefficients' own rounding
  for (int k = 5; k <= order; ++k, power *= reach) deviation += falling_4(k) * std::fabs(psi[k]) * power;
  // Terms beyond the order: each is at most 1.5 share times the one before.
  const double radius = analytic_radius * psi[0], share = reach / radius;
  deviation += analytic_bound * psi[0] * falling_4(order + 1) * std::pow(share, order - 3) / std::pow(radius, 4) /
               (1 - 1.5 * share);
  return {middle - deviation, middle + deviation};
}

}  // namespace

std::vector<Range> fourth_derivative_ranges(const UnitKick<double>& kick, double spacing, std::size_t intervals) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<Range> ranges(intervals, {infinity, -infinity});
  const double end = spacing * static_cast<double>(intervals);
  double center = 0, left = 0;
  while (left < end) {
    const double reach = used_share * analytic_radius * kick.at_root(center).psi;
    const Range here = range_around(kick, center, reach);
    const double right = center + reach;
    const auto first = static_cast<std::size_t>(left / spacing);
    const auto last = right < end ? static_cast<std::size_t>(right / spacing) + 1 : intervals;
    for (std::size_t i = first; i < std::min(last, intervals); ++i) {
      ranges[i] = {std::min(ranges[i].least, here.least), std::max(ranges[i].greatest, here.greatest)};
    }
    left = right;
    center = right + reach;  // psi grows with r, so the reach around the next centre is at least this one
  }
  return ranges;
}

}  // namespace breakaway::design
