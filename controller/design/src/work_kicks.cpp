#include "breakaway/design/work_kicks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "breakaway/law/work_aim.hpp"
#include "jointed.hpp"
#include "memo.hpp"
#include "work_approach.hpp"

namespace breakaway::design {
namespace {

using detail::infinite;
using detail::Jointed;

constexpr double least_counts = 0.51;

template <class Real>
class WorkTable {
 public:
  using Table = law::KickTable<Real>;

  // reach_m: the distance up to which kicks are needed.
  WorkTable(const Jointed& axis, double reach_m) : axis_{axis}, swing_{swing_periods(axis)} {
    const double from_m = axis.spring_m() + axis.axes.encoder_resolution_m / 4;
    const std::uint32_t least = interval_of(from_m), last = least + 16 * 12;
    // From where no pulse is sure, an interval at a time, until one is in each that follows.
    for (std::uint32_t first = least; first < last && !reaches(reach_m); first += table_.count + 1u) {
      table_.count = 0;
      table_.first = static_cast<std::uint16_t>(first);
      while (table_.count < Table::most_entries && add(first + table_.count)) {
      }
    }
  }

  static int swing_periods(const Jointed& axis) {
    return static_cast<int>(std::clamp(std::round(axis.swing_s() / axis.axes.period_s), 1.0, 1e6));
  }
  const Table& table() const { return table_; }

 private:
  static constexpr int samples = 32;
  static constexpr double good_share = 0.2, enough_share = 0.05;
  bool reaches(double reach_m) const { return table_.count > 0 && static_cast<double>(table_.reach_m()) >= reach_m; }
  static std::uint32_t interval_of(double distance_m) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(std::sqrt(distance_m))) >> Table::shift;
  }
  double at(std::uint32_t high, double t, int n) const {
    const double s = Table::root_at(high) + t * (Table::root_at(high + 1) - Table::root_at(high));
    return axis_.force_N(s * s, n);
  }

  bool fits(std::uint32_t high, int n) const {
    return at(high, 0, n) >= axis_.least_N(n) * (1 - 1e-9) && at(high, 1, n) <= axis_.axes.max_force_N;
  }
  // Of the distance, that the kick takes away at least. What is less than asked for is not followed further.
  double least_share(std::uint32_t high, int n, double asked) const {
    double least = infinite;
    for (const double t : {0.0, 0.999}) {
      const double s = Table::root_at(high) + t * (Table::root_at(high + 1) - Table::root_at(high));
      const double command_N = at(high, t, n) - axis_.axes.force_step_N;
      least = std::min(least, axis_.least_travel_m(s * s, command_N, n, asked * s * s) / (s * s));
      if (least < asked) return least;
    }
    return least;
  }

  // Whole swings as few as the force allows, or else, near the floor, what gets on best.
  std::optional<int> periods(std::uint32_t high) const {
    for (int n = swing_; n <= longest_pulse_periods; n += swing_)
      if (fits(high, n) && least_share(high, n, good_share) >= good_share) return n;
    std::optional<int> best;
    double most = enough_share;
    const auto consider = [&](int n) {
      if (!fits(high, n)) return;
      const double share = least_share(high, n, most);
      if (share > most) most = share, best = n;
    };
    const int stride = std::max(1, swing_ / 6);
    for (int n = std::min(swing_, longest_pulse_periods); n >= 1; n -= stride) consider(n);
    for (int n = 2 * swing_; n <= std::min(4 * swing_, longest_pulse_periods); n += swing_) consider(n);
    return best;
  }

  bool add(std::uint32_t high) {
    const std::optional<int> n = periods(high);
    if (!n) return false;
    const std::array<double, 4> f{at(high, 0, *n), at(high, 1.0 / 3, *n), at(high, 2.0 / 3, *n), at(high, 1, *n)};
    const double a0 = f[0], a1 = (-11 * f[0] + 18 * f[1] - 9 * f[2] + 2 * f[3]) / 2,
                 a2 = (18 * f[0] - 45 * f[1] + 36 * f[2] - 9 * f[3]) / 2,
                 a3 = (-9 * f[0] + 27 * f[1] - 27 * f[2] + 9 * f[3]) / 2;
    double over = 0;
    for (int j = 0; j <= samples; ++j) {
      const double t = static_cast<double>(j) / samples;
      over = std::max(over, a0 + t * (a1 + t * (a2 + t * a3)) - at(high, t, *n));
    }
    const double lowered = 1.05 * over + 1e-6 * f[3];
    table_.entries[table_.count] = {static_cast<Real>(a0 - lowered), static_cast<Real>(a1), static_cast<Real>(a2),
                                    static_cast<Real>(a3)};
    table_.periods[table_.count] = static_cast<std::uint8_t>(*n);
    ++table_.count;
    return true;
  }

  const Jointed& axis_;
  int swing_;
  Table table_{};
};

struct Asked {
  BrakedClass axes;
  double max_approach_speed_m_s;

  friend bool operator==(const Asked&, const Asked&) = default;
};

template <class Real>
WorkDesign<Real> work_made(const Asked& asked) {
  const BrakedClass& axes = asked.axes;
  const Jointed axis{axes};
  WorkDesign<Real> d;
  const int swing = WorkTable<Real>::swing_periods(axis);
  d.resonance_Hz = axis.load.resonance_Hz();
  d.unseen_m = axis.load.unseen_m(axes.load_N) + axis.G / 2;
  d.rest_s = axis.rest_s();
  d.holds = axis.A1 > 0;
  d.swing_is_counted = d.resonance_Hz * axes.period_s * least_swing_periods <= 1 && swing <= longest_pulse_periods;
  if (!d.holds || !d.swing_is_counted) return d;
  d.spring_m = axis.spring_m();
  d.pulse_needed_N = axis.least_N(swing);
  d.moves_load = d.pulse_needed_N <= axes.max_force_N;
  if (!d.moves_load) return d;

  law::WorkKicks<Real>& k = d.kicks;
  k.force_step_N = static_cast<Real>(axes.force_step_N);
  k.slow_lag = static_cast<Real>(axes.lag_s.most > 0 ? std::exp(-axes.period_s / axes.lag_s.most) : 0);
  k.breakaway_N = static_cast<Real>((axis.B1 + axis.B2) / axes.force_gain.least);
  k.lost_motion_m = static_cast<Real>(lost_motion_m(axes));
  k.spring_m = static_cast<Real>(d.spring_m);
  d.creep_m = axis.creep_m();
  k.creep_m = static_cast<Real>(d.creep_m);
  k.friction_per_gain_N = static_cast<Real>(axis.g / axes.force_gain.most);
  k.speeding_s_per_kg = static_cast<Real>(axes.force_gain.most * axes.period_s / (axis.lighter * axis.load.motor_kg));
  k.held_back_N = static_cast<Real>(axis.held_back_N() / axes.force_gain.most);
  k.late_periods = static_cast<Real>(axis.late_periods());
  k.still_periods = static_cast<std::uint16_t>(std::min(std::ceil(d.rest_s / axes.period_s), 65535.0));
  k.metered = !axis.load.encoder_on_load;
  k.approach = detail::work_approach<Real>(axis, swing);
  d.swing_growth = detail::worst_growth_of_swing(axis, k.approach);
  d.gap_swing = detail::gap_swing(axis, k.approach);
  k.table = WorkTable<Real>{axis, static_cast<double>(k.begin_m())}.table();
  if (k.table.count == 0) return d;
  d.floor_m = static_cast<double>(k.table.least_m());
  d.reach_m = static_cast<double>(k.table.reach_m());
  d.least_tolerance_m =
      std::max(d.floor_m + axes.reading_error_m(), least_counts * axes.encoder_resolution_m) + d.creep_m;
  double most_Ns = 0;
  for (std::size_t i = 0; i < k.table.count; ++i) {
    const auto& e = k.table.entries[i];
    const double force_N = std::max(double{e.a0}, double{e.a0} + e.a1 + e.a2 + e.a3);
    most_Ns = std::max(most_Ns, force_N * k.table.periods[i] * axes.period_s * axes.force_gain.most);
  }
  d.peak_speed_m_s =
      std::sqrt((2 * axis.g * d.reach_m + axis.Bs * axis.Bs / axis.K) / (axis.lighter * axis.load.motor_kg));
  k.longest_coast_periods =
      static_cast<std::uint16_t>(std::min(most_Ns / axis.g / axes.period_s + k.still_periods, 15000.0));
  d.longest_stop_s = detail::longest_stop_s(axis, k.approach, asked.max_approach_speed_m_s);
  k.patient_periods = static_cast<std::uint16_t>(
      std::min(k.still_periods + 4.0 * swing + 50 + std::ceil(d.longest_stop_s / axes.period_s), 65535.0));
  d.table_bytes = k.table.count * (sizeof k.table.entries[0] + 2);
  return d;
}

}  // namespace

template <class Real>
WorkDesign<Real> design_work_kicks(const BrakedClass& axes, double max_approach_speed_m_s) {
  static detail::Memo<Asked, WorkDesign<Real>> memo;
  return memo.of({axes, max_approach_speed_m_s}, work_made<Real>);
}

template <class Real>
double without_progress_s(const BrakedClass& axes, const WorkDesign<Real>& design) {
  const Jointed axis{axes};
  const auto& table = design.kicks.table;
  const auto first = table.periods.begin();
  const int pulse = table.count > 0 ? *std::max_element(first, first + table.count) : 0;
  const double begin_m = static_cast<double>(design.kicks.begin_m());
  const double kick_s = pulse * axes.period_s + std::sqrt(2 * axis.heavier * axis.M * begin_m / axis.g) + design.rest_s;
  return law::WorkAim<Real>::most_kicks * kick_s + kick_s + design.longest_stop_s;
}

template double without_progress_s(const BrakedClass&, const WorkDesign<float>&);
template double without_progress_s(const BrakedClass&, const WorkDesign<double>&);
template WorkDesign<float> design_work_kicks(const BrakedClass&, double);
template WorkDesign<double> design_work_kicks(const BrakedClass&, double);

}  // namespace breakaway::design
