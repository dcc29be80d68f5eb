#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/report/sweep_picture.hpp"
#include "breakaway/scenario/open_loop.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/stability/synthesis.hpp"
#include "call_files.hpp"
#include "commands.hpp"
#include "progress.hpp"
#include "synthesis_report.hpp"

namespace breakaway::cli {
namespace {

using Eigen::MatrixXd;
using stability::PdDesign;
using stability::PdWants;

constexpr double infinite = std::numeric_limits<double>::infinity();

struct SynthesizeCommand {
  std::string system, gains = "full", json, scenario, picture;
  std::vector<std::string> wants;
  std::vector<double> sweep;
  int trajectories = 200;
  std::uint64_t seed = 1;
  bool progress = false;
};

// Every want is met, so of several of one kind the strictest counts; "global" is a region without end.
void read_want(const std::string& text, PdWants& wants) {
  if (text == "global") return static_cast<void>(wants.region_J = infinite);
  const auto equals = text.find('=');
  const std::string name = text.substr(0, equals), number = equals == text.npos ? "" : text.substr(equals + 1);
  const bool least_is_strictest = name == "resting-error";
  double* to = least_is_strictest ? &wants.resting_error_m
               : name == "region" ? &wants.region_J
               : name == "reach"  ? &wants.reach_m
                                  : nullptr;
  double value = 0;
  if (to == nullptr || !CLI::detail::lexical_cast(number, value) || !std::isfinite(value) || !(value > 0)) {
    throw InputError{fmt::format(
        "--want {}: give global, resting-error=METRES, region=JOULES or reach=METRES, the number above 0", text)};
  }
  *to = least_is_strictest ? std::min(*to, value) : std::max(*to, value);
}

PdWants read_wants(const SynthesizeCommand& options) {
  PdWants wants;
  for (const std::string& text : options.wants) read_want(text, wants);
  return wants;
}

double velocity_norm_Ns_per_m(const PdDesign& design) {
  return Eigen::JacobiSVD<MatrixXd>(design.gains.velocity_Ns_per_m).singularValues()[0];
}

std::vector<stability::GainSweepRow> sweep(const SynthesizeCommand& options, const Synthesis& s) {
  const double norm = velocity_norm_Ns_per_m(s.design);
  if (norm == 0) {
    if (options.sweep.empty()) return {};
    throw InputError{"--sweep: the machine needs no gain of velocity, so there is none to scale; leave it out"};
  }
  std::vector<double> norms = options.sweep;
  if (norms.empty()) norms = {0.5 * norm, 0.6 * norm, 0.7 * norm, 0.8 * norm, 0.9 * norm, norm};
  return stability::sweep_velocity_gain(s.system, s.design.gains, norms);
}

// Where B is everything, the simulations start with up to ten times the energy that friction can hold at rest, and
// more.
void simulate(const SynthesizeCommand& options, Synthesis& s) {
  const stability::LinearMachine<>& machine = s.closed_loop.machine;
  const auto& a = s.design.attractivity;
  s.simulated_level_J = std::isfinite(a.rho_star_J) ? a.rho_star_J : 100 * a.greatest_rest_J;
  const auto slowest = Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(machine.stiffness, machine.mass,
                                                                          Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
  // Near the border of B the energy hardly falls: so many periods of the slowest oscillation are plenty.
  s.simulated_for_s = std::max(s.closed_loop.duration_s, 2e4 * std::acos(-1.0) / std::sqrt(slowest.eigenvalues()[0]));
  if (s.simulated_level_J > 0) {
    Progress progress{"simulating", options.progress};
    s.batch = study::run_to_rest(s.closed_loop, s.simulated_level_J, s.simulated_for_s, options.trajectories, s.seed,
                                 [&](double share) { progress.tell(share); });
  }
}

std::string draw(const SynthesizeCommand& options, const Synthesis& s, const stability::LinearMachine<>& open) {
  const double norm = velocity_norm_Ns_per_m(s.design);
  std::vector<report::SweptMachine> machines;
  for (const auto& row : s.sweep) {
    const MatrixXd velocity_gain = s.design.gains.velocity_Ns_per_m * (row.velocity_gain_Ns_per_m / norm);
    machines.push_back(
        {row.velocity_gain_Ns_per_m,
         stability::with_feedback(open, s.system.actuators, s.design.gains.position_N_per_m, velocity_gain)});
  }
  if (machines.empty()) machines.push_back({0, s.closed_loop.machine});
  return report::draw_sweep(options.picture, machines);
}

stability::PdDesign synthesized(const SynthesizeCommand& options, const stability::ActuatedSystem& system,
                                const PdWants& wants) try {
  const auto structure = options.gains == "full" ? stability::GainStructure::full : stability::GainStructure::identical;
  Progress progress{"searching gains", options.progress};
  return stability::synthesize(system, wants, structure, [&](double share) { progress.tell(share); });
} catch (const InputError& error) {
  throw error.in_file(options.system);
}

int synthesize(const SynthesizeCommand& options) {
  if (!options.picture.empty()) format::require_picture_ending(options.picture);
  const PdWants wants = read_wants(options);
  const scenario::OpenLoop open = scenario::read_open_loop(options.system);
  if (open.scenario.machine.force_N.size() > 0 && !open.scenario.machine.force_N.isZero(0)) {
    throw InputError{options.system + ": [machine] force_N shifts every rest; compensate it, and leave it out here"};
  }
  Synthesis s;
  s.structure = options.gains;
  s.seed = options.seed;
  s.system = {open.scenario.machine, open.actuators};
  s.design = synthesized(options, s.system, wants);
  s.conditions = stability::machine_conditions(s.system);
  for (const auto& condition : stability::loop_conditions(s.design.closed_loop)) s.conditions.push_back(condition);
  s.theorem_2 = stability::verify_theorem_2(s.system, s.design.gains.position_N_per_m);
  s.sweep = sweep(options, s);
  // What is simulated is what the file will say.
  const std::string scenario =
      scenario::with_gains(open, s.design.gains.position_N_per_m, s.design.gains.velocity_Ns_per_m);
  s.closed_loop = scenario::parse_machine_scenario(scenario, options.system);
  simulate(options, s);

  const std::string drawn = options.picture.empty() ? "" : draw(options, s, open.scenario.machine);
  if (!options.scenario.empty()) format::write_output(options.scenario, scenario);
  if (!options.json.empty()) format::write_output(options.json, to_json(s));
  if (!options.picture.empty()) format::write_output(options.picture, drawn);
  if (options.json != "-" && options.scenario != "-") print_summary(s);
  return s.batch.not_at_rest ? failed_check : done;
}

}  // namespace

void add_synthesize(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<SynthesizeCommand>();
  CLI::App* command = app.add_subcommand("synthesize", "PD gains of a machine for a wanted region and resting error");
  CallFiles files{*command};
  files
      .reads("system", options->system,
             "The machine, a TOML file with [machine]; its [feedback] names the "
             "actuators, gains in it are replaced")
      ->required();
  command
      ->add_option(
          "--want", options->wants,
          "resting-error=M: nothing rests farther from 0; region=J: V < J is certified; reach=M: every "
          "rest within M is; global: everything is, which includes every region and reach. Several may be wanted: all "
          "of them are met, the strictest where one is given twice")
      ->required()
      ->allow_extra_args(false);
  command
      ->add_option("--gains", options->gains,
                   "full: all coordinates to all actuators (needs sdpa); identical: the same p and d for each "
                   "actuator's own coordinate")
      ->check(CLI::IsMember({"full", "identical"}))
      ->capture_default_str();
  command
      ->add_option("--sweep", options->sweep,
                   "Scale the velocity gain to these norms [N s/m]; by default to 0.5 to 1 of what was found")
      ->delimiter(',')
      ->check(positive_number);
  command->add_option("--trajectories", options->trajectories, "Random starts inside the region to simulate")
      ->check(whole_number_between(0, 1'000'000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of the random starts")->check(whole_number)->capture_default_str();
  files.makes("--scenario", options->scenario, "Write the machine with its gains to this file; - is standard output");
  files.writes("--json", options->json, "Write the figures as JSON to this file; - is standard output");
  files.writes("--picture", options->picture, "Draw the sweep to this .svg or .png (needs gnuplot)");
  add_progress(*command, options->progress);
  command->footer(
      std::string{
          "Example: breakaway synthesize sim/scenarios/two_mass_actuated.toml --want resting-error=1 --want region=16 "
          "--gains identical --picture sweep.svg\n"
          "         breakaway synthesize S.toml --want resting-error=0.05 --want global --scenario "
          "closed_loop.toml\n"} +
      exit_codes);
  files.then([options, &exit_code] { exit_code = synthesize(*options); });
}

}  // namespace breakaway::cli
