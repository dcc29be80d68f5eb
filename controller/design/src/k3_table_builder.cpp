#include "breakaway/design/k3_table_builder.hpp"

namespace breakaway::design::detail {

std::vector<Range> hermite_remainders(const K3<double>& law, double spacing, std::size_t intervals) {
  const double unit_spacing = law.unit_per_root() * spacing;
  auto remainders = fourth_derivative_ranges(law.unit(), unit_spacing, intervals);
  const double factor = law.reduced(0) * std::pow(unit_spacing, 4) / 384;
  for (Range& remainder : remainders) remainder = {factor * remainder.least, factor * remainder.greatest};
  return remainders;
}

double largest_deviation(double off0, double off1, Range remainder) {
  constexpr int cells = 64;  // even, so that H and w are monotone in every cell
  const auto offset = [&](double t) { return off0 + (off1 - off0) * t * t * (3 - 2 * t); };
  const auto weight = [](double t) { return 16 * t * t * (1 - t) * (1 - t); };
  double largest = 0;
  for (int cell = 0; cell < cells; ++cell) {
    const double t0 = static_cast<double>(cell) / cells, t1 = static_cast<double>(cell + 1) / cells;
    const auto [least_w, most_w] = std::minmax({weight(t0), weight(t1)});
    const auto [least_off, most_off] = std::minmax({offset(t0), offset(t1)});
    const double above = most_off - std::min(least_w * remainder.least, most_w * remainder.least);
    const double below = std::max(least_w * remainder.greatest, most_w * remainder.greatest) - least_off;
    largest = std::max({largest, above, below});
  }
  return largest;
}

}  // namespace breakaway::design::detail
