#include "breakaway/stability/attractivity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

#include "random_systems.hpp"
#include "two_mass_example.hpp"

namespace attractivity_test {
namespace {

using namespace breakaway::stability;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// rho* = 1 / (d1 - 0.75)^2 by hand: beta = sqrt(2), lambda = d1 - 0.75, U_c orthonormal. From 0.75 on it is global.
TEST(Theorem1, GivesTheLevelsOfTheDerivativeGainSweep) {
  for (const auto& [d1, rho] :
       {std::pair{0.3, 4.938}, {0.4, 8.163}, {0.5, 16.0}, {0.6, 44.44}, {0.7, 400.0}, std::pair{0.74, 10000.0}}) {
    const Attractivity a = certify_attractivity(two_mass_example(d1));
    ASSERT_TRUE(a.certified) << a.reason;
    EXPECT_NEAR(a.rho_star_J / rho, 1, 2e-4) << d1;  // the figures have four digits
    EXPECT_NEAR(a.rho_star_J * (d1 - 0.75) * (d1 - 0.75), 1, 1e-11) << d1;
    EXPECT_TRUE(a.all_of_E);
  }
  EXPECT_TRUE(std::isinf(certify_attractivity(two_mass_example(0.75)).rho_star_J));
  EXPECT_TRUE(std::isinf(certify_attractivity(two_mass_example(0.9)).rho_star_J));
}

TEST(Theorem1, FindsTheTightAlphaOfTheExample) {
  const Attractivity a = certify_attractivity(two_mass_example());
  EXPECT_NEAR(a.alpha, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(a.rho_star_J, 16, 1e-13);
  EXPECT_NEAR(a.greatest_rest_J, 1, 1e-14);  // at (1, 1)
  EXPECT_EQ(a.unstable, 1);
  // (27), the closed form of the example, is four times more conservative.
  const double gamma = 1 / 0.25;
  EXPECT_NEAR(a.rho_star_J / (0.5 * 0.5 * gamma * gamma), 4, 1e-13);
}

// (9) holds for random etadot, comes close to equality for some, and V does not grow inside { V < rho* }, by (10).
TEST(Theorem1, HoldsForRandomSystems) {
  std::mt19937_64 random{11};
  for (const auto& [n, m] : {std::pair<Eigen::Index, Eigen::Index>{2, 2}, {2, 5}, {3, 3}, {3, 6}, {4, 4}}) {
    LinearMachine<> s;
    const MatrixXd k = random_matrix(random, n, n), mass = random_matrix(random, n, n), c = random_matrix(random, n, n);
    s.stiffness = k * k.transpose() + MatrixXd::Identity(n, n);
    s.mass = mass * mass.transpose() + MatrixXd::Identity(n, n);
    s.damping = c + c.transpose() - MatrixXd::Identity(n, n);
    s.directions = random_matrix(random, n, m);
    s.friction_N = random_matrix(random, m, 1).cwiseAbs();
    const Attractivity a = certify_attractivity(s);
    ASSERT_TRUE(a.certified) << a.reason;
    ASSERT_GT(a.unstable, 0);
    const MatrixXd columns = s.mass.diagonal().cwiseSqrt().cwiseInverse().asDiagonal() * a.eigencolumns;
    double closest = 0;
    VectorXd closest_eta = VectorXd::Zero(n);
    for (int i = 0; i < 20000; ++i) {
      // A random search: any direction, then ever nearer to the best so far.
      const double reach = std::exp(-i / 2000.0);
      const VectorXd eta = (closest_eta + reach * random_matrix(random, n, 1)).normalized();
      const double held = (s.directions.transpose() * columns * eta).cwiseAbs().dot(s.friction_N);
      if (const double ratio = eta.head(a.unstable).cwiseAbs().sum() / (a.alpha * held); ratio > closest) {
        closest = ratio;
        closest_eta = eta;
      }
      VectorXd v = random_matrix(random, n, 1);
      v *= std::sqrt(2 * a.rho_star_J / v.dot(s.mass * v));
      const double power = -v.dot(s.damping * v) - (s.directions.transpose() * v).cwiseAbs().dot(s.friction_N);
      EXPECT_LT(power, 1e-12 * a.rho_star_J);
    }
    EXPECT_LE(closest, 1 + 1e-12);
    EXPECT_GT(closest, 0.99) << "n " << n << " m " << m << ": alpha is not the smallest";
  }
}

TEST(Theorem1, NamesWhatItCannotCertify) {
  LinearMachine<> one_friction = two_mass_example();
  one_friction.friction_N[0] = 0;  // the unstable eigencolumn (1, -1) needs both
  EXPECT_NE(certify_attractivity(one_friction).reason.find("condition 2"), std::string::npos);
  EXPECT_EQ(certify_attractivity(one_friction).rho_star_J, 0);

  LinearMachine<> soft = two_mass_example();
  soft.stiffness << 1, -2, -2, 1;
  EXPECT_NE(certify_attractivity(soft).reason.find("stiffness"), std::string::npos);
  soft.stiffness << 2, -1, 0, 2;
  EXPECT_NE(certify_attractivity(soft).reason.find("symmetric"), std::string::npos);
}

TEST(Theorem1, OneFrictionWillDoWhenItPointsAlongTheUnstableDirection) {
  LinearMachine<> s = two_mass_example();
  s.directions = Eigen::Vector2d{1, -1};
  s.friction_N = VectorXd::Ones(1);
  const Attractivity a = certify_attractivity(s);
  ASSERT_TRUE(a.certified) << a.reason;
  EXPECT_NEAR(a.rho_star_J, 16, 1e-13);  // |v1 - v2| = sqrt(2) |eta_1|: beta = sqrt(2) again
}

}  // namespace
}  // namespace attractivity_test
