#include "stick_mode.hpp"

#include <utility>

namespace breakaway::campaign {
namespace {

std::vector<std::size_t> zeros(const std::vector<int>& signs) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    if (signs[i] == 0) result.push_back(i);
  }
  return result;
}

template <class Real>
Split<Real> split(const NormalMachine<Real>& machine, const std::vector<std::size_t>& sticking) {
  std::vector<Vector<Real>> columns;
  for (const std::size_t i : sticking) columns.push_back(machine.pushes[i]);
  return split_space(columns, machine.stiffness.rows());
}

template <class Real>
Real natural_rate(const Matrix<Real>& stiffness, const Matrix<Real>& damping) {
  const Real rate = square_root(stiffness.peak());
  if (rate > 0) return rate;
  return damping.peak() > 0 ? damping.peak() : Real(1);
}

template <class Real>
Matrix<Real> generator(const Matrix<Real>& stiffness, const Matrix<Real>& damping, Real omega) {
  const std::size_t n = stiffness.rows();
  Matrix<Real> a(2 * n, 2 * n);
  for (std::size_t i = 0; i < n; ++i) {
    a(i, n + i) = omega;
    for (std::size_t j = 0; j < n; ++j) {
      a(n + i, j) = -stiffness(i, j) / omega;
      a(n + i, n + j) = -damping(i, j);
    }
  }
  return a;
}

}  // namespace

template <class Real>
StickMode<Real>::StickMode(const NormalMachine<Real>& machine, const std::vector<int>& signs)
    : sticking{zeros(signs)},
      free{split(machine, sticking).complement},
      held{split(machine, sticking).range},
      omega{natural_rate(free.transposed() * machine.stiffness * free, free.transposed() * machine.damping * free)},
      flow{generator(free.transposed() * machine.stiffness * free, free.transposed() * machine.damping * free, omega)},
      load_by_integral(held.columns(), 2 * free.columns()) {
  const Matrix<Real> across = held.transposed();
  const Matrix<Real> by_position = across * machine.stiffness * free, by_velocity = across * machine.damping * free;
  for (std::size_t i = 0; i < across.rows(); ++i) {
    for (std::size_t j = 0; j < free.columns(); ++j) {
      load_by_integral(i, j) = by_position(i, j) / omega;
      load_by_integral(i, free.columns() + j) = by_velocity(i, j);
    }
  }
  for (const std::size_t i : sticking) held_columns.push_back(across * machine.pushes[i]);
}

template struct StickMode<Fast>;
template struct StickMode<Quad>;

}  // namespace breakaway::campaign
