#include "braked_approach.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planned_force.hpp"

namespace breakaway::design {
namespace {

using detail::KickClass;
using detail::PlannedForce;
using detail::spread;
using detail::unseen_m;
constexpr double unlimited = std::numeric_limits<double>::infinity();

constexpr double followed = 0.95;  // of the deceleration that is sure: the rest is for coming back onto the curve
constexpr Interval steps_of_jerk{4, 64};  // that lead to the full deceleration
constexpr double soon_moving = 15;        // periods until an axis moves, well before it would count as stuck
constexpr double unseen_speed = 0.5;      // of the speed at which the brake takes over: so far may the estimate be off
constexpr double unseen_gain = 4;         // times what an unknown mass and force gain add to it while it is not seen
constexpr double passed_by_jerk = 0.5;    // of what the jerk adds to it in a period: by so much a plan passes its limit
constexpr double least_planned = 0.75;    // of a move's speed: so much of it is planned at least
constexpr double misread_in_a_row = 2;    // periods with the wrong force, as an axis is to begin to brake
constexpr double least_speed = 8;         // of the same, that a move may have as its limit
constexpr double moving = 1.25;           // times what an axis may go slower than its plan, so that it does not stand

// Of its speed an axis is read off by so much under jitter.
template <class Real>
double misread_share(const BrakedClass& axes, const law::BrakedApproach<Real>& plan) {
  return static_cast<double>(plan.correction) * axes.jitter_s / axes.period_s;
}

// Of a class with limits of a move; what the drive cannot give is not planned.
double planned_deceleration_m_s2(const BrakedClass& axes, const KickClass& kicks) {
  const PlannedForce force{axes, kicks};
  const double given = (kicks.limit_N() + force.least_N) / force.told_kg;
  return std::min(force.deceleration(axes.move->acceleration_m_s2), given);
}

template <class Real>
void limit(law::BrakedApproach<Real>& approach, const BrakedClass& axes, const KickClass& kicks) {
  if (!axes.move || axes.move->acceleration_m_s2 < least_acceleration_m_s2(axes)) return;
  const PlannedForce force{axes, kicks};
  const double braking = planned_deceleration_m_s2(axes, kicks);
  const double given = (kicks.limit_N() - force.least_N) / force.told_kg;
  const double speeding = std::min(force.acceleration(axes.move->acceleration_m_s2), given);
  // The speed may be off as far as it is not seen, and as what is not known of the acceleration adds until it is.
  const double blind_s = static_cast<double>(approach.response_s) + axes.latency_periods * axes.period_s;
  const double jerk = axes.move->jerk_m_s3.value_or(0);
  const double unseen_m_s = unseen_speed * static_cast<double>(approach.switch_speed_m_s) +
                            unseen_gain * (spread(axes.mass_kg) + spread(axes.force_gain)) * speeding * blind_s +
                            passed_by_jerk * jerk * axes.period_s * axes.period_s;
  approach.move = {
      .speed_m_s = static_cast<Real>(std::max(axes.move->speed_m_s - unseen_m_s, least_planned * axes.move->speed_m_s)),
      .acceleration_m_s2 = static_cast<Real>(speeding),
      .deceleration_m_s2 = static_cast<Real>(braking),
      .jerk_m_s3 = static_cast<Real>(jerk)};
  approach.hard_m_s2 = std::min(approach.hard_m_s2, static_cast<Real>(followed * force.sure_deceleration(braking)));
  // It answers a friction above the least so late that it ends short enough.
  if (jerk > 0) approach.short_of_target_m = 0;
}

// Below this speed a friction that rises from its least to its greatest stops the axis before the plan can answer.
double least_steady_speed_m_s(const BrakedClass& axes, const KickClass& kicks, double response_s) {
  const double gap_N = kicks.most_friction_N() - kicks.least_friction_N();
  return 2 * gap_N * (response_s + axes.latency_periods * axes.period_s) / axes.mass_kg.most;
}

}  // namespace

template <class Real>
law::BrakedApproach<Real> detail::braked_approach(const BrakedClass& axes, const KickClass& kicks) {
  const double T = axes.period_s, q = unseen_m(axes), m = axes.mass_kg.most;
  const double stop_N = kicks.least_friction_N() + axes.force_gain.least * kicks.brake_N();
  const double gap_N = kicks.most_friction_N() - kicks.least_friction_N();
  const double gentle = stop_N / m, lag_s = (axes.lag_s.least + axes.lag_s.most) / 2;
  const double response_s = T + 2 * lag_s;
  // A share g of a reading's surprise lets the estimated speed err by g q / T for the count and by doubt T / (m g) for
  // what is not known of the force: the sum is least at the g below. More of it than force for it would be no use.
  // What is off while the drive brakes hard is still in the estimate when the brake takes over. Jitter makes a speed be
  // read off by its share of the period.
  const double hard = 0.8 * (axes.force_gain.least * kicks.limit_N() + kicks.least_friction_N()) / m;
  const double unknown_share = spread(axes.mass_kg) + spread(axes.force_gain);
  const double hard_N = m * hard - kicks.least_friction_N();
  const double doubt_N = gap_N + std::max((0.02 + unknown_share) * stop_N, unknown_share * hard_N);
  const double most_correction = 0.5 * (kicks.limit_N() - kicks.most_friction_N()) * T * response_s / (m * q);
  const double jitter = axes.jitter_s / T, unshaken = jitter > 0 ? 0.1 / jitter : unlimited;
  const double correction =
      std::clamp(std::min({T * std::sqrt(doubt_N / (m * q)), most_correction, unshaken}), 1e-3, 1.0);
  const double speed_error = correction * q / T + doubt_N * T / (m * correction);
  // Below the last of these speeds the axis might stick where the plan asks for no more force than friction takes.
  const double speed =
      std::max({5 * speed_error / (1 - 5 * correction * jitter), least_steady_speed_m_s(axes, kicks, response_s),
                gentle * (T * (1 + 0.4 * axes.latency_periods) + axes.lag_s.most)});
  law::BrakedApproach<Real> plan{
      .mass_kg = static_cast<Real>((axes.mass_kg.least + axes.mass_kg.most) / 2),
      .friction_N = static_cast<Real>(kicks.least_friction_N()),
      .hard_m_s2 = static_cast<Real>(hard),
      .gentle_m_s2 = static_cast<Real>(gentle),
      .switch_speed_m_s = static_cast<Real>(speed),
      .switch_distance_m = static_cast<Real>(speed * speed / (2 * gentle)),
      .short_of_target_m = static_cast<Real>(speed * gap_N * T / stop_N),
      .response_s = static_cast<Real>(response_s),
      .lag_s = static_cast<Real>(lag_s),
      .correction = static_cast<Real>(correction),
      .standing_m_s = static_cast<Real>(axes.encoder_noise_m > 0 ? 2 * correction * q / T : 0),
      .move = {}};
  limit(plan, axes, kicks);
  return plan;
}

// Friction and brake end a move, which is the one bound; the other is what breaks the axis away.
double least_acceleration_m_s2(const BrakedClass& axes) {
  const KickClass kicks{axes};
  const PlannedForce force{axes, kicks};
  const double braked = (force.most_N + force.gain_most * (kicks.brake_N() + force.rounding_N)) / force.lightest_kg;
  return std::max(braked, force.exceeded_by(force.needed_acceleration()));
}

Interval jerk_m_s3(const BrakedClass& axes) {
  const KickClass kicks{axes};
  const double braking = planned_deceleration_m_s2(axes, kicks);
  const double needed = PlannedForce{axes, kicks}.needed_acceleration();
  const double least_per_period = std::max(braking / steps_of_jerk.most, needed / soon_moving);
  return {least_per_period / axes.period_s, braking / (steps_of_jerk.least * axes.period_s)};
}

template <class Real>
bool keeps_speed(const BrakedClass& axes, const BrakedDesign<Real>& design) {
  return static_cast<double>(design.kicks.approach.move.speed_m_s) > (least_planned + 1e-6) * axes.move->speed_m_s;
}

template <class Real>
double least_move_speed_m_s(const BrakedDesign<Real>& design) {
  return least_speed * static_cast<double>(design.kicks.approach.switch_speed_m_s);
}

// The force is that which leads to the greatest speed V within response_s, from the speed that the plan takes an axis
// for whose friction is not the least: its readings say too much by what the force ought to have done in the time
// since. A reading that is off, by a count or by jitter, lets the plan take the axis for faster still. So the axis goes
// slower than V by what is computed here, and must not stand. Far below the speed at which the brake takes over
// friction stops the axis before a force that was planned too low comes back, and an axis that stands again and again
// looks like one that is driven to and fro. While samples are lost the axis is reckoned on under its least friction,
// with all that the last reading put into its speed; in a long approach now and then two are lost in a row.
template <class Real>
double least_approach_speed_m_s(const BrakedClass& axes, const BrakedDesign<Real>& design) {
  constexpr double of_switch_speed = 1.0 / 3;
  const law::BrakedApproach<Real>& plan = design.kicks.approach;
  const double slower_m_s = detail::slower_than_planned_m_s(axes, plan);
  return std::max({moving * slower_m_s / (1 - misread_share(axes, plan)),
                   least_steady_speed_m_s(axes, KickClass{axes}, static_cast<double>(plan.response_s)),
                   of_switch_speed * static_cast<double>(plan.switch_speed_m_s)});
}

// Further away what Real rounds away of a position error slows an axis down that is allowed this speed until it stands,
// by the same bound; or leads a move beyond its speed by more than what it has as a margin.
template <class Real>
double farthest_approach_m(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s) {
  constexpr double margin = 0.01, of_switch_speed = 0.25;
  const law::BrakedApproach<Real>& plan = design.kicks.approach;
  const double lost = detail::lost_in_a_row * axes.period_s / static_cast<double>(plan.response_s);
  const double slower_m_s = max_speed_m_s * (1 - misread_share(axes, plan)) / moving;
  const double misread_m_s =
      axes.move ? margin * axes.move->speed_m_s + of_switch_speed * static_cast<double>(plan.switch_speed_m_s)
                : (slower_m_s - detail::slower_than_planned_m_s(axes, plan)) / (1 + lost);
  const double rounded_m = std::max(misread_m_s, 0.0) * axes.period_s / static_cast<double>(plan.correction);
  const double last_digit = static_cast<double>(std::numeric_limits<Real>::epsilon());
  return std::min(design.farthest_m, (axes.encoder_resolution_m + rounded_m) / last_digit);
}

// The double S: jerk up and down to the greatest acceleration that the way lets it reach, and the greatest speed.
double least_move_s(const MoveRequest& move) {
  const double j = move.jerk_m_s3.value_or(unlimited), d = move.distance_m;
  const double a = std::min(move.acceleration_m_s2, std::cbrt(d * j * j / 2)), rise_s = std::isinf(j) ? 0 : a / j;
  // The speed that the way lets it reach, with all of the acceleration.
  const double way_m_s = a * (std::sqrt(rise_s * rise_s + 4 * d / a) - rise_s) / 2;
  const double v = std::min(move.speed_m_s, way_m_s);
  const double speeding_s = v >= a * rise_s ? v / a + rise_s : 2 * std::sqrt(v / j);
  return speeding_s + d / v;
}

template <class Real>
double hand_over_m(const BrakedDesign<Real>& design) {
  const law::BrakedApproach<Real>& approach = design.kicks.approach;
  return static_cast<double>(approach.switch_distance_m + approach.short_of_target_m);
}

namespace {

// So old is what a force is planned from when the next one takes its place.
template <class Real>
double known_for_s(const BrakedClass& axes, const law::BrakedApproach<Real>& plan) {
  return axes.latency_periods * axes.period_s + static_cast<double>(plan.response_s);
}

// By which every axis of the class slows down whose plan has it brake as hard as it may.
template <class Real>
double sure_braking_m_s2(const BrakedClass& axes, const law::BrakedApproach<Real>& plan) {
  const KickClass kicks{axes};
  const PlannedForce force{axes, kicks};
  return plan.move.are_asked_for() ? force.sure_deceleration(planned_deceleration_m_s2(axes, kicks))
                                   : (force.gain_least * kicks.limit_N() + force.least_N) / force.heaviest_kg;
}

// An axis that is to brake from the speed v by a_h, and goes on by a for tau because readings that jitter, or are lost,
// have it taken for slower, is taken back by a deceleration of up to d. It goes further by
// (v + a tau)^2 / (2 d) - v^2 / (2 a_h) + v tau + a tau^2 / 2, which is greatest at some v.
template <class Real>
double misread_beyond_m(const BrakedClass& axes, const law::BrakedApproach<Real>& plan, double fastest_m_s) {
  const KickClass kicks{axes};
  const PlannedForce force{axes, kicks};
  const bool moves = plan.move.are_asked_for();
  const double misread_s = misread_in_a_row * axes.period_s, braking = static_cast<double>(plan.hard_m_s2);
  const double sure = sure_braking_m_s2(axes, plan);
  const double given = (force.gain_most * kicks.limit_N() - force.least_N) / force.lightest_kg;
  const double speeding = moves ? std::min(given, axes.move->acceleration_m_s2) : given;
  const double late_s = misread_s * (1 + speeding / sure), taken_back = std::max(1 / braking - 1 / sure, 0.0) / 2;
  const double v = std::min(fastest_m_s, late_s / (2 * taken_back));
  return v * (late_s - v * taken_back) + speeding * misread_s * late_s / 2;
}

}  // namespace

template <class Real>
double approach_peak_m_s(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s,
                         double from_m) {
  constexpr double kept = 1.01;  // by a move
  if (axes.move) return kept * std::min(max_speed_m_s, axes.move->speed_m_s);
  // One that its drive throws past the target within a period is thrown back as hard, for as long as what is known of
  // it is old.
  const law::BrakedApproach<Real>& plan = design.kicks.approach;
  const KickClass kicks{axes};
  const PlannedForce force{axes, kicks};
  const double thrown = (force.gain_most * kicks.limit_N() - force.least_N) / force.lightest_kg;
  return std::max(max_speed_m_s + detail::faster_than_planned_m_s(axes, plan, max_speed_m_s, from_m),
                  thrown * known_for_s(axes, plan));
}

// Known late, and with a jerk that has to take the acceleration away and to bring that of the brake.
template <class Real>
double turning_m(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s, double from_m) {
  const law::BrakedApproach<Real>& plan = design.kicks.approach;
  const double fastest_m_s = approach_peak_m_s(axes, design, max_speed_m_s, from_m);
  const double rise_s = axes.move && axes.move->jerk_m_s3 ? axes.move->acceleration_m_s2 / *axes.move->jerk_m_s3 : 0;
  return fastest_m_s * (known_for_s(axes, plan) + 2 * rise_s + fastest_m_s / (2 * sure_braking_m_s2(axes, plan)));
}

template <class Real>
double approach_beyond_m(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s) {
  // What the plan asks of the drive, by so many times the age of what it knows, and by so much more under jitter; and
  // as much again where jitter has a pattern, so that the force that answers a late sample always acts for a short
  // period.
  constexpr double late = 3, late_by_jitter = 16, in_pattern = 2, late_by_jerk = 2;
  const law::BrakedApproach<Real>& plan = design.kicks.approach;
  const double T = axes.period_s, old_s = known_for_s(axes, plan);
  const double in_a_period_m = static_cast<double>(plan.hard_m_s2) * T * old_s;
  const double fastest_m_s =
      plan.move.are_asked_for() ? std::min(max_speed_m_s, static_cast<double>(plan.move.speed_m_s)) : max_speed_m_s;
  const double beyond_m = detail::hand_overs_beyond * hand_over_m(design) +
                          (late + late_by_jitter * axes.jitter_s / T) * in_a_period_m +
                          misread_beyond_m(axes, plan, fastest_m_s);
  if (axes.jitter_s > 0) return in_pattern * beyond_m;  // with which no move is certified
  if (!axes.move) return beyond_m;
  const double in_move_m = axes.move->acceleration_m_s2 * T * T;
  if (!axes.move->jerk_m_s3) return beyond_m + in_move_m;
  // A change of the acceleration that is one period late comes as long after it was due; and a friction that falls is
  // answered, and the speed that it left taken away, as slowly as the jerk lets it.
  const KickClass kicks{axes};
  const double jerk = *axes.move->jerk_m_s3;
  const double fall = (kicks.most_friction_N() - kicks.least_friction_N()) / axes.mass_kg.least;
  const double gained_m_s = fall * (old_s + fall / (2 * jerk));
  return late_by_jerk * (beyond_m + in_move_m + gained_m_s * (old_s + 2 * std::sqrt(gained_m_s / jerk)));
}

template law::BrakedApproach<float> detail::braked_approach(const BrakedClass&, const KickClass&);
template law::BrakedApproach<double> detail::braked_approach(const BrakedClass&, const KickClass&);
template bool keeps_speed(const BrakedClass&, const BrakedDesign<float>&);
template bool keeps_speed(const BrakedClass&, const BrakedDesign<double>&);
template double least_move_speed_m_s(const BrakedDesign<float>&);
template double least_move_speed_m_s(const BrakedDesign<double>&);
template double least_approach_speed_m_s(const BrakedClass&, const BrakedDesign<float>&);
template double least_approach_speed_m_s(const BrakedClass&, const BrakedDesign<double>&);
template double farthest_approach_m(const BrakedClass&, const BrakedDesign<float>&, double);
template double farthest_approach_m(const BrakedClass&, const BrakedDesign<double>&, double);
template double hand_over_m(const BrakedDesign<float>&);
template double hand_over_m(const BrakedDesign<double>&);
template double approach_peak_m_s(const BrakedClass&, const BrakedDesign<float>&, double, double);
template double approach_peak_m_s(const BrakedClass&, const BrakedDesign<double>&, double, double);
template double turning_m(const BrakedClass&, const BrakedDesign<float>&, double, double);
template double turning_m(const BrakedClass&, const BrakedDesign<double>&, double, double);
template double approach_beyond_m(const BrakedClass&, const BrakedDesign<float>&, double);
template double approach_beyond_m(const BrakedClass&, const BrakedDesign<double>&, double);

}  // namespace breakaway::design
