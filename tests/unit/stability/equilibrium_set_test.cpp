#include "breakaway/stability/equilibrium_set.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "../refusal.hpp"
#include "two_mass_example.hpp"

namespace equilibrium_set_test {
namespace {

using namespace breakaway::stability;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(EquilibriumSet, OfTheExampleIsAParallelogramInsideTheBoxOf26) {
  const auto set = EquilibriumSet::make(two_mass_example());
  const Polygon corners = set.cross_section(Eigen::Matrix2d::Identity(), 6);
  EXPECT_EQ(corners.size(), 4u);
  EXPECT_NEAR(area(corners), 4.0 / 3, 1e-14);
  EXPECT_TRUE(set.extent().isApprox(Eigen::Vector2d{1, 1}, 1e-14));  // the box of (26) has area 4
  EXPECT_TRUE(set.contains(Eigen::Vector2d{1, 1}));
  EXPECT_FALSE(set.contains(Eigen::Vector2d{1, 0.9}));  // in the box, not in the set
  EXPECT_FALSE(set.contains(Eigen::Vector2d{1, 1} * (1 + 1e-11)));
}

MatrixXd random_matrix(std::mt19937_64& random, Eigen::Index rows, Eigen::Index columns) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// More frictions than coordinates, as many and fewer: every K^-1 W lambda with |lambda| <= p is inside, some of those
// with |lambda_i| = p_i are on the rim, and nothing inside exceeds the extents.
TEST(EquilibriumSet, HoldsExactlyWhatFrictionCanHold) {
  std::mt19937_64 random{7};
  std::uniform_real_distribution<double> share{-1, 1};
  for (const Eigen::Index m : {1, 2, 3, 5, 7}) {
    LinearMachine<> s;
    const MatrixXd root = random_matrix(random, 3, 3);
    s.stiffness = root * root.transpose() + MatrixXd::Identity(3, 3);
    s.directions = random_matrix(random, 3, m);
    s.friction_N = random_matrix(random, m, 1).cwiseAbs();
    const auto set = EquilibriumSet::make(s);
    for (int i = 0; i < 200; ++i) {
      const VectorXd lambda = VectorXd::NullaryExpr(m, [&] { return share(random); }).cwiseProduct(s.friction_N);
      const VectorXd q = s.stiffness.llt().solve(s.directions * lambda);
      EXPECT_TRUE(set.contains(q, 1e-10)) << m;
      EXPECT_TRUE((q.cwiseAbs().array() <= set.extent().array() * (1 + 1e-12)).all());
    }
    // The farthest point in a random direction u of forces lies on the rim.
    const VectorXd u = s.directions * random_matrix(random, m, 1);
    const VectorXd lambda = (s.directions.transpose() * u).cwiseSign().cwiseProduct(s.friction_N);
    const VectorXd rim = s.stiffness.llt().solve(s.directions * lambda);
    EXPECT_TRUE(set.contains(rim, 1e-10)) << m;
    EXPECT_FALSE(set.contains(rim * (1 + 1e-6))) << m;
    EXPECT_EQ(m >= 3, set.contains(random_matrix(random, 3, 1) * 1e-3)) << "flat unless W spans the space";
  }
}

TEST(EquilibriumSet, CrossSectionsHoldWhatTheSetHolds) {
  LinearMachine<> s;
  s.stiffness = (MatrixXd(3, 3) << 3, -1, 0, -1, 2, -1, 0, -1, 2).finished();
  s.directions = (MatrixXd(3, 4) << 1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 0).finished();
  s.friction_N = Eigen::Vector4d{1, 2, 0.5, 0.3};
  const auto set = EquilibriumSet::make(s);
  MatrixXd plane = MatrixXd::Zero(3, 2);
  plane(0, 0) = plane(2, 1) = 1;
  const Polygon polygon = set.cross_section(plane, 10);
  // Area by counting cells; an error of one cell along the rim is 4 h times its half-length, about 1e-2 here.
  const double h = 2e-3;
  int inside = 0;
  for (double x = -3; x < 3; x += h) {
    for (double y = -3; y < 3; y += h) {
      inside += set.contains(Eigen::Vector3d{x, 0, y});
    }
  }
  EXPECT_NEAR(area(polygon), inside * h * h, 1e-2);
  EXPECT_GT(area(polygon), 0.1);
}

TEST(EquilibriumSet, IsUnboundedWhereNoSpringPulls) {
  LinearMachine<> s = two_mass_example();
  s.stiffness << 1, -1, -1, 1;  // nothing holds the centre of mass
  const auto set = EquilibriumSet::make(s);
  EXPECT_EQ(set.extent()[0], std::numeric_limits<double>::infinity());
  EXPECT_TRUE(set.contains(Eigen::Vector2d{1e6, 1e6}));
  EXPECT_NEAR(area(set.cross_section(Eigen::Matrix2d::Identity(), 6)), 144 - 11 * 11, 1e-12);  // |x1 - x2| <= 1
}

TEST(EquilibriumSet, WithoutFrictionIsThePointOfRest) {
  LinearMachine<> s = two_mass_example();
  s.friction_N.setZero();
  const auto set = EquilibriumSet::make(s);
  EXPECT_TRUE(set.contains(Eigen::Vector2d::Zero()));
  EXPECT_FALSE(set.contains(Eigen::Vector2d{1e-9, 0}));
  EXPECT_EQ(area(set.cross_section(Eigen::Matrix2d::Identity(), 6)), 0);
}

TEST(EquilibriumSet, RefusesWhatItCannotEnumerate) {
  LinearMachine<> s;
  s.stiffness = MatrixXd::Identity(12, 12);
  s.directions = MatrixXd::Random(12, 40);
  s.friction_N = VectorXd::Ones(40);
  const std::string message = breakaway::testing::refusal([&] { EquilibriumSet::make(s); });
  EXPECT_NE(message.find("40 frictions"), std::string::npos) << message;
}

}  // namespace
}  // namespace equilibrium_set_test
