// The worst sequence of kicks that a certificate must count with.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "bent_kicks.hpp"
#include "breakaway/law/kick_table.hpp"
#include "kick_class.hpp"
#include "kick_time.hpp"

namespace breakaway::design::detail {

// What a kick leaves at worst of each error from the tolerance up. A kick that takes more than its least may lead to
// where the next takes less, so that what counts is the worst of all errors up to one, and of all readings of each.
class WorstKicks {
 public:
  template <class Real>
  WorstKicks(const BrakedClass& axes, const law::BrakedKicks<Real>& flashed, double tolerance_m, double reach_m)
      : reading_error_m_{axes.reading_error_m()}, readings_m_{places(flashed.table, tolerance_m, reach_m)} {
    const KickClass kicks{axes};
    const KickTime time{axes, flashed};
    const bool bends = axes.presliding_stiffness_N_per_m > 0;
    const BentKicks bent = bends ? try_bent_kicks(axes, flashed, tolerance_m) : BentKicks{};
    double left_m = 0, longest_s = 0;
    for (std::size_t i = 0; i + 1 < readings_m_.size(); ++i) {
      const law::Pulse<Real> p = flashed.table.pulse(static_cast<Real>(readings_m_[i] * (1 + 1e-9)));
      const double force_N = kicks.rounded_down_N(std::min(static_cast<double>(p.force_N), kicks.limit_N()));
      const double travel_m = kicks.least_travel_m(force_N, p.periods, p.cut_periods);
      const double taken_m = bends ? bent.led_on_m(readings_m_[i], travel_m) : travel_m;
      if (i == 0) least_m_ = taken_m;
      left_m = std::max(left_m, readings_m_[i + 1] + reading_error_m_ - taken_m);
      left_m_.push_back(left_m);
      taken_m_.push_back(taken_m);
      beyond_m_ = taken_m;
      const double cut_N = kicks.cut_N(force_N, p.periods, p.cut_periods);
      longest_s = std::max(longest_s, time.periods(force_N, p.periods, p.cut_periods, cut_N) * axes.period_s);
      longest_s_.push_back(longest_s);
    }
  }

  // The error after a kick from this error, which may be read too near or too far.
  double after(double error_m) const {
    const double nearest_m = error_m - reading_error_m_;
    if (nearest_m > readings_m_.back()) return error_m - beyond_m_;
    const auto next = std::ranges::upper_bound(readings_m_, nearest_m) - readings_m_.begin();
    const double least_left_m = next > 0 ? left_m_[std::min(static_cast<std::size_t>(next) - 1, left_m_.size() - 1)]
                                         : std::min(left_m_.front(), error_m - least_m_);
    return std::max(least_left_m, error_m - least_taken_m(static_cast<std::size_t>(next), error_m + reading_error_m_));
  }

  // The longest time of a kick from an error up to this.
  double longest_s(double error_m) const {
    const auto next = std::ranges::upper_bound(readings_m_, error_m + reading_error_m_) - readings_m_.begin();
    return longest_s_[std::min(static_cast<std::size_t>(next), longest_s_.size() - 1)];
  }

 private:
  // By kicks from readings between that place and this one; infinite where there is no place between.
  double least_taken_m(std::size_t from, double to_m) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = from; i < taken_m_.size() && readings_m_[i] <= to_m; ++i) least = std::min(least, taken_m_[i]);
    return least;
  }

  // Fine enough that an error within two of them is hardly worse than the nearer one; the table's own places among
  // them.
  template <class Real>
  static std::vector<double> places(const law::KickTable<Real>& table, double from_m, double to_m) {
    constexpr double spacing = 1.004;
    std::vector<double> all;
    for (double r = from_m; r < to_m * spacing; r *= spacing) all.push_back(r);
    for (std::size_t i = 0; i < table.count; ++i) {
      const double root = std::bit_cast<float>((table.first + static_cast<std::uint32_t>(i)) << table.shift);
      const double r = table.list ? static_cast<double>(table.entries[i].a0) : root * root;
      if (r > from_m && r < to_m) all.push_back(r);
    }
    std::ranges::sort(all);
    if (all.size() < 2) all.push_back(from_m * spacing);
    return all;
  }

  double reading_error_m_;
  double least_m_ = 0;   // that is taken near the tolerance
  double beyond_m_ = 0;  // that is taken at the end of the table and beyond
  std::vector<double> readings_m_, left_m_, taken_m_, longest_s_;
};

}  // namespace breakaway::design::detail
