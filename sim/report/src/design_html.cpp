#include "breakaway/report/design_html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "breakaway/format/html_page.hpp"
#include "breakaway/format/length_text.hpp"
#include "design_pictures.hpp"

namespace breakaway::report {
namespace {

using design::AxisDesign;
using design::DesignReport;

// With the remedies when the design fails.
std::string verdict(const DesignReport& report, const std::string& prefix) {
  const std::string lines = format::html_list(report.certified ? report.conditions : report.reasons);
  return format::html_section(
      prefix + (report.certified ? "Certified, provided that" : "Not certified, because"), lines,
      report.certified ? "What must be true of the machine. A certificate says nothing about a machine "
                         "that breaks one of these conditions."
                       : "Each line names the check that fails, in numbers, and what mends it.");
}

std::string checks(const DesignReport& report, bool required, std::string_view title, std::string_view caption) {
  format::HtmlTable table;
  for (const design::Check& check : report.checks) {
    if (check.required != required) continue;
    table.row(fmt::format("{} {}", check.holds ? "&#10003;" : "&#10007;", check.name),
              fmt::format("{}. Margin {:.4g}. Source: {}.", check.reason, check.margin, check.source));
  }
  return format::html_section(title, table.text(), caption);
}

std::string axis_table(const AxisDesign& axis, const std::string& source) {
  format::HtmlTable table;
  table.file("Read from", source);
  table.quantity("Moving mass", axis.mass_kg, "kg");
  table.row("Dry friction", fmt::format("{:g} to {:g} N", axis.friction.lower_N, axis.friction.upper_N));
  table.quantity("Slope of smooth friction at rest", axis.smooth_friction_slope_Ns_per_m, "N s/m");
  if (axis.braked || axis.work) {
    table.row("Coast", axis.work ? "work" : "brake");
  } else {
    table.quantity("Stiffness k₁", axis.stiffness_N_per_m, "N/m");
    table.quantity("Approach damping k₂₁", axis.approach_damping_Ns_per_m, "N s/m");
    table.quantity("Kick damping k₂₂", axis.kick_damping_Ns_per_m, "N s/m");
  }
  table.quantity("Largest force", axis.max_force_N, "N");
  table.quantity("Control period", 1e3 * axis.period_s, "ms");
  table.row("Latency", fmt::format("{} × control period", axis.latency_ticks));
  table.quantity("Encoder count", 1e6 * axis.encoder_resolution_m, "µm");
  table.quantity("Tolerance asked for", 1e6 * axis.position_tolerance_m, "µm");
  return table.text();
}

void add_approach_time(format::HtmlTable& table, double way_m, double time_s) {
  table.at_most(fmt::format("From {}, to the first kick at most (tested)", format::length_text(way_m)), time_s, "s");
}

std::string results_table(const DesignReport& report) {
  format::HtmlTable table;
  table.row("Damping ratio ζ",
            fmt::format("{:.4g} in the approach, {:.4g} in the kick phase", report.zeta_approach, report.zeta_kick));
  table.quantity("Minimal stick set, c<sub>lower</sub> of (9)", 1e3 * report.c_lower_m, "mm");
  table.quantity("Maximal stick set, c<sub>upper</sub> of (9)", 1e3 * report.c_upper_m, "mm");
  table.quantity("Largest impulse, |k₃(c<sub>upper</sub>)|", report.largest_impulse_Ns, "N s");
  table.at_most("Error left by a kick, of the error before", report.contraction_per_kick, "");
  table.at_most("Bound (19) on the time in the minimal stick set", report.finite_time_bound_s, "s");
  table.at_most("Accuracy floor", 1e6 * report.accuracy_floor_m, "µm");
  table.row("Friction ratio", fmt::format("{:.4g}; needed {:.4g} (exact), {:.4g} by (18)", report.ratio,
                                          report.exact_ratio_threshold, report.ratio_threshold_18));
  table.quantity("Least k₂₂ for (18), Remark 1", report.least_damping_Ns_per_m, "N s/m");
  if (report.pd && report.certified) {
    const design::PdPromise& promise = *report.pd;
    table.at_most("True error at rest, at most (tested)", 1e6 * promise.error_m, "µm");
    table.row("Kicks, at most (tested)", fmt::format("{}", promise.most_kicks));
    if (std::isfinite(promise.beyond_m)) {
      table.at_most("Beyond the target, at most (tested)", 1e3 * promise.beyond_m, "mm");
      table.at_most("Largest speed of an approach (tested)", promise.approach_peak_m_s, "m/s");
      add_approach_time(table, promise.longest_way_m, promise.approach_s);
    }
    table.at_most("The kicks take at most (tested)", promise.kicks_s, "s");
  }
  table.row("k₃ table", fmt::format("{} bytes, relative error at most {:g} (proved), {:.3g} found", report.table_bytes,
                                    rounded_up(report.table_proved_error, 3), report.table_measured_error));
  return table.text();
}

std::string braked_results_table(const design::BrakedPromise& promise) {
  format::HtmlTable table;
  table.at_most("True error at rest, at most", 1e6 * promise.error_m, "µm");
  table.at_most("Beyond the target by a kick, at most", 1e6 * promise.beyond_m, "µm");
  table.at_most("Accuracy floor", 1e6 * promise.floor_m, "µm");
  table.at_most("Least tolerance", 1e6 * promise.least_tolerance_m, "µm");
  if (promise.fine_stage)
    table.row("Below the floor", "the fine stage aims at the tolerance, and goes beyond the target");
  table.row("Kicks, at most", fmt::format("{}", promise.most_kicks));
  table.quantity("Reach of a kick", 1e3 * promise.reach_m, "mm");
  table.quantity("The approach gives way to brake and kicks at", 1e3 * promise.hand_over_m, "mm");
  table.at_most("An approach passes its target by at most (tested)", 1e3 * promise.approach_beyond_m, "mm");
  if (std::isfinite(promise.approach_peak_m_s))
    table.at_most("Largest speed of an approach (tested)", promise.approach_peak_m_s, "m/s");
  table.quantity("Brake", promise.brake_N, "N");
  table.at_most("Largest speed by a kick", promise.kick_peak_m_s, "m/s");
  table.quantity("Rest is proved after", 1e3 * promise.rest_s, "ms");
  table.row("Kick table", fmt::format("{} bytes, aims short by {:g} of the distance at most", promise.table_bytes,
                                      promise.aim_lost > 0 ? rounded_up(promise.aim_lost, 3) : 0));
  if (promise.least_move_s > 0) table.at_least("Longest move, under any law at least", promise.least_move_s, "s");
  if (promise.approach_s > 0) {
    add_approach_time(table, promise.longest_way_m, promise.approach_s);
    table.at_most("The kicks take at most", promise.kicks_s, "s");
  }
  return table.text();
}

std::string work_results_table(const design::WorkPromise& promise) {
  format::HtmlTable table;
  table.at_most("True error at rest of the side with the encoder, at most", 1e6 * promise.error_m, "µm");
  table.at_most("Beyond the target by a kick, at most", 1e6 * promise.beyond_m, "µm");
  table.at_most("The other side off from it at rest, at most", 1e6 * promise.unseen_m, "µm");
  table.at_least("Resonance, at least", promise.resonance_Hz, "Hz");
  table.at_most("Added to a kick by the spring, at most", 1e6 * promise.spring_m, "µm");
  table.at_most("Accuracy floor", 1e6 * promise.floor_m, "µm");
  table.at_most("Least tolerance", 1e6 * promise.least_tolerance_m, "µm");
  table.row("Kicks, at most", fmt::format("{}", promise.most_kicks));
  table.quantity("Reach of a kick", 1e3 * promise.reach_m, "mm");
  table.quantity("Kicked from within", 1e3 * promise.hand_over_m, "mm");
  table.at_least("Approached from within", promise.farthest_m, "m");
  table.at_most("An approach passes its target by at most (tested)", 1e3 * promise.approach_beyond_m, "mm");
  if (std::isfinite(promise.approach_peak_m_s))
    table.at_most("Largest speed of an approach (tested)", promise.approach_peak_m_s, "m/s");
  table.at_most("Largest speed of the motor by a kick", promise.kick_peak_m_s, "m/s");
  table.quantity("Rest is seen after", 1e3 * promise.rest_s, "ms");
  table.row("Kick table", fmt::format("{} bytes", promise.table_bytes));
  return table.text();
}

std::string results_of_coast(const design::DesignReport& report) {
  if (report.braked) return braked_results_table(*report.braked);
  return report.work ? work_results_table(*report.work) : results_table(report);
}

// How an axis comes to its target under each coast, and on what that rests: what is signed claims no more.
constexpr std::string_view coast_pd =
    "<p>The axis slides towards its target under a PD law and sticks short of it, because of dry friction. While it "
    "rests within the maximal stick set, it is kicked: an impulse is chosen so that under the least friction it would "
    "come to rest exactly on the target; under more friction it stops short, but nearer than before. Of the ideal law, "
    "with impulses, [I] proves that this cannot fail for any friction within the bounds, also when friction varies "
    "with position, speed and time. Of a sampled loop it is tested.</p>";
constexpr std::string_view coast_brake =
    "<p>Coast \"brake\": the axis is led near its target within its limits of force and speed. From rest it is kicked "
    "by a pulse of force out of a table, after which a constant force below the least friction brakes it (none, where "
    "friction bends before it slides). The table is made so that under the least friction, with everything off by what "
    "is stated, a kick of the table ends on the target at most, but for half a count; under more friction the axis "
    "stops short, but nearer than before. The conditions say what of this is tested, not proved.</p>";
constexpr std::string_view coast_work =
    "<p>Coast \"work\": the axis is led near its target so that its load does not swing on. From rest it is kicked by "
    "a pulse that does no more work than friction is sure to take on the way to the target, so that neither the motor "
    "nor its load gets beyond by more than is said. The conditions say what of this is tested, not proved.</p>";
constexpr std::string_view sources =
    "<p>[I]: N. van de Wouw and R. I. Leine, <i>Impulsive Control of Mechanical Motion Systems with Uncertain "
    "Friction</i>. [A]: by the same authors, <i>Stability Properties of Equilibrium Sets of Controlled Linear "
    "Mechanical Systems with Dry Friction</i>. Numbers in parentheses are equations of [I] unless said otherwise.</p>";

bool has_gains_of_its_law(const DesignedAxis& axis) { return !axis.design.braked && !axis.design.work; }

std::string legend(const std::vector<DesignedAxis>& axes) {
  std::string text = "<section><h2>How to read this</h2>";
  if (std::ranges::any_of(axes, has_gains_of_its_law)) text += coast_pd;
  if (std::ranges::any_of(axes, [](const DesignedAxis& axis) { return axis.design.braked.has_value(); }))
    text += coast_brake;
  if (std::ranges::any_of(axes, [](const DesignedAxis& axis) { return axis.design.work.has_value(); }))
    text += coast_work;
  return text.append(sources).append("</section>\n");
}

// `prefix` names the axis in headings, where there are several.
std::string axis_sections(const DesignedAxis& axis, const std::string& source, const std::string& prefix) {
  std::string sections =
      verdict(axis.report, prefix) +
      fmt::format(
          "<section><div class=\"columns\"><div><h2>{}Axis</h2>\n{}</div><div><h2>What follows</h2>\n{}</div></div>"
          "</section>\n",
          prefix, axis_table(axis.design, source), results_of_coast(axis.report)) +
      checks(axis.report, true, prefix + "Checks that the certificate needs",
             "The margin is positive when a check holds, in the unit of what is compared.") +
      checks(
          axis.report, false, prefix + "For information",
          has_gains_of_its_law(axis)
              ? "Sufficient conditions of the paper; the exact ones are above."
              : "What the coast \"pd\" would ask for, with the gains k₁, k₂₁ and k₂₂, which this axis does not use.");
  for (const Picture& picture : draw_design_pictures(axis.design, axis.report))
    sections += format::html_section(prefix + picture.title, picture.svg, picture.caption);
  return sections;
}

}  // namespace

std::string design_html(const std::string& title, const std::string& source, const std::vector<DesignedAxis>& axes) {
  std::string sections;
  for (const DesignedAxis& axis : axes)
    sections += axis_sections(axis, source, axes.size() == 1 ? std::string{} : axis.name + ": ");
  const bool certified = std::ranges::all_of(axes, &DesignReport::certified, &DesignedAxis::report);
  return format::html_page(title, certified, certified ? "certified" : "not certified", sections + legend(axes));
}

}  // namespace breakaway::report
