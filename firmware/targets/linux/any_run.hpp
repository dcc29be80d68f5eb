// The run that a configuration asks for, whatever its law, its drives and what is to be done with them.
#pragma once

#include <type_traits>
#include <variant>

#include "breakaway/socketcan/kernel_socket.hpp"
#include "canopen_side.hpp"
#include "configuration.hpp"
#include "experiment_node.hpp"
#include "identify_run.hpp"
#include "node_run.hpp"
#include "odrive_side.hpp"
#include "options.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

template <class Flashed, class Side>
struct RunOf {
  using Type = NodeRun<Flashed, Side>;
};
template <class Side>
struct RunOf<ExperimentNode, Side> {
  using Type = IdentifyRun<Side>;
};

// Of those there are on a bus of ODrives.
template <class Flashed>
constexpr bool may_have_odrives =
    std::is_same_v<Flashed, config::AnyNode<float>> || std::is_same_v<Flashed, ExperimentNode>;

// Returns what use(run) does, where run is a NodeRun or an IdentifyRun.
template <class Use>
auto with_run(const Configuration& configuration, const Options& options, socketcan::KernelSocket& socket,
              Telemetry& telemetry, const Use& use) {
  const auto by = [&]<class Side, class Flashed>(const Flashed& flashed, Side) {
    typename RunOf<Flashed, Side>::Type run{flashed, configuration, options, socket, telemetry};
    return use(run);
  };
  const auto with = [&]<class Flashed>(const Flashed& flashed) {
    if constexpr (may_have_odrives<Flashed>)
      if (configuration.speaks_odrive()) return by(flashed, OdriveSide{});
    return by(flashed, CanopenSide{});
  };
  return std::visit(with, configuration.node);
}

}  // namespace breakaway::linux_node
