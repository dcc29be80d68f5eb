// Identifies an axis by a safe experiment, on its emulated drive, or from a record.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/edited_file.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/evaluation/record_csv.hpp"
#include "breakaway/evaluation/summary.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/shell_word.hpp"
#include "breakaway/report/identification_report.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/study/identification.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "progress.hpp"

namespace breakaway::cli {
namespace {

using scenario::Scenario;

constexpr std::size_t most_of_a_record = std::size_t{1} << 28;  // bytes: an hour at 10 kHz

struct IdentifyCommand {
  std::string scenario, axis, log, output, report, json, csv;
  config::ExperimentRequest request;
  std::vector<const CLI::Option*> of_an_experiment;  // and of no record
  bool progress = false;
  bool quiet() const { return output == "-" || report == "-" || json == "-" || csv == "-"; }
};

Scenario read_identified_axis(const std::string& file, const std::string& name) {
  Scenario s = scenario::read_scenario(file);
  if (!s.machine && !name.empty()) s = only_axis(s, name);
  if (!s.machine && s.axes() > 1)
    throw InputError{config::shown_name(file) + ": has several axes: say which to identify with --axis NAME"};
  return s;
}

study::IdentifiedRun run(const IdentifyCommand& options, const Scenario& s) {
  if (!options.log.empty())
    return study::recorded_identification(s, config::file_contents(options.log, most_of_a_record),
                                          config::shown_name(options.log));
  Progress progress{"experiment", options.progress};
  return study::run_identification(s, options.request, [&](double share) {
    progress.tell(share);
    return true;
  });
}

void print_identification(const study::IdentifiedRun& run) {
  if (!run.title.empty()) fmt::print("{}\n", run.title);
  fmt::print("  experiment     {:.1f} s, {}\n{}", run.found.duration_s, run.ending, evaluation::summary(run.found));
  const evaluation::LatencyEstimate& latency = run.found.latency;
  if (latency.most_periods < 1)
    fmt::print(
        "  note           design and flashed loop count on a latency of 1 period; this record is of a loop whose "
        "forces "
        "act before the next sample\n");
  if (latency.fewest_periods > 1)
    fmt::print(
        "  note           design and flashed loop count on a latency of 1 period; find what takes {}: a drive that "
        "answers late, or a filter\n",
        latency.periods);
  if (!latency.is_told_apart())
    fmt::print(
        "  note           [drive] current_loop_time_constant_s is left as it is; an experiment with steadier periods "
        "tells it (a kernel for real time, a drive that samples at the SYNC)\n");
}

// What was found may ask for other gains than the file has, or forbid its tolerance: `tune` chooses those. For a PID
// there is neither certificate nor choice. No file tells of another latency, so that a certificate would not be that of
// the loop in the record.
void print_next(const IdentifyCommand& options, const std::string& text, const std::string& name, bool late) {
  const config::Node node = config::parse_node(text, options.output);
  const auto axis = std::ranges::find(node.axes, name, &config::Axis::name);
  const bool pid = axis->controller.pid.has_value();
  if (late && !pid)
    return fmt::print(
        "  certificate    none: the forces of this loop act too late\n"
        "next: breakaway identify {} again, when the latency is 1 period\n",
        shell_word(options.scenario));
  const std::string why_not = pid ? "" : config::why_not_certified(node, *axis);
  if (why_not.empty())
    return fmt::print("next: breakaway {} {}\n", pid ? "simulate" : "design", shell_word(options.output));
  fmt::print("  certificate    none: {}\n", why_not);
  std::filesystem::path tuned{options.output};
  tuned.replace_filename(tuned.stem().string() + "_tuned.toml");
  fmt::print("next: breakaway tune {}{} -o {}    (it chooses coast, gains and tolerance)\n", shell_word(options.output),
             node.axes.size() > 1 ? " --axis " + name : "", shell_word(tuned.string()));
}

// A record has its travel and its duration already.
void require_experiment(const IdentifyCommand& options) {
  if (options.log.empty()) return;
  for (const CLI::Option* option : options.of_an_experiment) {
    if (option->count() > 0)
      throw InputError{
          fmt::format("{}: says how to make an experiment, and --log has the record of one; leave one of the two out",
                      option->get_name())};
  }
}

int identify_axis(const IdentifyCommand& options) {
  require_experiment(options);
  const Scenario s = read_identified_axis(options.scenario, options.axis);
  study::IdentifiedRun run = cli::run(options, s);
  // A run that ended early is kept for whoever wants to see why it tells nothing.
  if (!options.csv.empty()) format::write_output(options.csv, evaluation::to_csv(run.record));
  study::evaluate(run);
  const std::string file =
      options.output.empty()
          ? ""
          : config::moved_text(study::with_found(config::file_contents(options.scenario), s, run.found),
                               options.scenario, options.output);
  if (!options.report.empty()) format::write_output(options.report, report::identification_html(run));
  if (!options.json.empty()) format::write_output(options.json, report::identification_json(run));
  if (!file.empty()) format::write_output(options.output, file);
  if (options.quiet()) return run.complete ? done : failed_check;
  print_identification(run);
  for (const std::string& path : {options.csv, options.report, options.json, options.output})
    if (!path.empty()) fmt::print("  written        {}\n", path);
  if (!file.empty()) print_next(options, file, s.node.axes.front().name, run.found.latency.fewest_periods > 1);
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
  const auto of_an_experiment = [&](const char* name, double& to, const char* says) {
    CLI::Option* option = command->add_option(name, to, says);
    options->of_an_experiment.push_back(option);
    return option;
  };
  of_an_experiment("--from", options->request.lowest_m, "Lower end of the travel [m] instead of [limits]")
      ->check(finite_number);
  of_an_experiment("--to", options->request.highest_m, "Upper end of the travel [m] instead of [limits]")
      ->check(finite_number);
  of_an_experiment("--duration", options->request.duration_s, "Seconds that the experiment may take (60)")
      ->check(positive_number);
  files.reads("--log", options->log,
              "Evaluate this record instead, as `breakaway-node --csv` or --csv here writes it; without --from, --to "
              "and --duration, which are for an experiment");
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
