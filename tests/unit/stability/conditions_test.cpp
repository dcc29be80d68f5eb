// Theorem 1 at the edges of its conditions, and what it refuses.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <ctime>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "breakaway/stability/attractivity.hpp"
#include "random_systems.hpp"
#include "two_mass_example.hpp"

namespace conditions_test {
namespace {

using namespace breakaway::stability;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinite = std::numeric_limits<double>::infinity();

TEST(Conditions, OfTheExampleHoldWithTheirMargins) {
  const Attractivity a = certify_attractivity(two_mass_example());
  ASSERT_EQ(a.conditions.size(), 5u);
  for (const Condition& condition : a.conditions) {
    EXPECT_TRUE(condition.holds) << condition.name;
    EXPECT_GT(condition.margin, 0) << condition.name;
  }
  EXPECT_NEAR(a.conditions[1].margin, 0.5, 1e-15);             // K / 2 has the eigenvalues 1/2 and 3/2
  EXPECT_NEAR(a.conditions[3].margin, std::sqrt(2.0), 1e-15);  // beta
  EXPECT_NEAR(a.conditions[4].margin, 0.75, 1e-14);            // V = 1 at (1, 1), of 16
}

TEST(Conditions, GiveTheClosedFormOfTheExampleOnlyWhereItIsTrue) {
  EXPECT_DOUBLE_EQ(closed_form_rho_J(two_mass_example()).value(), 4);
  EXPECT_FALSE(closed_form_rho_J(two_mass_example(0.8)));  // c1 + 2 c2 > 0: global
  LinearMachine<> other = two_mass_example();
  other.directions(0, 1) = 0.5;
  EXPECT_FALSE(closed_form_rho_J(other));
}

TEST(Conditions, CertifyAllOfEForEveryUnstableGainOfTheSweep) {
  for (double d1 = 0.001; d1 < 0.75; d1 += 0.001) {
    const Attractivity a = certify_attractivity(two_mass_example(d1));
    EXPECT_TRUE(a.all_of_E) << d1;
    EXPECT_TRUE(std::isfinite(a.rho_star_J)) << d1;
  }
}

// Just inside and just outside of each border, by a relative 1e-9: far above rounding, far below any tolerance in use.
TEST(Conditions, AreToldApartNextToTheirBorders) {
  constexpr double hair = 1e-9;
  for (const double side : {-1.0, 1.0}) {
    LinearMachine<> s = two_mass_example();
    s.stiffness << 1 + side * hair, -1, -1, 1;  // singular at 0
    EXPECT_EQ(certify_attractivity(s).definite, side > 0) << "stiffness";
    s = two_mass_example();
    s.mass << 1 + side * hair, 1, 1, 1;
    EXPECT_EQ(certify_attractivity(s).definite, side > 0) << "mass";
    s = two_mass_example(0.75 + side * hair);
    EXPECT_EQ(std::isinf(certify_attractivity(s).rho_star_J), side > 0) << "damping";
    // The corner (1, 1) of E has V = f^2 (1 + 1) / 2: on the border of {V < 16} beta^2 / 2 grows with it, so move K.
    s = two_mass_example();
    s.stiffness *= (1 - side * hair) / 16;
    s.stiffness = s.stiffness.eval();
    const Attractivity a = certify_attractivity(s);
    EXPECT_EQ(a.all_of_E, side < 0) << a.greatest_rest_J;
    EXPECT_EQ(a.conditions.back().holds, side < 0);
  }
}

// The smallest eigenvalue of a definite matrix made `share` of what it was.
MatrixXd with_least(const MatrixXd& matrix, double share) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(matrix);
  const VectorXd least = eigen.eigenvectors().col(0);
  const MatrixXd moved = matrix - (1 - share) * eigen.eigenvalues()[0] * least * least.transpose();
  return (moved + moved.transpose()) / 2;
}

TEST(Conditions, OfRandomSystemsAreToldApartNextToTheirBorders) {
  constexpr double hair = 1e-8;
  std::mt19937_64 random{41};
  std::uniform_int_distribution<Eigen::Index> size{2, 6};
  int bounded = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Index n = size(random), m = size(random);
    const LinearMachine<> s = random_theorem_1_system(random, n, m);
    const Attractivity a = certify_attractivity(s);
    for (const double side : {-1.0, 1.0}) {
      LinearMachine<> near = s;
      near.mass = with_least(s.mass, side * hair);
      EXPECT_EQ(certify_attractivity(near).definite, side > 0) << "mass " << trial;
      near = s;
      near.stiffness = with_least(s.stiffness, side * hair);
      EXPECT_EQ(certify_attractivity(near).definite, side > 0) << "stiffness " << trial;
      near = s;
      VectorXd values = random_matrix(random, n, 1).cwiseAbs() + VectorXd::Ones(n);
      values[0] = side * hair;
      near.damping = from_mass_units(s, with_eigenvalues(basis_along_directions(s), values));
      EXPECT_EQ(std::isinf(certify_attractivity(near).rho_star_J), side > 0) << "damping " << trial;
      if (!std::isfinite(a.rho_star_J)) continue;
      ++bounded;
      near = s;  // the largest V in E goes as 1/K, rho* not at all
      near.stiffness *= a.greatest_rest_J / a.rho_star_J * (1 + side * hair);
      EXPECT_EQ(certify_attractivity(near).all_of_E, side > 0) << "E " << trial;
    }
  }
  EXPECT_GT(bounded, 150);
}

// The unstable direction leans out of span{W} by a tenth of a millionth.
TEST(Conditions, OfRandomSystemsSeeTheUnstableColumnLeaveTheSpan) {
  std::mt19937_64 random{43};
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Index n = 2 + trial % 5, m = 1 + trial % (n - 1);
    LinearMachine<> s = random_theorem_1_system(random, n, m);
    VectorXd values = VectorXd::Ones(n);
    values[0] = -0.3;
    for (const double lean : {0.0, 1e-7}) {
      MatrixXd columns = basis_along_directions(s);
      const VectorXd first = columns.col(0), last = columns.col(n - 1);
      columns.col(0) = std::cos(lean) * first + std::sin(lean) * last;
      columns.col(n - 1) = std::cos(lean) * last - std::sin(lean) * first;
      s.damping = from_mass_units(s, with_eigenvalues(columns, values));
      EXPECT_EQ(certify_attractivity(s).certified, lean == 0) << trial;
    }
  }
}

TEST(Conditions, AllowTheUnstableColumnNoDeviationFromTheSpan) {
  for (const auto& [turn, holds] : {std::pair{0.0, true}, {1e-12, true}, {1e-7, false}, {0.1, false}}) {
    LinearMachine<> s = two_mass_example();
    s.directions =
        Eigen::Vector2d{std::cos(turn - 0.25 * 3.141592653589793), std::sin(turn - 0.25 * 3.141592653589793)};
    s.friction_N = VectorXd::Ones(1);
    const Attractivity a = certify_attractivity(s);
    EXPECT_EQ(a.certified, holds) << turn;
    EXPECT_EQ(a.conditions.back().holds, holds);
    EXPECT_GT(a.level_J, 0) << "the damping is positive across the friction: the weaker condition";
  }
}

TEST(Conditions, AtExactlyZeroDampingFrictionAloneIsEnough) {
  LinearMachine<> s = two_mass_example();
  s.damping.setZero();
  const Attractivity a = certify_attractivity(s);
  ASSERT_TRUE(a.certified) << a.reason;
  EXPECT_EQ(a.unstable, 2);
  EXPECT_EQ(a.rho_star_J, infinite);
  s.friction_N[0] = 0;  // now mass 1 and the springs might oscillate for ever, for all that the theorem knows
  EXPECT_FALSE(certify_attractivity(s).certified);
  EXPECT_EQ(certify_attractivity(s).level_J, 0);
}

// C = -I leaves U_c free. Along the frictions sum |eta| <= 1 for |v1| + |v2| <= 1, turned by 45 degrees it is sqrt 2.
TEST(Conditions, ChooseTheBasisOfARepeatedEigenvalue) {
  LinearMachine<> s = two_mass_example();
  for (const double turn : {0.0, 0.3, 0.785}) {
    const Eigen::Matrix2d to{{std::cos(turn), -std::sin(turn)}, {std::sin(turn), std::cos(turn)}};
    s.directions = to;
    s.damping = -to * to.transpose();
    const Attractivity a = certify_attractivity(s);
    ASSERT_TRUE(a.certified);
    EXPECT_NEAR(a.alpha, 1, 1e-9) << turn;
    EXPECT_NEAR(a.rho_star_J, 0.5, 1e-9);
    EXPECT_NEAR(a.level_J, 0.5, 1e-9);
    EXPECT_TRUE((a.eigencolumns.transpose() * a.eigencolumns).isIdentity(1e-14));
  }
}

// Ten equal axes and sixteen frictions have 11,440 corners: the best basis would take a minute to find, and any is
// valid.
TEST(Conditions, TakeABasisThatIsGoodEnoughWhereCornersAreMany) {
  constexpr Eigen::Index n = 10, frictions = 16;
  std::mt19937_64 bits{1};
  std::normal_distribution<> normal;
  LinearMachine<> s;
  s.mass = MatrixXd::Identity(n, n);
  s.damping = -0.01 * s.mass;
  s.stiffness = 2 * s.mass;
  s.directions = MatrixXd::NullaryExpr(n, frictions, [&] { return normal(bits); });
  s.friction_N = VectorXd::Ones(frictions);
  const std::clock_t begin = std::clock();
  const Attractivity a = certify_attractivity(s);
  EXPECT_LT(std::clock() - begin, 20 * CLOCKS_PER_SEC);
  EXPECT_TRUE(a.certified);
  EXPECT_TRUE((a.eigencolumns.transpose() * a.eigencolumns).isIdentity(1e-14));
}

// Remark 3 looks at one corner of E. Where springs couple two frictions the other way, another one is farther.
TEST(Conditions, DoNotTrustRemark3WhereAnotherCornerIsFarther) {
  LinearMachine<> s = two_mass_example();
  EXPECT_NEAR(certify_attractivity(s).remark_3_J, 1, 1e-14);
  s.stiffness << 2, 1.9, 1.9, 2;
  const Attractivity a = certify_attractivity(s);
  EXPECT_NEAR(a.remark_3_J, 1 / 3.9, 1e-13);
  EXPECT_NEAR(a.greatest_rest_J, 10, 1e-12);  // at (1, -1) / 0.1
  s.damping *= 2;
  const Attractivity fed = certify_attractivity(s);
  EXPECT_LT(fed.remark_3_J, fed.rho_star_J);  // 4
  EXPECT_FALSE(fed.all_of_E);
  EXPECT_NEAR(fed.certified_share_of_E(), std::sqrt(4.0 / 10), 1e-12);
}

TEST(Conditions, RefuseBadSystemsByName) {
  const auto refusal = [](auto spoil) {
    LinearMachine<> s = two_mass_example();
    spoil(s);
    const Attractivity a = certify_attractivity(s);
    EXPECT_FALSE(a.certified);
    EXPECT_EQ(a.level_J, 0);
    return a.reason;
  };
  const auto names = [](const std::string& reason, const char* name, const char* what) {
    EXPECT_NE(reason.find(name), std::string::npos) << reason;
    EXPECT_NE(reason.find(what), std::string::npos) << reason;
  };
  const double nan = std::nan("");
  names(refusal([&](LinearMachine<>& s) { s.mass(0, 1) = nan; }), "mass", "finite");
  names(refusal([&](LinearMachine<>& s) { s.damping(1, 1) = infinite; }), "damping", "finite");
  names(refusal([&](LinearMachine<>& s) { s.stiffness(0, 0) = nan; }), "stiffness", "finite");
  names(refusal([&](LinearMachine<>& s) { s.directions(0, 0) = nan; }), "directions", "finite");
  names(refusal([&](LinearMachine<>& s) { s.friction_N[1] = nan; }), "friction_N", "finite");
  names(refusal([](LinearMachine<>& s) { s.friction_N[1] = -1; }), "friction_N[1]", "-1");
  names(refusal([](LinearMachine<>& s) { s.mass(0, 1) = 0.1; }), "mass", "symmetric");
  names(refusal([](LinearMachine<>& s) { s.stiffness(0, 1) = 0.1; }), "stiffness", "symmetric");
  names(refusal([](LinearMachine<>& s) { s.mass(0, 0) = -1; }), "mass", "positive definite");
  names(refusal([](LinearMachine<>& s) { s.stiffness(0, 0) = 0; }), "stiffness", "positive definite");
  names(refusal([](LinearMachine<>& s) { s.damping = MatrixXd::Zero(3, 3); }), "damping", "3 x 3");
  names(refusal([](LinearMachine<>& s) { s.directions = MatrixXd::Zero(3, 2); }), "directions", "3 x 2");
  names(refusal([](LinearMachine<>& s) { s.friction_N = VectorXd::Ones(3); }), "friction_N", "3 x 1");
  names(refusal([](LinearMachine<>& s) { s.mass.resize(0, 0); }), "mass", "empty");
}

TEST(Conditions, TakeTheSymmetricPartOfTheDamping) {
  LinearMachine<> s = two_mass_example();
  s.damping(0, 1) += 0.7;
  s.damping(1, 0) -= 0.7;
  const Attractivity a = certify_attractivity(s);
  ASSERT_TRUE(a.certified);
  EXPECT_NEAR(a.rho_star_J, 16, 1e-13);
  EXPECT_NE(a.conditions[2].reason.find("no work"), std::string::npos);
}

}  // namespace
}  // namespace conditions_test
