#include "pd_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "breakaway/law/rest_detector.hpp"
#include "breakaway/law/velocity_estimator.hpp"
#include "breakaway/stability/attractivity.hpp"
#include "brief.hpp"
#include "check.hpp"
#include "pd_trial.hpp"

namespace breakaway::design {
namespace {

using detail::below;
using detail::Equality;

// A check of the friction ratio against a threshold, for information.
Check above(std::string name, std::string source, double ratio, double threshold) {
  const bool holds = ratio > threshold;
  std::string reason = "friction_lower_N / friction_upper_N = " + brief(ratio) + (holds ? " is" : " is not") +
                       " above " + brief(threshold);
  if (!holds) reason += "; raise the damping k22 or narrow the friction bounds";
  return {std::move(name), false, holds, ratio - threshold, std::move(source), std::move(reason)};
}

// Propositions 2 and 3 cover different friction: the one that fits the axis is required. (17) and (18) are sufficient
// for Assumption 3, the exact threshold is necessary too.
std::vector<Check> assumption_checks(const AxisDesign& axis, const DesignReport& report) {
  const law::FrictionBounds<double>& friction = axis.friction;
  Check assumption_1{
      "assumption_1",
      true,
      true,
      friction.upper_N - friction.lower_N,
      "[I] Assumption 1",
      "0 < friction_lower_N = " + brief(friction.lower_N) + " <= friction_upper_N = " + brief(friction.upper_N)};
  const double critical = 2 * std::sqrt(axis.stiffness_N_per_m) * std::sqrt(axis.mass_kg);
  const std::string remedy = "lower the approach damping k21";
  Check proposition_2 =
      below("assumption_2_proposition_2", "[I] Proposition 2 (friction constant between velocity reversals)",
            report.zeta_approach, 1, "zeta = k21 / (2 sqrt(k1 m)) against 1", remedy);
  Check proposition_3 =
      below("assumption_2_proposition_3", "[I] Proposition 3 (constant dry friction and a smooth one)",
            axis.approach_damping_Ns_per_m + axis.smooth_friction_slope_Ns_per_m, critical,
            "k21 + smooth friction slope against 2 sqrt(k1 m)", remedy);
  const bool purely_dry = axis.smooth_friction_slope_Ns_per_m == 0;
  proposition_2.required = purely_dry;
  proposition_3.required = !purely_dry;
  Check exact = above("assumption_3_exact", "a kick from c_upper under friction_upper_N ends in the inner stick set",
                      report.ratio, report.exact_ratio_threshold);
  exact.required = true;
  return {std::move(assumption_1),
          std::move(proposition_2),
          std::move(proposition_3),
          above("assumption_3_eq_17", "[I] (17)", report.ratio, ratio_threshold_17),
          above("assumption_3_eq_18", "[I] (18)", report.ratio, report.ratio_threshold_18),
          std::move(exact)};
}

// The approach is a machine of one coordinate: [A] says whether it comes to rest, and from where.
Check rest_check(const AxisDesign& axis) {
  const double damping = axis.approach_damping_Ns_per_m + axis.smooth_friction_slope_Ns_per_m;
  const auto scalar = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
  const stability::Attractivity rest =
      stability::certify_attractivity({scalar(axis.mass_kg), scalar(damping), scalar(axis.stiffness_N_per_m), scalar(1),
                                       Eigen::VectorXd::Constant(1, axis.friction.lower_N)});
  const bool from_everywhere = rest.certified && std::isinf(rest.rho_star_J);
  return {"approach_comes_to_rest",
          true,
          from_everywhere,
          damping,
          "[A] Theorem 1 and remark 4",
          "k21 + smooth friction slope = " + brief(damping) + " N s/m" +
              (from_everywhere ? ": the approach comes to rest from everywhere"
                               : ", so the approach comes to rest from within " + brief(rest.rho_star_J) +
                                     " J only; raise the approach damping k21")};
}

Check encoder_check(const AxisDesign& axis) {
  return below("tolerance_above_encoder_resolution", "one encoder count is the least error that can be seen",
               axis.encoder_resolution_m, axis.position_tolerance_m,
               "encoder_resolution_m against position_tolerance_m", "widen the tolerance or use a finer encoder",
               Equality::holds);
}

Check table_check(const DesignReport& report) {
  // A kick moves the axis by about its square: an impulse off by e is a displacement off by 2 e, which adds to the
  // error 1 - f_lower / f_upper that a kick may leave. The sum must stay below 1.
  return below("table_keeps_contraction", "a kick must leave less error than it found", 2 * report.table_proved_error,
               report.ratio, "twice the k3 table's relative error against friction_lower_N / friction_upper_N",
               "lower the damping k22 or narrow the friction bounds");
}

// Total force of the least kick: of one period, and over the least distance that is read beyond the tolerance.
double least_kick_N(const AxisDesign& axis) {
  const double q = axis.encoder_resolution_m, tolerance_m = axis.position_tolerance_m;
  const double distance_m = q > 0 ? q * (std::floor(tolerance_m / q) + 1) : tolerance_m;
  const double A = axis.friction.lower_N, T = axis.period_s;
  return (A + std::sqrt(A * A + 8 * axis.mass_kg * A * distance_m / (T * T))) / 2;
}

// With a force that grows with the current loop, that kick must break away in time.
Check lag_check(const AxisDesign& axis, const std::string& brake) {
  const double least_N = least_kick_N(axis);
  return below(
      "least_kick_outlasts_the_lag",
      "tested, not proved: behind the current loop the least kick must break away within half its period",
      axis.friction.upper_N / -std::expm1(-axis.period_s / (2 * axis.current_loop_lag_s)), least_N,
      "friction_upper_N over the share of its force that the current loop reaches in half a period, against the "
      "force of the least kick",
      std::string{"widen the tolerance"} + (least_N < axis.friction.upper_N ? "" : ", or take a faster current loop") +
          brake,
      Equality::holds);
}

// Periods over which the law's velocity is smoothed, because the encoder is coarse for its damping.
double smoothing_periods(const AxisDesign& axis) {
  const law::VelocityEstimator<double> velocity{axis.period_s, axis.encoder_resolution_m, axis.kick_damping_Ns_per_m,
                                                axis.friction.lower_N};
  return 1 / velocity.weight();
}

// The share of a speed that is damped too late.
double late_damping(const AxisDesign& axis) {
  const double delay_s = axis.current_loop_lag_s + (axis.latency_ticks + smoothing_periods(axis)) * axis.period_s;
  return axis.kick_damping_Ns_per_m * delay_s / axis.mass_kg;
}
constexpr double most_late_damping = 0.2;

// Each of them alone. A shorter period makes counts coarser for the velocity, which is smoothed for as long then.
std::string ways_to_damp_in_time(const AxisDesign& axis) {
  AxisDesign finely_read = axis, often_sampled = axis, soon_answered = axis;
  finely_read.encoder_resolution_m = 0;
  often_sampled.period_s = std::max(axis.least_period_s, 1e-3 * axis.period_s);
  soon_answered.latency_ticks = 0;
  std::string ways = "lower k22 (and k1 with it, to keep zeta)";
  if (late_damping(finely_read) < most_late_damping) ways += ", or use a finer encoder";
  if (late_damping(often_sampled) < most_late_damping) ways += ", or shorten the period";
  if (late_damping(soon_answered) < most_late_damping) ways += ", or shorten the latency";
  return ways;
}

// What random axes need to settle in closed loop, and what sufficed for all of them: tests/campaign.
std::vector<Check> loop_checks(const AxisDesign& axis) {
  const double smoothing = smoothing_periods(axis);
  const std::string brake = "; or take coast = \"brake\"";
  std::vector<Check> checks{
      below("damping_tolerates_delay", "tested, not proved: damping that acts late must brake, not push",
            late_damping(axis), most_late_damping,
            "k22 (latency, smoothing of the velocity and current loop) / mass_kg against 0.2",
            ways_to_damp_in_time(axis) + brake),
      below("velocity_is_seen", "tested, not proved: the velocity must not lag behind the motion of a kick", smoothing,
            10, "periods over which the encoder has the velocity smoothed against 10",
            "use a finer encoder, or lower k22" + brake, Equality::holds),
      below("current_loop_is_fast", "tested, not proved: a pulse of one period must reach its force",
            axis.current_loop_lag_s, 0.2 * axis.period_s, "current_loop_time_constant_s against a fifth of period_s",
            "take a longer period" + brake, Equality::holds),
      below("friction_bounds_are_apart", "tested, not proved: a kick that did not move is raised by 2 %",
            axis.friction.ratio(), 0.98, "friction_lower_N / friction_upper_N against 0.98",
            "state wider bounds" + brake, Equality::holds)};
  if (axis.current_loop_lag_s > 0) checks.push_back(lag_check(axis, brake));
  return checks;
}

// At its greatest speed V the spring pulls with k21 V and no more, which must move the axis wherever it stands; and so
// that it is not taken for stuck, it must show a count within half of the law's patience from rest, and two on its way.
// Where it stood, far from the target, it would be kicked from there with all that the table and the drive have.
Check approach_check(const AxisDesign& axis) {
  constexpr double surely =
      1.2;  // against what one count makes of the damping force, a twentieth of the least friction
  const double patience_s = law::RestDetector<float>::patience * axis.period_s, q = axis.encoder_resolution_m;
  const double seen_N = patience_s > 0 ? axis.mass_kg * 8 * q / (patience_s * patience_s) : 0;
  const double seen_m_s = patience_s > 0 ? 2 * q / patience_s : 0;
  const auto needed_m_s = [&](double k21) { return (surely * axis.friction.upper_N + seen_N) / k21 + seen_m_s; };
  const double most_k21 = 2 * std::sqrt(axis.stiffness_N_per_m) * std::sqrt(axis.mass_kg);  // its zeta is below 1
  const bool damping_may_do = needed_m_s(most_k21) < axis.max_approach_speed_m_s;
  return below(
      "approach_gets_on", "the spring that is limited for the sake of speed must still move the axis",
      needed_m_s(axis.approach_damping_Ns_per_m), axis.max_approach_speed_m_s,
      "the speed that an approach must be allowed, friction_upper_N / k21 and what its count asks for, against "
      "max_approach_speed_m_s, and nine tenths of [limits] speed_m_s",
      std::string{damping_may_do ? "raise these or k21" : "raise these"} + ", or take coast = \"brake\"",
      Equality::holds);
}

// The force is off what the law asks for by half a step, which acts as that much less or more friction: see
// pd_trial.hpp. Beside what friction may vary by it must be little, or the least kicks go to and fro over the target.
Check step_check(const AxisDesign& axis) {
  constexpr double steps_of_friction = 8;
  const double varies_N = axis.friction.upper_N - axis.friction.lower_N;
  return below("force_is_fine", "tested, not proved: what sufficed for all of many axes behind drives of coarse steps",
               steps_of_friction * axis.force_step_N, std::min(axis.friction.lower_N, varies_N),
               "eight steps of the drive's force against friction_lower_N, and what friction_upper_N is above it",
               "use a drive with a finer step of force, or take coast = \"brake\"", Equality::holds);
}

std::vector<Check> sampling_checks(const AxisDesign& axis, const DesignReport& report) {
  const double floor_at_best_m = accuracy_floor_m(axis.mass_kg, axis.friction, axis.least_period_s);
  return {
      below("force_breaks_away",
            "a pulse below the upper friction bound may not move the axis; tested, not proved: one that hardly does is "
            "long, and friction that falls meanwhile leads it far beyond",
            1.5 * axis.friction.upper_N, axis.max_force_N, "one and a half times friction_upper_N against max_force_N",
            "use a stronger drive or reduce the friction, or take coast = \"brake\"", Equality::holds),
      below("tolerance_above_floor",
            "least sure step of a one-period pulse, f_upper (f_upper - f_lower) Ts^2 / (2 m f_lower)",
            report.accuracy_floor_m, axis.position_tolerance_m, "accuracy floor against position_tolerance_m",
            std::string{"widen the tolerance"} + (floor_at_best_m > axis.position_tolerance_m
                                                      ? ""
                                                      : " or shorten the period (the floor falls with its square)"),
            Equality::holds),
  };
}

}  // namespace

namespace detail {

std::vector<Check> pd_checks(const AxisDesign& axis, const DesignReport& report) {
  std::vector<Check> checks = assumption_checks(axis, report);
  checks.push_back(rest_check(axis));
  checks.push_back(table_check(report));
  if (axis.max_approach_speed_m_s < std::numeric_limits<double>::infinity()) checks.push_back(approach_check(axis));
  if (axis.encoder_resolution_m > 0) checks.push_back(encoder_check(axis));
  if (axis.period_s > 0) {
    for (Check& check : sampling_checks(axis, report)) checks.push_back(std::move(check));
    for (Check& check : loop_checks(axis)) checks.push_back(std::move(check));
    if (axis.force_step_N > 0) checks.push_back(step_check(axis));
  }
  return checks;
}

Check tried_check(const PdPromise& pd) {
  const std::string most = std::to_string(most_tried_periods) + " periods";
  return {"axis_is_tried",
          true,
          pd.is_tried,
          pd.is_tried ? 1.0 : -1.0,
          "tested, not proved: how far, how fast and how long an axis goes is what the law does in trials",
          pd.is_tried ? "trials of its approach and its kicks end within " + most
                      : "trials of its approach and its kicks do not end within " + most +
                            "; take a longer period, or coast = \"brake\""};
}

// Further away there is no force at rest that friction could hold: the law has not seen that the axis moves.
Check near_end_check(const DesignReport& report, const PdPromise& pd) {
  constexpr double surely = 1.25;  // just outside hardly any force is left of the spring
  return below(
      "approach_ends_near", "tested, not proved: kicks begin where friction may hold the axis", pd.left_m,
      surely * report.c_upper_m,
      "the distance at which an approach ends in its trial against one and a quarter of the maximal stick set",
      "state nearer [limits] of position, from which a float shows that the axis sets off, or take coast = \"brake\"",
      Equality::holds);
}

Check few_kicks_check(const PdPromise& pd) {
  return below("kicks_are_few", "tested, not proved: the law needs few of the kicks it has", pd.most_kicks,
               most_tried_kicks(), "kicks that are needed at most against four fifths of what the law gives",
               "use a stronger drive, widen the tolerance, or take coast = \"brake\"", Equality::holds);
}

}  // namespace detail

}  // namespace breakaway::design
