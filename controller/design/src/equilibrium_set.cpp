#include "breakaway/design/equilibrium_set.hpp"

#include <Eigen/LU>
#include <limits>

#include "zonotope.hpp"

namespace breakaway::design {
namespace {

Eigen::VectorXd extent_of(const LinearSystem& system, const Eigen::MatrixXd& pushes) {
  const Eigen::FullPivLU<Eigen::MatrixXd> stiffness(system.stiffness);
  if (!stiffness.isInvertible())
    return Eigen::VectorXd::Constant(system.stiffness.rows(), std::numeric_limits<double>::infinity());
  return stiffness.solve(pushes).cwiseAbs().rowwise().sum();
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

double area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  return twice / 2;
}

Polygon square(double half_width) {
  return {{-half_width, -half_width}, {half_width, -half_width}, {half_width, half_width}, {-half_width, half_width}};
}

Polygon clipped(const Polygon& polygon, const Eigen::Vector2d& normal, double bound) {
  Polygon inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double excess_from = normal.dot(from) - bound, excess_to = normal.dot(to) - bound;
    if (excess_from <= 0) inside.push_back(from);
    if ((excess_from < 0 && excess_to > 0) || (excess_from > 0 && excess_to < 0)) {
      inside.push_back(from + (to - from) * (excess_from / (excess_from - excess_to)));
    }
  }
  return inside;
}

Expected<EquilibriumSet> EquilibriumSet::make(const LinearSystem& system) {
  const Eigen::MatrixXd pushes = system.directions * system.friction_N.asDiagonal();
  const SpannedSpace space = spanned_space(pushes);
  if (facet_candidates(space) > most_facet_candidates) {
    return Error{"the equilibrium set of " + std::to_string(pushes.cols()) + " frictions in " +
                 std::to_string(pushes.rows()) + " coordinates has too many facets; merge frictions"};
  }
  std::vector<Eigen::VectorXd> normals;
  facet_directions(space, [&](const Eigen::VectorXd& u) { normals.push_back(u); });
  EquilibriumSet set;
  set.facets_.resize(static_cast<Eigen::Index>(normals.size()), pushes.rows());
  set.bounds_.resize(set.facets_.rows());
  for (Eigen::Index i = 0; i < set.facets_.rows(); ++i) {
    const Eigen::VectorXd& u = normals[static_cast<std::size_t>(i)];
    set.facets_.row(i) = u.transpose() * system.stiffness;
    set.bounds_[i] = (u.transpose() * pushes).cwiseAbs().sum();
  }
  set.unheld_ = space.complement.transpose() * system.stiffness;
  set.unheld_row_ = set.unheld_.rowwise().norm();
  set.extent_ = extent_of(system, pushes);
  return set;
}

bool EquilibriumSet::contains(const Eigen::VectorXd& q, double tolerance) const {
  const auto held = ((facets_ * q).cwiseAbs().array() <= bounds_.array() * (1 + tolerance)).all();
  return held && ((unheld_ * q).cwiseAbs().array() <= tolerance * q.norm() * unheld_row_.array()).all();
}

Polygon EquilibriumSet::cross_section(const Eigen::MatrixX2d& plane, double half_width) const {
  Polygon polygon = square(half_width);
  const auto keep_strip = [&](const Eigen::Vector2d& normal, double bound) {
    polygon = clipped(clipped(polygon, normal, bound), -normal, bound);
  };
  for (Eigen::Index i = 0; i < facets_.rows(); ++i) keep_strip((facets_.row(i) * plane).transpose(), bounds_[i]);
  for (Eigen::Index i = 0; i < unheld_.rows(); ++i) {
    const Eigen::Vector2d normal = (unheld_.row(i) * plane).transpose();
    if (normal.norm() > 1e-12 * unheld_row_[i]) keep_strip(normal, 0);
  }
  return polygon;
}

}  // namespace breakaway::design
