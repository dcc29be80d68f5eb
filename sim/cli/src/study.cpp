#include "breakaway/study/friction_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/shell_word.hpp"
#include "breakaway/report/study_html.hpp"
#include "breakaway/report/study_json.hpp"
#include "breakaway/report/study_junit.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/margins.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "breakaway/study/requirement.hpp"
#include "breakaway/study/study_table.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "progress.hpp"
#include "shard_option.hpp"
#include "sync_off.hpp"

namespace breakaway::cli {
namespace {

using namespace study;
using scenario::Scenario;

struct StudyCommand {
  std::string scenario, against, axis, json, junit, report, csv, shard = "0/1";
  std::vector<std::string> required, merge;
  std::vector<std::pair<double, double>> starts;
  StudyOptions study;
  bool progress = false;
};

struct Study {
  std::string file;  // as the command has it
  std::string name;  // as messages have it
  std::string axis;  // that was asked for, if any
  Scenario scenario;
  std::vector<StudyRow> rows;
};

// Returns the axis of this name, or the only one.
Scenario read_studied_axis(const std::string& file, const std::string& axis) {
  Scenario s = scenario::read_scenario(file);
  if (!s.machine && !axis.empty()) s = only_axis(s, axis);
  if (!s.machine && s.axes() > 1)
    throw InputError{config::shown_name(file) + ": has several axes: say which to study with --axis NAME"};
  return studied_axis(std::move(s));
}

// The starts that are named are those of the option.
void require_starts_within_limits(const Study& study, const StudyCommand& command) try {
  for (const auto& [position_m, velocity_m_s] : command.starts)
    require_within_limits(study.scenario, {position_m, velocity_m_s});
} catch (const InputError& error) {
  throw InputError{fmt::format("--start {}", error.what())};
}

std::string table_label(const StudyCommand& command, const StudyOptions& options) {
  return study_table_label(config::file_contents(command.scenario), command.axis, options);
}

// The runs of one file, done here or, if they are to be merged, elsewhere.
Study run(const std::string& file, const StudyCommand& command, StudyOptions options) {
  Study study{file, config::shown_name(file), command.axis, read_studied_axis(file, command.axis), {}};
  require_starts_within_limits(study, command);
  if (!command.merge.empty()) {
    study.rows = merged_study(command.merge, table_label(command, options), options);
    return study;
  }
  Progress progress{study.name, command.progress};
  options.progress = [&](int done, int all) { progress.tell(static_cast<double>(done) / all); };
  study.rows = run_study(study.scenario, options);
  return study;
}

// Whether a run under each law ended at rest within the tolerance, without a fault.
bool all_settled(const Study& study) {
  return std::all_of(study.rows.begin(), study.rows.end(),
                     [](const StudyRow& row) { return settled_runs(row) == row.runs.size(); });
}

std::string time_text(double time_s) { return std::isfinite(time_s) ? fmt::format("{:.3f} s", time_s) : "never"; }

// The first time from which every run stayed within the level; "never" if one did not.
std::string worst_time_within(const StudyRow& row, std::size_t level) {
  double worst = 0;
  for (const StudyRun& run : row.runs) {
    if (level >= run.reached.size() || std::isnan(run.reached[level].time_s)) return "never";
    worst = std::max(worst, run.reached[level].time_s);
  }
  return time_text(worst);
}

void print_rows(const Study& study) {
  for (const StudyRow& row : study.rows) {
    fmt::print(
        "{:<10} {:>7g} m {:>4g} m/s {:>4}/{:<4} {:>9} {:>9} {:>11} {:>9.2e} m {:>9.2e} m {:>7} {:>7} {:>8.2f} N\n",
        report::controller_name(study.scenario.node), row.start.position_m, row.start.velocity_m_s, settled_runs(row),
        row.runs.size(), time_text(median_settling_time_s(row)), time_text(worst_settling_time_s(row)),
        worst_time_within(row, 0), worst_error_m(row), worst_excursions(row).beyond_m, limit_cycles(row),
        faulted_runs(row), largest_force_N(row));
  }
}

// The command that runs the worst law again, without the others but the fixed ones.
std::string again(const Study& study, const StudyRow& row, const StudyOptions& options) {
  const std::size_t place = slowest_run(row).place;
  const bool random = place >= fixed_laws;
  return fmt::format("breakaway study {}{} --start {:.12g} {:.12g} --laws {:d} --seed {}", shell_word(study.file),
                     study.axis.empty() ? "" : " --axis " + shell_word(study.axis), row.start.position_m,
                     row.start.velocity_m_s, random,
                     options.seed + (random ? static_cast<std::uint64_t>(place - fixed_laws) : 0));
}

void print_slowest(const Study& study, const StudyOptions& options) {
  for (const StudyRow& row : study.rows) {
    const StudyRun& slowest = slowest_run(row);
    fmt::print("worst from {:g} m: {}, {}; again: {}\n", row.start.position_m, slowest.law,
               time_text(slowest.settled ? slowest.settling_time_s : NAN), again(study, row, options));
    fmt::print("  margins to the limits: {}\n", sil::to_text(margins(study.scenario.node, row)));
  }
}

void print_told(const std::vector<Study>& studies) {
  for (const Study& study : studies) {
    const std::string told = config::told_otherwise(study.scenario.node.axes.front());
    if (!told.empty()) fmt::print("{}: the controller is told {}\n", study.name, told);
  }
}

// What the runs below are to be held against.
void print_certificate(const Study& study) {
  const config::Node& node = study.scenario.node;
  if (node.axes.front().controller.pid) return;
  const std::string why_not = config::why_not_certified(node, node.axes.front());
  fmt::print("{}: {}\n", study.name, why_not.empty() ? "certified" : "not certified: " + why_not);
  if (!why_not.empty()) return;
  for (const StudyRow& row : study.rows)
    if (const std::string outside =
            config::outside_certificate(node.axes.front(), row.start.position_m, row.start.velocity_m_s);
        !outside.empty())
      fmt::print("  from {:g} m it is not: {}\n", row.start.position_m, outside);
  double off_s = 0;
  for (const StudyRow& row : study.rows) off_s = std::max(off_s, sync_off_s(row));
  print_sync_off("SYNC of these runs was ", node.axes.front(), off_s);
}

void print_table(const std::vector<Study>& studies, const StudyOptions& options) {
  const config::Node& node = studies.front().scenario.node;
  const config::Axis& axis = node.axes.front();
  fmt::print(
      "Friction between {:g} N and {:g} N: both bounds, the scenario's law, static/kinetic, {} random laws (seeds from "
      "{})\n",
      config::truth_of(axis).bounds.lower_N, config::truth_of(axis).bounds.upper_N, options.random_laws, options.seed);
  if (options.shard.count > 1)
    fmt::print("Of these, part {} of {} only\n", options.shard.index == 0 ? options.shard.count : options.shard.index,
               options.shard.count);
  print_told(studies);
  for (const Study& study : studies) print_certificate(study);
  fmt::print("Settled: at rest within {:g} m for {:g} s, force at most {:g} N\n\n", judged_tolerance_m(node, axis),
             studies.front().scenario.run->settle_time_s, sil::most_true_N(axis));
  fmt::print("{:<10} {:>18} {:>9} {:>9} {:>9} {:>11} {:>11} {:>11} {:>7} {:>7} {:>10}\n", "law", "start", "settled",
             "median", "worst", "worst 1 mm", "worst error", "beyond", "cycles", "faults", "peak");
  for (const Study& study : studies) print_rows(study);
  fmt::print("\n");
  for (const Study& study : studies) print_slowest(study, options);
}

std::string json(const std::vector<Study>& studies, const StudyOptions& options) {
  std::vector<report::StudiedAxis> axes;
  axes.reserve(studies.size());
  for (const Study& study : studies) axes.push_back({study.name, study.scenario.node, study.rows});
  return report::to_json(axes, options);
}

std::string junit(const std::vector<Study>& studies, const std::vector<Requirement>& required) {
  std::vector<report::StudiedFile> files;
  files.reserve(studies.size());
  for (const Study& study : studies) files.push_back({study.name, study.rows});
  return report::to_junit(files, required);
}

std::string html(const std::vector<Study>& studies, const StudyOptions& options) {
  std::vector<report::ReportedStudy> reported;
  for (const Study& study : studies) {
    report::ReportedStudy one{study.name, study.scenario.node, {}};
    for (const StudyRow& row : study.rows)
      one.rows.push_back(
          {row, run_again(study.scenario, options, row.start, slowest_run(row).place), again(study, row, options)});
    reported.push_back(std::move(one));
  }
  return report::study_html(reported);
}

// Whether the first scenario keeps all that is required of it; what it does not keep is said.
bool keeps(const Study& study, const std::vector<Requirement>& required) {
  bool all = true;
  for (const StudyRow& row : study.rows) {
    for (const std::string& sentence : broken(required, row)) {
      fmt::print(stderr, "breakaway: {}: {}\n", study.name, sentence);
      all = false;
    }
  }
  return all;
}

void require_one_table(const StudyCommand& options, const Shard& shard) {
  if (!options.against.empty() && (shard.count > 1 || !options.merge.empty() || !options.csv.empty()))
    throw InputError{"--against: a table has the runs of one scenario: leave out --shard, --merge and --csv"};
  if (!options.merge.empty() && shard.count > 1) throw InputError{"--merge joins whole shards: leave out --shard"};
}

int study(const StudyCommand& options) {
  StudyOptions what = options.study;
  what.shard = read_shard(options.shard);
  require_one_table(options, what.shard);
  std::vector<Requirement> required;
  for (const std::string& text : options.required) required.push_back(read_requirement(text));
  for (const auto& [position_m, velocity_m_s] : options.starts) what.starts.push_back({position_m, velocity_m_s});
  if (what.starts.empty()) what.starts = default_starts(read_studied_axis(options.scenario, options.axis));
  std::vector<Study> studies{run(options.scenario, options, what)};
  if (!options.against.empty()) studies.push_back(run(options.against, options, what));
  // Everything is ready before the first file is written: an error here leaves no file behind.
  const std::string page = options.report.empty() ? "" : html(studies, what);
  if (!options.csv.empty())
    format::write_output(options.csv, study_table_parts(studies.front().rows, table_label(options, what)));
  if (!options.json.empty()) format::write_output(options.json, json(studies, what));
  if (!page.empty()) format::write_output(options.report, page);
  if (!options.junit.empty()) format::write_output(options.junit, junit(studies, required));
  if (options.json != "-" && options.junit != "-" && options.report != "-" && options.csv != "-")
    print_table(studies, what);
  const bool kept = keeps(studies.front(), required);
  return kept && all_settled(studies.front()) ? done : failed_check;
}

}  // namespace

void add_study(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<StudyCommand>();
  CLI::App* command =
      app.add_subcommand("study", "Run an axis under every friction law of its class, from several starts");
  CallFiles files{*command};
  files.reads("scenario", options->scenario, "The scenario; its own start is not used")->required();
  files.reads("--against", options->against, "Another scenario to run under the same laws, to compare with");
  command->add_option("--axis", options->axis, "The name of the axis to study, where the scenario has several");
  command->add_option("--laws", options->study.random_laws, "Random laws beside the four fixed ones, default 100")
      ->check(whole_number_between(0, 1'000'000));
  command->add_option("--seed", options->study.seed, "Seed of the first random law, default 1")->check(whole_number);
  command
      ->add_option(
          "--start", options->starts,
          "Position in m and velocity in m/s; may be repeated; default -4 -4, -0.1 0, -0.01 0, within the limits")
      ->type_name("POSITION VELOCITY")
      ->delimiter(',')
      ->allow_extra_args(false)  // a third number would be a position without a velocity
      ->check(finite_number);
  files.writes("--json", options->json, "Write every run as JSON to this file; - is standard output");
  command
      ->add_option("--require", options->required,
                   "Exit with 1 unless this holds from every start, as 'worst_settling_s<=0.5'; may be repeated")
      ->allow_extra_args(false);
  files.writes("--junit", options->junit,
               "Write runs and requirements as JUnit's XML to this file; - is standard output");
  files.writes("--csv", options->csv, "Write a line a run to this file, for --merge; - is standard output");
  command->add_option("--shard", options->shard, "Only part i of n of the runs, as i/n, for --merge");
  files.reads("--merge", options->merge, "Simulate nothing: join these tables, by --csv, of shards");
  files.writes_page("--report", options->report,
                    "Write a page with histograms and the worst law of each start to this HTML file (needs gnuplot)");
  add_progress(*command, options->progress);
  command->footer(
      std::string{"Example: breakaway study sim/scenarios/can_axis.toml --against sim/scenarios/can_axis_pid.toml\n"
                  "         breakaway study axis.toml --laws 1000000 --shard 1/64 --csv 1.csv    (and 2/64 to 64/64, "
                  "elsewhere)\n"
                  "         breakaway study axis.toml --laws 1000000 --merge *.csv --report study.html\n"} +
      exit_codes);
  files.then([options, &exit_code] { exit_code = study(*options); });
}

}  // namespace breakaway::cli
