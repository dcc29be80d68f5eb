// How often values lie in bins of equal width.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace breakaway::report {

struct Histogram {
  double least = 0, width = 0;      // of the first bin; each has this width
  std::vector<std::size_t> counts;  // empty without a finite value

  double middle(std::size_t bin) const { return least + (static_cast<double>(bin) + 0.5) * width; }
};

// Passes over what is not finite. Equal values have one bin, of a width that can be drawn.
inline Histogram histogram_of(std::vector<double> values, std::size_t bins) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {};
  const auto [least, most] = std::ranges::minmax(values);
  const double span = most - least;
  if (!(span > 1e-9 * std::max(std::abs(least), std::abs(most)))) {
    const double width = least == 0 ? 1 : std::abs(least) / 10;
    return {least - width / 2, width, {values.size()}};
  }
  Histogram histogram{least, span / static_cast<double>(bins), std::vector<std::size_t>(bins)};
  for (const double value : values) {
    const auto bin = static_cast<std::size_t>((value - least) / histogram.width);
    ++histogram.counts[std::min(bin, bins - 1)];
  }
  return histogram;
}

}  // namespace breakaway::report
