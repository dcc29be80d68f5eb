// What the coast "work" needs on the controller, and what it promises: for a motor and a load that are joined by a
// spring with backlash.
//
// Let 1 be the motor and 2 the load, A and B bounds of friction, the force beside the drive's counted in on the motor,
// g = A1 + A2, K the least stiffness, G the greatest gap, Bs = min(B1, B2). A pulse in which the motor travels D1 under
// the force F leads neither of them beyond y if
//   F D1 <= g (y - eps),   eps = ((Bs + A')^2 / (2 K) + A' G) / g,   A' of the side without the encoder,
// which is Theorem E of THEORY.md. It is sure to move the load if, for the whole time t of the pulse,
//   F >= 1.002 max(B1 + B2, B1 - Bs + (B2 + Bs) / (1 - cos min(w1 t, pi/2))),   w1^2 = K/m1.
#pragma once

#include <cstddef>
#include <limits>

#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/law/work_kicks.hpp"

namespace breakaway::design {

// A swing of the least stiffness lasts at least so many periods: a pulse lasts whole ones, and readings must show them.
constexpr double least_swing_periods = 3;
// By which the true joint may be stiffer than is told. Nothing but the approach asks: at a faster swing its feedback
// acts too late and drives it.
constexpr double most_stiffer = 2.5;

// Of motor and load against each other, across the gap between them.
struct GapSwing {
  double apart_m = 0;  // either way
  double force_N = 0;  // that the feedback of an approach gives in it, with the most gain
};

template <class Real>
struct WorkDesign {
  law::WorkKicks<Real> kicks{};
  bool holds = false;             // the force beside the drive's leaves some of the motor's friction
  bool moves_load = false;        // some pulse within max_force_N is sure to
  bool swing_is_counted = false;  // a swing of the joint lasts at least 3 periods, and at most as long as a pulse may
  double pulse_needed_N = 0;  // the least command that is sure to move the load, in the longest pulse that is counted
  double spring_m = 0;        // eps
  double creep_m = 0;         // by which the spring may move an axis that is held, before it is kicked again
  double unseen_m = 0;        // that the side without the encoder may rest off where it seems to
  double floor_m = 0;         // nearer than this an axis is not kicked
  double reach_m = 0;
  double least_tolerance_m = 0;
  double rest_s = 0;          // without a count, that proves rest
  double resonance_Hz = 0;    // with the least stiffness
  double peak_speed_m_s = 0;  // of the motor, which no kick exceeds: it has no more than all the work
  // By which share the approach's feedback, which acts late, lets a swing of the joint grow in 1/(2 pi) of it, at the
  // worst stiffness and with the least damping of the joint; negative where it falls.
  double swing_growth = 0;
  GapSwing gap_swing;         // the greatest that it would keep up without friction
  double longest_stop_s = 0;  // in which friction may hold an axis, or turn it back, that its approach leads on
  std::size_t table_bytes = 0;

  // Kicks go on where the approach ends.
  bool possible() const {
    return holds && moves_load && swing_is_counted && floor_m < reach_m &&
           reach_m >= static_cast<double>(kicks.begin_m());
  }
};

// For a class with a spring_load, whose approaches may be as fast as this, [m/s]: an axis that looks still for
// longer than slow ones let it counts as stuck.
template <class Real>
WorkDesign<Real> design_work_kicks(const BrakedClass& axes,
                                   double max_approach_speed_m_s = std::numeric_limits<double>::infinity());

// The speed that an approach may reach which is to go no faster than this, [m/s], and how far it may go beyond its
// target, [m], of a design that is possible(): tested, not proved.
template <class Real>
double approach_peak_m_s(const BrakedClass& axes, const WorkDesign<Real>& design, double max_speed_m_s);
template <class Real>
double approach_beyond_m(const BrakedClass& axes, const WorkDesign<Real>& design, double max_speed_m_s);

// In which an axis may come no nearer to its target than where its approach passed it: it rests, and is kicked as often
// as it may be, each time until it is proved to rest; and in its approach friction may hold it.
template <class Real>
double without_progress_s(const BrakedClass& axes, const WorkDesign<Real>& design);

}  // namespace breakaway::design
