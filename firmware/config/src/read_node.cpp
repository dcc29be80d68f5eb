#include "breakaway/config/read_node.hpp"
#include "breakaway/config/drive_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "axis_tables.hpp"
#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/cia402/setup_plan.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/parse_toml.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/odrive/bus_budget.hpp"
#include "read_coupling.hpp"
#include "surroundings.hpp"
#include "wiring.hpp"

namespace breakaway::config {
namespace {

constexpr double shortest_period_s = 1e-5;  // that a file may ask for

using firmware::FaultScope;
using firmware::MovesEnd;

Loop read_loop(const Section& section, std::vector<Key> others) {
  Loop loop;
  section.read(
      std::vector<Key>{
          required("period_s", duration_s(loop.period, {shortest_period_s, 1})),
          optional("node_id", integer([&](std::int64_t n) { loop.node_id = static_cast<std::uint8_t>(n); }, 1, 127)),
          optional("heartbeat_period_s", duration_s(loop.heartbeat_period, heartbeat)),
          optional("command_timeout_s", duration_s(loop.command_timeout, {1e-2, 60})),
          optional("fault_stops",
                   choice(loop.fault_scope, {{"axis", FaultScope::axis}, {"all", FaultScope::all_axes}})),
          optional("moves_end", choice(loop.moves_end, {{"each", MovesEnd::each}, {"together", MovesEnd::together}})),
      } +
      std::move(others));
  if (!section.has("heartbeat_period_s")) loop.heartbeat_period = std::max(loop.heartbeat_period, 2 * loop.period);
  if (loop.heartbeat_period < 2 * loop.period)
    section.fail("heartbeat_period_s",
                 fmt::format("is {}, below two periods: a heartbeat takes the place of a frame that sets a drive up; "
                             "raise it to {} at least",
                             hal::seconds(loop.heartbeat_period), hal::seconds(2 * loop.period)));
  return loop;
}

// read_name() refuses what does not match, which editors are told here.
Value name_value(std::string& to) {
  Value value = text(to);
  value.form.pattern = fmt::format("^[a-zA-Z0-9_.-]{{1,{}}}$", firmware::longest_axis_name);
  return value;
}

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

// What of a node for CANopen has no meaning where the bus has no master.
void check_without_master(const Section& section) {
  for (const char* key : {"node_id", "heartbeat_period_s", "command_timeout_s"})
    if (section.has(key))
      section.fail(
          key, "is of a node on a CANopen bus, and one with drives of protocol = \"odrive\" has none; leave it out");
}

// [[axis]] entries, or the file itself as one axis.
void read_axes(const Section& root, Node& node, AxisTables& alone, const FileRows& others) {
  if (!root.has("axis")) return node.axes.push_back(alone.read(root, "axis", node, others));
  root.read_alone(optional("axis", tables([&](const Section& entry) {
                             AxisTables tables;
                             std::string name;
                             entry.read(tables.rows() + std::vector<Key>{required("name", name_value(name))});
                             name = read_name(entry, std::move(name), node.axes);
                             node.axes.push_back(tables.read(entry, std::move(name), node, others));
                           })));
  if (node.axes.size() > most_axes)
    root.fail("axis",
              fmt::format("stands {} times, may stand {} times: a node drives no more", node.axes.size(), most_axes));
}

// What the law calls reached must be what counts as settled.
void check_tolerances(const Section& run, const Node& node) {
  if (node.settle_tolerance_m == 0) return;
  for (const Axis& axis : node.axes) {
    if (!axis.controller.impulsive) continue;
    const OffCount off = furthest_off_count(axis);
    const double reached_m = axis.controller.position_tolerance_m + reading_error_m(axis) + off.m();
    if (axis.controller.position_tolerance_m == 0 || reached_m <= node.settle_tolerance_m * (1 + 1e-9)) continue;
    if (reached_m - off.m() <= node.settle_tolerance_m * (1 + 1e-9))
      run.fail(
          "settle_tolerance_m",
          fmt::format("is {:g}, and axis {} goes to whole counts of its encoder, so that it may rest {:g} m from the "
                      "target at {:.12g} m; give {:.12g} m, which is a whole count, or raise the tolerance",
                      node.settle_tolerance_m, axis.name, reached_m, off.target_m, off.count_at_m));
    const auto [settles, reached] = compared(node.settle_tolerance_m, reached_m);
    run.fail(
        "settle_tolerance_m",
        fmt::format("is {}, below position_tolerance_m of axis {} and what a reading may be off, {}: there the law "
                    "leaves the axis alone; raise the one or lower the other",
                    settles, axis.name, reached));
  }
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

std::vector<Key> of_machines_alone() {
  return elsewhere({"sweep", "feedback", "impulse"}, "it is for a [machine] without axes; leave it out");
}

void check_data_sheets(const Node& node) {
  for (const Axis& axis : node.axes) {
    if (!axis.drive || !axis.drive->data_sheet || !node.loop) continue;
    if (const auto lacking = what_is_lacking(node, axis))
      throw InputError{
          fmt::format("[drive] eds of axis {}: {} {}", axis.name, axis.drive->data_sheet->name(), *lacking)}
          .in_file(node.file);
  }
}

// The least period that is at least this long and that drives can be told.
hal::Duration period_that_is_told(hal::Duration period) {
  hal::Duration step = std::chrono::microseconds{1};
  while (period > 255 * step) step *= 10;
  return (period + step - hal::Duration{1}) / step * step;
}

}  // namespace

bool has_axes(const toml::table& document) {
  constexpr std::array keys{"axis", "plant", "controller", "drive", "loop"};
  return std::ranges::any_of(keys, [&](const char* key) { return document.contains(key); });
}

Node read_node(const toml::table& document, const std::string& name, const FileRows& others, KnownTables* known) {
  const Section root{document, name, "", known};
  if (root.has("machine") && !has_axes(document))
    throw InputError{
        "describes a [machine] alone, and an axis is asked for: take `simulate`, `attract` or `basin`, or give a file "
        "with [plant], [friction] and [controller]"}
        .in_file(name);
  Node node;
  node.file = name;
  std::optional<Section> loop, bus, run, target, coupling;
  AxisTables alone;
  const std::vector<Key> common{optional("title", text(node.title)),
                                keep_table("loop", loop),
                                keep_table("bus", bus),
                                keep_table("run", run),
                                keep_table("target", target),
                                keep_table("coupling", coupling)};
  const Key entries = required("axis", tables([](const Section&) {}));
  for (const char* part : {"plant", "friction", "controller", "drive", "limits", "told", "uncertainty", "move"})
    if (root.has("axis") && root.has(part))
      root.fail(part, "stands beside [[axis]]; put it into the axis that it is of");
  root.read(common + (root.has("axis") ? std::vector<Key>{entries} : alone.rows()) + others.root + of_machines_alone());
  if (loop) node.loop = read_loop(*loop, others.loop);
  if (run)
    run->read(std::vector<Key>{optional("settle_tolerance_m", number(node.settle_tolerance_m, "m", positive))} +
              others.run +
              elsewhere({"integrator", "step_s", "theta", "tolerance"},
                        "it is for a [machine] without axes; leave it out, or ask an axis for accuracy_m"));
  if (target) node.wiring = read_wiring(*target);
  read_axes(root, node, alone, others);
  if (run && node.loop) check_tolerances(*run, node);
  read_bus(bus, node, others.bus);
  if (loop && node.bit_rate && !speaks_odrive(node)) check_period(*loop, *node.loop);
  check_data_sheets(node);
  if (loop && speaks_odrive(node)) check_without_master(*loop);
  if (coupling && speaks_odrive(node))
    coupling->fail("mass",
                   "stands beside a drive of protocol = \"odrive\", whose axes move each alone so far; leave "
                   "[coupling] out, or take protocol = \"canopen\"");
  if (coupling) node.coupling = read_coupling(*coupling, node);
  look_at_root(root, node);
  return node;
}

Node parse_node(std::string_view text, const std::string& name) {
  return with_document(text, name,
                       [&](const toml::table& document) { return read_node(document, name, passed_over()); });
}

Node read_node(const std::filesystem::path& file) { return parse_node(file_contents(file), shown_name(file)); }

FileRows passed_over() {
  const auto named = [](std::initializer_list<std::string_view> names) {
    std::vector<Key> rows;
    for (const std::string_view name : names) rows.push_back(optional(name, {"", [](const Entry&) { return true; }}));
    return rows;
  };
  return {.root = named({"machine", "start"}),
          .loop = {},
          .bus = named({"loss_probability", "delay_min_s", "delay_max_s", "seed"}),
          .run = named({"duration_s", "settle_time_s", "stop_when_settled", "accuracy_m"}),
          .axis = [=](std::size_t) {
            return AxisRows{.plant = named({"position_m", "velocity_m_s", "force_N", "presliding", "load", "backlash",
                                            "cogging", "ripple", "encoder_error", "drift", "machine"}),
                            .friction = named({"law"}),
                            .controller = named({"scalar"}),
                            .drive = named({"tpdo_delay_min_s", "tpdo_delay_max_s", "seed", "quirks"})};
          }};
}

namespace {

struct Need {
  std::uint32_t needed_us = 0, available_us = 0;
  hal::Duration least_period{};
  bool fits = true;
};

// Of cyclic estimates a longer period may bring more, so its need is its own; a whole one of theirs brings one.
Need need_of_odrives(const Node& node) {
  const Odrive& o = *node.axes.front().drive->odrive;
  const odrive::Sampling sampling{o.estimates, o.estimate_period};
  const auto axes = static_cast<unsigned>(node.axes.size());
  const auto budget = odrive::bus_budget(axes, node.loop->period, *node.bit_rate, sampling);
  hal::Duration least = std::chrono::microseconds{budget.needed_us};
  if (o.estimates == odrive::Estimates::cyclic) least = std::max(least, o.estimate_period);
  return {budget.needed_us, budget.available_us, least, budget.fits()};
}

Need need_of_canopen(const Node& node) {
  const auto axes = static_cast<unsigned>(node.axes.size());
  const auto budget = canopen::bus_budget(axes, node.loop->period, *node.bit_rate);
  return {budget.needed_us, budget.available_us, budget.least_period, axes <= budget.max_axes};
}

Need need_of_bus(const Node& node) { return speaks_odrive(node) ? need_of_odrives(node) : need_of_canopen(node); }

}  // namespace

double least_period_s(const Node& node) {
  if (!node.loop || !node.bit_rate) return shortest_period_s;
  double late_s = 0;
  for (const Axis& axis : node.axes)
    if (axis.drive && !axis.drive->odrive) late_s = std::max(late_s, answer_delay_s(node, axis));
  const hal::Duration late{static_cast<std::int64_t>(std::ceil(late_s * 1e9))};
  return std::max(shortest_period_s, hal::seconds(period_that_is_told(need_of_bus(node).least_period + late)));
}

void require_fitting_bus(const Node& node) {
  if (!node.loop || !node.bit_rate) return;
  const auto axes = node.axes.size();
  const Need budget = need_of_bus(node);
  if (budget.fits) return;
  throw InputError{fmt::format("{} {} at [loop] period_s = {} {} not fit a [bus] of {} bit/s: a period needs {} us on "
                               "the bus and has {} us; "
                               "choose a period_s of at least {}",
                               axes, axes == 1 ? "axis" : "axes", node.period_s(), axes == 1 ? "does" : "do",
                               *node.bit_rate, budget.needed_us, budget.available_us,
                               hal::seconds(period_that_is_told(budget.least_period)))}
      .in_file(node.file);
}

}  // namespace breakaway::config
