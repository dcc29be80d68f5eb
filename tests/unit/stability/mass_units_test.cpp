// What is certified is about the machine, whatever units of length, mass and time it is written in.
#include "breakaway/stability/mass_units.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/energy_level.hpp"
#include "random_systems.hpp"
#include "two_mass_example.hpp"

namespace mass_units_test {
namespace {

using namespace breakaway::stability;
using Eigen::Index;
using Eigen::VectorXd;

// Two axes without coupling. The second one's damping is negative, and tiny only in its units: it grows by 1 % a time
// constant of 1 s, and a thousandth of a newton of friction per newton of spring cannot hold it from far away.
LinearMachine<> flies_apart() {
  LinearMachine<> machine;
  machine.mass = Eigen::Vector2d{1e3, 1e-12}.asDiagonal();
  machine.damping = Eigen::Vector2d{1e4, -1e-12}.asDiagonal();
  machine.stiffness = Eigen::Vector2d{1e6, 1e-6}.asDiagonal();
  machine.directions = Eigen::Matrix2d::Identity();
  machine.friction_N = Eigen::Vector2d{1, 1e-15};
  return machine;
}

// By hand: friction takes more than the damping gives while |v_2| < 1e-15 N / 1e-12 N s/m, so rho* = M v^2 / 2.
TEST(MassUnits, KeepATinyNegativeDamperFromAnInfiniteLevel) {
  const Attractivity a = certify_attractivity(flies_apart());
  ASSERT_TRUE(a.certified) << a.reason;
  EXPECT_NEAR(a.rho_star_J / (0.5 * 1e-12 * 1e-6), 1, 1e-9);
  EXPECT_NEAR(a.level_J / (0.5 * 1e-12 * 1e-6), 1, 1e-9);
  EXPECT_EQ(a.unstable, 1);
  LinearMachine<> damped = flies_apart();
  damped.damping(1, 1) = 1e-12;
  EXPECT_TRUE(std::isinf(certify_attractivity(damped).level_J));
}

LinearMachine<> in_other_units(const LinearMachine<>& machine, const VectorXd& length, double mass, double time) {
  LinearMachine<> result = in_units(machine, length);
  result.mass *= mass;
  result.damping *= mass / time;
  result.stiffness *= mass / time / time;
  result.friction_N *= mass / time / time;
  return result;
}

void expect_same(const Attractivity& a, const Attractivity& b, double unit, const std::string& label) {
  EXPECT_EQ(a.certified, b.certified) << label << a.reason << b.reason;
  EXPECT_EQ(a.definite, b.definite) << label;
  EXPECT_EQ(a.unstable, b.unstable) << label << a.eigenvalues.transpose() << " : " << b.eigenvalues.transpose();
  EXPECT_EQ(a.all_of_E, b.all_of_E) << label;
  ASSERT_EQ(a.conditions.size(), b.conditions.size()) << label;
  for (std::size_t i = 0; i < a.conditions.size(); ++i)
    EXPECT_EQ(a.conditions[i].holds, b.conditions[i].holds) << label;
  for (const auto level : {&Attractivity::rho_star_J, &Attractivity::level_J, &Attractivity::greatest_rest_J}) {
    if (std::isinf(a.*level) || a.*level == 0) {
      EXPECT_EQ(a.*level, b.*level) << label;
    } else if (a.*level > 1e15 * a.greatest_rest_J) {
      EXPECT_GT(b.*level, 1e15 * b.greatest_rest_J) << label;  // damping that is negative by its rounding alone
    } else {
      // The basis of a repeated eigenvalue is turned to an optimum of rho*, in a few sweeps.
      const double tolerance = level == &Attractivity::rho_star_J ? 1e-5 : 1e-9;
      EXPECT_NEAR(b.*level / (a.*level * unit), 1, tolerance) << label;
    }
  }
}

// Coordinates by any power of two each, the mass and the time by others; energy is mass length^2 / time^2, and lengths
// that are stretched by `length` make q smaller by it.
TEST(MassUnits, OfAnyKindChangeNoVerdict) {
  std::mt19937_64 random{23};
  std::uniform_int_distribution<int> exponent{-20, 20};
  std::uniform_int_distribution<Index> size{1, 6};
  for (int trial = 0; trial < 200; ++trial) {
    const Index n = size(random), m = size(random);
    LinearMachine<> s = trial % 2 == 0 ? random_theorem_1_system(random, n, m) : random_weak_system(random, n, m);
    if (trial % 5 == 0) s.friction_N[0] = 0;
    const VectorXd length = VectorXd::NullaryExpr(n, [&] { return std::ldexp(1.0, exponent(random)); });
    const double mass = std::ldexp(1.0, exponent(random)), time = std::ldexp(1.0, exponent(random));
    const std::string label = "trial " + std::to_string(trial) + " ";
    expect_same(certify_attractivity(s), certify_attractivity(in_other_units(s, length, mass, time)),
                mass / time / time, label);
    EXPECT_NEAR(parting_rate_per_s(in_other_units(s, length, mass, time)) * time, parting_rate_per_s(s),
                1e-9 * (1 + parting_rate_per_s(s)))
        << label;
  }
}

TEST(MassUnits, OfAnyKindLeaveTheExampleItsLevel) {
  for (const double other : {1e-9, 0.3, 7.0, 1e9}) {
    const Attractivity a = certify_attractivity(in_units(two_mass_example(), Eigen::Vector2d{other, 1 / other}));
    EXPECT_NEAR(a.rho_star_J, 16, 1e-9) << other;
    EXPECT_TRUE(a.all_of_E) << other;
    const Attractivity border = certify_attractivity(in_units(two_mass_example(0.75), Eigen::Vector2d{4, 1}));
    EXPECT_TRUE(std::isinf(border.level_J));
  }
}

TEST(MassUnits, RefuseASkewPartThatStiffUnitsWouldHide) {
  LinearMachine<> s = flies_apart();
  s.damping.setZero();
  s.stiffness(0, 1) = 1e-7;  // far below 1e6, and far above what the soft axis can bear
  const Attractivity a = certify_attractivity(s);
  EXPECT_FALSE(a.certified);
  EXPECT_EQ(a.level_J, 0);
  EXPECT_NE(a.reason.find("not symmetric"), std::string::npos) << a.reason;
}

}  // namespace
}  // namespace mass_units_test
