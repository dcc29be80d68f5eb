#include "breakaway/config/read_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/cia402/setup_plan.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/parse_toml.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

using firmware::FaultScope;

constexpr Range not_negative{0, 1e12};
constexpr Range anywhere{-1e9, 1e9};
constexpr Range up_to_a_second{0, 1};
constexpr Range heartbeat{1e-3, 65.535};

std::vector<Key> operator+(std::vector<Key> rows, std::vector<Key> others) {
  std::ranges::move(others, std::back_inserter(rows));
  return rows;
}

void require_ordered(const Section& section, std::string_view lower, double low, std::string_view upper, double up) {
  if (low <= up) return;
  section.fail(lower, fmt::format("is {} and exceeds {} = {}; swap or correct them", low, upper, up));
}

// Friction is given either in newtons, or as the paper's coefficients with the gravity that makes them newtons.
Friction read_friction(const Section& section, double mass_kg, std::vector<Key> others) {
  Friction f;
  const bool coefficients = section.has("mu_lower") || section.has("mu_upper") || section.has("gravity_m_s2");
  const std::string_view lower = coefficients ? "mu_lower" : "lower_N", upper = coefficients ? "mu_upper" : "upper_N";
  const std::string_view unit = coefficients ? "" : "N";
  double gravity_m_s2 = 0;
  std::vector<Key> keys{
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

Controller read_controller(const Section& section, bool sampled, std::vector<Key> others) {
  Controller controller;
  bool is_pid = false;
  const Key kind = optional("kind", choice(is_pid, {{"impulsive", false}, {"pid", true}}));
  section.read(kind);
  if (is_pid) controller.pid.emplace();
  if (!is_pid) controller.impulsive.emplace().kick = sampled ? Kick::two_phase : Kick::ideal;
  const std::vector<Key> common{
      kind,
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
void check_gains(const Section& section, const ImpulsiveGains& gains, double mass_kg, bool sampled) {
  const double critical = 2 * std::sqrt(gains.stiffness_N_per_m * mass_kg);
  const auto refuse = [&](std::string_view key, double value, std::string_view rule) {
    section.fail(key, fmt::format("is {}, so zeta = {:.6g}; {} 2 sqrt(k1 m) = {:.6g} N s/m", value, value / critical,
                                  rule, critical));
  };
  const double k21 = gains.approach_damping_Ns_per_m, k22 = gains.kick_damping_Ns_per_m;
  if (!(k21 < critical)) refuse("k21_Ns_per_m", k21, "the approach needs zeta < 1: lower it below");
  if (!(k22 > critical)) refuse("k22_Ns_per_m", k22, "the kicks need zeta > 1: raise it above");
  if (sampled && gains.kick == Kick::ideal) {
    section.fail("kick", "must be \"two_phase\" or \"naive\" with a [loop]: a sampled kick takes time");
  }
}

Value thousandths(std::uint32_t& to, std::string_view unit) {
  return number([&to](double value) { to = static_cast<std::uint32_t>(std::lround(value * 1000)); }, unit, {1e-3, 4e6});
}

Drive read_drive(const Section& section, std::size_t place, std::vector<Key> others) {
  Drive d;
  d.node_id = static_cast<std::uint8_t>(place + 1);
  section.read(
      std::vector<Key>{
          optional("node_id", integer([&](std::int64_t n) { d.node_id = static_cast<std::uint8_t>(n); }, 1, 127)),
          required("rated_torque_Nm", thousandths(d.rated_torque_mNm, "N m")),
          optional("rated_current_A", thousandths(d.rated_current_mA, "A")),
          required("max_torque_per_mille",
                   integer([&](std::int64_t n) { d.max_torque_per_mille = static_cast<std::uint16_t>(n); }, 1, 32767)),
          required("force_per_torque_N_per_Nm", number(d.force_per_torque_N_per_Nm, "N/(N m)", positive)),
          optional("peak_force_N", number(d.peak_force_N, "N", positive)),
          required("encoder_resolution_m", number(d.encoder_resolution_m, "m", {1e-12, 1})),
          optional("current_loop_time_constant_s", number(d.current_loop_time_constant_s, "s", up_to_a_second)),
          optional("invert_direction", boolean(d.invert_direction)),
          optional("heartbeat_period_s", duration_s(d.heartbeat_period, heartbeat)),
          optional("heartbeat_timeout_s", duration_s(d.heartbeat_timeout, heartbeat)),
          optional("sdo_timeout_s", duration_s(d.sdo_timeout, {1e-3, 60})),
      } +
      std::move(others));
  // The simulation takes steps of a fraction of it, so a run would take for ever.
  if (d.current_loop_time_constant_s > 0 && d.current_loop_time_constant_s < 1e-8)
    section.fail("current_loop_time_constant_s", "is below 1e-8; give 0 for a current loop without lag");
  if (d.heartbeat_timeout <= d.heartbeat_period)
    section.fail("heartbeat_timeout_s", "is not above heartbeat_period_s; raise it to two or three periods");
  return d;
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

Loop read_loop(const Section& section, std::vector<Key> others) {
  Loop loop;
  section.read(
      std::vector<Key>{
          required("period_s", duration_s(loop.period, {1e-5, 1})),
          optional("node_id", integer([&](std::int64_t n) { loop.node_id = static_cast<std::uint8_t>(n); }, 1, 127)),
          optional("heartbeat_period_s", duration_s(loop.heartbeat_period, heartbeat)),
          optional("fault_stops",
                   choice(loop.fault_scope, {{"axis", FaultScope::axis}, {"all", FaultScope::all_axes}})),
      } +
      std::move(others));
  return loop;
}

// What a lawful motion needs must not stop the axis.
void check_limits(const Section& section, const Axis& axis) {
  const auto require = [&](bool holds, std::string_view key, double limit, std::string_view what, double least) {
    if (!holds)
      section.fail(key,
                   fmt::format("is {:g}, below {} = {:g}, which the controller may use; raise the one or lower the "
                               "other",
                               limit, what, least));
  };
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
}

// The drive must give what the law may ask for.
void check_force(const Section& section, const Axis& axis) {
  if (!axis.drive || axis.controller.max_force_N == unlimited) return;
  const double given_N = axis.drive->max_force_N();
  if (axis.controller.max_force_N <= given_N * (1 + 1e-12)) return;
  section.fail("max_force_N", fmt::format("is {}, but the [drive] gives {:.6g} N at most: lower it, or give the drive "
                                          "more torque",
                                          axis.controller.max_force_N, given_N));
}

void check_in_node(const Section& section, const Drive& drive, const Node& node) {
  const unsigned id = drive.node_id;
  if (node.loop && id == node.loop->node_id)
    section.fail("node_id", fmt::format("is {}, as that of the [loop]; change one of them", id));
  for (const Axis& other : node.axes) {
    if (other.drive && other.drive->node_id == drive.node_id)
      section.fail("node_id", fmt::format("is {}, as that of axis {}; give every drive its own", id, other.name));
  }
  // Drive and node watch each other with one timeout.
  if (node.loop && drive.heartbeat_timeout <= node.loop->heartbeat_period)
    section.fail("heartbeat_timeout_s",
                 fmt::format("is {}, not above the [loop] heartbeat_period_s = {}; raise the one or lower the other",
                             hal::seconds(drive.heartbeat_timeout), hal::seconds(node.loop->heartbeat_period)));
}

// The tables of one axis: the whole file, or an entry of [[axis]].
struct AxisTables {
  std::optional<Section> plant, friction, controller, drive, limits;

  std::vector<Key> rows() {
    const auto keep = [](std::optional<Section>& to) { return table([&to](const Section& part) { to = part; }); };
    return {optional("plant", keep(plant)), optional("friction", keep(friction)),
            optional("controller", keep(controller)), optional("drive", keep(drive)), optional("limits", keep(limits))};
  }

  // The next axis of the node. A table that is missing is missed only after those before it were read, so that a
  // misspelt key in the first table is what an unfinished file is told of.
  Axis read(const Section& parent, std::string name, const Node& node, const FileRows& others) const {
    const auto need = [&](const std::optional<Section>& part, const char* key) -> const Section& {
      if (!part) parent.fail(key, "is missing; give it a table");
      return *part;
    };
    const bool sampled = node.loop.has_value();
    const std::size_t place = node.axes.size();
    Axis axis;
    axis.name = std::move(name);
    const AxisRows also = others.axis ? others.axis(place) : AxisRows{};
    need(plant, "plant").read(std::vector<Key>{required("mass_kg", number(axis.mass_kg, "kg", positive))} + also.plant);
    axis.friction = read_friction(need(friction, "friction"), axis.mass_kg, also.friction);
    axis.controller = read_controller(need(controller, "controller"), sampled, also.controller);
    if (drive) axis.drive = read_drive(*drive, place, also.drive);
    if (drive) check_in_node(*drive, *axis.drive, node);
    if (limits) axis.limits = read_limits(*limits);
    check_force(*controller, axis);
    if (axis.controller.impulsive) check_gains(*controller, *axis.controller.impulsive, axis.mass_kg, sampled);
    if (limits) check_limits(*limits, axis);
    return axis;
  }
};

std::string read_name(const Section& section, std::string name, const std::vector<Axis>& before) {
  constexpr std::size_t longest = firmware::longest_axis_name;
  const bool readable = std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
  });
  if (name.empty() || name.size() > longest || !readable)
    section.fail("name", fmt::format("is \"{}\", must be 1 to {} letters, digits, '_', '-' or '.'", name, longest));
  if (std::ranges::find(before, name, &Axis::name) != before.end())
    section.fail("name", fmt::format("is \"{}\", as that of an axis above; give every axis a name of its own", name));
  return name;
}

void check_period(const Section& section, const Loop& loop) {
  if (cia402::interpolation_period(loop.period)) return;
  section.fail("period_s", "is not 1 to 255 times 1 s, 0.1 s, ... or 1 us, which drives need (60C2h); round it");
}

// [[axis]] entries, or the file itself as one axis.
void read_axes(const Section& root, Node& node, AxisTables& alone, const FileRows& others) {
  if (!root.has("axis")) return node.axes.push_back(alone.read(root, "axis", node, others));
  root.read(optional("axis", tables([&](const Section& entry) {
                       AxisTables tables;
                       std::string name;
                       entry.read(tables.rows() + std::vector<Key>{required("name", text(name))});
                       name = read_name(entry, std::move(name), node.axes);
                       node.axes.push_back(tables.read(entry, std::move(name), node, others));
                     })));
  if (node.axes.size() > most_axes)
    root.fail("axis",
              fmt::format("stands {} times, may stand {} times: a node drives no more", node.axes.size(), most_axes));
}

Key keep_table(std::string_view name, std::optional<Section>& to) {
  return optional(name, table([&to](const Section& part) { to = part; }));
}

void read_bus(const std::optional<Section>& section, Node& node, std::vector<Key> others) {
  const bool any_drive = std::ranges::any_of(node.axes, [](const Axis& axis) { return axis.drive.has_value(); });
  if (any_drive) node.bit_rate = 1'000'000;
  if (!section) return;
  std::uint32_t bit_rate = 1'000'000;
  section->read(
      std::vector<Key>{optional(
          "bit_rate", integer([&](std::int64_t n) { bit_rate = static_cast<std::uint32_t>(n); }, 10'000, 1'000'000))} +
      std::move(others));
  node.bit_rate = bit_rate;
}

// The least period that is at least this long and that drives can be told.
hal::Duration rounded_up(hal::Duration period) {
  hal::Duration step = std::chrono::microseconds{1};
  while (period > 255 * step) step *= 10;
  return (period + step - hal::Duration{1}) / step * step;
}

}  // namespace

Node read_node(const toml::table& document, const std::string& name, const FileRows& others) {
  const Section root{document, name, ""};
  Node node;
  node.file = name;
  std::optional<Section> loop, bus, run;
  AxisTables alone;
  const std::vector<Key> common{optional("title", text(node.title)), keep_table("loop", loop), keep_table("bus", bus),
                                keep_table("run", run)};
  const Key entries = optional("axis", tables([](const Section&) {}));
  root.read(common + (root.has("axis") ? std::vector<Key>{entries} : alone.rows()) + others.root);
  if (loop) node.loop = read_loop(*loop, others.loop);
  if (run)
    run->read(std::vector<Key>{optional("settle_tolerance_m", number(node.settle_tolerance_m, "m", positive))} +
              others.run);
  read_axes(root, node, alone, others);
  read_bus(bus, node, others.bus);
  if (loop && node.bit_rate) check_period(*loop, *node.loop);
  return node;
}

Node parse_node(std::string_view text, const std::string& name) {
  return with_document(text, name,
                       [&](const toml::table& document) { return read_node(document, name, passed_over()); });
}

Node read_node(const std::filesystem::path& file) { return parse_node(file_contents(file), file.string()); }

FileRows passed_over() {
  const auto named = [](std::initializer_list<std::string_view> names) {
    std::vector<Key> rows;
    for (const std::string_view name : names) rows.push_back(optional(name, {"", [](const Entry&) { return true; }}));
    return rows;
  };
  return {.root = {},
          .loop = {},
          .bus = named({"loss_probability", "delay_min_s", "delay_max_s", "seed"}),
          .run = named({"duration_s", "settle_time_s", "stop_when_settled"}),
          .axis = [=](std::size_t) {
            return AxisRows{.plant = named({"position_m", "velocity_m_s"}),
                            .friction = named({"law"}),
                            .controller = named({"scalar"}),
                            .drive = named({"tpdo_delay_min_s", "tpdo_delay_max_s", "seed"})};
          }};
}

void require_fitting_bus(const Node& node) {
  if (!node.loop || !node.bit_rate) return;
  const auto axes = static_cast<unsigned>(node.axes.size());
  const hal::Duration period = node.loop->period;
  const auto budget = canopen::bus_budget(axes, period, *node.bit_rate);
  if (axes <= budget.max_axes) return;
  throw InputError{fmt::format("{} {} at [loop] period_s = {} {} not fit a [bus] of {} bit/s: a period needs {} us on "
                               "the bus and has {} us; "
                               "choose a period_s of at least {}",
                               axes, axes == 1 ? "axis" : "axes", node.period_s(), axes == 1 ? "does" : "do",
                               *node.bit_rate, budget.needed_us, budget.available_us,
                               hal::seconds(rounded_up(budget.least_period)))}
      .in_file(node.file);
}

}  // namespace breakaway::config
