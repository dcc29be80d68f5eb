// Certificates that were made wrong on purpose have to be found out by the motions that they are about.
#include "breakaway/sil/contradiction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../refusal.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/sil/run_machine.hpp"
#include "two_masses.hpp"

namespace {

using namespace breakaway;
using breakaway::testing::refusal;
using State = hybrid::MachineState<Eigen::Dynamic>;

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Case {
  scenario::MachineScenario scenario = two_masses();
  sil::Certificates certificates = sil::certify(scenario.machine);

  std::string refused_from(double q1, double q2, double end_s = 20) const {
    const State start{0, Eigen::Vector2d{q1, q2}, Eigen::Vector2d::Zero()};
    const auto outcome = hybrid::EventDriven<>{scenario.machine}.run(start, end_s);
    return refusal([&] { sil::require_consistent(scenario.machine, certificates, start, outcome); });
  }
};

TEST(Contradiction, IsNoneWhereTheCertificatesAreRight) {
  const Case right;
  EXPECT_EQ(refusal([&] { sil::require_consistent(right.scenario.machine, right.certificates); }), "");
  for (const double q : {0.0, 0.5, 2.0, 3.9, 7.0}) EXPECT_EQ(right.refused_from(q, -q), "") << q;
  EXPECT_EQ(right.refused_from(2, -2, 1e-3), "") << "not at rest yet is no contradiction";
}

TEST(Contradiction, OfALevelThatIsTooHighIsTheGrowingEnergy) {
  Case wrong;
  wrong.certificates.attractivity.level_J = infinite;
  const std::string said = wrong.refused_from(7, -7);
  EXPECT_NE(said.find("certified to come to rest"), std::string::npos) << said;
  EXPECT_NE(said.find("energy grew from"), std::string::npos) << said;
  EXPECT_EQ(wrong.refused_from(2, -2), "") << "this motion does come to rest";
  const std::string both = refusal([&] { sil::require_consistent(wrong.scenario.machine, wrong.certificates); });
  EXPECT_NE(both.find("grow for ever, at"), std::string::npos) << both;
}

TEST(Contradiction, OfAnEscapeThatIsTooLowIsTheRest) {
  Case wrong;
  wrong.certificates.attractivity.level_J = 0;
  for (auto& escape : wrong.certificates.escapes) escape.level *= 1e-3;
  const std::string said = wrong.refused_from(2, -2);
  EXPECT_NE(said.find("certified never to come to rest, and was at rest"), std::string::npos) << said;
}

// The region of escape of the example is apart from { V < 16 }, but not by much.
TEST(Contradiction, OfTwoCertificatesBeginsWhereTheirRegionsOverlap) {
  const auto overlap = [](double factor) {
    Case wrong;
    for (auto& escape : wrong.certificates.escapes) escape.level *= factor;
    return !refusal([&] { sil::require_consistent(wrong.scenario.machine, wrong.certificates); }).empty();
  };
  EXPECT_FALSE(overlap(1));
  EXPECT_TRUE(overlap(0.5));
}

TEST(Contradiction, IsFoundWhereAMotionIsNotANumber) {
  Case machine;
  hybrid::Outcome<Eigen::Dynamic> outcome;
  outcome.end = *machine.scenario.start;
  outcome.end.v[0] = std::nan("");
  EXPECT_NE(refusal([&] {
              sil::require_consistent(machine.scenario.machine, machine.certificates, *machine.scenario.start, outcome);
            }),
            "");
}

}  // namespace
