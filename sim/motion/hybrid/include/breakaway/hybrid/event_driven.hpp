// EventDriven: a LinearMachine followed without a step size, as in section 4 of van de Wouw & Leine (stability
// properties of equilibrium sets): the motion between events is known in closed form, events are located to rounding
// and cannot be missed, and a linear complementarity problem says which directions stick after a stop. Scaling
// coordinates, velocities and forces by a power of two scales the result exactly: there is no absolute tolerance.
//
// Zeno: with friction the number of events in a finite time is finite, so there is nothing to accelerate; a machine
// that settles with ever more events is ended by the caller's EarlyDecision.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "breakaway/hybrid/hybrid_modes.hpp"
#include "breakaway/hybrid/segment.hpp"
#include "breakaway/hybrid/types.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::hybrid {

// Forces of about one leave room for products of them.
template <int N, int M>
LinearMachine<N, M> scaled_by(LinearMachine<N, M> machine, int exponent) {
  for (double& force_N : machine.friction_N) force_N = std::ldexp(force_N, exponent);
  for (double& force_N : machine.force_N) force_N = std::ldexp(force_N, exponent);
  return machine;
}

// Copies are cheap and independent, but one is not for use by several threads at once: modes are factorised when first
// met.
template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
class EventDriven {
 public:
  // Throws InputError for a machine that require_valid() refuses or with more than 16 directions.
  explicit EventDriven(const LinearMachine<N, M>& machine, EarlyDecision<N> decision = {})
      : EventDriven{checked(machine), std::move(decision), 0} {}

  // To rest, to a decision or to end_time_s, which may be infinite only if rest or a decision is sure to come. Throws
  // InputError for a start of the wrong size or with entries that are not finite.
  Outcome<N> run(const MachineState<N>& start, double end_time_s, std::vector<Event>* log = nullptr,
                 const Observer<N>& observer = {}) const;

 private:
  using Modes = HybridModes<N, M>;
  using Set = StickSet<N, M>;
  using State = HybridState<N, M>;
  using Signs = Eigen::Matrix<double, M, 1>;
  using Ending = typename Segment<N, M>::Ending;

  // The run at the last event.
  struct Walk {
    State at;                            // in forces of about one
    double time_s = 0, time_rest_s = 0;  // the exact time is their sum
    Segment<N, M> segment;
    std::vector<Event>* log = nullptr;
    Outcome<N> outcome;
  };

  EventDriven(const LinearMachine<N, M>& machine, EarlyDecision<N> decision, int)
      : decision_{std::move(decision)}, exponent_{largest_exponent(machine)}, modes_{scaled_by(machine, -exponent_)} {}

  static LinearMachine<N, M> checked(LinearMachine<N, M> machine);
  static int largest_exponent(const LinearMachine<N, M>& machine);

  Walk begin(const MachineState<N>& start) const;
  MachineState<N> state(const Walk& walk) const;
  Verdict decide(const Walk& walk) const { return decision_ ? decision_(state(walk)) : Verdict::undecided; }
  Outcome<N> finish(Walk& walk, Verdict verdict) const;
  Outcome<N> finish_at_rest(Walk& walk, const Observer<N>& observer) const;
  Outcome<N> finish_without_event(Walk& walk, Ending ending, double end_time_s, const Observer<N>& observer) const;

  void start_segment(Walk& walk, const Set& in) const;
  void leave_segment(Walk& walk, const Set& in) const;
  // doubtful: the same instant has been decided again and again.
  void handle_event(Walk& walk, bool doubtful) const;
  void record(Walk& walk, const Signs& before) const;
  void pass_time(Walk& walk, double duration_s) const;

  EarlyDecision<N> decision_;
  int exponent_;  // forces, coordinates and velocities are in units of 2^exponent_
  Modes modes_;
};

template <int N, int M>
LinearMachine<N, M> EventDriven<N, M>::checked(LinearMachine<N, M> machine) {
  stability::require_valid(stability::unsized(machine));
  if (machine.frictions() > Modes::most_directions) {
    throw InputError{"directions has " + std::to_string(machine.frictions()) +
                     " columns: the event-driven method takes at most 16, so use time stepping"};
  }
  machine.force_N = stability::constant_force(machine);
  return machine;
}

template <int N, int M>
int EventDriven<N, M>::largest_exponent(const LinearMachine<N, M>& machine) {
  const double friction = machine.frictions() > 0 ? machine.friction_N.maxCoeff() : 0;
  const double largest = friction > 0 ? friction : machine.force_N.cwiseAbs().maxCoeff();
  return largest == 0 ? 0 : std::ilogb(largest);
}

template <int N, int M>
typename EventDriven<N, M>::Walk EventDriven<N, M>::begin(const MachineState<N>& start) const {
  const Eigen::Index n = modes_.machine().coordinates(), m = modes_.machine().frictions();
  if (start.q.size() != n || start.v.size() != n) {
    throw InputError{"the start has " + std::to_string(start.q.size()) + " coordinates and " +
                     std::to_string(start.v.size()) + " velocities: give " + std::to_string(n) + " of each"};
  }
  Walk walk;
  const auto scaled = [&](double value) { return std::ldexp(value, -exponent_); };
  walk.at.q = start.q.unaryExpr(scaled);
  walk.at.v = start.v.unaryExpr(scaled);
  walk.time_s = start.time_s;
  if (!walk.at.q.allFinite() || !walk.at.v.allFinite() || !std::isfinite(walk.time_s)) {
    throw InputError{"the start is not finite, or more than 1e300 times what friction can hold: correct it"};
  }
  walk.at.signs.setZero(m);
  DirectionSet stopped = 0;
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto terms = modes_.machine().directions.col(i).cwiseProduct(walk.at.v);
    const double speed = terms.sum();
    if (modes_.frictionless(i)) continue;
    if (std::abs(speed) <= 4 * std::numeric_limits<double>::epsilon() * terms.cwiseAbs().sum()) {
      stopped |= only(i);
    } else {
      walk.at.signs[i] = speed > 0 ? 1 : -1;
    }
  }
  modes_.choose(walk.at, stopped);
  return walk;
}

template <int N, int M>
MachineState<N> EventDriven<N, M>::state(const Walk& walk) const {
  const auto unscaled = [&](double value) { return std::ldexp(value, exponent_); };
  return {walk.time_s, walk.at.q.unaryExpr(unscaled), walk.at.v.unaryExpr(unscaled)};
}

template <int N, int M>
void EventDriven<N, M>::start_segment(Walk& walk, const Set& in) const {
  walk.segment.start(in, modes_.coordinates(walk.at, in), modes_.rounding(walk.at, in));
  for (Eigen::Index i = 0; i < modes_.machine().frictions(); ++i) {
    if (walk.at.signs[i] == 0) continue;
    walk.segment.watch({&in.sliding[static_cast<std::size_t>(i)], walk.at.signs[i], 0, 0, static_cast<int>(i), -1, 0});
  }
  if (in.facets.empty() || in.flow.size() == 0) return;
  const auto applied = modes_.force(walk.at);
  for (std::size_t k = 0; k < in.facets.size(); ++k) {
    const auto& facet = in.facets[k];
    const double needed = facet.stiffness.dot(walk.at.q) - facet.normal.dot(applied);
    const double scale = facet.limit_N + facet.stiffness.cwiseAbs().dot(walk.at.q.cwiseAbs()) +
                         facet.normal.cwiseAbs().dot(applied.cwiseAbs());
    for (const double sign : {-1.0, 1.0}) {
      walk.segment.watch({&facet.line, sign, facet.limit_N + sign * needed, scale, -1, static_cast<int>(k), 0});
    }
  }
}

// Carries the state to the segment's end.
template <int N, int M>
void EventDriven<N, M>::leave_segment(Walk& walk, const Set& in) const {
  walk.at.q += in.velocity.lazyProduct(walk.segment.integral());
  walk.at.v = in.velocity.lazyProduct(walk.segment.x());
  pass_time(walk, walk.segment.elapsed_s());
  ++walk.outcome.steps;
}

template <int N, int M>
void EventDriven<N, M>::pass_time(Walk& walk, double duration_s) const {
  const double step = duration_s + walk.time_rest_s, sum = walk.time_s + step;
  walk.time_rest_s = step - (sum - walk.time_s);
  walk.time_s = sum;
}

template <int N, int M>
void EventDriven<N, M>::handle_event(Walk& walk, bool doubtful) const {
  const Signs before = walk.at.signs;
  const Watch<N>& cause = walk.segment.ended_by();
  if (cause.facet >= 0) {
    modes_.release(walk.at, cause.facet);
  } else {
    DirectionSet stopped = walk.at.sticking | only(cause.direction);
    for (const Watch<N>& watch : walk.segment.watches()) {
      if (walk.segment.stops_too(watch)) stopped |= only(watch.direction);
    }
    modes_.choose(walk.at, stopped, doubtful);
  }
  record(walk, before);
}

template <int N, int M>
void EventDriven<N, M>::record(Walk& walk, const Signs& before) const {
  for (Eigen::Index i = 0; i < modes_.machine().frictions(); ++i) {
    if (walk.at.signs[i] == before[i]) continue;
    ++walk.outcome.events;
    if (walk.log == nullptr) continue;
    const EventKind kind = walk.at.signs[i] == 0 ? EventKind::stick
                           : before[i] == 0      ? EventKind::slip
                                                 : EventKind::reversal;
    walk.log->push_back({walk.time_s, kind, static_cast<int>(i)});
  }
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::finish(Walk& walk, Verdict verdict) const {
  walk.outcome.verdict = verdict;
  walk.outcome.end = state(walk);
  walk.outcome.settling_time_s = walk.time_s;
  return walk.outcome;
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::finish_at_rest(Walk& walk, const Observer<N>& observer) const {
  walk.at.v.setZero();
  if (observer) observer(state(walk));
  return finish(walk, Verdict::at_rest);
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::finish_without_event(Walk& walk, Ending ending, double end_time_s,
                                                   const Observer<N>& observer) const {
  if (end_time_s < never) walk.time_s = end_time_s;
  if (observer) observer(state(walk));
  if (ending != Ending::forever || walk.at.signs.any()) return finish(walk, Verdict::undecided);
  const bool decays = modes_.set(walk.at.sticking).flow.decays(walk.segment.x().data());
  return finish(walk, decays ? Verdict::captured : Verdict::lost);
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::run(const MachineState<N>& start, double end_time_s, std::vector<Event>* log,
                                  const Observer<N>& observer) const {
  if (!(end_time_s >= start.time_s)) {
    throw InputError{"the end time is no number or before the start: give a later one"};
  }
  Walk walk = begin(start);
  walk.log = log;
  for (int at_once = 0;;) {
    const Set& in = modes_.set(walk.at.sticking);
    if (modes_.resting(walk.at, in)) return finish_at_rest(walk, observer);
    if (observer) observer(state(walk));
    if (const Verdict verdict = decide(walk); verdict != Verdict::undecided) return finish(walk, verdict);
    start_segment(walk, in);
    const Ending ending = walk.segment.advance((end_time_s - walk.time_s) - walk.time_rest_s);
    leave_segment(walk, in);
    if (ending != Ending::event) return finish_without_event(walk, ending, end_time_s, observer);
    at_once = walk.segment.elapsed_s() > 0 ? 0 : at_once + 1;
    const auto most_at_once = 2 * (modes_.machine().frictions() + 1);
    handle_event(walk, at_once > most_at_once);
    if (at_once > 2 * most_at_once) {
      if (modes_.lost_in_rounding(walk.at)) return finish_at_rest(walk, observer);
      throw InputError{"the friction directions switch without end at one instant: the machine is too ill-scaled"};
    }
  }
}

}  // namespace breakaway::hybrid
