#include "holding_forces.hpp"

#include <algorithm>
#include <utility>

namespace breakaway::campaign {

template <class Real>
HoldingForces<Real>::HoldingForces(std::vector<Vector<Real>> columns, std::size_t rank)
    : columns_{std::move(columns)}, rank_{rank}, signs_(columns_.size()) {
  // The largest of what is left of each column, until rank - 1 are found.
  std::vector<Vector<Real>> chosen;
  while (inside_.size() + 1 < rank_) {
    Real most = 0;
    std::size_t best = 0;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (std::find(inside_.begin(), inside_.end(), i) != inside_.end()) continue;
      const Matrix<Real> free = split_space(chosen, rank_).complement;
      const Real size = norm(free.transposed() * columns_[i]) / norm(columns_[i]);
      if (size <= most) continue;
      most = size;
      best = i;
    }
    inside_.push_back(best);
    chosen.push_back(columns_[best]);
  }
}

template <class Real>
std::optional<Vector<Real>> HoldingForces<Real>::normal(const std::vector<std::size_t>& inside) const {
  std::vector<Vector<Real>> chosen;
  chosen.reserve(inside.size());
  for (const std::size_t i : inside) chosen.push_back(columns_[i]);
  const Matrix<Real> complement = split_space(chosen, rank_).complement;
  if (complement.columns() != rank_ - inside.size()) return std::nullopt;
  return complement.column(0);
}

template <class Real>
void HoldingForces<Real>::orient(const Vector<Real>& load) {
  if (dot(normal_, load) < 0) normal_ = -normal_;
  for (std::size_t i = 0; i < columns_.size(); ++i) signs_[i] = dot(normal_, columns_[i]) < 0 ? -1 : 1;
  for (const std::size_t i : inside_) signs_[i] = 0;
}

template <class Real>
bool HoldingForces<Real>::refresh() {
  Vector<Real> together(rank_);
  for (std::size_t i = 0; i < columns_.size(); ++i) add_scaled(together, signs_[i], columns_[i]);
  std::vector<Vector<Real>> system{together};
  for (const std::size_t i : inside_) system.push_back(columns_[i]);
  const Matrix<Real> square = from_columns(system, rank_);
  forces_ = Matrix<Real>(rank_, rank_);
  for (std::size_t j = 0; j < rank_; ++j) {
    Vector<Real> unit(rank_);
    unit[j] = 1;
    const Vector<Real> column = solve(square, unit);
    if (column.empty()) return false;
    for (std::size_t i = 0; i < rank_; ++i) forces_(i, j) = column[i];
  }
  return true;
}

template <class Real>
bool HoldingForces<Real>::optimise(const Vector<Real>& load) {
  const auto first = normal(inside_);
  if (!first) return false;
  normal_ = *first;
  orient(load);
  for (int pivots = 0; pivots < 200; ++pivots) {
    if (!refresh()) return false;
    const Vector<Real> forces = forces_ * load;
    if (forces.empty()) return false;
    Real worst = forces[0] * (1 + Real(Rounding<Real>::noise / 10));
    std::size_t leaving = 0;
    for (std::size_t i = 1; i < forces.size(); ++i) {
      if (magnitude(forces[i]) <= worst) continue;
      worst = magnitude(forces[i]);
      leaving = i;
    }
    if (leaving == 0) return true;
    if (!exchange(leaving - 1, forces[leaving] > 0 ? 1 : -1)) return false;
  }
  return false;
}

// The face turns about the columns that stay inside, until the first of the others comes to lie in it.
template <class Real>
bool HoldingForces<Real>::exchange(std::size_t leaving, int sign) {
  const std::size_t out = inside_[leaving];
  std::vector<std::size_t> staying = inside_;
  staying.erase(staying.begin() + static_cast<std::ptrdiff_t>(leaving));
  std::vector<Vector<Real>> kept{normal_};
  for (const std::size_t i : staying) kept.push_back(columns_[i]);
  const Matrix<Real> rest = split_space(kept, rank_).complement;
  if (rest.columns() != 1) return false;
  Vector<Real> turn = rest.column(0);
  if (dot(turn, columns_[out]) * sign < 0) turn = -turn;
  Real most = 0;
  std::ptrdiff_t enters = -1;
  for (std::size_t j = 0; j < columns_.size(); ++j) {
    if (signs_[j] == 0) continue;
    const Real before = larger(Real(1e-60), signs_[j] * dot(normal_, columns_[j]));
    const Real change = signs_[j] * dot(turn, columns_[j]);
    if (enters >= 0 && -change / before <= most) continue;
    most = -change / before;
    enters = static_cast<std::ptrdiff_t>(j);
  }
  if (enters < 0) return false;
  signs_[out] = sign;
  signs_[static_cast<std::size_t>(enters)] = 0;
  staying.push_back(static_cast<std::size_t>(enters));
  inside_ = staying;
  const auto turned = normal(inside_);
  if (!turned) return false;
  normal_ = *turned;
  if (dot(normal_, columns_[out]) * sign < 0) normal_ = -normal_;
  return true;
}

template class HoldingForces<Fast>;
template class HoldingForces<Quad>;

}  // namespace breakaway::campaign
