// A node of two axes that verify() finds to be good.
#pragma once

#include <chrono>

#include "breakaway/firmware/flashed_node.hpp"

namespace breakaway::firmware::testing {

inline FlashedAxis<float> certified_axis(char name, std::uint8_t node_id) {
  FlashedAxis<float> axis;
  axis.name.characters[0] = name;
  axis.drive = {.node_id = node_id, .force_per_torque_N_per_Nm = 50};
  axis.law = {1, 400, 32, 60, {2.5F, 4.5F}, 50, 5, 2e-6F, 1e-6F, 1e-3F};
  axis.kicks.table.count = 2;  // kicks for which nothing here waits
  axis.certified = true;
  return axis;
}

inline FlashedNode<float, 2> certified_node() {
  FlashedNode<float, 2> node;
  node.loop.network.period = std::chrono::milliseconds{1};
  node.axes = {certified_axis('x', 1), certified_axis('y', 2)};
  node.checksum = checksum_of(node);
  return node;
}

}  // namespace breakaway::firmware::testing
