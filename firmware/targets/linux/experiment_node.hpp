// ExperimentNode: what a run that identifies an axis is told, in the place of what is flashed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "breakaway/firmware/flashed_machine.hpp"
#include "breakaway/firmware/loop_config.hpp"
#include "breakaway/firmware/node_laws.hpp"
#include "breakaway/identify/experiment.hpp"
#include "breakaway/identify/experiment_law.hpp"
#include "breakaway/identify/experiment_parameters.hpp"

namespace breakaway::linux_node {

// One axis, of which nothing is certified.
struct ExperimentNode {
  firmware::LoopConfig loop{};
  std::uint8_t count = 1;
  std::array<firmware::FlashedMachineAxis<float>, 1> axes{};
  identify::ExperimentParameters<float> experiment{};
  std::uint32_t checksum = 0;  // nothing is flashed
};

}  // namespace breakaway::linux_node

namespace breakaway::firmware {

// The law of the axis is the experiment.
template <>
class NodeLaws<linux_node::ExperimentNode> {
 public:
  using Scalar = float;
  using Law = identify::ExperimentLaw<Scalar>;

  explicit NodeLaws(const linux_node::ExperimentNode& node) noexcept : experiment_{node.experiment} {}
  NodeLaws(const NodeLaws&) = delete;
  NodeLaws& operator=(const NodeLaws&) = delete;

  Law law_of(std::size_t) noexcept { return Law{experiment_}; }
  identify::Experiment<Scalar>& experiment() noexcept { return experiment_; }
  const identify::Experiment<Scalar>& experiment() const noexcept { return experiment_; }

 private:
  identify::Experiment<Scalar> experiment_;
};

}  // namespace breakaway::firmware
