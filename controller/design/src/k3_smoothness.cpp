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

// sum_{j=1}^{k} f_j (k - j + 1) g_{k-j+1}: the terms of (f g')_k that do not hold the newest coefficient of g.
double product_with_derivative(const Series& f, const Series& g, int k) {
  double sum = 0;
  for (int j = 1; j <= k; ++j) sum += f[j] * (k - j + 1) * g[k - j + 1];
  return sum;
}

double square(const Series& f, int first, int k) {
  double sum = 0;
  for (int j = first; j <= k - first; ++j) sum += f[j] * f[k - j];
  return sum;
}

// Taylor coefficients of psi about r0.
Series taylor(const UnitKick<double>& kick, double r0) {
  const auto point = kick.at_root(r0);
  Series psi{}, growth{};
  psi[0] = point.psi;
  growth[0] = point.growth;
  for (int k = 0; k < order; ++k) {
    if (r0 == 0 && k > 0) {  // r = 0 is a regular singular point: psi_k follows from the terms in r^k
      psi[k] = (psi[k - 1] + growth[k] - square(psi, 1, k) - product_with_derivative(psi, psi, k - 1)) / (k + 2);
    }
    if (r0 > 0) {
      const double before = k == 0 ? 0 : psi[k - 1] - (product_with_derivative(psi, psi, k - 1) + psi[0] * k * psi[k]);
      const double sum = psi[k] + (before + growth[k] - square(psi, 0, k)) / r0;
      psi[k + 1] = (sum - product_with_derivative(psi, psi, k)) / ((k + 1) * psi[0]);
    }
    growth[k + 1] = (kick.rho * growth[k] - product_with_derivative(psi, growth, k)) / ((k + 1) * psi[0]);
  }
  if (r0 == 0) {
    psi[order] =
        (psi[order - 1] + growth[order] - square(psi, 1, order) - product_with_derivative(psi, psi, order - 1)) /
        (order + 2);
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
