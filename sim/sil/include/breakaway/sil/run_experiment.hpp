// The experiment that identifies an axis, run on the axis of a scenario behind its emulated drive.
#pragma once

#include <functional>
#include <string>

#include "breakaway/evaluation/record.hpp"
#include "breakaway/identify/experiment_parameters.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::sil {

struct ExperimentRun {
  evaluation::Record record;  // as the loop read and commanded
  identify::Ending ending = identify::Ending::none;
  std::string fault;                   // by which the loop stopped the axis; empty: none
  double lowest_m = 0, highest_m = 0;  // where the axis truly was
  double fastest_m_s = 0;              // at the ends of periods
};

// Progress is told the share of the longest duration, and says false to end the experiment.
using ExperimentProgress = std::function<bool(double share)>;

// The axis begins at rest where the scenario puts it. Requires a scenario of one axis with [loop] and [drive], without
// [machine]. Throws InputError where the axis cannot be followed.
ExperimentRun run_experiment(const scenario::Scenario& scenario,
                             const identify::ExperimentParameters<double>& parameters,
                             const ExperimentProgress& progress = {});

}  // namespace breakaway::sil
