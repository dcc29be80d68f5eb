#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <variant>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "breakaway/tradeoff/frontiers.hpp"
#include "breakaway/tradeoff/scene_tradeoff.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "progress.hpp"

namespace breakaway::cli {
namespace {

struct TradeoffFiles {
  std::string scenario;
  std::optional<double> accuracy_m;
  std::string json, picture, page, work;
  std::uint64_t repeats = 1;
  bool quick = false, progress = false;
};

std::string figure(double value, const char* unit) {
  return std::isfinite(value) ? fmt::format("{:>10.3g} {}", value, unit) : fmt::format("{:>10} {}", "-", unit);
}

std::string cost_text(const tradeoff::Cost& cost) {
  const std::string ratio = figure(cost.time_ratio, "x");
  return std::isfinite(cost.instructions) ? fmt::format("{} {:>14.0f} instructions", ratio, cost.instructions) : ratio;
}

std::string step_text(const tradeoff::IntegratorRow& row) {
  if (row.step_s > 0) return fmt::format("h = {:<14g}", row.step_s);
  return row.tolerance > 0 ? fmt::format("tolerance {:<8g}", row.tolerance) : std::string(18, ' ');
}

void print_frontiers(const tradeoff::Frontiers& f) {
  fmt::print("Integrators on the two-mass example: mean error, wrong verdicts, cost of a trajectory\n");
  for (const auto& row : f.integrators) {
    fmt::print("  {:<16} {:<7} {} {} {}\n", row.method, step_text(row), figure(row.error_m, "m"),
               figure(100 * row.wrong_share, "%"), cost_text(row.trajectory));
  }
  fmt::print("Time stepping of the impulsive example never settles: the ball it keeps kicking in\n");
  for (const auto& row : f.balls) {
    fmt::print("  h = {:<7g} {:>10.3g} m, f_lo h^2 / (8 m) = {:.3g} m, {:.3g} kicks a step\n", row.step_s, row.ball_m,
               row.predicted_m, row.kicks_per_step);
  }
  fmt::print("k3: bytes, largest relative error (mild plant, hard plant), cost of a call\n");
  for (const auto& row : f.evaluators) {
    fmt::print("  {:<22} {:<6} {:>5} {:>6} B {:>9.2g} {:>9.2g} {}\n", row.method, row.scalar, row.nodes, row.bytes,
               row.mild_error, row.hard_error, cost_text(row.call));
  }
  fmt::print("Control period: tolerance in floors, runs settled, worst error in floors\n");
  for (const auto& row : f.periods) {
    fmt::print("  T = {:<6g} s, floor {:>8.3g} m, encoder {:>8.3g} m: {:>5.2f} {:>4}/{:<4} {:>8.3g}\n", row.period_s,
               row.floor_m, row.resolution_m, row.tolerance_m / row.floor_m, row.settled, row.runs,
               row.worst_error_m / row.floor_m);
  }
  fmt::print("Scenarios: cost of a simulated second\n");
  for (const auto& row : f.scenario_parts) fmt::print("  {:<75} {}\n", row.scenario, cost_text(row.second));
}

tradeoff::Options measuring(const TradeoffFiles& files) {
  tradeoff::Options options;
  options.quick = files.quick;
  if (!files.quick && tradeoff::can_count())
    options.counting.program = std::filesystem::read_symlink("/proc/self/exe").string();
  return options;
}

std::optional<double>& accuracy_of(scenario::MachineScenario& scenario) { return scenario.accuracy_m; }
std::optional<double>& accuracy_of(scenario::Scenario& scenario) {
  sil::require_complete(scenario);
  return scenario.run->accuracy_m;
}

// Of the user's own scene.
void run_scene(const TradeoffFiles& files) {
  if (!files.page.empty()) throw InputError{"--page: is written without a scenario; leave one of the two out"};
  if (!files.picture.empty()) format::require_picture_ending(files.picture);
  auto any = scenario::read_any_scenario(files.scenario);
  std::optional<Progress> progress{std::in_place, "measuring", files.progress};
  const tradeoff::SceneTradeoff scene = std::visit(
      [&](auto& scenario) {
        std::optional<double>& accuracy_m = accuracy_of(scenario);
        if (files.accuracy_m) accuracy_m = files.accuracy_m;
        if (!accuracy_m) throw InputError{"--accuracy is missing: say which error (m) the answer may have"};
        return tradeoff::measure_scene(scenario, [&](const std::string& what) { progress->say(what); });
      },
      any);
  progress.reset();
  const std::string picture = files.picture.empty() ? "" : tradeoff::draw_scene(files.picture, scene);
  if (!files.json.empty()) format::write_output(files.json, tradeoff::to_json(scene));
  if (!files.picture.empty()) format::write_output(files.picture, picture);
  if (files.json != "-") fmt::print("{}", tradeoff::to_table(scene));
  if (scene.refusal) throw sil::AccuracyRefused{*scene.refusal};
}

void run_tradeoff(const TradeoffFiles& files) {
  if (!files.work.empty()) return tradeoff::do_work(files.work, files.repeats);
  if (!files.scenario.empty()) return run_scene(files);
  if (files.accuracy_m) throw InputError{"--accuracy: needs a scenario; name your machine's or axis' file"};
  auto options = measuring(files);
  std::optional<Progress> progress{std::in_place, "measuring", files.progress};
  options.counting.progress = [&](const std::string& what) { progress->say(what); };
  const auto frontiers = tradeoff::measure(options);
  progress.reset();
  const std::string picture = files.picture.empty() ? "" : tradeoff::to_svg(frontiers);
  if (!files.json.empty()) format::write_output(files.json, tradeoff::to_json(frontiers));
  if (!files.picture.empty()) format::write_output(files.picture, picture);
  if (!files.page.empty()) format::write_output(files.page, tradeoff::to_page(frontiers));
  if (files.json != "-" && files.picture != "-" && files.page != "-") print_frontiers(frontiers);
}

}  // namespace

void add_tradeoff(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<TradeoffFiles>();
  CLI::App* command = app.add_subcommand(
      "tradeoff", "Measure speed against accuracy: integrators, k3 evaluators, control periods, parts of a scenario");
  CallFiles files{*command};
  files.reads("scenario", options->scenario, "A scenario of your own: its methods, and the parts it can do without");
  command->add_option("--accuracy", options->accuracy_m, "The error (m) that the scenario's answer may have")
      ->check(positive_number);
  command->add_flag("--quick", options->quick, "Fewer rows, and no counting of instructions: seconds, not minutes");
  files.writes("--json", options->json, "Write all figures as JSON to this file; - is standard output");
  files.writes("--picture", options->picture, "Draw the frontiers into this SVG file (needs gnuplot)");
  files.writes("--page", options->page, "Write the figures and what follows from them as Markdown to this file");
  // How the command counts: it runs itself under valgrind with these.
  command->add_option("--work", options->work)->group("");
  command->add_option("--repeat", options->repeats)->group("");
  add_progress(*command, options->progress);
  command->footer(
      std::string{"Example: breakaway tradeoff sim/scenarios/can_axis.toml --accuracy 1e-5 --picture own.svg\n"
                  "         breakaway tradeoff --page sim/TRADEOFF.md --picture sim/tradeoff.svg\n"
                  "Instructions are counted where valgrind is installed; without it costs are ratios of times.\n"} +
      exit_codes);
  files.then([options, &exit_code] {
    run_tradeoff(*options);
    exit_code = done;
  });
}

}  // namespace breakaway::cli
