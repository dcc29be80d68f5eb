#include "breakaway/identify/experiment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "../../campaign/random_unknown_joint.hpp"
#include "../../unknown_axis.hpp"
#include "breakaway/firmware/loop_concepts.hpp"
#include "breakaway/identify/experiment_law.hpp"

namespace breakaway::identify {
namespace {

using testing::ExperimentRun;
using testing::run_experiment;
using testing::UnknownAxis;

static_assert(firmware::AxisLaw<ExperimentLaw<float>, float>);

void expect_within_travel(const UnknownAxis& axis, const ExperimentRun& run) {
  EXPECT_GE(run.lowest_m, axis.lowest_m);
  EXPECT_LE(run.highest_m, axis.highest_m);
  EXPECT_LE(run.fastest_m_s, axis.max_speed_m_s);
}

TEST(Experiment, StaysWithinItsTravelWhereverItBegins) {
  for (const double start_m : {-0.24, -0.1, 0.0, 0.07, 0.24}) {
    UnknownAxis axis;
    axis.start_m = start_m;
    const ExperimentRun run = run_experiment(axis);
    EXPECT_EQ(run.ending, Ending::complete) << start_m << ": " << to_string(run.ending);
    expect_within_travel(axis, run);
  }
}

TEST(Experiment, StaysWithinAShortTravelOnNearlyNoFriction) {
  for (const double friction_N : {0.1, 0.3, 1.0}) {
    UnknownAxis axis;
    axis.lowest_m = -0.05, axis.highest_m = 0.05;
    axis.friction_N = friction_N;
    axis.latency_periods = 3;
    axis.lag_s = 2e-3;
    const ExperimentRun run = run_experiment(axis);
    expect_within_travel(axis, run);
    EXPECT_LE(run.duration_s, 60);
  }
}

TEST(Experiment, EndsAtRestAndWithinItsTravelWheneverThatIsAsked) {
  const UnknownAxis axis;
  for (double asked_s = 0.05; asked_s < 20; asked_s += 0.83) {
    const ExperimentRun run = run_experiment(axis, {.end_asked_s = asked_s});
    EXPECT_EQ(run.ending, Ending::asked) << asked_s;
    EXPECT_LE(run.duration_s, asked_s + 1) << asked_s;
    EXPECT_EQ(run.speed_at_end_m_s, 0) << asked_s;
    EXPECT_EQ(run.record.readings.back().command_N, 0) << asked_s;
    expect_within_travel(axis, run);
  }
}

TEST(Experiment, CommandsWholeStepsOfForceWithinTheLimit) {
  UnknownAxis axis;
  axis.force_step_N = 0.4;
  axis.max_force_N = 30.1;
  for (const evaluation::Reading& reading : run_experiment(axis).record.readings) {
    EXPECT_LE(std::abs(reading.command_N), axis.max_force_N);
    const double steps = reading.command_N / axis.force_step_N;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
  }
}

TEST(Experiment, BeginsWithASmallForce) {
  const UnknownAxis axis;
  double greatest_N = 0;
  for (const evaluation::Reading& reading : run_experiment(axis, {.end_asked_s = 0.2}).record.readings)
    greatest_N = std::max(greatest_N, std::abs(reading.command_N));
  EXPECT_LE(greatest_N, axis.friction_N / 2);
}

TEST(Experiment, GoesOnWhenSamplesAreLost) {
  const UnknownAxis axis;
  const ExperimentRun run = run_experiment(axis, {.lost_share = 0.002});
  EXPECT_EQ(run.ending, Ending::complete) << to_string(run.ending);
  expect_within_travel(axis, run);
  EXPECT_NEAR(evaluation::evaluate(run.record).mass.mass_kg, axis.mass_kg, 0.02 * axis.mass_kg);
}

TEST(Experiment, NamesAnAxisThatTheGreatestForceDoesNotMove) {
  UnknownAxis axis;
  axis.friction_N = 80;
  const ExperimentRun run = run_experiment(axis);
  EXPECT_EQ(run.ending, Ending::jammed) << to_string(run.ending);
  EXPECT_EQ(run.record.readings.back().command_N, 0);
}

TEST(Experiment, NamesAnAxisThatMovesWithoutForce) {
  UnknownAxis axis;
  axis.load_N = 6;
  const ExperimentRun run = run_experiment(axis, {.end_asked_s = 5});
  EXPECT_EQ(run.ending, Ending::drifting) << to_string(run.ending);
  EXPECT_LT(run.duration_s, 0.2);
}

TEST(Experiment, GivesNoForceOutsideItsTravel) {
  UnknownAxis axis;
  axis.start_m = 0.3;
  const ExperimentRun run = run_experiment(axis);
  EXPECT_EQ(run.ending, Ending::no_room);
  for (const evaluation::Reading& reading : run.record.readings) EXPECT_EQ(reading.command_N, 0);
}

TEST(Experiment, GivesNoForceAfterAReadingThatIsNoNumber) {
  Experiment<double> experiment{testing::told<double>(UnknownAxis{})};
  for (int k = 0; k < 400; ++k) experiment.update({0.0, 0.0, true});
  EXPECT_EQ(experiment.update({std::numeric_limits<double>::quiet_NaN(), 0.0, true}).force_N, 0);
  EXPECT_EQ(experiment.fault(), law::ControlFault::not_a_number);
  for (int k = 0; k < 400; ++k) EXPECT_EQ(experiment.update({0.0, 0.0, true}).force_N, 0);
}

TEST(Experiment, GoesOnAloneWhereTheOriginIsShifted) {
  Experiment<double> one{testing::told<double>(UnknownAxis{})}, other{testing::told<double>(UnknownAxis{})};
  other.shift_target(0.125);
  for (int k = 0; k < 2000; ++k)
    ASSERT_EQ(one.update({0.0, 0.0, true}).force_N, other.update({-0.125, 0.0, true}).force_N) << k;
}

TEST(ExperimentWithALoad, KeepsMotorAndLoadWithinTheTravelFromSoftToStiffAndWheneverItIsEnded) {
  for (const double resonance_Hz : {15.0, 30.0, 60.0, 200.0}) {
    campaign::Random random{7};
    const campaign::UnknownJoint axis = campaign::random_unknown_joint(random, resonance_Hz, 1.0001 * resonance_Hz);
    for (const double asked_s : {1e9, 3.0, 7.7}) {
      const ExperimentRun run = campaign::run_experiment<double>(axis, {.end_asked_s = asked_s});
      EXPECT_EQ(run.ending, asked_s < 1e9 ? Ending::asked : Ending::complete) << resonance_Hz;
      EXPECT_EQ(run.record.readings.back().command_N, 0);
      expect_within_travel(axis.motor, run);
    }
  }
}

}  // namespace
}  // namespace breakaway::identify
