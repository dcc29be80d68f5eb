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
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "breakaway/hybrid/budget.hpp"
#include "breakaway/hybrid/compiled_size.hpp"
#include "breakaway/hybrid/friction_groups.hpp"
#include "breakaway/hybrid/hybrid_modes.hpp"
#include "breakaway/hybrid/refused.hpp"
#include "breakaway/hybrid/segment.hpp"
#include "breakaway/hybrid/types.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/motion/summed_time.hpp"

namespace breakaway::hybrid {

// Copies are cheap and independent, but one is not for use by several threads at once: modes are factorised when first
// met.
template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
class EventDriven {
 public:
  static constexpr int coordinates = N;

  // Throws InputError for a machine that require_valid() refuses or with more than 16 directions.
  explicit EventDriven(const LinearMachine<N, M>& machine, EarlyDecision<N> decision = {});

  // Runs to rest, to a decision or to end_time_s, which may be infinite only if rest or a decision is sure to come.
  // Throws InputError for a start of the wrong size or with entries that are not finite.
  Outcome<N> run(const MachineState<N>& start, double end_time_s, std::vector<Event>* log = nullptr,
                 const Observer<N>& observer = {}, const Budget& budget = Budget{}) const;

  // Runs on from where a run ended, as when forces change. `sticking` (bit i: direction i) says what sticks at the
  // start, whatever rounding has left of its speed, and then what sticks at the end.
  Outcome<N> resume(const MachineState<N>& start, DirectionSet& sticking, double end_time_s,
                    std::vector<Event>* log = nullptr, const Budget& budget = Budget{}) const;

  // From now on this constant force acts in place of the machine's. Modes that were met stay factorised. Throws
  // InputError for a force of the wrong size or that is not finite.
  void set_force(const Eigen::Matrix<double, N, 1>& force_N);

 private:
  using Modes = HybridModes<N, M>;
  using Set = StickSet<N, M>;
  using State = HybridState<N, M>;
  using Signs = hybrid::Signs<M>;
  using Ending = typename Segment<N, M>::Ending;
  // The same machine at a size that the compiler knows, which takes less than half of the instructions.
  using Compiled =
      std::conditional_t<N == Eigen::Dynamic, CompiledSize<EventDriven<1>, EventDriven<2>>, std::monostate>;

  // The run at the last event.
  struct Walk {
    State state;  // in forces of about one
    motion::SummedTime time;
    double start_time_s = 0;
    Budget budget;
    Segment<N, M> segment;
    ExtendedVector begun;  // where the segment began, if the state is fine
    std::vector<Event>* log = nullptr;
    Outcome<N> outcome;
  };

  static const LinearMachine<N, M>& checked(const LinearMachine<N, M>& machine);
  static Compiled make_compiled([[maybe_unused]] const LinearMachine<N, M>& machine,
                                [[maybe_unused]] const EarlyDecision<N>& decision) {
    if constexpr (N == Eigen::Dynamic) {
      return Compiled{stability::unsized(machine), decision};
    } else {
      return {};
    }
  }
  static int largest_exponent(const LinearMachine<N, M>& machine);
  static LinearMachine<N, M> scaled(LinearMachine<N, M> machine, int exponent);

  Walk begin(const MachineState<N>& start, double end_time_s, DirectionSet sticking) const;
  Outcome<N> follow(Walk& walk, double end_time_s, const Observer<N>& observer) const;
  // `sticking` and what has no speed is at rest.
  void choose_first_modes(State& state, DirectionSet sticking) const;
  DirectionSet leaders_of(DirectionSet directions) const;
  DirectionSet followers_of(DirectionSet leaders) const;
  MachineState<N> unscaled(const Walk& walk) const;
  Verdict decide(const Walk& walk) const { return decision_ ? decision_(unscaled(walk)) : Verdict::undecided; }
  Outcome<N> finish(Walk& walk, Verdict verdict) const;
  Outcome<N> finish_at_rest(Walk& walk, const Observer<N>& observer) const;
  Outcome<N> finish_without_event(Walk& walk, Ending ending, double end_time_s, const Observer<N>& observer) const;

  void start_segment(Walk& walk, const Set& held) const;
  void watch_limits(Walk& walk, const Set& held) const;
  [[gnu::noinline]] void begin_fine(Walk& walk, const Set& held) const;
  // What is watched as it changes from its value at the start, which the digits of the state tell.
  [[gnu::noinline]] void watch_change(Walk& walk, Eigen::Index direction) const;
  [[gnu::noinline]] void watch_change(Walk& walk, const Facet<N, M>& facet, double sign) const;
  void leave_segment(Walk& walk, const Set& held) const;
  void rub(Walk& walk, const Set& held) const;
  // `doubtful` says that the same instant has been decided again and again.
  void handle_event(Walk& walk, bool doubtful) const;
  void stop_everything(Walk& walk) const;
  DirectionSet stopped_with(const Walk& walk, int direction) const;
  void record(Walk& walk, const Signs& before) const;
  double work_of_an_event() const;
  [[noreturn]] void refuse(const Walk& walk, double end_time_s) const;

  Compiled compiled_;
  EarlyDecision<N> decision_;
  int exponent_;  // forces, coordinates and velocities are in units of 2^exponent_
  FrictionGroups groups_;
  Modes modes_;
};

template <int N, int M>
EventDriven<N, M>::EventDriven(const LinearMachine<N, M>& machine, EarlyDecision<N> decision)
    : compiled_{make_compiled(checked(machine), decision)},
      decision_{std::move(decision)},
      exponent_{largest_exponent(machine)},
      groups_{group_frictions(stability::unsized(scaled(machine, -exponent_)))},
      modes_{stability::sized<N, M>(groups_.machine)} {}

template <int N, int M>
const LinearMachine<N, M>& EventDriven<N, M>::checked(const LinearMachine<N, M>& machine) {
  stability::require_valid(stability::unsized(machine));
  if (machine.frictions() > most_directions) {
    throw Refused{"directions has " + std::to_string(machine.frictions()) +
                      " columns, and the event-driven method takes at most 16",
                  "leave out those without friction, and join what is parallel",
                  "set [run] integrator to \"time_stepping\""};
  }
  return machine;
}

template <int N, int M>
int EventDriven<N, M>::largest_exponent(const LinearMachine<N, M>& machine) {
  double largest = 0;
  for (const double force_N : machine.friction_N) largest = std::max(largest, force_N);
  if (largest == 0) {
    for (const double force_N : machine.force_N) largest = std::max(largest, std::abs(force_N));
  }
  return largest == 0 ? 0 : std::ilogb(largest);
}

// Forces of about one leave room for products of them.
template <int N, int M>
LinearMachine<N, M> EventDriven<N, M>::scaled(LinearMachine<N, M> machine, int exponent) {
  machine.force_N = stability::constant_force(machine);
  for (double& force_N : machine.friction_N) force_N = std::ldexp(force_N, exponent);
  for (double& force_N : machine.force_N) force_N = std::ldexp(force_N, exponent);
  return machine;
}

template <int N, int M>
typename EventDriven<N, M>::Walk EventDriven<N, M>::begin(const MachineState<N>& start, double end_time_s,
                                                          DirectionSet sticking) const {
  if (!(end_time_s >= start.time_s)) {
    throw InputError{"the end time is no number or before the start: give a later one"};
  }
  const Eigen::Index n = modes_.machine().coordinates();
  if (start.q.size() != n || start.v.size() != n) {
    throw InputError{"the start has " + std::to_string(start.q.size()) + " coordinates and " +
                     std::to_string(start.v.size()) + " velocities: give " + std::to_string(n) + " of each"};
  }
  Walk walk;
  walk.state.q = start.q;
  walk.state.v = start.v;
  walk.time = {start.time_s};
  walk.state.time_s = walk.start_time_s = start.time_s;
  bool finite = std::isfinite(start.time_s);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (double* const value : {&walk.state.q[i], &walk.state.v[i]}) {
      *value = std::ldexp(*value, -exponent_);
      finite = finite && std::isfinite(*value);
    }
  }
  if (!finite) {
    throw InputError{"the start is not finite, or more than 1e300 times what friction can hold: correct it"};
  }
  choose_first_modes(walk.state, leaders_of(sticking));
  return walk;
}

template <int N, int M>
DirectionSet EventDriven<N, M>::leaders_of(DirectionSet directions) const {
  DirectionSet leaders = 0;
  for (std::size_t i = 0; i < groups_.leader.size(); ++i) {
    if (groups_.leader[i] >= 0 && contains(directions, static_cast<Eigen::Index>(i)))
      leaders |= only(groups_.leader[i]);
  }
  return leaders;
}

template <int N, int M>
DirectionSet EventDriven<N, M>::followers_of(DirectionSet leaders) const {
  DirectionSet directions = 0;
  for (std::size_t i = 0; i < groups_.leader.size(); ++i) {
    if (groups_.leader[i] >= 0 && contains(leaders, groups_.leader[i]))
      directions |= only(static_cast<Eigen::Index>(i));
  }
  return directions;
}

template <int N, int M>
void EventDriven<N, M>::choose_first_modes(State& state, DirectionSet sticking) const {
  const auto& machine = modes_.machine();
  state.signs.setZero(machine.frictions());
  DirectionSet stopped = 0;
  for (Eigen::Index i = 0; i < machine.frictions(); ++i) {
    if (modes_.frictionless(i)) continue;
    const auto terms = machine.directions.col(i).cwiseProduct(state.v);
    const double speed = terms.sum();
    if (contains(sticking, i) ||
        std::abs(speed) <= 4 * std::numeric_limits<double>::epsilon() * terms.cwiseAbs().sum()) {
      stopped |= only(i);
    } else {
      state.signs[i] = speed > 0 ? 1 : -1;
    }
  }
  modes_.choose(state, stopped);
}

template <int N, int M>
MachineState<N> EventDriven<N, M>::unscaled(const Walk& walk) const {
  MachineState<N> state{walk.time.sum_s, walk.state.q, walk.state.v};
  for (double& value : state.q) value = std::ldexp(value, exponent_);
  for (double& value : state.v) value = std::ldexp(value, exponent_);
  return state;
}

template <int N, int M>
void EventDriven<N, M>::start_segment(Walk& walk, const Set& held) const {
  if (held.stiff || walk.state.fine) [[unlikely]]
    begin_fine(walk, held);
  walk.segment.start(held, modes_.coordinates(walk.state, held), modes_.rounding(walk.state, held));
  for (Eigen::Index i = 0; i < modes_.machine().frictions(); ++i) {
    if (walk.state.signs[i] == 0) continue;
    const auto& line = held.sliding[static_cast<std::size_t>(i)];
    walk.segment.watch({&line, walk.state.signs[i], 0, 0, static_cast<int>(i), -1, 0});
    if (walk.state.fine) [[unlikely]]
      watch_change(walk, i);
  }
  if (held.flow.size() > 0) watch_limits(walk, held);
}

template <int N, int M>
void EventDriven<N, M>::watch_limits(Walk& walk, const Set& held) const {
  if (held.facets.empty()) return;
  const auto applied = modes_.force(walk.state);
  for (std::size_t k = 0; k < held.facets.size(); ++k) {
    const auto& facet = held.facets[k];
    const double needed = facet.stiffness.dot(walk.state.q) - facet.normal.dot(applied);
    const double scale = facet.limit_N + facet.stiffness.cwiseAbs().dot(walk.state.q.cwiseAbs()) +
                         facet.normal.cwiseAbs().dot(applied.cwiseAbs());
    for (const double sign : {-1.0, 1.0}) {
      walk.segment.watch({&facet.line, sign, facet.limit_N + sign * needed, scale, -1, static_cast<int>(k), 0});
      if (walk.state.fine) [[unlikely]]
        watch_change(walk, facet, sign);
    }
  }
}

template <int N, int M>
void EventDriven<N, M>::begin_fine(Walk& walk, const Set& held) const {
  if (!walk.state.fine) modes_.refine(walk.state);
  walk.begun = modes_.fine_coordinates(walk.state, held);
}

template <int N, int M>
void EventDriven<N, M>::watch_change(Walk& walk, Eigen::Index direction) const {
  const auto column = modes_.machine().directions.col(direction);
  const Extended speed = column.template cast<Extended>().dot(walk.state.fine->v);
  walk.segment.watch_change(
      {walk.state.signs[direction] * static_cast<double>(speed), column.cwiseProduct(walk.state.v).cwiseAbs().sum()});
}

template <int N, int M>
void EventDriven<N, M>::watch_change(Walk& walk, const Facet<N, M>& facet, double sign) const {
  const auto terms = facet.normal.cwiseProduct(modes_.balance(walk.state)).eval();
  walk.segment.watch_change({facet.limit_N - sign * terms.sum(), facet.limit_N + terms.cwiseAbs().sum()});
}

// Carries the state to the segment's end.
template <int N, int M>
void EventDriven<N, M>::leave_segment(Walk& walk, const Set& held) const {
  if (walk.budget.judged()) rub(walk, held);
  if (walk.state.fine) [[unlikely]] {
    modes_.move(walk.state, held, walk.begun, walk.segment.x(), walk.segment.integral(), walk.segment.elapsed_s());
    if (!walk.state.q.allFinite() || !walk.state.v.allFinite()) refuse_growth();
  } else {
    walk.state.q += held.velocity.lazyProduct(walk.segment.integral());
    walk.state.v = held.velocity.lazyProduct(walk.segment.x());
  }
  walk.time.pass(walk.segment.elapsed_s());
  walk.state.time_s = walk.time.sum_s;
  ++walk.outcome.steps;
}

// Tells the budget of a long run what friction takes from it.
template <int N, int M>
void EventDriven<N, M>::rub(Walk& walk, const Set& held) const {
  const auto& machine = modes_.machine();
  const Eigen::Matrix<double, N, 1> way = held.velocity.lazyProduct(walk.segment.integral());
  for (Eigen::Index i = 0; i < machine.frictions(); ++i) {
    if (walk.state.signs[i] != 0) walk.budget.rub(machine.friction_N[i] * std::abs(machine.directions.col(i).dot(way)));
  }
}

template <int N, int M>
void EventDriven<N, M>::handle_event(Walk& walk, bool doubtful) const {
  const Signs before = walk.state.signs;
  const Watch<N>& cause = walk.segment.ended_by();
  if (cause.facet >= 0) {
    modes_.release(walk.state, cause.facet);
  } else {
    modes_.choose(walk.state, stopped_with(walk, cause.direction), doubtful);
  }
  record(walk, before);
}

// A creep has died out, and no crossing of zero stops it: static friction has it now. The place still holds the
// rounding of a motion that began farther away; what that leaves of a force moves it on, from there.
template <int N, int M>
void EventDriven<N, M>::stop_everything(Walk& walk) const {
  const Signs before = walk.state.signs;
  DirectionSet stopped = walk.state.sticking;
  for (Eigen::Index i = 0; i < before.size(); ++i) {
    if (before[i] != 0) stopped |= only(i);
  }
  modes_.choose(walk.state, stopped, true);
  record(walk, before);
}

// All directions that have no speed when this one stops. Nearly parallel directions are slow together although a third
// one, which depends on them, is not: then they do not stop together.
template <int N, int M>
DirectionSet EventDriven<N, M>::stopped_with(const Walk& walk, int direction) const {
  const DirectionSet stopped = walk.state.sticking | only(direction);
  DirectionSet all = stopped;
  for (const Watch<N>& watch : walk.segment.watches()) {
    if (watch.direction != direction && walk.segment.stops_too(watch)) all |= only(watch.direction);
  }
  if (all == stopped) return stopped;
  const DirectionSet held = modes_.set(all).sticking;
  for (const Watch<N>& watch : walk.segment.watches()) {
    if (watch.direction >= 0 && contains(held, watch.direction) && walk.segment.slides(watch)) return stopped;
  }
  return all;
}

template <int N, int M>
void EventDriven<N, M>::record(Walk& walk, const Signs& before) const {
  for (std::size_t i = 0; i < groups_.leader.size(); ++i) {
    const Eigen::Index leader = groups_.leader[i];
    if (leader < 0 || walk.state.signs[leader] == before[leader]) continue;
    ++walk.outcome.events;
    if (walk.log == nullptr) continue;
    const EventKind kind = walk.state.signs[leader] == 0 ? EventKind::stick
                           : before[leader] == 0         ? EventKind::slip
                                                         : EventKind::reversal;
    walk.log->push_back({walk.time.sum_s, kind, static_cast<int>(i)});
  }
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::finish(Walk& walk, Verdict verdict) const {
  walk.outcome.verdict = verdict;
  walk.outcome.end = unscaled(walk);
  walk.outcome.settling_time_s = walk.time.sum_s;
  walk.outcome.work = walk.budget.spent();
  return walk.outcome;
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::finish_at_rest(Walk& walk, const Observer<N>& observer) const {
  walk.state.v.setZero();
  if (walk.state.fine) walk.state.fine->v.setZero();
  if (observer) observer(unscaled(walk));
  return finish(walk, Verdict::at_rest);
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::finish_without_event(Walk& walk, Ending ending, double end_time_s,
                                                   const Observer<N>& observer) const {
  if (end_time_s < never) walk.time = {end_time_s};
  if (observer) observer(unscaled(walk));
  if (ending != Ending::forever || walk.state.signs.any()) {
    return finish(walk, modes_.lost_in_rounding(walk.state) ? Verdict::at_rest : Verdict::undecided);
  }
  const bool decays = modes_.set(walk.state.sticking).flow.decays(walk.segment.x().data());
  return finish(walk, decays ? Verdict::captured : Verdict::lost);
}

// About the multiplications of a segment: a few products for each line that is watched, and for the flow.
template <int N, int M>
double EventDriven<N, M>::work_of_an_event() const {
  const auto n = static_cast<double>(modes_.machine().coordinates());
  return 12 * n * n * (static_cast<double>(modes_.machine().frictions()) + 8);
}

template <int N, int M>
void EventDriven<N, M>::refuse(const Walk& walk, double end_time_s) const {
  if (walk.budget.exhausted()) {
    walk.budget.refuse(walk.time.sum_s - walk.start_time_s, end_time_s - walk.start_time_s,
                       "its directions stick and slip, or vibrate, so often", "end earlier, or damp what vibrates",
                       "set [run] integrator to \"time_stepping\"");
  }
  throw Refused{"the friction directions switch without end at t = " + shown(walk.time.sum_s) + " s",
                "the machine is too ill-scaled for double precision; leave out its least friction or mass"};
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::run(const MachineState<N>& start, double end_time_s, std::vector<Event>* log,
                                  const Observer<N>& observer, const Budget& budget) const {
  if constexpr (N == Eigen::Dynamic) {
    if (compiled_.takes(start)) return compiled_.run(start, end_time_s, log, observer, budget);
  }
  Walk walk = begin(start, end_time_s, 0);
  walk.log = log;
  walk.budget = budget;
  return follow(walk, end_time_s, observer);
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::resume(const MachineState<N>& start, DirectionSet& sticking, double end_time_s,
                                     std::vector<Event>* log, const Budget& budget) const {
  if constexpr (N == Eigen::Dynamic) {
    if (compiled_.takes(start)) return compiled_.resume(start, sticking, end_time_s, log, budget);
  }
  Walk walk = begin(start, end_time_s, sticking);
  walk.log = log;
  walk.budget = budget;
  Outcome<N> outcome = follow(walk, end_time_s, {});
  sticking = followers_of(walk.state.sticking);
  return outcome;
}

template <int N, int M>
void EventDriven<N, M>::set_force(const Eigen::Matrix<double, N, 1>& force_N) {
  if (force_N.size() != modes_.machine().coordinates() || !force_N.allFinite())
    throw InputError{"the force is not finite or not of the machine's size: give a number for each coordinate"};
  if constexpr (N == Eigen::Dynamic) compiled_.set_force(force_N);
  Eigen::Matrix<double, N, 1> scaled_N = force_N;
  for (double& value_N : scaled_N) value_N = std::ldexp(value_N, -exponent_);
  modes_.set_force(scaled_N);
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::follow(Walk& walk, double end_time_s, const Observer<N>& observer) const {
  const auto most_at_once = 2 * (modes_.machine().frictions() + 1);
  for (int at_once = 0;;) {
    const Set& held = modes_.set(walk.state.sticking);
    if (modes_.resting(walk.state, held)) return finish_at_rest(walk, observer);
    if (observer) observer(unscaled(walk));
    if (const Verdict verdict = decide(walk); verdict != Verdict::undecided) return finish(walk, verdict);
    start_segment(walk, held);
    const Ending ending = walk.segment.advance(walk.time.until(end_time_s), walk.budget);
    leave_segment(walk, held);
    if (ending == Ending::exhausted) refuse(walk, end_time_s);
    const bool died_out = ending == Ending::faded;
    if (ending != Ending::event && !died_out) return finish_without_event(walk, ending, end_time_s, observer);
    const bool crawls = walk.segment.elapsed_s() <= std::numeric_limits<double>::epsilon() * std::abs(walk.time.sum_s);
    at_once = crawls ? at_once + 1 : 0;
    died_out ? stop_everything(walk) : handle_event(walk, at_once > most_at_once);
    walk.budget.spend(work_of_an_event());
    if (at_once <= 2 * most_at_once && !walk.budget.exhausted()) continue;
    if (modes_.lost_in_rounding(walk.state)) return finish_at_rest(walk, observer);
    refuse(walk, end_time_s);
  }
}

extern template class EventDriven<2, 2>;
extern template class EventDriven<1>;
extern template class EventDriven<2>;
extern template class EventDriven<>;

}  // namespace breakaway::hybrid
