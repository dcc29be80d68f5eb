#include "breakaway/stability/pd_design.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "../refusal.hpp"
#include "breakaway/stability/lmi.hpp"
#include "breakaway/stability/synthesis.hpp"
#include "two_mass_example.hpp"

namespace pd_design_test {
namespace {

using namespace breakaway::stability;
using breakaway::testing::refusal;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(std::mt19937_64& random, Eigen::Index rows, Eigen::Index columns) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

Condition named(const std::vector<Condition>& conditions, const std::string& name) {
  for (const Condition& condition : conditions) {
    if (condition.name == name) return condition;
  }
  ADD_FAILURE() << "no condition " << name;
  return {};
}

Condition stabilizable(const LinearMachine<>& machine, const MatrixXd& actuators) {
  return named(machine_conditions({machine, actuators}), "stabilizable");
}

// The damping of the example has the unstable direction (1, -1).
TEST(PdConditions, NameTheDirectionThatNothingActsOn) {
  LinearMachine<> machine = two_mass_example();
  machine.directions = Eigen::Vector2d{1, 1};
  machine.friction_N = VectorXd::Ones(1);
  const Condition neither = stabilizable(machine, Eigen::Vector2d{2, 2});
  EXPECT_FALSE(neither.holds);
  EXPECT_NE(neither.reason.find("(0.70711, -0.70711)"), std::string::npos) << neither.reason;
  EXPECT_NE(neither.reason.find("-0.25"), std::string::npos) << neither.reason;
  EXPECT_TRUE(stabilizable(machine, Eigen::Vector2d{1, 0}).holds) << "an actuator may do it";
  machine.directions = Eigen::Vector2d{0, 1};
  EXPECT_TRUE(stabilizable(machine, Eigen::Vector2d{2, 2}).holds) << "or friction";
  machine.friction_N.setZero();
  EXPECT_FALSE(stabilizable(machine, Eigen::Vector2d{2, 2}).holds) << "but none without force";
  machine.damping = Eigen::Matrix2d{{1, 0}, {0, 2}};
  EXPECT_TRUE(stabilizable(machine, Eigen::Vector2d{2, 2}).holds) << "a damped machine needs nothing";
}

// By construction: w^T C = mu w^T with mu <= 0 and w orthogonal to all of W and S.
TEST(PdConditions, FindThePlantedDirectionInRandomSystems) {
  std::mt19937_64 random{3};
  for (Eigen::Index n = 2; n <= 6; ++n) {
    MatrixXd left = random_matrix(random, n, n);
    const VectorXd hidden = left.row(0).normalized();
    VectorXd mu = random_matrix(random, n, 1).cwiseAbs().array() + 0.5;
    mu[0] = -0.3;
    LinearMachine<> machine;
    machine.mass = machine.stiffness = MatrixXd::Identity(n, n);
    machine.damping = left.inverse() * mu.asDiagonal() * left;
    const MatrixXd across = MatrixXd::Identity(n, n) - hidden * hidden.transpose();
    machine.directions = across * random_matrix(random, n, 2);
    machine.friction_N = VectorXd::Ones(2);
    const MatrixXd actuators = across * random_matrix(random, n, 1);
    const Condition condition = stabilizable(machine, actuators);
    EXPECT_FALSE(condition.holds) << n;
    // The direction is printed to five digits.
    double largest = 0, printed = 0;
    for (const double entry : hidden) largest = std::abs(entry) > std::abs(largest) ? entry : largest;
    ASSERT_NE(condition.reason.find('('), std::string::npos);
    printed = std::strtod(condition.reason.c_str() + condition.reason.find('(') + 1, nullptr);
    EXPECT_NEAR(printed, hidden[0] * (largest > 0 ? 1 : -1), 1e-5) << condition.reason;
    EXPECT_TRUE(stabilizable(machine, actuators + 1e-3 * hidden).holds) << n;
  }
}

TEST(PdConditions, NameTheStiffnessThatNoActuatorReaches) {
  LinearMachine<> machine = two_mass_example();
  machine.stiffness << 2, 0, 0, -3;
  const auto conditions = machine_conditions({machine, Eigen::Vector2d{1, 0}});
  const Condition positive = named(conditions, "stiffness_positive");
  EXPECT_FALSE(positive.holds);
  EXPECT_NEAR(positive.margin, -3, 1e-9);
  EXPECT_NE(positive.reason.find("(0, 1)"), std::string::npos) << positive.reason;
  EXPECT_TRUE(named(machine_conditions({machine, Eigen::Vector2d{0, 1}}), "stiffness_positive").holds);
  const std::string refused = refusal([&] {
    synthesize({machine, Eigen::Vector2d{1, 0}}, {.resting_error_m = 1}, GainStructure::full);
  });
  EXPECT_NE(refused.find("stiffness_positive"), std::string::npos) << refused;

  machine.stiffness << 1, 1, 0, 1;
  const MatrixXd none = MatrixXd::Zero(2, 1);
  EXPECT_FALSE(named(machine_conditions({machine, none}), "stiffness_symmetric").holds);
  EXPECT_TRUE(named(machine_conditions({machine, Eigen::Vector2d{1, 0}}), "stiffness_symmetric").holds);
}

TEST(PdConditions, OfTheLoopAreThoseOfSection5) {
  LinearMachine<> closed = two_mass_example();
  for (const Condition& condition : loop_conditions(closed)) EXPECT_TRUE(condition.holds) << condition.reason;
  closed.directions = Eigen::Vector2d{1, 0};
  closed.friction_N = VectorXd::Ones(1);
  const Condition span = named(loop_conditions(closed), "eigencolumns in span W");
  EXPECT_FALSE(span.holds);
  EXPECT_NE(span.reason.find("0.70711"), std::string::npos) << span.reason;
  // Stabilizable all the same: [A] takes the two for equivalent, and they are not.
  EXPECT_TRUE(stabilizable(closed, MatrixXd::Zero(2, 1)).holds);
  closed.stiffness << 1, -2, -2, 1;
  EXPECT_FALSE(named(loop_conditions(closed), "K_cl positive definite").holds);
  closed.damping(0, 1) += 0.1;
  EXPECT_FALSE(named(loop_conditions(closed), "C_cl symmetric").holds);
}

// (24) with p1 = 1: K_cl = [2, -1; -1, 2], so A = -[2, 1; 1, 2] / 3, of eigenvalues -1 and -1/3.
TEST(Theorem2, HoldsForTheGainsOfTheExample) {
  LinearMachine<> machine = two_mass_example();
  machine.stiffness << 1, -1, -1, 1;
  const Theorem2 t = verify_theorem_2({machine, MatrixXd::Identity(2, 2)}, MatrixXd::Identity(2, 2));
  EXPECT_TRUE(t.A.isApprox(Eigen::Matrix2d{{-2, -1}, {-1, -2}} / 3, 1e-14));
  EXPECT_TRUE((t.Y * t.A.inverse()).isApprox(MatrixXd::Identity(2, 2), 1e-14));  // F1 = Y A^-1
  EXPECT_NEAR(t.hurwitz, 1.0 / 3, 1e-13);
  EXPECT_NEAR(t.lmi, 2, 1e-13);
  const Theorem2 unstable = verify_theorem_2({machine, MatrixXd::Identity(2, 2)}, -MatrixXd::Identity(2, 2));
  EXPECT_LT(unstable.hurwitz, 0) << "K_cl = [0, -1; -1, 0] is indefinite";
}

TEST(LeastEigenvalue, IsProvenJustBelowTheTrueOne) {
  std::mt19937_64 random{4};
  for (Eigen::Index n = 1; n <= 20; ++n) {
    // A reflection has no rounding to speak of: the least eigenvalue of H diag H is that of the diagonal.
    const VectorXd u = random_matrix(random, n, 1).normalized();
    const MatrixXd h = MatrixXd::Identity(n, n) - 2 * u * u.transpose();
    const VectorXd values = random_matrix(random, n, 1);
    const MatrixXd a = h * values.asDiagonal() * h;
    const double proven = proven_least_eigenvalue((a + a.transpose()) / 2), size = values.norm();
    EXPECT_LT(proven, values.minCoeff() + 1e-15 * size);
    EXPECT_GT(proven, values.minCoeff() - 1e-12 * size);
  }
  EXPECT_LT(proven_least_eigenvalue(MatrixXd::Ones(3, 3)), 0) << "singular is not positive definite";
}

// min x1 + x2 with [x1, 1; 1, x2] >= 0 is 2 at (1, 1), and 0.5 + 2 with x1 <= 0.5.
TEST(Lmi, FindsTheMinimum) {
  if (std::system("command -v sdpa > /dev/null") != 0) GTEST_SKIP() << "sdpa is not installed";
  LmiProblem problem;
  problem.cost = VectorXd::Ones(2);
  problem.matrices = {
      {Eigen::Matrix2d{{0, 1}, {1, 0}}, {{0, Eigen::Matrix2d{{1, 0}, {0, 0}}}, {1, Eigen::Matrix2d{{0, 0}, {0, 1}}}}}};
  const auto free = minimised(problem);
  EXPECT_TRUE(free.isApprox(VectorXd::Ones(2), 1e-6)) << free.transpose();
  problem.rows = Eigen::RowVector2d{-1, 0};
  problem.offsets = VectorXd::Constant(1, 0.5);
  const auto bound = minimised(problem);
  EXPECT_NEAR(bound[0], 0.5, 1e-6);
  EXPECT_NEAR(bound[1], 2, 1e-5);
  problem.offsets[0] = -1;  // x1 <= -1 contradicts the matrix
  const std::string none = refusal([&] { minimised(problem); });
  EXPECT_NE(none.find("no solution"), std::string::npos) << none;
}

TEST(Lmi, NamesTheSolverThatIsNotThere) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const LmiProblem problem{VectorXd::Ones(1), {{MatrixXd::Zero(1, 1), {{0, MatrixXd::Ones(1, 1)}}}}, {}, {}};
  const std::string message = refusal([&] { minimised(problem); });
  setenv("PATH", path.c_str(), 1);
  EXPECT_NE(message.find("install the package sdpa"), std::string::npos) << message;
}

}  // namespace
}  // namespace pd_design_test
