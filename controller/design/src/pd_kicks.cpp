#include "breakaway/design/pd_kicks.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/design/k3.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/law/velocity_estimator.hpp"
#include "kick_curve.hpp"
#include "rubbed_mass.hpp"

namespace breakaway::design {
namespace {

law::AxisParameters<double> in_double(const law::AxisParameters<float>& p) {
  law::AxisParameters<double> d;
  d.mass_kg = p.mass_kg;
  d.stiffness_N_per_m = p.stiffness_N_per_m;
  d.approach_damping_Ns_per_m = p.approach_damping_Ns_per_m;
  d.kick_damping_Ns_per_m = p.kick_damping_Ns_per_m;
  d.friction = {p.friction.lower_N, p.friction.upper_N};
  d.max_force_N = p.max_force_N;
  d.position_tolerance_m = p.position_tolerance_m;
  d.encoder_resolution_m = p.encoder_resolution_m;
  d.period_s = p.period_s;
  d.latency_periods = p.latency_periods;
  return d;
}
const law::AxisParameters<double>& in_double(const law::AxisParameters<double>& p) { return p; }

// The feedback of the coast, whose samples are those of an axis that has rested.
class Feedback {
 public:
  Feedback(const law::AxisParameters<double>& p, double distance_m)
      : p_{p},
        before_m_{-distance_m},
        weight_{law::VelocityEstimator<double>{p.period_s, p.encoder_resolution_m, p.kick_damping_Ns_per_m,
                                               p.friction.lower_N}
                    .weight()} {
    late_N_.fill(p.stiffness_N_per_m * distance_m);
  }

  // Once a period: takes what is read now, and returns the force that acts now.
  double next_N(double position_m, double velocity_m_s) {
    velocity_ += p_.exact() ? velocity_m_s - velocity_ : weight_ * ((position_m - before_m_) / p_.period_s - velocity_);
    before_m_ = position_m;
    late_N_[newest_] = -p_.stiffness_N_per_m * position_m - p_.kick_damping_Ns_per_m * velocity_;
    const double acts_N = late_N_[(newest_ + size - p_.latency_periods) % size];
    newest_ = (newest_ + 1) % size;
    return acts_N;
  }
  // Until it shows what the axis does.
  double late_s() const { return (p_.latency_periods + 1 / weight_) * p_.period_s; }
  // None that is on its way moves an axis that rests; the velocity that is still believed only fades.
  bool holds() const {
    return std::ranges::all_of(late_N_, [&](double force_N) { return std::abs(force_N) <= p_.friction.lower_N; });
  }

 private:
  static constexpr std::size_t size = 256;  // more than any latency
  const law::AxisParameters<double>& p_;
  double before_m_, velocity_ = 0, weight_;
  std::array<double, size> late_N_{};
  std::size_t newest_ = 0;
};

template <class Real>
class PdTableBuilder {
 public:
  PdTableBuilder(const law::AxisParameters<double>& p, double lag_s, PulseAim aim) : p_{p}, lag_s_{lag_s}, aim_{aim} {
    // Without a limit of force no kick takes more than this in one period.
    const double farthest_m = p.stick_radius_upper_m();
    const double enough_N = 8 * (k3_Ns(farthest_m) / p.period_s + p.stiffness_N_per_m * farthest_m);
    if (!std::isfinite(p_.max_force_N)) p_.max_force_N = enough_N;
    under_most_ = p_;
    under_most_.friction.lower_N = p_.friction.upper_N;
  }

  PdKicks<Real> build() {
    const std::uint32_t first = high_of(least_m());
    made_.table.first = static_cast<std::uint16_t>(first);
    for (std::size_t i = 0; i < Table::most_entries; ++i) {
      const double left = Table::root_at(first + static_cast<std::uint32_t>(i));
      const double right = Table::root_at(first + static_cast<std::uint32_t>(i) + 1);
      if (i > 0 && distance_m(left) > p_.stick_radius_upper_m()) break;
      fit(i, left, right);
    }
    return made_;
  }

 private:
  using Table = law::KickTable<Real>;
  static constexpr int samples = 16;  // of an interval

  // The table's root is that of the root of the distance.
  static double distance_m(double root) { return root * root * root * root; }
  static std::uint32_t high_of(double distance_m) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(std::sqrt(std::sqrt(distance_m)))) >> Table::shift;
  }

  // Of the distances that kicks are for: a creeping axis is kicked as from less than a wide tolerance.
  double least_m() const {
    const double creeping_m = 8 * p_.accuracy_floor_m() + p_.encoder_resolution_m;
    return std::max({std::min(p_.position_tolerance_m, creeping_m), p_.encoder_resolution_m / 2,
                     p_.accuracy_floor_m() / 64, p_.stick_radius_upper_m() * std::ldexp(1, -28)});
  }

  void fit(std::size_t i, double left, double right) {
    choose_periods(distance_m(left), distance_m(right));
    Table& table = made_.table;
    table.periods[i] = static_cast<std::uint8_t>(periods_);
    table.entries[i] =
        detail::cubic_through<Real>(left, right, [&](double root) { return force_N(distance_m(root), periods_); });
    table.count = static_cast<std::uint8_t>(i + 1);
    if (aim_ == PulseAim::target) lower(i, left, right);
  }

  // Takes off what the cubic, as the controller reads it, lies above the curve, until no pulse leads beyond the target.
  void lower(std::size_t i, double left, double right) {
    constexpr int most_rounds = 8;
    constexpr double unseen = 1e-6;  // of the way: what the curve does between the places that are looked at
    typename Table::Entry& e = made_.table.entries[i];
    const double slope_N_per_m = (double{e.a1} + double{e.a2} + double{e.a3}) / (distance_m(right) - distance_m(left));
    // Roundings of what is read, and of the law's own sum.
    e.a0 -= static_cast<Real>(4e-7 * (std::abs(e.a0) + std::abs(e.a1)));
    for (int round = 0; round < most_rounds; ++round) {
      double beyond_m = -HUGE_VAL, short_share = 0;
      for (int j = 0; j <= samples; ++j) {
        const auto y = static_cast<Real>(distance_m(left + (right - left) * (j + 1e-3) / (samples + 2e-3)));
        const double off_m = pd_travel_m(p_, lag_s_, y, read(y), periods_) - static_cast<double>(y);
        beyond_m = std::max(beyond_m, off_m + unseen * static_cast<double>(y));
        short_share = std::max(short_share, -off_m / static_cast<double>(y));
      }
      if (beyond_m <= 0) {
        made_.aim_lost = std::max(made_.aim_lost, short_share);
        return;
      }
      e.a0 -= static_cast<Real>(1.05 * beyond_m * slope_N_per_m + 1e-7 * std::abs(e.a0));
      if (round + 1 == most_rounds) made_.beyond = std::max(made_.beyond, beyond_m / distance_m(left));
    }
  }
  double read(Real distance_m) const { return static_cast<double>(made_.table.pulse(std::sqrt(distance_m)).force_N); }

  // The least number with which a force within the limit reaches the target from all over the interval, or one less,
  // whose force falls short at the limit: whichever is sure to take more of the distance away.
  void choose_periods(double left_m, double right_m) {
    if (aim_ == PulseAim::k3) {
      const double exact = k3_Ns(right_m) / ((p_.max_force_N - p_.friction.lower_N) * p_.period_s);
      periods_ = static_cast<int>(std::clamp(std::ceil(exact), 1.0, double{longest_pulse_periods}));
      return;
    }
    double travel_m = pd_travel_m(p_, lag_s_, right_m, p_.max_force_N, reaching_);
    while (travel_m < right_m && reaching_ < longest_pulse_periods) {
      const double more_m = pd_travel_m(p_, lag_s_, right_m, p_.max_force_N, reaching_ + 1);
      if (!(more_m > travel_m * (1 + 1e-9))) break;
      travel_m = more_m;
      ++reaching_;
    }
    periods_ = reaching_;
    if (reaching_ > 1 && share_sure(reaching_ - 1, left_m, right_m) > share_sure(reaching_, left_m, right_m))
      --periods_;
  }
  // Of the distance, which a kick takes away under any friction.
  double share_sure(int periods, double left_m, double right_m) const {
    const auto share = [&](double distance_m) {
      const double force = std::min(force_N(distance_m, periods), p_.max_force_N);
      return pd_travel_m(under_most_, lag_s_, distance_m, force, periods) / distance_m;
    };
    return std::min(share(left_m), share(right_m));
  }

  // Of a pulse of that many periods; it may be more than the limit.
  double force_N(double distance_m, int periods) const {
    if (aim_ == PulseAim::k3) return k3_Ns(distance_m) / (periods * p_.period_s) + p_.stiffness_N_per_m * distance_m;
    // Regula falsi over the root of the way, which grows about as the force does; an end that stays counts half.
    const double wanted = std::sqrt(distance_m);
    const auto off = [&](double force_N) {
      return std::sqrt(pd_travel_m(p_, lag_s_, distance_m, force_N, periods)) - wanted;
    };
    double low = p_.friction.lower_N, high = p_.max_force_N, under = -wanted, over = off(high);
    for (int step = 0; step < 40 && over < 0; ++step) {
      low = std::exchange(high, 2 * high);
      under = std::exchange(over, off(high));
    }
    int side = 0;
    for (int step = 0; step < 100 && high - low > 1e-10 * high; ++step) {
      const double middle = low + (high - low) * (-under / (over - under));
      const double here = off(middle);
      if (std::abs(here) <= 1e-11 * wanted) return middle;
      const bool above = here > 0;
      (above ? high : low) = middle;
      (above ? over : under) = here;
      if (side == (above ? 1 : -1)) (above ? under : over) /= 2;
      side = above ? 1 : -1;
    }
    return low;
  }
  double k3_Ns(double distance_m) const {
    return K3<double>::make({p_.mass_kg, p_.stiffness_N_per_m, p_.kick_damping_Ns_per_m, p_.friction.lower_N})
        .impulse_Ns(-distance_m);
  }

  law::AxisParameters<double> p_, under_most_;
  double lag_s_;
  PulseAim aim_;
  int reaching_ = 1;  // periods of a pulse that reaches the target
  int periods_ = 1;   // of the interval
  PdKicks<Real> made_;
};

}  // namespace

double pd_travel_m(const law::AxisParameters<double>& p, double lag_s, double distance_m, double force_N, int periods) {
  constexpr long most_periods = 2'000'000;
  const double pulse_N = force_N - p.stiffness_N_per_m * distance_m;
  const double late_s = std::min(lag_s, p.period_s);
  double acting_N = p.stiffness_N_per_m * distance_m;
  const double limit_N = std::max(p.max_force_N, force_N);
  const double fades_to_m = -p.friction.lower_N / p.stiffness_N_per_m;
  const double fading_s = p.kick_damping_Ns_per_m / p.stiffness_N_per_m;
  detail::RubbedMass mass{p.mass_kg, p.friction.lower_N, -distance_m};
  Feedback feedback{p, distance_m};
  const bool damps_in_time = p.kick_damping_Ns_per_m * (late_s + feedback.late_s()) < p.mass_kg / 2;
  for (long k = 0; k < most_periods; ++k) {
    const double feedback_N = feedback.next_N(mass.position_m(), mass.velocity_m_s());
    const double wanted_N = feedback_N + (k < periods ? pulse_N : 0);
    mass.push(std::exchange(acting_N, std::clamp(wanted_N, -limit_N, limit_N)), late_s);
    mass.push(acting_N, p.period_s - late_s);
    if (k < periods + p.latency_periods) continue;
    // One that turned back does not come as far again. Beyond the least stick radius an axis fades into rest at its
    // end, for ever: overdamped, and damped in time, it does not pass that end where its speed is below that of the
    // fast mode.
    const double speed_m_s = mass.velocity_m_s(), short_m = fades_to_m - mass.position_m();
    if (damps_in_time && speed_m_s > 0 && speed_m_s * fading_s <= 2 * short_m) return distance_m + fades_to_m;
    if (speed_m_s == 0 ? feedback.holds() : speed_m_s * fading_s < 1e-10 * distance_m) break;
  }
  return mass.furthest_m() + distance_m;
}

template <class Real>
PdKicks<Real> design_pd_kicks(const law::AxisParameters<Real>& p, double lag_s, PulseAim aim) {
  if (const auto error = validate(p); error != law::ParameterError::none)
    throw InputError{std::string{to_string(error)}};
  if (!(p.period_s > 0)) throw InputError{"period_s", "is 0: pulses are for a loop with a period"};
  return PdTableBuilder<Real>{in_double(p), lag_s, aim}.build();
}

template PdKicks<float> design_pd_kicks(const law::AxisParameters<float>&, double, PulseAim);
template PdKicks<double> design_pd_kicks(const law::AxisParameters<double>&, double, PulseAim);

}  // namespace breakaway::design
