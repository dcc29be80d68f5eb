// Sums of segments: their outlines in the plane, and the directions of their facets.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "../../../controller/stability/src/zonotope.hpp"
#include "../../../controller/stability/src/zonotope_vertices.hpp"

namespace zonotope_test {
namespace {

using namespace breakaway::stability;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(Zonogon, OfNothingIsAPoint) {
  for (const Eigen::Matrix2Xd& nothing : {Eigen::Matrix2Xd(2, 0), Eigen::Matrix2Xd(Eigen::Matrix2Xd::Zero(2, 3))}) {
    const Polygon point = zonogon(nothing);
    ASSERT_EQ(point.size(), 1U);
    EXPECT_EQ(point[0], Eigen::Vector2d::Zero());
  }
}

TEST(Zonogon, OfOneDirectionIsASegmentWhateverTheSigns) {
  const Polygon segment = zonogon(Eigen::Matrix2Xd{{1, -2, 0}, {0, 0, 0}});
  ASSERT_EQ(segment.size(), 2U);
  EXPECT_EQ(segment[0], Eigen::Vector2d(-3, 0));
  EXPECT_EQ(segment[1], Eigen::Vector2d(3, 0));
}

TEST(Zonogon, HasNoCornerBetweenParallelEdges) {
  // The edges (1, 0), (-2, 0) and (0, 1), (0, -3): a rectangle of 6 x 8.
  const Polygon rectangle = zonogon(Eigen::Matrix2Xd{{1, -2, 0, 0}, {0, 0, 1, -3}});
  ASSERT_EQ(rectangle.size(), 4U);
  EXPECT_EQ(area(rectangle), 48);
}

TEST(FacetDirections, AreOnlyThoseOfIndependentGenerators) {
  // Two generators along x and one along y and z each: the pair along x spans no plane, and the others give x, y and z.
  const MatrixXd generators{{1, 2, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  int found = 0;
  facet_directions(spanned_space(generators), [&](const VectorXd& u) {
    ++found;
    EXPECT_NEAR(u.cwiseAbs().maxCoeff(), 1, 1e-15);
    EXPECT_NEAR(u.norm(), 1, 1e-15);
  });
  EXPECT_EQ(found, 5);
}

// Those of (1, 1, 1) written with more and with fewer digits: neither one direction nor, to rounding, several.
TEST(Zonotope, VerticesOfGeneratorsThatAreNearlyParallelAreFound) {
  MatrixXd generators(3, 3);
  generators << 0.57735026919, 0.5773502691896, 0.5773502691896, 0.57735026919, 0.5773502691896, 0.5773502691896,
      0.577350269195, 0.5773502691896, 0.5773502691896;
  const std::set<Signs> found = vertex_signs(generators);
  EXPECT_TRUE(found.contains(Signs{1, 1, 1}));
  EXPECT_TRUE(found.contains(Signs{-1, -1, -1}));
  std::mt19937 random{5};
  std::uniform_real_distribution<double> exponent{-14, -8}, entry{-1, 1};
  for (int trial = 0; trial < 300; ++trial) {
    MatrixXd near = MatrixXd::Constant(3, 5, 0.5);
    for (double& x : near.reshaped()) x += entry(random) * std::pow(10.0, exponent(random));
    EXPECT_GE(vertex_signs(near).size(), 2U) << trial;
  }
}

}  // namespace
}  // namespace zonotope_test
