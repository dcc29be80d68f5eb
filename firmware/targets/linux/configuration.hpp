// From a node's file to what is run: certified, or not at all, but for an experiment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "breakaway/config/flash.hpp"
#include "experiment_node.hpp"
#include "options.hpp"

namespace breakaway::linux_node {

struct Visit {
  double after_s = 0;  // since the axis was enabled; of a tour: 0
  std::int32_t counts = 0;
};

// What the node does with one axis, beside what is flashed.
struct AxisPlan {
  std::string name;
  std::vector<Visit> visits;        // at least one
  double reached_m = 0;             // at the end of a run the reading is this near to the target, or the run failed
  double resolution_m = 0;          // one count
  float force_per_per_mille_N = 0;  // of the file's drive, for display
  std::uint16_t max_torque_per_mille = 0;  // 6072h as the file has it
};

struct Configuration {
  config::Node file;  // with what the options change of it
  // The second with the coast "work", the third with a [coupling], the fourth with --identify.
  std::variant<config::AnyNode<float>, config::WorkNode<float>, config::MachineNode<float>, ExperimentNode> node;
  std::vector<AxisPlan> axes;  // as the node has them
  // Of protocol "odrive", one for each axis, in place of what `node` has; else empty.
  std::vector<odrive::DriveConfig<float>> odrives;
  bool timed = false;  // visits by time, each axis its own; else a tour, on which all axes rest before the next

  const firmware::LoopConfig& loop() const {
    return std::visit([](const auto& flashed) -> const firmware::LoopConfig& { return flashed.loop; }, node);
  }
  bool speaks_odrive() const { return !odrives.empty(); }
  std::uint8_t node_id(std::size_t place) const {
    return speaks_odrive() ? odrives[place].node_id : drive(place).node_id;
  }
  // Of protocol "canopen".
  const cia402::DriveConfig<float>& drive(std::size_t place) const {
    const auto of = [&](const auto& flashed) -> const cia402::DriveConfig<float>& { return flashed.axes[place].drive; };
    return std::visit(of, node);
  }
};

// Throws InputError with the remedy: the file cannot be used, an axis is not certified by the checks of `breakaway
// design`, an option contradicts the certificate.
Configuration read_configuration(const Options& options);

// The same for --identify, of one axis. Neither its mass nor its friction is read, and nothing is certified. Throws
// InputError where an option is for targets, where travel or speed have no limit, and where axes push each other.
Configuration read_experiment(const Options& options);

}  // namespace breakaway::linux_node
