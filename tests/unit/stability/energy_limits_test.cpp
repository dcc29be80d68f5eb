// The dissipated level where the better bounds end and dampers in place of friction are all that is left.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "breakaway/stability/energy_level.hpp"
#include "random_systems.hpp"
#include "two_mass_example.hpp"

namespace energy_limits_test {
namespace {

using namespace breakaway::stability;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Twelve masses of 1 kg, each with a damper of -0.1 N s/m, and 40 frictions of 1 N: more corners than are looked at.
TEST(DissipatedLevelLimits, WithTooManyCornersIsThatOfDampers) {
  LinearMachine<> s;
  s.mass = s.stiffness = MatrixXd::Identity(12, 12);
  s.damping = -0.1 * MatrixXd::Identity(12, 12);
  std::mt19937_64 random{12};
  s.directions = random_matrix(random, 12, 40);
  s.friction_N = VectorXd::Ones(40);
  const double level_J = dissipated_level_J(s);
  EXPECT_GT(level_J, 0);
  // Along each coordinate friction gives way where |W^T v| = 0.1 v: the level is not above the energy there.
  for (Index i = 0; i < 12; ++i) {
    const double speed = s.directions.row(i).cwiseAbs().sum() / 0.1;
    EXPECT_LE(level_J, 0.5 * speed * speed);
  }
}

// The damping that the free mass leaves of the other one, c^2 / C, is beyond all numbers, but not the damper that holds
// it: y w^2 = 1e318 with w = 1e50 and the friction 1e200 N, so that kappa = y w / p = 1e68.
TEST(DissipatedLevelLimits, IsThatOfDampersWhereTheReducedDampingOverflows) {
  LinearMachine<> s;
  s.mass = s.stiffness = MatrixXd::Identity(2, 2);
  s.damping = MatrixXd{{0, 1e299}, {1e299, 1e280}};
  s.directions = MatrixXd{{1e50}, {0}};
  s.friction_N = VectorXd::Constant(1, 1e200);
  const double level_J = dissipated_level_J(s);
  EXPECT_TRUE(std::isfinite(level_J));
  EXPECT_GE(level_J / 0.5e-136, 1 - 1e-8);
}

}  // namespace
}  // namespace energy_limits_test
