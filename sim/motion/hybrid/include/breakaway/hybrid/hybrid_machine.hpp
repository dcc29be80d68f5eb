// HybridMachine: a LinearMachine of which some friction directions stick and the others slide: the forces on it, its
// state in the coordinates of what is left to move, and whether static friction holds it.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "breakaway/hybrid/mode_choice.hpp"
#include "breakaway/hybrid/stick_set.hpp"
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

// HybridMachine is for one thread, because stick sets are factorised when first met. Copies are cheap and independent.
template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
class HybridMachine {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Set = StickSet<N, M>;
  using State = HybridState<N, M>;
  using Coordinates = typename Set::Coordinates;

  // `machine` passes require_valid(), has its constant force in force_N and at most 16 directions, no two of which are
  // parallel. Directions without friction have columns of zero.
  explicit HybridMachine(LinearMachine<N, M> machine);

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

 protected:
  // The rounding of a sum of forces, as a share of its terms.
  static constexpr double force_rounding = 8 * std::numeric_limits<double>::epsilon();

  // The sizes of the terms of force(), and of all forces.
  Vector applied_terms(const State& state) const;
  Vector force_terms(const State& state) const {
    return applied_terms(state) + machine_.stiffness.cwiseAbs().lazyProduct(state.q.cwiseAbs()) +
           machine_.damping.cwiseAbs().lazyProduct(state.v.cwiseAbs());
  }
  // Returns force() for a state that keeps its digits.
  ExtendedVector fine_force(const State& state) const;
  // Says whether static friction can bear what sticking needs. At the very limit it can, and release() says whether it
  // then gives way.
  bool holds(const State& state, const Set& held, double rounding = force_rounding) const;
  DirectionSet rubbing() const { return rubbing_; }
  const Eigen::Matrix<double, M, N>& response() const { return response_; }
  const Eigen::Matrix<double, M, M>& coupling() const { return coupling_; }
  const ModeChoice& choice() const { return *choice_; }  // where double leaves in doubt what sticks

 private:
  const Set& make_set(DirectionSet directions) const;
  bool all_stick(const State& state) const { return (state.signs.array() == 0).all(); }
  [[gnu::noinline]] Vector fine_balance(const State& state) const;
  [[gnu::noinline]] Coordinates rounded_coordinates(const State& state, const Set& held) const;
  void measure_greatest_force() {
    greatest_force_N_ = machine_.force_N.cwiseAbs() + machine_.directions.cwiseAbs().lazyProduct(machine_.friction_N);
  }

  LinearMachine<N, M> machine_;
  DirectionSet rubbing_ = 0;              // the directions with friction
  Eigen::Matrix<double, M, N> response_;  // W^T M^-1: accelerations of directions by forces
  Eigen::Matrix<double, M, M> coupling_;  // W^T M^-1 W
  Vector greatest_force_N_;               // |f| + |W| p
  std::shared_ptr<const ModeChoice> choice_;
  mutable std::vector<std::shared_ptr<const Set>> sets_;
};

template <int N, int M>
HybridMachine<N, M>::HybridMachine(LinearMachine<N, M> machine)
    : machine_{std::move(machine)},
      choice_{std::make_shared<const ModeChoice>(stability::unsized(machine_))},
      sets_(std::size_t{1} << machine_.frictions()) {
  measure_greatest_force();
  response_ = choice_->response();
  coupling_ = choice_->coupling();
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (machine_.friction_N[i] != 0 && coupling_(i, i) != 0) rubbing_ |= only(i);
  }
}

template <int N, int M>
const StickSet<N, M>& HybridMachine<N, M>::make_set(DirectionSet directions) const {
  const auto made = make_stick_set(stability::unsized(machine_), directions);
  // Directions that cannot slide while the others stick make two names for one set.
  auto& closed = sets_[made.sticking];
  if (!closed) closed = std::make_shared<const Set>(fixed<N, M>(made));
  sets_[directions] = closed;
  return *closed;
}

template <int N, int M>
typename HybridMachine<N, M>::Vector HybridMachine<N, M>::force(const State& state) const {
  Vector force = machine_.force_N;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (state.signs[i] != 0) force -= machine_.directions.col(i) * (state.signs[i] * machine_.friction_N[i]);
  }
  return force;
}

template <int N, int M>
ExtendedVector HybridMachine<N, M>::fine_force(const State& state) const {
  ExtendedVector force = machine_.force_N.template cast<Extended>();
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (state.signs[i] == 0) continue;
    const ExtendedVector direction = machine_.directions.col(i).template cast<Extended>();
    force -= direction * Extended(state.signs[i] * machine_.friction_N[i]);
  }
  return force;
}

template <int N, int M>
typename HybridMachine<N, M>::Vector HybridMachine<N, M>::fine_balance(const State& state) const {
  return choice_->balance(fine_force(state), state.fine->q, state.fine->v).template cast<double>();
}

template <int N, int M>
ExtendedVector HybridMachine<N, M>::fine_coordinates(const State& state, const Set& held) const {
  const FineMaps& maps = *held.fine;
  return maps.from_position * state.fine->q + maps.from_velocity * state.fine->v + maps.from_force * fine_force(state);
}

// In the time of a short motion x hardly changes, and a speed may be far less than the terms that it is the sum of:
// then what has changed is added, else x as it has become is known better.
template <int N, int M>
void HybridMachine<N, M>::move(State& state, const Set& held, ExtendedVector begun, const Coordinates& x,
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
typename HybridMachine<N, M>::Coordinates HybridMachine<N, M>::rounded_coordinates(const State& state,
                                                                                   const Set& held) const {
  Coordinates x = Coordinates::Zero(2 * machine_.coordinates());
  x.head(held.flow.size()) = fine_coordinates(state, held).template cast<double>();
  return x;
}

template <int N, int M>
typename HybridMachine<N, M>::Coordinates HybridMachine<N, M>::coordinates(const State& state, const Set& held) const {
  if (state.fine) [[unlikely]]
    return rounded_coordinates(state, held);
  return held.from_position.lazyProduct(state.q) + held.from_velocity.lazyProduct(state.v) +
         held.from_force.lazyProduct(force(state));
}

template <int N, int M>
typename HybridMachine<N, M>::Coordinates HybridMachine<N, M>::rounding(const State& state, const Set& held) const {
  const Coordinates sizes = held.from_position.cwiseAbs().lazyProduct(state.q.cwiseAbs()) +
                            held.from_velocity.cwiseAbs().lazyProduct(state.v.cwiseAbs()) +
                            held.from_force.cwiseAbs().lazyProduct(greatest_force_N_);
  return force_rounding * sizes;
}

template <int N, int M>
bool HybridMachine<N, M>::resting(const State& state, const Set& held) const {
  if (!all_stick(state)) return false;
  if (held.flow.size() == 0) return true;
  if ((state.v.array() != 0).any()) return false;
  return (coordinates(state, held).array().abs() <= rounding(state, held).array()).all();
}

template <int N, int M>
bool HybridMachine<N, M>::lost_in_rounding(const State& state) const {
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
typename HybridMachine<N, M>::Vector HybridMachine<N, M>::applied_terms(const State& state) const {
  Vector terms = machine_.force_N.cwiseAbs();
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (state.signs[i] != 0) terms += machine_.directions.col(i).cwiseAbs() * machine_.friction_N[i];
  }
  return terms;
}

template <int N, int M>
bool HybridMachine<N, M>::holds(const State& state, const Set& held, double rounding) const {
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

extern template class HybridMachine<2, 2>;
extern template class HybridMachine<1>;
extern template class HybridMachine<2>;
extern template class HybridMachine<>;

}  // namespace breakaway::hybrid
