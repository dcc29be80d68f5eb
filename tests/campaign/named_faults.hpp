// What may go wrong between a controller, its bus, its drive and its axis, each by name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fault_world.hpp"

namespace breakaway::campaign {

// How the drive must lose its force once the axis has a fault.
enum class Stop {
  at_once,    // within two periods: drive and bus obey
  escalated,  // within the time of the escalation: the drive is deaf, or not heard
};

struct NamedFault {
  std::string name;
  std::function<void(FaultWorld&)> cause;
  std::function<void(FaultWorld&)> mend;
  Stop stop = Stop::at_once;
  bool encoder = false;     // the truth cannot be known while it lasts
  bool needs_edge = false;  // the axis may wait, disabled, for "enable" to be said anew
  // Another tool raises the drive's own limit, so that no controller can bound the force.
  bool foreign_force = false;
};

std::vector<NamedFault> named_faults();

}  // namespace breakaway::campaign
