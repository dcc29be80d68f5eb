// Which descriptions of coupled axes are refused, and the ends of the conditions on kicks.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/stability/sequential_kicks.hpp"

namespace breakaway::stability::kick_refusals_test {
namespace {

using breakaway::testing::refusal;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Two axes of 2 kg that throw 0.5 kg at each other, friction 2.5 to 4.5 N, nothing else.
CoupledAxes kicked_pair() {
  CoupledAxes a;
  a.mass = MatrixXd{{2, 0.5}, {0.5, 2}};
  a.mass_error = a.damping = a.stiffness = MatrixXd::Zero(2, 2);
  a.load_N = a.brake_N = a.force_step_N = VectorXd::Zero(2);
  a.friction_lower_N = VectorXd::Constant(2, 2.5);
  a.friction_upper_N = VectorXd::Constant(2, 4.5);
  a.max_force_N = VectorXd::Constant(2, 50);
  a.period_s = 1e-3;
  return a;
}

VectorXd pair_box() { return VectorXd::Constant(2, 0.01); }

struct BadAxes {
  std::function<void(CoupledAxes&)> spoil;
  const char* says;
};

TEST(CoupledAxesRefusals, SayWhatIsWrong) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<BadAxes> refused{
      {[](CoupledAxes& a) { a.mass.resize(0, 0); }, "mass is empty"},
      {[](CoupledAxes& a) { a.mass = MatrixXd::Identity(2, 3); }, "mass is of 2 x 3, and the machine has 2 axes"},
      {[](CoupledAxes& a) { a.load_N = VectorXd::Zero(3); }, "load_N is of 3 x 1, and the machine has 2 axes"},
      {[](CoupledAxes& a) { a.range_m = VectorXd::Ones(1); }, "range_m is of 1 x 1, and the machine has 2 axes"},
      {[](CoupledAxes& a) { a.mass_error(0, 1) = -1; }, "mass_error has an entry below 0"},
      {[](CoupledAxes& a) { a.mass_error(0, 0) = 2; }, "mass_error takes all of a mass on the diagonal away"},
      {[](CoupledAxes& a) { a.damping(1, 1) = -1; }, "damping is negative for an axis alone"},
      {[](CoupledAxes& a) { a.damping(0, 1) = std::nan(""); }, "damping is negative for an axis alone"},
      {[](CoupledAxes& a) { a.stiffness(0, 1) = infinity; }, "stiffness is not finite"},
      {[](CoupledAxes& a) { a.load_N[1] = infinity; }, "load_N is a bound"},
      {[](CoupledAxes& a) { a.friction_upper_N[0] = 1; }, "friction_upper_N is below friction_lower_N"},
      {[](CoupledAxes& a) { a.brake_N[0] = -1; }, "brake_N has an entry below 0"},
      {[](CoupledAxes& a) { a.force_step_N[0] = -1; }, "force_step_N has an entry below 0"},
      {[](CoupledAxes& a) { a.max_force_N[0] = -1; }, "max_force_N has an entry below 0"},
      {[](CoupledAxes& a) { a.period_s = 0; }, "period_s must be above 0"},
      {[](CoupledAxes& a) { a.lag_s = -1e-4; }, "lag_s and mass_slope_kg_per_m not below"},
      {[](CoupledAxes& a) { a.mass_slope_kg_per_m = -1; }, "lag_s and mass_slope_kg_per_m not below"},
  };
  EXPECT_EQ(refusal([] { require_valid(kicked_pair()); }), "");
  for (const BadAxes& bad : refused) {
    CoupledAxes a = kicked_pair();
    bad.spoil(a);
    const std::string message = refusal([&] { require_valid(a); });
    EXPECT_NE(message.find(bad.says), std::string::npos) << bad.says << ": " << message;
  }
}

TEST(KickPhases, HaveNamesThatAReportCanPrint) {
  EXPECT_STREQ(to_string(KickPhase::start), "start of the pulse");
  EXPECT_STREQ(to_string(KickPhase::pulse), "pulse");
  EXPECT_STREQ(to_string(KickPhase::coast), "coast");
  EXPECT_STREQ(to_string(KickPhase::hold_off), "hold-off force of the drive");
}

TEST(FreeFriction, OfAnAxisWithoutADriveLosesNothingToStepsOfForce) {
  CoupledAxes a = kicked_pair();
  a.force_step_N = VectorXd::Constant(2, 0.2);
  EXPECT_DOUBLE_EQ(free_friction_N(a, pair_box(), 1), 2.4);
  a.max_force_N[1] = 0;
  EXPECT_DOUBLE_EQ(free_friction_N(a, pair_box(), 1), 2.5);
}

TEST(LargestKick, IsNoneWhereTheDriveGivesLessThanTheLeastOne) {
  EXPECT_EQ(largest_kick_N(kicked_pair(), pair_box(), 4.6, 50, 0), 50);
  EXPECT_EQ(largest_kick_N(kicked_pair(), pair_box(), 60, 50, 0), 0);
}

// Each axis may throw more than its own force back at the other: what one feels of the other has no bound.
TEST(SimultaneousKicks, HaveNoBoundWhereEachAxisMayPushTheOtherHarder) {
  CoupledAxes a = kicked_pair();
  const VectorXd force_N = VectorXd::Constant(2, 20);
  EXPECT_TRUE(std::isfinite(simultaneous_condition(a, pair_box(), force_N, 0, 1).needed_N));
  a.mass_error(0, 1) = a.mass_error(1, 0) = 1.6;
  const PairCondition c = simultaneous_condition(a, pair_box(), force_N, 0, 1);
  EXPECT_TRUE(std::isinf(c.needed_N));
  EXPECT_FALSE(c.holds());
}

}  // namespace
}  // namespace breakaway::stability::kick_refusals_test
