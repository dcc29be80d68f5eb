#include "breakaway/design/k3.hpp"

#include <fmt/format.h>

#include <memory>
#include <vector>

#include "breakaway/format/json_writer.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "call_files.hpp"
#include "commands.hpp"

namespace breakaway::cli {
namespace {

struct K3Command {
  design::KickPlant<double> plant{};
  std::vector<double> positions_m;
  std::string json;
};

std::string to_json(const design::K3<double>& law, const std::vector<double>& positions_m) {
  format::JsonWriter json;
  json.object([&] {
    json.array("rows", [&] {
      for (const double y : positions_m) {
        json.object([&] {
          json.member("position_m", y);
          json.member("k3_Ns", law.impulse_Ns(y) + 0.0);  // + 0.0: no negative zero
          json.member("time_to_go_s", law.time_to_go_s(y));
        });
      }
    });
  });
  return json.text();
}

void print_table(const design::K3<double>& law, const std::vector<double>& positions_m) {
  fmt::print("{:>24} {:>24} {:>24}\n", "position [m]", "k3 [N s]", "time to go [s]");
  for (const double y : positions_m) {
    fmt::print("{:>24} {:>24} {:>24}\n", y, law.impulse_Ns(y) + 0.0, law.time_to_go_s(y));
  }
}

// Extreme inputs leave the range of double.
void require_finite(const design::K3<double>& law, double position_m) {
  if (std::isfinite(law.impulse_Ns(position_m)) && std::isfinite(law.time_to_go_s(position_m))) return;
  throw InputError{fmt::format(
      "--position: k3 at {} m is beyond the range of floating point for this axis; check the units", position_m)};
}

void k3(const K3Command& options) {
  const auto law = design::K3<double>::make(options.plant);
  for (const double y : options.positions_m) require_finite(law, y);
  if (!options.json.empty()) format::write_output(options.json, to_json(law, options.positions_m));
  if (options.json != "-") print_table(law, options.positions_m);
}

}  // namespace

void add_k3(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<K3Command>();
  CLI::App* command = app.add_subcommand("k3", "The exact impulse that sends a resting axis to its target");
  CallFiles files{*command};
  auto& plant = options->plant;
  command->add_option("--mass", plant.mass_kg, "Moving mass [kg]")->required()->check(positive_number);
  command->add_option("--k1", plant.stiffness_N_per_m, "Stiffness of the control [N/m]")
      ->required()
      ->check(positive_number);
  command
      ->add_option("--k22", plant.damping_Ns_per_m,
                   "Damping in the kick phase [N s/m]; zeta = k22 / (2 sqrt(k1 m)) > 1")
      ->required()
      ->check(positive_number);
  command->add_option("--friction-lower", plant.friction_lower_N, "Least friction force, m g mu_lower [N]")
      ->required()
      ->check(positive_number);
  command->add_option("--position", options->positions_m, "Position error at rest [m]; give it once for each row")
      ->required()
      ->allow_extra_args(false)
      ->check(finite_number);
  files.writes("--json", options->json, "Write the rows as JSON to this file; - is standard output");
  command->footer(
      std::string{"Example: breakaway k3 --mass 1 --k1 1 --k22 3 --friction-lower 2.5 --position -0.1 --position 1e-6 "
                  "--json -\n"} +
      exit_codes);
  files.then([options, &exit_code] {
    k3(*options);
    exit_code = done;
  });
}

}  // namespace breakaway::cli
