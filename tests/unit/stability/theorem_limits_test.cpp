// Theorem 1 where rounding, sizes or the number of frictions end what can be said.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../../../controller/stability/src/power_proof.hpp"
#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/energy_level.hpp"
#include "breakaway/stability/escape.hpp"
#include "breakaway/stability/pd_design.hpp"
#include "random_systems.hpp"
#include "two_mass_example.hpp"

namespace theorem_limits_test {
namespace {

using namespace breakaway::stability;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double without_end = std::numeric_limits<double>::infinity();

// One mass of 1 kg on a spring of 1 N/m.
LinearMachine<> one_mass(double damping, const MatrixXd& directions, const VectorXd& friction_N) {
  return {MatrixXd::Ones(1, 1), MatrixXd::Constant(1, 1, damping), MatrixXd::Ones(1, 1), directions, friction_N};
}

// Two masses of 1 kg and 1e-300 kg: a unit in which both are 1 differs by 1e150 between them.
LinearMachine<> heavy_and_weightless() {
  LinearMachine<> s = two_mass_example();
  s.mass(1, 1) = 1e-300;
  return s;
}

TEST(TheoremLimits, AMachineWithoutFrictionNeedsItsDamping) {
  const Attractivity damped = certify_attractivity(one_mass(1, MatrixXd(1, 0), VectorXd(0)));
  EXPECT_TRUE(damped.certified && damped.global()) << damped.reason;
  EXPECT_EQ(damped.greatest_rest_J, 0);
  EXPECT_FALSE(certify_attractivity(one_mass(-1, MatrixXd(1, 0), VectorXd(0))).certified);
}

// 24 frictions of 1 N on one mass are one of 24 N: it rests within 24 m, and V is 288 J there.
TEST(TheoremLimits, ManyFrictionsOfOneMassAddUp) {
  const Attractivity a = certify_attractivity(one_mass(-0.5, MatrixXd::Ones(1, 24), VectorXd::Ones(24)));
  ASSERT_TRUE(a.certified) << a.reason;
  EXPECT_NEAR(a.greatest_rest_J, 288, 1e-9);
  EXPECT_NEAR(a.rho_star_J, 24.0 * 24 / (2 * 0.25), 1e-9);
}

TEST(TheoremLimits, TooManyCornersAreRefusedWithWhatIsKnown) {
  LinearMachine<> s;
  s.mass = s.stiffness = s.damping = MatrixXd::Identity(12, 12);
  std::mt19937_64 random{12};
  s.directions = random_matrix(random, 12, 40);
  s.friction_N = VectorXd::Ones(40);
  const Attractivity a = certify_attractivity(s);
  EXPECT_FALSE(a.certified);
  EXPECT_TRUE(a.definite);
  EXPECT_NE(a.reason.find("more than a million corners; merge frictions"), std::string::npos) << a.reason;
  EXPECT_GE(a.greatest_rest_J, a.remark_3_J);
}

// [F75, F76; F76, F77] of Fibonacci's numbers has the determinant 1, and its least eigenvalue is 1e-31 of the greatest.
TEST(TheoremLimits, RoundingMayHideWhetherSpringsHold) {
  double before = 1, last = 1;
  for (int i = 3; i <= 76; ++i) {
    const double next = before + last;
    before = last;
    last = next;
  }
  LinearMachine<> s = two_mass_example();
  s.stiffness = MatrixXd{{before, last}, {last, before + last}};
  const Attractivity a = certify_attractivity(s);
  EXPECT_FALSE(a.definite);
  EXPECT_EQ(a.reason.rfind("stiffness is so nearly singular that rounding hides whether it is positive definite", 0),
            0U)
      << a.reason;
}

TEST(TheoremLimits, MassesOfSizesThatNoUnitHoldsAreRefused) {
  LinearMachine<> dampers = heavy_and_weightless(), directions = heavy_and_weightless();
  dampers.damping(1, 1) = 1e100;
  directions.directions(1, 1) = 1e200;
  for (const LinearMachine<>& s : {dampers, directions}) {
    const Attractivity a = certify_attractivity(s);
    EXPECT_FALSE(a.certified);
    EXPECT_EQ(a.level_J, 0);
    EXPECT_NE(a.reason.find("the masses differ by more than numbers can hold"), std::string::npos) << a.reason;
    EXPECT_TRUE(escape_levels(s).empty()) << "nothing is said to escape, either";
  }
  EXPECT_TRUE(certify_attractivity(heavy_and_weightless()).definite);
}

TEST(TheoremLimits, TheCertifiedShareOfEIsTheRatioOfSizes) {
  Attractivity a;
  EXPECT_EQ(a.certified_share_of_E(), 0) << "nothing is certified, and nothing rests anywhere but at 0";
  a.level_J = 4;
  EXPECT_EQ(a.certified_share_of_E(), 1);
  a.greatest_rest_J = 1;
  EXPECT_EQ(a.certified_share_of_E(), 1);
  a.greatest_rest_J = 16;
  EXPECT_EQ(a.certified_share_of_E(), 0.5);
  a.level_J = 0;
  EXPECT_EQ(a.certified_share_of_E(), 0);
}

TEST(TheoremLimits, TheClosedFormIsThatOfTheExampleAlone) {
  const std::vector<std::function<void(LinearMachine<>&)>> changes{
      [](LinearMachine<>& s) { s.mass(0, 1) = 0.1; },
      [](LinearMachine<>& s) { s.mass(0, 1) = s.mass(1, 0) = 0.1; },
      [](LinearMachine<>& s) {
        s.directions = MatrixXd::Identity(2, 1);
        s.friction_N = VectorXd::Ones(1);
      },
      [](LinearMachine<>& s) { s = one_mass(-1, MatrixXd::Identity(1, 1), VectorXd::Ones(1)); },
      [](LinearMachine<>& s) { s.damping(0, 0) += 0.1; },
      [](LinearMachine<>& s) { s.damping(0, 1) += 0.1; },
      [](LinearMachine<>& s) { s.damping.diagonal().setConstant(-0.375); },
  };
  ASSERT_TRUE(closed_form_rho_J(two_mass_example()).has_value());
  for (std::size_t i = 0; i < changes.size(); ++i) {
    LinearMachine<> s = two_mass_example();
    changes[i](s);
    EXPECT_FALSE(closed_form_rho_J(s).has_value()) << "change " << i;
  }
}

// Each mass has its own damper and friction of 1 N, so that beta is 1: rho* is 1 / (2 lambda^2) of the worst one.
TEST(TheoremLimits, OnlyEqualEigenvaluesShareTheirColumns) {
  LinearMachine<> s;
  s.mass = s.stiffness = s.directions = MatrixXd::Identity(4, 4);
  s.damping = Eigen::Vector4d{-1, -2, -1, 0.5}.asDiagonal();
  s.friction_N = VectorXd::Ones(4);
  const Attractivity a = certify_attractivity(s);
  ASSERT_TRUE(a.certified) << a.reason;
  EXPECT_EQ(a.unstable, 3);
  EXPECT_NEAR(a.alpha, 1, 1e-9);
  EXPECT_NEAR(a.rho_star_J, 1.0 / 8, 1e-9);
  EXPECT_NEAR(a.rho_J.maxCoeff(), 1.0 / 2, 1e-9);
}

TEST(PowerProofLimits, WithoutAProofThereIsNoLevel) {
  LinearMachine<> s = two_mass_example();
  s.friction_N.setZero();
  const PowerProof proof{s};
  EXPECT_FALSE(proof.found());
  EXPECT_FALSE(proof.everywhere());
  EXPECT_EQ(proof.level_J(), 0);
}

TEST(PowerProofLimits, DampingThatGivesNoPowerHoldsAtEverySpeed) {
  const PowerProof proof{two_mass_example(1)};
  EXPECT_TRUE(proof.everywhere());
  EXPECT_EQ(proof.level_J(), without_end);
}

TEST(PowerProofLimits, ForcesThatAreNotFiniteAreNotCompleted) {
  const PowerProof proof{two_mass_example()};
  ASSERT_TRUE(proof.found());
  EXPECT_EQ(proof.completed(0.3 * MatrixXd::Identity(2, 2)).rows(), 2);
  EXPECT_EQ(proof.completed(MatrixXd::Constant(2, 2, without_end)).size(), 0);
}

// The damper in place of a friction of 1e300 N along a direction of 1e-100 is beyond all numbers.
TEST(PowerProofLimits, AFrictionBeyondAllNumbersProvesNothing) {
  const LinearMachine<> s = one_mass(-1, MatrixXd::Constant(1, 1, 1e-100), VectorXd::Constant(1, 1e300));
  EXPECT_FALSE(PowerProof{s}.found());
  EXPECT_EQ(dissipated_level_J(s), 0);
}

// A friction along no direction holds nothing, and harms nothing.
TEST(PowerProofLimits, AFrictionThatActsOnNothingChangesNothing) {
  LinearMachine<> s = two_mass_example();
  s.directions = MatrixXd{{1, 0, 0}, {0, 0, 1}};
  s.friction_N = VectorXd::Ones(3);
  EXPECT_NEAR(dissipated_level_J(s), 16, 1e-12);
  EXPECT_NEAR(certify_attractivity(s).rho_star_J, 16, 1e-12);
}

// m v' = -c v + u without any spring: for c = -1 N s/m and |u| <= 1 N what is faster than 1 m/s never comes back.
TEST(EscapeLimits, OfAMassWithoutSpringsIsOneOfSpeed) {
  LinearMachine<> s = one_mass(-1, MatrixXd::Ones(1, 1), VectorXd::Ones(1));
  s.stiffness.setZero();
  const auto levels = escape_levels(s);
  ASSERT_EQ(levels.size(), 1U);
  EXPECT_NEAR(levels[0].growth_rate, 1, 1e-14);
  EXPECT_NEAR(levels[0].level / std::abs(levels[0].real[1]), 1, 2e-9);
  s.damping.setZero();
  EXPECT_TRUE(escape_levels(s).empty()) << "a free mass goes on as it is";
}

TEST(EscapeLimits, AFrictionThatNoUnitHoldsLeavesNothingToSay) {
  LinearMachine<> s = heavy_and_weightless();
  s.damping = Eigen::Vector2d{-1, 0}.asDiagonal();
  s.stiffness = Eigen::Vector2d{1, 1e-300}.asDiagonal();
  EXPECT_EQ(escape_levels(s).size(), 1U);
  s.directions(1, 1) = 1e200;
  EXPECT_TRUE(escape_levels(s).empty());
}

TEST(LoopConditions, RefuseASkewStiffnessAsNotPositiveDefinite) {
  LinearMachine<> s = two_mass_example();
  s.stiffness(0, 1) = -0.5;
  const std::vector<Condition> conditions = loop_conditions(s);
  EXPECT_FALSE(conditions.at(0).holds);
  EXPECT_EQ(conditions.at(1).name, "K_cl positive definite");
  EXPECT_FALSE(conditions.at(1).holds);
  EXPECT_LE(conditions.at(1).margin, 0);
}

// A gyroscope without any damper turns the plane: its left vectors are (1, i), which no turn makes real.
TEST(MachineConditions, NameADirectionOfAMotionThatTurns) {
  LinearMachine<> s = two_mass_example();
  s.damping = MatrixXd{{0, -1}, {1, 0}};
  s.friction_N.setZero();
  const std::vector<Condition> conditions = machine_conditions({s, MatrixXd::Zero(2, 1)});
  const Condition& stabilizable = conditions.at(3);
  EXPECT_FALSE(stabilizable.holds);
  EXPECT_NE(stabilizable.reason.find("neither friction nor an actuator acts on it"), std::string::npos)
      << stabilizable.reason;
  EXPECT_EQ(stabilizable.reason.find("nan"), std::string::npos) << stabilizable.reason;
}

// 16 J is where the power of friction and that of the damping are equal, whatever the other motion's damping is.
TEST(TheoremLimits, NoLevelIsAboveTheOneThatIsProved) {
  for (const double d : {0.0, 1e3, 1e6, 5 * 0x1p26, 0x1p40}) {
    LinearMachine<> machine = two_mass_example();
    machine.damping += MatrixXd::Constant(2, 2, d);
    machine.stiffness *= 1e-12;
    const Attractivity a = certify_attractivity(machine);
    EXPECT_LE(a.rho_star_J, 16 * (1 + 1e-14)) << d;
    EXPECT_LE(a.level_J, 16 * (1 + 1e-14)) << d;
    EXPECT_LE(a.rho_star_J, a.level_J) << d;
  }
}

// In decimals it is singular, so that equilibria lie anywhere along (-0.3, 1); as stored it is positive definite.
TEST(TheoremLimits, OfASpringThatRoundingAloneMakesOneNotAllEquilibriaAreCertified) {
  LinearMachine<> machine = two_mass_example();
  machine.damping << -1e-6, 0, 0, 1;
  for (const double c : {0.03, 0.07, 0.11, 0.13, 0.17}) {
    machine.stiffness << 0.1, c, c, c * c * 10;
    const Attractivity a = certify_attractivity(machine);
    EXPECT_FALSE(a.all_of_E) << c;
  }
}

// By hand: V at rest is p^T K^-1 p / 2 with p in [-1, 1]^2, greatest at (1, -1): 1 / (1 - c).
TEST(TheoremLimits, TheGreatestEnergyAtRestIsNeverTooSmall) {
  for (const double near : {1e-3, 1e-6, 1e-9, 1e-12}) {
    LinearMachine<> machine = two_mass_example();
    const double c = 1 - near;
    machine.stiffness << 1, c, c, 1;
    const double exact = 1 / (1 - c);
    const Attractivity a = certify_attractivity(machine);
    EXPECT_GE(a.greatest_rest_J, exact) << near;
    EXPECT_LE(a.greatest_rest_J, exact * (1 + 1e-13 / near)) << near;
  }
}

TEST(TheoremLimits, ALevelThatOverflowsIsNotOneOfEverywhere) {
  LinearMachine<> machine = two_mass_example();
  machine.mass *= 1e308;
  const Attractivity a = certify_attractivity(machine);
  EXPECT_TRUE(std::isfinite(a.rho_star_J));
  EXPECT_TRUE(std::isfinite(a.level_J));
  const auto closed_form = closed_form_rho_J(machine);
  EXPECT_TRUE(closed_form && !std::isnan(*closed_form));
}

}  // namespace
}  // namespace theorem_limits_test
