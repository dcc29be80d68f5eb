#include "breakaway/study/identification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/identified.hpp"
#include "breakaway/evaluation/record_csv.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::study {
namespace {

using scenario::Scenario;

void require_alone(const Scenario& s) {
  if (s.machine)
    throw InputError{"an experiment identifies an axis that moves alone, and this one is part of a [machine]"}.in_file(
        s.node.file);
}

evaluation::Mechanism mechanism_of(const Scenario& s) {
  return s.node.axes.front().surroundings.load ? evaluation::Mechanism::load_on_spring
                                               : evaluation::Mechanism::one_mass;
}

config::IdentifiedSpring entered_spring(const evaluation::SpringEstimate& spring) {
  return {.motor_kg = spring.motor_kg,
          .load_kg = spring.load_kg,
          .stiffness_N_per_m = spring.stiffness_N_per_m,
          .least_seen_N_per_m = spring.stiffness_seen_N_per_m.least,
          .damping_Ns_per_m = spring.damping_Ns_per_m,
          .motor_lower_N = spring.motor_N.least,
          .motor_upper_N = spring.motor_N.most,
          .load_lower_N = spring.load_N.least,
          .load_upper_N = spring.load_N.most};
}

}  // namespace

IdentifiedRun run_identification(const Scenario& s, const config::ExperimentRequest& request,
                                 const sil::ExperimentProgress& progress) {
  require_alone(s);
  const auto parameters = config::experiment_parameters<double>(s.node, s.node.axes.front(), request);
  sil::ExperimentRun run = sil::run_experiment(s, parameters, progress);
  const std::string ending{to_string(run.ending)};
  if (run.ending == identify::Ending::no_room)
    throw InputError{fmt::format("{} (it begins at {:g} m, and the travel is from {:g} to {:g} m)", ending,
                                 s.worlds.front().position_m, parameters.lowest_m, parameters.highest_m)}
        .in_file(s.node.file);
  return {.title = s.node.title,
          .file = s.node.file,
          .source = "an experiment on the emulated drive of " + s.node.file,
          .ending = ending,
          .complete = run.fault.empty() && run.ending == identify::Ending::complete,
          .stopped_by = run.fault,
          .mechanism = mechanism_of(s),
          .record = std::move(run.record),
          .found = {}};
}

IdentifiedRun recorded_identification(const Scenario& s, std::string_view csv, const std::string& name) {
  require_alone(s);
  const config::Axis& axis = s.node.axes.front();
  if (!s.node.loop || !axis.drive)
    throw InputError{"[loop] and [drive] are needed, which say what a period and a count are"}.in_file(s.node.file);
  const evaluation::RecordUnits units{.period_s = s.node.period_s(),
                                      .resolution_m = axis.drive->encoder_resolution_m,
                                      .force_step_N = config::force_step_N(axis),
                                      .max_force_N = axis.drive->max_force_N(),
                                      .axis = axis.name};
  try {
    return {.title = s.node.title,
            .file = name,
            .source = name,
            .ending = "a record from elsewhere",
            .complete = true,
            .stopped_by = "",
            .mechanism = mechanism_of(s),
            .record = evaluation::record_of_csv(csv, units),
            .found = {}};
  } catch (const InputError& error) {
    throw error.in_file(name);
  }
}

void evaluate(IdentifiedRun& run) {
  if (!run.stopped_by.empty())
    throw InputError{fmt::format("the experiment was stopped by \"{}\"", run.stopped_by)}.in_file(run.file);
  try {
    run.found = evaluation::evaluate(run.record, {}, run.mechanism);
  } catch (const InputError& error) {
    const InputError whole = run.complete ? error : InputError{fmt::format("{} ({})", error.what(), run.ending)};
    throw whole.in_file(run.file);
  }
}

std::string with_found(std::string_view text, const Scenario& s, const evaluation::Identification& found) {
  const config::Axis& axis = s.node.axes.front();
  const evaluation::LatencyEstimate& latency = found.latency;
  config::IdentifiedAxis entered{.mass_kg = found.mass.mass_kg,
                                 .mass_uncertainty = found.mass_uncertainty,
                                 .friction_lower_N = found.bounds_N.least,
                                 .friction_upper_N = found.bounds_N.most};
  if (found.spring) entered.spring = entered_spring(*found.spring);
  // The only coast that is told of it.
  if (axis.controller.impulsive && axis.controller.impulsive->coast == law::Coast::brake)
    entered.presliding_stiffness_N_per_m = found.presliding_N_per_m;
  // Of the loop that the file is for.
  if (latency.lag_is_seen && latency.periods == 1) {
    entered.lag_s = latency.lag_s;
    entered.lag_uncertainty = std::max(0.2, latency.lag_error_s / latency.lag_s);
  }
  return config::with_identified(text, s.node.file, axis.name, entered);
}

}  // namespace breakaway::study
