#include "breakaway/stability/escape.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "two_mass_example.hpp"

namespace escape_test {
namespace {

using namespace breakaway::stability;

// Against each other, y = (x1 - x2) / sqrt(2), the two masses obey y'' - y'/4 + 3 y = u with |u| <= sqrt(2): the mode
// grows at 1/8, and z carries y' with the same factor as u.
TEST(Escape, LevelOfTheExampleIsThatOfItsUnstableMode) {
  const auto levels = escape_levels(two_mass_example());
  ASSERT_EQ(levels.size(), 1u);
  const Eigen::Vector2d against{std::sqrt(0.5), -std::sqrt(0.5)};
  const double gain = std::hypot(levels[0].real.tail(2).dot(against), levels[0].imaginary.tail(2).dot(against));
  EXPECT_NEAR(levels[0].growth_rate, 0.125, 1e-14);
  EXPECT_NEAR(levels[0].level, gain * std::sqrt(2.0) / 0.125, 1e-7);  // carries its margin of 1e-9
  EXPECT_GT(levels[0].level, gain * std::sqrt(2.0) / 0.125);
}

TEST(Escape, IsNowhereForAStableMachine) {
  EXPECT_TRUE(escape_levels(two_mass_example(0.8)).empty());
  EXPECT_TRUE(escape_levels(two_mass_example(0.75)).empty());  // the mode neither grows nor decays
}

TEST(Escape, WithoutFrictionEveryMotionOfTheModeEscapes) {
  LinearMachine<> s = two_mass_example();
  s.friction_N.setZero();
  ASSERT_EQ(escape_levels(s).size(), 1u);
  EXPECT_EQ(escape_levels(s)[0].level, 0);
}

// Three frictions of one mode, along the same line in the complex plane but for rounding, add up.
TEST(Escape, AddsUpFrictionsThatPushAlike) {
  LinearMachine<> s = two_mass_example();
  const double whole = escape_levels(s)[0].level;
  s.directions = Eigen::Matrix<double, 2, 4>{{1, 1, 1, 0}, {0, 0, 0, 1}};
  s.friction_N = Eigen::Vector4d{0.1, 0.3, 0.6, 1};
  EXPECT_NEAR(escape_levels(s)[0].level / whole, 1, 1e-12);
}

// m q'' = k q + lambda: the fall over. s = sqrt(k / m), and z ~ s q + v reaches f / s at the border of what can return.
TEST(Escape, OfAFallIsExact) {
  LinearMachine<> s;
  s.mass = Eigen::MatrixXd::Constant(1, 1, 2);
  s.damping = Eigen::MatrixXd::Zero(1, 1);
  s.stiffness = Eigen::MatrixXd::Constant(1, 1, -8);
  s.directions = Eigen::MatrixXd::Ones(1, 1);
  s.friction_N = Eigen::VectorXd::Constant(1, 4);
  const auto levels = escape_levels(s);
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_NEAR(levels[0].growth_rate, 2, 1e-14);
  EXPECT_NEAR(levels[0].real[0] / levels[0].real[1], 2, 1e-14);
  EXPECT_NEAR(levels[0].level / std::abs(levels[0].real[1]), (4.0 / 2) / 2, 2e-9);  // (f / m) / s
}

// Two masses that a third, far greater one nearly makes a single body: [1 1-e; 1-e 1] has the mass e against each
// other, and 2 - e together. With springs and dampers that are as much smaller the mode against each other is that of
// the example, whatever e is; all entries are exact for powers of two.
TEST(Escape, OfAMassMatrixThatIsNearlySingularIsExactOrNotClaimed) {
  const auto both = [](double together, double against) {
    return Eigen::MatrixXd{{(together + against) / 2, (together - against) / 2},
                           {(together - against) / 2, (together + against) / 2}};
  };
  int claimed = 0;
  for (int bits = 0; bits <= 50; ++bits) {
    const double e = std::ldexp(1.0, -bits);
    LinearMachine<> s;
    s.mass = both(2 - e, e);
    s.damping = both(1, -e / 4);
    s.stiffness = both(1, 3 * e);
    s.directions = Eigen::MatrixXd::Identity(2, 2);
    s.friction_N = Eigen::Vector2d{1, 2};
    for (const EscapeLevel& mode : escape_levels(s)) {
      ++claimed;
      EXPECT_NEAR(mode.growth_rate, 0.125, 1e-10) << "e = 2^-" << bits;
      const double gain = std::hypot(mode.real[2] - mode.real[3], mode.imaginary[2] - mode.imaginary[3]) / 2;
      // z' = s z + ... + gain (lambda1 - lambda2) / e against each other, |lambda1 - lambda2| <= 3.
      EXPECT_NEAR(mode.level / (gain * 3 / e / 0.125), 1, 1e-8) << "e = 2^-" << bits;
    }
  }
  EXPECT_GT(claimed, 35) << "where it is nearly regular it is claimed";
}

}  // namespace
}  // namespace escape_test
