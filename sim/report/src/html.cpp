#include "breakaway/report/html.hpp"

#include <fmt/format.h>

#include <cmath>

#include "breakaway/format/html_page.hpp"
#include "pictures.hpp"

namespace breakaway::report {
namespace {

using scenario::Scenario;
using sil::Result;

std::string outcome(const Result& r) {
  format::HtmlTable table;
  table.quantity("Settling time", r.settling_time_s, "s");
  table.quantity("Final position error", r.final_error_m, "m");
  if (r.ideal) {
    table.quantity("Maximal stick set reached, t₁", r.ideal->t1_s, "s");
    table.quantity("Minimal stick set reached, t₂", r.ideal->t2_s, "s");
    table.quantity("Error there, y₂", r.ideal->y2_m, "m");
    table.quantity("Target reached, t∞", r.ideal->t_inf_s, "s");
    table.quantity("Bound (19) on t∞", r.ideal->bound_s, "s");
  }
  if (!r.ideal) table.quantity("Largest actuator force", r.max_force_N, "N");
  table.row("Kicks", fmt::format("{}", r.kicks.size()));
  if (r.loop) {
    table.row("Control periods",
              fmt::format("{}, of which {} without fresh feedback", r.loop->ticks, r.loop->missed_ticks));
    table.row("Mean bus load", fmt::format("{:.1f} %", 100 * r.loop->bus_load));
  }
  for (const auto& fault : r.faults) table.row("Fault", fmt::format("{} at {:.6g} s", fault.name, fault.time_s));
  table.row("Time taken to compute", fmt::format("{:.1f} ms", 1e3 * r.wall_s));
  return table.text();
}

std::string inputs(const Scenario& s) {
  format::HtmlTable table;
  table.quantity("Mass", s.plant.mass_kg, "kg");
  table.row("Start", fmt::format("{:g} m, {:g} m/s", s.plant.position_m, s.plant.velocity_m_s));
  table.row("Friction bounds", fmt::format("{:g} to {:g} N", s.friction.lower_N, s.friction.upper_N));
  if (const auto& gains = s.controller.impulsive) {
    const double critical = 2 * std::sqrt(gains->stiffness_N_per_m * s.plant.mass_kg);
    table.quantity("Stiffness k₁", gains->stiffness_N_per_m, "N/m");
    table.row("Approach damping k₂₁", fmt::format("{:g} N s/m (ζ = {:.3g})", gains->approach_damping_Ns_per_m,
                                                  gains->approach_damping_Ns_per_m / critical));
    table.row("Kick damping k₂₂", fmt::format("{:g} N s/m (ζ = {:.3g})", gains->kick_damping_Ns_per_m,
                                              gains->kick_damping_Ns_per_m / critical));
  }
  if (const auto& gains = s.controller.pid) {
    table.quantity("Proportional gain", gains->proportional_N_per_m, "N/m");
    table.quantity("Integral gain", gains->integral_N_per_ms, "N/(m s)");
    table.quantity("Derivative gain", gains->derivative_Ns_per_m, "N s/m");
  }
  if (s.controller.max_force_N < scenario::unlimited) table.quantity("Force limit", s.controller.max_force_N, "N");
  if (s.loop) table.quantity("Control period", 1e3 * s.loop->period_s, "ms");
  if (s.drive) {
    table.quantity("Encoder count", 1e6 * s.drive->encoder_resolution_m, "µm");
    table.quantity("Force per per-mille of rated torque",
                   1e-6 * s.drive->rated_torque_mNm * std::fabs(s.drive->force_per_torque_N_per_Nm), "N");
  }
  if (s.bus) table.quantity("Bus", 1e-6 * s.bus->bit_rate, "Mbit/s");
  return table.text();
}

}  // namespace

std::string to_html(const Scenario& s, const Result& r) {
  std::string sections = fmt::format(
      "<section><div class=\"columns\"><div><h2>Outcome</h2>\n{}</div><div><h2>Axis</h2>\n{}</div></div>"
      "</section>\n",
      outcome(r), inputs(s));
  for (const Picture& picture : draw_pictures(s, r))
    sections += format::html_section(picture.title, picture.svg, picture.caption);
  return format::html_page(s.title.empty() ? "Positioning run" : s.title, r.settled,
                           r.settled ? "settled on the target" : "did not settle", sections);
}

}  // namespace breakaway::report
