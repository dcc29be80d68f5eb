#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/json_writer.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/report/basin_picture.hpp"
#include "breakaway/report/region_picture.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/study/certified_region.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "conditions_json.hpp"
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

struct SweepRow {
  double d1;
  Attractivity attractivity;
};

// All that the command finds out. Where nothing is certified there is no region.
struct Found {
  sil::Certificates certificates;
  stability::EquilibriumSet equilibria;
  std::optional<double> closed_form_J;
  std::vector<SweepRow> sweep;
  std::optional<study::CertifiedRegion> region;
  report::Regions sections;

  const Attractivity& attractivity() const { return certificates.attractivity; }
};

bool global(const Attractivity& a) { return std::isinf(a.level_J); }

std::vector<SweepRow> swept(const scenario::MachineScenario& s) {
  std::vector<SweepRow> rows;
  if (!s.sweep) return rows;
  stability::LinearMachine<> system = s.machine;
  for (const double d1 : s.sweep->d1) {
    system.damping = s.sweep->damping + d1 * s.sweep->per_d1;
    rows.push_back({d1, stability::certify_attractivity(system)});
  }
  return rows;
}

Found find(const AttractCommand& options, const scenario::MachineScenario& s) {
  const std::array<int, 2> plane = read_plane(options.plane, static_cast<int>(s.machine.coordinates()));
  Progress progress{"proving", options.progress};
  progress.say("the theorem's conditions");
  Found found{sil::certify(s.machine),
              stability::EquilibriumSet::make(s.machine),
              stability::closed_form_rho_J(s.machine),
              swept(s),
              {},
              {}};
  if (found.attractivity().level_J == 0) return found;
  const double half_width =
      options.window > 0 ? options.window : study::fitting_half_width(s.machine, found.attractivity(), plane);
  found.region = study::certify_region(s, found.certificates, {half_width, plane, options.depth}, options.threads,
                                       [&](double share) { progress.tell(share); });
  found.sections = report::regions(s.machine, found.certificates, {2, half_width, plane});
  return found;
}

template <class Vector>
void write_numbers(format::JsonWriter& json, const Vector& numbers) {
  json.array([&] {
    for (const double number : numbers) json.value(number);
  });
}

void write_equilibria(format::JsonWriter& json, const Found& found) {
  Eigen::MatrixXd vertices;
  std::string reason;
  try {
    vertices = found.equilibria.vertices();
  } catch (const InputError& error) {
    reason = error.what();
  }
  json.array("vertices", [&] {
    for (const auto corner : vertices.colwise()) write_numbers(json, corner);
  });
  json.array("extent", [&] {
    for (const double extent : found.equilibria.extent()) json.value(extent);
  });
  json.member("section_area", stability::area(found.sections.equilibria));
  json.member("reason", reason);
}

void write_theorem(format::JsonWriter& json, const Found& found) {
  const Attractivity& a = found.attractivity();
  write_conditions(json, a.conditions);
  json.member("certified", a.certified);
  json.member("reason", a.reason);
  json.array("eigenvalues", [&] {
    for (const double value : a.eigenvalues) json.value(value);
  });
  json.member("alpha", a.alpha);
  json.member("beta", a.beta);
  json.array("rho", [&] {
    for (const double rho : a.rho_J) json.value(rho);
  });
  json.member("rho_star", a.rho_star_J);
  json.member("rho_star_closed_form", found.closed_form_J.value_or(std::nan("")));
  json.member("level", a.level_J);
  json.member("global", global(a));
  json.member("E_certified", a.all_of_E);
  json.member("E_share_certified", a.certified_share_of_E());
  json.member("E_greatest_energy", a.greatest_rest_J);
  json.member("remark_3_energy", a.remark_3_J);
  json.member("remark_3_holds", a.remark_3_J < a.rho_star_J);
}

void write_region(format::JsonWriter& json, const Found& found) {
  const study::CertifiedRegion& region = *found.region;
  json.array("plane", [&] {
    for (const int place : region.window().plane) json.value(place + 1);
  });
  json.member("window", region.window().half_width);
  json.member("certified_area_theorem_1", stability::area(found.sections.certified));
  json.member("certified_area", region.area(Fate::attracted));
  json.member("certified_lost_area", region.area(Fate::lost));
  json.member("true_area", region.area_simulated());
  json.member("certified_share", region.proved_share());
  json.member("motions", region.motions());
}

std::string to_json(const scenario::MachineScenario& s, const Found& found) {
  format::JsonWriter json;
  json.object([&] {
    json.member("title", s.title);
    write_theorem(json, found);
    json.object("equilibrium_set", [&] { write_equilibria(json, found); });
    if (found.region) {
      write_region(json, found);
    } else {
      json.member("certified_area", 0.0);
    }
    json.array("sweep", [&] {
      for (const SweepRow& row : found.sweep) {
        json.object([&] {
          json.member("d1", row.d1);
          json.member("rho_star", row.attractivity.rho_star_J);
          json.member("E_certified", row.attractivity.all_of_E);
          json.member("global", global(row.attractivity));
          json.member("reason", row.attractivity.reason);
        });
      }
    });
  });
  return json.text();
}

void print_region(const Found& found) {
  const study::CertifiedRegion& region = *found.region;
  fmt::print("  equilibria     area {:.6g}\n", stability::area(found.sections.equilibria));
  fmt::print("  by Theorem 1   area {:.6g}\n", stability::area(found.sections.certified));
  fmt::print("  proved         area {:.6g} attracted, {:.6g} lost, by {} motions\n", region.area(Fate::attracted),
             region.area(Fate::lost), region.motions());
  fmt::print("  simulated      area {:.6g} attracted, of which {:.3g} % are proved\n", region.area_simulated(),
             100 * region.proved_share());
}

void print_summary(const scenario::MachineScenario& s, const Found& found) {
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
             a.certified_share_of_E(), global(a) ? "yes" : "no");
  if (found.region) print_region(found);
  for (const SweepRow& row : found.sweep) {
    fmt::print("  d1 {:<8.4g} rho* {:<10.5g} E certified: {}\n", row.d1, row.attractivity.rho_star_J,
               row.attractivity.all_of_E ? "all" : "in part");
  }
}

int attract(const AttractCommand& options) {
  const scenario::MachineScenario s = scenario::read_machine_scenario(options.system);
  if (!options.picture.empty()) format::require_picture_ending(options.picture);
  const Found found = find(options, s);
  if (!options.picture.empty() && !found.region)
    throw InputError{fmt::format("--picture: there is no region to draw: {}", found.attractivity().reason)};
  const std::string drawn =
      options.picture.empty() ? "" : report::draw_region(options.picture, s, *found.region, found.sections);
  if (!options.json.empty()) format::write_output(options.json, to_json(s, found));
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
      ->check(positive_number);
  command->add_option("--depth", options->depth, "Cells are halved at most so often: 2^depth along each axis")
      ->check(CLI::Range(0, 14))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads to use; the result does not depend on it")
      ->check(CLI::Range(1, 1024));
  add_progress(*command, options->progress);
  command->footer(
      std::string{"Example: breakaway attract sim/scenarios/two_mass_example.toml --json - --picture region.svg\n"} +
      exit_codes);
  files.then([options, &exit_code] { exit_code = attract(*options); });
}

}  // namespace breakaway::cli
