// HybridModes: a LinearMachine with its friction directions stuck or sliding, and which of them stick or slide next. At
// a stop, the accelerations decide, and at the very limit of static friction their derivatives: linear complementarity
// problems, so that simultaneous stops and dependent directions need no special case.
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "breakaway/hybrid/lcp.hpp"
#include "breakaway/hybrid/stick_set.hpp"
#include "breakaway/hybrid/types.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::hybrid {

// Where the machine is, and how its directions are.
template <int N, int M>
struct HybridState {
  Eigen::Matrix<double, N, 1> q, v;
  Eigen::Matrix<double, M, 1> signs;  // of sliding; 0 while sticking
  DirectionSet sticking = 0;          // with all directions that cannot slide while these stick
};

// Not for use by several threads at once: stick sets are factorised when first met. Copies are cheap and independent.
template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
class HybridModes {
 public:
  static constexpr Eigen::Index most_directions = 16;

  using Vector = Eigen::Matrix<double, N, 1>;
  using Set = StickSet<N, M>;
  using State = HybridState<N, M>;
  using Coordinates = typename Set::Coordinates;

  // `machine` passes require_valid(), has its constant force in force_N and at most 16 directions.
  explicit HybridModes(LinearMachine<N, M> machine)
      : machine_{std::move(machine)},
        delassus_{machine_.directions.transpose() * machine_.mass.llt().solve(machine_.directions)},
        sets_(std::size_t{1} << machine_.frictions()) {}

  const LinearMachine<N, M>& machine() const { return machine_; }
  const Set& set(DirectionSet directions) const;
  bool frictionless(Eigen::Index i) const { return machine_.friction_N[i] == 0 || delassus_(i, i) == 0; }

  // All forces but those of springs, dampers and sticking directions.
  Vector force(const State& at) const;
  // The state in the coordinates of a stick set, and the rounding in them.
  Coordinates coordinates(const State& at, const Set& in) const;
  Coordinates rounding(const State& at, const Set& in) const;
  // Neither velocity nor acceleration, to rounding.
  bool resting(const State& at, const Set& in) const;
  // Slower than 1e-12 of what the energy in the springs could drive: what is left of a motion that dies out in ever
  // smaller slips.
  bool lost_in_rounding(const State& at) const;

  // Decides which of the stopped directions stick and which slide, and how. Throws InputError for a machine so
  // ill-scaled that no friction forces can be found. `keep`: what friction can bear sticks, even at its very limit,
  // where rounding may say that it slides one way and, once sliding, that it stops again.
  void choose(State& at, DirectionSet stopped, bool keep = false) const;
  // Directions at the very limit of static friction: the same problem one derivative later. A force that moves inward
  // keeps the direction stuck, one that moves outward lets it slide. `forced_facet`: the face that is being crossed, or
  // -1.
  void release(State& at, int forced_facet) const;

 private:
  using Signs = Eigen::Matrix<double, M, 1>;
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

  bool all_stick(const State& at) const { return (at.signs.array() == 0).all(); }
  bool holds(const State& at, const Set& in) const;
  DirectionSet release_by_acceleration(State& at, DirectionSet stopped) const;

  LinearMachine<N, M> machine_;
  Eigen::Matrix<double, M, M> delassus_;
  mutable std::vector<std::shared_ptr<const Set>> sets_;
};

template <int N, int M>
const StickSet<N, M>& HybridModes<N, M>::set(DirectionSet directions) const {
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
typename HybridModes<N, M>::Vector HybridModes<N, M>::force(const State& at) const {
  Vector force = machine_.force_N;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (at.signs[i] != 0) force -= machine_.directions.col(i) * (at.signs[i] * machine_.friction_N[i]);
  }
  return force;
}

template <int N, int M>
typename HybridModes<N, M>::Coordinates HybridModes<N, M>::coordinates(const State& at, const Set& in) const {
  const Vector balance = force(at) - machine_.stiffness * at.q - machine_.damping * at.v;
  return in.from_velocity.lazyProduct(at.v) + in.from_force.lazyProduct(balance);
}

template <int N, int M>
typename HybridModes<N, M>::Coordinates HybridModes<N, M>::rounding(const State& at, const Set& in) const {
  const Vector terms = machine_.force_N.cwiseAbs() + machine_.directions.cwiseAbs().lazyProduct(machine_.friction_N) +
                       machine_.stiffness.cwiseAbs().lazyProduct(at.q.cwiseAbs()) +
                       machine_.damping.cwiseAbs().lazyProduct(at.v.cwiseAbs());
  const Coordinates sizes =
      in.from_velocity.cwiseAbs().lazyProduct(at.v.cwiseAbs()) + in.from_force.cwiseAbs().lazyProduct(terms);
  return 8 * std::numeric_limits<double>::epsilon() * sizes;
}

template <int N, int M>
bool HybridModes<N, M>::resting(const State& at, const Set& in) const {
  if (!all_stick(at)) return false;
  if (in.flow.size() == 0) return true;
  if ((at.v.array() != 0).any()) return false;
  return (coordinates(at, in).array().abs() <= rounding(at, in).array()).all();
}

template <int N, int M>
bool HybridModes<N, M>::lost_in_rounding(const State& at) const {
  return at.v.dot(machine_.mass * at.v) <= 1e-24 * at.q.dot(machine_.stiffness * at.q);
}

// Whether static friction can bear what sticking needs. At the very limit it can: whether it then gives way is for
// release() to say.
template <int N, int M>
bool HybridModes<N, M>::holds(const State& at, const Set& in) const {
  const Vector applied = force(at);
  for (const auto& facet : in.facets) {
    const double needed = facet.stiffness.dot(at.q) + facet.damping.dot(at.v) - facet.normal.dot(applied);
    if (!(std::abs(needed) <= facet.limit_N * (1 + 1e-12))) return false;
  }
  return true;
}

template <int N, int M>
void HybridModes<N, M>::choose(State& at, DirectionSet stopped, bool keep) const {
  if (stopped != 0) stopped = set(stopped).sticking;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(stopped, i)) at.signs[i] = 0;
  }
  at.sticking = stopped;
  if (!holds(at, set(at.sticking))) {
    stopped &= ~release_by_acceleration(at, stopped);
    at.sticking = set(stopped).sticking;
  }
  if (!keep) release(at, -1);
}

// The accelerations at a stop: gamma = A lambda + b with lambda_i in -f_i Sign(gamma_i). With lambda = f (z1 - 1) and
// gamma = w1 - z2 this is a linear complementarity problem of twice the size; each row and force in its own unit.
template <int N, int M>
DirectionSet HybridModes<N, M>::release_by_acceleration(State& at, DirectionSet stopped) const {
  Indices index;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(stopped, i) && !frictionless(i)) index.add(i);
  }
  const auto count = index.size;
  const Vector acceleration =
      machine_.mass.llt().solve(Vector{force(at) - machine_.stiffness * at.q - machine_.damping * at.v});
  if (count == 1) {  // static friction does not hold it, so it slides
    at.signs[index[0]] = machine_.directions.col(index[0]).dot(acceleration) > 0 ? 1 : -1;
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
  if (!z) throw InputError{"the friction forces at a stop could not be found: directions and mass are too ill-scaled"};
  DirectionSet released = 0;
  for (Eigen::Index r = 0; r < count; ++r) {
    const double slide = a.row(r).head(count).dot(z->head(count)) + b[r];
    const double scale = a.row(r).head(count).cwiseAbs().sum() + std::abs(b[r]);
    if (std::abs(slide) <= significance * scale) continue;
    const Eigen::Index i = index[r];
    at.signs[i] = slide > 0 ? 1 : -1;
    released |= only(i);
  }
  return released;
}

template <int N, int M>
void HybridModes<N, M>::release(State& at, int forced_facet) const {
  if (at.sticking == 0) return;
  const Set& held = set(at.sticking);
  const Vector applied = force(at);
  Signs slide = Signs::Zero(machine_.frictions());
  DirectionSet limited = 0, forced = 0;
  for (std::size_t k = 0; k < held.facets.size(); ++k) {
    const auto& facet = held.facets[k];
    const double needed = facet.stiffness.dot(at.q) + facet.damping.dot(at.v) - facet.normal.dot(applied);
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

  State freed = at;
  Indices index;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (!contains(limited, i)) continue;
    index.add(i);
    freed.signs[i] = slide[i];
  }
  const DirectionSet rest = at.sticking & ~limited;
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
    if (contains(released, i)) at.signs[i] = slide[i];
  }
  at.sticking = set(at.sticking & ~released).sticking;
  for (Eigen::Index i = 0; i < machine_.frictions(); ++i) {
    if (contains(at.sticking, i)) at.signs[i] = 0;
  }
}

}  // namespace breakaway::hybrid
