#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/report/basin_json.hpp"
#include "breakaway/report/basin_picture.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/study/basin.hpp"
#include "breakaway/study/basin_table.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "plane_option.hpp"
#include "progress.hpp"
#include "shard_option.hpp"

namespace breakaway::cli {
namespace {

using study::Basin;
using study::Fate;
using Clock = std::chrono::steady_clock;

constexpr double most_points = 1e8;  // 0.9 GB

struct BasinCommand {
  std::string system, plane = "1,2", shard = "0/1", json, csv, picture, resume;
  std::vector<std::string> merge;
  int points = 101;
  double window = 0;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool progress = false;
};

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

study::Grid read_grid(const BasinCommand& options, int coordinates) {
  return {options.points, options.window, read_plane(options.plane, coordinates)};
}

void check(const BasinCommand& options, const study::Shard& shard) {
  if (!options.picture.empty()) format::require_picture_ending(options.picture);
  if (!options.merge.empty() && (shard.count > 1 || !options.resume.empty()))
    throw InputError{"--merge joins whole shards: leave out --shard and --resume"};
  const double points = static_cast<double>(options.points) * options.points / shard.count;
  if (points > most_points) {
    throw InputError{fmt::format("--grid {}: makes {:.2g} points; use --shard i/n with n >= {}", options.points, points,
                                 static_cast<int>(points * shard.count / most_points) + 1)};
  }
}

report::BasinEffort decide(const BasinCommand& options, const scenario::MachineScenario& s, Basin& basin) {
  std::optional<study::Journal> journal;
  if (!options.resume.empty()) journal.emplace(options.resume, s, basin);
  const auto begin = Clock::now();
  Progress progress{"simulating", options.progress};
  const auto pending = static_cast<double>(basin.count(Fate::pending));
  std::size_t before = 0;
  const std::size_t trajectories = study::decide_pending(basin, s, options.threads, [&](int row, std::size_t done) {
    if (journal && done > before) journal->append(basin, row);
    before = done;
    progress.tell(static_cast<double>(done) / pending);
  });
  return {trajectories, seconds_since(begin)};
}

void merge(const BasinCommand& options, const scenario::MachineScenario& s, Basin& basin) {
  for (const std::string& path : options.merge) study::read_table(path, s, basin);
  if (const std::size_t missing = basin.count(Fate::pending); missing > 0) {
    throw InputError{fmt::format("--merge: {} of {} points are in none of the files; add the missing shards", missing,
                                 basin.size())};
  }
}

void print_summary(const scenario::MachineScenario& s, const Basin& basin, const report::Regions& regions,
                   const report::BasinEffort& simulated) {
  if (!s.title.empty()) fmt::print("{}\n", s.title);
  fmt::print("  attracted      {} of {} points, area {:.6g}\n", basin.count(Fate::attracted), basin.size(),
             basin.area(Fate::attracted));
  fmt::print("  lost           {}\n  undecided      {}\n", basin.count(Fate::lost), basin.count(Fate::undecided));
  if (basin.given_up() > 0)
    fmt::print("  given up       {} of the undecided: they take too many events, or are refused\n", basin.given_up());
  fmt::print("  certified      area {:.6g}\n", stability::area(regions.certified));
  if (simulated.trajectories > 0) {
    fmt::print("  simulated      {} trajectories in {:.3g} s, {:.3g} each second\n", simulated.trajectories,
               simulated.seconds, static_cast<double>(simulated.trajectories) / simulated.seconds);
  }
}

int basin_of(const BasinCommand& options) {
  const scenario::MachineScenario s = scenario::read_machine_scenario(options.system);
  const study::Shard shard = read_shard(options.shard);
  const study::Grid grid = read_grid(options, static_cast<int>(s.machine.coordinates()));
  check(options, shard);
  const sil::Certificates certificates = sil::certify(s);
  const report::Regions regions = report::regions(s.machine, certificates, grid);
  Basin basin{grid, shard};
  report::BasinEffort simulated;
  options.merge.empty() ? static_cast<void>(simulated = decide(options, s, basin)) : merge(options, s, basin);
  const std::string drawn = options.picture.empty() ? "" : report::draw_basin(options.picture, s, basin, regions);
  if (!options.csv.empty()) format::write_output(options.csv, study::table_parts(basin, s));
  if (!options.json.empty()) format::write_output(options.json, report::to_json(s, basin, certificates, simulated));
  if (!options.picture.empty()) format::write_output(options.picture, drawn);
  if (options.json != "-" && options.csv != "-") print_summary(s, basin, regions, simulated);
  return done;
}

}  // namespace

void add_basin(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<BasinCommand>();
  CLI::App* command = app.add_subcommand("basin", "Region of attraction of a machine with friction, on a grid");
  CallFiles files{*command};
  files.reads("system", options->system, "The machine, a TOML file with [machine]")->required();
  command->add_option("--grid", options->points, "Points along each axis")
      ->required()
      ->check(whole_number_between(2, 1'000'000));
  command->add_option("--window", options->window, "The axes reach from minus to plus this [m, or m/s]")
      ->required()
      ->check(window_half_width);
  command
      ->add_option(
          "--plane", options->plane,
          "Which two of (q, v) the axes are, as i,j from 1; the others are 0. With force_N, q is counted from K^-1 f")
      ->capture_default_str();
  files.writes(
      "--csv", options->csv,
      "Write x1,x2,attracted,time_s of every point, below a comment that names the system; - is standard output");
  files.writes("--json", options->json, "Write the figures as JSON to this file; - is standard output");
  files.writes("--picture", options->picture, "Draw it to this .svg or .png (needs gnuplot)");
  command->add_option("--shard", options->shard, "Only part i of n, as i/n, for --merge");
  files.reads("--merge", options->merge, "Simulate nothing: join these tables, by --csv or --resume, of shards");
  files.writes("--resume", options->resume, "Keep finished rows in this file, and go on from it if it exists");
  command->add_option("--threads", options->threads, "Threads to use; the result does not depend on it")
      ->check(whole_number_between(1, 1024));
  add_progress(*command, options->progress);
  command->footer(
      std::string{
          "Example: breakaway basin sim/scenarios/two_mass_example.toml --grid 401 --window 6 --picture basin.svg\n"
          "         breakaway basin S.toml --grid 4001 --window 6 --shard 1/2 --csv 1.csv    (and 2/2, elsewhere)\n"
          "         breakaway basin S.toml --grid 4001 --window 6 --merge 1.csv 2.csv --csv all.csv\n"} +
      exit_codes);
  files.then([options, &exit_code] { exit_code = basin_of(*options); });
}

}  // namespace breakaway::cli
