// What sticks and what slips: at the very limit of static friction, and of several directions that stop at one instant.
// Every number is one that double holds exactly, each case is asked both ways round, and none depends on the order of
// the directions.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "breakaway/hybrid/event_driven.hpp"

namespace stick_decision_test {
namespace {

using breakaway::hybrid::EventDriven;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::MachineState;
using breakaway::hybrid::Verdict;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd place_after(double time_s, const LinearMachine<>& machine, const VectorXd& q, const VectorXd& v) {
  return EventDriven<>(machine).run(MachineState<Eigen::Dynamic>{0, q, v}, time_s).end.q;
}

// A mass without friction, by a spring of 1 to each of the others, which have a friction of 1.
LinearMachine<> mover_and(Eigen::Index others) {
  const Eigen::Index n = others + 1;
  LinearMachine<> machine{MatrixXd::Identity(n, n),  MatrixXd::Zero(n, n),   MatrixXd::Identity(n, n),
                          MatrixXd::Zero(n, others), VectorXd::Ones(others), VectorXd::Zero(n)};
  machine.stiffness(0, 0) = static_cast<double>(others);
  machine.stiffness.block(0, 1, 1, others).setConstant(-1);
  machine.stiffness.block(1, 0, others, 1).setConstant(-1);
  machine.directions.bottomRows(others).setIdentity();
  return machine;
}

// The spring's force is the limit, to the last digit: whether it grows or falls decides.
TEST(StickDecision, AMassAtItsLimitSlipsWhereTheForceGrowsAndSticksWhereItFalls) {
  for (const double side : {1.0, -1.0}) {
    const VectorXd grown = place_after(0.125, mover_and(1), Vector2d{side, 0}, Vector2d{side, 0});
    EXPECT_NEAR(side * grown[1], 0.125 * 0.125 * 0.125 / 6, 2e-5);
    EXPECT_EQ(place_after(0.125, mover_and(1), Vector2d{side, 0}, Vector2d{-side, 0})[1], 0);
    EXPECT_EQ(place_after(0.125, mover_and(1), Vector2d{side, 0}, Vector2d{0, 0})[1], 0);
  }
}

TEST(StickDecision, OfTwoMassesAtTheirLimitsOnlyTheOneSlipsThatIsPulledFurther) {
  for (const double way : {1.0, -1.0}) {
    const VectorXd q = place_after(0.125, mover_and(2), Vector3d{1, 0, 2}, Vector3d{way, 0, 0});
    EXPECT_NEAR(way > 0 ? q[1] : 2 - q[2], 0.125 * 0.125 * 0.125 / 6, 3e-5) << way;
    EXPECT_EQ(way > 0 ? q[2] : q[1], way > 0 ? 2 : 0) << way;
  }
}

TEST(StickDecision, TwoMassesThatArePulledFurtherBothSlip) {
  for (const double side : {1.0, -1.0}) {
    const VectorXd q = place_after(0.125, mover_and(2), Vector3d{side, 0, 0}, Vector3d{side, 0, 0});
    EXPECT_GT(side * q[1], 1e-4);
    EXPECT_EQ(q[1], q[2]);
  }
}

// A block that lies on another one, which lies on the ground, in two orders of their frictions.
LinearMachine<> stack(double between_N, double ground_N, double pull_N, bool swapped, bool pulls_the_lower) {
  LinearMachine<> machine{MatrixXd::Identity(2, 2), MatrixXd::Zero(2, 2), MatrixXd::Zero(2, 2),
                          MatrixXd::Zero(2, 2),     VectorXd::Zero(2),    VectorXd::Zero(2)};
  const int between = swapped ? 1 : 0;
  machine.directions.col(between) = Vector2d{1, -1};
  machine.directions.col(1 - between) = Vector2d{0, 1};
  machine.friction_N[between] = between_N;
  machine.friction_N[1 - between] = ground_N;
  machine.force_N[pulls_the_lower ? 1 : 0] = pull_N;
  return machine;
}

struct Pull {
  const char* label;
  double between_N, ground_N, pull_N;
  bool pulls_the_lower;
  double upper_m_s2, lower_m_s2;
};

class AStackThatIsPulled : public ::testing::TestWithParam<Pull> {};

TEST_P(AStackThatIsPulled, SticksAndSlipsAsItsFrictionsSay) {
  const Pull& p = GetParam();
  for (const double side : {1.0, -1.0}) {
    for (const bool swapped : {false, true}) {
      const LinearMachine<> machine = stack(p.between_N, p.ground_N, side * p.pull_N, swapped, p.pulls_the_lower);
      const VectorXd q = place_after(2, machine, VectorXd::Zero(2), VectorXd::Zero(2));
      EXPECT_NEAR(side * q[0], 2 * p.upper_m_s2, 1e-12) << side << swapped;
      EXPECT_NEAR(side * q[1], 2 * p.lower_m_s2, 1e-12) << side << swapped;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Of, AStackThatIsPulled,
                         ::testing::Values(Pull{"AllSticks", 2, 1, 0.5, false, 0, 0},
                                           Pull{"AllSticksAtTheGroundsLimit", 2, 1, 1, false, 0, 0},
                                           Pull{"AllSticksAtBothLimits", 1, 1, 1, false, 0, 0},
                                           Pull{"TheUpperSlips", 1, 2, 2.5, false, 1.5, 0},
                                           Pull{"TheUpperSlipsAndTheLowerIsAtItsLimit", 1, 1, 2.5, false, 1.5, 0},
                                           Pull{"BothSlipTogether", 2, 1, 2, false, 0.5, 0.5},
                                           Pull{"BothSlipApart", 2, 1, 4, false, 2, 1},
                                           Pull{"TheLowerTakesTheUpperAlong", 2, 1, 3, true, 1, 1},
                                           Pull{"TheLowerSlipsUnderTheUpper", 0.5, 1, 3, true, 0.5, 1.5}),
                         [](const auto& param_info) { return std::string{param_info.param.label}; });

// Both stop at one instant, and only one of them goes on, backwards.
TEST(StickDecision, OfTwoMassesThatStopAtOneInstantTheOneGoesBackThatItsForceOvercomes) {
  for (const double side : {1.0, -1.0}) {
    for (const bool swapped : {false, true}) {
      LinearMachine<> machine{MatrixXd::Identity(2, 2), MatrixXd::Zero(2, 2), MatrixXd::Zero(2, 2),
                              MatrixXd::Identity(2, 2), VectorXd::Zero(2),    VectorXd::Zero(2)};
      // Decelerations of 4 and 4: 1 of friction and 3 of force, and 3 and 1.
      machine.friction_N = swapped ? Vector2d{3, 1} : Vector2d{1, 3};
      machine.force_N = side * (swapped ? Vector2d{-1, -3} : Vector2d{-3, -1});
      const VectorXd q = place_after(2, machine, VectorXd::Zero(2), side * Vector2d{4, 4});
      // They stop at 2 after 1 s; then one goes back with 3 - 1.
      EXPECT_NEAR(side * q[swapped ? 1 : 0], 1, 1e-12);
      EXPECT_NEAR(side * q[swapped ? 0 : 1], 2, 1e-12);
    }
  }
}

}  // namespace
}  // namespace stick_decision_test
