// MachineScenario: any linear machine with dry friction, from where it starts and how long it is followed.
//
//   [machine]  mass, damping, stiffness, directions (matrices, row by row), friction_N
//   [feedback] actuators, position_gain, velocity_gain: u = -F1 q - F2 v through S, (28) of van de Wouw & Leine
//   [start]    q, v
//   [run]      duration_s, integrator ("event_driven" or "time_stepping"), step_s and theta of the latter
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "breakaway/plant/linear_machine.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

enum class Integrator { event_driven, time_stepping };

struct MachineScenario {
  std::string file, title;
  plant::LinearMachine<> machine;                            // the closed loop (29) when there is feedback
  std::optional<plant::MachineState<Eigen::Dynamic>> start;  // at time 0
  double duration_s = 60;
  Integrator integrator = Integrator::event_driven;
  double step_s = 1e-3;
  double theta = 0.5;
};

// Throw InputError: file not readable, TOML syntax, unknown or missing key, wrong type or size, a matrix that is no
// machine's. Keys, units and ranges stand in read_machine.cpp, one row each.
MachineScenario read_machine_scenario(const std::filesystem::path& file);
MachineScenario parse_machine_scenario(std::string_view text, const std::string& name);

// A machine if the file has a [machine], else an axis.
std::variant<Scenario, MachineScenario> read_any_scenario(const std::filesystem::path& file);
std::variant<Scenario, MachineScenario> parse_any_scenario(std::string_view text, const std::string& name);

}  // namespace breakaway::scenario
