// From a node's file to what is run: certified, or not at all.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/flash.hpp"
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
  config::AnyNode<float> node;
  std::vector<AxisPlan> axes;  // as the node has them
  bool timed = false;          // visits by time, each axis its own; else a tour, on which all axes rest before the next
};

// Throws InputError with the remedy: the file cannot be used, an axis is not certified by the checks of `breakaway
// design`, an option contradicts the certificate.
Configuration read_configuration(const Options& options);

}  // namespace breakaway::linux_node
