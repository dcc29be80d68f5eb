// What is claimed of the energy, against the power that dampers and friction take at sampled velocities.
#include "breakaway/stability/energy_level.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "breakaway/stability/attractivity.hpp"
#include "random_systems.hpp"
#include "two_mass_example.hpp"

namespace energy_level_test {
namespace {

using namespace breakaway::stability;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Where along v the damping begins to give more than friction takes: 1/2 v^T M v there.
double break_even_J(const LinearMachine<>& s, const VectorXd& v) {
  const double given = -v.dot(s.damping * v), held = (s.directions.transpose() * v).cwiseAbs().dot(s.friction_N);
  return given > 0 ? 0.5 * v.dot(s.mass * v) * (held / given) * (held / given)
                   : std::numeric_limits<double>::infinity();
}

// A random search that closes in on the least.
double least_break_even_J(const LinearMachine<>& s, std::mt19937_64& random) {
  VectorXd best = random_matrix(random, s.mass.rows(), 1);
  for (int i = 0; i < 3000; ++i) {
    const VectorXd next = (best + std::exp(-i / 300.0) * random_matrix(random, best.size(), 1)).normalized();
    if (break_even_J(s, next) < break_even_J(s, best)) best = next;
  }
  return break_even_J(s, best);
}

TEST(DissipatedLevel, IsNeverAboveTheTrueOneNorBelowTheoremOne) {
  std::mt19937_64 random{17};
  std::uniform_int_distribution<Index> size{1, 6};
  int improved = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Index n = size(random), m = size(random);
    const bool weak = trial % 2 == 1;
    const LinearMachine<> s = weak ? random_weak_system(random, n, m) : random_theorem_1_system(random, n, m);
    const Attractivity a = certify_attractivity(s);
    ASSERT_TRUE(weak || a.certified) << a.reason;
    ASSERT_GT(dissipated_level_J(s), 0);
    EXPECT_GE(dissipated_level_J(s), a.rho_star_J * (1 - 1e-9));
    EXPECT_LE(a.level_J, least_break_even_J(s, random) * (1 + 1e-9)) << "trial " << trial;
    improved += a.level_J > 1.05 * a.rho_star_J;
  }
  EXPECT_GT(improved, 100);
}

TEST(DissipatedLevel, IsExactWhereTheWorstVelocityIsACorner) {
  EXPECT_NEAR(dissipated_level_J(two_mass_example()), 16, 1e-12);
  LinearMachine<> s;  // unequal negative dampers, each with a friction of its own: the weaker pair decides
  s.mass = MatrixXd::Identity(2, 2);
  s.stiffness = MatrixXd::Identity(2, 2);
  s.damping = Eigen::Vector2d{-0.5, -0.1}.asDiagonal();
  s.directions = MatrixXd::Identity(2, 2);
  s.friction_N = Eigen::Vector2d{1, 1};
  EXPECT_NEAR(dissipated_level_J(s), 0.5 / 0.25, 1e-12);
  EXPECT_NEAR(certify_attractivity(s).rho_star_J, 0.5 / 0.25, 1e-12);
}

TEST(DissipatedLevel, NeedsDampingWhereThereIsNoFriction) {
  LinearMachine<> s = two_mass_example();
  s.directions = Eigen::Vector2d{1, 0};
  s.friction_N = VectorXd::Ones(1);
  for (const double c : {-1e-6, 0.0, 1e-6}) {
    s.damping << -0.2, 0, 0, c;
    EXPECT_EQ(dissipated_level_J(s) > 0, c > 0) << c;
  }
}

// (d/dt) |x - y|^2 / 2 = -dv^T C dv - friction, which is not above c dv^T M dv, and reaches it.
TEST(PartingRate, IsTheLargestRateOfTheNegativeDamping) {
  EXPECT_NEAR(parting_rate_per_s(two_mass_example()), 0.25, 1e-12);
  EXPECT_LE(parting_rate_per_s(two_mass_example(0.9)), 0);
  std::mt19937_64 random{19};
  for (int trial = 0; trial < 100; ++trial) {
    const LinearMachine<> s = random_weak_system(random, 1 + trial % 6, 3);
    const double rate = parting_rate_per_s(s);
    for (int i = 0; i < 100; ++i) {
      const VectorXd v = random_matrix(random, s.mass.rows(), 1);
      EXPECT_LE(-v.dot(s.damping * v), rate * v.dot(s.mass * v) * (1 + 1e-12) + 1e-300);
    }
  }
}

}  // namespace
}  // namespace energy_level_test
