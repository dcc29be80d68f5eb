#include "breakaway/scenario/read_scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/parse_toml.hpp"
#include "breakaway/config/toml_section.hpp"
#include "breakaway/input/input_error.hpp"
#include "read_friction.hpp"

namespace breakaway::scenario {

using namespace config;
namespace {

constexpr Range not_negative{0, 1e12};
constexpr Range anywhere{-1e9, 1e9};
constexpr Range delay{0, 1};

Plant read_plant(const Section& section) {
  Plant plant;
  section.read({
      required("mass_kg", number(plant.mass_kg, "kg", positive)),
      optional("position_m", number(plant.position_m, "m", anywhere)),
      optional("velocity_m_s", number(plant.velocity_m_s, "m/s", anywhere)),
  });
  return plant;
}

TargetChange read_target(const Section& section) {
  TargetChange change;
  section.read({
      required("time_s", number(change.time_s, "s", not_negative)),
      required("position_m", number(change.position_m, "m", anywhere)),
  });
  return change;
}

std::vector<Key> gain_keys(ImpulsiveGains& gains) {
  return {
      required("k1_N_per_m", number(gains.stiffness_N_per_m, "N/m", positive)),
      required("k21_Ns_per_m", number(gains.approach_damping_Ns_per_m, "N s/m", positive)),
      required("k22_Ns_per_m", number(gains.kick_damping_Ns_per_m, "N s/m", positive)),
      optional("kick",
               choice(gains.kick, {{"ideal", Kick::ideal}, {"two_phase", Kick::two_phase}, {"naive", Kick::naive}})),
  };
}

std::vector<Key> gain_keys(PidGains& gains) {
  return {
      required("kp_N_per_m", number(gains.proportional_N_per_m, "N/m", positive)),
      required("ki_N_per_ms", number(gains.integral_N_per_ms, "N/(m s)", not_negative)),
      required("kd_Ns_per_m", number(gains.derivative_Ns_per_m, "N s/m", positive)),
  };
}

Controller read_controller(const Section& section, bool ideal) {
  Controller controller;
  bool is_pid = false;
  const Key kind = optional("kind", choice(is_pid, {{"impulsive", false}, {"pid", true}}));
  section.read(kind);
  if (is_pid) controller.pid.emplace();
  if (!is_pid) controller.impulsive.emplace().kick = ideal ? Kick::ideal : Kick::two_phase;
  std::vector<Key> keys = is_pid ? gain_keys(*controller.pid) : gain_keys(*controller.impulsive);
  const std::vector<Key> common{
      kind,
      optional("max_force_N", number(controller.max_force_N, "N", positive)),
      optional("max_approach_speed_m_s", number(controller.max_approach_speed_m_s, "m/s", positive)),
      optional("position_tolerance_m", number(controller.position_tolerance_m, "m", not_negative)),
      optional("scalar", choice(controller.scalar, {{"float", ScalarType::float32}, {"double", ScalarType::float64}})),
      optional("target_m", number(controller.target_m, "m", anywhere)),
      optional("targets", tables([&](const Section& entry) { controller.targets.push_back(read_target(entry)); })),
  };
  keys.insert(keys.end(), common.begin(), common.end());
  section.read(keys);
  if (!std::ranges::is_sorted(controller.targets, {}, &TargetChange::time_s)) {
    section.fail("targets", "are not in order of time_s; sort them");
  }
  return controller;
}

Loop read_loop(const Section& section) {
  Loop loop;
  section.read({required("period_s", number(loop.period_s, "s", {1e-5, 1}))});
  return loop;
}

drive_emulator::EmulatorConfig read_drive(const Section& section) {
  drive_emulator::EmulatorConfig d;
  const auto in_thousandths = [](auto& to) {
    return [&to](double value) { to = static_cast<std::uint32_t>(std::lround(value * 1000)); };
  };
  section.read({
      optional("node_id", integer([&](std::int64_t n) { d.node_id = static_cast<std::uint8_t>(n); }, 1, 127)),
      required("rated_torque_Nm", number(in_thousandths(d.rated_torque_mNm), "N m", {1e-3, 4e6})),
      optional("rated_current_A", number(in_thousandths(d.rated_current_mA), "A", {1e-3, 4e6})),
      required("max_torque_per_mille",
               integer([&](std::int64_t n) { d.max_torque_per_mille = static_cast<std::uint16_t>(n); }, 1, 32767)),
      required("force_per_torque_N_per_Nm", number(d.force_per_torque_N_per_Nm, "N/(N m)", positive)),
      optional("peak_force_N", number(d.peak_force_N, "N", positive)),
      required("encoder_resolution_m", number(d.encoder_resolution_m, "m", {1e-12, 1})),
      optional("current_loop_time_constant_s", number(d.current_loop_time_constant_s, "s", delay)),
      optional("tpdo_delay_min_s", duration_s(d.min_tpdo_delay, delay)),
      optional("tpdo_delay_max_s", duration_s(d.max_tpdo_delay, delay)),
      optional("seed", integer([&](std::int64_t n) { d.seed = static_cast<std::uint64_t>(n); }, 0, INT64_MAX)),
  });
  // The motion is followed within a fraction of it: the run would take for ever.
  if (d.current_loop_time_constant_s > 0 && d.current_loop_time_constant_s < 1e-8)
    section.fail("current_loop_time_constant_s", "is below 1e-8; give 0 for a current loop without lag");
  if (d.min_tpdo_delay > d.max_tpdo_delay)
    section.fail("tpdo_delay_min_s", "exceeds tpdo_delay_max_s; swap or raise it");
  return d;
}

virtual_bus::VirtualBusConfig read_bus(const Section& section) {
  virtual_bus::VirtualBusConfig bus;
  section.read({
      optional("bit_rate",
               integer([&](std::int64_t n) { bus.bit_rate = static_cast<std::uint32_t>(n); }, 10'000, 1'000'000)),
      optional("loss_probability", number(bus.loss_probability, "", {0, 1})),
      optional("delay_min_s", duration_s(bus.min_delay, delay)),
      optional("delay_max_s", duration_s(bus.max_delay, delay)),
      optional("seed", integer([&](std::int64_t n) { bus.seed = static_cast<std::uint64_t>(n); }, 0, INT64_MAX)),
  });
  if (bus.min_delay > bus.max_delay) section.fail("delay_min_s", "exceeds delay_max_s; swap or raise it");
  return bus;
}

Limits read_limits(const Section& section) {
  Limits limits;
  section.read({
      optional("position_m", number(limits.position_m, "m", positive)),
      optional("speed_m_s", number(limits.speed_m_s, "m/s", positive)),
      optional("following_error_m", number(limits.following_error_m, "m", positive)),
  });
  return limits;
}

Run read_run(const Section& section) {
  Run run;
  section.read({
      required("duration_s", number(run.duration_s, "s", {0, 1e6, true})),
      optional("settle_tolerance_m", number(run.settle_tolerance_m, "m", positive)),
      optional("settle_time_s", number(run.settle_time_s, "s", not_negative)),
      optional("stop_when_settled", boolean(run.stop_when_settled)),
  });
  return run;
}

// The rules that hold between keys, for the law of [I]. zeta = k2 / (2 sqrt(k1 m)).
void check_gains(const Section& section, const ImpulsiveGains& gains, const Scenario& s) {
  const double critical = 2 * std::sqrt(gains.stiffness_N_per_m * s.plant.mass_kg);
  const auto refuse = [&](std::string_view key, double value, std::string_view rule) {
    section.fail(key, fmt::format("is {}, so zeta = {:.6g}; {} 2 sqrt(k1 m) = {:.6g} N s/m", value, value / critical,
                                  rule, critical));
  };
  const double k21 = gains.approach_damping_Ns_per_m, k22 = gains.kick_damping_Ns_per_m;
  if (!(k21 < critical)) refuse("k21_Ns_per_m", k21, "the approach needs zeta < 1: lower it below");
  if (!(k22 > critical)) refuse("k22_Ns_per_m", k22, "the kicks need zeta > 1: raise it above");
  if (s.loop && gains.kick == Kick::ideal) {
    section.fail("kick", "must be \"two_phase\" or \"naive\" with a [loop]: a sampled kick takes time");
  }
}

Scenario read_axis(const toml::table& document, const std::string& name) {
  const Section root{document, name, ""};
  Scenario s;
  s.file = name;
  std::optional<Section> friction_part, controller_part;
  root.read({
      optional("title", text(s.title)),
      required("plant", table([&](const Section& part) { s.plant = read_plant(part); })),
      required("friction", table([&](const Section& part) { friction_part = part; })),
      required("controller", table([&](const Section& part) { controller_part = part; })),
      optional("loop", table([&](const Section& part) { s.loop = read_loop(part); })),
      optional("drive", table([&](const Section& part) { s.drive = read_drive(part); })),
      optional("bus", table([&](const Section& part) { s.bus = read_bus(part); })),
      optional("limits", table([&](const Section& part) { s.limits = read_limits(part); })),
      optional("run", table([&](const Section& part) { s.run = read_run(part); })),
  });
  s.friction = read_friction(*friction_part, s.plant.mass_kg);
  s.controller = read_controller(*controller_part, s.ideal());
  if (s.drive && !s.bus) s.bus.emplace();
  if (s.controller.impulsive) check_gains(*controller_part, *s.controller.impulsive, s);
  return s;
}

}  // namespace

Scenario parse_scenario(std::string_view text, const std::string& name) {
  try {
    return read_axis(parse_toml(text, name), name);
  } catch (const toml::parse_error& error) {
    throw InputError{fmt::format("{}:{}: not valid TOML: {}", name, error.source().begin.line, error.description())};
  }
}

Scenario read_scenario(const std::filesystem::path& file) { return parse_scenario(file_contents(file), file.string()); }

}  // namespace breakaway::scenario
