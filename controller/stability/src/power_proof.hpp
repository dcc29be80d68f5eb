// The proof that friction takes more power than the damping gives; THEORY.md, "Friction as dampers".
//
// Where C + W Y W^T is positive definite, for any symmetric Y, -v^T C v < g^T Y g with g = W^T v, and what is left to
// bound is a product of the forces W Y g and the speed. The definiteness is proved for the stored numbers, in spite of
// all rounding; no rank, no eigenvector and no threshold enters.
#pragma once

#include <Eigen/Core>

#include "breakaway/stability/definite_proof.hpp"
#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {

class PowerProof {
 public:
  // `machine` without errors, its mass proved positive definite.
  explicit PowerProof(const LinearMachine<>& machine);

  // Says whether dampers y_i in the directions of friction make C + W diag(y) W^T positive definite. Without them no
  // level is certified, whether there are none or rounding hides them.
  bool found() const { return found_; }

  // Says whether the damping is proved to give no power at all, so that friction holds at every speed.
  bool everywhere() const { return found_ && semidefinite_ == Proof::holds; }

  // What is proved of C.
  Proof definite() const { return definite_; }
  Proof semidefinite() const { return semidefinite_; }

  // The level that the dampers prove: 1 / (2 kappa^2) with kappa the largest y_i |w_i|_{M^-1} / p_i.
  double level_J() const;

  // Returns the Y nearest to `forces` for which C + W Y W^T is proved to be definite: what is missing is taken from the
  // dampers. An empty matrix where nothing near does.
  Eigen::MatrixXd completed(const Eigen::MatrixXd& forces) const;

 private:
  bool proves(const Eigen::MatrixXd& forces) const;
  void find_dampers(double kappa);

  extended::Matrix system_, directions_;  // C and W
  Proof definite_, semidefinite_;
  Eigen::VectorXd unit_dampers_;  // p_i / |w_i|_{M^-1}: kappa = 1
  bool found_ = false;
  double kappa_ = 0;
  Eigen::VectorXd dampers_;     // kappa_ * unit_dampers_
  double mobility_margin_ = 1;  // what the norms |w_i|_{M^-1} may be too small by
};

}  // namespace breakaway::stability
