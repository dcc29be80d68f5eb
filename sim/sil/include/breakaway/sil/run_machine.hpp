// One motion of a machine: `breakaway simulate` on a scenario with a [machine].
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "breakaway/hybrid/types.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/accuracy.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

struct MachineResult {
  hybrid::Outcome<Eigen::Dynamic> outcome;  // of the motion after the last impulse; steps and events are of all
  std::vector<hybrid::Event> events;
  std::vector<std::vector<int>> modes;  // in order: for each direction the sign of its sliding, 0 while it sticks
  // Of the start, or of the state after the last impulse: captured or lost by a certificate.
  hybrid::Verdict proved = hybrid::Verdict::undecided;
  std::string warning;                                      // why the figures may be wrong; empty if nothing is known
  std::optional<Accuracy> accuracy;                         // where the scenario asks for one
  std::vector<hybrid::MachineState<Eigen::Dynamic>> trace;  // in the order of time; empty unless asked for

  bool settled() const { return outcome.verdict == hybrid::Verdict::at_rest; }
};

// From scenario.start to rest after the last impulse, or to duration_s. With recording.trace the states at all events
// are kept and some thousand in between. Throws InputError when the scenario has no start, or the integrator cannot
// take the machine; Contradiction when the motion and its certificate exclude each other; AccuracyRefused when
// scenario.accuracy_m is given and no method holds it.
MachineResult run_machine(const scenario::MachineScenario& scenario, const RecordingOptions& recording = {});

// The sign of each direction's sliding velocity, 0 while it is zero to rounding.
std::vector<int> sliding_signs(const stability::LinearMachine<>& machine, const Eigen::VectorXd& v);

}  // namespace breakaway::sil
