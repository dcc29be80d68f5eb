// ModeChoice: what sticks and what slides after a stop, where double precision does not tell.
//
// Friction forces that differ by many orders of magnitude, masses that do, and directions that are nearly dependent
// make differences of large numbers of what decides. The accelerations and their couplings are then computed in
// extended precision from the machine as it was given. If that does not tell either, the machine is refused by name:
// no answer is better than a wrong one.
#pragma once

#include <vector>

#include "breakaway/hybrid/flow.hpp"
#include "breakaway/hybrid/stop_problem.hpp"
#include "breakaway/hybrid/types.hpp"

namespace breakaway::hybrid {

class ModeChoice {
 public:
  // `machine` passes require_valid(). Nothing may be asked about columns of directions that are zero.
  explicit ModeChoice(const LinearMachine<>& machine);

  // W^T M^-1 and W^T M^-1 W, rounded: accelerations of directions by forces, and by forces in directions.
  const Eigen::MatrixXd& response() const { return rounded_response_; }
  const Eigen::MatrixXd& coupling() const { return rounded_coupling_; }

  // Returns the sum of all forces, of which `applied` are those of no spring and no damper.
  ExtendedVector balance(const ExtendedVector& applied, const ExtendedVector& q, const ExtendedVector& v) const {
    return applied - stiffness_ * q - damping_ * v;
  }

  // The state at a stop, with the forces of all but springs, dampers and stopped directions.
  struct Stop {
    double time_s;
    ExtendedVector q, v;
    ExtendedVector applied;                 // n
    Eigen::VectorXd rounding;               // n: of the sum of all forces, >= 0,
    Eigen::VectorXd applied_rounding;       // and of the applied forces alone
    std::vector<Eigen::Index> stopped;      // directions
    DirectionVector forward_N, backward_N;  // by stopped direction: > 0
  };

  // Bits and indices are places in stop.stopped. Throws Refused.
  Sliding sliding(const Stop& stop) const;
  [[noreturn]] static void refuse(double time_s);

 private:
  ExtendedMatrix damping_, stiffness_;
  ExtendedMatrix response_, coupling_;
  Eigen::MatrixXd rounded_response_, rounded_coupling_;
};

}  // namespace breakaway::hybrid
