// Adaptive: a LinearMachine whose frictions follow general laws (breakaway/friction),
//   M q'' + C q' + K q = f + W lambda,   lambda_i in -f_i(t, w_i^T q, |g_i|) Sign(g_i),   g = W^T q'.
//
// Extrapolation of high order in steps of adaptive size, from event to event. A direction comes to rest by exchange of
// the independent variable (Henon), so that no step passes the jump of friction at zero speed; static limits and the
// edges of a law are located as roots. At each event a linear complementarity problem says what sticks and what slides,
// however many directions stop at once. While directions stick, the motion is integrated in coordinates of the motions
// that are left: W_S^T q' = 0 holds to rounding, and q cannot drift.
//
// Between a law's static and its first sliding level nothing moves: a direction breaks away from the greater of the
// two, times 1 + 1e-12. Limits of sticking directions are watched at the stages of each step, with their slopes: a step
// is halved until a limit is farther away than it can come between two stages, or comes nearer, or leaves, all the
// time.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "breakaway/hybrid/types.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/model/friction_law.hpp"

namespace breakaway::hybrid {

struct HeldSet;
class ModeChoice;

struct AdaptiveOptions {
  double tolerance = 1e-12;  // of a step, relative to the speeds in the norm of the mass; in [1e-14, 1e-2]
  double longest_step_s = std::numeric_limits<double>::infinity();  // > 0; for an observer that wants to see more
  std::uint64_t most_steps = 200'000;  // > 0; a run that takes more is refused, so that none goes on without end
};

// Adaptive is for one thread, because what depends on the sticking directions is computed when first met.
class Adaptive {
 public:
  using Laws = std::vector<model::FrictionLaw>;
  using State = MachineState<Eigen::Dynamic>;
  using Result = Outcome<Eigen::Dynamic>;

  // `laws` holds one for each direction, in newtons (for a rotary direction newton metres) over t, w_i^T q and |w_i^T
  // q'|; machine.friction_N is not used. Throws InputError for a machine that require_valid() refuses, another number
  // of laws, more than 16 directions, and options out of range.
  //
  // A decision by certificate may take for granted that each friction stays within its law's bounds and nothing more.
  // Theorem 1 of van de Wouw & Leine (equilibrium sets) then holds with the lower ones: -g^T lambda >= sum lower_i
  // |g_i|, so inside { V < rho* } V falls at least as fast as under constant friction, and all motion dies out. Levels
  // of escape hold with the upper ones.
  Adaptive(const LinearMachine<>& machine, const Laws& laws, AdaptiveOptions options = {},
           EarlyDecision<Eigen::Dynamic> decision = {});

  // Takes constant friction, machine.friction_N.
  explicit Adaptive(const LinearMachine<>& machine, AdaptiveOptions options = {},
                    EarlyDecision<Eigen::Dynamic> decision = {});

  // Runs to rest, to a decision or to end_time_s, which is finite. The observer sees every step. at_rest is said when
  // it is sure to last: the machine is held even if every law that changes with time falls to its lower bound. One that
  // stands still under stronger friction which may yet fall is watched to the end, and `undecided`. Throws InputError
  // for a start of the wrong size or with entries that are not finite. Throws Refused when the directions switch
  // without end at one instant, when steps become too short, and when there are more of them than most_steps.
  Result run(const State& start, double end_time_s, std::vector<Event>* log = nullptr,
             const Observer<Eigen::Dynamic>& observer = {}) const;

  // Does the same with laws that have a past and keep it: those of random dwell draw on.
  Result resume(Laws& laws, const State& start, double end_time_s, std::vector<Event>* log = nullptr,
                const Observer<Eigen::Dynamic>& observer = {}) const;
  const Laws& laws() const { return laws_; }  // of the directions that have friction

 private:
  void keep_directions(const LinearMachine<>& machine, const std::vector<int>& columns);

  LinearMachine<> machine_;  // without directions that have no friction
  Laws laws_;                // one for each direction that is left
  std::vector<int> places_;  // by direction of the machine as it was given: its place among them, -1 for none
  std::shared_ptr<const ModeChoice> choice_;
  AdaptiveOptions options_;
  EarlyDecision<Eigen::Dynamic> decision_;
  mutable std::map<unsigned, std::shared_ptr<const HeldSet>> held_;  // by the set of sticking directions
};

}  // namespace breakaway::hybrid
