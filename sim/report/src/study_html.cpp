#include "breakaway/report/study_html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/html_page.hpp"
#include "breakaway/format/length_text.hpp"
#include "breakaway/format/plot_style.hpp"
#include "histogram.hpp"
#include "pictures.hpp"

namespace breakaway::report {
namespace {

using format::HtmlTable;
using study::StudyRow;
using study::StudyRun;

constexpr std::size_t most_bins = 24;
constexpr int histogram_px = 280;

// What a histogram shows beside its bars.
struct HistogramMarks {
  std::string x_label;
  double tolerance = std::numeric_limits<double>::quiet_NaN();  // NaN: none
};

std::string draw(const std::string& name, const Histogram& h, const HistogramMarks& marks) {
  std::string commands = format::plot_style + "$bars << END\n";
  for (std::size_t bin = 0; bin < h.counts.size(); ++bin)
    commands += fmt::format("{:.10g} {}\n", h.middle(bin), h.counts[bin]);
  double least = h.least, most = h.least + h.width * static_cast<double>(h.counts.size());
  if (std::isfinite(marks.tolerance)) least = std::min(least, marks.tolerance), most = std::max(most, marks.tolerance);
  const double room = 0.03 * (most - least);
  commands += fmt::format(
      "END\nset boxwidth {:.10g}\nset style fill solid 0.85 border linecolor '#ffffff'\nset xlabel '{}'\n"
      "set ylabel 'friction laws'\nset grid noxtics\nset xrange [{:.10g}:{:.10g}]\nset yrange [0:*]\n",
      h.width, marks.x_label, least - room, most + room);
  if (std::isfinite(marks.tolerance))
    commands +=
        fmt::format("set arrow from {0:.10g}, graph 0 to {0:.10g}, graph 1 nohead linestyle 4\n", marks.tolerance);
  if (constexpr std::size_t few = 10; *std::ranges::max_element(h.counts) <= few) commands += "set ytics 1\n";
  commands += "plot $bars using 1:2 with boxes linecolor '#1c5d99' notitle";
  if (std::isfinite(marks.tolerance)) commands += ", NaN with lines linestyle 4 title 'tolerance'";
  return format::draw_svg(name, format::width_px, histogram_px, commands + "\n");
}

std::string unsettled_text(const StudyRow& row) {
  const std::size_t never = row.runs.size() - study::settled_runs(row);
  return never == 0 ? "" : fmt::format(" {} of {} never settled and are not in it.", never, row.runs.size());
}

std::string times_section(const StudyRow& row, const std::string& start) {
  std::vector<double> times;
  for (const StudyRun& run : row.runs) times.push_back(run.settled ? run.settling_time_s : std::nan(""));
  const Histogram histogram = histogram_of(times, most_bins);
  if (histogram.counts.empty()) return "";
  return format::html_section("Settling times" + start, draw("times", histogram, {.x_label = "settling time [s]"}),
                              "How many friction laws took how long." + unsettled_text(row));
}

std::string errors_section(const StudyRow& row, double tolerance_m, const std::string& start) {
  std::vector<double> errors;
  double most_m = tolerance_m;
  for (const StudyRun& run : row.runs)
    if (std::isfinite(run.final_error_m)) most_m = std::max(most_m, std::abs(run.final_error_m));
  const format::LengthUnit unit = format::length_unit(most_m);
  for (const StudyRun& run : row.runs) errors.push_back(std::abs(run.final_error_m) * unit.per_metre);
  const Histogram histogram = histogram_of(errors, most_bins);
  if (histogram.counts.empty()) return "";
  return format::html_section(
      "Errors" + start,
      draw("errors", histogram,
           {.x_label = fmt::format("distance from the target at the end [{}]", unit.name),
            .tolerance = tolerance_m * unit.per_metre}),
      "How many friction laws ended how far from the target, those that never settled among them.");
}

std::string seconds(double time_s) { return std::isfinite(time_s) ? fmt::format("{:.4g} s", time_s) : "never"; }

std::string summary(const config::Node& node, const ReportedRow& reported, double tolerance_m) {
  const StudyRow& row = reported.row;
  const StudyRun& slowest = study::slowest_run(row);
  HtmlTable table;
  table.row("Settled", fmt::format("{} of {}, within {}", study::settled_runs(row), row.runs.size(),
                                   format::length_text(tolerance_m)));
  table.row("Settling time", fmt::format("median {}, worst {}", seconds(study::median_settling_time_s(row)),
                                         seconds(study::worst_settling_time_s(row))));
  table.row("Within the tolerance for good", fmt::format("worst {}", seconds(study::worst_time_inside_s(row))));
  table.row("Worst error", format::length_text(study::worst_error_m(row)));
  table.row("Furthest past the target", format::length_text(study::worst_excursions(row).overshoot_m));
  table.row("Furthest past it by a kick", format::length_text(study::worst_excursions(row).beyond_m));
  table.quantity("Largest speed", study::worst_excursions(row).peak_speed_m_s, "m/s");
  table.quantity("Largest force", study::largest_force_N(row), "N");
  table.row("Margins to the limits", sil::to_text(study::margins(node, row)));
  if (const std::size_t cycles = study::limit_cycles(row); cycles > 0)
    table.row("Limit cycles", fmt::format("{}", cycles));
  if (const std::size_t faulted = study::faulted_runs(row); faulted > 0)
    table.row("Stopped by a fault", fmt::format("{}", faulted));
  table.row("Worst law", slowest.law + ": " + seconds(slowest.settled ? slowest.settling_time_s : std::nan("")));
  for (const sil::FaultRecord& fault : slowest.faults)
    table.row("Its fault", fmt::format("{} at {:.6g} s", fault.name, fault.time_s));
  table.row("Again", reported.again);
  return table.text();
}

// How the axis moved under the worst law.
std::string worst_sections(const ReportedStudy& study, const ReportedRow& reported, const std::string& start) {
  std::string sections;
  for (const Picture& picture : draw_pictures(study.node, study.node.axes.front(), reported.worst.axes.front())) {
    if (picture.title != "Response" && picture.title != "Position error") continue;
    sections += format::html_section("Worst law" + start + ": " + picture.title, picture.svg, picture.caption);
  }
  return sections;
}

bool all_settled(const std::vector<ReportedRow>& rows) {
  return std::ranges::all_of(
      rows, [](const ReportedRow& reported) { return study::settled_runs(reported.row) == reported.row.runs.size(); });
}

}  // namespace

std::string study_html(const std::vector<ReportedStudy>& studies) {
  std::string sections;
  for (const ReportedStudy& study : studies) {
    const double tolerance_m = judged_tolerance_m(study.node, study.node.axes.front());
    for (const ReportedRow& reported : study.rows) {
      const study::Start& from = reported.row.start;
      const std::string start =
          fmt::format(", {}from {:g} m{}", studies.size() > 1 ? study.file + " " : "", from.position_m,
                      from.velocity_m_s != 0 ? fmt::format(" at {:g} m/s", from.velocity_m_s) : "");
      sections += format::html_section("Study" + start, summary(study.node, reported, tolerance_m), "") +
                  times_section(reported.row, start) + errors_section(reported.row, tolerance_m, start) +
                  worst_sections(study, reported, start);
    }
  }
  const ReportedStudy& first = studies.front();
  const bool good = all_settled(first.rows);
  return format::html_page(first.node.title.empty() ? "Study of an axis" : first.node.title, good,
                           good ? "settled under every friction law" : "did not settle under every friction law",
                           sections);
}

}  // namespace breakaway::report
