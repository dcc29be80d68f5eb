#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <thread>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/report/attraction_json.hpp"
#include "breakaway/report/region_picture.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/study/attraction.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "plane_option.hpp"
#include "progress.hpp"

namespace breakaway::cli {
namespace {

using stability::Attractivity;
using study::Fate;

struct AttractCommand {
  std::string system, plane = "1,2", json, picture;
  double window = 0;  // 0: that fits
  int depth = 10;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool progress = false;
};

// What is proved takes a while.
study::Attraction find(const AttractCommand& options, const scenario::MachineScenario& s) {
  const std::array<int, 2> plane = read_plane(options.plane, static_cast<int>(s.machine.coordinates()));
  std::optional<Progress> progress{std::in_place, "proving", options.progress};
  progress->say("the theorem's conditions");
  return study::find_attraction(s, {.plane = plane,
                                    .half_width = options.window,
                                    .depth = options.depth,
                                    .threads = options.threads,
                                    .progress = [&](study::RegionStage stage, double share) {
                                      if (stage == study::RegionStage::following && share == 0)
                                        progress.emplace("following what is not proved", options.progress);
                                      progress->tell(share);
                                    }});
}

void print_region(const study::CertifiedRegion& region, const report::Regions& sections) {
  fmt::print("  equilibria     area {:.6g}\n", stability::area(sections.equilibria));
  fmt::print("  by Theorem 1   area {:.6g}\n", stability::area(sections.certified));
  fmt::print("  proved         area {:.6g} attracted, {:.6g} lost, by {} motions\n", region.area(Fate::attracted),
             region.area(Fate::lost), region.motions());
  fmt::print("  simulated      area {:.6g} attracted", region.area_simulated(Fate::attracted));
  const double undecided = region.area_simulated(Fate::undecided);
  if (undecided > 0) fmt::print(", {:.6g} undecided: it takes too many events, or never rests nor grows", undecided);
  fmt::print("\n  proved share   {:.3g} % of what is{} attracted\n", 100 * region.proved_share(),
             undecided > 0 ? ", or may be," : "");
}

void print_summary(const scenario::MachineScenario& s, const study::Attraction& found) {
  const Attractivity& a = found.attractivity();
  if (!s.title.empty()) fmt::print("{}\n", s.title);
  for (const stability::Condition& condition : a.conditions) {
    fmt::print("  {:5} {}\n        {:.6g}: {}\n", condition.holds ? "holds" : "fails", condition.name, condition.margin,
               condition.reason);
  }
  if (!a.reason.empty()) fmt::print("  not certified by Theorem 1: {}\n", a.reason);
  fmt::print("  alpha          {:.6g}, beta {:.6g}\n", a.alpha, a.beta);
  fmt::print("  rho*           {:.6g} J by (7)", a.rho_star_J);
  if (found.closed_form_J) fmt::print(", {:.6g} J by the closed form (27)", *found.closed_form_J);
  fmt::print("; level proved {:.6g} J\n", a.level_J);
  fmt::print("  E certified    {}, shrunk to {:.4g}; attractive from everywhere: {}\n", a.all_of_E ? "all" : "in part",
             a.certified_share_of_E(), a.global() ? "yes" : "no");
  if (found.region) print_region(*found.region, report::regions(s.machine, found));
  for (const study::SweepRow& row : found.sweep) {
    fmt::print("  d1 {:<8.4g} rho* {:<10.5g} E certified: {}\n", row.d1, row.attractivity.rho_star_J,
               row.attractivity.all_of_E ? "all" : "in part");
  }
}

int attract(const AttractCommand& options) {
  const scenario::MachineScenario s = scenario::read_machine_scenario(options.system);
  if (!options.picture.empty()) format::require_picture_ending(options.picture);
  const study::Attraction found = find(options, s);
  if (!options.picture.empty() && !found.region)
    throw InputError{fmt::format("--picture: there is no region to draw: {}", found.attractivity().reason)};
  const std::string drawn = options.picture.empty() ? ""
                                                    : report::draw_region(options.picture, s, *found.region,
                                                                          report::regions(s.machine, found));
  if (!options.json.empty()) format::write_output(options.json, report::to_json(s, found));
  if (!options.picture.empty()) format::write_output(options.picture, drawn);
  if (options.json != "-") print_summary(s, found);
  return found.attractivity().level_J > 0 ? done : failed_check;
}

}  // namespace

void add_attract(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<AttractCommand>();
  CLI::App* command = app.add_subcommand("attract", "Where a machine with friction is certain to come to rest");
  CallFiles files{*command};
  files.reads("system", options->system, "The machine, a TOML file with [machine]")->required();
  files.writes("--json", options->json, "Write all findings as JSON to this file; - is standard output");
  files.writes("--picture", options->picture, "Draw the region to this .svg or .png (needs gnuplot)");
  command->add_option("--plane", options->plane, "Which two of (q, v) the axes are, as i,j from 1; the others are 0")
      ->capture_default_str();
  command->add_option("--window", options->window, "The axes reach from minus to plus this [m, or m/s] (what fits B)")
      ->check(window_half_width);
  command->add_option("--depth", options->depth, "Cells are halved at most so often: 2^depth along each axis")
      ->check(whole_number_between(0, 14))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads to use; the result does not depend on it")
      ->check(whole_number_between(1, 1024));
  add_progress(*command, options->progress);
  command->footer(
      std::string{"Example: breakaway attract sim/scenarios/two_mass_example.toml --json - --picture region.svg\n"} +
      exit_codes);
  files.then([options, &exit_code] { exit_code = attract(*options); });
}

}  // namespace breakaway::cli
