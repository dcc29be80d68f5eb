// The ends of ranges and of counts: what the law makes of the longest wait, of the largest quotient and of nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "../../kicked_axis.hpp"
#include "breakaway/law/approach_plan.hpp"
#include "breakaway/law/force_steps.hpp"
#include "breakaway/law/kick_cycle.hpp"
#include "breakaway/law/move_plan.hpp"
#include "breakaway/law/rest_detector.hpp"
#include "breakaway/law/shaped_move.hpp"
#include "breakaway/law/velocity_estimator.hpp"
#include "breakaway/law/work_cycle.hpp"
#include "law_fixture.hpp"
#include "scripted_axis.hpp"

namespace breakaway::law {
namespace {

using breakaway::testing::axes_of_the_scenes;

constexpr int longer_than_any_count = 70'000;

BrakedKicks<float> kicks_of_the_scenes() { return design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks; }

TEST(MoveLimits, AreUsableWholeOrNotAtAll) {
  const MoveLimits<double> none{}, sound{1, 1, 2, 10};
  EXPECT_TRUE(none.are_usable());
  EXPECT_TRUE(sound.are_usable());
  const auto with = [&](double MoveLimits<double>::*number, double value) {
    MoveLimits<double> limits = sound;
    limits.*number = value;
    return limits;
  };
  EXPECT_TRUE(with(&MoveLimits<double>::jerk_m_s3, 0).are_usable()) << "without a limit of jerk";
  EXPECT_FALSE(with(&MoveLimits<double>::jerk_m_s3, -1).are_usable());
  EXPECT_FALSE(with(&MoveLimits<double>::acceleration_m_s2, -1).are_usable());
  EXPECT_FALSE(with(&MoveLimits<double>::acceleration_m_s2, std::nan("")).are_usable());
  EXPECT_FALSE(with(&MoveLimits<double>::acceleration_m_s2, 0).are_usable());
  EXPECT_FALSE(with(&MoveLimits<double>::deceleration_m_s2, 0).are_usable());
  EXPECT_FALSE(with(&MoveLimits<double>::speed_m_s, 0).are_usable());
  auto kicks = kicks_of_the_scenes();
  ASSERT_TRUE(are_usable(kicks));
  kicks.approach.move.jerk_m_s3 = -1;
  EXPECT_FALSE(are_usable(kicks)) << "nor are kicks with such limits";
}

TEST(MoveLimits, AMoveOfNoLengthTakesNoTimeAndOneInNoTimeGoesAsFastAsItMay) {
  const MoveLimits<double> limits{1, 1, 1, 0.1};
  EXPECT_EQ((MoveLimits<double>{1, 1, 1, 0}).time_s(0, 1), 0);
  EXPECT_EQ(limits.speed_for_m_s(0.1, 1), 1) << "its acceleration alone takes ten seconds to rise";
  EXPECT_LT(limits.speed_for_m_s(0.1, 100), 0.01);
}

TEST(KickTable, TakesNoDistanceForTheShortest) {
  const auto kicks = kicks_of_the_scenes();
  const Pulse<float> shortest = kicks.table.pulse(1e-12F);
  for (const float distance_m : {0.0F, -1e-3F}) {
    EXPECT_EQ(kicks.table.pulse(distance_m).force_N, shortest.force_N);
    EXPECT_EQ(kicks.table.pulse(distance_m).periods, shortest.periods);
  }
}

TEST(ForceSteps, ALimitOfMoreThanThereAreIsThatOfAll) {
  EXPECT_EQ(force_limit_steps(1e6F, 1e-3F), most_force_steps);
  EXPECT_EQ(force_limit_steps(std::numeric_limits<float>::infinity(), 1e-3F), most_force_steps);
  EXPECT_EQ(force_limit_steps(10.0F, 1e-3F), 10'000);
}

TEST(ForceSteps, AreRoundedDownWithinSixteenBitsEitherWay) {
  struct Row {
    float force_N;
    std::int32_t steps;
  };
  for (const auto& [force_N, steps] :
       {Row{2.5F, 2}, Row{-2.5F, -3}, Row{-3, -3}, Row{32'766.5F, 32'766}, Row{32'767, 32'767}, Row{32'767.5F, 32'767},
        Row{4e4F, 32'767}, Row{-32'766.5F, -32'767}, Row{-32'767, -32'767}, Row{-32'767.5F, -32'767},
        Row{-32'768, -32'767}, Row{-4e4F, -32'767}, Row{std::nanf(""), 0}})
    EXPECT_EQ(whole_force_steps(force_N, 1.0F), steps) << force_N;
}

TEST(Limited, NoForceThatNobodyComputedActs) {
  EXPECT_EQ(limited(std::nanf(""), 5.0F), 0.0F);
  EXPECT_EQ(limited(6.0F, 5.0F), 5.0F);
  EXPECT_EQ(limited(-6.0F, 5.0F), -5.0F);
  EXPECT_EQ(limited(0.5F, 5.0F), 0.5F);
}

TEST(FrictionBounds, TellHowFarApartTheyAre) {
  const FrictionBounds<double> friction{3, 4};
  EXPECT_EQ(friction.ratio(), 0.75);
  EXPECT_EQ(friction.gap(), 0.25);
}

TEST(AxisParameters, AFeedforwardOfLessThanANewtonIsOneEitherWay) {
  AxisParameters<double> p = testing::sampled_axis<double>();
  for (const double feedforward_N : {0.5, -0.5}) {
    p.feedforward_N = feedforward_N;
    EXPECT_EQ(p.total_force_N(), p.max_force_N + 0.5);
    EXPECT_EQ(validate(p), ParameterError::none);
  }
}

TEST(AxisParameters, ALightAxisMayBeDampedByLessThanOne) {
  AxisParameters<double> p = testing::sampled_axis<double>();
  p.mass_kg = p.stiffness_N_per_m = 0.01;
  p.approach_damping_Ns_per_m = 0.01;
  p.kick_damping_Ns_per_m = 0.5;
  EXPECT_EQ(validate(p), ParameterError::none);
}

template <class Scalar>
void expect_nothing_given(const ControlOutput<Scalar>& out) {
  EXPECT_EQ(out.mode, Mode::fault);
  EXPECT_EQ(out.force_N, 0);
  EXPECT_EQ(out.impulse_Ns, 0);
  EXPECT_FALSE(out.kicked);
}

TEST(AxisController, GivesNothingFromThePeriodOnInWhichItsReadingIsNoNumber) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double resolution_m : {1e-6, 0.0}) {
    AxisParameters<double> p = testing::sampled_axis<double>();
    p.encoder_resolution_m = resolution_m;
    const auto table = testing::ballistic_table(p, 1.0);
    for (const Measurement<double>& wrong : {Measurement<double>{std::nan(""), 0, true},
                                             {infinity, 0, true},
                                             {-infinity, 0, true},
                                             {0.01, infinity, true},
                                             {0.01, -infinity, true},
                                             {0.01, std::nan(""), true}}) {
      const bool is_read = resolution_m > 0;  // then the velocity is not
      if (is_read && std::isfinite(wrong.position_error_m)) continue;
      AxisController<double> controller{p, table};
      controller.update({0.01, 0, true});
      expect_nothing_given(controller.update(wrong));
      EXPECT_EQ(controller.fault(), ControlFault::not_a_number);
      expect_nothing_given(controller.update({0.01, 0, true}));
      expect_nothing_given(controller.update({0.01, 0, false}));
    }
  }
}

TEST(RestDetector, StaysPatientHoweverLongAnAxisIsStuck) {
  RestDetector<double> rest{1, 2.5, 1e-6, 1e-3};
  for (int n = 0; n < longer_than_any_count; ++n)
    EXPECT_EQ(rest.update(0, 3), n >= RestDetector<double>::patience) << n;
}

TEST(VelocityEstimator, CountsAThousandLostSamples) {
  VelocityEstimator<double> velocity{1e-3, 1e-6, 1e-3, 2.5};
  velocity.update(0);
  for (int n = 0; n < longer_than_any_count; ++n) velocity.skip();
  EXPECT_DOUBLE_EQ(velocity.update(1), velocity.weight() * 1000 / 1001);
}

TEST(ApproachPlan, CountsAThousandLostSamples) {
  const auto kicks = kicks_of_the_scenes();
  ApproachPlan<float> plan{kicks.approach, 1e-3F, 1, 0};
  plan.see(0, 0, 0, Reading::lost);
  EXPECT_FALSE(plan.see(-0.5F, 0, 0)) << "what was lost before the first reading counts for nothing";
  for (int n = 0; n < longer_than_any_count; ++n) plan.see(0, 0, 0, Reading::lost);
  plan.see(0.501F, 0, 0);
  EXPECT_NEAR(plan.velocity_m_s(), kicks.approach.correction, 1e-3F * kicks.approach.correction);
}

// Readings from one side of the target to the other, of an axis that cannot have gone there.
TEST(ApproachPlan, HasTurnedOftenAndIsAskedAnewForANewTarget) {
  BrakedApproach<float> approach = kicks_of_the_scenes().approach;
  approach.move = {1, 5, 5, 0};
  ApproachPlan<float> plan{approach, 1e-3F, 1, 0};
  for (int n = 0; n < 2000; ++n) {
    plan.see(n % 2 == 0 ? 0.1F : -0.1F, 0, 0);
    EXPECT_TRUE(n < 200 || plan.turned_often());
  }
  plan.retarget(0);
  EXPECT_FALSE(plan.turned_often());
  plan.see(0.1F, 0, 0);
  plan.see(-0.1F, 0, 0);
  EXPECT_FALSE(plan.turned_often());
}

TEST(KickCycle, RestsHoweverLongItWaitsAndHoweverLongItsCoastMayBe) {
  const auto kicks = kicks_of_the_scenes();
  KickCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.see(0);
  cycle.release(1e6F);
  for (int n = 0; n < longer_than_any_count; ++n) cycle.see(0);
  EXPECT_TRUE(cycle.patient());
  EXPECT_TRUE(cycle.at_rest()) << "whatever the force: there is no more to wait for";
  int periods = 0;
  for (; !cycle.overdue() && periods < 10 * longer_than_any_count; ++periods) cycle.next_steps(0);
  EXPECT_EQ(periods, 4 * (65535 + kicks.patient_periods + kicks.settling_periods) + kicks.spring.ringing_periods);
}

TEST(KickCycle, ABrakeForNoTimeIsTakenOffAfterAPeriod) {
  const auto kicks = kicks_of_the_scenes();
  KickCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.see(0);
  cycle.brake(1, 0);
  EXPECT_LT(cycle.next_steps(0), 0);
  EXPECT_EQ(cycle.next_steps(0), 0);
}

// The stillness under the brake counts, but for what the force proves.
TEST(KickCycle, WhatStoodUnderTheBrakeNeedNotStandAsLongAfterIt) {
  const auto kicks = kicks_of_the_scenes();
  KickCycle<float> cycle{kicks, 1e-6F, 50, 0};
  cycle.see(0);
  cycle.brake(1, 1000);
  for (int n = 0; n < kicks.patient_periods - 1; ++n) cycle.see(0);
  EXPECT_FALSE(cycle.patient());
  cycle.release(10);
  cycle.see(0);
  EXPECT_TRUE(cycle.patient());
}

TEST(WorkCycle, RestsHoweverLongItWaitsAndHoweverLongItsCoastMayBe) {
  WorkKicks<float> kicks;
  kicks.force_step_N = 1e-3F;
  kicks.patient_periods = kicks.still_periods = 100;
  WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.see(0);
  cycle.release(1e6F);
  for (int n = 0; n < longer_than_any_count; ++n) cycle.see(0);
  EXPECT_TRUE(cycle.at_rest());
  int periods = 0;
  for (; !cycle.overdue() && periods < 10 * longer_than_any_count; ++periods) cycle.next_steps(0);
  EXPECT_EQ(periods, 4 * (65535 + kicks.still_periods));
}

TEST(ShapedMove, WhatIsLostBeforeItsFirstReadingCountsForNothing) {
  ShapedApproach<double> approach;
  approach.mass_kg = approach.acceleration_m_s2 = 1;
  ShapedMove<double> move{approach, 1e-3, 1, 0}, other{approach, 1e-3, 1, 0};
  move.see(0, 0, 0, Reading::lost);
  for (int n = 0; n < 50; ++n) {
    EXPECT_EQ(move.see(-0.1, 0, 0), other.see(-0.1, 0, 0));
    EXPECT_EQ(move.force_N(), other.force_N());
  }
}

TEST(AxisControllerHold, OneThatIsLeftOverAndOverEndsByName) {
  testing::Scripted axis{0};
  int periods = 0;
  for (; axis.controller().fault() == ControlFault::none && periods < 1'000'000; ++periods)
    axis.show(axis.controller().mode() == Mode::hold ? 2e-5F : 0);
  EXPECT_EQ(axis.controller().fault(), ControlFault::hunting) << periods;
}

// Without a period and counts: the law of the paper.
TEST(IdealAxis, IsKickedTowardsItsTargetFromRestOnly) {
  auto p = testing::sampled_axis<double>();
  p.period_s = p.encoder_resolution_m = p.position_tolerance_m = 0;
  const auto table = testing::ballistic_table(p, p.stick_radius_upper_m());
  for (const double side : {1.0, -1.0}) {
    for (const double speed_m_s : {0.01, -0.01}) {
      AxisController<double> moving{p, table};
      EXPECT_FALSE(moving.update({side * 1e-3, speed_m_s, true}).kicked);
    }
    AxisController<double> resting{p, table};
    const auto out = resting.update({side * 1e-3, 0, true});
    EXPECT_TRUE(out.kicked);
    EXPECT_LT(side * out.impulse_Ns, 0);
  }
}

}  // namespace
}  // namespace breakaway::law
