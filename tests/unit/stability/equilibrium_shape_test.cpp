// Corners, shadows and measures of the equilibrium set, against each other and against its definition.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <tuple>

#include "../refusal.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "random_systems.hpp"
#include "two_mass_example.hpp"

namespace equilibrium_shape_test {
namespace {

using namespace breakaway::stability;
using breakaway::testing::refusal;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(EquilibriumShape, OfTheExampleHasItsFourCornersInOrder) {
  const auto corners = EquilibriumSet::make(two_mass_example()).vertices();
  ASSERT_EQ(corners.cols(), 4);
  Polygon polygon;
  for (const Eigen::Vector2d corner : corners.colwise()) {
    polygon.push_back(corner);
    // K q = (+-1, +-1): full friction on both.
    EXPECT_TRUE((two_mass_example().stiffness * corner).cwiseAbs().isOnes(1e-14)) << corner.transpose();
  }
  EXPECT_NEAR(area(polygon), 4.0 / 3, 1e-14);
}

// 2 (C(m - 1, 0) + ... + C(m - 1, n - 1)) corners of m generators in general position; they are in E and on its rim,
// and in every direction the farthest of them is as far as the support function says.
TEST(EquilibriumShape, CornersAreAllThereAndFarthest) {
  std::mt19937_64 random{23};
  for (const auto& [n, m, count] : {std::tuple<Index, Index, Index>{1, 3, 2},
                                    {2, 5, 10},
                                    {3, 2, 4},
                                    {3, 3, 8},
                                    {3, 5, 22},
                                    {4, 6, 52},
                                    {6, 6, 64}}) {
    const LinearMachine<> s = random_theorem_1_system(random, n, m);
    const auto set = EquilibriumSet::make(s);
    const auto corners = set.vertices();
    EXPECT_EQ(corners.cols(), count) << n << " " << m;
    for (const VectorXd corner : corners.colwise()) {
      EXPECT_NEAR(set.gauge(corner), 1, 1e-10);
      EXPECT_NEAR(set.gauge(0.25 * corner), 0.25, 1e-10);
    }
    EXPECT_TRUE(corners.cwiseAbs().rowwise().maxCoeff().isApprox(set.extent(), 1e-12));
    for (int i = 0; i < 50; ++i) {
      const VectorXd u = random_matrix(random, n, 1);
      EXPECT_NEAR((u.transpose() * corners).maxCoeff() / set.support(u), 1, 1e-12);
    }
  }
}

TEST(EquilibriumShape, HandlesParallelDependentAndAbsentFrictions) {
  LinearMachine<> s;
  s.stiffness = MatrixXd::Identity(3, 3);
  s.directions =
      (MatrixXd(3, 5) << 1, 2, 0, 1, 7, 0, 0, 1, 1, 7, 0, 0, 0, 0, 7).finished();  // a plane, and no friction
  s.friction_N = (VectorXd(5) << 1, 0.5, 1, 1, 0).finished();
  const auto set = EquilibriumSet::make(s);
  const auto corners = set.vertices();
  EXPECT_EQ(corners.cols(), 6);  // (2, 0), (0, 1) and (1, 1): a hexagon
  EXPECT_EQ(corners.row(2).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(set.gauge(VectorXd::Unit(3, 2)), std::numeric_limits<double>::infinity());
  s.friction_N.setZero();
  const auto none = EquilibriumSet::make(s).vertices();
  EXPECT_EQ(none.cols(), 1);
  EXPECT_TRUE(none.isZero(0));
}

// The shadow's corners are the extremes of the set's corners in the plane of the shadow.
TEST(EquilibriumShape, ShadowsAreThoseOfTheCorners) {
  std::mt19937_64 random{29};
  for (const Index m : {1, 2, 4, 6}) {
    const LinearMachine<> s = random_theorem_1_system(random, 4, m);
    const auto set = EquilibriumSet::make(s);
    const Eigen::Matrix2Xd onto = random_matrix(random, 2, 4);
    const auto shadow = set.projection(onto);
    EXPECT_EQ(shadow.size(), static_cast<std::size_t>(2 * m));
    EXPECT_GE(area(shadow), -1e-12);
    const MatrixXd cast = onto * set.vertices();
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector2d u = random_matrix(random, 2, 1);
      double farthest = 0;
      for (const auto& corner : shadow) farthest = std::max(farthest, u.dot(corner));
      EXPECT_NEAR(farthest, (u.transpose() * cast).maxCoeff(), 1e-12 * farthest);
    }
  }
}

TEST(EquilibriumShape, RefusesCornersOfAnUnboundedSetByItsDirection) {
  LinearMachine<> s = two_mass_example();
  s.stiffness << 1, -1, -1, 1;
  const auto set = EquilibriumSet::make(s);
  const std::string message = refusal([&] { set.vertices(); });
  EXPECT_NE(message.find("unbounded along (0.7071"), std::string::npos) << message;
  EXPECT_THROW(set.projection(Eigen::Matrix2d::Identity()), breakaway::InputError);
  EXPECT_EQ(set.support(Eigen::Vector2d{1, 1}), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(set.support(Eigen::Vector2d{1, -1})));
}

TEST(EquilibriumShape, RefusesBadStaticsByName) {
  const auto message = [](const LinearMachine<>& machine) { return refusal([&] { EquilibriumSet::make(machine); }); };
  LinearMachine<> s = two_mass_example();
  s.friction_N[0] = -2;
  EXPECT_NE(message(s).find("friction_N[0] is -2"), std::string::npos);
  s = two_mass_example();
  s.stiffness(0, 0) = std::nan("");
  EXPECT_NE(message(s).find("stiffness"), std::string::npos);
  s = two_mass_example();
  s.directions.resize(1, 2);
  EXPECT_NE(message(s).find("directions is 1 x 2"), std::string::npos);
}

}  // namespace
}  // namespace equilibrium_shape_test
