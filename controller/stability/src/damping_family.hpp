// The damping matrices that feedback of velocity can give a machine so that condition 2 of Theorem 1 holds.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "actuation.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/lmi.hpp"
#include "breakaway/stability/pd_design.hpp"

namespace breakaway::stability {

struct Split {
  Eigen::MatrixXd subspace, complement;  // orthonormal, together a basis
};

// The symmetric C_cl that feedback can reach and that leave a subspace of span W invariant; positive definite on its
// complement and above a limit -g on the subspace itself. Then every eigencolumn with a non-positive eigenvalue lies in
// the subspace. They are base + sum_k z_k terms_k, in units in which C and S are of the size 1.
// The system is in mass units; it and the actuation must outlive the family.
class DampingFamily {
 public:
  DampingFamily(const ActuatedSystem& system, const Actuation& actuation, Split split, double unit_per_s);

  // Says whether the subspace can be made invariant.
  bool exists() const { return exists_; }

  // The lowest g >= 0 that some gain reaches, in the unit, without more gain than it takes.
  double least_limit() const;

  // Returns the F2 of least norm for the limit -g.
  Eigen::MatrixXd least_gain(double limit) const;

 private:
  Eigen::Index count() const { return static_cast<Eigen::Index>(terms_.size()); }
  void keep_invariant();
  Eigen::MatrixXd combined(const Eigen::VectorXd& weights) const;
  MatrixInequality above(const Eigen::MatrixXd& basis, double least) const;
  LmiProblem program() const;

  const Actuation& actuation_;
  Split split_;
  double unit_, actuator_unit_;
  Eigen::MatrixXd open_, inverse_, base_;
  std::vector<Eigen::MatrixXd> terms_;
  bool exists_ = true;
};

}  // namespace breakaway::stability
