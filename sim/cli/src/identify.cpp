// Identifies an axis by a safe experiment, on its emulated drive, or from a record.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/experiment.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/identified.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/evaluation/identification.hpp"
#include "breakaway/evaluation/record_csv.hpp"
#include "breakaway/evaluation/summary.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/shell_word.hpp"
#include "breakaway/report/identification_report.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_experiment.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "progress.hpp"

namespace breakaway::cli {
namespace {

using evaluation::Identification;
using scenario::Scenario;

constexpr std::size_t most_of_a_record = std::size_t{1} << 28;  // bytes: an hour at 10 kHz

struct IdentifyCommand {
  std::string scenario, axis, log, output, report, json, csv;
  config::ExperimentRequest request;
  bool progress = false;
  bool quiet() const { return output == "-" || report == "-" || json == "-" || csv == "-"; }
};

Scenario read_identified_axis(const std::string& file, const std::string& name) {
  Scenario s = scenario::read_scenario(file);
  if (s.machine)
    throw InputError{config::shown_name(file) +
                     ": an experiment identifies an axis that moves alone, and this one is part of a [machine]"};
  if (!name.empty()) s = only_axis(s, name);
  if (s.axes() > 1)
    throw InputError{config::shown_name(file) + ": has several axes: say which to identify with --axis NAME"};
  return s;
}

report::IdentifiedRun experiment(const IdentifyCommand& options, const Scenario& s) {
  const auto parameters = config::experiment_parameters<double>(s.node, s.node.axes.front(), options.request);
  Progress progress{"experiment", options.progress};
  const auto tell = [&](double share) {
    progress.tell(share);
    return true;
  };
  sil::ExperimentRun run = sil::run_experiment(s, parameters, tell);
  const std::string ending{to_string(run.ending)};
  if (!run.fault.empty())
    throw InputError{fmt::format("{}: the experiment was stopped by \"{}\"{}", config::shown_name(options.scenario),
                                 run.fault, run.ending == identify::Ending::none ? "" : ": " + ending)};
  if (run.ending == identify::Ending::no_room)
    throw InputError{fmt::format("{} (it begins at {:g} m, and the travel is from {:g} to {:g} m)", ending,
                                 s.worlds.front().position_m, parameters.lowest_m, parameters.highest_m)}
        .in_file(config::shown_name(options.scenario));
  return {.title = s.node.title,
          .source = "an experiment on the emulated drive of " + config::shown_name(options.scenario),
          .ending = ending,
          .complete = run.ending == identify::Ending::complete,
          .record = std::move(run.record),
          .found = {}};
}

evaluation::Record read_record(const std::string& file, const evaluation::RecordUnits& units) {
  const std::string text = config::file_contents(file, most_of_a_record);
  try {
    return evaluation::record_of_csv(text, units);
  } catch (const InputError& error) {
    throw error.in_file(config::shown_name(file));
  }
}

// What was recorded elsewhere, in units of the file's drive.
report::IdentifiedRun recorded(const IdentifyCommand& options, const Scenario& s) {
  const config::Axis& axis = s.node.axes.front();
  if (!s.node.loop || !axis.drive)
    throw InputError{"[loop] and [drive] are needed, which say what a period and a count are"}.in_file(
        config::shown_name(options.scenario));
  const evaluation::RecordUnits units{.period_s = s.node.period_s(),
                                      .resolution_m = axis.drive->encoder_resolution_m,
                                      .force_step_N = config::force_step_N(axis),
                                      .axis = axis.name};
  return {.title = s.node.title,
          .source = config::shown_name(options.log),
          .ending = "a record from elsewhere",
          .complete = true,
          .record = read_record(options.log, units),
          .found = {}};
}

// An experiment that ended early tells why its record says too little.
Identification evaluated(const IdentifyCommand& options, const report::IdentifiedRun& run) try {
  return evaluation::evaluate(run.record);
} catch (const InputError& error) {
  const InputError whole = run.complete ? error : InputError{fmt::format("{} ({})", error.what(), run.ending)};
  throw whole.in_file(config::shown_name(options.log.empty() ? options.scenario : options.log));
}

std::string identified_file(const IdentifyCommand& options, const config::Axis& axis, const Identification& found) {
  const evaluation::LatencyEstimate& latency = found.latency;
  config::IdentifiedAxis entered{.mass_kg = found.mass.mass_kg,
                                 .mass_uncertainty = found.mass_uncertainty,
                                 .friction_lower_N = found.bounds_N.least,
                                 .friction_upper_N = found.bounds_N.most};
  // The only coast that is told of it.
  if (axis.controller.impulsive && axis.controller.impulsive->coast == law::Coast::brake)
    entered.presliding_stiffness_N_per_m = found.presliding_N_per_m;
  if (latency.lag_is_seen) {
    entered.lag_s = latency.lag_s;
    entered.lag_uncertainty = std::max(0.2, 3 * latency.lag_error_s / latency.lag_s);
  }
  return config::with_identified(config::file_contents(options.scenario), config::shown_name(options.scenario),
                                 axis.name, entered);
}

void print_identification(const report::IdentifiedRun& run) {
  if (!run.title.empty()) fmt::print("{}\n", run.title);
  fmt::print("  experiment     {:.1f} s, {}\n{}", run.found.duration_s, run.ending, evaluation::summary(run.found));
  if (run.found.latency.periods != 1)
    fmt::print(
        "  note           design and flashed loop count on a latency of 1 period; find what takes {}: a drive that "
        "answers late, or a filter\n",
        run.found.latency.periods);
}

// What was found may ask for other gains than the file has, or forbid its tolerance: `tune` chooses those. For a PID
// there is neither certificate nor choice.
void print_next(const IdentifyCommand& options, const std::string& text, const std::string& name) {
  const config::Node node = config::parse_node(text, options.output);
  const auto axis = std::ranges::find(node.axes, name, &config::Axis::name);
  const bool pid = axis->controller.pid.has_value();
  const std::string why_not = pid ? "" : config::why_not_certified(node, *axis);
  if (why_not.empty())
    return fmt::print("next: breakaway {} {}\n", pid ? "simulate" : "design", shell_word(options.output));
  fmt::print("  certificate    none: {}\n", why_not);
  std::filesystem::path tuned{options.output};
  tuned.replace_filename(tuned.stem().string() + "_tuned.toml");
  fmt::print("next: breakaway tune {}{} -o {}    (it chooses coast, gains and tolerance)\n", shell_word(options.output),
             node.axes.size() > 1 ? " --axis " + name : "", shell_word(tuned.string()));
}

int identify_axis(const IdentifyCommand& options) {
  const Scenario s = read_identified_axis(options.scenario, options.axis);
  report::IdentifiedRun run = options.log.empty() ? experiment(options, s) : recorded(options, s);
  // A run that ended early is kept for whoever wants to see why it tells nothing.
  if (!options.csv.empty()) format::write_output(options.csv, evaluation::to_csv(run.record));
  run.found = evaluated(options, run);
  const std::string file = options.output.empty() ? "" : identified_file(options, s.node.axes.front(), run.found);
  if (!options.report.empty()) format::write_output(options.report, report::identification_html(run));
  if (!options.json.empty()) format::write_output(options.json, report::identification_json(run));
  if (!file.empty()) format::write_output(options.output, file);
  if (options.quiet()) return run.complete ? done : failed_check;
  print_identification(run);
  for (const std::string& path : {options.csv, options.report, options.json, options.output})
    if (!path.empty()) fmt::print("  written        {}\n", path);
  if (!file.empty()) print_next(options, file, s.node.axes.front().name);
  return run.complete ? done : failed_check;
}

}  // namespace

void add_identify(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<IdentifyCommand>();
  CLI::App* command = app.add_subcommand(
      "identify", "Find mass, friction and latency of an unknown axis by a safe experiment on its emulated drive");
  CallFiles files{*command};
  files
      .reads("scenario", options->scenario,
             "The axis: its [plant] and [friction] are the truth, which the experiment is not told")
      ->required();
  command->add_option("--axis", options->axis, "The name of the axis to identify, where the file has several");
  command->add_option("--from", options->request.lowest_m, "Lower end of the travel [m] instead of [limits]")
      ->check(finite_number);
  command->add_option("--to", options->request.highest_m, "Upper end of the travel [m] instead of [limits]")
      ->check(finite_number);
  command->add_option("--duration", options->request.duration_s, "Seconds that the experiment may take (60)")
      ->check(positive_number);
  files.reads("--log", options->log, "Evaluate this record instead, as `breakaway-node --csv` or --csv here writes it");
  files.makes("-o,--output", options->output, "Write the file with what was found in it, for `breakaway design`");
  files.writes_page("--report", options->report, "Write a report with pictures to this HTML file (needs gnuplot)");
  files.writes("--json", options->json, "Write all figures as JSON to this file; - is standard output");
  files.writes("--csv", options->csv, "Write positions and forces of the experiment to this file");
  add_progress(*command, options->progress);
  command->footer(
      std::string{"Example: breakaway identify sim/scenarios/braked_axis.toml --from -4.5 --to -3.5 -o found.toml\n"} +
      exit_codes);
  files.then([options, &exit_code] { exit_code = identify_axis(*options); });
}

}  // namespace breakaway::cli
