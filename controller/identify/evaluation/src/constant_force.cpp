#include "constant_force.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace breakaway::evaluation {

double rounding_m(const Record& record) { return record.resolution_m / std::sqrt(12.0); }

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::vector<Stretch> stretches_of(const Record& record) {
  std::vector<Stretch> found;
  const auto& readings = record.readings;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const bool goes_on = !found.empty() && found.back().last == i && readings[i].fresh &&
                         std::abs(readings[i].command_N - found.back().command_N) < record.force_step_N / 2;
    if (goes_on)
      ++found.back().last;
    else if (readings[i].fresh)
      found.push_back({i, i + 1, readings[i].command_N});
  }
  return found;
}

Parabola fit(const Record& record, std::size_t first, std::size_t last) {
  const auto n = static_cast<double>(last - first);
  const double middle = static_cast<double>(first) + (n - 1) / 2, T = record.period_s;
  // Orthogonal polynomials on n equidistant points: 1, t and t^2 - c.
  const double mean_square = (n * n - 1) / 12;
  const double norm_linear = n * mean_square, norm_square = n * (n * n - 1) * (n * n - 4) / 180;
  const double origin_m = record.readings[first].position_m;
  double constant = 0, linear = 0, square = 0;
  for (std::size_t i = first; i < last; ++i) {
    const double t = static_cast<double>(i) - middle, x = record.readings[i].position_m - origin_m;
    constant += x, linear += x * t, square += x * (t * t - mean_square);
  }
  const double curve = square / norm_square, slope = linear / norm_linear;
  double residual_m2 = 0;
  for (std::size_t i = first; i < last; ++i) {
    const double t = static_cast<double>(i) - middle, x = record.readings[i].position_m - origin_m;
    residual_m2 += std::pow(x - constant / n - slope * t - curve * (t * t - mean_square), 2);
  }
  const double residual_m = std::sqrt(residual_m2 / n);
  const double scatter_m = std::max(rounding_m(record), residual_m * std::sqrt(n / (n - 3)));
  return {.first = first,
          .last = last,
          .middle = middle,
          .position_m = origin_m + constant / n - curve * mean_square,
          .speed_m_s = slope / T,
          .acceleration_m_s2 = 2 * curve / (T * T),
          .error_m_s2 = 2 * scatter_m / std::sqrt(norm_square) / (T * T),
          .residual_m = residual_m};
}

double scatter_m(const Record& record, std::size_t first, std::size_t last) {
  const auto position_m = [&](std::size_t i) { return record.readings[i].position_m; };
  std::vector<double> thirds_m;
  for (std::size_t i = first + 3; i < last; ++i)
    thirds_m.push_back(std::abs(position_m(i) - position_m(i - 3) - 3 * (position_m(i - 1) - position_m(i - 2))));
  // The variance of a third difference is 20 times that of a reading, and half of all normal numbers are within 0.6745
  // of their standard deviation.
  if (thirds_m.empty()) return rounding_m(record);
  return std::max(rounding_m(record), median(std::move(thirds_m)) / (0.6745 * std::sqrt(20.0)));
}

double readings_for(double error_m_s2, double scatter_m, double period_s) {
  return std::pow(26.8 * scatter_m / (error_m_s2 * period_s * period_s), 0.4);
}

Motion motion_in(const Record& record, std::size_t first, std::size_t last) {
  constexpr std::size_t patience = 16;
  const auto& readings = record.readings;
  Motion motion{first, first, 0};
  std::size_t left_at = first;
  for (std::size_t i = first + 1; i < last; ++i) {
    const double step_m = readings[i].position_m - readings[i - 1].position_m;
    if (std::abs(step_m) < record.resolution_m / 2) {
      if (i - left_at > patience) break;
      continue;
    }
    const int direction = step_m > 0 ? 1 : -1;
    if (motion.direction != 0 && direction != motion.direction) break;
    if (motion.direction == 0) motion.first = left_at;
    motion.direction = direction;
    motion.last = left_at = i;
  }
  if (motion.direction == 0) motion.last = motion.first;
  return motion;
}

}  // namespace breakaway::evaluation
