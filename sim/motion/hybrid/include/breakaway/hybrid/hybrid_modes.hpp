// HybridModes: a LinearMachine with its friction directions stuck or sliding, and which of them stick or slide next. At
// a stop, the accelerations decide, and at the very limit of static friction their derivatives: linear complementarity
// problems, so that simultaneous stops and dependent directions need no special case.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "breakaway/hybrid/lcp.hpp"
#include "breakaway/hybrid/mode_choice.hpp"
#include "breakaway/hybrid/stick_set.hpp"
#include "breakaway/hybrid/stop_problem.hpp"
#include "breakaway/hybrid/types.hpp"
#include "breakaway/motion/tie.hpp"
#include "breakaway/stability/dense.hpp"

namespace breakaway::hybrid {

// A state before it was rounded.
struct FineState {
  ExtendedVector q, v;
};

// Says where the machine is and which of its directions stick.
template <int N, int M>
struct HybridState {
  Eigen::Matrix<double, N, 1> q, v;
  hybrid::Signs<M> signs;         // of sliding; 0 while sticking
  DirectionSet sticking = 0;      // with all directions that cannot slide while these stick
  double time_s = 0;              // for what is told to a person
  std::optional<FineState> fine;  // once a stiff set was met
};

// HybridModes is for one thread, because stick sets are factorised when first met. Copies are cheap and independent.
template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
class HybridModes {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Set = StickSet<N, M>;
  using State = HybridState<N, M>;
  using Coordinates = typename Set::Coordinates;

  // `machine` passes require_valid(), has its constant force in force_N and at most 16 directions, no two of which are
  // parallel. Directions without friction have columns of zero.
  explicit HybridModes(LinearMachine<N, M> machine);

  const LinearMachine<N, M>& machine() const { return machine_; }
  // Stick sets do not depend on the constant force, so those that were met stay.
  void set_force(const Vector& force_N) {
    machine_.force_N = force_N;
    measure_greatest_force();
  }
  const Set& set(DirectionSet directions) const {
    const auto& found = sets_[directions];
    return found ? *found : make_set(directions);
  }
  bool frictionless(Eigen::Index i) const { return !contains(rubbing_, i); }

  // All forces but those of springs, dampers and sticking directions.
  Vector force(const State& state) const;
  // All forces but those of sticking directions.
  Vector balance(const State& state) const {
    if (state.fine) [[unlikely]]
      return fine_balance(state);
    return force(state) - machine_.stiffness * state.q - machine_.damping * state.v;
  }
  // Returns what static friction must bear in this face so that the sticking directions stick.
  double needed_N(const State& state, const Facet<N, M>& facet, const Vector& applied) const {
    if (state.fine) [[unlikely]]
      return -facet.normal.dot(balance(state));
    return facet.stiffness.dot(state.q) + facet.damping.dot(state.v) - facet.normal.dot(applied);
  }
  // Keeps the digits of the state from here on.
  void refine(State& state) const {
    state.fine = {state.q.template cast<Extended>(), state.v.template cast<Extended>()};
  }
  // The state in the coordinates of a stick set, k, and a state whose digits are kept carried on from there: to x, with
  // the integral of x on the way.
  ExtendedVector fine_coordinates(const State& state, const Set& held) const;
  [[gnu::noinline]] void move(State& state, const Set& held, ExtendedVector begun, const Coordinates& x,
                              const Coordinates& integral, double elapsed_s) const;
  // The state in the coordinates of a stick set, and the rounding in them.
  Coordinates coordinates(const State& state, const Set& held) const;
  Coordinates rounding(const State& state, const Set& held) const;
  // Says whether there is neither velocity nor acceleration, to rounding.
  bool resting(const State& state, const Set& held) const;
  // Says whether what is left of the motion is rounding: the machine is slower than 1e-12 of what the energy in the
  // springs could drive, and where it is friction holds it, as far as rounding can tell. It is the end of a motion that
  // dies out in ever smaller slips, or creeps.
  bool lost_in_rounding(const State& state) const;

  // Decides which of the stopped directions stick and which slide, and how. Throws Refused for a machine so ill-scaled
  // that this cannot be told. `keep`: what friction can bear sticks, even at its very limit,
  // where rounding may say that it slides one way and, once sliding, that it stops again.
  void choose(State& state, DirectionSet stopped, bool keep = false) const;
  // Directions at the very limit of static friction: the same problem one derivative later. A force that moves inward
  // keeps the direction stuck, one that moves outward lets it slide. `forced_facet`: the face that is being crossed, or
  // -1.
  void release(State& state, int forced_facet) const;

 private:
  using Signs = hybrid::Signs<M>;

  // Holds a few directions, off the heap.
  struct Indices {
    std::array<Eigen::Index, most_directions> direction;
    Eigen::Index size = 0;

    void add(Eigen::Index i) { direction[static_cast<std::size_t>(size++)] = i; }
    Eigen::Index operator[](Eigen::Index i) const { return direction[static_cast<std::size_t>(i)]; }
  };

  // Sticking directions at their limit, and the signs with which they would slide.
  struct Limited {
    Signs slide;
    DirectionSet all = 0;
    DirectionSet forced = 0;  // those of the face that is being crossed
  };

  const Set& make_set(DirectionSet directions) const;
  // The sizes of the terms of force(), and of all forces.
  Vector applied_terms(const State& state) const;
  Vector force_terms(const State& state) const {
    return applied_terms(state) + machine_.stiffness.cwiseAbs().lazyProduct(state.q.cwiseAbs()) +
           machine_.damping.cwiseAbs().lazyProduct(state.v.cwiseAbs());
  }
  bool all_stick(const State& state) const { return (state.signs.array() == 0).all(); }
  ExtendedVector fine_force(const State& state) const;
  [[gnu::noinline]] Vector fine_balance(const State& state) const;
  [[gnu::noinline]] Coordinates rounded_coordinates(const State& state, const Set& held) const;
  bool holds(const State& state, const Set& held, double rounding = force_rounding) const;
  DirectionSet slide_after_stop(State& state, DirectionSet stopped) const;
  bool slides_held(DirectionSet stopped, DirectionSet released) const {
    return (set(stopped & ~released).sticking & released) != 0;
  }
  [[gnu::noinline]] bool holds_too(State& state, DirectionSet held) const;
  Sliding decide_stop(const State& state, const Indices& index, const Vector& balance) const;
  Sliding decide_in_extended_precision(const State& state, const Indices& index) const;
  DirectionSet slide(State& state, const Indices& index, const Sliding& sliding, DirectionSet except) const;
  Limited limited(const State& state, const Set& held, int forced_facet) const;
  DirectionSet leaving(const State& state, const Limited& limited) const;

  // The rounding of a sum of forces, as a share of its terms.
  static constexpr double force_rounding = 8 * std::numeric_limits<double>::epsilon();

  void measure_greatest_force() {
    greatest_force_N_ = machine_.force_N.cwiseAbs() + machine_.directions.cwiseAbs().lazyProduct(machine_.friction_N);
  }

  LinearMachine<N, M> machine_;
  DirectionSet rubbing_ = 0;              // the directions with friction
  Eigen::Matrix<double, M, N> response_;  // W^T M^-1: accelerations of directions by forces
  Eigen::Matrix<double, M, M> coupling_;  // W^T M^-1 W
  Vector greatest_force_N_;               // |f| + |W| p
  std::shared_ptr<const ModeChoice> doubtful_;
  mutable std::vector<std::shared_ptr<const Set>> sets_;
};

template <int N, int M>
HybridModes<N, M>::HybridModes(LinearMachine<N, M> machine)
    : machine_{std::move(machine)},
      doubtful_{std::make_shared<const ModeChoice>(stability::unsized(machine_))},
      sets_(std::size_t{1} << machine_.frictions()) {
  measure_greatest_force();
  response_ = doubtful_->response();
  coupling_ = doubtful_->coupling();
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (machine_.friction_N[i] != 0 && coupling_(i, i) != 0) rubbing_ |= only(i);
  }
}

template <int N, int M>
const StickSet<N, M>& HybridModes<N, M>::make_set(DirectionSet directions) const {
  const auto made = make_stick_set(stability::unsized(machine_), directions);
  // Directions that cannot slide while the others stick make two names for one set.
  auto& closed = sets_[made.sticking];
  if (!closed) closed = std::make_shared<const Set>(fixed<N, M>(made));
  sets_[directions] = closed;
  return *closed;
}

template <int N, int M>
typename HybridModes<N, M>::Vector HybridModes<N, M>::force(const State& state) const {
  Vector force = machine_.force_N;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (state.signs[i] != 0) force -= machine_.directions.col(i) * (state.signs[i] * machine_.friction_N[i]);
  }
  return force;
}

template <int N, int M>
ExtendedVector HybridModes<N, M>::fine_force(const State& state) const {
  ExtendedVector force = machine_.force_N.template cast<Extended>();
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (state.signs[i] == 0) continue;
    const ExtendedVector direction = machine_.directions.col(i).template cast<Extended>();
    force -= direction * Extended(state.signs[i] * machine_.friction_N[i]);
  }
  return force;
}

template <int N, int M>
typename HybridModes<N, M>::Vector HybridModes<N, M>::fine_balance(const State& state) const {
  return doubtful_->balance(fine_force(state), state.fine->q, state.fine->v).template cast<double>();
}

template <int N, int M>
ExtendedVector HybridModes<N, M>::fine_coordinates(const State& state, const Set& held) const {
  const FineMaps& maps = *held.fine;
  return maps.from_position * state.fine->q + maps.from_velocity * state.fine->v + maps.from_force * fine_force(state);
}

// In the time of a short motion x hardly changes, and a speed may be far less than the terms that it is the sum of:
// then what has changed is added, else x as it has become is known better.
template <int N, int M>
void HybridModes<N, M>::move(State& state, const Set& held, ExtendedVector begun, const Coordinates& x,
                             const Coordinates& integral, double elapsed_s) const {
  const ExtendedVector sum = integral.head(begun.size()).template cast<Extended>();
  for (const Block& block : held.flow.blocks()) {
    const auto rows = Eigen::seqN(block.first, block.size);
    if (block.speed * elapsed_s < 0.5) {
      begun(rows) += held.flow.generator()(rows, rows) * sum(rows);
    } else {
      begun(rows) = x(rows).template cast<Extended>();
    }
  }
  state.fine->q += held.fine->velocity * sum;
  state.fine->v = held.fine->velocity * begun;
  state.q = state.fine->q.template cast<double>();
  state.v = state.fine->v.template cast<double>();
}

template <int N, int M>
typename HybridModes<N, M>::Coordinates HybridModes<N, M>::rounded_coordinates(const State& state,
                                                                               const Set& held) const {
  Coordinates x = Coordinates::Zero(2 * machine_.coordinates());
  x.head(held.flow.size()) = fine_coordinates(state, held).template cast<double>();
  return x;
}

template <int N, int M>
typename HybridModes<N, M>::Coordinates HybridModes<N, M>::coordinates(const State& state, const Set& held) const {
  if (state.fine) [[unlikely]]
    return rounded_coordinates(state, held);
  return held.from_position.lazyProduct(state.q) + held.from_velocity.lazyProduct(state.v) +
         held.from_force.lazyProduct(force(state));
}

template <int N, int M>
typename HybridModes<N, M>::Coordinates HybridModes<N, M>::rounding(const State& state, const Set& held) const {
  const Coordinates sizes = held.from_position.cwiseAbs().lazyProduct(state.q.cwiseAbs()) +
                            held.from_velocity.cwiseAbs().lazyProduct(state.v.cwiseAbs()) +
                            held.from_force.cwiseAbs().lazyProduct(greatest_force_N_);
  return force_rounding * sizes;
}

template <int N, int M>
bool HybridModes<N, M>::resting(const State& state, const Set& held) const {
  if (!all_stick(state)) return false;
  if (held.flow.size() == 0) return true;
  if ((state.v.array() != 0).any()) return false;
  return (coordinates(state, held).array().abs() <= rounding(state, held).array()).all();
}

template <int N, int M>
bool HybridModes<N, M>::lost_in_rounding(const State& state) const {
  if (state.v.dot(machine_.mass * state.v) > 1e-24 * std::abs(state.q.dot(machine_.stiffness * state.q))) return false;
  constexpr double lost = 1e-11;
  State still = state;
  still.v.setZero();
  if (still.fine) still.fine->v.setZero();
  still.signs.setZero();
  const Set& held = set(rubbing_);
  still.sticking = held.sticking;
  if (!holds(still, held, lost)) return false;
  const Coordinates sizes = held.from_force.cwiseAbs().lazyProduct(force_terms(still));
  return (coordinates(still, held).array().abs() <= lost * sizes.array()).all();
}

template <int N, int M>
typename HybridModes<N, M>::Vector HybridModes<N, M>::applied_terms(const State& state) const {
  Vector terms = machine_.force_N.cwiseAbs();
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (state.signs[i] != 0) terms += machine_.directions.col(i).cwiseAbs() * machine_.friction_N[i];
  }
  return terms;
}

// Says whether static friction can bear what sticking needs. At the very limit it can, and release() says whether it
// then gives way.
template <int N, int M>
bool HybridModes<N, M>::holds(const State& state, const Set& held, double rounding) const {
  const Vector applied = force(state);
  for (const auto& facet : held.facets) {
    const double needed = std::abs(needed_N(state, facet, applied));
    if (needed <= motion::widened(facet.limit_N)) continue;
    const double terms = facet.stiffness.cwiseAbs().dot(state.q.cwiseAbs()) +
                         facet.damping.cwiseAbs().dot(state.v.cwiseAbs()) +
                         facet.normal.cwiseAbs().dot(applied_terms(state));
    if (!(needed <= motion::widened(facet.limit_N) + rounding * terms)) return false;
  }
  return true;
}

template <int N, int M>
void HybridModes<N, M>::choose(State& state, DirectionSet stopped, bool keep) const {
  stopped &= rubbing_;
  if (stopped != 0) stopped = set(stopped).sticking;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(stopped, i)) state.signs[i] = 0;
  }
  state.sticking = stopped;
  if (!holds(state, set(state.sticking))) {
    const DirectionSet released = slide_after_stop(state, stopped);
    state.sticking = set(stopped & ~released).sticking;
    const DirectionSet held = state.sticking & released;
    if (released == 0 || (held != 0 && !holds_too(state, held))) ModeChoice::refuse(state.time_s);
  }
  if (!keep) release(state, -1);
}

// What is said to slide and cannot, as others hold it, sticks: then friction must bear that, or the decision was wrong.
template <int N, int M>
bool HybridModes<N, M>::holds_too(State& state, DirectionSet held) const {
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(held, i)) state.signs[i] = 0;
  }
  return holds(state, set(state.sticking));
}

// Those of the stopped directions that do not stick begin to slide, and are returned.
template <int N, int M>
DirectionSet HybridModes<N, M>::slide_after_stop(State& state, DirectionSet stopped) const {
  Indices index;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(stopped & rubbing_, i)) index.add(i);
  }
  const Vector balance = this->balance(state);
  if (index.size == 1) {  // static friction does not hold it, so it slides
    state.signs[index[0]] = response_.row(index[0]).dot(balance) > 0 ? 1 : -1;
    return only(index[0]);
  }
  Sliding sliding = decide_stop(state, index, balance);
  DirectionSet released = slide(state, index, sliding, sliding.ties);
  if (slides_held(stopped, released)) [[unlikely]] {
    for (Eigen::Index r = 0; r < index.size; ++r) state.signs[index[r]] = 0;
    sliding = decide_in_extended_precision(state, index);
    released = slide(state, index, sliding, sliding.ties);
  }
  if (sliding.ties == 0 || holds(state, set(stopped & ~released))) return released;
  return slide(state, index, sliding, 0);
}

// Lets slide what does, but for those at the places `except`.
template <int N, int M>
DirectionSet HybridModes<N, M>::slide(State& state, const Indices& index, const Sliding& sliding,
                                      DirectionSet except) const {
  DirectionSet released = 0;
  for (Eigen::Index r = 0; r < index.size; ++r) {
    if (sliding.signs[r] == 0 || contains(except, r)) continue;
    state.signs[index[r]] = sliding.signs[r];
    released |= only(index[r]);
  }
  return released;
}

template <int N, int M>
Sliding HybridModes<N, M>::decide_stop(const State& state, const Indices& index, const Vector& balance) const {
  const Vector rounding = force_rounding * force_terms(state);
  StopProblem<double> problem(index.size);
  for (Eigen::Index r = 0; r < index.size; ++r) {
    const auto response = response_.row(index[r]);
    problem.acceleration[r] = response.dot(balance);
    problem.rounding[r] = response.cwiseAbs().dot(rounding);
    problem.forward_N[r] = machine_.friction_N[index[r]];
    for (Eigen::Index c = 0; c < index.size; ++c) problem.coupling(r, c) = coupling_(index[r], index[c]);
  }
  problem.backward_N = problem.forward_N;
  const auto sliding = sliding_after_stop(problem);
  return sliding && sliding->ties == 0 ? *sliding : decide_in_extended_precision(state, index);
}

template <int N, int M>
Sliding HybridModes<N, M>::decide_in_extended_precision(const State& state, const Indices& index) const {
  ModeChoice::Stop stop{state.time_s,
                        state.fine ? state.fine->q : ExtendedVector{state.q.template cast<Extended>()},
                        state.fine ? state.fine->v : ExtendedVector{state.v.template cast<Extended>()},
                        state.fine ? fine_force(state) : ExtendedVector{force(state).template cast<Extended>()},
                        force_rounding * force_terms(state),
                        force_rounding * applied_terms(state),
                        {},
                        DirectionVector(index.size),
                        {}};
  for (Eigen::Index r = 0; r < index.size; ++r) {
    stop.stopped.push_back(index[r]);
    stop.forward_N[r] = machine_.friction_N[index[r]];
  }
  stop.backward_N = stop.forward_N;
  return doubtful_->sliding(stop);
}

template <int N, int M>
void HybridModes<N, M>::release(State& state, int forced_facet) const {
  if (state.sticking == 0) return;
  const Limited limited = this->limited(state, set(state.sticking), forced_facet);
  if (limited.all == 0) return;
  // Where one face is crossed and no other limit reached, all of it gives way.
  DirectionSet released = limited.all == limited.forced ? limited.all : leaving(state, limited);
  if ((released & limited.forced) == 0) released |= limited.forced;
  const DirectionSet sticking = set(state.sticking & ~released).sticking;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(released, i)) state.signs[i] = limited.slide[i];
    if (contains(sticking, i)) state.signs[i] = 0;
  }
  state.sticking = sticking;
}

template <int N, int M>
typename HybridModes<N, M>::Limited HybridModes<N, M>::limited(const State& state, const Set& held,
                                                               int forced_facet) const {
  const Vector applied = force(state);
  Limited limited{Signs::Zero(machine_.frictions())};
  for (std::size_t k = 0; k < held.facets.size(); ++k) {
    const auto& facet = held.facets[k];
    const double needed = needed_N(state, facet, applied);
    const bool crossed = static_cast<int>(k) == forced_facet;
    if (!crossed && std::abs(needed) < facet.limit_N * (1 - 0.1 * motion::tie)) continue;
    for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
      if (facet.share[i] == 0) continue;
      limited.slide[i] = (needed > 0) == (facet.share[i] > 0) ? -1 : 1;
      limited.all |= only(i);
      if (crossed) limited.forced |= only(i);
    }
  }
  return limited;
}

// Those of the directions at their limit that the change of the forces drives beyond it: the jerks outward = A z + b
// with z the rates at which their friction gives in, if all slid that can.
template <int N, int M>
DirectionSet HybridModes<N, M>::leaving(const State& state, const Limited& limited) const {
  State freed = state;
  Indices index;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (!contains(limited.all, i)) continue;
    index.add(i);
    freed.signs[i] = limited.slide[i];
  }
  const Set& left = set(state.sticking & ~limited.all);
  const Coordinates x = coordinates(freed, left), noise = rounding(freed, left);
  const Eigen::Index count = index.size;
  LcpMatrix<double> a(count, count);
  LcpVector<double> b(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const Eigen::Index i = index[r];
    const auto& row = left.sliding[static_cast<std::size_t>(i)].second;
    double jerk = 0, scale = 0;
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      jerk += row[j] * x[j];
      scale += significance * std::abs(row[j] * x[j]) + std::abs(row[j]) * noise[j];
    }
    b[r] = std::abs(jerk) <= scale ? 0 : limited.slide[i] * jerk;
    for (Eigen::Index c = 0; c < count; ++c) {
      a(r, c) = limited.slide[i] * limited.slide[index[c]] * left.coupling(i, index[c]);
    }
  }
  const auto z = solve_lcp(a, b);
  DirectionSet leaving = 0;
  for (Eigen::Index r = 0; z && r < count; ++r) {
    if ((z->basic >> r & 1U) != 0) continue;
    double outward = b[r], scale = std::abs(b[r]);
    for (Eigen::Index c = 0; c < count; ++c) {
      outward += a(r, c) * z->z[c];
      scale += std::abs(a(r, c) * z->z[c]);
    }
    if (outward > significance * scale) leaving |= only(index[r]);
  }
  return leaving;
}

extern template class HybridModes<2, 2>;
extern template class HybridModes<1>;
extern template class HybridModes<2>;
extern template class HybridModes<>;

}  // namespace breakaway::hybrid
