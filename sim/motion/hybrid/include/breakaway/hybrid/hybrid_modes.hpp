// HybridModes: a HybridMachine, and which of its friction directions stick or slide next. At a stop, the accelerations
// decide, and at the very limit of static friction their derivatives: linear complementarity problems, so that
// simultaneous stops and dependent directions need no special case.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "breakaway/hybrid/hybrid_machine.hpp"
#include "breakaway/hybrid/lcp.hpp"
#include "breakaway/hybrid/mode_choice.hpp"
#include "breakaway/hybrid/stick_set.hpp"
#include "breakaway/hybrid/stop_problem.hpp"
#include "breakaway/motion/tie.hpp"

namespace breakaway::hybrid {

template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
class HybridModes : public HybridMachine<N, M> {
 public:
  using Base = HybridMachine<N, M>;
  using typename Base::Coordinates, typename Base::Set, typename Base::State, typename Base::Vector;

  using Base::Base;
  using Base::coordinates, Base::force, Base::machine, Base::needed_N, Base::rounding, Base::set;

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
  using Base::applied_terms, Base::choice, Base::coupling, Base::fine_force, Base::force_rounding, Base::force_terms;
  using Base::holds, Base::response, Base::rubbing;

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

  DirectionSet slide_after_stop(State& state, DirectionSet stopped) const;
  [[gnu::noinline]] bool holds_too(State& state, DirectionSet held) const;
  Sliding decide_stop(const State& state, const Indices& index, const Vector& balance) const;
  Sliding decide_in_extended_precision(const State& state, const Indices& index) const;
  DirectionSet slide(State& state, const Indices& index, const Sliding& sliding, DirectionSet except) const;
  Limited limited(const State& state, const Set& held, int forced_facet) const;
  DirectionSet leaving(const State& state, const Limited& limited) const;
};

template <int N, int M>
void HybridModes<N, M>::choose(State& state, DirectionSet stopped, bool keep) const {
  stopped &= rubbing();
  if (stopped != 0) stopped = set(stopped).sticking;
  for (Eigen::Index i = 0; i < machine().frictions(); ++i) {
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
  for (Eigen::Index i = 0; i < machine().frictions(); ++i) {
    if (contains(held, i)) state.signs[i] = 0;
  }
  return holds(state, set(state.sticking));
}

// Those of the stopped directions that do not stick begin to slide, and are returned.
template <int N, int M>
DirectionSet HybridModes<N, M>::slide_after_stop(State& state, DirectionSet stopped) const {
  Indices index;
  for (Eigen::Index i = 0; i < machine().frictions(); ++i) {
    if (contains(stopped & rubbing(), i)) index.add(i);
  }
  const Vector balance = this->balance(state);
  if (index.size == 1) {  // static friction does not hold it, so it slides
    state.signs[index[0]] = response().row(index[0]).dot(balance) > 0 ? 1 : -1;
    return only(index[0]);
  }
  const Sliding sliding = decide_stop(state, index, balance);
  const DirectionSet released = slide(state, index, sliding, sliding.ties);
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
  const Vector rounding_N = force_rounding * force_terms(state);
  StopProblem<double> problem(index.size);
  for (Eigen::Index r = 0; r < index.size; ++r) {
    const auto row = response().row(index[r]);
    problem.acceleration[r] = row.dot(balance);
    problem.rounding[r] = row.cwiseAbs().dot(rounding_N);
    problem.forward_N[r] = machine().friction_N[index[r]];
    for (Eigen::Index c = 0; c < index.size; ++c) problem.coupling(r, c) = coupling()(index[r], index[c]);
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
    stop.forward_N[r] = machine().friction_N[index[r]];
  }
  stop.backward_N = stop.forward_N;
  return choice().sliding(stop);
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
  for (Eigen::Index i = 0; i < machine().frictions(); ++i) {
    if (contains(released, i)) state.signs[i] = limited.slide[i];
    if (contains(sticking, i)) state.signs[i] = 0;
  }
  state.sticking = sticking;
}

template <int N, int M>
typename HybridModes<N, M>::Limited HybridModes<N, M>::limited(const State& state, const Set& held,
                                                               int forced_facet) const {
  const Vector applied = force(state);
  Limited limited{Signs::Zero(machine().frictions())};
  for (std::size_t k = 0; k < held.facets.size(); ++k) {
    const auto& facet = held.facets[k];
    const double needed = needed_N(state, facet, applied);
    const bool crossed = static_cast<int>(k) == forced_facet;
    if (!crossed && std::abs(needed) < facet.limit_N * (1 - 0.1 * motion::tie)) continue;
    for (Eigen::Index i = 0; i < machine().frictions(); ++i) {
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
  for (Eigen::Index i = 0; i < machine().frictions(); ++i) {
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
