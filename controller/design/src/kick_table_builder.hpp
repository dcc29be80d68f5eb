// Builds the table of the coast "brake", and examines it as the controller reads it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "breakaway/law/braked_kicks.hpp"
#include "kick_class.hpp"
#include "kick_curve.hpp"

namespace breakaway::design::detail {

// A pulse that the drive can give: the force is a whole number of steps.
struct RealPulse {
  double force_N = 0;
  int periods = 0, cut_periods = 0;
  double most_m = 0, least_m = 0;  // its travel
};

// Of the pulses of one entry: its force grows from one end of the entry to the other.
template <class Real>
double greatest_force_N(const law::KickTable<Real>& table, std::size_t entry) {
  const auto& e = table.entries[entry];
  return table.list ? double{e.a1} : std::max(double{e.a0}, double{e.a0} + e.a1 + e.a2 + e.a3);
}

template <class Real>
class KickTableBuilder {
 public:
  using Table = law::KickTable<Real>;

  KickTableBuilder(const BrakedClass& axes, const KickClass& kicks) : axes_{axes}, kicks_{kicks} {}

  // from_m: the least distance that a kick is wanted for.
  void build(double from_m) {
    from_m_ = from_m;
    if (kicks_.listed())
      list(from_m);
    else
      curve(from_m);
  }

  const Table& table() const { return table_; }
  double aim_lost() const { return aim_lost_; }

  // The drive has the force that each pulse of the table is cut with. Behind a very slow current loop the longest cut
  // may ask for more, and a weaker one lets the pulse go on further than the table counts with.
  bool cuts_are_given() const {
    constexpr double rounding = 1e-6;
    for (std::size_t i = 0; i < table_.count; ++i) {
      const double force_N = kicks_.rounded_down_N(std::min(greatest_force_N(table_, i), kicks_.limit_N()));
      if (kicks_.cut_N(force_N, table_.periods[i], table_.cut_periods[i]) > kicks_.limit_N() * (1 + rounding))
        return false;
    }
    return true;
  }

  // The least distance from which on to the end each kick takes its share, and that end.
  Interval range_m() const { return table_.list ? range_of_list() : range_of_curve(); }

  // No kick makes the axis faster. The force is at most F and rises towards it from below A', so that a lag adds to the
  // net force after the pulse no more than it has kept back during the pulse: the impulse above A' is (F - A') n T at
  // most.
  double peak_speed_m_s() const {
    double most = 0;
    for (std::size_t i = 0; i < table_.count; ++i) {
      const double force_N = std::min(greatest_force_N(table_, i), kicks_.limit_N());
      const double net_N = axes_.force_gain.most * force_N - kicks_.least_friction_N();
      const double longest_s = table_.periods[i] * axes_.period_s + axes_.jitter_s;
      most = std::max(most, net_N * longest_s / axes_.mass_kg.least);
    }
    return most;
  }

  // What the controller takes for friction when it sees a lawful kick, at least and at most, and a hundredth more.
  // Springs take and give back what no friction does: there kicks show nothing of it.
  Interval seen_N() const {
    constexpr double anything_N = std::numeric_limits<Real>::max();
    if (axes_.spring_load || axes_.presliding_stiffness_N_per_m > 0) return {-anything_N, anything_N};
    Interval seen{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const auto note = [&](const RealPulse& p) {
      const double mass_kg = (axes_.mass_kg.least + axes_.mass_kg.most) / 2, pulse_s = p.periods * axes_.period_s;
      const auto friction_N = [&](double travel_m) {
        return law::friction_seen_N(mass_kg, p.force_N, kicks_.brake_N(), pulse_s, std::max(travel_m, 0.0));
      };
      seen = {std::min(seen.least, friction_N(p.most_m)), std::max(seen.most, friction_N(p.least_m))};
    };
    for_each_place([&](double distance_m) { note(pulse(distance_m)); });
    const double more = 0.01 * (seen.most - seen.least + kicks_.most_friction_N());
    return {seen.least - more, seen.most + more};
  }

  // A line below what kicks travel at least, as steep as the counts just outside the least tolerance let it be: there a
  // reading says least, because the axis may be half a count nearer or further. range: of range_m().
  law::SureTravel<Real> sure_travel(const Interval& range) const {
    constexpr double rounding = 1e-6, kept = 0.999;
    const double q = axes_.encoder_resolution_m, step_m = q / sure_places;
    const double first_m = std::ceil(range.least / q * (1 - rounding)) * q;
    const double places = std::min(std::floor((range.most - first_m) / step_m), double{sure_counts * sure_places});
    if (axes_.spring_load || axes_.presliding_stiffness_N_per_m > 0 || !(places >= 1)) return {};
    const double most_m = first_m + places * step_m;
    // A count may be where an interval ends, and another pulse begins.
    const auto travel_m = [&](double y) {
      return std::min(least_travel_m(y * (1 - rounding)), least_travel_m(y * (1 + rounding)));
    };
    const double at_first_m = travel_m(first_m);
    double slope = std::min(1.0, (least_travel_beyond_m(most_m) - at_first_m) / (most_m - first_m));
    for (int i = 1; i <= places; ++i)
      slope = std::min(slope, (travel_m(first_m + i * step_m) - at_first_m) / (i * step_m));
    if (!(slope > 0)) return {};
    double from_m = first_m - at_first_m / slope;
    // From here to there a pulse is no weaker than here, unless an interval ends between. A target need be no count.
    for (double here_m = range.least, there_m = 0; here_m < most_m; here_m = there_m) {
      there_m = std::min(here_m + std::max(here_m - first_m, q) / sure_counts, end_of_interval_m(here_m));
      from_m = std::max(from_m, there_m - travel_m(here_m) / slope);
    }
    return {static_cast<Real>(kept * slope), static_cast<Real>(from_m), static_cast<Real>(most_m)};
  }

 private:
  static constexpr int samples = 32;               // of an interval
  static constexpr int longest_cut_periods = 255;  // that the table's bytes hold
  static constexpr int sure_counts = 64;           // beyond the least tolerance, where kicks are sure to lead further
  static constexpr int sure_places = 4;            // of a count, which the line is as steep as

  // Of all entries, from one end of each to the other, which is where the next begins but for its pulse.
  template <class Visitor>
  void for_each_place(const Visitor& visit) const {
    for (std::size_t i = 0; i < table_.count; ++i) {
      if (table_.list) visit(static_cast<double>(table_.entries[i].a0));
      for (int j = 0; j <= samples && !table_.list; ++j) {
        const double left = Table::root_at(table_.first + static_cast<std::uint32_t>(i));
        const double right = Table::root_at(table_.first + static_cast<std::uint32_t>(i) + 1);
        const double s = left + (right - left) * j / samples;
        visit(s * s);
      }
    }
  }

  static double end_of_interval_m(double distance_m) {
    const float root = std::sqrt(static_cast<float>(distance_m));
    const double end = Table::root_at((std::bit_cast<std::uint32_t>(root) >> Table::shift) + 1);
    return end * end;
  }

  // From this distance on, at the end of the table and beyond it as well. Between two places a pulse is no weaker than
  // at the nearer one.
  double least_travel_beyond_m(double distance_m) const {
    double least_m = least_travel_m(std::numeric_limits<Real>::max()), nearer_m = 0;
    for_each_place([&](double y) {
      if (y > distance_m) {
        if (!(nearer_m > distance_m)) least_m = std::min(least_m, least_travel_m(nearer_m));
        least_m = std::min(least_m, least_travel_m(y));
      }
      nearer_m = y;
    });
    return least_m;
  }

  // What the controller does at this distance.
  RealPulse pulse(double distance_m) const {
    const law::Pulse<Real> p = table_.pulse(static_cast<Real>(distance_m));
    const double force_N = given_N(p);
    return {force_N, p.periods, p.cut_periods, kicks_.most_travel_m(force_N, p.periods, p.cut_periods),
            kicks_.least_travel_m(force_N, p.periods, p.cut_periods)};
  }
  double least_travel_m(double distance_m) const {
    const law::Pulse<Real> p = table_.pulse(static_cast<Real>(distance_m));
    return kicks_.least_travel_m(given_N(p), p.periods, p.cut_periods);
  }
  double given_N(const law::Pulse<Real>& p) const {
    return kicks_.rounded_down_N(std::min(static_cast<double>(p.force_N), kicks_.limit_N()));
  }

  // A curve

  void curve(double from_m) {
    const auto root = static_cast<float>(std::sqrt(from_m));
    const std::uint32_t first = std::bit_cast<std::uint32_t>(root) >> Table::shift;
    table_.first = static_cast<std::uint16_t>(first);
    for (int n = 1; n <= longest_pulse_periods; ++n) {
      const int cuts = kicks_.cut_periods(kicks_.limit_N(), n);
      longest_[static_cast<std::size_t>(n)] = {cuts, kicks_.most_travel_m(kicks_.limit_N(), n, cuts)};
    }
    const double end_m = longest_.back().travel_m;
    int periods = 1;
    for (std::size_t i = 0; i < Table::most_entries; ++i) {
      const double left = Table::root_at(first + static_cast<std::uint32_t>(i));
      const double right = Table::root_at(first + static_cast<std::uint32_t>(i) + 1);
      if (left * left > end_m) break;
      const int near = i == 0 ? longest_pulse_periods : periods + 4 + periods / 8;
      periods = best_periods(i == 0 ? 1 : periods, near, left, right);
      // Behind a slow current loop the next length that is sure to move the axis may be far from the last.
      if (share_taken(periods, left * left) < least_share)
        periods = best_periods(periods, longest_pulse_periods, left, right);
      fit(i, left, right, periods);
      table_.count = static_cast<std::uint8_t>(i + 1);
    }
  }

  // The pulse length whose kicks take the most away at worst.
  int best_periods(int from, int to, double left, double right) const {
    int best = from;
    double best_score = -1;
    for (int n = from; n <= std::min(to, longest_pulse_periods); ++n) {
      const double score = score_of(n, {left, (left + right) / 2, right}, best_score);
      if (score <= best_score) continue;
      best = n;
      best_score = score;
    }
    return best;
  }
  // Something that is not above `to_beat` where the score is not.
  double score_of(int periods, const std::array<double, 3>& roots, double to_beat) const {
    double score = 0, worst = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const double share = share_taken(periods, roots[i] * roots[i]);
      score += std::min(share, least_share);
      worst = std::min(worst, share);
      double most = score;
      for (std::size_t later = i + 1; later < roots.size(); ++later) most += least_share;
      if (most + 0.01 * worst <= to_beat) return to_beat;
    }
    return score + 0.01 * worst;
  }
  double share_taken(int periods, double distance_m) const {
    const Longest& longest = longest_[static_cast<std::size_t>(periods)];
    const int at_limit = longest.cut_periods;
    const bool limited = longest.travel_m <= distance_m;
    const double force_N = limited ? kicks_.limit_N() : kicks_.force_N(distance_m, periods, at_limit);
    const double taken_N = kicks_.rounded_down_N(std::min(force_N, kicks_.limit_N()));
    return kicks_.least_travel_m(taken_N, periods, at_limit) / distance_m;
  }

  int cuts_for(double force_N, int periods) const {
    return kicks_.cut_periods(std::min(force_N, kicks_.limit_N()), periods);
  }

  void fit(std::size_t i, double left, double right, int periods) {
    // With fewer periods of cut the force reached is less at the right end, and the cut with it.
    int cuts = cuts_for(kicks_.limit_N(), periods);
    for (int fewer = cuts - 1; fewer >= 1; --fewer) {
      if (cuts_for(kicks_.force_N(right * right, periods, fewer), periods) > fewer) break;
      cuts = fewer;
    }
    table_.periods[i] = static_cast<std::uint8_t>(periods);
    table_.cut_periods[i] = static_cast<std::uint8_t>(cuts);
    table_.entries[i] =
        cubic_through<Real>(left, right, [&](double root) { return kicks_.force_N(root * root, periods, cuts); });
    lower(i, left, right, periods, cuts);
  }

  // Takes off the most by which the cubic, as the controller computes it, lies above the curve.
  void lower(std::size_t i, double left, double right, int periods, int cuts) {
    table_.count = static_cast<std::uint8_t>(i + 1);
    double above_N = 0, most_N = 0;
    for (int j = 0; j <= samples; ++j) {
      const double s = left + (right - left) * (j + 1e-3) / (samples + 2e-3);
      const auto y = static_cast<Real>(s * s);
      const auto force_N = static_cast<double>(table_.pulse(y).force_N);
      const double too_far_m = kicks_.most_travel_m(force_N, periods, cuts) - static_cast<double>(y);
      above_N = std::max(above_N, too_far_m * slope_N_per_m(i, s, right - left));
      most_N = std::max(most_N, force_N);
    }
    // Roundings between the samples: of the root, of t, and of four sums.
    constexpr double unseen = 2e-7;
    const double less_N = 1.05 * above_N + unseen * most_N;
    table_.entries[i].a0 -= static_cast<Real>(less_N);
    note_lost_aim(left, right, periods, cuts);
  }

  // dF/dy of the cubic.
  double slope_N_per_m(std::size_t i, double root, double width) const {
    const typename Table::Entry& e = table_.entries[i];
    const double t = root / width - std::floor(root / width);
    return (e.a1 + t * (2.0 * e.a2 + t * 3.0 * e.a3)) / width / (2 * root);
  }

  void note_lost_aim(double left, double right, int periods, int cuts) {
    for (int j = 1; j < samples; j += 2) {
      const double s = left + (right - left) * j / samples, y = s * s;
      const double force_N = table_.pulse(static_cast<Real>(y)).force_N;
      if (force_N < kicks_.limit_N())
        aim_lost_ = std::max(aim_lost_, 1 - kicks_.most_travel_m(force_N, periods, cuts) / y);
    }
  }

  // Kicks are wanted from from_m_ on, wherever the interval begins in which that lies.
  Interval range_of_curve() const {
    const double end = Table::root_at(table_.first + static_cast<std::uint32_t>(table_.count));
    const double from = least_root(end);
    return {std::max(from * from, from_m_), end * end};
  }
  // In the cell that ends the range its end is looked for more finely: where cells lie follows from the unit of length,
  // and the floor must not.
  double least_root(double end) const {
    double from = end;
    for (int i = table_.count; i-- > 0;) {
      const double left = Table::root_at(table_.first + static_cast<std::uint32_t>(i));
      const double right = Table::root_at(table_.first + static_cast<std::uint32_t>(i) + 1);
      for (int j = samples; j-- > 0;) {
        const double s = left + (right - left) * j / samples;
        from = take_their_share(s, from) ? s : share_taken_from(s, from);
        if (from > s) return from;
      }
    }
    return from;
  }
  double share_taken_from(double left, double right) const {
    double from = right;
    for (int j = samples; j-- > 0;) {
      const double s = left + (right - left) * j / samples;
      if (!take_their_share(s, from)) break;
      from = s;
    }
    return from;
  }
  // Of kicks from between two roots the distance is at most that of the upper one, and the travel at least that of the
  // lower one.
  bool take_their_share(double lower, double upper) const {
    return least_travel_m(lower * lower) >= least_share * upper * upper;
  }

  // A list

  void list(double from_m) {
    table_.list = true;
    std::vector<RealPulse> all = listed_pulses();
    std::ranges::sort(all, {}, &RealPulse::most_m);
    // Of pulses that go about as far the one that is sure to go furthest; all that there is room for.
    const auto last_below = std::ranges::partition_point(all, [&](const RealPulse& p) { return p.most_m <= from_m; });
    if (last_below != all.begin()) all.erase(all.begin(), last_below - 1);
    double spacing = 1.0;
    std::vector<RealPulse> kept;
    do {
      kept = spaced(all, spacing);
      spacing *= 1.02;
    } while (kept.size() > Table::most_entries);
    for (std::size_t i = 0; i < kept.size(); ++i) {
      table_.entries[i] = {rounded_up(kept[i].most_m), static_cast<Real>(kept[i].force_N + axes_.force_step_N / 2), 0,
                           0};
      table_.periods[i] = static_cast<std::uint8_t>(kept[i].periods);
      table_.cut_periods[i] = static_cast<std::uint8_t>(kept[i].cut_periods);
    }
    table_.count = static_cast<std::uint8_t>(kept.size());
  }
  static Real rounded_up(double value) {
    return std::nextafter(static_cast<Real>(value), std::numeric_limits<Real>::infinity());
  }
  std::vector<RealPulse> listed_pulses() const {
    std::vector<RealPulse> all;
    const int steps = static_cast<int>(std::lround(kicks_.limit_N() / axes_.force_step_N));
    for (int n = 1; n <= longest_pulse_periods; ++n) {
      for (int k = std::max(1, static_cast<int>(kicks_.held_N() / axes_.force_step_N)); k <= steps; ++k) {
        const double force_N = k * axes_.force_step_N;
        // A longer cut is rounded to steps otherwise, and may go further for certain.
        const int least_cut = kicks_.cut_periods(force_N, n),
                  most_cut = least_cut > 0 ? std::min(least_cut + 3, longest_cut_periods) : 0;
        for (int cut = least_cut; cut <= most_cut; ++cut) {
          const double least_m = kicks_.least_travel_m(force_N, n, cut);
          if (least_m > 0) all.push_back({force_N, n, cut, kicks_.most_travel_m(force_N, n, cut), least_m});
        }
      }
    }
    return all;
  }
  // Takes from each group of pulses within `spacing` the one that is best for its distance, and leaves out a pulse that
  // is sure of less than one before it.
  static std::vector<RealPulse> spaced(const std::vector<RealPulse>& all, double spacing) {
    std::vector<RealPulse> kept;
    double group_from = 0;
    for (const RealPulse& p : all) {
      if (!kept.empty() && p.least_m <= kept.back().least_m) continue;
      if (!kept.empty() && p.most_m < group_from * spacing && kept.size() > 1) {
        if (p.least_m / p.most_m > kept.back().least_m / kept.back().most_m) kept.back() = p;
        continue;
      }
      group_from = p.most_m;
      kept.push_back(p);
    }
    return kept;
  }
  Interval range_of_list() const {
    if (table_.count == 0) return {std::numeric_limits<double>::infinity(), 0};
    const double end_m = static_cast<double>(table_.entries[table_.count - 1].a0);
    double from_m = end_m;
    for (std::size_t i = table_.count; i-- > 0;) {
      const auto here_m = static_cast<double>(table_.entries[i].a0);
      const double next_m = i + 1u < table_.count ? static_cast<double>(table_.entries[i + 1].a0) : here_m;
      if (!(least_travel_m(here_m) >= least_share * next_m)) break;
      from_m = here_m;
    }
    return {from_m, end_m};
  }

  // The greatest kick of so many periods.
  struct Longest {
    int cut_periods = 0;
    double travel_m = 0;
  };

  const BrakedClass& axes_;
  const KickClass& kicks_;
  std::array<Longest, longest_pulse_periods + 1> longest_{};
  Table table_{};
  double from_m_ = 0;
  double aim_lost_ = 0;
};

}  // namespace breakaway::design::detail
