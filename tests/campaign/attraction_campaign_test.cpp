// Theorem 1 against simulation, on many random machines: no motion from inside the certified level leaves it or fails
// to reach the equilibrium set. Each machine depends on its number only, so that any one of them can be run again:
//   BREAKAWAY_FIRST_SYSTEM=0 BREAKAWAY_SYSTEMS=100000 tests/campaign/attraction_campaign_test
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <sstream>
#include <string>

#include "../unit/stability/random_systems.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "environment.hpp"

namespace {

using namespace breakaway;
using campaign::from_environment;
using Eigen::Index;
using State = hybrid::MachineState<Eigen::Dynamic>;

template <class Matrix>
std::string rows(const Matrix& matrix) {
  std::ostringstream text;
  text.precision(17);
  for (Index i = 0; i < matrix.rows(); ++i) {
    text << (i == 0 ? "[[" : ", [");
    for (Index j = 0; j < matrix.cols(); ++j) text << (j == 0 ? "" : ", ") << matrix(i, j);
    text << "]";
  }
  return text.str() + "]";
}

std::string row(const Eigen::VectorXd& vector) {
  const std::string text = rows(vector.transpose());
  return text.substr(1, text.size() - 2);
}

// A scenario that shows the failure again.
std::string scenario(const stability::LinearMachine<>& m, const State& start, double end_s) {
  return "[machine]\nmass = " + rows(m.mass) + "\ndamping = " + rows(m.damping) + "\nstiffness = " + rows(m.stiffness) +
         "\ndirections = " + rows(m.directions) + "\nfriction_N = " + row(m.friction_N) +
         "\n[start]\nq = " + row(start.q) + "\nv = " + row(start.v) + "\n[run]\nduration_s = " + std::to_string(end_s) +
         "\n";
}

struct Trial {
  stability::LinearMachine<> machine;
  State start;
  double level_J = 0;
};

// Up to 6 coordinates and 6 frictions; every third machine satisfies only the weaker condition.
Trial trial(long number) {
  std::mt19937_64 random{static_cast<std::uint64_t>(number)};
  std::uniform_int_distribution<Index> size{1, 6};
  const Index n = size(random), m = size(random);
  Trial t;
  t.machine =
      number % 3 == 2 ? stability::random_weak_system(random, n, m) : stability::random_theorem_1_system(random, n, m);
  const stability::Attractivity a = stability::certify_attractivity(t.machine);
  t.level_J = a.level_J;
  t.start = {0, stability::random_matrix(random, n, 1), stability::random_matrix(random, n, 1)};
  const double wanted_J = std::isinf(a.level_J) ? 20 * a.greatest_rest_J + 1 : 0.9999 * a.level_J;
  const double scale = std::sqrt(wanted_J / stability::energy_J(t.machine, t.start));
  t.start.q *= scale;
  t.start.v *= scale;
  return t;
}

// Long enough for a motion that leaves the border of its level as slowly as the weakest damping, of either sign, lets
// it.
double patience_s(const stability::LinearMachine<>& m) {
  const Eigen::MatrixXd damping = m.damping + m.damping.transpose();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> rates{damping / 2, m.mass, Eigen::EigenvaluesOnly};
  return std::max(2000.0, 50 / rates.eigenvalues().cwiseAbs().minCoeff());
}

// In E as far as double precision can tell. A machine that friction does not hold in every direction comes to rest only
// asymptotically: it is not followed into the rounding of its springs.
bool in_equilibrium(const Trial& t, const stability::EquilibriumSet& set, const State& state) {
  const double kinetic_J = 0.5 * state.v.dot(t.machine.mass * state.v);
  return kinetic_J <= 1e-20 * stability::energy_J(t.machine, t.start) && set.gauge(state.q, 1e-6) <= 1 + 1e-8;
}

// A few motions of millions of vibrations are followed to their rest, too.
constexpr double patient_work = 1e12;

// Empty, or what went wrong.
std::string failure(const Trial& t, double end_s) {
  double before_J = stability::energy_J(t.machine, t.start);
  std::string wrong;
  const auto set = stability::EquilibriumSet::make(t.machine);
  const auto arrived = [&](const State& state) {
    return in_equilibrium(t, set, state) ? hybrid::Verdict::captured : hybrid::Verdict::undecided;
  };
  const hybrid::EventDriven<> integrator{t.machine, arrived};
  const auto watch = [&](const State& state) {
    const double now_J = stability::energy_J(t.machine, state);
    if (!(now_J <= before_J * (1 + 1e-9))) wrong = "the energy grew at " + std::to_string(state.time_s) + " s";
    if (!(now_J < t.level_J)) wrong = "it left the level at " + std::to_string(state.time_s) + " s";
    before_J = now_J;
  };
  const auto outcome = integrator.run(t.start, end_s, nullptr, watch, hybrid::Budget{patient_work});
  if (!wrong.empty()) return wrong;
  if (outcome.verdict == hybrid::Verdict::at_rest || outcome.verdict == hybrid::Verdict::captured) return "";
  if (in_equilibrium(t, set, outcome.end)) return "";
  return "it is not at rest";
}

TEST(AttractionCampaign, NoMotionLeavesItsCertificate) {
  const long first = from_environment("BREAKAWAY_FIRST_SYSTEM", 0),
             count = from_environment("BREAKAWAY_SYSTEMS", 10'000);
  long certified = 0;
  for (long number = first; number < first + count; ++number) {
    const Trial t = trial(number);
    const double end_s = patience_s(t.machine);
    ASSERT_GT(t.level_J, 0) << "machine " << number << " is made to be certified";
    ++certified;
    std::string wrong;
    try {
      wrong = failure(t, end_s);
    } catch (const std::exception& error) {
      wrong = error.what();
    }
    EXPECT_EQ(wrong, "") << "# machine " << number << "\n" << scenario(t.machine, t.start, end_s);
  }
  std::printf("%ld machines, all certified, each followed from the border of its level\n", certified);
}

}  // namespace
