// What certify_machine() refuses, and with which words; the machine is one that it certifies, spoilt in one thing.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/stability/machine_certificate.hpp"

namespace breakaway::stability::machine_refusals_test {
namespace {

using breakaway::testing::refusal;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Task {
  CoupledAxes axes;
  SampledApproach approach;
  VectorXd tolerance_m;

  MachineCertificate certificate() const { return certify_machine(axes, approach, tolerance_m); }
};

// Two motors on one beam, each end 3.67 kg and 1.33 kg of it thrown at the other, at 2 kHz.
Task beam_task() {
  CoupledAxes a;
  a.mass = MatrixXd{{3.6667, 1.3333}, {1.3333, 3.6667}};
  a.mass_error = 0.02 * a.mass;
  a.stiffness = MatrixXd{{40, -40}, {-40, 40}};
  a.damping = MatrixXd{{1, -1}, {-1, 1}};
  a.load_N = a.brake_N = VectorXd::Zero(2);
  a.friction_lower_N = VectorXd::Constant(2, 7);
  a.friction_upper_N = VectorXd::Constant(2, 13);
  a.force_step_N = VectorXd::Constant(2, 0.05);
  a.max_force_N = VectorXd::Constant(2, 100);
  a.period_s = 5e-4;
  a.lag_s = 1e-4;
  return {a,
          {VectorXd::Constant(2, 1500), VectorXd::Constant(2, 80), VectorXd::Constant(2, 0.02),
           VectorXd::Constant(2, 1e-6), 1},
          VectorXd::Constant(2, 5e-5)};
}

// A slide of 4 kg that nothing pulls back but its approach.
Task slide_task() {
  CoupledAxes a;
  a.mass = MatrixXd::Constant(1, 1, 4);
  a.mass_error = MatrixXd::Constant(1, 1, 0.05);
  a.stiffness = a.damping = MatrixXd::Zero(1, 1);
  a.load_N = a.brake_N = a.force_step_N = VectorXd::Zero(1);
  a.friction_lower_N = VectorXd::Constant(1, 7);
  a.friction_upper_N = VectorXd::Constant(1, 13);
  a.max_force_N = VectorXd::Constant(1, 100);
  a.period_s = 5e-4;
  return {a,
          {VectorXd::Constant(1, 1500), VectorXd::Constant(1, 80), VectorXd::Constant(1, 0.02),
           VectorXd::Constant(1, 1e-6), 1},
          VectorXd::Constant(1, 5e-5)};
}

Condition condition_named(const MachineCertificate& c, const std::string& name) {
  for (const Condition& condition : c.conditions) {
    if (condition.name == name) return condition;
  }
  ADD_FAILURE() << "there is no condition '" << name << "'; the reason is: " << c.reason;
  return {};
}

struct Refusal {
  const char* what;
  std::function<void(Task&)> spoil;
  const char* condition;  // the reason begins with its name
  const char* says;
};

TEST(MachineRefusals, NameTheConditionThatFailsAndTheRemedy) {
  const std::vector<Refusal> refusals{
      {"springs that do work around a circle", [](Task& t) { t.axes.stiffness(0, 1) = 40; }, "closed loop stiffness",
       "not proved to be symmetric and positive definite"},
      {"masses whose error makes them singular",
       [](Task& t) {
         t.axes.mass_error = MatrixXd{{0, 4}, {4, 0}};
       },
       "masses", "state the masses more exactly"},
      {"masses whose error, by its rows, might make them singular",
       [](Task& t) {
         t.axes.mass = MatrixXd{{1, 0.5}, {0.5, 2}};
         t.axes.mass_error = MatrixXd{{0, 0.75}, {0.75, 0}};
       },
       "masses", "the errors of the masses are 1.07 of what"},
      {"samples whose hold grows slowly from round to round", [](Task& t) { t.axes.period_s = 0.05; }, "sampling",
       "take a shorter period"},
      {"samples whose hold grows beyond all numbers", [](Task& t) { t.axes.period_s = 1; }, "sampling",
       "take a shorter period"},
      {"a coupling by dampers that feeds the motion",
       [](Task& t) {
         t.axes.damping = MatrixXd{{0, 400}, {400, 0}};
         t.approach.velocity_gain_Ns_per_m.setConstant(20);
         t.approach.start_m.setConstant(5e-3);
         t.axes.period_s = 1e-4;
         t.axes.lag_s = 0;
       },
       "region of attraction", "raise the velocity gains"},
      {"a box that is larger than the range of the masses",
       [](Task& t) {
         t.approach.start_m.setConstant(2e-3);
         t.axes.range_m = VectorXd::Constant(2, 5e-3);
       },
       "range of the masses after the release", "the release may take it"},
      {"a brake that is stronger than what stops the axis", [](Task& t) { t.axes.brake_N[0] = 8; }, "stop of axis 1",
       "against a brake of 8 N"},
      {"a drive that is too weak for friction",
       [](Task& t) {
         t.approach.start_m.setConstant(1e-3);
         t.axes.max_force_N.setConstant(12);
       },
       "force of kicks of axis 1", "take a stronger drive"},
      {"a drive that is too weak to hold its axis off",
       [](Task& t) {
         t.approach.start_m.setConstant(1e-5);
         t.axes.max_force_N[1] = 2;
       },
       "kicks of axis 1 alone", "take a stronger drive for axis 2"},
      {"an accuracy of one axis that is too fine", [](Task& t) { t.tolerance_m[0] = 1e-6; }, "accuracy of axis 1",
       "ask for what can be promised"},
      {"an axis without a drive, which only springs pull back",
       [](Task& t) {
         t.approach.position_gain_N_per_m[1] = t.approach.velocity_gain_Ns_per_m[1] = 0;
         t.axes.max_force_N[1] = 0;
         t.axes.stiffness = MatrixXd{{500, -500}, {-500, 500}};
         t.axes.damping *= 80;
         t.approach.start_m.setConstant(5e-3);
       },
       "release", "make the springs between the axes softer"},
      {"a drive for speed alone on an axis that only springs pull back",
       [](Task& t) {
         t.approach.position_gain_N_per_m[1] = 0;
         t.axes.stiffness = MatrixXd{{500, -500}, {-500, 500}};
         t.approach.start_m.setConstant(5e-3);
       },
       "release", "make the springs between the axes softer"},
  };
  ASSERT_TRUE(beam_task().certificate().certified) << beam_task().certificate().reason;
  for (const Refusal& refused : refusals) {
    Task task = beam_task();
    refused.spoil(task);
    const MachineCertificate c = task.certificate();
    EXPECT_FALSE(c.certified) << refused.what;
    EXPECT_EQ(c.reason.rfind(std::string{refused.condition} + ": ", 0), 0U) << refused.what << ": " << c.reason;
    EXPECT_NE(c.reason.find(refused.says), std::string::npos) << refused.what << ": " << c.reason;
    EXPECT_EQ(c.reason.find("nan"), std::string::npos) << refused.what << ": " << c.reason;
    EXPECT_FALSE(condition_named(c, refused.condition).holds) << refused.what;
  }
}

// What springs alone pull back rests where they pull with its friction: let go, nothing of its friction is left over.
TEST(MachineRefusals, LeaveNoMachineWithAnAxisThatHasNoDrive) {
  for (const double spring : {0.1, 10.0, 1000.0}) {
    Task task = beam_task();
    task.approach.position_gain_N_per_m[1] = task.approach.velocity_gain_Ns_per_m[1] = 0;
    task.axes.max_force_N[1] = 0;
    task.axes.stiffness = MatrixXd{{spring, -spring}, {-spring, spring}};
    task.axes.damping *= 80;
    task.approach.start_m.setConstant(1e-3);
    EXPECT_EQ(task.certificate().reason.rfind("release: ", 0), 0U) << spring << ": " << task.certificate().reason;
  }
}

TEST(MachineRefusals, OfTheDriveThatHoldsOffSayWhatItMustGive) {
  Task task = beam_task();
  task.approach.start_m.setConstant(1e-5);
  task.axes.max_force_N[1] = 2;
  const std::string reason = task.certificate().reason;
  EXPECT_NE(reason.find("the drive of axis 2 must give "), std::string::npos) << reason;
  EXPECT_NE(reason.find(" N of 2 N, at a kick of "), std::string::npos) << reason;
}

// The range of the masses is asked after the release, too, and the box within it is all that is needed.
TEST(MachineRefusals, ForTheRangeOfTheMassesEndWhereTheBoxFits) {
  Task task = beam_task();
  task.approach.start_m.setConstant(2e-3);
  task.axes.range_m = VectorXd::Constant(2, 5e-3);
  const MachineCertificate refused = task.certificate();
  const Condition range = condition_named(refused, "range of the masses after the release");
  task.axes.range_m.array() += -range.margin * (1 + 1e-9);
  EXPECT_TRUE(task.certificate().certified) << task.certificate().reason;
  task.axes.range_m.array() -= 1e-6;
  EXPECT_FALSE(task.certificate().certified);
}

TEST(MachineRefusals, OfOneAxisLeaveThePromiseOfTheOther) {
  Task task = beam_task();
  task.tolerance_m[0] = 1e-6;
  const MachineCertificate c = task.certificate();
  ASSERT_EQ(c.axes.size(), 2U);
  EXPECT_EQ(c.axes[0].most_kicks, 0U);
  EXPECT_GT(c.axes[1].most_kicks, 0U);
  EXPECT_TRUE(c.simultaneous.empty());
}

struct Input {
  const char* name;
  VectorXd& (*of)(Task&);
};

TEST(MachineRefusals, NameTheVectorThatDoesNotFitTheMachine) {
  const std::vector<Input> inputs{
      {"position_gain", [](Task& t) -> VectorXd& { return t.approach.position_gain_N_per_m; }},
      {"velocity_gain", [](Task& t) -> VectorXd& { return t.approach.velocity_gain_Ns_per_m; }},
      {"start_m", [](Task& t) -> VectorXd& { return t.approach.start_m; }},
      {"resolution_m", [](Task& t) -> VectorXd& { return t.approach.resolution_m; }},
      {"tolerance_m", [](Task& t) -> VectorXd& { return t.tolerance_m; }},
  };
  for (const Input& input : inputs) {
    for (const VectorXd& bad :
         {VectorXd{VectorXd::Ones(3)}, VectorXd{Eigen::Vector2d{1, std::numeric_limits<double>::infinity()}},
          VectorXd{Eigen::Vector2d{-1, 1}}, VectorXd{Eigen::Vector2d{std::nan(""), 1}}}) {
      Task task = beam_task();
      input.of(task) = bad;
      EXPECT_EQ(refusal([&] { task.certificate(); }),
                std::string{input.name} + " must have a number of at least 0 for each of the 2 axes")
          << bad.transpose();
    }
  }
}

TEST(MachineCertificateOfOneAxis, HasNoOtherAxisToThinkOf) {
  const MachineCertificate c = slide_task().certificate();
  ASSERT_TRUE(c.certified) << c.reason;
  const Condition alone = condition_named(c, "kicks of axis 1 alone");
  EXPECT_EQ(alone.reason, "there is no other axis");
  EXPECT_TRUE(std::isinf(alone.margin));
  EXPECT_TRUE(c.simultaneous.empty());
  EXPECT_GT(c.axes[0].kick_N, c.axes[0].kicked.sure_N);
}

// A force that is hardly above friction moves a slide a thousandth of a count in a period that is so short.
TEST(MachineCertificateOfOneAxis, RefusesATaskThatTakesEndlessKicks) {
  Task task = slide_task();
  task.axes.period_s = 2.5e-5;
  task.approach.velocity_gain_Ns_per_m.setConstant(40);
  task.approach.start_m.setConstant(1e-3);
  task.tolerance_m[0] = 0;
  const double least_m = task.certificate().axes.at(0).least_tolerance_m;
  task.tolerance_m[0] = least_m;
  const MachineCertificate c = task.certificate();
  EXPECT_FALSE(c.certified);
  EXPECT_EQ(c.reason.rfind("kicks of axis 1 at most: 100000 kicks from ", 0), 0U) << c.reason;
  EXPECT_NE(c.reason.find("ask for less accuracy"), std::string::npos) << c.reason;
}

// At 30 million periods a second a kick of 255 of them goes less than rounding of where it starts.
TEST(MachineCertificateOfOneAxis, RefusesKicksThatRoundingSwallows) {
  Task task = slide_task();
  task.axes.period_s = 3e-8;
  task.approach.velocity_gain_Ns_per_m.setZero();
  task.approach.resolution_m.setConstant(1e-5);
  task.approach.start_m.setConstant(1e-3);
  const MachineCertificate c = task.certificate();
  EXPECT_FALSE(c.certified);
  EXPECT_EQ(c.reason.rfind("kicks of axis 1 at most: 100000 kicks from ", 0), 0U) << c.reason;
}

// Springs that push the ends apart alike: of K_cl^-1 the entries off the diagonal are negative, and the worst rest has
// both frictions against each other.
TEST(MachineCertificate, TakesTheWorstSignsOfFrictionForTheGate) {
  Task task = beam_task();
  task.axes.stiffness = MatrixXd{{40, 40}, {40, 40}};
  const MachineCertificate c = task.certificate();
  ASSERT_TRUE(c.certified) << c.reason;
  const double rest_m = 13.0 * 1580 / (1540.0 * 1540 - 1600);
  EXPECT_GT(c.axes[0].gate_m, rest_m);
  EXPECT_LT(c.axes[0].gate_m, 1.1 * rest_m);
}

TEST(MachineCertificate, LetsGoEarlierWithoutALagOfTheCurrentLoops) {
  Task task = beam_task();
  const double lagging_s = task.certificate().release_s;
  task.axes.lag_s = 0;
  const MachineCertificate c = task.certificate();
  ASSERT_TRUE(c.certified) << c.reason;
  EXPECT_LT(c.release_s, lagging_s);
}

// Dampers that may feed motion take from the friction that brings the machine to rest after its release.
TEST(MachineCertificate, CountsDampersThatFeedMotionAgainstTheRelease) {
  Task task = beam_task();
  const MachineCertificate passive = task.certificate();
  task.axes.damping = MatrixXd{{1, -3}, {-3, 1}};
  const MachineCertificate fed = task.certificate();
  ASSERT_TRUE(fed.certified) << fed.reason;
  EXPECT_LT(condition_named(fed, "release").margin, condition_named(passive, "release").margin);
}

TEST(KickPulse, OfLessThanAnyPulseCanAimAtIsOneWeakPeriod) {
  const MachineCertificate c = beam_task().certificate();
  const KickedAxis& k = c.axes.at(0).kicked;
  const KickPulse pulse = kick_pulse(k, 50, 1e-9, 5e-4);
  EXPECT_EQ(pulse.periods, 1);
  EXPECT_LT(pulse.force_N, k.sure_N);
  EXPECT_NEAR(k.most_travel_m(pulse.force_N, 5e-4), 1e-9, 1e-15);
}

}  // namespace
}  // namespace breakaway::stability::machine_refusals_test
