// The equilibrium set (4) of [A], as the polytope that it is: all q at which static friction can hold the springs,
//   E = { q : K q = W lambda for some |lambda_i| <= p_i },  at q' = 0.
// (26) of [A] is its bounding box only.
//
// [A] = van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction".
#pragma once

#include <Eigen/Core>
#include <vector>

#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {

using Polygon = std::vector<Eigen::Vector2d>;  // corners, counter-clockwise; two are a segment, one is a point

// Signed: positive for a counter-clockwise polygon.
double area(const Polygon& polygon);

// The part of a convex polygon where normal . y <= bound.
Polygon clipped(const Polygon& polygon, const Eigen::Vector2d& normal, double bound);

// [-half_width, half_width]^2.
Polygon square(double half_width);

class EquilibriumSet {
 public:
  // Refuses K, W and p that require_valid_statics() refuses, and systems whose polytope has more than about a million
  // candidates for facets.
  static EquilibriumSet make(const LinearMachine<>& system);

  // Is q an equilibrium? `tolerance` is relative to the friction forces and to the spring forces at q.
  bool contains(const Eigen::VectorXd& q, double tolerance = 1e-12) const;

  // The largest |q_i| in E, i = 1..n: what (26) states for the two-mass example. Infinite when K is singular.
  const Eigen::VectorXd& extent() const { return extent_; }

  // The share of the friction forces that q needs: the least t with q in t E, 0 at q = 0 and 1 on the rim. Infinite
  // when no friction acts against the spring forces; `tolerance` is relative to them.
  double gauge(const Eigen::VectorXd& q, double tolerance = 1e-9) const;

  // The corners of E, n x how many; in the plane, n = 2, counter-clockwise. Refuses a singular K, with which E is
  // unbounded, and more than a million candidates for corners.
  Eigen::MatrixXd vertices() const;

  // The support function: the largest u . q in E. Infinite where E is unbounded. With a singular K and u in its range,
  // an upper bound of it.
  double support(const Eigen::VectorXd& u) const;

  // The shadow of E: all onto * q with q in E, `onto` 2 x n. Refuses a singular K.
  Polygon projection(const Eigen::Matrix2Xd& onto) const;

  // E in the plane q = plane * y through the origin, `plane` n x 2, inside |y_1|, |y_2| <= half_width > 0.
  Polygon cross_section(const Eigen::MatrixX2d& plane, double half_width) const;

 private:
  EquilibriumSet() = default;

  InputError unbounded() const;

  Eigen::VectorXd unit_;        // q = unit_ y, entry by entry
  Eigen::MatrixXd facets_;      // E is |facets_ y| <= bounds_, row by row ...
  Eigen::VectorXd bounds_;      // N
  Eigen::MatrixXd unheld_;      // ... and unheld_ y = 0: spring forces that no friction acts against
  Eigen::VectorXd unheld_row_;  // norms of the rows of unheld_
  Eigen::VectorXd extent_;
  Eigen::MatrixXd stiffness_;  // of y
  Eigen::MatrixXd pushes_;     // W diag(p) of y: y is in E where it is stiffness_^-1 pushes_ s with |s_i| <= 1
  Eigen::MatrixXd reach_;      // K^-1 W diag(p); empty when K is singular
  Eigen::VectorXd slack_;      // a direction without spring force, when K is singular
};

}  // namespace breakaway::stability
