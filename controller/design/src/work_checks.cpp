#include "work_checks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "breakaway/law/shaped_move.hpp"
#include "breakaway/law/work_aim.hpp"
#include "check.hpp"
#include "jointed.hpp"
#include "work_approach.hpp"

namespace breakaway::design::detail {
namespace {

// What random axes were drawn from, all of which settled: tests/campaign.
constexpr double most_ratio = 10, most_unsure = 0.1, most_lag = 0.2, least_friction_ratio = 0.4,
                 least_friction_share = 0.1;
// In which friction may hold an axis: a node gives up one that gets no nearer for a minute, and the law counts up to
// 65535 periods in which it looks still, with those that show it.
constexpr double most_stop_s = 30, most_stop_periods = 64000;

constexpr const char* tested_of_work = "tested, not proved: what sufficed for all of many axes with a load on a spring";

std::vector<Check> checks_of_class(const BrakedClass& c) {
  const SpringLoad& load = *c.spring_load;
  const double ratio = load.load_kg / load.motor_kg, swings = load.resonance_Hz() * c.period_s;
  const auto unsure = [](const Interval& i) { return (i.most - i.least) / (i.most + i.least); };
  const auto share = [](double motor_N, double load_N) { return std::min(motor_N, load_N) / (motor_N + load_N); };
  const double least_share = std::min(share(load.motor_friction.lower_N, load.load_friction.lower_N),
                                      share(load.motor_friction.upper_N, load.load_friction.upper_N));
  const double friction_ratio = std::min(load.motor_friction.lower_N / load.motor_friction.upper_N,
                                         load.load_friction.lower_N / load.load_friction.upper_N);
  return {
      below("motor_holds_the_load_force", "rest without a force", c.load_N, load.motor_friction.lower_N,
            "the force beside the drive's against the least friction of the motor",
            "feed a known force forward, or narrow its bounds"),
      below("swing_is_sampled", tested_of_work, swings, 1 / least_swing_periods,
            "the swings of the load in a period against a third",
            "shorten period_s, or take coast = \"brake\", which may hold a spring as stiff", Equality::holds),
      below("swing_is_counted", "a pulse lasts whole swings", 1 / swings, longest_pulse_periods,
            "the periods of a swing against those of the longest pulse", "take a longer period_s, or a stiffer joint",
            Equality::holds),
      below("masses_are_comparable", tested_of_work, std::max(ratio, 1 / ratio), most_ratio,
            "the greater of motor and load over the other against 10", "simulate it", Equality::holds),
      below("masses_and_gain_are_known", tested_of_work, std::max(unsure(c.mass_kg), unsure(c.force_gain)), most_unsure,
            "[uncertainty] of mass and force_gain against a tenth", "know them better", Equality::holds),
      below("friction_is_known", tested_of_work, least_friction_ratio, friction_ratio,
            "0.4 against the least over the greatest friction of either side", "know it better", Equality::holds),
      below("friction_is_shared", tested_of_work, least_friction_share, least_share,
            "a tenth against the share that the side which rubs less has in the friction of both", "simulate it",
            Equality::holds),
      below("work_loop_is_fast", tested_of_work, c.lag_s.most, most_lag * c.period_s,
            "the time constant of the current loop against a fifth of period_s", "take a longer period_s",
            Equality::holds),
      below("work_keeps_time", tested_of_work, c.jitter_s + c.encoder_noise_m, 0,
            "jitter_s and encoder_noise_m against 0", "state neither, or simulate it", Equality::holds),
      below("work_stands_alone", tested_of_work, (c.presliding_stiffness_N_per_m > 0) + c.move.has_value(), 0,
            "friction that bends and limits of a move against none", "leave them out, or simulate it",
            Equality::holds)};
}

// One approach counts so many periods of its highest speed, of which it plans half at least; and to a hundred
// thousandth of its way a float holds the plan.
double farthest_m(const AxisDesign& axis, const WorkDesign<float>& design) {
  const double counted_s = law::ShapedMove<float>::most_planned_periods * axis.work->period_s;
  return std::min(axis.max_approach_speed_m_s / 2 * counted_s, 1e5 * static_cast<double>(design.kicks.begin_m()));
}

// The feedback with which swings end depends on how the joint damps them; nothing else of a design does.
std::optional<double> enough_damping_Ns_per_m(const BrakedClass& c, int swing_periods) {
  BrakedClass damped = c;
  SpringLoad& load = *damped.spring_load;
  const double critical = load.critical_damping_Ns_per_m();
  for (double share = 0.005; share < 0.5; share *= 1.5) {
    if (share * critical <= c.spring_load->damping_Ns_per_m) continue;
    load.damping_Ns_per_m = share * critical;
    const Jointed axis{damped};
    if (ends_swings(axis, work_approach<float>(axis, swing_periods))) return load.damping_Ns_per_m;
  }
  return std::nullopt;
}

std::string against_swings(const BrakedClass& c, const WorkDesign<float>& design) {
  const auto damping = enough_damping_Ns_per_m(c, design.kicks.approach.swing_periods);
  return (damping ? "state that the joint has a damping_Ns_per_m of " + brief(1.001 * *damping) +
                        " at least, where it has, or "
                  : std::string{}) +
         (c.spring_load->encoder_on_load ? "read the motor" : "shorten period_s or the latency");
}

}  // namespace

std::vector<Check> work_checks(const AxisDesign& axis, const WorkDesign<float>& design) {
  const BrakedClass& c = *axis.work;
  std::vector<Check> checks = checks_of_class(c);
  if (!design.holds || !design.swing_is_counted) return checks;
  checks.push_back(below("pulse_moves_the_load", "a pulse must be sure to break motor and load away by 0.2 %",
                         design.pulse_needed_N, c.max_force_N, "the least sure pulse of a swing against max_force_N",
                         "use a stronger drive, or a stiffer joint", Equality::holds));
  if (!design.moves_load) return checks;
  checks.push_back(below("rest_is_seen_in_time", "the mass that is not read may swing on while the other sticks",
                         design.rest_s / c.period_s, 15000, "the periods that prove rest",
                         "use a finer encoder, or a stiffer joint"));
  const Jointed joint{c};
  const std::string remedy = ends_swings(joint, design.kicks.approach) ? std::string{} : against_swings(c, design);
  checks.push_back(below("swing_is_not_driven", tested_of_work, design.swing_growth, 0,
                         "the share by which the approach, whose feedback acts late, lets a swing grow in a radian",
                         remedy, Equality::holds));
  checks.push_back(below("swing_across_gap_is_held", tested_of_work, design.gap_swing.force_N, joint.g,
                         "what the approach's feedback gives in the greatest swing that it keeps up across the gap "
                         "against the least friction, which is to end it",
                         remedy, Equality::holds));
  const double counted_s = (most_stop_periods - design.kicks.still_periods) * c.period_s;
  checks.push_back(below("approach_gets_on", tested_of_work, design.longest_stop_s, std::min(most_stop_s, counted_s),
                         "the time in which friction may hold an axis that its approach leads on against what is "
                         "waited for",
                         "raise max_approach_speed_m_s, or know friction better"));
  checks.push_back(below("kicks_get_on", "from the floor on each tried kick takes 5 % away", design.floor_m,
                         design.reach_m, "accuracy floor against the reach of a kick",
                         "use a stiffer joint, or know friction and backlash better"));
  checks.push_back(below("kicks_go_on_from_the_approach", "an axis that rests further away is approached again",
                         static_cast<double>(design.kicks.begin_m()), design.reach_m,
                         "where the approach may end against the reach of a kick",
                         "use a stronger drive, a stiffer joint, or know friction better", Equality::holds));
  const double count_m = c.encoder_resolution_m;
  checks.push_back(below("kicks_reach_the_tolerance", "what rests outside its tolerance, kicks must aim at",
                         axis.position_tolerance_m + count_m, design.reach_m,
                         "position_tolerance_m and a count against the reach of a kick",
                         design.reach_m - count_m > design.least_tolerance_m
                             ? "take a tolerance below " + brief(0.999 * (design.reach_m - count_m))
                             : std::string{"use a finer encoder, or a stronger drive"}));
  checks.push_back(
      below("tolerance_above_floor", "nearer than the floor an axis is not kicked, and the spring may lead it back",
            design.least_tolerance_m, axis.position_tolerance_m, "the least tolerance against position_tolerance_m",
            "take a tolerance of " + brief(design.least_tolerance_m * 1.001) +
                ", a stiffer joint, less backlash, or narrower bounds of friction",
            Equality::holds));
  return checks;
}

WorkPromise work_promise(const AxisDesign& axis, const WorkDesign<float>& design) {
  const BrakedClass& c = *axis.work;
  WorkPromise p{.floor_m = design.floor_m,
                .least_tolerance_m = design.least_tolerance_m,
                .error_m = axis.position_tolerance_m + c.reading_error_m(),
                .beyond_m = c.reading_error_m(),
                .spring_m = design.spring_m,
                .unseen_m = design.unseen_m,
                .resonance_Hz = design.resonance_Hz,
                .reach_m = design.reach_m,
                .hand_over_m = static_cast<double>(design.kicks.begin_m()),
                .farthest_m = farthest_m(axis, design),
                .most_kicks = law::WorkAim<float>::most_kicks,
                .rest_s = design.kicks.still_periods * c.period_s,
                .kick_peak_m_s = design.peak_speed_m_s,
                .table_bytes = design.table_bytes,
                .approach_beyond_m = approach_beyond_m(c, design, axis.max_approach_speed_m_s),
                .approach_peak_m_s = approach_peak_m_s(c, design, axis.max_approach_speed_m_s),
                .promise = {}};
  const bool on_load = c.spring_load->encoder_on_load;
  const std::string read = on_load ? "load" : "motor", unread = on_load ? "motor" : "load";
  p.promise = "at rest the true error of the " + read + " is at most " + brief_up(p.error_m) +
              " m, no kick leads it more than " + brief_up(p.beyond_m) + " m beyond the target, and the " + unread +
              " may rest " + brief_up(p.unseen_m) + " m from where the " + read + " says; a target may be set " +
              brief(rounded_down(p.farthest_m, 6)) + " m away";
  return p;
}

std::vector<std::string> conditions_of_work(const AxisDesign& axis, const WorkPromise& promise) {
  const BrakedClass& c = *axis.work;
  const SpringLoad& load = *c.spring_load;
  const auto bounds = [](const law::FrictionBounds<double>& f) {
    return brief(f.lower_N) + " N and " + brief(f.upper_N) + " N";
  };
  const std::string metered = load.encoder_on_load
                                  ? ""
                                  : "that the spring never pushes the motor on harder in a pulse than it can at "
                                    "rest, which the meter counts with, ";
  std::string tested = "tested, not proved: that the axis settles within the kicks that it may have, " + metered +
                       "and that the approach ends near the target, and goes no further than " +
                       brief_up(promise.approach_beyond_m) + " m beyond it";
  if (std::isfinite(promise.approach_peak_m_s))
    tested += ", nor faster than " + brief_up(promise.approach_peak_m_s) + " m/s";
  // A load that has not moved pulls by no more than its greatest friction, of which each swing of the motor loses 2 A1.
  const double pull_N = load.load_friction.upper_N - 2 * (load.motor_friction.lower_N - c.load_N);
  const double back_m = std::max(pull_N, 0.0) / load.stiffness_N_per_m + load.gap_m;
  return {
      "friction of the motor stays between " + bounds(load.motor_friction) + ", that of the load between " +
          bounds(load.load_friction) + ", at any position, speed and time, as it likes",
      "motor and load are joined by a spring of " + brief(load.stiffness_N_per_m) + " N/m, or up to " +
          brief(most_stiffer) + " times as stiff, with damping of at least " + brief(load.damping_Ns_per_m) +
          " N s/m and a gap of at most " + brief(load.gap_m) + " m, and by nothing that drives them",
      "motor and load together have a mass of " + range(c.mass_kg, " kg") + ", shared as stated, and the drive gives " +
          range(c.force_gain, " times the force") +
          " that is commanded, behind a current loop with a time constant of " + range(c.lag_s, " s"),
      "a force beside the drive's acts on the motor and is at most " + brief(c.load_N) + " N either way",
      std::string{"a reading is off by half a count at most, and no command is lost; a sample that is lost costs a "} +
          "period, and of a hundred no more than one is",
      "the axis rests when it is enabled, at least " + (back_m > 0 ? brief_up(back_m) : brief(back_m)) +
          " m inside its position limits: so far the motor may swing back before the load breaks away",
      "a target is no further away when it is set than the promise says",
      std::string{"friction that is at its least at rest and rises with speed, or falls again and again while the "} +
          "axis rests, may let the bent spring creep: then the run may end by name, as drifting or hunting",
      tested};
}

}  // namespace breakaway::design::detail
