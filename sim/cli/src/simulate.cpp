#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <variant>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/report/accuracy_json.hpp"
#include "breakaway/report/formats.hpp"
#include "breakaway/report/html.hpp"
#include "breakaway/report/machine_report.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/margins.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "progress.hpp"
#include "sync_off.hpp"

namespace breakaway::cli {
namespace {

using scenario::MachineScenario;
using scenario::Scenario;
using sil::AxisResult;
using sil::MachineResult;
using sil::Result;

struct SimulateCommand {
  std::string scenario, json, csv, candump, report;
  std::optional<double> accuracy_m;
  bool progress = false;
  std::array<std::string, 4> outputs() const { return {json, csv, candump, report}; }
  bool quiet() const { return std::ranges::count(outputs(), "-") > 0; }
  sil::RecordingOptions recording(Progress& progress_line) const {
    sil::RecordingOptions recorded{.trace = !csv.empty() || !report.empty(), .frames = !candump.empty()};
    if (progress_line.shown()) recorded.progress = [&](double share) { progress_line.tell(share); };
    return recorded;
  }
};

std::string instant(double time_s) { return std::isnan(time_s) ? "never" : fmt::format("{:.7g} s", time_s); }

void print_axis(const config::Axis& described, const AxisResult& axis, double duration_s) {
  if (axis.settled) {
    fmt::print("  settled        at {:.6g} s\n", axis.settling_time_s);
  } else {
    fmt::print("  NOT settled    within {:.6g} s\n", duration_s);
  }
  fmt::print("  final error    {:.3g} m\n  kicks          {}\n", axis.final_error_m, axis.kicks.size());
  if (axis.ideal) {
    fmt::print("  t1, t2, t_inf  {}, {}, {}", instant(axis.ideal->t1_s), instant(axis.ideal->t2_s),
               instant(axis.ideal->t_inf_s));
    // There is a bound where the law is told the truth.
    const double bound_s = axis.ideal->bound_s;
    fmt::print("{}\n", std::isfinite(bound_s) ? fmt::format(" (bound {:.7g} s)", bound_s) : "");
  } else {
    fmt::print("  largest force  {:.4g} N\n", axis.max_force_N);
    if (axis.excursions)
      fmt::print("  past target    {:.3g} m, {:.3g} m by a kick; at most {:.3g} m/s\n", axis.excursions->overshoot_m,
                 axis.excursions->beyond_m, axis.excursions->peak_speed_m_s);
    if (axis.excursions) {
      fmt::print("  way            {:.6g} to {:.6g} m\n", axis.excursions->lowest_m, axis.excursions->highest_m);
      fmt::print("  margins        {}\n", sil::to_text(sil::margins(described, *axis.excursions, axis.max_force_N)));
    }
  }
  if (axis.load_position_m) fmt::print("  load at        {:.9g} m\n", *axis.load_position_m);
  if (!axis.told.empty()) fmt::print("  told           {}\n", axis.told);
  if (axis.encoder_noise_seed) fmt::print("  encoder noise  seed {}\n", *axis.encoder_noise_seed);
  for (const auto& fault : axis.faults) fmt::print("  FAULT          {} at {:.6g} s\n", fault.name, fault.time_s);
}

void print_accuracy(const std::optional<sil::Accuracy>& accuracy) {
  if (!accuracy) return;
  fmt::print("  method         {}\n  error          about {:.2g} m, of {:g} m allowed\n", to_string(accuracy->method),
             accuracy->error_estimate_m, accuracy->asked_m);
}

void print_certificate(const config::Node& node, const config::Axis& axis, const scenario::AxisWorld& world,
                       const std::optional<sil::LoopFigures>& loop) {
  if (!axis.controller.impulsive) return;
  const std::string why_not = config::why_not_certified(node, axis);
  const std::string outside = config::outside_certificate(axis, world.position_m, world.velocity_m_s);
  const std::string yes = outside.empty() ? "yes" : "yes, but not of this run: " + outside;
  fmt::print("  certificate    {}\n", why_not.empty() ? yes : "none: " + why_not);
  if (why_not.empty() && loop) print_sync_off("  SYNC           ", axis, loop->sync_off_s);
}

void print_figures(const Scenario& s, const Result& r) {
  for (std::size_t i = 0; i < r.axes.size(); ++i) {
    if (s.axes() > 1) fmt::print("  axis {}\n", r.axes[i].name);
    print_axis(s.node.axes[i], r.axes[i], r.duration_s);
    print_certificate(s.node, s.node.axes[i], s.worlds[i], r.loop);
  }
  if (r.loop) {
    fmt::print("  bus load       {:.1f} %\n  control ticks  {} ({} missed)\n", 100 * r.loop->bus_load, r.loop->ticks,
               r.loop->missed_ticks);
  }
  print_accuracy(r.accuracy);
}

void print_figures(const MachineScenario&, const MachineResult& r) {
  const auto& end = r.outcome.end;
  fmt::print("  {:<14} at {:.9g} s\n", r.settled() ? "at rest" : "NOT at rest", end.time_s);
  for (Eigen::Index i = 0; i < end.q.size(); ++i) {
    fmt::print("  q{:<13} {:.9g} m, {:.9g} m/s\n", i + 1, end.q[i], end.v[i]);
  }
  fmt::print("  events         {}\n", r.events.size());
  if (r.proved != hybrid::Verdict::undecided) {
    const bool captured = r.proved == hybrid::Verdict::captured;
    fmt::print("  certified      {}{}\n", captured ? "to come to rest" : "never to come to rest",
               captured && !r.settled() ? ", which says nothing of when: a longer [run] duration_s shows it" : "");
  }
  print_accuracy(r.accuracy);
}

const std::string& title(const Scenario& s) { return s.node.title; }
const std::string& title(const MachineScenario& s) { return s.title; }

// Why there are no frames to write; nothing where there are.
const char* why_no_bus(const Scenario& s) {
  return s.ideal() ? "the scenario has no bus; give it a [loop] and a [drive], or leave this out" : nullptr;
}
const char* why_no_bus(const MachineScenario&) { return "a [machine] has no bus; leave this out"; }

std::string frames_of(const Result& result) { return report::to_candump(result); }
std::string frames_of(const MachineResult&) { return {}; }

const std::string& warning(const Result&) {
  static const std::string none;
  return none;
}
const std::string& warning(const MachineResult& result) { return result.warning; }

bool asks_for_accuracy(const Scenario& s) { return s.run && s.run->accuracy_m; }
bool asks_for_accuracy(const MachineScenario& s) { return s.accuracy_m.has_value(); }

void check_frames(const SimulateCommand& options, const char* no_bus) {
  if (!options.candump.empty() && no_bus != nullptr) throw InputError{fmt::format("--candump: {}", no_bus)};
}

template <class AnyScenario, class AnyResult>
void print_summary(const SimulateCommand& options, const AnyScenario& scenario, const AnyResult& result) {
  if (!title(scenario).empty()) fmt::print("{}\n", title(scenario));
  print_figures(scenario, result);
  for (const std::string& path : options.outputs()) {
    if (!path.empty()) fmt::print("  written        {}\n", path);
  }
}

template <class AnyScenario>
int simulate_scenario(const SimulateCommand& options, const AnyScenario& scenario) {
  check_frames(options, why_no_bus(scenario));
  Progress progress{"simulating", options.progress};
  if (asks_for_accuracy(scenario)) progress.say("choosing the method");
  const auto result = sil::run_scenario(scenario, options.recording(progress));
  if (!warning(result).empty()) fmt::print(stderr, "breakaway: warning: {}\n", warning(result));
  if (!options.report.empty()) progress.say("drawing the pictures");
  // Everything is ready before the first file is written: an error here leaves no file behind.
  const std::string html = options.report.empty() ? "" : report::to_html(scenario, result);
  if (!options.json.empty()) format::write_output(options.json, report::to_json(scenario, result));
  if (!options.csv.empty()) format::write_output(options.csv, report::to_csv(scenario, result));
  if (!options.candump.empty()) format::write_output(options.candump, frames_of(result));
  if (!options.report.empty()) format::write_output(options.report, html);
  if (!options.quiet()) print_summary(options, scenario, result);
  return result.settled() ? done : failed_check;
}

void ask_for(double accuracy_m, Scenario& scenario) {
  if (scenario.run) scenario.run->accuracy_m = accuracy_m;
}
void ask_for(double accuracy_m, MachineScenario& scenario) { scenario.accuracy_m = accuracy_m; }

int simulate(const SimulateCommand& options) try {
  auto any = scenario::read_any_scenario(options.scenario);
  return std::visit(
      [&](auto& scenario) {
        if (options.accuracy_m) ask_for(*options.accuracy_m, scenario);
        return simulate_scenario(options, scenario);
      },
      any);
} catch (const sil::AccuracyRefused& refusal) {
  if (!options.json.empty()) format::write_output(options.json, report::to_json(refusal));
  throw;
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<SimulateCommand>();
  CLI::App* command =
      app.add_subcommand("simulate", "Simulate a scenario: does the axis or machine settle, when and how well?");
  CallFiles files{*command};
  files.reads("scenario", options->scenario, "The scenario, a TOML file")->required();
  files.writes("--json", options->json, "Write all figures as JSON to this file; - is standard output");
  files.writes("--csv", options->csv,
               "Write the samples of the run to this file; - is standard output; friction_level_N is nan at rest");
  files.writes("--candump", options->candump, "Write the bus traffic in candump's log format to this file");
  files.writes_page("--report", options->report, "Write a report with pictures to this HTML file (needs gnuplot)");
  command
      ->add_option("--accuracy", options->accuracy_m,
                   "Allow this error (m), and take the cheapest method that holds it: [run] accuracy_m")
      ->check(positive_number);
  add_progress(*command, options->progress);
  command->footer(
      std::string{"Example: breakaway simulate sim/scenarios/impulsive_example.toml --json - --report example.html\n"} +
      exit_codes);
  files.then([options, &exit_code] { exit_code = simulate(*options); });
}

}  // namespace breakaway::cli
