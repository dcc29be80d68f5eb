#include "breakaway/stability/equilibrium_set.hpp"

#include <algorithm>
#include <cmath>

#include "breakaway/stability/dense.hpp"
#include "infinite.hpp"
#include "zonotope.hpp"
#include "zonotope_vertices.hpp"

namespace breakaway::stability {
namespace {

constexpr double most_vertex_candidates = 4e6;

// Units in which each coordinate has a spring, or else a mass, of about the same size, so that no unit of a coordinate
// decides which directions are one and what is zero. They are powers of two, which change no digit.
Eigen::VectorXd units(const LinearMachine<>& system) {
  const Eigen::Index n = system.stiffness.rows();
  const bool springs = (system.stiffness.diagonal().array() > 0).all();
  const bool masses = system.mass.rows() == n && (system.mass.diagonal().array() > 0).all();
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(n);
  if (!springs && !masses) return unit;
  const Eigen::VectorXd size = springs ? system.stiffness.diagonal() : system.mass.diagonal();
  for (Eigen::Index i = 0; i < n; ++i) {
    const int exponent = std::ilogb(size[i]) - std::ilogb(size[0]);
    unit[i] = std::ldexp(1.0, -(exponent - (exponent & 1)) / 2);
  }
  return unit;
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

EquilibriumSet EquilibriumSet::make(const LinearMachine<>& system) {
  require_valid_statics(system);
  EquilibriumSet set;
  set.unit_ = units(system);
  set.stiffness_ = set.unit_.asDiagonal() * (system.stiffness * set.unit_.asDiagonal());
  set.pushes_ = set.unit_.asDiagonal() * (system.directions * system.friction_N.asDiagonal());
  const SpannedSpace space = spanned_space(set.pushes_);
  if (facet_candidates(space) > most_facet_candidates) {
    throw InputError{"the equilibrium set of " + std::to_string(set.pushes_.cols()) + " frictions in " +
                     std::to_string(set.pushes_.rows()) + " coordinates has too many facets; merge frictions"};
  }
  std::vector<Eigen::VectorXd> normals;
  facet_directions(space, [&](const Eigen::VectorXd& u) { normals.push_back(u); });
  set.facets_.resize(static_cast<Eigen::Index>(normals.size()), set.pushes_.rows());
  set.bounds_.resize(set.facets_.rows());
  for (Eigen::Index i = 0; i < set.facets_.rows(); ++i) {
    const Eigen::VectorXd& u = normals[static_cast<std::size_t>(i)];
    set.facets_.row(i) = u.transpose() * set.stiffness_;
    set.bounds_[i] = (u.transpose() * set.pushes_).cwiseAbs().sum();
  }
  set.unheld_ = space.complement.transpose() * set.stiffness_;
  set.unheld_row_ = set.unheld_.rowwise().norm();
  const Eigen::MatrixXd slack = dense::span(set.stiffness_.transpose()).complement;
  if (slack.cols() == 0) {
    set.reach_ = set.unit_.asDiagonal() * (dense::inverse(set.stiffness_) * set.pushes_);
    set.extent_ = set.reach_.cwiseAbs().rowwise().sum();
  } else {
    set.slack_ = set.unit_.cwiseProduct(slack.col(0)).stableNormalized();
    set.extent_ = Eigen::VectorXd::Constant(set.pushes_.rows(), infinite);
  }
  return set;
}

InputError EquilibriumSet::unbounded() const {
  std::string along;
  for (const double entry : slack_) along += (along.empty() ? "" : ", ") + to_text(entry);
  throw InputError{"stiffness is singular: the equilibrium set is unbounded along (" + along +
                   "); give that motion a spring, or ask for a cross-section"};
}

double EquilibriumSet::gauge(const Eigen::VectorXd& q, double tolerance) const {
  const Eigen::VectorXd y = q.cwiseQuotient(unit_);
  if (((unheld_ * y).cwiseAbs().array() > tolerance * y.norm() * unheld_row_.array()).any()) return infinite;
  double share = 0;
  for (Eigen::Index i = 0; i < facets_.rows(); ++i)
    share = std::max(share, std::abs(facets_.row(i).dot(y)) / bounds_[i]);
  return share;
}

Eigen::MatrixXd EquilibriumSet::vertices() const {
  if (slack_.size() > 0) throw unbounded();
  const Eigen::Index n = stiffness_.rows();
  if (vertex_candidates(pushes_) > most_vertex_candidates) {
    throw InputError{"the equilibrium set of " + std::to_string(pushes_.cols()) + " frictions in " + std::to_string(n) +
                     " coordinates has too many corners; merge frictions"};
  }
  std::vector<Eigen::VectorXd> corners;
  if (n == 2) {
    for (const Eigen::Vector2d& corner : zonogon(unit_.cwiseInverse().asDiagonal() * reach_))
      corners.push_back(unit_.cwiseProduct(corner));
  } else {
    for (const Signs& signs : vertex_signs(pushes_)) {
      corners.push_back(reach_ * Eigen::Map<const Eigen::Matrix<std::int8_t, Eigen::Dynamic, 1>>(
                                     signs.data(), static_cast<Eigen::Index>(signs.size()))
                                     .cast<double>());
    }
  }
  Eigen::MatrixXd columns(n, static_cast<Eigen::Index>(corners.size()));
  for (Eigen::Index i = 0; i < columns.cols(); ++i) columns.col(i) = corners[static_cast<std::size_t>(i)];
  return columns;
}

double EquilibriumSet::support(const Eigen::VectorXd& u) const {
  if (slack_.size() == 0) return (u.transpose() * reach_).cwiseAbs().sum();
  const Eigen::VectorXd along = unit_.cwiseProduct(u), force = dense::solution(stiffness_.transpose(), along);
  if (!(stiffness_.transpose() * force).isApprox(along, 1e-12)) return infinite;
  return (force.transpose() * pushes_).cwiseAbs().sum();
}

Polygon EquilibriumSet::projection(const Eigen::Matrix2Xd& onto) const {
  if (slack_.size() > 0) throw unbounded();
  return zonogon(onto * reach_);
}

bool EquilibriumSet::contains(const Eigen::VectorXd& q, double tolerance) const {
  const Eigen::VectorXd y = q.cwiseQuotient(unit_);
  const auto held = ((facets_ * y).cwiseAbs().array() <= bounds_.array() * (1 + tolerance)).all();
  return held && ((unheld_ * y).cwiseAbs().array() <= tolerance * y.norm() * unheld_row_.array()).all();
}

Polygon EquilibriumSet::cross_section(const Eigen::MatrixX2d& plane, double half_width) const {
  const Eigen::MatrixX2d scaled = unit_.cwiseInverse().asDiagonal() * plane;
  Polygon polygon = square(half_width);
  const auto keep_strip = [&](const Eigen::Vector2d& normal, double bound) {
    polygon = clipped(clipped(polygon, normal, bound), -normal, bound);
  };
  for (Eigen::Index i = 0; i < facets_.rows(); ++i) keep_strip((facets_.row(i) * scaled).transpose(), bounds_[i]);
  for (Eigen::Index i = 0; i < unheld_.rows(); ++i) {
    const Eigen::Vector2d normal = (unheld_.row(i) * scaled).transpose();
    if (normal.norm() > 1e-12 * unheld_row_[i] * scaled.norm()) keep_strip(normal, 0);
  }
  return polygon;
}

}  // namespace breakaway::stability
