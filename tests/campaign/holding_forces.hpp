// The static friction forces that hold a set of directions, followed as the load on them changes: a certificate that
// they can be held, in closed form while it lasts, and the exact instant at which they cannot.
#pragma once

#include <optional>
#include <vector>

#include "dense_algebra.hpp"

namespace breakaway::campaign {

// B mu = r with |mu_i| <= gauge, for the least gauge: at its optimum all but rank - 1 of the mu are at +-gauge. With
// these signs held, gauge and the other mu are linear in the load r.
template <class Real>
class HoldingForces {
 public:
  // `columns`: in coordinates of the space that they span, of this rank.
  HoldingForces(std::vector<Vector<Real>> columns, std::size_t rank);

  // Makes the choice of signs the best one for this load. False if no end was found.
  bool optimise(const Vector<Real>& load);

  // Row i times the load is one of the forces, in units of its limit: the gauge first, then the mu that are not at it.
  const Matrix<Real>& forces() const { return forces_; }

 private:
  bool refresh();
  std::optional<Vector<Real>> normal(const std::vector<std::size_t>& inside) const;
  void orient(const Vector<Real>& load);
  bool exchange(std::size_t leaving, int sign);

  std::vector<Vector<Real>> columns_;
  std::size_t rank_;
  std::vector<std::size_t> inside_;  // rank - 1 of the columns
  std::vector<int> signs_;           // of the others; 0 for those inside
  Vector<Real> normal_;              // orthogonal to the columns inside
  Matrix<Real> forces_;
};

}  // namespace breakaway::campaign
