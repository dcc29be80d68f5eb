#include "brake_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "bent_kicks.hpp"
#include "breakaway/law/approach_plan.hpp"
#include "breakaway/law/kick_judge.hpp"
#include "check.hpp"
#include "planned_force.hpp"
#include "reachable.hpp"

namespace breakaway::design::detail {
namespace {

// Of an axis whose friction bends: tests/campaign.
constexpr double least_ringing_per_period = 0.25, least_apart = 1.5, most_coarse_steps = 64, most_bent_over = 1.75,
                 least_led_on = 0.01;

// Of a move: tests/campaign.
constexpr double steps_of_a_move = 4;  // of the force within the least friction

// What it takes instead is found by designs of other classes, which need no such search themselves: add_ways.
constexpr const char* tolerance_above_floor = "tolerance_above_floor";
constexpr const char* few_kicks = "kicks_are_few";

// What the fine stage aims at is not promised, so that it may be asked for only where what is promised will do.
Check tolerance_check(const AxisDesign& axis, const BrakedDesign<float>& design) {
  const BrakedClass& c = *axis.braked;
  const double error_m = error_at_rest_m(c, design.least_tolerance_m);
  const bool fine = design.has_fine_stage() && error_m <= axis.settle_tolerance_m * (1 + bound_rounding);
  const double least_m = fine ? design.least_reading_m : design.least_tolerance_m;
  const std::string reading = c.encoder_noise_m > 0 ? "twice what a reading may be off" : "0.51 counts";
  return below(tolerance_above_floor, fine ? reading : "the floor of the kick table, and " + reading, least_m,
               axis.position_tolerance_m, "the least tolerance against position_tolerance_m", "", Equality::holds);
}

// The six conditions of the coast "brake", and that rest can be seen. Of them follows what the promise says.
std::vector<Check> checks_of_brake(const AxisDesign& axis, const BrakedDesign<float>& design) {
  const BrakedClass& c = *axis.braked;
  const double least_N = c.friction.lower_N - c.load_N, brake_N = static_cast<double>(design.kicks.brake_N);
  const std::string source = "every friction between its bounds, by comparison with the least";
  std::vector<Check> checks{
      below("brake_lets_the_axis_rest", source, c.force_gain.most * brake_N, least_N,
            "the brake with the largest force gain against the least friction less the greatest load",
            "narrow the bounds of the friction or of the force beside the drive's"),
      below("pulse_breaks_away", "a pulse must be sure to exceed the greatest friction and load by 0.2 %",
            design.pulse_needed_N, c.max_force_N, "the least sure pulse against max_force_N",
            "use a stronger drive, or one with a faster current loop", Equality::holds)};
  checks.push_back(below("latency_is_bridged", "the approach carries its estimate on over the latency",
                         c.latency_periods, law::ApproachPlan<float>::most_latency_periods,
                         "the latency in periods against those that the approach has room for",
                         "shorten the latency, or take a longer period", Equality::holds));
  if (!design.breaks_away) return checks;
  const law::BrakedKicks<float>& kicks = design.kicks;
  checks.push_back(below("rest_is_seen_in_time", "a moving axis loses a count within sqrt(2 q m / (A - theta))",
                         std::max(kicks.still_periods, kicks.either_way_periods) + kicks.settling_periods, 15000,
                         "the periods that prove rest", "use a finer encoder"));
  checks.push_back(below("kicks_contract", "from the floor to the end of the table each kick takes 3 % away",
                         design.floor_m, design.reach_m, "accuracy floor against the reach of a kick",
                         "know friction better, narrow the uncertainties, or use a drive with a finer step of force"));
  checks.push_back(tolerance_check(axis, design));
  if (!c.move)
    checks.push_back(below(
        "approach_gets_on",
        "the force that leads to the greatest speed must exceed all friction, and nothing may stop the axis on its way",
        least_approach_speed_m_s(c, design), axis.max_approach_speed_m_s,
        std::string{"the speed that an approach must be allowed against max_approach_speed_m_s, and nine tenths of "
                    "[limits] speed_m_s"} +
            (c.jitter_s > 0 ? " less what samples may be late by" : ""),
        "raise these, know friction better, or use a finer encoder", Equality::holds));
  const double from_m = kicks_begin_m(design);
  const int most = most_kicks(c, design, from_m, std::max(axis.position_tolerance_m, design.least_tolerance_m));
  const bool end = most > 0 || axis.position_tolerance_m >= from_m;
  checks.push_back(below(few_kicks, "after so many kicks the law stops by name",
                         end ? most : std::numeric_limits<double>::infinity(), law::KickJudge<float>::most_kicks,
                         "the kicks that may be needed from " + brief(from_m) +
                             " m, the farthest at which kicks begin, against what the law allows",
                         "", Equality::holds));
  return checks;
}

// Friction that bends before it slides: what random axes needed to settle in closed loop (tests/campaign).
std::vector<Check> checks_of_presliding(const BrakedClass& c) {
  const std::string tested = "tested, not proved: what sufficed for all of many axes whose friction bends";
  const double least_N = c.friction.lower_N - c.load_N, most_N = c.friction.upper_N + c.load_N;
  const double stiffness = c.presliding_stiffness_N_per_m, counts = least_N / stiffness / c.encoder_resolution_m;
  return {below("bending_is_few_counts", tested, counts, most_bending_counts,
                "least friction / presliding_stiffness_N_per_m in counts against 30",
                "use a coarser encoder, or know a stiffer bound", Equality::holds),
          below("bending_rings_visibly", tested, least_ringing_per_period,
                std::sqrt(stiffness / c.mass_kg.most) * c.period_s,
                "a quarter against sqrt(presliding_stiffness_N_per_m / mass) period_s", "take a longer period",
                Equality::holds),
          below("bending_bounds_are_apart", tested, least_N, most_N / least_apart,
                "the least friction less the load against the greatest and the load over 1.5", "state wider bounds",
                Equality::holds),
          below("bending_loop_is_fast", tested, c.lag_s.most, 0.2 * c.period_s,
                "the time constant of the current loop against a fifth of period_s", "take a longer period",
                Equality::holds),
          below("bending_load_is_small", tested, c.load_N, 0.1 * c.friction.lower_N,
                "the force beside the drive's against a tenth of the least friction", "feed a known force forward",
                Equality::holds),
          below("bending_is_read_in_time", tested, c.jitter_s + c.encoder_noise_m, 0,
                "jitter_s and encoder_noise_m together against 0",
                c.rounding_m > 0 ? "state neither, of a drive that shows no float as its position" : "state neither",
                Equality::holds),
          below("bending_force_is_fine", tested, most_coarse_steps * c.force_step_N, c.max_force_N,
                "64 steps of force against max_force_N", "use a drive with a finer step of force")};
}

// Of an axis that meets those: its kicks tried on what bends.
std::vector<Check> checks_of_bent_kicks(const BrakedClass& c, const BrakedDesign<float>& design, double tolerance_m) {
  const BentKicks tried = try_bent_kicks(c, design.kicks, tolerance_m);
  // From the first count outside, of which half a count may be nearer, to the last within on the other side.
  const double within = std::floor(tolerance_m / c.encoder_resolution_m);
  const double most = std::min(most_bent_over, (2 * within + 1) / (within + 1));
  const std::string tested = "tested, not proved: kicks at the ends of the class, on Dahl's friction";
  return {
      below("bent_kicks_end_nearer", tested, tried.furthest, most,
            "of the distance that the axis is kicked from, how far it goes at most (from " +
                brief(tried.furthest_from_m) + " m), against what leaves it nearer on the other side",
            "widen the tolerance, or know a stiffer bound", Equality::holds),
      below("bent_kicks_lead_on", tested, least_led_on, tried.least_on,
            "a hundredth of that distance against the share by which a kick and the spring lead it on at least (from " +
                brief(tried.least_on_from_m) + " m)",
            "widen the tolerance, feed a known force forward, or know a stiffer bound")};
}

// The rigid law on an axis whose load hangs on a spring.
std::vector<Check> checks_of_spring_load(const AxisDesign& axis, const BrakedDesign<float>& design) {
  const BrakedClass& c = *axis.braked;
  const SpringDemand demand = spring_demand(c, design);
  const double resonance_Hz = c.spring_load->resonance_Hz();
  const double safe_Hz = demand.safe_from_Hz(c, axis.position_tolerance_m), shortest_s = c.period_s - c.jitter_s;
  const std::string remedy = "the load resonates at " + brief(resonance_Hz) +
                             " Hz, and the law for one rigid mass is safe from " + brief(safe_Hz) +
                             " Hz on; take coast = \"work\", a longer period_s, a wider tolerance, or a stiffer joint";
  const std::string tested = "tested, not proved: what sufficed for all of many axes with a load on a spring";
  return {
      below("load_rings_fast", tested, demand.least_per_period, resonance_Hz * shortest_s,
            "1.2 against the swings of the load in a period", remedy, Equality::holds),
      below("spring_keeps_the_target", "the work of a pulse against what friction takes and the spring holds",
            demand.nearest_m, axis.position_tolerance_m,
            "what the spring adds to a pulse of a period against position_tolerance_m", remedy, Equality::holds),
      below("pulse_outlasts_the_spring", "a pulse moves the load, and not the motor alone", demand.swing_s, shortest_s,
            "a quarter of a swing of the motor on the spring against the shortest pulse", remedy, Equality::holds),
      below("spring_stands_alone", tested,
            (c.presliding_stiffness_N_per_m > 0) + c.move.has_value() + design.has_fine_stage(), 0,
            "friction that bends, limits of a move and a fine stage against none", "leave them out, or simulate it",
            Equality::holds)};
}

// An axis of which all is known, at its least friction, can do with less.
bool knowledge_lets_move(const BrakedClass& c) {
  BrakedClass known = c;
  known.friction.upper_N = known.friction.lower_N;
  for (Interval* interval : {&known.mass_kg, &known.force_gain})
    interval->least = interval->most = (interval->least + interval->most) / 2;
  return least_acceleration_m_s2(known) <= c.move->acceleration_m_s2;
}

// What a move asks for must be possible for every axis of the class.
std::vector<Check> checks_of_move(const BrakedClass& c, const BrakedDesign<float>& design) {
  const MoveRequest& move = *c.move;
  const double least_m_s2 = least_acceleration_m_s2(c);
  std::vector<Check> checks{
      below("move_can_be_made", "the least force that breaks the axis away, and friction with the brake that stops it",
            least_m_s2, move.acceleration_m_s2,
            "the acceleration that some axis of the class takes at least against [move] acceleration_m_s2",
            "raise it to " + brief(rounded_up(least_m_s2, 3)) +
                (knowledge_lets_move(c) ? ", or know friction, mass and force gain better" : ""),
            Equality::holds)};
  if (!design.possible()) return checks;
  const std::string tested = "tested, not proved: what is seen of the speed, and how soon a force follows";
  const std::string tested_of_moves = "tested, not proved: what sufficed for all of many moves";
  checks.push_back(below("speed_is_seen_well_enough", tested, least_move_speed_m_s(design), move.speed_m_s,
                         "eight times the speed at which brake and kicks take over against [move] speed_m_s",
                         "raise it, use a finer encoder, or know friction and mass better", Equality::holds));
  checks.push_back(below("move_keeps_time", "the limits of a move are for a loop without jitter", c.jitter_s, 0,
                         "[uncertainty] jitter_s against 0 where there is a [move]", "leave [move] out",
                         Equality::holds));
  checks.push_back(below("move_force_is_fine", tested_of_moves, steps_of_a_move * c.force_step_N,
                         c.friction.lower_N - c.load_N,
                         "four steps of the drive's force against the least friction less the load",
                         "use a drive with a finer step of force, or leave [move] out", Equality::holds));
  if (!checks.front().holds) return checks;
  const double planned_m_s = static_cast<double>(design.kicks.approach.move.speed_m_s);
  checks.push_back(
      {"speed_margin_is_small", true, keeps_speed(c, design), planned_m_s - 0.75 * move.speed_m_s, tested,
       "of [move] speed_m_s = " + brief(move.speed_m_s) + ", " + brief(planned_m_s) +
           " is planned, and must be above three quarters; raise it, lower acceleration_m_s2, or know mass and "
           "force gain better"});
  if (!move.jerk_m_s3) return checks;
  const Interval jerk = jerk_m_s3(c);
  const std::string remedy = "take one between " + brief(rounded_up(jerk.least, 6)) + " and " +
                             brief(rounded_down(jerk.most, 6)) + ", or leave it out";
  checks.push_back(below("jerk_can_be_followed", "four periods at least to the full deceleration", *move.jerk_m_s3,
                         jerk.most, "[move] jerk_m_s3 against what periods can follow", remedy, Equality::holds));
  checks.push_back(below("jerk_leaves_time_to_brake", tested, jerk.least, *move.jerk_m_s3,
                         "64 periods to the full deceleration, and 15 until the axis moves, against [move] jerk_m_s3",
                         remedy, Equality::holds));
  checks.push_back(below("jerk_is_known", tested_of_moves, spread(c.mass_kg) + spread(c.force_gain),
                         most_unknown_with_jerk,
                         "the shares by which mass and force gain may be off, together, against a tenth",
                         "know them better, or leave [move] jerk_m_s3 out", Equality::holds));
  checks.push_back(below("jerk_is_followed_soon", tested, c.lag_s.most, most_lag_with_jerk * c.period_s,
                         "the time constant of the current loop against half a period", "leave [move] jerk_m_s3 out",
                         Equality::holds));
  return checks;
}

void add(std::vector<Check>& checks, std::vector<Check> more) {
  for (Check& check : more) checks.push_back(std::move(check));
}

// All of them, without the ways that lead to a tolerance.
std::vector<Check> checks_of(const AxisDesign& axis, const BrakedDesign<float>& design) {
  const BrakedClass& c = *axis.braked;
  std::vector<Check> checks = checks_of_brake(axis, design);
  if (c.presliding_stiffness_N_per_m > 0) {
    const std::vector<Check> bending = checks_of_presliding(c);
    add(checks, bending);
    const double tolerance_m = std::max(axis.position_tolerance_m, design.least_tolerance_m);
    if (design.possible() && std::ranges::all_of(bending, &Check::holds))
      add(checks, checks_of_bent_kicks(c, design, tolerance_m));
  }
  if (c.spring_load && design.brake_holds) add(checks, checks_of_spring_load(axis, design));
  if (c.move && design.brake_holds) add(checks, checks_of_move(c, design));
  return checks;
}

std::vector<Check> checks_of(AxisDesign axis, const BrakedClass& other, const BrakedDesign<float>& design) {
  axis.braked = other;
  return checks_of(axis, design);
}

bool is_kept(const Check& check) { return check.holds || check.name == tolerance_above_floor; }

// A way to the tolerance must not break another check. Where one fails anyway, nothing can be said of the others.
std::string ways_of(const AxisDesign& axis, const BrakedDesign<float>& design, const std::vector<Check>& checks) {
  if (!std::ranges::all_of(checks, is_kept))
    return ways_to_reach(*axis.braked, design, axis.position_tolerance_m, axis.least_period_s);
  const Keeps keeps = [&](const BrakedClass& other, const BrakedDesign<float>& of_other) {
    return std::ranges::all_of(checks_of(axis, other, of_other), is_kept);
  };
  return ways_to_reach(*axis.braked, design, axis.position_tolerance_m, axis.least_period_s, keeps);
}

std::string by_less_lag(const AxisDesign& axis) {
  const auto lag_s = longest_lag_s(*axis.braked, [&](const BrakedClass& quicker) {
    return std::ranges::all_of(checks_of(axis, quicker, design_braked_kicks<float>(quicker)), &Check::holds);
  });
  return lag_s ? ", or take a drive with a current_loop_time_constant_s of " + brief(*lag_s) + " s" : "";
}

bool holds(const std::vector<Check>& checks, const std::string& name) {
  const auto found = std::ranges::find(checks, name, &Check::name);
  return found != checks.end() && found->holds;
}

// One number of an axis, and how to say which would do.
struct Remedy {
  std::string_view words, unit;
  void (*take)(AxisDesign& axis, double times);
  double (*number)(const AxisDesign& axis);
};

void widen_tolerance(AxisDesign& axis, double times) {
  axis.position_tolerance_m = rounded_up(axis.position_tolerance_m * times, 3);
  if (axis.braked->fine_tolerance_m > 0) axis.braked->fine_tolerance_m = axis.position_tolerance_m;
}
void take_stronger_drive(AxisDesign& axis, double times) {
  axis.max_force_N = axis.braked->max_force_N = rounded_up(axis.braked->max_force_N * times, 3);
}
void take_finer_steps(AxisDesign& axis, double times) {
  axis.braked->force_step_N = rounded_down(axis.braked->force_step_N / times, 3);
}
void take_finer_encoder(AxisDesign& axis, double times) {
  axis.encoder_resolution_m = axis.braked->encoder_resolution_m =
      rounded_down(axis.braked->encoder_resolution_m / times, 3);
}

constexpr Remedy fewer_kicks[] = {
    {"widen the tolerance to ", " m", widen_tolerance, [](const AxisDesign& a) { return a.position_tolerance_m; }},
    {"use a drive of ", " N", take_stronger_drive, [](const AxisDesign& a) { return a.braked->max_force_N; }},
    {"use one with steps of force of ", " N", take_finer_steps,
     [](const AxisDesign& a) { return a.braked->force_step_N; }},
    {"use an encoder_resolution_m of ", " m", take_finer_encoder,
     [](const AxisDesign& a) { return a.braked->encoder_resolution_m; }},
};

// Each number alone, with which the kicks are few and no other check fails that holds without it.
std::string ways_to_few_kicks(const AxisDesign& axis, const std::vector<Check>& checks) {
  const auto is_mended = [&](const AxisDesign& other) {
    const std::vector<Check> now = checks_of(other, design_braked_kicks<float>(*other.braked));
    return holds(now, few_kicks) &&
           std::ranges::all_of(checks, [&](const Check& check) { return !check.holds || holds(now, check.name); });
  };
  std::string ways;
  for (const Remedy& remedy : fewer_kicks) {
    for (const double times : {1.1, 1.25, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0}) {
      AxisDesign other = axis;
      remedy.take(other, times);
      if (!is_mended(other)) continue;
      ways.append(ways.empty() ? "" : ", or ").append(remedy.words);
      ways.append(brief(remedy.number(other))).append(remedy.unit);
      break;
    }
  }
  return ways.empty() ? "mend the other checks first, or narrow the bounds of the friction" : ways;
}

// A faster current loop may mend all that fails, and is told once.
void add_ways(std::vector<Check>& checks, const AxisDesign& axis, const BrakedDesign<float>& design) {
  const auto first = std::ranges::find(checks, false, &Check::holds);
  if (first == checks.end()) return;
  for (Check& check : checks)
    if (!check.holds && check.name == tolerance_above_floor) check.reason += ways_of(axis, design, checks);
  for (Check& check : checks)
    if (!check.holds && check.name == few_kicks) check.reason += ways_to_few_kicks(axis, checks);
  first->reason += by_less_lag(axis);
}

}  // namespace

std::vector<Check> brake_checks(const AxisDesign& axis, const BrakedDesign<float>& design) {
  std::vector<Check> checks = checks_of(axis, design);
  add_ways(checks, axis, design);
  return checks;
}

}  // namespace breakaway::design::detail
