// Certificates against long simulations: what is called captured comes to rest, what is called lost never does.
#include "breakaway/sil/certificates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/scenario/machine_scenario.hpp"

namespace {

using namespace breakaway;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sil::ProvenFate;
using State = hybrid::MachineState<Eigen::Dynamic>;

MatrixXd random_matrix(std::mt19937_64& random, Index rows, Index columns) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// Positive definite mass and stiffness, damping with some negative direction, a friction for each coordinate.
stability::LinearMachine<> random_machine(std::mt19937_64& random, Index n) {
  const MatrixXd mass = random_matrix(random, n, n), stiffness = random_matrix(random, n, n);
  const MatrixXd damping = random_matrix(random, n, n);
  stability::LinearMachine<> m;
  m.mass = mass * mass.transpose() + MatrixXd::Identity(n, n);
  m.stiffness = stiffness * stiffness.transpose() + MatrixXd::Identity(n, n);
  m.damping = 0.3 * (damping + damping.transpose()) - 0.1 * MatrixXd::Identity(n, n);
  m.directions = random_matrix(random, n, n);
  m.friction_N = random_matrix(random, n, 1).cwiseAbs() + VectorXd::Constant(n, 0.1);
  return m;
}

double mode_size(const stability::EscapeLevel& mode, const State& state) {
  VectorXd x(2 * state.q.size());
  x << state.q, state.v;
  return std::hypot(mode.real.dot(x), mode.imaginary.dot(x));
}

// V falls without end where stiffness is negative, and is below every level there.
TEST(Certificates, CaptureNothingWhereNothingIsProved) {
  std::mt19937_64 random{4};
  for (int trial = 0; trial < 60; ++trial) {
    auto m = random_machine(random, 2 + trial % 2);
    m.stiffness(0, 0) = -1;
    const auto certificates = sil::certify(m);
    ASSERT_FALSE(certificates.attractivity.certified);
    const ProvenFate<Eigen::Dynamic> fate(m, certificates);
    for (int i = 0; i < 20; ++i) {
      State start{0, 10 * random_matrix(random, m.coordinates(), 1), random_matrix(random, m.coordinates(), 1)};
      EXPECT_NE(fate(start), hybrid::Verdict::captured) << "trial " << trial;
    }
  }
}

TEST(Certificates, WhatIsCapturedComesToRest) {
  std::mt19937_64 random{3};
  for (int trial = 0; trial < 60; ++trial) {
    const auto m = random_machine(random, 2 + trial % 2);
    const auto certificates = sil::certify(m);
    ASSERT_TRUE(certificates.attractivity.certified) << certificates.attractivity.reason;
    const double rho_J = std::min(certificates.attractivity.rho_star_J, 1e3);
    State start{0, random_matrix(random, m.coordinates(), 1), random_matrix(random, m.coordinates(), 1)};
    const double scale = std::sqrt(0.99 * rho_J / stability::energy_J(m, start));
    start.q *= scale;
    start.v *= scale;
    ASSERT_EQ(ProvenFate<Eigen::Dynamic>(m, certificates)(start), hybrid::Verdict::captured);
    const auto outcome = hybrid::EventDriven<>{m}.run(start, 1e5);
    EXPECT_EQ(outcome.verdict, hybrid::Verdict::at_rest) << "trial " << trial;
  }
}

TEST(Certificates, WhatIsLostGrowsForEver) {
  std::mt19937_64 random{5};
  int unstable = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto m = random_machine(random, 2 + trial % 2);
    const auto certificates = sil::certify(m);
    if (certificates.escapes.empty()) continue;
    // The fastest: the rounding of its growth soon exceeds what a slower one holds.
    const stability::EscapeLevel& mode =
        *std::ranges::max_element(certificates.escapes, {}, &stability::EscapeLevel::growth_rate);
    ++unstable;
    State start{0, random_matrix(random, m.coordinates(), 1), random_matrix(random, m.coordinates(), 1)};
    const double scale = 1.001 * mode.level / mode_size(mode, start);
    start.q *= scale;
    start.v *= scale;
    ASSERT_EQ(ProvenFate<Eigen::Dynamic>(m, certificates)(start), hybrid::Verdict::lost);
    double last = 0;
    // |z| - level grows at least as e^(growth t): from 1e-3 to 1e5 levels.
    const auto outcome = hybrid::EventDriven<>{m}.run(start, 20 / mode.growth_rate, nullptr, [&](const State& s) {
      EXPECT_GE(mode_size(mode, s), last * (1 - 1e-10)) << "trial " << trial;
      last = mode_size(mode, s);
    });
    EXPECT_NE(outcome.verdict, hybrid::Verdict::at_rest) << "trial " << trial;
    EXPECT_GT(last, 1e5 * mode.level) << "trial " << trial;
  }
  EXPECT_GT(unstable, 30);
}

// A start just inside the border of a fall returns, one just outside is called lost: for a real mode nothing is given
// away.
TEST(Certificates, LoseNothingThatReturnsFromAFall) {
  stability::LinearMachine<> m;
  m.mass = MatrixXd::Constant(1, 1, 2);
  m.damping = MatrixXd::Zero(1, 1);
  m.stiffness = MatrixXd::Constant(1, 1, -8);
  m.directions = MatrixXd::Ones(1, 1);
  m.friction_N = VectorXd::Constant(1, 4);
  const ProvenFate<Eigen::Dynamic> fate{m, sil::certify(m)};
  const auto from_speed = [](double v) { return State{0, VectorXd::Zero(1), VectorXd::Constant(1, v)}; };
  EXPECT_EQ(fate(from_speed(1 + 1e-8)), hybrid::Verdict::lost);  // (f / m) / s = 1
  EXPECT_EQ(fate(from_speed(1 - 1e-8)), hybrid::Verdict::undecided);
  EXPECT_EQ(hybrid::EventDriven<>{m}.run(from_speed(1 - 1e-8), 100).verdict, hybrid::Verdict::at_rest);
}

}  // namespace
