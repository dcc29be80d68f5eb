// What the command line of breakaway-node says.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace breakaway::linux_node {

struct Options {
  std::string configuration;
  std::string interface;
  std::vector<std::string> targets;  // visited in order, "x" or "x,y,..." [m]; empty: the configuration's
  double dwell_s = 1;                // at rest on a target, before the next
  double duration_s = 0;             // 0: until a signal
  double max_force_N = 0;            // 0: the configuration's
  double patience_s = 5;             // for the drive to answer
  std::optional<unsigned> node_id;   // nothing: the configuration's
  int priority = 80;
  bool readonly = false;
  bool realtime = true;
  bool identify = false;  // an experiment instead of targets
  std::string axis;       // to identify, by name; empty: the only one
  bool reset = false;     // acknowledge a fault that the drive has at the start
  std::string csv, candump;
  std::string stream;  // udp:HOST:PORT; empty: none
};

enum ExitCode : int { done = 0, failed = 1, bad_input = 2 };

}  // namespace breakaway::linux_node
