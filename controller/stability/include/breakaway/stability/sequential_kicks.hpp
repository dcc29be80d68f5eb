// Theorem S: one axis of a coupled machine is kicked from rest, and no other one moves.
//
//   M(q) q'' + c(q, q') + C q' + K q = u + load + lambda,   |lambda_j| in [lo_j, hi_j] while axis j slides.
//
// While all others stick, the kicked axis i is an axis alone with the mass M_ii and the friction A..B, and what
// friction must hold of axis j is affine in its acceleration: hold-off forces take the middle of it away. THEORY.md
// proves it, with the lag of the current loops, and names the check of each assumption.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace breakaway::stability {

// A machine whose n coordinates are its axes, as far as the theorem must know it. SI units; vectors have n entries,
// matrices n x n.
struct CoupledAxes {
  Eigen::MatrixXd mass;              // kg, symmetric, at the middle of its range
  Eigen::MatrixXd mass_error;        // kg >= 0, by which an entry may be off, either way, within the range
  Eigen::VectorXd range_m;           // of |q_j| in which mass_error holds; empty: anywhere
  double mass_slope_kg_per_m = 0;    // the most of |dM_ab/dq_c| for any a, b, c: what makes Coriolis forces
  Eigen::MatrixXd damping;           // N s/m, C; its diagonal is not negative
  Eigen::MatrixXd stiffness;         // N/m, K
  Eigen::VectorXd load_N;            // >= 0, what else may push an axis, either way
  Eigen::VectorXd friction_lower_N;  // lo > 0
  Eigen::VectorXd friction_upper_N;  // hi >= lo
  Eigen::VectorXd brake_N;           // b >= 0, against the motion of a coast
  Eigen::VectorXd force_step_N;      // >= 0, of which a force is a whole number
  Eigen::VectorXd max_force_N;       // of the drive; 0 where no drive acts
  double period_s = 0;               // T
  double lag_s = 0;                  // time constant of all current loops; 0: a force acts at once

  Eigen::Index axes() const { return mass.rows(); }
  bool actuated(Eigen::Index j) const { return max_force_N[j] > 0; }
};

// Throws InputError with what is wrong and the remedy unless sizes, signs and symmetry are as above.
void require_valid(const CoupledAxes& axes);

// A force this much above the greatest friction is sure to move an axis.
inline constexpr double sure_share = 1.002;

// What a kick of one axis does to the axis itself, in a box |q_j| <= box_j around the target.
struct KickedAxis {
  double lower_N = 0, upper_N = 0;  // A and B: friction with all that acts beside it
  double brake_N = 0;
  double mass_lower_kg = 0, mass_upper_kg = 0;
  double peak_m_s = 0;  // the fastest that a kick from inside the box can make it
  double lag_s = 0;     // of its current loop
  double sure_N = 0;    // a force that moves the axis within half a period, whatever friction is

  // How far a force for `seconds` and the coast after it take the axis: the most, and the least. The force is at least
  // sure_N, for whole periods.
  double most_travel_m(double force_N, double seconds) const;
  double least_travel_m(double force_N, double seconds) const;
  // The force that goes `distance_m` at most.
  double force_N(double distance_m, double seconds) const;
};

KickedAxis kicked_axis(const CoupledAxes& axes, const Eigen::VectorXd& box_m, Eigen::Index kicked);

// The share of the kicked axis' inertia that its acceleration asks of another: hold_off = k_j, and what M leaves open.
struct Coupling {
  double hold_off = 0;   // the middle of M_ji/M_ii
  double deviation = 0;  // d_j, by which it may be off that
};

Coupling coupling(const CoupledAxes& axes, Eigen::Index kicked, Eigen::Index held);

// The last is no phase: the drive of the held axis must give the hold-off force of the pulse.
enum class KickPhase { start, pulse, coast, hold_off };

const char* to_string(KickPhase phase);

// One inequality of the theorem: what friction must hold of the axis `held`, at most, against what it holds at least;
// or what its drive must give.
struct PairCondition {
  Eigen::Index kicked = 0, held = 0;
  KickPhase phase = KickPhase::pulse;
  double needed_N = 0, held_N = 0;
  bool simultaneous = false;

  double margin_N() const { return held_N - needed_N; }
  bool holds() const { return margin_N() >= 0; }
};

// Of axis `held`: lo less springs, loads and rounding of forces in the box, at rest.
double free_friction_N(const CoupledAxes& axes, const Eigen::VectorXd& box_m, Eigen::Index held);

// All conditions on one pair, for kicks of at most force_N > B. They only get worse with force_N and with the box.
std::vector<PairCondition> pair_conditions(const CoupledAxes& axes, const Eigen::VectorXd& box_m, double force_N,
                                           Eigen::Index kicked, Eigen::Index held);

// The condition of the least margin over all pairs of one kicked axis; of a machine of one axis a condition that holds.
PairCondition tightest(const CoupledAxes& axes, const Eigen::VectorXd& box_m, double force_N, Eigen::Index kicked);

// The largest force at or below `most_N` with which no other axis moves; 0 where not even least_N does.
double largest_kick_N(const CoupledAxes& axes, const Eigen::VectorXd& box_m, double least_N, double most_N,
                      Eigen::Index kicked);

// Both axes are kicked at once, each with the hold-off force for the other: what the other's kick asks of the friction
// that is to stop this one, beside its brake. Sequential kicks do not need it.
PairCondition simultaneous_condition(const CoupledAxes& axes, const Eigen::VectorXd& box_m,
                                     const Eigen::VectorXd& force_N, Eigen::Index disturbed, Eigen::Index other);

}  // namespace breakaway::stability
