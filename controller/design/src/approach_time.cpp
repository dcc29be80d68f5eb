#include "breakaway/design/approach_time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/design/kick_promise.hpp"
#include "kick_time.hpp"
#include "planned_force.hpp"

namespace breakaway::design {
namespace {

using detail::KickClass;
using detail::PlannedForce;

constexpr double along_the_way = 1.03;  // of the time of the way, for forces in whole steps behind a lagging loop
constexpr double least_led = 0.2;       // of the speed that the plan leads to, which no axis falls short of
constexpr double braking = 3.25;        // of the speed at which the brake takes over, before it is taken off at last
constexpr double jerks = 3;             // changes of the acceleration, each from none to the most
constexpr int again = 3;                // approaches that may follow the first, on the way back or nearer

// The least speeds on the way of the slowest axis.
struct SlowestWay {
  double speeding_m_s2;  // from rest
  double cruising_m_s;
  double hard_m_s2, gentle_m_s2;  // of the curves down to the brake
  double switch_speed_m_s;
  double slower_m_s;
  double seems_faster;  // so many times, at most, to a plan under jitter in a pattern

  double from_rest_m_s(double gone_m) const { return std::sqrt(2 * speeding_m_s2 * gone_m); }
  double down_m_s(double left_m) const {
    return std::sqrt(switch_speed_m_s * switch_speed_m_s + 2 * hard_m_s2 * left_m);
  }
  double speed_m_s(double gone_m, double left_m) const {
    const double led_m_s = std::min(down_m_s(left_m), cruising_m_s) / seems_faster;
    return std::min(from_rest_m_s(gone_m), std::max(led_m_s - slower_m_s, least_led * led_m_s));
  }

  // A substitution that goes slowly at both ends takes the root there out of the integral.
  double time_s(double way_m) const {
    constexpr int steps = 512;
    if (!(way_m > 0)) return 0;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const double u = (i + 0.5) / steps, gone_m = way_m * u * u * (3 - 2 * u);
      sum += 6 * u * (1 - u) / speed_m_s(gone_m, way_m - gone_m);
    }
    return sum * way_m / steps;
  }
};

template <class Real>
double speeding_m_s2(const BrakedClass& axes, const law::BrakedApproach<Real>& plan) {
  const KickClass kicks{axes};
  const PlannedForce force{axes, kicks};
  const double given = (axes.force_gain.least * kicks.limit_N() - force.most_N) / force.heaviest_kg;
  if (!plan.move.are_asked_for()) return given;
  return std::min(given, force.sure_acceleration(static_cast<double>(plan.move.acceleration_m_s2)));
}

// Where every other period is late, a long one shows more of the way than was asked for, by the jitter's share j of a
// period, and of that the estimate takes its correction over; the force that answers falls into a long period again,
// and the plan counts with a whole one. Either makes the axis seem faster by the order of j^2: tested, not proved.
template <class Real>
double seems_faster(const BrakedClass& axes, const law::BrakedApproach<Real>& plan) {
  constexpr double more = 1.5;
  const double j = axes.jitter_s / axes.period_s, answered = axes.period_s / static_cast<double>(plan.response_s);
  return 1 + more * j * j * (static_cast<double>(plan.correction) + answered);
}

template <class Real>
SlowestWay slowest_way(const BrakedClass& axes, const law::BrakedApproach<Real>& plan, double speed_m_s,
                       double from_m = 0) {
  return {.speeding_m_s2 = speeding_m_s2(axes, plan),
          .cruising_m_s = speed_m_s,
          .hard_m_s2 = static_cast<double>(plan.hard_m_s2),
          .gentle_m_s2 = static_cast<double>(plan.gentle_m_s2),
          .switch_speed_m_s = static_cast<double>(plan.switch_speed_m_s),
          .slower_m_s = detail::slower_than_planned_m_s(axes, plan, from_m),
          .seems_faster = seems_faster(axes, plan)};
}

// To be led by the plan, and from where the brake takes over to the proof of rest.
template <class Real>
double ends_s(const BrakedClass& axes, const law::BrakedKicks<Real>& kicks, const SlowestWay& way) {
  const law::MoveLimits<Real>& move = kicks.approach.move;
  const double jerk_s = move.jerk_m_s3 > 0 ? static_cast<double>(move.acceleration_m_s2 / move.jerk_m_s3) : 0;
  const double led_s = 2 * way.slower_m_s / way.speeding_m_s2 + jerks * jerk_s;
  const double brake_s = braking * way.switch_speed_m_s / way.gentle_m_s2 + 4 * axes.lag_s.most;
  const int rest = detail::proofs_of_rest(axes) * (kicks.still_periods + kicks.either_way_periods);
  const double periods = rest + kicks.settling_periods + 2 * (axes.latency_periods + 2);
  return led_s + brake_s + periods * axes.period_s;
}

}  // namespace

template <class Real>
double approach_s(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s, double distance_m) {
  const law::BrakedKicks<Real>& kicks = design.kicks;
  const law::BrakedApproach<Real>& plan = kicks.approach;
  const double move_m_s =
      plan.move.are_asked_for() ? static_cast<double>(plan.move.speed_m_s) : std::numeric_limits<double>::infinity();
  const double allowed_m_s = std::min(max_speed_m_s, move_m_s), away_m = hand_over_m(design);
  const SlowestWay fast = slowest_way(axes, plan, allowed_m_s, distance_m);
  const SlowestWay slow = slowest_way(axes, plan, std::min(allowed_m_s, fast.switch_speed_m_s));
  const bool gets_on = least_approach_speed_m_s(axes, design) <= allowed_m_s && fast.speeding_m_s2 > 0;
  if (!gets_on) return std::numeric_limits<double>::infinity();
  const double end_s = ends_s(axes, kicks, fast);
  // A fast one may pass its target; slow ones end where kicks can mend what they leave.
  const double left_m = detail::hand_overs_beyond * away_m;
  const double passed_m = std::max(left_m, approach_beyond_m(axes, design, max_speed_m_s));
  const double ways_s = slow.time_s(passed_m) + (again - 1) * slow.time_s(left_m);
  return along_the_way * fast.time_s(distance_m - away_m) + end_s + ways_s +
         again * (end_s + kicks.patient_periods * axes.period_s);
}

template <class Real>
double without_progress_s(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s,
                          double tolerance_m) {
  return approach_s(axes, design, max_speed_m_s, hand_over_m(design)) +
         KickPromise{axes, design, tolerance_m}.most_s(kicks_begin_m(design));
}

template double without_progress_s(const BrakedClass&, const BrakedDesign<float>&, double, double);
template double without_progress_s(const BrakedClass&, const BrakedDesign<double>&, double, double);
template double approach_s(const BrakedClass&, const BrakedDesign<float>&, double, double);
template double approach_s(const BrakedClass&, const BrakedDesign<double>&, double, double);

}  // namespace breakaway::design
