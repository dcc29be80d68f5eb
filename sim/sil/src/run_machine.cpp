#include "breakaway/sil/run_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/refused.hpp"
#include "breakaway/hybrid/time_stepping.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/sil/contradiction.hpp"
#include "breakaway/sil/method_choice.hpp"
#include "impulse_walk.hpp"
#include "machine_end.hpp"

namespace breakaway::sil {
namespace {

using scenario::MachineScenario;
using State = hybrid::MachineState<Eigen::Dynamic>;

void append_mode(MachineResult& result, std::vector<int> mode) {
  if (result.modes.empty() || result.modes.back() != mode) result.modes.push_back(std::move(mode));
}

void append_rest(MachineResult& result, const hybrid::Outcome<Eigen::Dynamic>& outcome, Eigen::Index frictions) {
  if (outcome.verdict != hybrid::Verdict::at_rest) return;
  append_mode(result, std::vector<int>(static_cast<std::size_t>(frictions), 0));
}

constexpr double samples_of_a_trace = 1000;  // between events

double sample_interval_s(const scenario::MachineScenario& s) { return s.duration_s / samples_of_a_trace; }

void tell(const RecordingOptions& recording, const State& state, const MachineScenario& s) {
  if (recording.progress) recording.progress(state.time_s / s.duration_s);
}

template <class RunTo>
void run_from_impulse_to_impulse(const scenario::MachineScenario& s, MachineResult& result, const RunTo& run) {
  const Certificates certificates = certify(s);
  State last = *s.start;
  result.outcome = walk_impulses(s, run, [&](const State& state) { last = state; });
  result.proved = ProvenFate<Eigen::Dynamic>{s.machine, certificates}(last);
  require_consistent(s.machine, certificates, last, result.outcome);
}

// At an event a direction that begins to slide has no velocity yet: the mode shows half-way to the next one.
void run_event_driven(const scenario::MachineScenario& s, MachineResult& result, const RecordingOptions& recording) {
  const hybrid::EventDriven<> integrator{s.machine};
  std::vector<State> corners;
  run_from_impulse_to_impulse(s, result, [&](const State& start, double end_s) {
    return integrator.run(start, end_s, &result.events, [&](const State& state) {
      corners.push_back(state);
      tell(recording, state, s);
    });
  });
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (recording.trace) result.trace.push_back(corners[i]);
    if (i + 1 == corners.size() || !(corners[i + 1].time_s > corners[i].time_s)) continue;
    const double from_s = corners[i].time_s, to_s = corners[i + 1].time_s;
    append_mode(result, sliding_signs(s.machine, integrator.run(corners[i], (from_s + to_s) / 2).end.v));
    const double interval_s = sample_interval_s(s);
    for (double at_s = from_s + interval_s; recording.trace && at_s < to_s; at_s += interval_s) {
      result.trace.push_back(integrator.run(corners[i], at_s).end);
      result.trace.back().time_s = at_s;
    }
  }
  append_rest(result, result.outcome, s.machine.frictions());
}

void run_time_stepping(const scenario::MachineScenario& s, MachineResult& result, const RecordingOptions& recording) {
  const hybrid::TimeStepping<> integrator{s.machine, {.step_s = s.step_s, .theta = s.theta}};
  result.warning = integrator.warning();
  double next_s = 0;
  run_from_impulse_to_impulse(s, result, [&](const State& start, double end_s) {
    auto outcome = integrator.run(start, end_s, &result.events, [&](const State& state) {
      tell(recording, state, s);
      append_mode(result, sliding_signs(s.machine, state.v));
      if (!recording.trace || state.time_s < next_s) return;
      result.trace.push_back(state);
      next_s = state.time_s + sample_interval_s(s) / 2;
    });
    append_rest(result, outcome, s.machine.frictions());
    return outcome;
  });
  if (recording.trace) result.trace.push_back(result.outcome.end);
}

void run_adaptive(const scenario::MachineScenario& s, MachineResult& result, const RecordingOptions& recording) {
  hybrid::AdaptiveOptions options{.tolerance = s.tolerance};
  if (recording.trace) options.longest_step_s = sample_interval_s(s);
  const hybrid::Adaptive integrator =
      s.laws.empty() ? hybrid::Adaptive{s.machine, options} : hybrid::Adaptive{s.machine, s.laws, options};
  auto laws = integrator.laws();
  run_from_impulse_to_impulse(s, result, [&](const State& start, double end_s) {
    State before = start;
    auto outcome = integrator.resume(laws, start, end_s, &result.events, [&](const State& state) {
      tell(recording, state, s);
      // At an event a velocity may be zero, but no direction reverses within a step.
      if (state.time_s > before.time_s) append_mode(result, sliding_signs(s.machine, before.v + state.v));
      if (recording.trace) result.trace.push_back(state);
      before = state;
    });
    append_rest(result, outcome, s.machine.frictions());
    return outcome;
  });
}

}  // namespace

std::vector<int> sliding_signs(const stability::LinearMachine<>& machine, const Eigen::VectorXd& v) {
  constexpr double rounding = 1e-13;
  std::vector<int> signs;
  for (const auto direction : machine.directions.colwise()) {
    const double rate = direction.dot(v), scale = direction.cwiseAbs().dot(v.cwiseAbs());
    signs.push_back(std::abs(rate) <= rounding * scale ? 0 : rate > 0 ? 1 : -1);
  }
  return signs;
}

namespace {

MachineResult run_as_it_says(const scenario::MachineScenario& s, const RecordingOptions& recording) {
  MachineResult result;
  switch (s.integrator) {
    case scenario::Integrator::event_driven:
      run_event_driven(s, result, recording);
      break;
    case scenario::Integrator::time_stepping:
      run_time_stepping(s, result, recording);
      break;
    case scenario::Integrator::adaptive:
      run_adaptive(s, result, recording);
      break;
  }
  return result;
}

MachineResult run_to_accuracy(const scenario::MachineScenario& s, const RecordingOptions& recording) {
  const Accuracy accuracy = choose_method(s);
  MachineResult result = run_as_it_says(with_method(s, accuracy.method), recording);
  result.accuracy = accuracy;
  return result;
}

}  // namespace

MachineResult run_machine(const scenario::MachineScenario& s, const RecordingOptions& recording) {
  if (!s.start) throw InputError{fmt::format("{}: [start] is missing; give it q, and v unless 0", s.file)};
  try {
    return s.accuracy_m ? run_to_accuracy(s, recording) : run_as_it_says(s, recording);
  } catch (const AccuracyRefused&) {
    throw;  // it names the file
  } catch (const hybrid::Refused& refusal) {
    const bool free_choice = s.laws.empty() && !s.accuracy_m;
    if (s.file.empty()) throw;  // of the type that it is
    throw(free_choice ? refusal : refusal.without_another_method()).in_file(s.file);
  } catch (const InputError& error) {
    if (s.file.empty()) throw;
    throw error.in_file(s.file);
  }
}

}  // namespace breakaway::sil
