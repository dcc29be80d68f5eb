// Where double precision does not tell what sticks: a weak slider beside two directions that are nearly parallel. What
// sticks of those two is known to a part of their friction only, and that is more than what pushes the slider is made
// of: whether its acceleration is told from zero hangs on what was rounded.
#include "breakaway/hybrid/mode_choice.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "breakaway/hybrid/refused.hpp"

namespace mode_choice_test {
namespace {

using breakaway::hybrid::Extended;
using breakaway::hybrid::ExtendedVector;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::ModeChoice;
using breakaway::hybrid::Refused;
using breakaway::hybrid::Sliding;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double slider_N = 0x1p-12;

LinearMachine<> machine_of(double angle) {
  LinearMachine<> machine;
  machine.mass = Matrix3d::Identity();
  machine.damping = Matrix3d::Zero();
  machine.stiffness = Matrix3d::Zero();
  machine.directions = (Matrix3d{} << 1, 1, 0.625, 0, angle, 0, 0, 0, 0.75).finished();
  machine.friction_N = Vector3d{1, 1, slider_N};
  return machine;
}

const Vector3d push_N{0x1p-9, 0, 0x1p-10};

ModeChoice::Stop stop_of(const LinearMachine<>& machine, double side, double rounding_N, double applied_rounding_N) {
  return {0.5,
          ExtendedVector::Zero(3),
          ExtendedVector::Zero(3),
          (side * push_N).cast<Extended>(),
          VectorXd::Constant(3, rounding_N),
          VectorXd::Constant(3, applied_rounding_N),
          {0, 1, 2},
          machine.friction_N,
          machine.friction_N};
}

// The first two hold what the slider does not of the push along the first coordinate.
constexpr double held_N = 0x1p-9 - 0.625 * slider_N;

void expect_the_slider_alone(const Sliding& sliding, double side) {
  EXPECT_EQ(sliding.signs, (Vector3d{0, 0, side}));
  EXPECT_NEAR(sliding.force_N[0] + sliding.force_N[1], -side * held_N, 1e-8);
  EXPECT_EQ(sliding.force_N[2], -side * slider_N);
}

TEST(ModeChoice, SlidesWhatForcesThatAreKnownMove) {
  for (const double side : {1.0, -1.0}) {
    for (const double angle : {0x1p-18, 0x1p-20}) {
      const LinearMachine<> machine = machine_of(angle);
      const Sliding sliding = ModeChoice(machine).sliding(stop_of(machine, side, 0, 0));
      expect_the_slider_alone(sliding, side);
      EXPECT_EQ(sliding.ties, 0U);
    }
  }
}

TEST(ModeChoice, TellsOfAForceThatIsRoundedThatItMayBeNone) {
  for (const double side : {1.0, -1.0}) {
    const LinearMachine<> machine = machine_of(0x1p-18);
    const Sliding sliding = ModeChoice(machine).sliding(stop_of(machine, side, 1, 1));
    expect_the_slider_alone(sliding, side);
    EXPECT_EQ(sliding.ties, 0b100U);
  }
}

TEST(ModeChoice, TakesTheStateForExactWhereItsRoundingAloneLeavesADoubt) {
  for (const double side : {1.0, -1.0}) {
    const LinearMachine<> machine = machine_of(0x1p-20);
    ModeChoice::Stop stop = stop_of(machine, side, 1, 0);
    const Sliding sliding = ModeChoice(machine).sliding(stop);
    expect_the_slider_alone(sliding, side);
    EXPECT_EQ(sliding.ties, 0U);
    stop.stopped = {2, 0, 1};
    stop.forward_N = stop.backward_N = Vector3d{slider_N, 1, 1};
    const Sliding first = ModeChoice(machine).sliding(stop);
    EXPECT_EQ(first.signs, (Vector3d{side, 0, 0}));
    EXPECT_EQ(first.ties, 0U);
  }
}

TEST(ModeChoice, RefusesByNameWhatTheAppliedForcesLeaveInDoubt) {
  for (const double side : {1.0, -1.0}) {
    const LinearMachine<> machine = machine_of(0x1p-20);
    const ModeChoice choice(machine);
    try {
      choice.sliding(stop_of(machine, side, 1, 1));
      ADD_FAILURE() << "nothing was refused";
    } catch (const Refused& refused) {
      const std::string said = refused.what();
      EXPECT_NE(said.find("at t = 0.5 s cannot be decided in double precision, because friction"), said.npos) << said;
      EXPECT_NE(said.find("which friction directions stick"), said.npos) << said;
    }
  }
}

// Any order of the directions that stop, any of them, and forces of springs and dampers as of others.
TEST(ModeChoice, NamesDirectionsByTheirPlacesAmongThoseThatStop) {
  LinearMachine<> machine = machine_of(0x1p-18);
  machine.stiffness(2, 1) = -0x1p-10;
  machine.damping(0, 0) = -0x1p-9;
  ModeChoice::Stop stop = stop_of(machine, 1, 0, 0);
  stop.applied.setZero();
  stop.q = Vector3d{0, 1, 0}.cast<Extended>();
  stop.v = Vector3d{1, 0, 0}.cast<Extended>();
  stop.stopped = {2, 0};
  stop.forward_N = stop.backward_N = Eigen::Vector2d{slider_N, 1};
  const Sliding sliding = ModeChoice(machine).sliding(stop);
  EXPECT_EQ(sliding.signs, (Eigen::Vector2d{1, 0}));
  EXPECT_EQ(sliding.force_N[0], -slider_N);
  EXPECT_NEAR(sliding.force_N[1], -held_N, 1e-15);
}

TEST(ModeChoice, BearsForwardsAndBackwardsWhatEachIsGiven) {
  const LinearMachine<> machine = machine_of(0x1p-18);
  ModeChoice::Stop stop = stop_of(machine, 1, 0, 0);
  stop.stopped = {0};
  stop.forward_N = VectorXd::Constant(1, 0x1p-10);
  stop.backward_N = VectorXd::Constant(1, 1);
  EXPECT_EQ(ModeChoice(machine).sliding(stop).signs[0], 1);
  stop.applied = -stop.applied;
  EXPECT_EQ(ModeChoice(machine).sliding(stop).signs[0], 0);
  std::swap(stop.forward_N, stop.backward_N);
  EXPECT_EQ(ModeChoice(machine).sliding(stop).signs[0], -1);
}

}  // namespace
}  // namespace mode_choice_test
