#include <fmt/format.h>

#include <limits>
#include <memory>

#include "breakaway/design/flashed_header.hpp"
#include "breakaway/design/report.hpp"
#include "breakaway/format/json_writer.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/report/design_html.hpp"
#include "breakaway/scenario/axis_design.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "commands.hpp"

namespace breakaway::cli {
namespace {

using scenario::Scenario;

struct DesignCommand {
  std::string axis, json, report, header;
};

void write_check(format::JsonWriter& json, const design::Check& check) {
  json.member("name", check.name);
  json.member("required", check.required);
  json.member("holds", check.holds);
  json.member("margin", check.margin);
  json.member("source", check.source);
  json.member("reason", check.reason);
}

std::string to_json(const design::DesignReport& report) {
  format::JsonWriter json;
  json.object([&] {
    json.member("certified", report.certified);
    json.array("reasons", [&] {
      for (const std::string& reason : report.reasons) json.value(reason);
    });
    json.array("conditions", [&] {
      for (const std::string& condition : report.conditions) json.value(condition);
    });
    json.member("zeta_approach", report.zeta_approach);
    json.member("zeta_kick", report.zeta_kick);
    json.member("c_lower_m", report.c_lower_m);
    json.member("c_upper_m", report.c_upper_m);
    json.member("friction_ratio", report.ratio);
    json.member("friction_ratio_threshold_18", report.ratio_threshold_18);
    json.member("friction_ratio_exact_threshold", report.exact_ratio_threshold);
    json.member("least_k22_for_18_Ns_per_m", report.least_damping_Ns_per_m);
    json.member("largest_impulse_Ns", report.largest_impulse_Ns);
    json.member("contraction_per_kick", report.contraction_per_kick);
    json.member("accuracy_floor_m", report.accuracy_floor_m);
    json.member("bound_s", report.finite_time_bound_s);
    json.object("table", [&] {
      json.member("bytes", report.table_bytes);
      json.member("proved_error", report.table_proved_error);
      json.member("measured_error", report.table_measured_error);
    });
    json.array("checks", [&] {
      for (const design::Check& check : report.checks) json.object([&] { write_check(json, check); });
    });
  });
  return json.text();
}

void print_report(const design::DesignReport& r) {
  for (const design::Check& check : r.checks) {
    const char* verdict = check.holds ? "holds" : check.required ? "FAILS" : "no";
    fmt::print("{:<6} {:<36} margin {:>11.4g}  {}\n", verdict, check.name, check.margin, check.reason);
  }
  fmt::print("\nzeta                  {:.4g} in the approach, {:.4g} in the kick phase\n", r.zeta_approach,
             r.zeta_kick);
  fmt::print("stick sets            {:.4g} m (minimal), {:.4g} m (maximal)\n", r.c_lower_m, r.c_upper_m);
  fmt::print("accuracy floor        {:.4g} m\n", r.accuracy_floor_m);
  fmt::print("bound (19)            {:.4g} s from the minimal stick set to the target\n", r.finite_time_bound_s);
  fmt::print("error after a kick    at most {:.4g} of the error before\n", r.contraction_per_kick);
  fmt::print("k3 table              {} bytes, relative error at most {:.3g} (measured {:.3g})\n", r.table_bytes,
             r.table_proved_error, r.table_measured_error);
  fmt::print("{}\n", r.certified ? "certified, provided that" : "NOT certified");
  for (const std::string& line : r.certified ? r.conditions : r.reasons) fmt::print("  {}\n", line);
}

void write_header(const DesignCommand& options, const Scenario& s, const design::AxisDesign& axis,
                  const design::DesignReport& report) {
  const auto flashed = design::flashed_axis(scenario::axis_parameters<float>(s), axis, report);
  format::write_output(options.header, design::flashed_header(flashed, report, options.axis));
}

design::DesignReport checked(const std::string& file, const design::AxisDesign& axis) try {
  return design::design_axis(axis);
} catch (const InputError& error) {
  throw error.in_file(file);
}

// A design that is not certified is no bad input, so that its report is written; only nothing is flashed.
int design_file(const DesignCommand& options) {
  const Scenario s = scenario::read_scenario(options.axis);
  const design::AxisDesign axis = scenario::axis_design(s);
  const auto report = checked(options.axis, axis);
  if (!options.json.empty()) format::write_output(options.json, to_json(report));
  if (!options.report.empty()) {
    const std::string title = "Design: " + (s.title.empty() ? "a positioning axis" : s.title);
    format::write_output(options.report, report::design_html(title, options.axis, axis, report));
  }
  if (options.json != "-" && options.report != "-" && options.header != "-") print_report(report);
  if (!options.header.empty() && report.certified) write_header(options, s, axis, report);
  if (!options.header.empty() && !report.certified) {
    fmt::print(stderr, "{}: not certified, so no header is written: {}\n", options.axis, report.reasons.front());
  }
  return report.certified ? done : failed_check;
}

}  // namespace

void add_design(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<DesignCommand>();
  CLI::App* command =
      app.add_subcommand("design", "Check an axis: every assumption with its margin, accuracy, k3 table");
  command
      ->add_option("axis", options->axis,
                   "The axis: a scenario file, or its [plant], [friction], [controller], [loop] and [drive]")
      ->required();
  command->add_option("--json", options->json, "Write everything as JSON to this file; - is standard output")
      ->check(file_name);
  command->add_option("--report", options->report, "Write the report to sign to this HTML file (needs gnuplot)")
      ->check(file_name);
  command
      ->add_option("--header", options->header,
                   "Write gains, table, limits and checksum as the C++ header that is flashed; only if certified")
      ->check(file_name);
  command->footer(
      std::string{
          "Example: breakaway design sim/scenarios/can_axis.toml --report design.html --header flashed_axis.hpp\n"} +
      exit_codes);
  command->callback([options, &exit_code] { exit_code = design_file(*options); });
}

}  // namespace breakaway::cli
