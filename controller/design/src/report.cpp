#include "breakaway/design/report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "brake_checks.hpp"
#include "breakaway/design/approach_time.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/design/kick_promise.hpp"
#include "breakaway/law/fine_stage.hpp"
#include "brief.hpp"
#include "pd_checks.hpp"
#include "pd_trial.hpp"
#include "planned_force.hpp"
#include "reachable.hpp"
#include "work_checks.hpp"

namespace breakaway::design {
namespace {

using detail::error_at_rest_m;
using detail::range;

constexpr const char* whole_counts = "a target is a whole count, to which the loop rounds every other";

void require_in_range(const AxisDesign& axis) {
  require_positive("mass_kg", axis.mass_kg);
  require_positive("stiffness k1", axis.stiffness_N_per_m);
  require_positive("approach damping k21", axis.approach_damping_Ns_per_m);
  require_positive("max_force_N", axis.max_force_N);
  require_positive("position_tolerance_m", axis.position_tolerance_m);
  require_not_negative("force_step_N", axis.force_step_N);
  require_not_negative("period_s", axis.period_s);
  require_not_negative("encoder_resolution_m", axis.encoder_resolution_m);
  if (axis.latency_ticks < 0) {
    throw InputError{"latency_ticks",
                     "is " + std::to_string(axis.latency_ticks) + "; give 0 or a whole number of periods"};
  }
  if (!std::isfinite(axis.smooth_friction_slope_Ns_per_m)) {
    throw InputError{"smooth_friction_slope_Ns_per_m",
                     "is not a finite number; give 0 when there is no smooth friction"};
  }
  require_valid(axis.friction);
}

double sprung_beyond_m(const BrakedClass& c, const BrakedDesign<float>& design) {
  return c.spring_load ? spring_demand(c, design).beyond_m : 0;
}

// Where friction holds at once and the mechanism is rigid, as it was tested.
double longest_approach_s(const AxisDesign& axis, const BrakedDesign<float>& design) {
  const bool tested = !axis.braked->spring_load && !(axis.braked->presliding_stiffness_N_per_m > 0);
  if (!tested || !(axis.longest_way_m > 0)) return 0;
  const double time_s = approach_s(*axis.braked, design, axis.max_approach_speed_m_s, axis.longest_way_m);
  return std::isfinite(time_s) ? time_s : 0;
}

// Of a design that is possible().
BrakedPromise promise(const AxisDesign& axis, const BrakedDesign<float>& design) {
  const BrakedClass& c = *axis.braked;
  const KickPromise kicks{c, design, axis.position_tolerance_m};
  const double fine_m = design.has_fine_stage() ? law::fine_floors_beyond * design.least_tolerance_m : 0;
  BrakedPromise p{.floor_m = design.floor_m,
                  .least_tolerance_m = design.least_tolerance_m,
                  .error_m = error_at_rest_m(c, kicks.reached_m()),
                  .beyond_m = c.reading_error_m() + bent_beyond_m(c, design) + fine_m + sprung_beyond_m(c, design),
                  .reach_m = design.reach_m,
                  .hand_over_m = hand_over_m(design),
                  .most_kicks = kicks.most_kicks(kicks_begin_m(design)),
                  .kicks_s = kicks.most_s(kicks_begin_m(design)),
                  .fine_stage = design.has_fine_stage(),
                  .brake_N = static_cast<double>(design.kicks.brake_N),
                  .kick_peak_m_s = design.peak_speed_m_s,
                  .rest_s = design.kicks.still_periods * c.period_s,
                  .aim_lost = design.aim_lost,
                  .table_bytes = design.table_bytes,
                  .approach_beyond_m = approach_beyond_m(c, design, axis.max_approach_speed_m_s),
                  .approach_peak_m_s = approach_peak_m_s(c, design, axis.max_approach_speed_m_s, axis.longest_way_m),
                  .turning_m = turning_m(c, design, axis.max_approach_speed_m_s, axis.longest_way_m),
                  .farthest_m = farthest_approach_m(c, design, axis.max_approach_speed_m_s),
                  .least_move_s = c.move ? least_move_s(*c.move) : 0,
                  .longest_way_m = axis.longest_way_m,
                  .approach_s = longest_approach_s(axis, design),
                  .promise = {}};
  p.promise = "at rest the true error is at most " + brief_up(p.error_m) + " m, no kick goes more than " +
              brief_up(p.beyond_m) + " m beyond the target, and from " + brief(kicks_begin_m(design)) + " m at most " +
              std::to_string(p.most_kicks) + " kicks are needed, which take " + brief_up(p.kicks_s) + " s at most";
  if (p.fine_stage)
    p.promise += "; below the floor the fine stage aims at " + brief(axis.position_tolerance_m) +
                 " m, which is not promised, and goes beyond the target for it";
  return p;
}

// A certificate takes in all that is said of a machine, or there is none.
std::vector<Check> class_checks(const AxisDesign& axis) {
  constexpr const char* name = "machine_is_within_the_class";
  const std::string source = "what is stated of the machine against what the other checks take in";
  if (axis.outside.empty()) return {{name, true, true, 0, source, "nothing that is stated is outside the class"}};
  std::vector<Check> checks;
  for (const std::string& what : axis.outside) checks.push_back({name, true, false, -1, source, what});
  return checks;
}

std::vector<std::string> reasons_against(const std::vector<Check>& checks) {
  std::vector<std::string> reasons;
  for (const Check& check : checks)
    if (check.required && !check.holds) reasons.push_back(check.name + ": " + check.reason);
  return reasons;
}

std::vector<Check> checks_of_coast(const AxisDesign& axis, const std::optional<BrakedDesign<float>>& braked,
                                   const std::optional<WorkDesign<float>>& work) {
  if (braked) return detail::brake_checks(axis, *braked);
  return work ? detail::work_checks(axis, *work) : std::vector<Check>{};
}

// What [I] assumes is for information where another coast ends the kicks.
std::vector<Check> all_checks(const AxisDesign& axis, const DesignReport& report,
                              const std::optional<BrakedDesign<float>>& braked,
                              const std::optional<WorkDesign<float>>& work) {
  if (!axis.braked && !axis.work) return detail::pd_checks(axis, report);
  std::vector<Check> checks = checks_of_coast(axis, braked, work);
  for (Check& check : detail::pd_checks(axis, report)) {
    // Of the k3 pulses, and of an approach by the spring.
    if (check.name == "tolerance_above_floor" || check.name == "force_breaks_away" ||
        check.name == "approach_gets_on" || check.name == "force_is_fine")
      continue;
    check.required = check.name == "assumption_1";
    checks.push_back(std::move(check));
  }
  return checks;
}

// What an approach keeps, in figures: a reader of the flashed header has no others.
std::string tested_of_approach(const BrakedDesign<float>& design, const BrakedPromise& p) {
  std::string tested = "that one of four approaches ends where kicks begin, within " + brief_up(kicks_begin_m(design)) +
                       " m of the target, and none from rest goes further than " + brief_up(p.approach_beyond_m) +
                       " m beyond it";
  if (std::isfinite(p.approach_peak_m_s)) tested += ", nor faster than " + brief_up(p.approach_peak_m_s) + " m/s";
  return tested;
}

std::vector<std::string> conditions_of_brake(const AxisDesign& axis, const BrakedDesign<float>& design,
                                             const BrakedPromise& promise) {
  const std::string tested =
      "tested, not proved: that a kick goes no further with more lag or less force gain, that the table holds between "
      "its places, and " +
      tested_of_approach(design, promise);
  const BrakedClass& c = *axis.braked;
  std::vector<std::string> conditions{
      "friction stays between " + brief(c.friction.lower_N) + " N and " + brief(c.friction.upper_N) +
          " N at any position, speed and time, as it likes",
      "the moving mass is " + range(c.mass_kg, " kg") + ", and the mechanism is rigid" +
          (c.presliding_stiffness_N_per_m > 0 ? " but for the friction"
           : c.spring_load                    ? " but for the spring"
                                              : ""),
      "the drive gives " + range(c.force_gain, " times the force") +
          " that is commanded, in whole periods, behind a current loop with a time constant of " + range(c.lag_s, " s"),
      "a force beside the drive's is at most " + brief(c.load_N) + " N either way",
      c.encoder_noise_m > 0 ? "a reading is off by half a count and " + brief(c.encoder_noise_m) + " m at most"
                            : "a reading is off by half a count at most",
      whole_counts,
      "samples are taken and forces begin " +
          (c.jitter_s > 0 ? "within " + brief(c.jitter_s) + " s of whole periods, one against another"
                          : std::string{"at whole periods"}) +
          "; no command is lost, and a sample that is lost costs a period",
      "SYNC leaves at the same time of every period, and a frame of somebody else on the wire delays it by at most "
      "[uncertainty] jitter_s = " +
          brief(c.jitter_s) + " s",
      "the axis rests when it is enabled; the speed of one that moves may be seen too late, and its run end by name",
      tested};
  if (std::isfinite(axis.following_error_m))
    conditions.push_back(
        "a target moves only while the axis rests, unless following_error_m leaves it the way to turn");
  if (std::isfinite(promise.approach_peak_m_s) && !c.move)
    conditions.push_back(
        "a target moves only while the axis rests or is approached, unless the limit of its speed leaves room for " +
        brief_up(law::most_taken_over * static_cast<double>(design.kicks.approach.switch_speed_m_s)) +
        " m/s more: an approach that begins under the brake is taken for one that begins at rest");
  if (c.presliding_stiffness_N_per_m > 0)
    conditions.push_back(
        "friction is a spring of " + brief(c.presliding_stiffness_N_per_m) +
        " N/m or stiffer before it slides, by the law of Dahl or LuGre with at most critical damping; "
        "tested, not proved: that the axis settles, how far a kick goes beyond, and how many are needed");
  if (c.spring_load)
    conditions.push_back(
        "the load hangs on a spring of " + brief(c.spring_load->stiffness_N_per_m) +
        " N/m or stiffer, without play, and each side keeps its bounds of friction; the side without the "
        "encoder may rest " +
        brief_up(c.spring_load->unseen_m(c.load_N)) +
        " m from where the other says, whatever the law; tested, not proved: that the axis settles, and "
        "how many kicks are needed");
  if (c.move)
    conditions.push_back(
        "the limits of a move hold until brake and kicks take over, within " + brief_up(promise.hand_over_m) +
        " m of the target, or where friction has stopped four approaches on their way; that of the jerk is of what is "
        "planned; tested, not proved: that the speed stays within its limit to 1 %, also where samples are lost; the "
        "acceleration may exceed its limit where a target moves on under the brake, and back before readings show the "
        "speed");
  return conditions;
}

std::string beyond_under_pd(const PdPromise& p) {
  if (!std::isfinite(p.beyond_m)) return "; an approach and a kick may go beyond the target";
  return ", and neither an approach nor a kick goes further than " + brief_up(p.beyond_m) +
         " m beyond the target, nor an approach faster than " + brief_up(p.approach_peak_m_s) + " m/s";
}

std::vector<std::string> conditions_of_law(const AxisDesign& axis, const std::optional<BrakedDesign<float>>& braked,
                                           const DesignReport& report) {
  // A class for which no kicks are possible has no figures to state, and nothing is certified of it.
  if (axis.braked)
    return report.braked ? conditions_of_brake(axis, *braked, *report.braked) : std::vector<std::string>{};
  if (axis.work && axis.work->spring_load)
    return report.work ? detail::conditions_of_work(axis, *report.work) : std::vector<std::string>{};
  const bool purely_dry = axis.smooth_friction_slope_Ns_per_m == 0;
  std::vector<std::string> conditions{
      "friction stays between " + brief(axis.friction.lower_N) + " N and " + brief(axis.friction.upper_N) +
          " N at any position, speed and time",
      purely_dry ? "during the approach, friction is constant between velocity reversals (Proposition 2); if it rises "
                   "with speed, state [friction] smooth_slope_Ns_per_m, or the approach may creep for ever"
                 : "during the approach, friction is constant dry friction plus a smooth force of the stated slope at "
                   "rest (Proposition 3)",
      "mass, stiffness and damping are as stated, and the mechanism is rigid"};
  if (axis.period_s > 0) {
    conditions.push_back("the drive gives the commanded force within its limit, period by period");
    if (axis.encoder_resolution_m > 0) conditions.emplace_back(whole_counts);
    conditions.emplace_back("the axis rests when it is enabled: one that moves may go further beyond");
    conditions.push_back("tested, not proved: that the sampled loop settles as the ideal law does" +
                         (report.pd ? beyond_under_pd(*report.pd) : std::string{}));
  }
  return conditions;
}

std::vector<std::string> conditions(const AxisDesign& axis, const std::optional<BrakedDesign<float>>& braked,
                                    const DesignReport& report) {
  std::vector<std::string> all = conditions_of_law(axis, braked, report);
  if (axis.sag_m > 0)
    all.push_back(
        "until the drive gives feedforward_N an axis whose brake opens sags by up to " + brief_up(axis.sag_m) +
        " m: it is enabled at least so far from its limits, and ways and times count from when it rests again");
  return all;
}

}  // namespace

DesignReport design_axis(const AxisDesign& axis) {
  require_in_range(axis);
  const double m = axis.mass_kg, k1 = axis.stiffness_N_per_m;
  const KickPlant<double> plant{m, k1, axis.kick_damping_Ns_per_m, axis.friction.lower_N};
  const auto law = K3<double>::make(plant);
  const double c_lower = axis.friction.lower_N / k1, c_upper = axis.friction.upper_N / k1;
  const auto built = build_k3_table<float>(plant, c_upper);
  const auto least_damping = least_damping_for_18(m, k1, axis.friction);

  DesignReport report{
      .zeta_approach = damping_ratio(m, k1, axis.approach_damping_Ns_per_m),
      .zeta_kick = damping_ratio(m, k1, axis.kick_damping_Ns_per_m),
      .c_lower_m = c_lower,
      .c_upper_m = c_upper,
      .largest_impulse_Ns = law.impulse_Ns(-c_upper),
      .accuracy_floor_m = accuracy_floor_m(m, axis.friction, axis.period_s),
      .finite_time_bound_s = finite_time_bound_s(m, axis.friction, c_lower),
      .contraction_per_kick = axis.friction.gap(),
      .ratio = axis.friction.ratio(),
      .ratio_threshold_18 = ratio_threshold_18(law.unit()),
      .exact_ratio_threshold = exact_ratio_threshold(law.unit()),
      .least_damping_Ns_per_m = least_damping ? *least_damping : std::numeric_limits<double>::quiet_NaN(),
      .table_bytes = built.size_bytes,
      .table_proved_error = built.proved_error,
      .table_measured_error = measured_error(built.table, plant),
      .checks = {},
      .braked = {},
      .work = {},
      .pd = {},
      .certified = false,
      .reasons = {},
      .conditions = {},
  };
  std::optional<BrakedDesign<float>> braked;
  if (axis.braked) braked = design_braked_kicks<float>(*axis.braked);
  std::optional<WorkDesign<float>> work;
  if (axis.work && axis.work->spring_load) work = design_work_kicks<float>(*axis.work, axis.max_approach_speed_m_s);
  report.checks = all_checks(axis, report, braked, work);
  for (Check& check : class_checks(axis)) report.checks.push_back(std::move(check));
  if (braked && braked->possible()) report.braked = promise(axis, *braked);
  if (work && work->possible()) report.work = detail::work_promise(axis, *work);
  report.reasons = reasons_against(report.checks);
  const bool is_sampled = axis.period_s > 0 && axis.encoder_resolution_m > 0;
  if (report.reasons.empty() && !axis.braked && !axis.work && is_sampled) {
    report.pd = detail::try_pd(axis, built.table);
    report.checks.push_back(detail::tried_check(*report.pd));
    report.checks.push_back(detail::near_end_check(report, *report.pd));
    report.checks.push_back(detail::few_kicks_check(*report.pd));
    report.reasons = reasons_against(report.checks);
  }
  report.conditions = conditions(axis, braked, report);
  report.certified = report.reasons.empty();
  return report;
}

}  // namespace breakaway::design
