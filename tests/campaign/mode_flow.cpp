#include "mode_flow.hpp"

#include <cmath>
#include <utility>

namespace breakaway::campaign {

template <class Real>
ModeFlow<Real>::ModeFlow(Matrix<Real> generator) : generator_{std::move(generator)} {
  const Real size = generator_.row_norm();
  shortest_s_ = size > 0 ? 1 / (256 * size) : Real(1e30);
}

template <class Real>
Real ModeFlow<Real>::step_s(int level) const {
  return shortest_s_ * std::ldexp(1.0, level);
}

template <class Real>
typename ModeFlow<Real>::Propagator ModeFlow<Real>::shortest() const {
  const std::size_t n = generator_.rows();
  Matrix<Real> power = Matrix<Real>::identity(n), change(n, n), integral(n, n);
  Real factor = 1;
  for (std::size_t k = 0; k < Rounding<Real>::terms; ++k) {
    factor *= shortest_s_ / static_cast<double>(k + 1);
    const Matrix<Real> higher = generator_ * power;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        integral(i, j) += factor * power(i, j);
        change(i, j) += factor * higher(i, j);
      }
    }
    power = higher;
  }
  return {std::move(change), std::move(integral)};
}

// (1 + c)^2 - 1 = c c + 2 c, and the integral over both halves is that of the first times 2 + c.
template <class Real>
typename ModeFlow<Real>::Propagator ModeFlow<Real>::doubled(const Propagator& half) {
  Propagator whole{half.change * half.change, half.integral * half.change};
  const std::size_t n = half.change.rows();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      whole.change(i, j) += 2 * half.change(i, j);
      whole.integral(i, j) += 2 * half.integral(i, j);
    }
  }
  return whole;
}

template <class Real>
const typename ModeFlow<Real>::Propagator& ModeFlow<Real>::propagator(int level) {
  const std::size_t n = generator_.rows();
  const double cube = static_cast<double>(n * n * n);
  if (ladder_.empty()) {
    ladder_.push_back(shortest());
    work_ += cube * static_cast<double>(Rounding<Real>::terms);
  }
  while (static_cast<int>(ladder_.size()) <= level) {
    ladder_.push_back(doubled(ladder_.back()));
    work_ += 2 * cube;
  }
  return ladder_[static_cast<std::size_t>(level)];
}

template <class Real>
typename ModeFlow<Real>::Step ModeFlow<Real>::propagate(int level, const Vector<Real>& e) {
  const Propagator& by = propagator(level);
  work_ += 2 * static_cast<double>(e.size() * e.size());
  Vector<Real> end = by.change * e;
  add_scaled(end, 1, e);
  return {std::move(end), by.integral * e};
}

template <class Real>
std::vector<Vector<Real>> ModeFlow<Real>::series(const Vector<Real>& e) const {
  std::vector<Vector<Real>> coefficients{e};
  for (std::size_t k = 1; k <= Rounding<Real>::terms; ++k) {
    Vector<Real> next = generator_ * coefficients.back();
    for (Real& x : next) x /= static_cast<double>(k);
    coefficients.push_back(std::move(next));
  }
  return coefficients;
}

template class ModeFlow<Fast>;
template class ModeFlow<Quad>;

}  // namespace breakaway::campaign
