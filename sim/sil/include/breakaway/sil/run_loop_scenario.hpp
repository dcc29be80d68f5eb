// Axes behind drives on a CAN bus.
#pragma once

#include <memory>
#include <variant>

#include "breakaway/config/flash.hpp"
#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

// Runs the flashed control loop against the drive emulators and their axes, in virtual time. Requires scenario.run and
// node.loop, and of every axis a drive. Throws InputError when the configuration cannot work: a bus that is too slow
// for the period, for example.
Result run_loop_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording);

// What is flashed for the scenario's node, in the scenario's scalar type and for its coast; nothing for a pid
// controller. To work out the kicks of the coast "brake" takes longer than a run, so that many runs of one node share
// it.
using SharedNode =
    std::variant<std::monostate, std::shared_ptr<const config::AnyNode<float>>,
                 std::shared_ptr<const config::AnyNode<double>>, std::shared_ptr<const config::WorkNode<float>>,
                 std::shared_ptr<const config::WorkNode<double>>, std::shared_ptr<const config::MachineNode<float>>,
                 std::shared_ptr<const config::MachineNode<double>>>;
SharedNode flashed_node(const scenario::Scenario& scenario);

// The same with the node as flashed_node() gave it; the scenario may differ from that one in its worlds only.
Result run_loop_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording, const SharedNode& node);

}  // namespace breakaway::sil
