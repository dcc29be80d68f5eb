// The equilibrium set of machines without springs, without masses, and with more corners than can be listed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "../refusal.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "random_systems.hpp"
#include "two_mass_example.hpp"

namespace equilibrium_limits_test {
namespace {

using namespace breakaway::stability;
using breakaway::testing::refusal;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A spring on the first coordinate only: |q1| <= 1, and anything of q2. Masses serve as units where springs do not.
TEST(EquilibriumLimits, OfACoordinateWithoutASpringHasNoEnd) {
  LinearMachine<> s = two_mass_example();
  s.stiffness = MatrixXd{{1, 0}, {0, 0}};
  s.directions = Eigen::Vector2d{1, 0};
  s.friction_N = VectorXd::Ones(1);
  LinearMachine<> weightless = s, unequal = s, impossible = s;
  weightless.mass = MatrixXd{};
  unequal.mass = Eigen::Vector2d{1, 4096}.asDiagonal();
  impossible.mass = Eigen::Vector2d{1, -1}.asDiagonal();
  for (const LinearMachine<>& one : {s, weightless, unequal, impossible}) {
    const auto set = EquilibriumSet::make(one);
    EXPECT_TRUE(std::isinf(set.extent()[1]));
    EXPECT_TRUE(set.contains(Eigen::Vector2d{1, 1e6}));
    EXPECT_FALSE(set.contains(Eigen::Vector2d{1.001, 0}));
    EXPECT_NEAR(set.support(Eigen::Vector2d{1, 0}), 1, 1e-12);
  }
}

TEST(EquilibriumLimits, RefusesMoreCornersThanCanBeListed) {
  LinearMachine<> s;
  s.stiffness = MatrixXd::Identity(12, 12);
  std::mt19937_64 random{12};
  s.directions = random_matrix(random, 12, 16);
  s.friction_N = VectorXd::Ones(16);
  const auto set = EquilibriumSet::make(s);
  EXPECT_TRUE(set.contains(VectorXd::Zero(12)));
  EXPECT_EQ(refusal([&] { set.vertices(); }),
            "the equilibrium set of 16 frictions in 12 coordinates has too many corners; merge frictions");
}

// Friction acts on the first of three coordinates only. In the plane of the first two, springs that nothing holds pull
// along the second, and what they do along the third is not seen.
TEST(EquilibriumLimits, ACrossSectionSeesOnlyWhatPullsInItsPlane) {
  LinearMachine<> s;
  s.stiffness = MatrixXd::Identity(3, 3);
  s.directions = Eigen::Vector3d{1, 0, 0};
  s.friction_N = VectorXd::Constant(1, 2);
  const Polygon segment = EquilibriumSet::make(s).cross_section(MatrixXd::Identity(3, 2), 6);
  ASSERT_FALSE(segment.empty());
  double farthest_m = 0;
  for (const Eigen::Vector2d& corner : segment) {
    EXPECT_EQ(corner.y(), 0);
    farthest_m = std::max(farthest_m, std::abs(corner.x()));
  }
  EXPECT_NEAR(farthest_m, 2, 1e-14);
}

}  // namespace
}  // namespace equilibrium_limits_test
