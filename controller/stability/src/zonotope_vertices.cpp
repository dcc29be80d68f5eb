#include "zonotope_vertices.hpp"

#include <algorithm>
#include <cmath>

#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double negligible = 1e-11;  // the cosine of what counts as orthogonal

using Indices = std::vector<Index>;

void add_all_signs(const Indices& which, Signs& signs, std::set<Signs>& found) {
  for (unsigned choice = 0; choice < (1u << which.size()); ++choice) {
    for (std::size_t i = 0; i < which.size(); ++i)
      signs[static_cast<std::size_t>(which[i])] = (choice >> i) & 1u ? 1 : -1;
    found.insert(signs);
  }
}

// Fixes the signs of those among `open` that are not orthogonal to u, at least one, and returns the others.
Indices orthogonal(const MatrixXd& generators, const Indices& open, const VectorXd& u, double side, Signs& signs) {
  std::vector<double> cosine;
  double greatest = 0;
  for (const Index j : open) {
    cosine.push_back(side * u.dot(generators.col(j).stableNormalized()));
    greatest = std::max(greatest, std::abs(cosine.back()));
  }
  Indices rest;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (std::abs(cosine[i]) <= std::min(negligible, greatest / 2)) {
      rest.push_back(open[i]);
    } else {
      signs[static_cast<std::size_t>(open[i])] = cosine[i] > 0 ? 1 : -1;
    }
  }
  return rest;
}

void collect(const MatrixXd& generators, const Indices& open, Signs signs, std::set<Signs>& found) {
  const SpannedSpace space = spanned_space(generators(Eigen::all, open));
  if (space.basis.cols() == static_cast<Index>(open.size())) return add_all_signs(open, signs, found);
  facet_directions(space, [&](const VectorXd& u) {
    for (const double side : {-1.0, 1.0}) {
      Signs fixed = signs;
      const Indices rest = orthogonal(generators, open, u, side, fixed);
      collect(generators, rest, fixed, found);
    }
  });
}

}  // namespace

double vertex_candidates(const MatrixXd& generators) {
  const SpannedSpace space = spanned_space(generators);
  return facet_candidates(space) * std::exp2(static_cast<double>(space.basis.cols()));
}

std::set<Signs> vertex_signs(const MatrixXd& generators) {
  Indices open;
  for (Index j = 0; j < generators.cols(); ++j) {
    if (generators.col(j).stableNorm() > 0) open.push_back(j);
  }
  std::set<Signs> found;
  collect(generators, open, Signs(static_cast<std::size_t>(generators.cols()), 0), found);
  return found;
}

Polygon zonogon(const Eigen::Matrix2Xd& generators) {
  const double size = generators.cols() == 0 ? 0 : generators.colwise().norm().maxCoeff();
  std::vector<Eigen::Vector2d> edges;  // turned to angles in [0, pi)
  for (const Eigen::Vector2d edge : generators.colwise()) {
    if (edge.norm() <= 1e-14 * size) continue;
    edges.push_back(edge.y() > 0 || (edge.y() == 0 && edge.x() > 0) ? edge : -edge);
  }
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); };
  std::ranges::sort(edges, [&](const auto& a, const auto& b) { return cross(a, b) > 0; });
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& edge : edges) corner -= edge;
  Polygon polygon{corner};
  for (const double way : {2.0, -2.0}) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      corner += way * edges[i];
      const bool straight_on = i + 1 < edges.size() && std::abs(cross(edges[i], edges[i + 1])) <=
                                                           negligible * edges[i].norm() * edges[i + 1].norm();
      if (!straight_on) polygon.push_back(corner);
    }
  }
  if (polygon.size() > 1) polygon.pop_back();  // back at the first
  return polygon;
}

}  // namespace breakaway::stability
