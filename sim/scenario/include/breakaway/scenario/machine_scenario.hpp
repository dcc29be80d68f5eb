// MachineScenario: any linear machine with dry friction, from where it starts and how long it is followed.
//
//   [machine]  mass, damping, stiffness, directions (matrices, row by row), friction_N, force_N
//   [[machine.friction]] instead of friction_N, one for each direction: lower_N, upper_N, law
//   [feedback] actuators, position_gain, velocity_gain: u = -F1 q - F2 v through S, (28) of van de Wouw & Leine
//   [start]    q, v
//   [[impulse]] time_s, impulse_Ns
//   [run]      duration_s, integrator ("event_driven", "time_stepping" or "adaptive"), step_s and theta of time
//              stepping, tolerance of the adaptive method; or accuracy_m, from which these are chosen
//   [sweep]    damping, per_d1, d1: the damping matrix as a function of a gain, Figure 4 of the same
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "breakaway/config/known_tables.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/scenario/scenario.hpp"
#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::scenario {

enum class Integrator { event_driven, time_stepping, adaptive };

// Returns the word that a file writes.
const char* to_string(Integrator integrator);

struct MachineImpulse {
  double time_s;
  Eigen::VectorXd impulse_Ns;  // on each coordinate
};

// C(d1) = damping + d1 per_d1: what certificates do when a derivative gain is raised.
struct DampingSweep {
  Eigen::MatrixXd damping, per_d1;  // n x n
  std::vector<double> d1;           // N s/m, in the order given
};

struct MachineScenario {
  std::string file, title;
  stability::LinearMachine<> machine;                            // the closed loop (29) when there is feedback
  std::vector<model::FrictionLaw> laws;                          // by direction; empty: machine.friction_N is constant,
                                                                 // otherwise it holds their lower bounds
  std::optional<stability::MachineState<Eigen::Dynamic>> start;  // at time 0
  std::vector<MachineImpulse> impulses;                          // in the order of their times, within duration_s
  std::optional<DampingSweep> sweep;
  double duration_s = 60;
  Integrator integrator = Integrator::event_driven;  // adaptive where there are laws
  double step_s = 1e-3;
  double theta = 0.5;
  double tolerance = 1e-12;
  // The error that the end of the motion may have, in any coordinate. Given, it decides on step_s and tolerance, and
  // where the file leaves that open on the integrator, too.
  std::optional<double> accuracy_m;
  bool integrator_is_named = false;  // by the file
};

// Throw InputError: file not readable, TOML syntax, unknown or missing key, wrong type or size, a matrix that is no
// machine's. Keys, units and ranges stand in read_machine.cpp, one row each. `known` gathers what is read.
MachineScenario read_machine_scenario(const std::filesystem::path& file);
MachineScenario parse_machine_scenario(std::string_view text, const std::string& name,
                                       config::KnownTables* known = nullptr);

// A machine if the file has a [machine], else an axis.
std::variant<Scenario, MachineScenario> read_any_scenario(const std::filesystem::path& file);
std::variant<Scenario, MachineScenario> parse_any_scenario(std::string_view text, const std::string& name,
                                                           config::KnownTables* known = nullptr);

}  // namespace breakaway::scenario
