#include "mode_flow.hpp"

#include <utility>

namespace breakaway::campaign {
namespace {

constexpr std::size_t terms = 15;  // (1/256)^15 / 15! is 1e-48

}  // namespace

ModeFlow::ModeFlow(Matrix generator) : generator_{std::move(generator)} {
  const Real size = generator_.row_norm();
  shortest_s_ = size > 0 ? 1 / (256 * size) : Real(1e30);
}

Real ModeFlow::step_s(int level) const {
  Real step = shortest_s_;
  for (int i = 0; i < level; ++i) step *= 2;
  return step;
}

const ModeFlow::Propagator& ModeFlow::propagator(int level) {
  const std::size_t n = generator_.rows();
  const double cube = static_cast<double>(n * n * n);
  if (ladder_.empty()) {
    Matrix power = Matrix::identity(n), end = power, integral(n, n);
    Real factor = 1;
    for (std::size_t k = 0; k < terms; ++k) {
      const Real next = factor * shortest_s_ / static_cast<double>(k + 1);
      const Matrix higher = generator_ * power;
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
          integral(i, j) += next * power(i, j);
          end(i, j) += next * higher(i, j);
        }
      }
      power = higher;
      factor = next;
    }
    work_ += cube * static_cast<double>(terms);
    ladder_.push_back({end, integral});
  }
  while (static_cast<int>(ladder_.size()) <= level) {
    const Propagator& last = ladder_.back();
    Matrix integral = last.integral * last.end;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) integral(i, j) += last.integral(i, j);
    }
    ladder_.push_back({last.end * last.end, integral});
    work_ += 2 * cube;
  }
  return ladder_[static_cast<std::size_t>(level)];
}

ModeFlow::Step ModeFlow::propagate(int level, const Vector& e) {
  const Propagator& by = propagator(level);
  work_ += 2 * static_cast<double>(e.size() * e.size());
  return {by.end * e, by.integral * e};
}

std::vector<Vector> ModeFlow::series(const Vector& e) const {
  std::vector<Vector> coefficients{e};
  for (std::size_t k = 1; k <= terms; ++k) {
    Vector next = generator_ * coefficients.back();
    for (Real& x : next) x /= static_cast<double>(k);
    coefficients.push_back(std::move(next));
  }
  return coefficients;
}

}  // namespace breakaway::campaign
