// TimeStepping: Moreau's scheme for a LinearMachine, impulses instead of forces and no events.
//
// One step of h from (q0, v0), with p_i = h lambda_i and theta = 1/2 for the midpoint rule:
//   (M + h theta C + h^2 theta^2 K) v1 = M v0 + h f - h (1 - theta) C v0 - h K (q0 + h theta (1 - theta) v0) + W p
//   p_i in -h Lambda_ii Sign(w_i^T v1),   q1 = q0 + h ((1 - theta) v0 + theta v1).
// Friction stays set-valued and acts on the velocity at the end of the step, so that what sticks stands still exactly.
// A velocity that passes through zero within a step does so at its end: the error is of the first order in h, whatever
// theta is, and does not depend on how many directions stick at once.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "breakaway/hybrid/friction_groups.hpp"
#include "breakaway/hybrid/types.hpp"
#include "breakaway/motion/tie.hpp"

namespace breakaway::hybrid {

struct TimeSteppingOptions {
  double step_s = 1e-3;  // h > 0
  double theta = 0.5;    // in [0, 1]: 0 explicit Euler, 1/2 midpoint, 1 implicit Euler
};

// Returns what to tell the user of a choice of theta, or nothing. theta != 1/2 acts as additional
// damping of about (theta - 1/2) h K. A machine whose own damping is not positive semidefinite may be unstable;
// implicit steps then bring to rest what in truth never rests, at any h, and say nothing.
std::string theta_warning(const LinearMachine<>& machine, double theta);

// The matrices of a step: without friction it ends at the velocity from_v v0 + from_q q0 + free.
struct SteppingScheme {
  Eigen::MatrixXd from_v, from_q;  // n x n
  Eigen::VectorXd free;            // n
  Eigen::MatrixXd to_v;            // n x m: velocities by impulses, (M + h theta C + h^2 theta^2 K)^-1 W
  Eigen::MatrixXd coupling;        // m x m: W^T to_v
  bool friction_holds_all;         // the directions span all coordinates
  Eigen::MatrixXd unheld;          // n x k: an orthonormal basis of the motions that no direction brakes
  bool nearly_dependent;           // of the directions, so that sweeps over them hardly converge
};

// Says whether short steps of this machine find the impulses at once, which takes microseconds, because sweeps over its
// directions hardly converge.
bool nearly_dependent(const LinearMachine<>& machine);

// Finds the impulses of a step at once. `sliding_m_s`: the speeds at its end without friction, by direction;
// `impulse_Ns` receives the impulses. Returns whether all directions stick. Throws Refused where double precision does
// not tell.
bool solve_impulses(const Eigen::MatrixXd& coupling, const Eigen::VectorXd& limit_Ns,
                    const Eigen::VectorXd& sliding_m_s, Eigen::VectorXd& impulse_Ns);

// Throws InputError for a machine that require_valid() refuses, a step or theta out of range, and a step so long that
// the matrix of the scheme is not positive definite.
SteppingScheme make_stepping_scheme(const LinearMachine<>& machine, const TimeSteppingOptions& options);

template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
class TimeStepping {
 public:
  // Throws as make_stepping_scheme() does.
  explicit TimeStepping(const LinearMachine<N, M>& machine, TimeSteppingOptions options = {},
                        EarlyDecision<N> decision = {});

  // Says why the results for this theta may be wrong; empty if they are right.
  const std::string& warning() const { return warning_; }
  double step_s() const { return step_s_; }

  // The search for the impulses of a step begins at those of the step before.
  struct Memory {
    Eigen::Matrix<double, M, 1> impulse_Ns;
    bool sticks = false;  // all directions did
  };
  Memory memory() const { return {Eigen::Matrix<double, M, 1>::Zero(limit_Ns_.size()), false}; }

  // Takes one step.
  void step(MachineState<N>& state, Memory& memory) const;

  // Runs until rest, an early decision or end_time_s, which the last step may pass by less than a step. Events are
  // logged at the end of the step in which they fall.
  Outcome<N> run(const MachineState<N>& start, double end_time_s, std::vector<Event>* log = nullptr,
                 const Observer<N>& observer = {}) const;

 private:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Square = Eigen::Matrix<double, N, N>;
  using Directions = Eigen::Matrix<double, N, M>;
  using Impulses = Eigen::Matrix<double, M, 1>;

  void solve(const Impulses& sliding_m_s, Memory& memory) const;
  void solve_at_once(const Impulses& sliding_m_s, Memory& memory) const;

  // Returns the impulse that would stop direction i.
  double wanted_Ns(const Impulses& sliding_m_s, const Impulses& p, Eigen::Index i) const {
    return p[i] - own_mass_kg_[i] * (sliding_m_s[i] + coupling_.row(i).dot(p));
  }

  // Says whether friction at its limits, as in the step before, stops no direction.
  bool slides_on(const Impulses& sliding_m_s, const Impulses& p) const {
    bool on = true;
    for (Eigen::Index i = 0; i < p.size(); ++i) {
      if (limit_Ns_[i] == 0) continue;
      const double along = p[i] < 0 ? -wanted_Ns(sliding_m_s, p, i) : wanted_Ns(sliding_m_s, p, i);
      on &= std::fabs(p[i]) == limit_Ns_[i] && along > motion::widened(limit_Ns_[i]);
    }
    return on;
  }

  // Says whether nothing but rounding pushes the motions that no direction brakes.
  bool unheld_rest(const Vector& q) const;
  void note_events(const Vector& before, Outcome<N>& outcome, std::vector<Event>& log) const;

  static constexpr int max_sweeps = 1000;  // beyond it the problem is solved at once

  double step_s_, before_s_, after_s_;  // h, h (1 - theta), h theta
  std::string warning_;                 // of theta_warning()
  EarlyDecision<N> decision_;
  Square from_v_, from_q_;
  Vector free_;
  Directions to_v_, directions_;
  Eigen::Matrix<double, M, M> coupling_;  // G = W^T (M + h theta C + h^2 theta^2 K)^-1 W
  Impulses limit_Ns_, own_mass_kg_, sliding_free_;
  Eigen::Matrix<double, M, N> sliding_from_v_, sliding_from_q_;  // of the end of the step without friction
  bool friction_holds_all_, nearly_dependent_;
  Eigen::MatrixXd unheld_, stiffness_;  // see SteppingScheme
  Eigen::VectorXd force_N_;
};

template <int N, int M>
TimeStepping<N, M>::TimeStepping(const LinearMachine<N, M>& machine, TimeSteppingOptions options,
                                 EarlyDecision<N> decision)
    : step_s_{options.step_s},
      before_s_{options.step_s * (1 - options.theta)},
      after_s_{options.step_s * options.theta},
      decision_{std::move(decision)} {
  const LinearMachine<> unsized = stability::unsized(machine);
  stability::require_valid(unsized);
  const LinearMachine<> rubbing = group_frictions(unsized).machine;
  const SteppingScheme scheme = make_stepping_scheme(rubbing, options);
  warning_ = theta_warning(unsized, options.theta);
  from_v_ = scheme.from_v;
  from_q_ = scheme.from_q;
  free_ = scheme.free;
  to_v_ = scheme.to_v;
  directions_ = machine.directions;
  coupling_ = scheme.coupling;
  limit_Ns_ = step_s_ * rubbing.friction_N;
  own_mass_kg_ = coupling_.diagonal();
  // A direction that moves nothing has no mass and takes no impulse.
  for (double& own : own_mass_kg_) own = own > 0 ? 1 / own : 0;
  sliding_from_v_ = rubbing.directions.transpose() * from_v_;
  sliding_from_q_ = rubbing.directions.transpose() * from_q_;
  sliding_free_ = rubbing.directions.transpose() * free_;
  friction_holds_all_ = scheme.friction_holds_all;
  nearly_dependent_ = scheme.nearly_dependent;
  unheld_ = scheme.unheld;
  stiffness_ = rubbing.stiffness;
  force_N_ = stability::constant_force(rubbing);
}

template <int N, int M>
void TimeStepping<N, M>::step(MachineState<N>& state, Memory& memory) const {
  Vector v = from_v_ * state.v + from_q_ * state.q + free_;
  solve(sliding_from_v_ * state.v + sliding_from_q_ * state.q + sliding_free_, memory);
  v += to_v_ * memory.impulse_Ns;
  // Where friction holds every coordinate, sticking leaves no speed, not even one of rounding; and what stands and is
  // not pushed stands on.
  if (memory.sticks && (friction_holds_all_ || (state.v.isZero(0) && unheld_rest(state.q)))) v.setZero();
  state.q += before_s_ * state.v + after_s_ * v;
  state.v = v;
  state.time_s += step_s_;
}

template <int N, int M>
Outcome<N> TimeStepping<N, M>::run(const MachineState<N>& start, double end_time_s, std::vector<Event>* log,
                                   const Observer<N>& observer) const {
  Outcome<N> outcome;
  outcome.end = start;
  Memory memory = this->memory();
  const double begin_s = outcome.end.time_s;
  bool stood = outcome.end.v.isZero(0);
  if (observer) observer(outcome.end);
  while (outcome.verdict == Verdict::undecided && outcome.end.time_s < end_time_s) {
    if (decision_) outcome.verdict = decision_(outcome.end);
    if (outcome.verdict != Verdict::undecided) break;
    const Vector before = outcome.end.v;
    step(outcome.end, memory);
    ++outcome.steps;
    outcome.end.time_s = begin_s + static_cast<double>(outcome.steps) * step_s_;  // h summed up would drift
    if (log != nullptr) note_events(before, outcome, *log);
    if (observer) observer(outcome.end);
    const bool stands = memory.sticks && outcome.end.v.isZero(0);
    if (stood && stands) {
      outcome.verdict = Verdict::at_rest;
      outcome.settling_time_s = outcome.end.time_s - step_s_;
    }
    stood = stands;
  }
  if (outcome.verdict != Verdict::at_rest) outcome.settling_time_s = outcome.end.time_s;
  return outcome;
}

template <int N, int M>
void TimeStepping<N, M>::solve(const Impulses& sliding_m_s, Memory& memory) const {
  Impulses& p = memory.impulse_Ns;
  if (slides_on(sliding_m_s, p)) {
    memory.sticks = p.size() == 0;
    return;
  }
  if (nearly_dependent_) return solve_at_once(sliding_m_s, memory);
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    bool changed = false;
    memory.sticks = true;
    for (Eigen::Index i = 0; i < p.size(); ++i) {
      const double wanted = wanted_Ns(sliding_m_s, p, i);
      const double next = std::clamp(wanted, -limit_Ns_[i], limit_Ns_[i]);
      changed |= std::fabs(next - p[i]) > 4e-16 * limit_Ns_[i];
      memory.sticks &= std::fabs(wanted) <= motion::widened(limit_Ns_[i]);
      p[i] = next;
    }
    if (!changed) return;
  }
  solve_at_once(sliding_m_s, memory);
}

template <int N, int M>
void TimeStepping<N, M>::solve_at_once(const Impulses& sliding_m_s, Memory& memory) const {
  Eigen::VectorXd impulse_Ns = memory.impulse_Ns;
  memory.sticks = solve_impulses(coupling_, limit_Ns_, sliding_m_s, impulse_Ns);
  memory.impulse_Ns = impulse_Ns;
}

template <int N, int M>
bool TimeStepping<N, M>::unheld_rest(const Vector& q) const {
  const Eigen::VectorXd force_N = force_N_ - stiffness_ * q;
  const Eigen::VectorXd terms_N = force_N_.cwiseAbs() + stiffness_.cwiseAbs() * q.cwiseAbs();
  const double rounding = 8 * std::numeric_limits<double>::epsilon();
  return ((unheld_.transpose() * force_N).array().abs() <=
          rounding * (unheld_.cwiseAbs().transpose() * terms_N).array())
      .all();
}

template <int N, int M>
void TimeStepping<N, M>::note_events(const Vector& before, Outcome<N>& outcome, std::vector<Event>& log) const {
  const auto sign = [](double rate, double scale) { return std::fabs(rate) <= 1e-14 * scale ? 0 : rate > 0 ? 1 : -1; };
  for (Eigen::Index i = 0; i < limit_Ns_.size(); ++i) {
    const auto direction = directions_.col(i);
    const int was = sign(direction.dot(before), direction.norm() * before.norm());
    const int is = sign(direction.dot(outcome.end.v), direction.norm() * outcome.end.v.norm());
    if (was == is) continue;
    const EventKind kind = is == 0 ? EventKind::stick : was == 0 ? EventKind::slip : EventKind::reversal;
    log.push_back({outcome.end.time_s, kind, static_cast<int>(i)});
    ++outcome.events;
  }
}

extern template class TimeStepping<2, 2>;
extern template class TimeStepping<>;

}  // namespace breakaway::hybrid
