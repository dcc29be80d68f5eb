// EventDriven: a LinearMachine followed without a step size, as in section 4 of van de Wouw & Leine (stability
// properties of equilibrium sets): the motion between events is known in closed form, events are located to rounding
// and cannot be missed, and a linear complementarity problem says which directions stick after a stop. Scaling
// coordinates, velocities and forces by a power of two scales the result exactly: there is no absolute tolerance.
//
// Zeno: with friction the number of events in a finite time is finite, so there is nothing to accelerate; a machine
// that settles with ever more events is ended by the caller's EarlyDecision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "breakaway/hybrid/lcp.hpp"
#include "breakaway/hybrid/segment.hpp"
#include "breakaway/hybrid/types.hpp"

namespace breakaway::hybrid {

// Not for use by several threads at once: modes are factorised when first met. Copies are cheap and independent.
template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
class EventDriven {
 public:
  static constexpr Eigen::Index most_directions = 16;

  // Throws std::invalid_argument for a machine that validate() refuses or with more than 16 directions.
  explicit EventDriven(const LinearMachine<N, M>& machine, EarlyDecision<N> decision = {})
      : machine_{machine}, decision_{std::move(decision)} {
    if (const std::string error = plant::validate(machine); !error.empty()) throw std::invalid_argument{error};
    if (machine.frictions() > most_directions) {
      throw std::invalid_argument{"directions has " + std::to_string(machine.frictions()) +
                                  " columns: the event-driven " + "method takes at most 16, so use time stepping"};
    }
    normalise_forces();
    delassus_ = machine_.directions.transpose() * machine_.mass.llt().solve(machine_.directions);
    sets_ = std::vector<std::shared_ptr<const Set>>(std::size_t{1} << machine.frictions());
  }

  // To rest, to a decision or to end_time_s, which may be infinite only if rest or a decision is sure to come. Throws
  // std::invalid_argument for a start of the wrong size or with entries that are not finite.
  Outcome<N> run(const MachineState<N>& start, double end_time_s, std::vector<Event>* log = nullptr,
                 const Observer<N>& observer = {}) const;

 private:
  using Set = StickSet<N, M>;
  using Vector = Eigen::Matrix<double, N, 1>;
  using Signs = Eigen::Matrix<double, M, 1>;
  using Coordinates = typename Set::Coordinates;
  static constexpr int pairs = twice(M);

  // A few directions, off the heap.
  struct Indices {
    std::array<Eigen::Index, most_directions> direction;
    Eigen::Index size = 0;

    void add(Eigen::Index i) { direction[static_cast<std::size_t>(size++)] = i; }
    Eigen::Index operator[](Eigen::Index i) const { return direction[static_cast<std::size_t>(i)]; }
    const Eigen::Index* begin() const { return direction.data(); }
    const Eigen::Index* end() const { return direction.data() + size; }
  };

  // The state at the last event, in forces of about one.
  struct Walk {
    Vector q, v;
    Signs signs;  // of sliding; 0 while sticking
    DirectionSet sticking = 0;
    double time_s = 0, time_rest_s = 0;  // the exact time is their sum
    Segment<N, M> segment;
    std::vector<Event>* log = nullptr;
    Outcome<N> outcome;
  };

  void normalise_forces();
  const Set& set(DirectionSet directions) const;
  bool all_stick(const Walk& walk) const { return (walk.signs.array() == 0).all(); }
  bool frictionless(Eigen::Index i) const { return machine_.friction_N[i] == 0 || delassus_(i, i) == 0; }

  Walk begin(const MachineState<N>& start) const;
  MachineState<N> state(const Walk& walk) const;
  Vector force(const Walk& walk) const;
  Coordinates coordinates(const Walk& walk, const Set& in) const;
  Coordinates rounding(const Walk& walk, const Set& in) const;
  bool resting(const Walk& walk, const Set& in) const;

  void choose_mode(Walk& walk, DirectionSet stopped) const;
  bool holds(const Walk& walk, const Set& in) const;
  DirectionSet release_by_acceleration(Walk& walk, DirectionSet stopped) const;
  void release_by_jerk(Walk& walk, int forced_facet) const;

  void start_segment(Walk& walk, const Set& in) const;
  void leave_segment(Walk& walk) const;
  void handle_event(Walk& walk) const;
  void record(Walk& walk, const Signs& before) const;
  void pass_time(Walk& walk, double duration_s) const;

  LinearMachine<N, M> machine_;
  EarlyDecision<N> decision_;
  int exponent_ = 0;  // forces, coordinates and velocities are in units of 2^exponent_
  Eigen::Matrix<double, M, M> delassus_;
  mutable std::vector<std::shared_ptr<const Set>> sets_;
};

// Forces of about one leave room for products of them.
template <int N, int M>
void EventDriven<N, M>::normalise_forces() {
  machine_.force_N = plant::constant_force(machine_);
  const double friction = machine_.frictions() > 0 ? machine_.friction_N.maxCoeff() : 0;
  const double largest = friction > 0 ? friction : machine_.force_N.cwiseAbs().maxCoeff();
  if (largest == 0) return;
  exponent_ = std::ilogb(largest);
  for (double& force_N : machine_.friction_N) force_N = std::ldexp(force_N, -exponent_);
  for (double& force_N : machine_.force_N) force_N = std::ldexp(force_N, -exponent_);
}

template <int N, int M>
const StickSet<N, M>& EventDriven<N, M>::set(DirectionSet directions) const {
  auto& found = sets_[directions];
  if (!found) {
    const auto made = make_stick_set({machine_.mass, machine_.damping, machine_.stiffness, machine_.directions,
                                      machine_.friction_N, machine_.force_N},
                                     directions);
    // Directions that cannot slide while the others stick make two names for one set.
    auto& closed = sets_[made.sticking];
    if (!closed) closed = std::make_shared<const Set>(fixed<N, M>(made));
    found = closed;
  }
  return *found;
}

template <int N, int M>
typename EventDriven<N, M>::Walk EventDriven<N, M>::begin(const MachineState<N>& start) const {
  const Eigen::Index n = machine_.coordinates(), m = machine_.frictions();
  if (start.q.size() != n || start.v.size() != n) {
    throw std::invalid_argument{"the start has " + std::to_string(start.q.size()) + " coordinates and " +
                                std::to_string(start.v.size()) + " velocities: give " + std::to_string(n) + " of each"};
  }
  Walk walk;
  const auto scaled = [&](double value) { return std::ldexp(value, -exponent_); };
  walk.q = start.q.unaryExpr(scaled);
  walk.v = start.v.unaryExpr(scaled);
  walk.time_s = start.time_s;
  if (!walk.q.allFinite() || !walk.v.allFinite() || !std::isfinite(walk.time_s)) {
    throw std::invalid_argument{"the start is not finite, or more than 1e300 times what friction can hold: correct it"};
  }
  walk.signs.setZero(m);
  DirectionSet stopped = 0;
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto terms = machine_.directions.col(i).cwiseProduct(walk.v);
    const double speed = terms.sum();
    if (frictionless(i)) continue;
    if (std::abs(speed) <= 4 * std::numeric_limits<double>::epsilon() * terms.cwiseAbs().sum()) {
      stopped |= only(i);
    } else {
      walk.signs[i] = speed > 0 ? 1 : -1;
    }
  }
  choose_mode(walk, stopped);
  return walk;
}

template <int N, int M>
MachineState<N> EventDriven<N, M>::state(const Walk& walk) const {
  const auto unscaled = [&](double value) { return std::ldexp(value, exponent_); };
  return {walk.time_s, walk.q.unaryExpr(unscaled), walk.v.unaryExpr(unscaled)};
}

// All forces but those of springs, dampers and sticking directions.
template <int N, int M>
typename EventDriven<N, M>::Vector EventDriven<N, M>::force(const Walk& walk) const {
  Vector force = machine_.force_N;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (walk.signs[i] != 0) force -= machine_.directions.col(i) * (walk.signs[i] * machine_.friction_N[i]);
  }
  return force;
}

template <int N, int M>
typename EventDriven<N, M>::Coordinates EventDriven<N, M>::coordinates(const Walk& walk, const Set& in) const {
  const Vector balance = force(walk) - machine_.stiffness * walk.q - machine_.damping * walk.v;
  return in.from_velocity.lazyProduct(walk.v) + in.from_force.lazyProduct(balance);
}

// That in coordinates().
template <int N, int M>
typename EventDriven<N, M>::Coordinates EventDriven<N, M>::rounding(const Walk& walk, const Set& in) const {
  const Vector terms = machine_.force_N.cwiseAbs() + machine_.directions.cwiseAbs().lazyProduct(machine_.friction_N) +
                       machine_.stiffness.cwiseAbs().lazyProduct(walk.q.cwiseAbs()) +
                       machine_.damping.cwiseAbs().lazyProduct(walk.v.cwiseAbs());
  const Coordinates sizes =
      in.from_velocity.cwiseAbs().lazyProduct(walk.v.cwiseAbs()) + in.from_force.cwiseAbs().lazyProduct(terms);
  return 8 * std::numeric_limits<double>::epsilon() * sizes;
}

// Neither velocity nor acceleration, to rounding.
template <int N, int M>
bool EventDriven<N, M>::resting(const Walk& walk, const Set& in) const {
  if (!all_stick(walk)) return false;
  if (in.flow.size() == 0) return true;
  if ((walk.v.array() != 0).any()) return false;
  return (coordinates(walk, in).array().abs() <= rounding(walk, in).array()).all();
}

// Whether static friction can bear what sticking needs. At the very limit it can: whether it then gives way is for
// release_by_jerk() to say.
template <int N, int M>
bool EventDriven<N, M>::holds(const Walk& walk, const Set& in) const {
  const Vector applied = force(walk);
  for (const auto& facet : in.facets) {
    const double needed = facet.stiffness.dot(walk.q) + facet.damping.dot(walk.v) - facet.normal.dot(applied);
    if (!(std::abs(needed) <= facet.limit_N * (1 + 1e-12))) return false;
  }
  return true;
}

// Decides which of the stopped directions stick and which slide, and how.
template <int N, int M>
void EventDriven<N, M>::choose_mode(Walk& walk, DirectionSet stopped) const {
  if (stopped != 0) stopped = set(stopped).sticking;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(stopped, i)) walk.signs[i] = 0;
  }
  walk.sticking = stopped;
  if (!holds(walk, set(walk.sticking))) {
    stopped &= ~release_by_acceleration(walk, stopped);
    walk.sticking = set(stopped).sticking;
  }
  release_by_jerk(walk, -1);
}

// The accelerations at a stop: gamma = A lambda + b with lambda_i in -f_i Sign(gamma_i). With lambda = f (z1 - 1) and
// gamma = w1 - z2 this is a linear complementarity problem of twice the size; each row and force in its own unit.
template <int N, int M>
DirectionSet EventDriven<N, M>::release_by_acceleration(Walk& walk, DirectionSet stopped) const {
  Indices index;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(stopped, i) && !frictionless(i)) index.add(i);
  }
  const auto count = index.size;
  const Vector acceleration =
      machine_.mass.llt().solve(Vector{force(walk) - machine_.stiffness * walk.q - machine_.damping * walk.v});
  if (count == 1) {  // static friction does not hold it, so it slides
    walk.signs[index[0]] = machine_.directions.col(index[0]).dot(acceleration) > 0 ? 1 : -1;
    return only(index[0]);
  }
  LcpMatrix<pairs> a = LcpMatrix<pairs>::Zero(2 * count, 2 * count);
  LcpVector<pairs> b(2 * count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const Eigen::Index i = index[r];
    const double weight = 1 / (delassus_(i, i) * machine_.friction_N[i]);
    b[r] = weight * machine_.directions.col(i).dot(acceleration);
    for (Eigen::Index c = 0; c < count; ++c) {
      const Eigen::Index j = index[c];
      a(r, c) = weight * delassus_(i, j) * machine_.friction_N[j];
      b[r] -= a(r, c);
    }
    a(r, count + r) = 1;
    a(count + r, r) = -1;
    b[count + r] = 2;
  }
  const auto z = solve_lcp<pairs>(a, b);
  if (!z)
    throw std::runtime_error{
        "the friction forces at a stop could not be found: directions and mass are too ill-scaled"};
  DirectionSet released = 0;
  for (Eigen::Index r = 0; r < count; ++r) {
    const double slide = a.row(r).head(count).dot(z->head(count)) + b[r];
    const double scale = a.row(r).head(count).cwiseAbs().sum() + std::abs(b[r]);
    if (std::abs(slide) <= significance * scale) continue;
    const Eigen::Index i = index[r];
    walk.signs[i] = slide > 0 ? 1 : -1;
    released |= only(i);
  }
  return released;
}

// Directions at the very limit of static friction: the same problem one derivative later. A force that moves inward
// keeps the direction stuck, one that moves outward lets it slide. `forced_facet`: the face that is being crossed, or
// -1.
template <int N, int M>
void EventDriven<N, M>::release_by_jerk(Walk& walk, int forced_facet) const {
  if (walk.sticking == 0) return;
  const Set& held = set(walk.sticking);
  const Vector applied = force(walk);
  Signs slide = Signs::Zero(machine_.frictions());
  DirectionSet limited = 0, forced = 0;
  for (std::size_t k = 0; k < held.facets.size(); ++k) {
    const auto& facet = held.facets[k];
    const double needed = facet.stiffness.dot(walk.q) + facet.damping.dot(walk.v) - facet.normal.dot(applied);
    const bool crossed = static_cast<int>(k) == forced_facet;
    if (!crossed && std::abs(needed) < facet.limit_N * (1 - 1e-13)) continue;
    for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
      if (facet.share[i] == 0) continue;
      slide[i] = (needed > 0) == (facet.share[i] > 0) ? -1 : 1;
      limited |= only(i);
      if (crossed) forced |= only(i);
    }
  }
  if (limited == 0) return;

  Walk freed = walk;
  Indices index;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (!contains(limited, i)) continue;
    index.add(i);
    freed.signs[i] = slide[i];
  }
  const DirectionSet rest = walk.sticking & ~limited;
  const Set& left = set(rest);
  const Coordinates x = coordinates(freed, left), noise = rounding(freed, left);
  const auto count = index.size;
  LcpMatrix<pairs> a(count, count);
  LcpVector<pairs> b(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const Eigen::Index i = index[r];
    const auto& row = left.sliding[static_cast<std::size_t>(i)].second;
    double jerk = 0, scale = 0;
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      jerk += row[j] * x[j];
      scale += significance * std::abs(row[j] * x[j]) + std::abs(row[j]) * noise[j];
    }
    b[r] = std::abs(jerk) <= scale ? 0 : slide[i] * jerk;
    for (Eigen::Index c = 0; c < count; ++c) {
      const Eigen::Index j = index[c];
      a(r, c) = slide[i] * slide[j] * machine_.directions.col(i).dot(left.mobility * machine_.directions.col(j));
    }
  }
  const auto z = solve_lcp<pairs>(a, b);
  DirectionSet released = 0;
  if (z) {
    for (Eigen::Index r = 0; r < count; ++r) {
      const double outward = a.row(r).dot(*z) + b[r];
      const double scale = a.row(r).cwiseAbs().dot(*z) + std::abs(b[r]);
      if (outward > significance * scale) released |= only(index[r]);
    }
  }
  if ((released & forced) == 0) released |= forced;
  for (const Eigen::Index i : index) {
    if (contains(released, i)) walk.signs[i] = slide[i];
  }
  walk.sticking = set(walk.sticking & ~released).sticking;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(walk.sticking, i)) walk.signs[i] = 0;
  }
}

template <int N, int M>
void EventDriven<N, M>::start_segment(Walk& walk, const Set& in) const {
  walk.segment.start(in, coordinates(walk, in), rounding(walk, in));
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (walk.signs[i] == 0) continue;
    walk.segment.watch({&in.sliding[static_cast<std::size_t>(i)], walk.signs[i], 0, 0, static_cast<int>(i), -1, 0});
  }
  if (in.facets.empty() || in.flow.size() == 0) return;
  const Vector applied = force(walk);
  for (std::size_t k = 0; k < in.facets.size(); ++k) {
    const auto& facet = in.facets[k];
    const double needed = facet.stiffness.dot(walk.q) - facet.normal.dot(applied);
    const double scale = facet.limit_N + facet.stiffness.cwiseAbs().dot(walk.q.cwiseAbs()) +
                         facet.normal.cwiseAbs().dot(applied.cwiseAbs());
    for (const double sign : {-1.0, 1.0}) {
      walk.segment.watch({&facet.line, sign, facet.limit_N + sign * needed, scale, -1, static_cast<int>(k), 0});
    }
  }
}

// Carries the state to the segment's end.
template <int N, int M>
void EventDriven<N, M>::leave_segment(Walk& walk) const {
  const Set& in = set(walk.sticking);
  walk.q += in.velocity.lazyProduct(walk.segment.integral());
  walk.v = in.velocity.lazyProduct(walk.segment.x());
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
void EventDriven<N, M>::handle_event(Walk& walk) const {
  const Signs before = walk.signs;
  const Watch<N>& cause = walk.segment.ended_by();
  if (cause.facet >= 0) {
    release_by_jerk(walk, cause.facet);
  } else {
    DirectionSet stopped = walk.sticking | only(cause.direction);
    for (const Watch<N>& watch : walk.segment.watches()) {
      if (walk.segment.stops_too(watch)) stopped |= only(watch.direction);
    }
    choose_mode(walk, stopped);
  }
  record(walk, before);
}

template <int N, int M>
void EventDriven<N, M>::record(Walk& walk, const Signs& before) const {
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (walk.signs[i] == before[i]) continue;
    ++walk.outcome.events;
    if (walk.log == nullptr) continue;
    const EventKind kind = walk.signs[i] == 0 ? EventKind::stick
                           : before[i] == 0   ? EventKind::slip
                                              : EventKind::reversal;
    walk.log->push_back({walk.time_s, kind, static_cast<int>(i)});
  }
}

template <int N, int M>
Outcome<N> EventDriven<N, M>::run(const MachineState<N>& start, double end_time_s, std::vector<Event>* log,
                                  const Observer<N>& observer) const {
  if (!(end_time_s >= start.time_s)) {
    throw std::invalid_argument{"the end time is no number or before the start: give a later one"};
  }
  Walk walk = begin(start);
  walk.log = log;
  const auto finish = [&](Verdict verdict) {
    walk.outcome.verdict = verdict;
    walk.outcome.end = state(walk);
    walk.outcome.settling_time_s = walk.time_s;
    return walk.outcome;
  };
  for (int at_once = 0;;) {
    const Set& in = set(walk.sticking);
    if (resting(walk, in)) {
      walk.v.setZero();
      if (observer) observer(state(walk));
      return finish(Verdict::at_rest);
    }
    if (observer) observer(state(walk));
    if (decision_) {
      if (const Verdict verdict = decision_(state(walk)); verdict != Verdict::undecided) return finish(verdict);
    }
    start_segment(walk, in);
    const auto ending = walk.segment.advance((end_time_s - walk.time_s) - walk.time_rest_s);
    leave_segment(walk);
    if (ending != Segment<N, M>::Ending::event) {
      if (end_time_s < never) walk.time_s = end_time_s;
      if (observer) observer(state(walk));
      const bool for_ever = ending == Segment<N, M>::Ending::forever && all_stick(walk);
      return finish(!for_ever                                 ? Verdict::undecided
                    : in.flow.decays(walk.segment.x().data()) ? Verdict::captured
                                                              : Verdict::lost);
    }
    handle_event(walk);
    at_once = walk.segment.elapsed_s() > 0 ? 0 : at_once + 1;
    if (at_once > 4 * (machine_.frictions() + 1)) {
      throw std::runtime_error{
          "the friction directions switch without end at one instant: the machine is too ill-scaled"};
    }
  }
}

}  // namespace breakaway::hybrid
