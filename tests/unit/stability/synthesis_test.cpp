#include "breakaway/stability/synthesis.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "../refusal.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "two_mass_example.hpp"

namespace synthesis_test {
namespace {

using namespace breakaway::stability;
using breakaway::testing::refusal;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinite = std::numeric_limits<double>::infinity();

bool sdpa_is_there() { return std::system("command -v sdpa > /dev/null") == 0; }

#define NEEDS_SDPA() \
  if (!sdpa_is_there()) GTEST_SKIP() << "sdpa is not installed"

// Figure 3 of [A]: the masses of the example between u1 and u2 only, K singular and one eigenvalue of C at -0.75.
ActuatedSystem actuated_masses(const MatrixXd& actuators = MatrixXd::Identity(2, 2)) {
  LinearMachine<> machine = two_mass_example(0);
  machine.stiffness << 1, -1, -1, 1;
  return {machine, actuators};
}

MatrixXd random_matrix(std::mt19937_64& random, Eigen::Index rows, Eigen::Index columns) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

ActuatedSystem random_system(std::mt19937_64& random, Eigen::Index n, Eigen::Index k, Eigen::Index m) {
  ActuatedSystem s;
  const MatrixXd mass = random_matrix(random, n, n), c = random_matrix(random, n, n),
                 stiff = random_matrix(random, n, n);
  s.machine.mass = mass * mass.transpose() + MatrixXd::Identity(n, n);
  s.machine.damping = c + c.transpose();
  s.machine.stiffness = stiff + stiff.transpose() + MatrixXd::Identity(n, n);
  s.machine.directions = random_matrix(random, n, m);
  s.machine.friction_N = random_matrix(random, m, 1).cwiseAbs().array() + 0.1;
  s.actuators = random_matrix(random, n, k);
  return s;
}

bool machine_allows(const ActuatedSystem& system) {
  for (const Condition& condition : machine_conditions(system)) {
    if (!condition.holds) return false;
  }
  return true;
}

void expect_verified(const ActuatedSystem& s, const PdDesign& design, const PdWants& wants, const std::string& label) {
  // Nothing of the design is believed: the loop is closed again and asked again.
  const LinearMachine<> closed = closed_loop(s, design.gains);
  for (const Condition& condition : loop_conditions(closed)) {
    EXPECT_TRUE(condition.holds || condition.name == "C_cl symmetric") << label << condition.name << condition.reason;
  }
  EXPECT_LE((closed.damping - closed.damping.transpose()).norm(),
            1e-12 * (s.machine.damping.norm() + closed.damping.norm()));
  const Attractivity a = certify_attractivity(closed);
  EXPECT_TRUE(a.certified && a.all_of_E) << label << a.reason;
  EXPECT_GE(a.rho_star_J, wants.region_J) << label;
  const auto rest = EquilibriumSet::make(closed);
  EXPECT_LE(rest.extent().maxCoeff(), wants.resting_error_m * (1 + 1e-9)) << label;
  const Theorem2 theorem = verify_theorem_2(s, design.gains.position_N_per_m);
  EXPECT_GT(theorem.hurwitz, 0) << label;
  EXPECT_NEAR(theorem.lmi, 2, 1e-6) << label;  // -(K A + A^T K^T + S Y + Y^T S^T) = 2 I by the normalisation
}

TEST(PdSynthesis, SweepsTheDerivativeGainOfFigure4) {
  PdGains gains{MatrixXd::Identity(2, 2), MatrixXd::Identity(2, 2)};
  const auto rows = sweep_velocity_gain(actuated_masses(), gains, {0.3, 0.4, 0.5, 0.6, 0.7, 0.74, 0.75, 0.9});
  const double expected[] = {4.938, 8.163, 16, 44.44, 400, 10000};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(rows[i].rho_star_J / expected[i], 1, 2e-4) << rows[i].velocity_gain_Ns_per_m;
    EXPECT_TRUE(rows[i].E_certified);
  }
  EXPECT_TRUE(std::isinf(rows[6].rho_star_J) && std::isinf(rows[7].rho_star_J));
}

// By hand: E reaches to 1/p1 (26), rho* = 1 / (d1 - 0.75)^2, so rho* = 16 at d1 = 0.5.
TEST(PdSynthesis, FindsTheIdenticalGainsOfTheExample) {
  const auto design = synthesize(actuated_masses(), {.resting_error_m = 1, .region_J = 16}, GainStructure::identical);
  EXPECT_TRUE(design.gains.position_N_per_m.isApprox(MatrixXd::Identity(2, 2), 1e-8));
  EXPECT_TRUE(design.gains.velocity_Ns_per_m.isApprox(0.5 * MatrixXd::Identity(2, 2), 1e-8));
  expect_verified(actuated_masses(), design, {.resting_error_m = 1, .region_J = 16}, "");
  // K_cl = [2, -1; -1, 2] is at most 3 stiff: 3/2 r^2 = 16.
  EXPECT_NEAR(design.reach_m, std::sqrt(32.0 / 3), 1e-7);

  const auto everywhere =
      synthesize(actuated_masses(), {.resting_error_m = 1, .region_J = infinite}, GainStructure::identical);
  EXPECT_NEAR(everywhere.gains.velocity_Ns_per_m(0, 0), 0.75 * (1 + 1e-3), 1e-4);
  EXPECT_TRUE(std::isinf(everywhere.attractivity.rho_star_J));
}

// By hand: K_cl = I/e is the softest with |q_i| <= e, and only the direction (1, -1) of the damping needs any gain.
TEST(PdSynthesis, FindsTheSoftestFullGainsOfTheExample) {
  NEEDS_SDPA();
  const PdWants wants{.resting_error_m = 0.5, .region_J = 16};
  const auto design = synthesize(actuated_masses(), wants, GainStructure::full);
  EXPECT_TRUE(design.closed_loop.stiffness.isApprox(2 * MatrixXd::Identity(2, 2), 1e-5))
      << design.closed_loop.stiffness;
  EXPECT_NEAR(design.gains.velocity_Ns_per_m.operatorNorm(), 0.5, 1e-4) << design.gains.velocity_Ns_per_m;
  EXPECT_NEAR(design.attractivity.eigenvalues[0], -0.25, 1e-4);
  expect_verified(actuated_masses(), design, wants, "");
}

TEST(PdSynthesis, LeavesAMachineAloneThatIsGoodEnough) {
  const ActuatedSystem s{two_mass_example(), MatrixXd::Identity(2, 2)};
  for (const auto structure : {GainStructure::full, GainStructure::identical}) {
    const auto design = synthesize(s, {.resting_error_m = 1, .region_J = 15.9}, structure);
    EXPECT_TRUE(design.gains.position_N_per_m.isZero(0) && design.gains.velocity_Ns_per_m.isZero(0));
  }
}

TEST(PdSynthesis, MeetsAWantedReach) {
  const PdWants wants{.resting_error_m = 0.5, .reach_m = 10};
  for (const auto structure : {GainStructure::full, GainStructure::identical}) {
    if (structure == GainStructure::full && !sdpa_is_there()) continue;
    const auto design = synthesize(actuated_masses(), wants, structure);
    EXPECT_GE(design.reach_m, 10);
    EXPECT_LT(design.reach_m, 10.1) << "more gain than wanted";
    expect_verified(actuated_masses(), design, wants, "");
  }
}

// One actuator on the second mass: no resting error below that of the first mass on its spring alone.
TEST(PdSynthesis, NamesTheBestRestingErrorThatTheActuatorsReach) {
  NEEDS_SDPA();
  const ActuatedSystem s = actuated_masses(Eigen::Vector2d{0, 1});
  const std::string refused = refusal([&] { synthesize(s, {.resting_error_m = 0.9}, GainStructure::full); });
  EXPECT_NE(refused.find("out of reach"), std::string::npos) << refused;
  // The stiffest actuator holds the second mass: q1 = 1 N / (1 N/m), and the number stands in the message.
  EXPECT_NE(refused.find("the best is about 1.00"), std::string::npos) << refused;
  const auto met = synthesize(s, {.resting_error_m = 1.2, .region_J = 2}, GainStructure::full);
  expect_verified(s, met, {.resting_error_m = 1.2, .region_J = 2}, "");
}

TEST(PdSynthesis, MeetsWantsOnRandomSystemsOrSaysWhyNot) {
  NEEDS_SDPA();
  std::mt19937_64 random{5};
  int met = 0, refused = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::Index n = 1 + trial % 5, k = 1 + trial / 5 % n, m = 1 + trial % 6;
    const ActuatedSystem s = random_system(random, n, k, m);
    const std::string label = "trial " + std::to_string(trial) + ": ";
    const PdWants wants{.resting_error_m = 2, .region_J = trial % 3 == 0 ? infinite : 1.0};
    PdDesign design;
    const std::string why = refusal([&] { design = synthesize(s, wants, GainStructure::full); });
    if (why.empty()) {
      ++met;
      expect_verified(s, design, wants, label);
    } else {
      ++refused;
      EXPECT_TRUE(!machine_allows(s) || why.find("out of reach") != std::string::npos ||
                  why.find("no gain of velocity") != std::string::npos)
          << label << why;
    }
  }
  EXPECT_GT(met, 10);
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace synthesis_test
