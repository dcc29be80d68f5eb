// From a scene's file to what the node runs: certified, or not at all.
#pragma once

#include <vector>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/law/flashed_axis.hpp"
#include "breakaway/scenario/scenario.hpp"
#include "options.hpp"

namespace breakaway::linux_node {

struct Visit {
  double after_s = 0;  // since the axis was enabled; without a place in time: 0
  std::int32_t counts = 0;
};

struct Configuration {
  law::FlashedAxis<float> axis;
  firmware::LoopConfig loop;
  cia402::DriveConfig<float> drive;
  firmware::AxisLimits<float> limits;
  std::vector<Visit> visits;        // at least one
  bool timed = false;               // visits by time, not by rest
  float force_per_per_mille_N = 0;  // of the scene's drive, for display
  double tolerance_m = 0;           // at the end of a run the axis is this near to its target, or the run failed

  hal::AxisScale<float> scale() const { return {axis.parameters.encoder_resolution_m, axis.parameters.max_force_N}; }
};

// Throws InputError with the remedy: the file cannot be used, the axis is not certified by the checks of
// `breakaway design`, a limit contradicts the certificate.
Configuration read_configuration(const Options& options);

}  // namespace breakaway::linux_node
