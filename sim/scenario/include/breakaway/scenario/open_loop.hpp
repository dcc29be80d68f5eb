// A machine's scenario without the feedback of its [feedback] table, and the same with other gains.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>

#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::scenario {

struct OpenLoop {
  MachineScenario scenario;   // gains of position and velocity are 0
  Eigen::MatrixXd actuators;  // S: n x k, the identity when the file names none
  std::string text;           // of the file
};

// Throw InputError as read_machine_scenario.
OpenLoop read_open_loop(const std::filesystem::path& file);
OpenLoop parse_open_loop(std::string_view text, const std::string& name);

// The text of the file as TOML with these gains (k x n) in [feedback]; comments are lost. Numbers keep all their
// digits.
std::string with_gains(const OpenLoop& open, const Eigen::MatrixXd& position_gain_N_per_m,
                       const Eigen::MatrixXd& velocity_gain_Ns_per_m);

}  // namespace breakaway::scenario
