#include "breakaway/design/braked_kicks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "braked_approach.hpp"
#include "breakaway/design/spring_load.hpp"
#include "kick_class.hpp"
#include "kick_table_builder.hpp"
#include "memo.hpp"
#include "planned_force.hpp"

namespace breakaway::design {
namespace {

using detail::KickClass;
using detail::PlannedForce;
using detail::unseen_m;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double longest_count = 30000;  // of periods

std::uint16_t counted(double periods) {
  return static_cast<std::uint16_t>(std::clamp(std::ceil(periods), 1.0, longest_count));
}

// Without a count of motion for so many periods an axis that loses speed under this net force is at rest. The readings
// may lie nearer together by the jitter, and the first may show the axis as long before the force came down.
double still_periods(const BrakedClass& axes, double net_force_N) {
  if (!(net_force_N > 0)) return infinity;
  // The reading of one that may ring may change by a count either way.
  const double way_m = unseen_m(axes) * (axes.presliding_stiffness_N_per_m > 0 ? 2.5 : 1);
  const double needed_s = std::sqrt(2 * way_m * axes.mass_kg.most / net_force_N);
  return (needed_s + 2 * axes.jitter_s) / axes.period_s;
}

// The least reading that an axis may be kicked from. Without noise what is read is the same at the same place, and one
// count is the least that is not zero. With noise an axis that a kick took beyond its target must not be kicked back.
double least_seen_m(const BrakedClass& axes) {
  return axes.encoder_noise_m > 0 ? 2.001 * axes.reading_error_m() : 0.51 * axes.encoder_resolution_m;
}

// e^(-T/tau), rounded to the side asked for.
template <class Real>
Real share_left(double period_s, double lag_s, Real towards) {
  if (lag_s == 0) return 0;
  const auto nearest = static_cast<Real>(std::exp(-period_s / lag_s));
  return nearest > 0 ? std::nextafter(nearest, towards) : Real{0};
}

}  // namespace

double most_travel_m(const BrakedClass& axes, double force_N, int periods, int cut_periods) {
  return KickClass{axes}.most_travel_m(force_N, periods, cut_periods);
}
double least_travel_m(const BrakedClass& axes, double force_N, int periods, int cut_periods) {
  return KickClass{axes}.least_travel_m(force_N, periods, cut_periods);
}

namespace {

// The distance that the least sure pulse goes at most, and the force of the least sure one.
struct LeastPulse {
  double distance_m = infinity;
  double force_N = infinity;
};

LeastPulse least_pulse(const KickClass& kicks) {
  LeastPulse least;
  for (int n = 1; n <= longest_pulse_periods; ++n) {
    const double needed_N = kicks.needed_N(n);
    least.force_N = std::min(least.force_N, needed_N);
    if (needed_N <= kicks.limit_N() * (1 + 1e-9))
      least.distance_m = std::min(least.distance_m, kicks.most_travel_m(needed_N, n, kicks.cut_periods(needed_N, n)));
  }
  return least;
}

// Until bristles no longer ring by half a count. Dahl's friction takes so much from each period of the ringing that its
// amplitude a obeys 1/a' = 1/a + 4 s0/(3 f). Stiffer ones, which fewer readings a ring may hide, do sooner.
double ringing_periods(const BrakedClass& axes, const KickClass& kicks) {
  const double s0 = axes.presliding_stiffness_N_per_m;
  const double rings = 1.5 * kicks.most_friction_N() / (s0 * axes.encoder_resolution_m);
  return rings * 2 * std::numbers::pi * std::sqrt(axes.mass_kg.most / s0) / axes.period_s;
}

// Friction as a spring, on which the mass rings with the frequency omega, or faster.
template <class Real>
law::FrictionSpring<Real> spring(const BrakedClass& axes, const KickClass& kicks) {
  const double s0 = axes.presliding_stiffness_N_per_m, q = axes.encoder_resolution_m, T = axes.period_s;
  if (!(s0 > 0)) return {};
  const double omega = std::sqrt(s0 / axes.mass_kg.most);
  // A force that follows the axis late pumps its ringing. One that follows the mean over some ringing does not, where a
  // few readings show that; else it must be slow, because friction that has bent by three quarters is four times as
  // soft.
  const double late = omega * T > 4 ? 0.02 : 0.15;
  const double delay_s = T * std::max(axes.latency_periods, 1) + axes.lag_s.most;
  const double gain = std::min(0.03 * omega, late / delay_s) * s0 * T;
  // From one limit to the other, while the axis reads half a count beside the target.
  const double crossing = 2 * kicks.spring_N() / (gain * q / 2);
  const double ringing = ringing_periods(axes, kicks);
  return {.reach_m = static_cast<Real>(2.5 * kicks.least_friction_N() / s0 + q),
          .step_m = static_cast<Real>(axes.force_gain.most * axes.force_step_N / s0),
          .most_N = static_cast<Real>(kicks.spring_N()),
          .gain_N_per_m = static_cast<Real>(gain),
          .share = static_cast<Real>(std::min(omega * T / 5, 1.0)),
          .longest_periods = counted(2 * crossing + ringing + 100),
          .ringing_periods = counted(2 * ringing)};
}

// In periods.
struct Waits {
  double still, either_way, settling;
};

// theta_N: the force under which a reading that stays proves rest after a kick; holding_N: either way.
Waits waits(const BrakedClass& axes, const KickClass& kicks, double theta_N, double holding_N) {
  const double gain = theta_N > 0 ? axes.force_gain.most : axes.force_gain.least, A = kicks.least_friction_N();
  // Half a period of the bristles' ringing shows it by a count.
  const double s0 = axes.presliding_stiffness_N_per_m;
  const double ringing = s0 > 0 ? std::numbers::pi * std::sqrt(axes.mass_kg.most / s0) / axes.period_s : 0;
  const double out_of_sight = sprung_rest_s(axes, kicks.brake_N()) / axes.period_s;
  return {std::max(still_periods(axes, A - gain * theta_N), ringing) + out_of_sight,
          std::max(still_periods(axes, A - axes.force_gain.most * holding_N), ringing) + out_of_sight,
          std::ceil(4 * axes.lag_s.most / axes.period_s)};
}

// All but the table.
template <class Real>
law::BrakedKicks<Real> numbers(const BrakedClass& axes, const KickClass& kicks, bool& rest_is_seen) {
  const double b = kicks.brake_N(), gains = axes.force_gain.most / axes.mass_kg.least * axes.mass_kg.most;
  const double theta_N = axes.lag_s.most > 0 ? 0.1 * kicks.held_N() : -b, holding_N = (b + kicks.held_N()) / 2;
  const auto [still, either_way, settling] = waits(axes, kicks, theta_N, holding_N);
  rest_is_seen = std::max(still, either_way) + settling < longest_count / 2;
  // The very number that the controller commands, which compares its force with it: whole steps, rounded once.
  const auto step_N = static_cast<Real>(axes.force_step_N);
  const Real brake_N = static_cast<Real>(std::round(b / axes.force_step_N)) * step_N;
  const auto exact = [&](double force_N) { return force_N == -b ? -brake_N : static_cast<Real>(force_N); };
  return {.brake_N = brake_N,
          .force_step_N = step_N,
          .preload_N = exact(kicks.preload_N()),
          .resting_force_N = exact(theta_N),
          .holding_force_N = static_cast<Real>(holding_N),
          .fast_lag = share_left<Real>(kicks.longest_period_s(), axes.lag_s.least, Real{0}),
          .slow_lag = share_left<Real>(kicks.shortest_period_s(), axes.lag_s.most, Real{1}),
          .short_lag = share_left<Real>(kicks.shortest_period_s(), axes.lag_s.least, Real{0}),
          .coast_per_N = static_cast<Real>((1 + axes.jitter_s / axes.period_s) * gains /
                                           (kicks.least_friction_N() + axes.force_gain.least * b)),
          .breakaway_N = static_cast<Real>(kicks.most_friction_N() / axes.force_gain.least),
          .lost_motion_m = static_cast<Real>(lost_motion_m(axes)),
          .least_seen_N = {},
          .most_seen_N = {},
          .still_periods = counted(still),
          .either_way_periods = counted(either_way),
          .patient_periods = {},
          .settling_periods = counted(settling),
          .fine_floor_m = {},
          .sure = {},
          .spring = spring<Real>(axes, kicks),
          .approach = detail::braked_approach<Real>(axes, kicks),
          .table = {}};
}

// The net force on the heaviest axis that rests as far away as kicks begin, or further, under the slowest plan; less
// than none where it may stay there.
template <class Real>
double least_surplus_N(const BrakedClass& axes, const KickClass& kicks, const law::BrakedKicks<Real>& k) {
  const PlannedForce force{axes, kicks};
  const double response_s = static_cast<double>(k.approach.response_s);
  const double gentle = static_cast<double>(std::min(k.approach.gentle_m_s2, k.approach.hard_m_s2));
  const double step = gentle * response_s;
  const double distance_m = static_cast<double>(k.begin_m() - k.approach.short_of_target_m);
  const double onto_curve = (std::sqrt(step * step + 8 * gentle * distance_m) - step) / (2 * response_s);
  const double planned = std::min(onto_curve, static_cast<double>(k.approach.switch_speed_m_s) / response_s);
  const double command_N = std::min(force.told_kg * planned + force.least_N - force.rounding_N, kicks.limit_N());
  const double whole_N = std::ceil(command_N / axes.force_step_N * (1 - 1e-9)) * axes.force_step_N;
  return force.gain_least * std::min(whole_N, kicks.limit_N()) - force.most_N;
}

// An axis that moves shows it within so many periods: one that comes to rest, and one that an approach sets moving.
template <class Real>
std::uint16_t patient_periods(const BrakedClass& axes, const KickClass& kicks, const law::BrakedKicks<Real>& k) {
  const double moving = still_periods(axes, least_surplus_N(axes, kicks, k));
  const double shown = std::max<double>(k.still_periods, k.either_way_periods);
  const int settling = axes.lag_s.most > 0 ? k.settling_periods : 0;
  return counted((std::isfinite(moving) ? std::max(shown, moving) : shown) + 30 + axes.latency_periods + settling);
}

// A position error is rounded to the digits that a Real has, the more the further away, and what it changes by in a
// period is off by as much. The slowest axis that sets off must show more than that before it counts as stuck.
template <class Real>
double farthest_m(const BrakedClass& axes, const KickClass& kicks, const law::BrakedKicks<Real>& k) {
  const double surplus_N = least_surplus_N(axes, kicks, k);
  if (!(surplus_N > 0)) return infinity;
  const double blind = axes.latency_periods + (axes.lag_s.most > 0 ? k.settling_periods : 0);
  const double seen_s = (k.patient_periods - blind) * axes.period_s - 2 * axes.jitter_s;
  const double way_m = surplus_N / axes.mass_kg.most * seen_s * seen_s / 2 - unseen_m(axes);
  return std::max(way_m, 0.0) / (2 * static_cast<double>(std::numeric_limits<Real>::epsilon()));
}

// Of a list each pulse is known with its very cut, so that a weaker one may go further than the list says.
template <class Real>
bool is_fine(double tolerance_m, const BrakedDesign<Real>& design) {
  const bool read = tolerance_m >= design.least_reading_m * (1 - 1e-9);
  const bool below = tolerance_m < design.least_tolerance_m * (1 - 1e-9);
  return read && below && design.possible() && !design.kicks.table.list;
}

template <class Real>
BrakedDesign<Real> braked_made(const BrakedClass& axes) {
  const KickClass kicks{axes};
  BrakedDesign<Real> design;
  const double A = kicks.least_friction_N();
  design.floor_m = design.pulse_needed_N = infinity;
  design.brake_holds = A > 0;  // the brake is nine tenths of it at most, with the largest gain
  if (!design.brake_holds) return design;
  const LeastPulse least = least_pulse(kicks);
  design.pulse_needed_N = least.force_N;
  design.breaks_away = std::isfinite(least.distance_m);
  if (!design.breaks_away) return design;

  detail::KickTableBuilder<Real> builder{axes, kicks};
  builder.build(std::max(least.distance_m, axes.reading_error_m()));
  if (!builder.cuts_are_given()) {
    design.pulse_needed_N = infinity;
    design.breaks_away = false;
    return design;
  }
  design.kicks = numbers<Real>(axes, kicks, design.rest_is_seen);
  design.kicks.table = builder.table();
  design.kicks.patient_periods = patient_periods(axes, kicks, design.kicks);
  design.farthest_m = farthest_m(axes, kicks, design.kicks);
  design.kicks.least_seen_N = static_cast<Real>(builder.seen_N().least);
  design.kicks.most_seen_N = static_cast<Real>(builder.seen_N().most);
  const Interval range = builder.range_m();
  design.kicks.sure = builder.sure_travel(range);
  design.floor_m = range.least;
  design.reach_m = range.most;
  design.aim_lost = builder.aim_lost();
  design.peak_speed_m_s = builder.peak_speed_m_s();
  design.table_bytes = sizeof(design.kicks.table);
  design.least_reading_m = least_seen_m(axes);
  // Nor where friction bends, on which a kick from the first count goes further than that.
  const double count_m = axes.presliding_stiffness_N_per_m > 0 ? 1.01 * axes.encoder_resolution_m : 0;
  design.least_tolerance_m = std::max({design.floor_m, design.least_reading_m, count_m});
  if (is_fine(axes.fine_tolerance_m, design)) design.kicks.fine_floor_m = static_cast<Real>(design.least_tolerance_m);
  return design;
}

}  // namespace

template <class Real>
BrakedDesign<Real> design_braked_kicks(const BrakedClass& axes) {
  static detail::Memo<BrakedClass, BrakedDesign<Real>> memo;
  return memo.of(axes, braked_made<Real>);
}

// Against friction A the axis would have lost A^2 / s0 more, and 1.75 times that where a force had bent friction the
// other way. With that as speed from the start it goes v0 t F / A and (1.75 A / s0) further.
template <class Real>
double bent_beyond_m(const BrakedClass& axes, const BrakedDesign<Real>& design) {
  if (!(axes.presliding_stiffness_N_per_m > 0)) return 0;
  const KickClass kicks{axes};
  const double A = kicks.least_friction_N(), bend_m = 1.75 * A / axes.presliding_stiffness_N_per_m;
  const double start_m_s = std::sqrt(2 * A * bend_m / axes.mass_kg.least);
  double impulse_Ns = 0;
  const law::KickTable<Real>& table = design.kicks.table;
  for (std::size_t i = 0; i < table.count; ++i) {
    const double force_N = std::min(detail::greatest_force_N(table, i), kicks.limit_N());
    impulse_Ns = std::max(impulse_Ns, force_N * table.periods[i] * axes.period_s);
  }
  return start_m_s * axes.force_gain.most * impulse_Ns / A + bend_m;
}

template <class Real>
double kicks_begin_m(const BrakedDesign<Real>& design) {
  return std::max(design.reach_m, law::left_beyond * hand_over_m(design));
}

template struct BrakedDesign<float>;
template struct BrakedDesign<double>;
template BrakedDesign<float> design_braked_kicks(const BrakedClass&);
template BrakedDesign<double> design_braked_kicks(const BrakedClass&);
template double bent_beyond_m(const BrakedClass&, const BrakedDesign<float>&);
template double bent_beyond_m(const BrakedClass&, const BrakedDesign<double>&);
template double kicks_begin_m(const BrakedDesign<float>&);
template double kicks_begin_m(const BrakedDesign<double>&);

}  // namespace breakaway::design
