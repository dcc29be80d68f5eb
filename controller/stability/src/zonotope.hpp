// The zonotope { sum_j s_j g_j : |s_j| <= 1 } of generators g_j, inside the space that they span.
//
// Its support function is h(u) = sum_j |u . g_j|, and each facet is orthogonal to a u that is orthogonal to r - 1
// independent generators, r being their rank. The same u are the corners of { u : h(u) <= 1 }, over which a convex
// function is greatest at a corner: both the equilibrium set (4) and the linear program (9) of [A] are this list.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <cmath>
#include <functional>
#include <vector>

namespace breakaway::stability {

struct SpannedSpace {
  Eigen::MatrixXd basis;       // n x r, orthonormal
  Eigen::MatrixXd complement;  // n x (n - r), orthonormal
  Eigen::MatrixXd generators;  // r x k: those that are not zero, of unit length, in the coordinates of `basis`
};

inline SpannedSpace spanned_space(const Eigen::MatrixXd& generators) {
  constexpr double negligible = 1e-12;  // of the unit length: directions closer than this are one direction
  const Eigen::Index n = generators.rows();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index j = 0; j < generators.cols(); ++j) {
    if (generators.col(j).stableNorm() > 0) kept.push_back(j);
  }
  Eigen::MatrixXd unit(n, static_cast<Eigen::Index>(kept.size()));
  for (Eigen::Index j = 0; j < unit.cols(); ++j) {
    unit.col(j) = generators.col(kept[static_cast<std::size_t>(j)]).stableNormalized();
  }
  if (unit.cols() == 0) return {Eigen::MatrixXd(n, 0), Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd(0, 0)};
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(negligible);
  qr.compute(unit);
  const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(n, n);
  const Eigen::Index rank = qr.rank();
  return {q.leftCols(rank), q.rightCols(n - rank), q.leftCols(rank).transpose() * unit};
}

// How many subsets facet_directions would look at, C(k, r - 1).
inline double facet_candidates(const SpannedSpace& space) {
  const double k = static_cast<double>(space.generators.cols()), chosen = static_cast<double>(space.basis.cols() - 1);
  if (chosen < 0) return 0;
  return std::round(std::exp(std::lgamma(k + 1) - std::lgamma(chosen + 1) - std::lgamma(k - chosen + 1)));
}

// Calls `visit` with a unit vector of R^n, in the spanned space, for every facet (one of each opposite pair, some of
// them more than once).
inline void facet_directions(const SpannedSpace& space, const std::function<void(const Eigen::VectorXd&)>& visit) {
  const Eigen::Index rank = space.basis.cols(), count = space.generators.cols();
  if (rank == 0) return;
  Eigen::MatrixXd chosen(rank, rank - 1);
  const std::function<void(Eigen::Index, Eigen::Index)> choose = [&](Eigen::Index first, Eigen::Index filled) {
    if (filled == rank - 1) {
      if (filled == 0) return visit(space.basis.col(0));
      const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(chosen);
      if (qr.rank() < rank - 1) return;
      return visit(space.basis * (qr.householderQ() * Eigen::VectorXd::Unit(rank, rank - 1)));
    }
    for (Eigen::Index j = first; j <= count - (rank - 1 - filled); ++j) {
      chosen.col(filled) = space.generators.col(j);
      choose(j + 1, filled + 1);
    }
  };
  choose(0, 0);
}

// The corners v of { v in the spanned space : h(v) <= 1 }, one of each opposite pair: n x how many. `pushes` are the
// generators as they were given to spanned_space().
inline Eigen::MatrixXd unit_corners(const SpannedSpace& space, const Eigen::MatrixXd& pushes) {
  std::vector<Eigen::VectorXd> found;
  facet_directions(space,
                   [&](const Eigen::VectorXd& u) { found.push_back(u / (u.transpose() * pushes).cwiseAbs().sum()); });
  Eigen::MatrixXd corners(pushes.rows(), static_cast<Eigen::Index>(found.size()));
  for (Eigen::Index j = 0; j < corners.cols(); ++j) corners.col(j) = found[static_cast<std::size_t>(j)];
  return corners;
}

constexpr double most_facet_candidates = 1e6;  // about a second

}  // namespace breakaway::stability
