// The motion while a set of directions sticks: e' = A e, and its integral, by scaling and squaring of the Taylor series
// in numbers of 113 bits. Steps are the shortest one, 1/256 of 1/|A|, times powers of two.
#pragma once

#include <vector>

#include "quad_algebra.hpp"

namespace breakaway::campaign {

class ModeFlow {
 public:
  explicit ModeFlow(Matrix generator);

  const Matrix& generator() const { return generator_; }
  Real shortest_s() const { return shortest_s_; }
  Real step_s(int level) const;

  // e(h) and the integral of e over h = step_s(level).
  struct Step {
    Vector end, integral;
  };
  Step propagate(int level, const Vector& e);

  // The coefficients of the Taylor series of e, as many as the shortest step needs.
  std::vector<Vector> series(const Vector& e) const;

  // The multiplications that have been spent.
  double work() const { return work_; }

 private:
  struct Propagator {
    Matrix end, integral;
  };
  const Propagator& propagator(int level);

  Matrix generator_;
  Real shortest_s_;
  std::vector<Propagator> ladder_;
  double work_ = 0;
};

}  // namespace breakaway::campaign
