#include "breakaway/report/html.hpp"

#include <fmt/format.h>

#include <cmath>

#include "pictures.hpp"

namespace breakaway::report {
namespace {

using scenario::Result;
using scenario::Scenario;

constexpr const char* style = R"(
  :root { color-scheme: light; }
  body { margin: 0; background: #f4f5f6; color: #22272b; font: 16px/1.55 system-ui, "Segoe UI", Helvetica, Arial, sans-serif; }
  main { max-width: 960px; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
  h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .4rem; }
  h2 { font-size: 1.15rem; margin: 0 0 .3rem; }
  .verdict { display: inline-block; padding: .15rem .7rem; border-radius: 1rem; font-weight: 600; }
  .yes { background: #d9efe3; color: #14532d; } .no { background: #fbe0dc; color: #7f1d1d; }
  section { background: #fff; border: 1px solid #e1e4e6; border-radius: 8px; padding: 1.1rem 1.3rem; margin-top: 1.1rem; }
  table { border-collapse: collapse; width: 100%; } th, td { text-align: left; padding: .28rem .5rem; border-bottom: 1px solid #eceeef; }
  th { font-weight: 500; color: #596168; width: 46%; } td { font-variant-numeric: tabular-nums; }
  svg { width: 100%; height: auto; } p { margin: .2rem 0 .6rem; } .caption { color: #4a5258; font-size: .93rem; }
  .columns { display: grid; grid-template-columns: 1fr 1fr; gap: 0 2rem; } @media (max-width: 720px) { .columns { grid-template-columns: 1fr; } }
  @media print { body { background: #fff; } section { break-inside: avoid; } }
)";

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

class Table {
 public:
  void row(std::string_view name, const std::string& value) {
    text_ += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", name, escaped(value));
  }
  void quantity(std::string_view name, double value, std::string_view unit) {
    row(name, std::isfinite(value) ? fmt::format("{:.6g} {}", value, unit) : "–");
  }
  std::string text() const { return "<table>\n" + text_ + "</table>\n"; }

 private:
  std::string text_;
};

std::string outcome(const Result& r) {
  Table table;
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
  Table table;
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
  const std::string title = escaped(s.title.empty() ? "Positioning run" : s.title);
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n"
      "<h1>{0}</h1>\n<p><span class=\"verdict {2}\">{3}</span></p>\n",
      title, style, r.settled ? "yes" : "no", r.settled ? "settled on the target" : "did not settle");
  html += fmt::format(
      "<section><div class=\"columns\"><div><h2>Outcome</h2>\n{}</div><div><h2>Axis</h2>\n{}</div></div>"
      "</section>\n",
      outcome(r), inputs(s));
  for (const Picture& picture : draw_pictures(s, r)) {
    html += fmt::format("<section><h2>{}</h2>\n{}\n<p class=\"caption\">{}</p></section>\n", picture.title, picture.svg,
                        escaped(picture.caption));
  }
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace breakaway::report
