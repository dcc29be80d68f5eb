#include "zonotope.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "breakaway/stability/dense.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using Visit = std::function<void(const VectorXd&)>;

// The generators that are not zero, of unit length.
MatrixXd unit_generators(const MatrixXd& generators) {
  MatrixXd unit(generators.rows(), generators.cols());
  Index kept = 0;
  for (const auto& generator : generators.colwise()) {
    if (generator.stableNorm() > 0) unit.col(kept++) = generator.stableNormalized();
  }
  return unit.leftCols(kept);
}

// Fills the columns of `chosen` from `filled` on with every choice of the generators from `first` on.
void visit_choices(const SpannedSpace& space, MatrixXd& chosen, Index first, Index filled, const Visit& visit) {
  const Index wanted = chosen.cols(), count = space.generators.cols();
  if (filled == wanted) {
    const VectorXd direction = dense::normal(chosen);
    if (direction.size() > 0) visit(space.basis * direction);
    return;
  }
  for (Index j = first; j <= count - (wanted - filled); ++j) {
    chosen.col(filled) = space.generators.col(j);
    visit_choices(space, chosen, j + 1, filled + 1, visit);
  }
}

}  // namespace

SpannedSpace spanned_space(const MatrixXd& generators) {
  const Index n = generators.rows();
  const MatrixXd unit = unit_generators(generators);
  if (unit.cols() == 0) return {MatrixXd(n, 0), MatrixXd::Identity(n, n), MatrixXd(0, 0)};
  const dense::Span span = dense::span(unit, 1e-12);
  return {span.basis, span.complement, span.basis.transpose() * unit};
}

double facet_candidates(const SpannedSpace& space) {
  const double k = static_cast<double>(space.generators.cols()), chosen = static_cast<double>(space.basis.cols() - 1);
  if (chosen < 0) return 0;
  return std::round(std::exp(std::lgamma(k + 1) - std::lgamma(chosen + 1) - std::lgamma(k - chosen + 1)));
}

void facet_directions(const SpannedSpace& space, const Visit& visit) {
  const Index rank = space.basis.cols();
  if (rank == 0) return;
  if (rank == 1) return visit(space.basis.col(0));
  MatrixXd chosen(rank, rank - 1);
  visit_choices(space, chosen, 0, 0, visit);
}

MatrixXd unit_corners(const SpannedSpace& space, const MatrixXd& pushes) {
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * static_cast<double>(pushes.rows());
  const VectorXd zero = rounding * pushes.colwise().stableNorm().transpose();
  std::vector<VectorXd> found;
  facet_directions(space, [&](const VectorXd& u) {
    // A generator that is orthogonal to u but for rounding must not count: it may be far larger than the others.
    const VectorXd along = (pushes.transpose() * u).cwiseAbs();
    const double support = (along.array() > zero.array()).select(along, 0).sum();
    if (support > 0) found.push_back(u / support);
  });
  MatrixXd corners(pushes.rows(), static_cast<Index>(found.size()));
  for (Index j = 0; j < corners.cols(); ++j) corners.col(j) = found[static_cast<std::size_t>(j)];
  return corners;
}

}  // namespace breakaway::stability
