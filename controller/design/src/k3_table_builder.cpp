#include "breakaway/design/k3_table_builder.hpp"

namespace breakaway::design::detail {

std::vector<Range> hermite_remainders(const K3<double>& law, double spacing, std::size_t intervals) {
  const double unit_spacing = law.unit_per_root() * spacing;
  auto remainders = fourth_derivative_ranges(law.unit(), unit_spacing, intervals);
  const double factor = law.reduced(0) * std::pow(unit_spacing, 4) / 384;
  for (Range& remainder : remainders) remainder = {factor * remainder.least, factor * remainder.greatest};
  return remainders;
}

}  // namespace breakaway::design::detail
