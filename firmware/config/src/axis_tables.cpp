#include "axis_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "read_drive.hpp"
#include "read_odrive.hpp"
#include "read_told.hpp"
#include "surroundings.hpp"

namespace breakaway::config {
namespace {

constexpr Range not_negative{0, 1e12};

void require_ordered(const Section& section, std::string_view lower, double low, std::string_view upper, double up) {
  if (low <= up) return;
  section.fail(lower, fmt::format("is {} and exceeds {} = {}; swap or correct them", low, upper, up));
}

// Of a coefficient, whose product with the normal force may be none.
void require_force(const Section& section, std::string_view key, double force_N) {
  if (positive.holds(force_N)) return;
  section.fail(key, fmt::format("times [plant] mass_kg times gravity_m_s2 is {} N, must be {} {:g} N; {} one of them",
                                force_N, force_N > 0 ? "at most" : "above", force_N > 0 ? positive.most : 0.0,
                                force_N > 0 ? "lower" : "raise"));
}

// Friction is given either in newtons, or as the paper's coefficients with the gravity that makes them newtons.
Friction read_friction(const Section& section, double mass_kg, std::vector<Key> others) {
  Friction f;
  const bool coefficients = section.has("mu_lower") || section.has("mu_upper") || section.has("gravity_m_s2");
  const std::string_view lower = coefficients ? "mu_lower" : "lower_N", upper = coefficients ? "mu_upper" : "upper_N";
  const std::string_view unit = coefficients ? "" : "N";
  double gravity_m_s2 = 0;
  std::vector<Key> keys{
      optional("presliding_stiffness_N_per_m", number(f.presliding_stiffness_N_per_m, "N/m", positive)),
      optional("smooth_slope_Ns_per_m", number(f.smooth_slope_Ns_per_m, "N s/m", {-1e12, 1e12})),
      required(lower, number(f.bounds.lower_N, unit, positive)),
      required(upper, number(f.bounds.upper_N, unit, positive)),
  };
  if (coefficients) keys.push_back(required("gravity_m_s2", number(gravity_m_s2, "m/s^2", positive)));
  section.read(keys + std::move(others));
  require_ordered(section, lower, f.bounds.lower_N, upper, f.bounds.upper_N);
  if (coefficients) {
    f.normal_force_N = mass_kg * gravity_m_s2;
    f.bounds.lower_N *= *f.normal_force_N;
    f.bounds.upper_N *= *f.normal_force_N;
    require_force(section, lower, f.bounds.lower_N);
    require_force(section, upper, f.bounds.upper_N);
  }
  return f;
}

TargetChange read_target(const Section& section) {
  TargetChange change;
  section.read({
      required("time_s", number(change.time_s, "s", not_negative)),
      required("position_m", number(change.position_m, "m", anywhere)),
  });
  return change;
}

Key kick_key(ImpulsiveGains& gains) {
  return optional("kick",
                  choice(gains.kick, {{"ideal", Kick::ideal}, {"two_phase", Kick::two_phase}, {"naive", Kick::naive}}));
}

std::vector<Key> gain_keys(ImpulsiveGains& gains) {
  return {
      required("k1_N_per_m", number(gains.stiffness_N_per_m, "N/m", positive)),
      required("k21_Ns_per_m", number(gains.approach_damping_Ns_per_m, "N s/m", positive)),
      required("k22_Ns_per_m", number(gains.kick_damping_Ns_per_m, "N s/m", positive)),
      kick_key(gains),
      optional("fine_stage", boolean(gains.fine_stage)),
      optional("coast",
               choice(gains.coast, {{"pd", law::Coast::pd}, {"brake", law::Coast::brake}, {"work", law::Coast::work}})),
      optional("feedforward_N", number(gains.feedforward_N, "N", anywhere)),
  };
}

std::vector<Key> gain_keys(PidGains& gains) {
  return {
      required("kp_N_per_m", number(gains.proportional_N_per_m, "N/m", positive)),
      required("ki_N_per_ms", number(gains.integral_N_per_ms, "N/(m s)", not_negative)),
      required("kd_Ns_per_m", number(gains.derivative_Ns_per_m, "N s/m", positive)),
  };
}

// What holds unless the file says otherwise. The coast "brake" needs whole periods and steps of force, and has kicks of
// its own.
ImpulsiveGains usual_gains(const Section& section, bool sampled, bool driven) {
  ImpulsiveGains gains{.kick = sampled ? Kick::two_phase : Kick::ideal};
  section.read_alone(kick_key(gains));
  if (sampled && driven && gains.kick != Kick::naive) gains.coast = law::Coast::brake;
  return gains;
}

Controller read_controller(const Section& section, bool sampled, bool driven, std::vector<Key> others) {
  Controller controller;
  bool is_pid = false;
  const Key kind = optional("kind", choice(is_pid, {{"impulsive", false}, {"pid", true}}));
  section.read_alone(kind);
  if (is_pid) controller.pid.emplace();
  if (!is_pid) controller.impulsive = usual_gains(section, sampled, driven);
  // Once it is decided, a `kind` that is there can be one only.
  const Key decided = is_pid ? required("kind", choice(is_pid, {{"pid", true}}))
                             : optional("kind", choice(is_pid, {{"impulsive", false}}));
  const std::vector<Key> common{
      decided,
      optional("max_force_N", number(controller.max_force_N, "N", positive)),
      optional("max_approach_speed_m_s", number(controller.max_approach_speed_m_s, "m/s", positive)),
      optional("position_tolerance_m", number(controller.position_tolerance_m, "m", not_negative)),
      optional("target_m", number(controller.target_m, "m", anywhere)),
      optional("targets", tables([&](const Section& entry) { controller.targets.push_back(read_target(entry)); })),
  };
  section.read((is_pid ? gain_keys(*controller.pid) : gain_keys(*controller.impulsive)) + common + std::move(others));
  if (!std::ranges::is_sorted(controller.targets, {}, &TargetChange::time_s)) {
    section.fail("targets", "are not in order of time_s; sort them");
  }
  return controller;
}

// These rules hold between the keys of the law of [I]. zeta = k2 / (2 sqrt(k1 m)).
void check_gains(const Section& section, const ImpulsiveGains& gains, double mass_kg, bool told, bool sampled) {
  const double critical = 2 * std::sqrt(gains.stiffness_N_per_m * mass_kg);
  const auto refuse = [&](std::string_view key, double value, std::string_view rule) {
    section.fail(key,
                 fmt::format("is {}, so zeta = {:.6g}{}; {} 2 sqrt(k1 m) = {:.6g} N s/m", value, value / critical,
                             told ? fmt::format(" with the [told] mass of {:g} kg", mass_kg) : "", rule, critical));
  };
  const double k21 = gains.approach_damping_Ns_per_m, k22 = gains.kick_damping_Ns_per_m;
  if (!(k21 < critical)) refuse("k21_Ns_per_m", k21, "the approach needs zeta < 1: lower it below");
  if (!(k22 > critical)) refuse("k22_Ns_per_m", k22, "the kicks need zeta > 1: raise it above");
  if (sampled && gains.kick == Kick::ideal) {
    section.fail("kick", "must be \"two_phase\" or \"naive\" with a [loop]: a sampled kick takes time");
  }
  if (!sampled && gains.coast != law::Coast::pd)
    section.fail("coast", fmt::format("is \"{}\", which takes whole periods of a [loop]; give one, or \"pd\"",
                                      gains.coast == law::Coast::brake ? "brake" : "work"));
}

Uncertainty read_uncertainty(const Section& section, const Friction& friction, double period_s) {
  constexpr Range relative{0, 0.9};
  Uncertainty u;
  section.read({
      optional("mass", number(u.mass, "", relative)),
      optional("force_gain", number(u.force_gain, "", relative)),
      optional("force_N", number(u.force_N, "N", not_negative)),
      optional("current_loop_time_constant", number(u.current_loop_time_constant, "", relative)),
      optional("jitter_s", number(u.jitter_s, "s", up_to_a_second)),
      optional("encoder_noise_m", number(u.encoder_noise_m, "m", {0, 1})),
  });
  if (u.jitter_s > design::most_jitter * period_s)
    section.fail("jitter_s",
                 fmt::format("is {:g}, more than half the period of {:g} s, so that no pulse is sure to last; "
                             "take a longer [loop] period_s, or a bus that delays more evenly",
                             u.jitter_s, period_s));
  if (u.force_N >= friction.bounds.lower_N)
    section.fail("force_N", fmt::format("is {:g}, not below the least friction of {:g} N, so that nothing holds the "
                                        "axis at rest; feed a known force forward, or narrow its bounds",
                                        u.force_N, friction.bounds.lower_N));
  return u;
}

Move read_move(const Section& section, const Controller& controller) {
  Move move;
  section.read({
      required("distance_m", number(move.distance_m, "m", positive)),
      required("speed_m_s", number(move.speed_m_s, "m/s", positive)),
      required("acceleration_m_s2", number(move.acceleration_m_s2, "m/s^2", positive)),
      optional("jerk_m_s3", number(move.jerk_m_s3, "m/s^3", positive)),
  });
  if (!controller.impulsive || controller.impulsive->coast != law::Coast::brake)
    section.fail("speed_m_s",
                 "is for the coast \"brake\", the only one that keeps to it; set [controller] coast = \"brake\"");
  return move;
}

// Kicks below the floor are those of the coast "brake".
void check_fine_stage(const Section& controller, const Axis& axis) {
  if (!axis.controller.impulsive || !controller.has("fine_stage")) return;
  if (axis.controller.impulsive->coast != law::Coast::brake)
    controller.fail("fine_stage", "is of the coast \"brake\"; set coast = \"brake\", or leave it out");
}

// What friction does before it slides is for the coast "brake" to know.
void check_presliding(const Section& friction, const Axis& axis) {
  if (axis.friction.presliding_stiffness_N_per_m == 0) return;
  if (!axis.controller.impulsive || axis.controller.impulsive->coast != law::Coast::brake)
    friction.fail("presliding_stiffness_N_per_m",
                  "is for the coast \"brake\", the only one that ends on a spring; set [controller] coast = \"brake\"");
}

Limits read_limits(const Section& section) {
  Limits limits;
  std::optional<double> both_m, least_m, most_m;
  hal::Duration feedback_timeout{};
  section.read({
      optional("position_m", number(both_m, "m", positive)),
      optional("position_min_m", number(least_m, "m", anywhere)),
      optional("position_max_m", number(most_m, "m", anywhere)),
      optional("speed_m_s", number(limits.speed_m_s, "m/s", positive)),
      optional("force_N", number(limits.force_N, "N", positive)),
      optional("following_error_m", number(limits.following_error_m, "m", positive)),
      optional("feedback_timeout_s", duration_s(feedback_timeout, {1e-6, 60})),
  });
  if (both_m && (least_m || most_m))
    section.fail("position_m", "stands beside position_min_m or position_max_m; give it alone, or those two");
  limits.position_min_m = both_m ? -*both_m : least_m.value_or(-unlimited);
  limits.position_max_m = both_m ? *both_m : most_m.value_or(unlimited);
  if (!(limits.position_min_m < limits.position_max_m))
    section.fail("position_min_m", "is not below position_max_m; swap or correct them");
  if (feedback_timeout > hal::Duration::zero()) limits.feedback_timeout = feedback_timeout;
  return limits;
}

// Between limits that are counted, so is every error of position.
void check_counted(const Section& section, const Axis& axis) {
  const auto finite = [](double position_m) { return std::isfinite(position_m) ? position_m : 0; };
  const double least_m = finite(axis.limits.position_min_m), most_m = finite(axis.limits.position_max_m);
  const double widest_m = std::max({std::abs(least_m), std::abs(most_m), most_m - least_m});
  if (is_counted(widest_m, axis)) return;
  const char* key = section.has("position_m")       ? "position_m"
                    : section.has("position_max_m") ? "position_max_m"
                                                    : "position_min_m";
  const double count_m = axis.drive->encoder_resolution_m;
  section.fail(key, fmt::format("makes a range of {:g} m, and 32 bits count less than {:.4g} m of encoder_resolution_m "
                                "= {:g}; narrow the range, or take a unit above {:.3g} m",
                                widest_m, counted_m(axis), count_m, rounded_up(widest_m / 0x1p31, 3)));
}

// What a lawful motion needs must not stop the axis.
void check_limits(const Section& section, const Axis& axis, const Node& node) {
  const auto require = [&](bool holds, std::string_view key, double limit, std::string_view what, double least) {
    if (holds) return;
    const auto [limit_text, least_text] = compared(limit, least);
    section.fail(key, fmt::format("is {}, below {} = {}, which the controller needs; raise the one or lower the other",
                                  limit_text, what, least_text));
  };
  check_counted(section, axis);
  const Limits& l = axis.limits;
  const Controller& c = axis.controller;
  const double force_N = max_force_N(axis);
  const bool by_drive = force_N < c.max_force_N;
  require(l.force_N >= force_N, "force_N", l.force_N, by_drive ? "what the [drive] gives" : "[controller] max_force_N",
          force_N);
  if (c.max_approach_speed_m_s < unlimited)
    require(l.speed_m_s >= c.max_approach_speed_m_s, "speed_m_s", l.speed_m_s, "[controller] max_approach_speed_m_s",
            c.max_approach_speed_m_s);
  require(l.following_error_m >= c.position_tolerance_m, "following_error_m", l.following_error_m,
          "[controller] position_tolerance_m", c.position_tolerance_m);
  if (node.loop && l.feedback_timeout)
    require(*l.feedback_timeout >= node.loop->period, "feedback_timeout_s", hal::seconds(*l.feedback_timeout),
            "[loop] period_s", node.period_s());
}

// The supervisor must not stop a move on its way.
void check_move(const Section& section, const Axis& axis) {
  const Move& move = *axis.move;
  constexpr double margin = 1.01;  // of the speed, which the supervisor takes from two readings
  const double least_m_s = margin * move.speed_m_s;
  if (axis.limits.speed_m_s < least_m_s) {
    const auto [asked, limit] = compared(move.speed_m_s, axis.limits.speed_m_s);
    section.fail("speed_m_s",
                 fmt::format("is {}, and [limits] speed_m_s is {}, which must be 1 % above; raise that to {}", asked,
                             limit, brief(rounded_up(least_m_s, 6))));
  }
  const double room_m = axis.limits.position_max_m - axis.limits.position_min_m;
  if (move.distance_m > room_m) {
    const auto [asked, room] = compared(move.distance_m, room_m);
    section.fail("distance_m",
                 fmt::format("is {}, more than the {} m between the [limits] of position; lower it", asked, room));
  }
}

void check_targets(const Section& section, const Axis& axis) {
  const auto require = [&](const char* key, double position_m) {
    if (const std::string problem = target_problem(position_m, axis); !problem.empty())
      section.fail(key, fmt::format("= {} m {}", position_m, problem));
  };
  require("target_m", axis.controller.target_m);
  double least_m = axis.controller.target_m, most_m = least_m;
  for (const TargetChange& change : axis.controller.targets) {
    require("targets", change.position_m);
    least_m = std::min(least_m, change.position_m);
    most_m = std::max(most_m, change.position_m);
  }
  if (!is_counted(most_m - least_m, axis))
    section.fail("targets",
                 fmt::format("are {:g} m apart, more than 32 bits count of encoder_resolution_m; choose them "
                             "closer together, or take a larger unit",
                             most_m - least_m));
}

// The drive must give what the law may ask for.
void check_force(const Section& section, const Axis& axis) {
  if (!axis.drive || axis.controller.max_force_N == unlimited) return;
  const double given_N = axis.drive->max_force_N();
  if (axis.controller.max_force_N <= given_N * (1 + 1e-12)) return;
  const auto [asked, given] = compared(axis.controller.max_force_N, given_N);
  section.fail("max_force_N", fmt::format("is {}, but the [drive] gives {} N at most: lower it, or give the drive more "
                                          "torque",
                                          asked, given));
}

// What is given against a known force is not there for the law.
void check_feedforward(const Section& section, const Axis& axis) {
  if (!axis.controller.impulsive || axis.controller.impulsive->feedforward_N == 0) return;
  if (!axis.drive)
    section.fail("feedforward_N", "takes a drive that gives it; give the axis a [drive], or leave it out");
  if (law_force_N(axis) > axis.friction.bounds.upper_N) return;
  section.fail(
      "feedforward_N",
      fmt::format("is {:g}, which of {:.6g} N leaves {:.6g} N, not above the upper friction bound of {:.6g} N; "
                  "raise max_force_N, or let a counterweight carry more",
                  axis.controller.impulsive->feedforward_N, max_force_N(axis), law_force_N(axis),
                  axis.friction.bounds.upper_N));
}

// A drive that counts torque in its largest one is told that in whole per mille of the rated torque.
void check_largest(const Section& section, const Axis& axis) {
  const double asked_N = axis.controller.max_force_N, upper_N = axis.friction.bounds.upper_N;
  if (!axis.controller.impulsive || !axis.drive || max_force_N(axis) > upper_N || !(asked_N > upper_N)) return;
  section.fail(
      "max_force_N",
      fmt::format("comes to {:.6g} N, not above the upper friction bound of {:.6g} N: the largest torque of the "
                  "[drive] is in whole per mille of the rated one, {:.6g} N each; raise it to a whole number of "
                  "these",
                  max_force_N(axis), upper_N, axis.drive->force_quantum_N()));
}

// A force below one step is none.
void check_step(const Section& section, const Axis& axis) {
  if (!axis.controller.impulsive || !axis.drive || law_force_N(axis) >= force_step_N(axis) * (1 - 1e-6)) return;
  section.fail(
      "max_force_N",
      fmt::format("leaves the law {:.6g} N, and the [drive] has steps of {:.6g} N; raise it, or take a drive with "
                  "finer steps",
                  law_force_N(axis), axis.drive->force_quantum_N()));
}

}  // namespace

std::vector<Key> AxisTables::rows() {
  // They are the same tables at the top of a file and in an entry of [[axis]].
  const auto keep = [](const char* name, std::optional<Section>& to) {
    return table([&to](const Section& part) { to = part; }, name);
  };
  return {required_later("plant", keep("plant", plant_)),
          required_later("friction", keep("friction", friction_)),
          required_later("controller", keep("controller", controller_)),
          optional("drive", keep("drive", drive_)),
          optional("limits", keep("limits", limits_)),
          optional("told", keep("told", told_)),
          optional("uncertainty", keep("uncertainty", uncertainty_)),
          optional("move", keep("move", move_))};
}

void AxisTables::look_around(Surroundings& surroundings) const {
  const auto look = [&](const std::optional<Section>& section, std::string_view table) {
    if (section) look_at(*section, table, surroundings);
  };
  look(plant_, "plant"), look(friction_, "friction"), look(controller_, "controller"), look(drive_, "drive");
  look(limits_, "limits"), look(told_, "told"), look(uncertainty_, "uncertainty"), look(move_, "move");
}

// The next axis of the node. A table that is missing is missed only after those before it were read, so that a
// misspelt key in the first table is what an unfinished file is told of.
Axis AxisTables::read(const Section& parent, std::string name, const Node& node, const FileRows& others) const {
  const auto need = [&](const std::optional<Section>& part, const char* key) -> const Section& {
    if (!part) parent.fail(key, "is missing; give it a table");
    return *part;
  };
  const bool sampled = node.loop.has_value();
  const std::size_t place = node.axes.size();
  Axis axis;
  axis.name = std::move(name);
  const AxisRows also = others.axis ? others.axis(place) : AxisRows{};
  need(plant_, "plant").read(std::vector<Key>{required("mass_kg", number(axis.mass_kg, "kg", positive))} + also.plant);
  axis.friction = read_friction(need(friction_, "friction"), axis.mass_kg, also.friction);
  axis.controller = read_controller(need(controller_, "controller"), sampled, drive_.has_value(), also.controller);
  if (drive_) axis.drive = read_drive(*drive_, place, node, also.drive);
  if (drive_) check_in_node(*drive_, *axis.drive, node);
  if (told_) read_told(*told_, axis);
  if (uncertainty_) axis.uncertainty = read_uncertainty(*uncertainty_, axis.friction, node.period_s());
  if (limits_) axis.limits = read_limits(*limits_);
  if (drive_) take_in_spacing(*drive_, limits_, axis);
  if (move_) axis.move = read_move(*move_, axis.controller);
  check_presliding(*friction_, axis);
  check_fine_stage(*controller_, axis);
  check_force(*controller_, axis);
  check_largest(*controller_, axis);
  check_feedforward(*controller_, axis);
  check_step(*controller_, axis);
  if (axis.controller.impulsive && axis.controller.impulsive->coast != law::Coast::pd && !drive_)
    controller_->fail("coast", fmt::format("is \"{}\", which counts in the steps of a drive's force; give the axis a "
                                           "[drive]",
                                           axis.controller.impulsive->coast == law::Coast::brake ? "brake" : "work"));
  if (axis.controller.impulsive)
    check_gains(*controller_, *axis.controller.impulsive, axis.mass_kg, truth_of(axis).mass_kg != axis.mass_kg,
                sampled);
  if (limits_) check_limits(*limits_, axis, node);
  if (move_) check_move(*move_, axis);
  check_targets(*controller_, axis);
  look_around(axis.surroundings);
  return axis;
}

}  // namespace breakaway::config
