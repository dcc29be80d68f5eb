// Sums of segments: their outlines in the plane, and the directions of their facets.
#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace zonotope_test
