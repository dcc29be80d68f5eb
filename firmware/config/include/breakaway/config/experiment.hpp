// The experiment that identifies an axis, as far as the axis' file describes what an engineer knows before it.
#pragma once

#include "breakaway/config/node.hpp"
#include "breakaway/identify/experiment_parameters.hpp"

namespace breakaway::config {

// Where the axis may be and how long it may take; what is not given is the file's.
struct ExperimentRequest {
  double lowest_m = -unlimited, highest_m = unlimited;
  double duration_s = 60;
  double max_force_N = unlimited;
};

// Neither mass nor friction of the file is read. Throws InputError with the remedy where a [loop], a [drive], a limit
// of speed is missing, or one of position that the request does not give either, where axes push each other, and where
// the request leaves the file's travel, or the time of 2 s to an hour that an experiment takes.
template <class Real>
identify::ExperimentParameters<Real> experiment_parameters(const Node& node, const Axis& axis,
                                                           const ExperimentRequest& request);

}  // namespace breakaway::config
