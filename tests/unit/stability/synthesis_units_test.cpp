// One machine in two systems of units has the same gains.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "../refusal.hpp"
#include "breakaway/stability/synthesis.hpp"
#include "random_systems.hpp"
#include "unit_twin.hpp"

namespace synthesis_units_test {
namespace {

using namespace breakaway::stability;
using breakaway::testing::refusal;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double reach = 20;  // powers of two: coordinates differ by up to 1e12, masses by 1e24

bool sdpa_is_there() { return std::system("command -v sdpa > /dev/null") == 0; }

ActuatedSystem actuated(std::mt19937_64& random, Index n, Index k, Index m) {
  ActuatedSystem s;
  const MatrixXd mass = random_matrix(random, n, n), stiff = random_matrix(random, n, n),
                 c = random_matrix(random, n, n);
  s.machine.mass = mass * mass.transpose() + MatrixXd::Identity(n, n);
  s.machine.stiffness = stiff * stiff.transpose() + MatrixXd::Identity(n, n);
  for (MatrixXd* const matrix : {&s.machine.mass, &s.machine.stiffness})
    *matrix = (*matrix + matrix->transpose()).eval() / 2;
  s.machine.damping = c + c.transpose();
  s.machine.directions = random_matrix(random, n, m);
  s.machine.friction_N = random_matrix(random, m, 1).cwiseAbs().array() + 0.1;
  s.actuators = random_matrix(random, n, k);
  return s;
}

// The norm that is made small, 1/s: that of F2 in mass units, with actuators of unit length.
double scaled_norm(const ActuatedSystem& s, const PdGains& gains) {
  const VectorXd coordinate = s.machine.mass.diagonal().cwiseSqrt().cwiseInverse();
  const VectorXd lever = (coordinate.asDiagonal() * s.actuators).colwise().norm();
  const MatrixXd scaled = lever.asDiagonal() * gains.velocity_Ns_per_m * coordinate.asDiagonal();
  return scaled.operatorNorm();
}

struct Answer {
  PdDesign design;
  std::string refused;
};

Answer answer(const ActuatedSystem& s, const PdWants& wants, GainStructure structure) {
  Answer result;
  result.refused = refusal([&] { result.design = synthesize(s, wants, structure); });
  return result;
}

// With a resting error that needs gains of position, a region, or everything, in turn.
void compare(GainStructure structure, bool powers, int trials, double tolerance) {
  std::mt19937_64 random{91};
  int met = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Index n = 1 + trial % 4, m = 1 + trial % 5, k = structure == GainStructure::full && trial % 3 > 0 ? n : 1;
    const ActuatedSystem s = actuated(random, n, structure == GainStructure::identical ? n : k, m);
    PdWants wants{.resting_error_m = trial % 2 == 0 ? 0.5 : infinite, .region_J = trial % 4 == 1 ? infinite : 1.0};
    wants.unit = VectorXd::Ones(n);
    const Answer given = answer(s, wants, structure);
    OtherUnits units = random_units(random, n, s.actuators.cols(), reach, powers);
    if (structure == GainStructure::identical) units.actuator.setOnes();  // one gain, in one unit
    wants.unit = wants.unit.cwiseQuotient(units.length);
    wants.region_J *= units.force;
    const Answer twin = answer(units.system(s), wants, structure);
    SCOPED_TRACE("trial " + std::to_string(trial));
    ASSERT_EQ(given.refused.empty(), twin.refused.empty()) << given.refused << " : " << twin.refused;
    if (!given.refused.empty()) continue;
    ++met;
    const MatrixXd position = units.position_gain(given.design.gains.position_N_per_m),
                   velocity = units.velocity_gain(given.design.gains.velocity_Ns_per_m);
    const auto& found = twin.design;
    if (powers) {
      EXPECT_EQ(found.gains.position_N_per_m, position);
      EXPECT_EQ(found.gains.velocity_Ns_per_m, velocity);
      EXPECT_EQ(found.attractivity.rho_star_J, given.design.attractivity.rho_star_J * units.force);
      EXPECT_EQ(found.reach_m, given.design.reach_m);
      continue;
    }
    const double rate = scaled_norm(s, given.design.gains);
    EXPECT_NEAR(scaled_norm(units.system(s), found.gains) / units.time, rate, tolerance * rate);
    ASSERT_EQ(std::isinf(found.reach_m), std::isinf(given.design.reach_m));
    if (std::isinf(found.reach_m)) continue;
    EXPECT_NEAR(found.attractivity.rho_star_J / units.force / given.design.attractivity.rho_star_J, 1, tolerance);
    EXPECT_NEAR(found.reach_m / given.design.reach_m, 1, tolerance);
  }
  EXPECT_GT(met, trials / 3);
}

TEST(SynthesisUnits, OfPowersOfTwoChangeNoBitOfIdenticalGains) { compare(GainStructure::identical, true, 40, 0); }

TEST(SynthesisUnits, ChangeNoIdenticalGain) { compare(GainStructure::identical, false, 40, 1e-7); }

TEST(SynthesisUnits, OfPowersOfTwoChangeNoBitOfFullGains) {
  if (!sdpa_is_there()) GTEST_SKIP() << "sdpa is not installed";
  compare(GainStructure::full, true, 5, 0);
}

// The solver stops at seven digits; of several gains that are as good as each other it takes one in between.
TEST(SynthesisUnits, ChangeNoFullGain) {
  if (!sdpa_is_there()) GTEST_SKIP() << "sdpa is not installed";
  compare(GainStructure::full, false, 5, 1e-4);
}

// Masses of 1000 kg and 1e-12 kg: 0.01 of the second one's damping is as much a matter of its mass as of the first's.
TEST(SynthesisUnits, LeaveALightUnstableMassNoLessGain) {
  ActuatedSystem s;
  s.machine.mass = Eigen::Vector2d{1e3, 1e-12}.asDiagonal();
  s.machine.damping = Eigen::Vector2d{1e4, -1e-12}.asDiagonal();
  s.machine.stiffness = Eigen::Vector2d{1e6, 1e-6}.asDiagonal();
  s.machine.directions = s.actuators = Eigen::Matrix2d::Identity();
  s.machine.friction_N = Eigen::Vector2d{1, 1e-15};
  const PdDesign design = synthesize(s, {.region_J = infinite}, GainStructure::identical);
  // By hand: -1 + d = 1e-3 * |C| in mass units, |C|^2 = 10^2 + 1.
  EXPECT_NEAR(design.gains.velocity_Ns_per_m(1, 1) / (1e-12 * (1 + 0.99e-3 * std::sqrt(101.0))), 1, 1e-7);
}

}  // namespace
}  // namespace synthesis_units_test
