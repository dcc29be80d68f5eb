// The way from an experiment, or from its record, to an axis' file with what was found in it.
#pragma once

#include <string>
#include <string_view>

#include "breakaway/config/experiment.hpp"
#include "breakaway/evaluation/identification.hpp"
#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/run_experiment.hpp"

namespace breakaway::study {

struct IdentifiedRun {
  std::string title;   // of the file
  std::string file;    // in which errors are found: the axis', or the record's
  std::string source;  // what was evaluated
  std::string ending;  // in words
  bool complete = false;
  std::string stopped_by;  // a fault of the loop, by name; the record ends with it
  evaluation::Mechanism mechanism = evaluation::Mechanism::one_mass;
  evaluation::Record record;
  evaluation::Identification found;  // by evaluate()
};

// The experiment on the emulated drive of the scenario's only axis. Throws InputError as
// config::experiment_parameters() and sil::run_experiment(), for a [machine], and where the room about the start ends
// it.
IdentifiedRun run_identification(const scenario::Scenario& scenario, const config::ExperimentRequest& request,
                                 const sil::ExperimentProgress& progress = {});

// What was recorded elsewhere, in units of the scenario's drive. `name` stands for the record in errors. Throws
// InputError without a [loop] and a [drive], and as evaluation::record_of_csv().
IdentifiedRun recorded_identification(const scenario::Scenario& scenario, std::string_view csv,
                                      const std::string& name);

// Throws InputError where a fault stopped the experiment or the record says too little, with how it ended.
void evaluate(IdentifiedRun& run);

// The text of the axis' file with what was found in it, for which the axis may stay as it is otherwise.
std::string with_found(std::string_view text, const scenario::Scenario& scenario,
                       const evaluation::Identification& found);

}  // namespace breakaway::study
