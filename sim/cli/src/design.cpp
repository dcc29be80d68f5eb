#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/machine_design.hpp"
#include "breakaway/design/binding_limit.hpp"
#include "breakaway/design/report.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/report/design_html.hpp"
#include "breakaway/report/design_json.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/stability/machine_certificate.hpp"
#include "call_files.hpp"
#include "commands.hpp"

namespace breakaway::cli {
namespace {

using config::Node;
using design::DesignReport;
using Reports = std::vector<DesignReport>;

struct DesignCommand {
  std::string file, json, report, header, law_image;
  bool writes() const { return !header.empty() || !law_image.empty(); }
};

// With few digits what something is at most, and at least. What is 0 or endless stays.
double at_most(double value, int digits = 4) {
  return value > 0 && std::isfinite(value) ? rounded_up(value, digits) : value;
}
double at_least(double value) { return value > 0 && std::isfinite(value) ? rounded_down(value, 4) : value; }

void print_overshoot(const auto& p) {
  fmt::print("overshoot             at most {:g} m by a kick, and {:g} m by an approach (tested){}\n",
             at_most(p.beyond_m), at_most(p.approach_beyond_m),
             std::isfinite(p.approach_peak_m_s)
                 ? fmt::format(", which goes {:g} m/s at most (tested)", at_most(p.approach_peak_m_s))
                 : "");
}

void print_promise(const design::BrakedPromise& p, bool certified) {
  fmt::print("coast \"brake\"         brake {:.4g} N, floor {:g} m, least tolerance {:g} m, table {} bytes\n",
             p.brake_N, at_most(p.floor_m), at_most(p.least_tolerance_m), p.table_bytes);
  if (!certified) return;
  fmt::print("                      {}\n", p.promise);
  print_overshoot(p);
  if (p.least_move_s > 0)
    fmt::print(
        "longest move          {:g} s at least within its limits, under any law; then brake and kicks from {:.4g} "
        "m\n",
        at_least(p.least_move_s), p.hand_over_m);
  if (p.approach_s > 0)
    fmt::print(
        "time to rest          from {:.4g} m at most {:g} s up to the first kick (tested), and {:g} s of kicks\n",
        p.longest_way_m, at_most(p.approach_s), at_most(p.kicks_s));
}

void print_promise(const design::WorkPromise& p, bool certified) {
  fmt::print("coast \"work\"          floor {:g} m, least tolerance {:g} m, table {} bytes\n", at_most(p.floor_m),
             at_most(p.least_tolerance_m), p.table_bytes);
  fmt::print(
      "load on a spring      resonates at {:g} Hz at least, adds {:g} m to a kick (eps); either side may rest {:g} m "
      "from "
      "where "
      "the other says\n",
      at_least(p.resonance_Hz), at_most(p.spring_m), at_most(p.unseen_m));
  if (!certified) return;
  fmt::print("                      {}\n", p.promise);
  print_overshoot(p);
}

void print_promise(const design::PdPromise& p) {
  fmt::print(
      "coast \"pd\"            kicks aim short by {:g} of the distance at most; {} kicks are needed at most (tested)"
      "\n                      at rest the true error is at most {:g} m (tested)\n",
      at_most(p.aim_lost, 2), p.most_kicks, at_most(p.error_m));
  if (!std::isfinite(p.beyond_m))
    return fmt::print("time to rest          {:g} s of kicks at most (tested)\n", at_most(p.kicks_s));
  fmt::print(
      "overshoot             at most {:g} m by an approach or a kick, and an approach goes {:g} m/s at most (tested)\n",
      at_most(p.beyond_m), at_most(p.approach_peak_m_s));
  fmt::print("time to rest          from {:.4g} m at most {:g} s up to the first kick, and {:g} s of kicks (tested)\n",
             p.longest_way_m, at_most(p.approach_s), at_most(p.kicks_s));
}

void print_report(const design::DesignReport& r) {
  for (const design::Check& check : r.checks) {
    const char* verdict = check.holds ? "holds" : check.required ? "FAILS" : "no";
    fmt::print("{:<6} {:<36} margin {:>11.4g}  {}\n", verdict, check.name, check.margin, check.reason);
  }
  fmt::print("\nzeta                  {:.4g} in the approach, {:.4g} in the kick phase\n", r.zeta_approach,
             r.zeta_kick);
  fmt::print("stick sets            {:.4g} m (minimal), {:.4g} m (maximal)\n", r.c_lower_m, r.c_upper_m);
  fmt::print("accuracy floor        {:g} m\n", at_most(r.accuracy_floor_m));
  fmt::print("bound (19)            {:g} s from the minimal stick set to the target\n", at_most(r.finite_time_bound_s));
  fmt::print("error after a kick    at most {:g} of the error before\n", at_most(r.contraction_per_kick));
  fmt::print("k3 table              {} bytes, relative error at most {:g} (measured {:.3g})\n", r.table_bytes,
             at_most(r.table_proved_error, 3), r.table_measured_error);
  if (r.braked) print_promise(*r.braked, r.certified);
  if (r.work) print_promise(*r.work, r.certified);
  if (r.pd && r.certified) print_promise(*r.pd);
  fmt::print("{}\n", r.certified ? "certified, provided that" : "NOT certified");
  for (const std::string& line : r.certified ? r.conditions : r.reasons) fmt::print("  {}\n", line);
}

void print_reports(const Node& node, const Reports& reports) {
  for (std::size_t i = 0; i < reports.size(); ++i) {
    if (reports.size() > 1) fmt::print("{}axis {}\n", i > 0 ? "\n" : "", node.axes[i].name);
    const std::string told = config::told_otherwise(node.axes[i]);
    if (!told.empty()) fmt::print("designed for what the controller is told: {}\n\n", told);
    print_report(reports[i]);
    if (reports[i].braked && reports[i].certified) {
      const design::BindingLimit limit = design::binding_limit(config::braked_class(node, node.axes[i]));
      fmt::print("accuracy is limited most by {}: with half of it a tolerance of {:g} m could be certified\n",
                 limit.name, at_most(limit.least_tolerance_m));
    }
  }
}

std::string html(const std::string& file, const Node& node, const Reports& reports) {
  std::vector<report::DesignedAxis> axes;
  for (std::size_t i = 0; i < reports.size(); ++i)
    axes.push_back({node.axes[i].name, config::axis_design(node, node.axes[i]), reports[i]});
  return report::design_html("Design: " + (node.title.empty() ? "a positioning axis" : node.title), file, axes);
}

std::string why_not(const Node& node, const Reports& reports) try {
  config::require_certified(node, reports);
  return "certified";
} catch (const InputError& error) {
  return error.what();
}

// What is flashed; empty where it was not asked for.
struct Flashed {
  std::string header, law_image;
};

// A file with the suffix of a header is text.
std::string law_image_as(const std::string& file, const std::vector<std::uint8_t>& image, const Node& node) {
  return file.ends_with(".h") ? config::law_image_header(image, node.file) : std::string{image.begin(), image.end()};
}

// Without --header nothing is written, but what could not be flashed is refused as well.
Flashed flashed(const DesignCommand& options, const Node& node, const Reports& reports, bool certified) {
  if (!options.writes()) config::require_flashable(node, reports);
  if (!options.writes() || !certified) return {};
  const auto write = [&](const auto& flashed) {
    Flashed files;
    if (!options.header.empty()) files.header = config::node_header(flashed, node, reports);
    if (!options.law_image.empty()) files.law_image = law_image_as(options.law_image, config::law_image(flashed), node);
    return files;
  };
  return config::is_by_work(node) ? write(config::certified_by_work(node, reports))
                                  : write(config::certified(node, reports));
}

void print_promised_axis(const Node& node, std::size_t i, const stability::AxisPromise& axis) {
  const double reading_m = config::reading_error_m(node.axes[i]);
  fmt::print("axis {:<16} box {:.4g} m, ", node.axes[i].name, axis.box_m);
  if (axis.most_kicks > 0)
    fmt::print("kicks of {:.4g} N at most, {} of them at most, error {:g} m (least {:g} m)\n", axis.kick_N,
               axis.most_kicks, at_most(config::tolerance_m(node, node.axes[i]) + reading_m),
               at_most(axis.least_tolerance_m + reading_m));
  else
    fmt::print("no kick is certified\n");
  const stability::PairCondition& pair = axis.tightest;
  if (pair.kicked != pair.held)
    fmt::print("                      its kicks ask most of {} in the {}: {:.4g} N of {:.4g} N, margin {:.4g} N\n",
               node.axes[static_cast<std::size_t>(pair.held)].name, stability::to_string(pair.phase), pair.needed_N,
               pair.held_N, pair.margin_N());
}

void print_machine(const Node& node, const stability::MachineCertificate& certificate) {
  for (const stability::Condition& c : certificate.conditions)
    fmt::print("{:<6} {:<30} margin {:>11.4g}  {}\n", c.holds ? "holds" : "FAILS", c.name, c.margin, c.reason);
  fmt::print("\n");
  for (std::size_t i = 0; i < certificate.axes.size(); ++i) print_promised_axis(node, i, certificate.axes[i]);
  for (const stability::PairCondition& pair : certificate.simultaneous)
    fmt::print("both at once          {} under a kick of {}: {}, margin {:.4g} N\n",
               node.axes[static_cast<std::size_t>(pair.held)].name,
               node.axes[static_cast<std::size_t>(pair.kicked)].name,
               pair.holds() ? "would stop" : "is not sure to stop", pair.margin_N());
  if (!certificate.certified) return fmt::print("NOT certified\n  {}\n", certificate.reason);
  fmt::print("release               {:g} s to certain rest\n", at_most(certificate.release_s));
  fmt::print("certified: {}; provided that\n", config::machine_promise(node, certificate));
  for (const std::string& condition : config::machine_conditions(node)) fmt::print("  {}\n", condition);
}

void print_written(const DesignCommand& options, bool certified) {
  const auto tell = [](const std::string& path) {
    if (!path.empty()) fmt::print("written: {}\n", path);
  };
  tell(options.json), tell(options.report);
  if (certified) tell(options.header), tell(options.law_image);
}

// With what the file says of the world, of which a node knows some only: what simulate refuses is not certified.
Node read_node(const std::string& file) { return scenario::read_scenario(file).node; }

// Axes that push each other have one certificate.
int design_machine(const DesignCommand& options, const Node& node) {
  if (!options.report.empty())
    throw InputError{
        "--report is of axes that move alone; a [coupling] is reported by --json, and its motion by "
        "`simulate --report`"}
        .in_file(node.file);
  if (!options.law_image.empty())
    throw InputError{"--law-image is of axes that move alone; those of a [coupling] are kicked by one coordinator"}
        .in_file(node.file);
  const stability::MachineCertificate certificate = config::examine_machine(node);
  // Without --header nothing is written, but what could not be flashed is refused as well.
  const std::string header =
      certificate.certified ? config::node_header(config::certified_machine(node, certificate), node, certificate) : "";
  if (!options.json.empty()) format::write_output(options.json, report::to_json(node, certificate));
  if (!options.header.empty() && certificate.certified) format::write_output(options.header, header);
  if (options.json != "-" && options.header != "-")
    print_machine(node, certificate), print_written(options, certificate.certified);
  if (!certificate.certified)
    fmt::print(stderr, "breakaway: {}: not certified: {}{}\n", node.file, certificate.reason,
               options.header.empty() ? "" : "; no header is written");
  return certificate.certified ? done : failed_check;
}

// A design that is not certified is no bad input, so that its report is written; only nothing is flashed.
int design_file(const DesignCommand& options) {
  const Node node = read_node(options.file);
  if (node.coupling) return design_machine(options, node);
  const Reports reports = config::examine(node);
  const bool certified = std::ranges::all_of(reports, &DesignReport::certified);
  // Everything is ready before the first file is written: an error here leaves no file behind.
  const std::string page = options.report.empty() ? "" : html(node.file, node, reports);
  const Flashed files = flashed(options, node, reports, certified);
  if (!options.json.empty()) format::write_output(options.json, report::to_json(node, reports));
  if (!page.empty()) format::write_output(options.report, page);
  if (!files.header.empty()) format::write_output(options.header, files.header);
  if (!files.law_image.empty()) format::write_output(options.law_image, files.law_image);
  const bool shown = options.json != "-" && options.report != "-" && options.header != "-" && options.law_image != "-";
  if (shown) print_reports(node, reports), print_written(options, certified);
  if (options.writes() && !certified)
    fmt::print(stderr, "breakaway: {}: no {} is written\n", why_not(node, reports),
               options.header.empty() ? "law image" : "header");
  return certified ? done : failed_check;
}

}  // namespace

void add_design(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<DesignCommand>();
  CLI::App* command =
      app.add_subcommand("design", "Check every axis of a node: each assumption with its margin, accuracy, k3 table");
  CallFiles files{*command};
  files.reads("axis", options->file, "The node: a scenario file, or what it says of loop, axes and drives")->required();
  files.writes("--json", options->json, "Write everything as JSON to this file; - is standard output");
  files.writes_page("--report", options->report, "Write the report to sign to this HTML file (needs gnuplot)");
  files.writes("--header", options->header,
               "Write the whole node as the C++ header that is flashed, under one checksum; only if certified");
  files.writes("--law-image", options->law_image,
               "Write the law of each axis for programs in C (breakaway/law.h): bytes, or an array where the file "
               "ends in .h; only if certified");
  command->footer(
      std::string{
          "Example: breakaway design sim/scenarios/can_axis.toml --report design.html --header flashed_node.hpp\n"} +
      exit_codes);
  files.then([options, &exit_code] { exit_code = design_file(*options); });
}

}  // namespace breakaway::cli
