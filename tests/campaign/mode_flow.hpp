// The motion while a set of directions sticks: e' = A e, and its integral, by scaling and squaring of the Taylor
// series. Steps are the shortest one, 1/256 of 1/|A|, times powers of two. What is squared is exp(A h) - 1, which keeps
// the digits of what moves slowly beside what is fast.
#pragma once

#include <vector>

#include "dense_algebra.hpp"

namespace breakaway::campaign {

template <class Real>
class ModeFlow {
 public:
  explicit ModeFlow(Matrix<Real> generator);

  const Matrix<Real>& generator() const { return generator_; }
  Real shortest_s() const { return shortest_s_; }
  Real step_s(int level) const;

  // e(h) and the integral of e over h = step_s(level).
  struct Step {
    Vector<Real> end, integral;
  };
  Step propagate(int level, const Vector<Real>& e);

  // The coefficients of the Taylor series of e, as many as the shortest step needs.
  std::vector<Vector<Real>> series(const Vector<Real>& e) const;

  // The multiplications that have been spent.
  double work() const { return work_; }

 private:
  struct Propagator {
    Matrix<Real> change, integral;
  };
  const Propagator& propagator(int level);
  Propagator shortest() const;
  static Propagator doubled(const Propagator& half);

  Matrix<Real> generator_;
  Real shortest_s_;
  std::vector<Propagator> ladder_;
  double work_ = 0;
};

}  // namespace breakaway::campaign
