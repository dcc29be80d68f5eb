#include "breakaway/stability/linear_machine.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../refusal.hpp"

namespace linear_machine_test {
namespace {

using breakaway::stability::LinearMachine;
using breakaway::stability::require_valid;

LinearMachine<> oscillator() {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix2d::Identity();
  machine.damping = Eigen::Matrix2d::Zero();
  machine.stiffness = Eigen::Matrix2d::Identity();
  machine.directions = Eigen::Vector2d{1, -1};
  machine.friction_N = Eigen::VectorXd::Constant(1, 0.5);
  return machine;
}

TEST(LinearMachine, AcceptsAMachineWithFewerFrictionsThanCoordinates) { EXPECT_NO_THROW(require_valid(oscillator())); }

TEST(LinearMachine, AcceptsMassesOfVeryDifferentUnits) {
  auto machine = oscillator();
  machine.mass.diagonal() << 1e-150, 1e150;
  EXPECT_NO_THROW(require_valid(machine));
}

TEST(LinearMachine, NamesWhatIsWrong) {
  const auto error = [](auto&& spoil) {
    auto machine = oscillator();
    spoil(machine);
    return breakaway::testing::refusal([&] { require_valid(machine); });
  };
  EXPECT_NE(error([](auto& m) { m.mass(0, 1) = 0.1; }).find("mass is not symmetric"), std::string::npos);
  EXPECT_NE(error([](auto& m) { m.mass << 1, 2, 2, 1; }).find("mass is not positive definite"), std::string::npos);
  EXPECT_NE(error([](auto& m) { m.damping(1, 1) = NAN; }).find("damping has an entry"), std::string::npos);
  EXPECT_NE(error([](auto& m) { m.stiffness.resize(3, 2); }).find("stiffness is 3 x 2: make it 2 x 2"),
            std::string::npos);
  EXPECT_NE(error([](auto& m) { m.friction_N[0] = -1; }).find("friction_N[0] is -1"), std::string::npos);
  EXPECT_NE(error([](auto& m) { m.force_N = Eigen::Vector3d::Zero(); }).find("force_N is 3 x 1"), std::string::npos);
  EXPECT_NE(error([](auto& m) { m.mass.resize(0, 0); }).find("mass is empty"), std::string::npos);
}

TEST(LinearMachine, FeedbackAddsToStiffnessAndDamping) {
  const Eigen::Vector2d actuator{0, 1};
  const auto closed = with_feedback(oscillator(), actuator, Eigen::RowVector2d{0, 3}, Eigen::RowVector2d{0, 0.25});
  EXPECT_EQ(closed.stiffness(1, 1), 4);
  EXPECT_EQ(closed.damping(1, 1), 0.25);
  EXPECT_EQ(closed.stiffness(0, 0), 1);
}

TEST(LinearMachine, EnergyIsThatOfMassesAndSprings) {
  LinearMachine<2, 1> machine;
  machine.mass << 2, 0, 0, 3;
  machine.stiffness << 2, -1, -1, 2;
  const breakaway::stability::MachineState<2> state{0, {1, -1}, {1, 2}};
  EXPECT_DOUBLE_EQ(energy_J(machine, state), 0.5 * (2 + 12) + 0.5 * 6);
  EXPECT_EQ(machine.force_N, Eigen::Vector2d::Zero());
  EXPECT_DOUBLE_EQ(after_impulse(machine, state, {2, 3}).v[1], 3);
}

// (1, -1) is what this actuator does not reach: no gain may seem to damp it, and the more so where its sum with the
// machine's own damping is rounded. The sums here are exact in long double.
TEST(LinearMachine, FeedbackSeemsToDampNothingThatItDoesNotReach) {
  LinearMachine<> machine = oscillator();
  machine.damping << 0.125, 0.375, 0.375, 0.125;
  for (double gain = 1; gain < 1e17; gain *= 7.3) {
    const auto closed =
        with_feedback(machine, Eigen::Vector2d{1, 1}, Eigen::RowVector2d::Zero(), Eigen::RowVector2d::Constant(gain));
    const auto& c = closed.damping;
    const long double power =
        (static_cast<long double>(c(0, 0)) - c(0, 1)) + (static_cast<long double>(c(1, 1)) - c(1, 0));
    EXPECT_LE(power, -0.5L) << gain;
    EXPECT_LE(-0.5L - power, 8 * gain * 0x1p-53 + 1e-30) << gain << ": no more than rounding";
  }
}

// Where the sizes of two coordinates differ by more than a number can hold, each takes its share by itself.
TEST(LinearMachine, FeedbackTakesOffWhatIsRoundedBetweenCoordinatesOfTheGreatestAndTheLeastSize) {
  LinearMachine<> machine = oscillator();
  machine.damping << 1e-320, 0.1, 0.1, 1e308;
  const auto closed =
      with_feedback(machine, Eigen::Vector2d{1, 0}, Eigen::RowVector2d::Zero(), Eigen::RowVector2d{0, 0.7});
  EXPECT_TRUE(closed.damping.allFinite());
  EXPECT_LT(closed.damping(0, 0), 0) << "0.1 + 0.7 is rounded";
  EXPECT_GT(closed.damping(0, 0), -1e-15);
  EXPECT_LE(closed.damping(1, 1), 1e308);
}

// A loop without damping elsewhere is one of everywhere only where nothing is taken off.
TEST(LinearMachine, FeedbackTakesNothingOffWhereItsSumsAreExact) {
  const auto closed =
      with_feedback(oscillator(), Eigen::Vector2d{1, 0}, Eigen::RowVector2d{0.1, 0}, Eigen::RowVector2d{0.3, 0});
  EXPECT_EQ(closed.damping, (Eigen::Matrix2d{{0.3, 0}, {0, 0}}));
  EXPECT_LT(closed.stiffness(0, 0), 1.1) << "1 + 0.1 is rounded";
  EXPECT_GT(closed.stiffness(0, 0), 1.1 - 1e-15);
  EXPECT_EQ(closed.stiffness(1, 1), 1);
}

}  // namespace
}  // namespace linear_machine_test
