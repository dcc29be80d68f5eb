#include "breakaway/study/tune.hpp"
#include "breakaway/config/edited_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>

#include "breakaway/config/file_contents.hpp"
#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/report/tune_json.hpp"
#include "breakaway/report/tune_picture.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "progress.hpp"

namespace breakaway::cli {
namespace {

using study::DoubledLimit;
using study::Gains;
using study::Objective;
using study::TunedPoint;
using study::Tuning;

struct TuneCommand {
  std::string file, output, json, picture;
  std::string objective = "time";
  study::TuneOptions tune;
  bool progress = false;
  bool quiet() const { return json == "-" || output == "-"; }
};

void print_limit(const DoubledLimit& limit, const Tuning& tuning) {
  if (!limit.why_not.empty()) return fmt::print("  {:<28} {}: {}\n", limit.name, limit.change, limit.why_not);
  fmt::print("  {:<28} {}: {:.3f} s instead of {:.3f} s", limit.name, limit.change, limit.best.worst_settling_s,
             tuning.chosen.worst_settling_s);
  const double now_m = limit.least_tolerance_m, before_m = tuning.least_tolerance_m;
  if (now_m > 0 && now_m == before_m) fmt::print(", certified to the same {:g} m", now_m);
  if (now_m > 0 && now_m != before_m) fmt::print(", certified to {:g} m instead of {:g} m", now_m, before_m);
  if (tuning.objective == Objective::gentle)
    fmt::print(", with {:.4g} N instead of {:.4g} N", limit.best.peak_force_N, tuning.chosen.peak_force_N);
  fmt::print("{}\n", limit.gain > 0 || now_m < before_m ? "" : ", which gains nothing");
}

void print_limits(const Tuning& tuning) {
  if (tuning.limits.empty()) return;
  const DoubledLimit& most = tuning.limits.front();
  constexpr double worth_telling = 0.02;
  const char* const what = tuning.objective == Objective::accuracy ? "accuracy"
                           : tuning.objective == Objective::gentle ? "the least force"
                                                                   : "settling time";
  const std::string first = most.gain > worth_telling
                                ? fmt::format("{} is limited most by {}, which twice as good saves {:.0f} %", what,
                                              most.name, 100 * most.gain)
                                : fmt::format("no single number limits {}", what);
  const bool gentle = tuning.objective == Objective::gentle;
  fmt::print("{}. Tuned again with each of them twice as good{}:\n", first,
             gentle ? ", in the time that this one may take" : "");
  for (const DoubledLimit& limit : tuning.limits) print_limit(limit, tuning);
}

void print_summary(const TuneCommand& options, const Tuning& tuning) {
  const TunedPoint& chosen = tuning.chosen;
  fmt::print(
      "{}: tuned for {}, certified. From {:g} m away it settles in {:.3f} s at worst (median {:.3f} s) under {} "
      "friction laws\n",
      config::shown_name(options.file), study::to_string(tuning.objective), tuning.distance_m, chosen.worst_settling_s,
      chosen.median_settling_s, chosen.laws);
  if (std::isfinite(chosen.overshoot_m))
    fmt::print(
        "overshoot {:.3g} m, peak force {:.4g} N, true error at rest certified {}\n", chosen.overshoot_m,
        chosen.peak_force_N,
        std::isfinite(chosen.error_m) ? fmt::format("{:g} m", rounded_up(chosen.error_m, 3)) : "to the tolerance");
  for (const study::ChosenNumber& number : tuning.numbers)
    fmt::print("  {:<28} {:<10} {}\n", number.key, number.value, number.why);
  print_limits(tuning);
  const auto good = std::ranges::count_if(tuning.tried, &TunedPoint::good);
  fmt::print("{} sets of gains were tried, of which {} are certified and settle\n", tuning.tried.size(), good);
  for (const std::string& path : {options.output, options.json, options.picture})
    if (!path.empty()) fmt::print("written: {}\n", path);
  if (options.output.empty()) fmt::print("nothing of it is written to a file: give one with -o\n");
}

int tune(const TuneCommand& options) {
  if (!options.picture.empty()) format::require_picture_ending(options.picture);
  study::TuneOptions how = options.tune;
  how.objective = study::objective_of(options.objective);
  Progress progress{"tuning", options.progress};
  how.progress = [&](double share) { progress.tell(share); };
  const Tuning tuning = study::tune(config::file_contents(options.file), config::shown_name(options.file), how);
  // Everything is ready before the first file is written: an error here leaves no file behind.
  const std::string picture = options.picture.empty() ? "" : report::draw_tuning(options.picture, tuning);
  if (!options.output.empty())
    format::write_output(options.output, config::moved_text(tuning.text, options.file, options.output));
  if (!options.json.empty()) format::write_output(options.json, report::to_json(tuning));
  if (!picture.empty()) format::write_output(options.picture, picture);
  if (!options.quiet()) print_summary(options, tuning);
  return done;
}

}  // namespace

void add_tune(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<TuneCommand>();
  CLI::App* command = app.add_subcommand(
      "tune", "Choose coast, gains, limits of the approach and tolerance of an axis from what it is, certified");
  CallFiles files{*command};
  files.reads("axis", options->file, "The scenario with the axis; its own gains count as one try")->required();
  command
      ->add_option("--for", options->objective,
                   "time: least worst settling time; accuracy: least tolerance; gentle: least force in 1.5 times the "
                   "least time")
      ->check(CLI::IsMember({"time", "accuracy", "gentle"}))
      ->capture_default_str();
  command->add_option("--axis", options->tune.axis, "The name of the axis to tune, where the scenario has several");
  files.makes("-o,--output", options->output,
              "Write the file with what was chosen to this file, all else as it was; - is standard output");
  files.writes("--json", options->json, "Write all that was tried as JSON to this file; - is standard output");
  files.writes("--picture", options->picture,
               "Draw the settling times that were tried, and what limits them, to this .svg or .png (needs gnuplot)");
  command
      ->add_option("--laws", options->tune.random_laws, "Random friction laws beside the four fixed ones, default 100")
      ->check(whole_number_between(0, 100000));
  command->add_option("--seed", options->tune.seed, "Seed of the first random law, default 1")->check(whole_number);
  add_progress(*command, options->progress);
  command->footer(std::string{"Example: breakaway tune axis.toml --for time -o tuned.toml --picture tuned.svg\n"} +
                  exit_codes);
  files.then([options, &exit_code] { exit_code = tune(*options); });
}

}  // namespace breakaway::cli
