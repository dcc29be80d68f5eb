// From one simulated motion to a proof about every start near it: THEORY.md of controller/design, "Two motions".
//
// Two motions of a machine part at most as e^(ct) in the metric |x|^2 = v^T M v + q^T K q. So if the motion from x is
// at the time t deeper than d inside a set that is certified, every motion from within e^(-ct) d of x ends there, too.
#pragma once

#include <cmath>
#include <vector>

#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/refused.hpp"
#include "breakaway/study/basin.hpp"
#include "region_bounds.hpp"

namespace breakaway::study {

// Not for use by several threads at once.
template <int N, int M>
class BallProver {
 public:
  struct Result {
    Fate proved = Fate::undecided;                           // of every start in the ball
    hybrid::Verdict simulated = hybrid::Verdict::undecided;  // of its centre
    bool given_up = false;                                   // refused, or more work than the budget has
  };

  // `bounds` must outlive it.
  BallProver(const stability::LinearMachine<>& machine, const RegionBounds& bounds)
      : bounds_{bounds},
        mass_{machine.mass},
        stiffness_{machine.stiffness},
        integrator_{stability::sized<N, M>(machine),
                    [this](const hybrid::MachineState<N>& state) { return examine(state); }} {
    const Eigen::Index n = machine.coordinates();
    for (const RegionBounds::Escape& escape : bounds.escapes) {
      modes_.push_back({escape.real.head(n), escape.real.tail(n), escape.imaginary.head(n), escape.imaginary.tail(n),
                        escape.level, escape.steepness});
    }
  }
  BallProver(const BallProver&) = delete;  // the integrator refers to it
  BallProver& operator=(const BallProver&) = delete;

  // The ball of `radius` > 0 around the start, in the metric above (sqrt J). Follows the centre until the ball is
  // proved or can no longer be; to the centre's own end if `to_the_end`. Undecided where the motion is refused, or
  // costs more than the budget.
  Result prove(const hybrid::MachineState<N>& start, double radius, bool to_the_end, const hybrid::Budget& budget) try {
    result_ = {};
    radius_ = radius;
    escaped_ = 0;
    to_the_end_ = to_the_end;
    const auto outcome = integrator_.run(start, bounds_.horizon_s, nullptr, {}, budget);
    result_.simulated = outcome.verdict;
    if (outcome.verdict == hybrid::Verdict::at_rest && result_.proved == Fate::undecided) {
      const double share = bounds_.equilibria.gauge(outcome.end.q);
      if ((1 - share) * bounds_.depth > spread(outcome.settling_time_s)) result_.proved = Fate::attracted;
    }
    return result_;
  } catch (const hybrid::Refused&) {
    return {.given_up = true};
  }

  double distance(const hybrid::MachineState<N>& state) const {
    return std::sqrt(state.v.dot(mass_.lazyProduct(state.v)) + state.q.dot(stiffness_.lazyProduct(state.q)));
  }

 private:
  using Vector = Eigen::Matrix<double, N, 1>;

  struct Mode {
    Vector real_q, real_v, imaginary_q, imaginary_v;
    double level, steepness;
  };

  // The radius of what the ball has become.
  double spread(double time_s) const { return radius_ * std::exp(bounds_.parting_rate_per_s * time_s); }

  // How far z is beyond a level of escape, as a distance that no motion in between can have.
  double escaped(const hybrid::MachineState<N>& state) const {
    double farthest = 0;
    for (const Mode& mode : modes_) {
      const double size = std::hypot(mode.real_q.dot(state.q) + mode.real_v.dot(state.v),
                                     mode.imaginary_q.dot(state.q) + mode.imaginary_v.dot(state.v));
      farthest = std::max(farthest, (size - mode.level) / mode.steepness);
    }
    return farthest;
  }

  // At every event.
  hybrid::Verdict examine(const hybrid::MachineState<N>& state) {
    const double spread_to = spread(state.time_s), inside = bounds_.depth - distance(state);
    if (inside > spread_to) return proved(Fate::attracted, hybrid::Verdict::captured);
    const bool too_wide = bounds_.depth <= spread_to;
    if (inside > 0 && too_wide) return hybrid::Verdict::captured;
    const double beyond = escaped(state);
    if (beyond > spread_to) return proved(Fate::lost, hybrid::Verdict::lost);
    // Once beyond, a motion gets away at first faster and then no faster than the ball widens.
    const double share = beyond / spread_to;
    if (share > 0 && share <= escaped_) return hybrid::Verdict::lost;
    escaped_ = share;
    // Any verdict ends the motion; prove() is then not asked for the centre's fate.
    return too_wide && !to_the_end_ && share == 0 ? hybrid::Verdict::lost : hybrid::Verdict::undecided;
  }

  hybrid::Verdict proved(Fate fate, hybrid::Verdict verdict) {
    result_.proved = fate;
    return verdict;
  }

  const RegionBounds& bounds_;
  Eigen::Matrix<double, N, N> mass_, stiffness_;
  std::vector<Mode> modes_;
  Result result_;
  double radius_ = 0, escaped_ = 0;
  bool to_the_end_ = true;
  hybrid::EventDriven<N, M> integrator_;
};

}  // namespace breakaway::study
