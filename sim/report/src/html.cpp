#include "breakaway/report/html.hpp"

#include <fmt/format.h>

#include <cmath>

#include "breakaway/format/html_page.hpp"
#include "breakaway/format/length_text.hpp"
#include "breakaway/sil/margins.hpp"
#include "coupled_pictures.hpp"
#include "motion_picture.hpp"
#include "pictures.hpp"

namespace breakaway::report {
namespace {

using format::HtmlTable;
using scenario::Scenario;
using sil::AxisResult;
using sil::Result;

void add_outcome(HtmlTable& table, const config::Axis& axis, const AxisResult& r) {
  table.quantity("Settling time", r.settling_time_s, "s");
  table.row("Final position error", format::length_text(r.final_error_m));
  if (r.ideal) {
    table.quantity("Maximal stick set reached, t₁", r.ideal->t1_s, "s");
    table.quantity("Minimal stick set reached, t₂", r.ideal->t2_s, "s");
    table.row("Error there, y₂", format::length_text(r.ideal->y2_m));
    table.quantity("Target reached, t∞", r.ideal->t_inf_s, "s");
    table.quantity("Bound (19) on t∞", r.ideal->bound_s, "s");
  }
  if (!r.ideal) table.quantity("Largest actuator force", r.max_force_N, "N");
  if (r.excursions) {
    table.row("Furthest past the target", format::length_text(r.excursions->overshoot_m));
    table.row("Furthest past it by a kick", format::length_text(r.excursions->beyond_m));
    table.quantity("Largest speed", r.excursions->peak_speed_m_s, "m/s");
    table.row("Way", fmt::format("{} to {}", format::length_text(r.excursions->lowest_m),
                                 format::length_text(r.excursions->highest_m)));
    table.row("Margins to the limits", sil::to_text(sil::margins(axis, *r.excursions, r.max_force_N)));
  }
  table.row("Kicks", fmt::format("{}", r.kicks.size()));
  for (const auto& fault : r.faults) table.row("Fault", fmt::format("{} at {:.6g} s", fault.name, fault.time_s));
}

void add_run(HtmlTable& table, const Result& r) {
  if (r.loop) {
    table.row("Control periods",
              fmt::format("{}, of which {} without fresh feedback", r.loop->ticks, r.loop->missed_ticks));
    table.row("Mean bus load", fmt::format("{:.1f} %", 100 * r.loop->bus_load));
    if (r.loop->sync_off_s > 0) table.row("SYNC off whole periods", fmt::format("{:.3g} s", r.loop->sync_off_s));
  }
  table.row("Time taken to compute", fmt::format("{:.1f} ms", 1e3 * r.wall_s));
}

void add_gains(HtmlTable& table, const config::Axis& axis, bool coupled) {
  if (const auto& gains = axis.controller.impulsive) {
    // The other coasts use none of these gains.
    if (gains->coast != law::Coast::pd && !coupled)
      return table.row("Coast", gains->coast == law::Coast::brake ? "brake" : "work");
    const double critical = 2 * std::sqrt(gains->stiffness_N_per_m * axis.mass_kg);
    table.quantity("Stiffness k₁", gains->stiffness_N_per_m, "N/m");
    table.row("Approach damping k₂₁", fmt::format("{:g} N s/m (ζ = {:.3g})", gains->approach_damping_Ns_per_m,
                                                  gains->approach_damping_Ns_per_m / critical));
    if (coupled) return;  // the law of its kicks has none
    table.row("Kick damping k₂₂", fmt::format("{:g} N s/m (ζ = {:.3g})", gains->kick_damping_Ns_per_m,
                                              gains->kick_damping_Ns_per_m / critical));
  }
  if (const auto& gains = axis.controller.pid) {
    table.quantity("Proportional gain", gains->proportional_N_per_m, "N/m");
    table.quantity("Integral gain", gains->integral_N_per_ms, "N/(m s)");
    table.quantity("Derivative gain", gains->derivative_Ns_per_m, "N s/m");
  }
}

// What the controller is told, and the truth where that is another number.
void add_told(HtmlTable& table, const char* name, double told, double truth, const char* unit) {
  if (told == truth) return table.quantity(name, told, unit);
  table.row(name, fmt::format("told {:.7g} {}, truly {:.7g} {}", told, unit, truth, unit));
}

void add_friction(HtmlTable& table, const config::Axis& axis) {
  const auto& told = axis.friction.bounds;
  const auto truth = config::truth_of(axis).bounds;
  const std::string bounds = fmt::format("{:g} to {:g} N", told.lower_N, told.upper_N);
  const bool same = told.lower_N == truth.lower_N && told.upper_N == truth.upper_N;
  table.row("Friction bounds",
            same ? bounds : fmt::format("told {}, truly {:g} to {:g} N", bounds, truth.lower_N, truth.upper_N));
}

// What stands behind an axis: a plant of its own, or a machine.
void add_plant(HtmlTable& table, const Scenario& s, std::size_t place) {
  const config::Axis& axis = s.node.axes[place];
  const scenario::AxisWorld& world = s.worlds[place];
  if (world.place) {
    const auto& bounds = axis.friction.bounds;
    table.row("Plant", "a place of the machine");
    table.row("Told of it",
              fmt::format("{:g} kg, {:g} to {:g} N of friction", axis.mass_kg, bounds.lower_N, bounds.upper_N));
    table.row("Start", fmt::format("{:g} m, {:g} m/s", world.place->read.dot(s.machine->start.q),
                                   world.place->read.dot(s.machine->start.v)));
    return;
  }
  add_told(table, "Mass", axis.mass_kg, config::truth_of(axis).mass_kg, "kg");
  table.row("Start", fmt::format("{:g} m, {:g} m/s", world.position_m, world.velocity_m_s));
  add_friction(table, axis);
}

std::string inputs(const Scenario& s, std::size_t place) {
  const config::Axis& axis = s.node.axes[place];
  HtmlTable table;
  add_plant(table, s, place);
  add_gains(table, axis, s.node.coupling.has_value());
  if (axis.controller.max_force_N < config::unlimited) table.quantity("Force limit", axis.controller.max_force_N, "N");
  if (s.node.loop) table.quantity("Control period", 1e3 * s.node.period_s(), "ms");
  if (axis.drive) {
    table.quantity("Encoder count", 1e6 * axis.drive->encoder_resolution_m, "µm");
    const double told = axis.drive->force_per_torque_N_per_Nm, quantum_N = axis.drive->force_quantum_N();
    add_told(table, axis.drive->odrive ? "Step of force" : "Force per per-mille of rated torque", std::fabs(quantum_N),
             std::fabs(quantum_N * config::truth_of(axis).force_per_torque_N_per_Nm / told), "N");
    if (axis.latency_periods != 1) table.row("Latency", fmt::format("told {} periods, truly 1", axis.latency_periods));
  }
  if (s.bus) table.quantity("Bus", 1e-6 * s.bus->bit_rate, "Mbit/s");
  return table.text();
}

std::string columns(const std::string& left, const std::string& right, const std::string& axis) {
  return fmt::format(
      "<section><div class=\"columns\"><div><h2>Outcome</h2>\n{}</div><div><h2>{}</h2>\n{}</div></div></section>\n",
      left, axis, right);
}

std::string pictures(const Scenario& s, const Result& r, std::size_t place, const std::string& prefix) {
  std::string sections;
  for (const Picture& picture : draw_pictures(s.node, s.node.axes[place], r.axes[place]))
    sections += format::html_section(prefix + picture.title, picture.svg, picture.caption);
  return sections;
}

std::string one_axis(const Scenario& s, const Result& r) {
  HtmlTable outcome;
  add_outcome(outcome, s.node.axes.front(), r.axes.front());
  add_run(outcome, r);
  return columns(outcome.text(), inputs(s, 0), "Axis") + pictures(s, r, 0, "");
}

std::string several_axes(const Scenario& s, const Result& r) {
  HtmlTable run;
  for (const AxisResult& axis : r.axes) {
    const std::string when =
        axis.settled ? fmt::format("settled at {:.6g} s", axis.settling_time_s) : std::string{"did NOT settle"};
    run.row("Axis " + axis.name, fmt::format("{}, final error {}, {} kicks", when,
                                             format::length_text(axis.final_error_m), axis.kicks.size()));
  }
  add_run(run, r);
  std::string sections = format::html_section("All axes", run.text(), "");
  if (s.node.coupling) {
    for (const Picture& picture : draw_coupled_pictures(s.node, r))
      sections += format::html_section(picture.title, picture.svg, picture.caption);
  }
  for (std::size_t i = 0; i < r.axes.size(); ++i) {
    const std::string name = "Axis " + r.axes[i].name;
    HtmlTable outcome;
    add_outcome(outcome, s.node.axes[i], r.axes[i]);
    sections += columns(outcome.text(), inputs(s, i), name) + pictures(s, r, i, "Axis " + r.axes[i].name + ": ");
  }
  return sections;
}

}  // namespace

std::string to_html(const Scenario& s, const Result& r) {
  std::string sections = r.axes.size() == 1 ? one_axis(s, r) : several_axes(s, r);
  if (r.loop && !r.axes.front().trace.empty()) {
    const Picture picture = draw_bus_load(r);
    sections += format::html_section(picture.title, picture.svg, picture.caption);
  }
  if (!r.machine_trace.empty())
    sections += format::html_section("Machine", draw_motion(r.machine_trace),
                                     "The coordinates of the machine that all axes stand on, and their velocities.");
  const bool several = r.axes.size() > 1;
  const char* verdict = r.settled() ? (several ? "all axes settled on their targets" : "settled on the target")
                                    : (several ? "not all axes settled" : "did not settle");
  return format::html_page(s.node.title.empty() ? "Positioning run" : s.node.title, r.settled(), verdict, sections);
}

}  // namespace breakaway::report
