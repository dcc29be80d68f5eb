#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "../../campaign/random_unknown_joint.hpp"
#include "../../unknown_axis.hpp"
#include "breakaway/evaluation/identification.hpp"
#include "breakaway/evaluation/summary.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::evaluation {
namespace {

using testing::run_experiment;
using testing::UnknownAxis;

std::string refusal(const Record& record, Mechanism mechanism = Mechanism::one_mass) {
  try {
    static_cast<void>(evaluate(record, {}, mechanism));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Evaluation, FindsTheLagOfTheCurrentLoopApartFromWholePeriodsOfLatency) {
  for (const double lag_s : {0.0, 0.3e-3, 1e-3, 3e-3}) {
    for (const int latency : {1, 2, 3}) {
      UnknownAxis axis;
      axis.lag_s = lag_s;
      axis.latency_periods = latency;
      const Identification found = evaluate(run_experiment(axis).record);
      EXPECT_EQ(found.latency.periods, latency) << lag_s;
      EXPECT_NEAR(found.latency.lag_s, lag_s, 0.05e-3);
      EXPECT_EQ(found.latency.lag_is_seen, lag_s > 0);
    }
  }
}

// Timers that wake late, and drives that sample as they read the SYNC: at speed a tenth of a period is many counts.
TEST(Evaluation, TakesPeriodsThatBeginLateForNeitherFrictionNorASpring) {
  for (const double late_share : {1.0, 0.02}) {
    const UnknownAxis axis;
    const Identification found = evaluate(run_experiment(axis, {.late_s = 100e-6, .late_share = late_share}).record);
    EXPECT_NEAR(found.mass.mass_kg, axis.mass_kg, 0.01 * axis.mass_kg);
    EXPECT_GE(found.friction_seen_N.least, 0.9 * axis.true_friction_N().least);
    EXPECT_LE(found.bounds_N.least, axis.true_friction_N().least);
  }
}

TEST(Evaluation, SaysBetweenWhichLatenciesItCannotTellWherePeriodsBeginLate) {
  for (const int latency : {2, 3}) {
    UnknownAxis axis;
    axis.latency_periods = latency;
    const Identification found = evaluate(run_experiment(axis, {.late_s = 200e-6}).record);
    ASSERT_FALSE(found.latency.is_told_apart()) << latency;
    EXPECT_EQ(found.latency.periods, 1) << "the usual one, as it can be";
    EXPECT_LE(found.latency.fewest_periods, latency);
    EXPECT_GE(found.latency.most_periods, latency);
    EXPECT_FALSE(found.latency.lag_is_seen);
    EXPECT_NE(summary(found).find(" periods, not told apart from a current loop"), std::string::npos);
  }
}

// Friction that changes from place to place puts what the switches show of latency and lag off.
TEST(Evaluation, BelievesInALatencyOfLessThanAPeriodOnlyWhereTheDelayIsTooShortForOne) {
  UnknownAxis axis;
  axis.lag_s = 0.3e-3;
  axis.wave = 0.2, axis.wave_length_m = 0.02, axis.phase = 2;
  const Identification found = evaluate(run_experiment(axis).record);
  EXPECT_EQ(found.latency.periods, 1);
  EXPECT_NEAR(found.latency.lag_s, axis.lag_s, found.latency.lag_error_s);
}

TEST(Evaluation, RefusesARecordWhosePositionsFollowTheForceBeforeItIsCommanded) {
  Record record = run_experiment(UnknownAxis{}).record;
  for (std::size_t i = 0; i + 3 < record.readings.size(); ++i)
    record.readings[i].position_m = record.readings[i + 3].position_m;
  EXPECT_NE(refusal(record).find("before it is commanded"), std::string::npos) << refusal(record);
}

// What the mass comes out as depends on how long the look is where friction changes within it.
TEST(Evaluation, IsAsUnsureOfAMassAsLongerAndShorterLooksDiffer) {
  EXPECT_LT(evaluate(run_experiment(UnknownAxis{}).record).mass.spread_of_lengths, 0.005);
  UnknownAxis axis;
  axis.wave = 0.2, axis.wave_length_m = 0.02;
  const Identification found = evaluate(run_experiment(axis).record);
  EXPECT_GT(found.mass.spread_of_lengths, 0.03);
  EXPECT_GE(found.mass_uncertainty, 2 * found.mass.spread_of_lengths);
  EXPECT_NEAR(found.mass.mass_kg, axis.mass_kg, found.mass_uncertainty * axis.mass_kg);
  axis.wave = 0.5;
  const std::string said = refusal(run_experiment(axis).record);
  EXPECT_NE(said.find("longer and shorter looks at the switches of the force differ"), std::string::npos) << said;
}

TEST(Evaluation, FindsWhereFrictionIsHigh) {
  UnknownAxis axis;
  axis.wave = 0.15, axis.tilt = 0;
  int seen = 0;
  for (const FrictionSample& sample : evaluate(run_experiment(axis).record).friction) {
    const double truth_N = axis.friction_at(sample.position_m, sample.direction, sample.speed_m_s);
    EXPECT_GE(truth_N, 0.93 * sample.friction_N.least);
    EXPECT_LE(truth_N, 1.07 * sample.friction_N.most);
    ++seen;
  }
  EXPECT_GT(seen, 100);
}

TEST(Evaluation, PromisesNoMoreThanTheNumberOfMotionsAllows) {
  const Identification found = evaluate(run_experiment(UnknownAxis{}).record);
  EXPECT_GE(found.motions, 20U);
  EXPECT_DOUBLE_EQ(found.chance_outside(), 2.0 / (static_cast<double>(found.motions) + 1));
  EXPECT_LE(found.motions, found.friction.back().motion);
  EXPECT_NE(summary(found).find("margin of 10 %"), std::string::npos);
}

TEST(Evaluation, WidensTheBoundsByItsMargins) {
  const Record record = run_experiment(UnknownAxis{}).record;
  const Identification found = evaluate(record, {.friction = 0.25, .mass = 0.05});
  EXPECT_DOUBLE_EQ(found.bounds_N.least, 0.75 * found.friction_seen_N.least);
  EXPECT_DOUBLE_EQ(found.bounds_N.most, 1.25 * found.friction_seen_N.most);
  EXPECT_GE(found.mass_uncertainty, 0.05);
}

TEST(Evaluation, SaysWhatARecordDoesNotShow) {
  Record record{1e-3, 1e-6, 0.025, {}};
  EXPECT_NE(refusal(record).find("fewer than 200 readings"), std::string::npos);
  record.readings.resize(1000);
  EXPECT_NE(refusal(record).find("nothing tells the mass"), std::string::npos);
  // Without the ramps, which stay below what sets the axis in motion at once.
  record = run_experiment(UnknownAxis{}).record;
  for (Reading& reading : record.readings)
    if (std::abs(reading.command_N) < 1.3 * UnknownAxis{}.friction_N) reading.command_N = 0;
  EXPECT_NE(refusal(record).find("friction at rest"), std::string::npos) << refusal(record);
}

// What comes after the fifth switch of the force in motion is cut off.
TEST(Evaluation, RefusesARecordOfFewSwitchesSinceTheirSpreadSaysLittle) {
  const Record whole = run_experiment(UnknownAxis{}).record;
  const std::string_view said_of_few = "switches of the force in motion 5 tell the mass, and 6 are needed";
  Record record = whole;
  std::string said;
  for (std::size_t size = 300; size <= whole.readings.size(); size += 20) {
    record.readings.assign(whole.readings.begin(), whole.readings.begin() + static_cast<std::ptrdiff_t>(size));
    said = refusal(record);
    if (said.find(said_of_few) != said.npos) break;
  }
  EXPECT_NE(said.find(said_of_few), std::string::npos) << said;
  EXPECT_NE(said.find("accelerate and brake 6 times or more"), std::string::npos) << said;
}

// Only one switch is much greater than all others, and friction steps within its second parabola.
TEST(Evaluation, IsNotMisledByAFrictionThatStepsFromPlaceToPlace) {
  UnknownAxis axis;
  axis.mass_kg = 3.678, axis.max_force_N = 238.9, axis.force_step_N = 0.11945, axis.period_s = 2e-3;
  axis.resolution_m = 1.12e-7, axis.lowest_m = -0.5, axis.highest_m = 0.5;
  const auto friction_N = [](const testing::Moment& now) {
    const double x = now.position_m;
    return x < -0.195 ? 7.636 : x < -0.045 ? 13.06 : x < 0.105 ? 8.992 : x < 0.305 ? 11.026 : 6.28;
  };
  testing::Slider slider{{.mass_kg = axis.mass_kg}, friction_N, 0, 0};
  const Identification found = evaluate(testing::run_experiment_on(slider, testing::told<double>(axis), 1).record);
  EXPECT_NEAR(found.mass.mass_kg, axis.mass_kg, 0.01 * axis.mass_kg);
  EXPECT_LE(std::abs(found.mass.mass_kg / axis.mass_kg - 1), found.mass_uncertainty);
  EXPECT_GE(found.mass.switches, 6U);
  EXPECT_EQ(found.latency.periods, 1);
}

// The greatest switches are all about one place.
TEST(Evaluation, IsAsSureOfTheMassAsFrictionThatVariesWithPlaceAllows) {
  for (const double phase : {0.0, 2.0, 4.0, 6.0}) {
    UnknownAxis axis;
    axis.wave = 0.35, axis.wave_length_m = 0.05, axis.phase = phase;
    const Identification found = evaluate(run_experiment(axis).record);
    EXPECT_LE(std::abs(found.mass.mass_kg / axis.mass_kg - 1), found.mass_uncertainty) << phase;
  }
}

TEST(Evaluation, RefusesARecordWithoutPeriodCountOrStepOfForce) {
  for (double Record::*const missing : {&Record::period_s, &Record::resolution_m, &Record::force_step_N}) {
    Record record{1e-3, 1e-6, 0.025, {}};
    record.readings.resize(1000);
    record.*missing = 0;
    EXPECT_NE(refusal(record).find("needs a period, a count and a step of force above 0"), std::string::npos);
  }
}

// On its way friction changes by more than ten of these counts tell, and by little against the motion.
TEST(Evaluation, TakesAnAxisForOneMassThatAFineEncoderSeesOffItsParabolas) {
  UnknownAxis axis;
  axis.resolution_m = 1e-9;
  axis.wave = 0.2;
  const Identification found = evaluate(run_experiment(axis).record);
  EXPECT_NEAR(found.mass.mass_kg, axis.mass_kg, 0.02 * axis.mass_kg);
}

TEST(Evaluation, CountsABreakAwayThatEndsTheRecord) {
  Record record = run_experiment(UnknownAxis{}).record;
  const Identification whole = evaluate(record);
  ASSERT_NE(whole.friction.back().speed_m_s, 0);
  // A ramp from rest; under its last force the axis sets off.
  const double rest_m = record.readings.back().position_m;
  for (int i = 1; i <= 300; ++i) record.readings.push_back({rest_m, 0.0125 * i, true});
  for (int i = 1; i <= 12; ++i) record.readings.push_back({rest_m + 3e-6 * i, 0.0125 * 300, true});
  const Identification again = evaluate(record);
  ASSERT_EQ(again.friction.size(), whole.friction.size() + 1);
  EXPECT_EQ(again.friction.back().speed_m_s, 0);
  EXPECT_DOUBLE_EQ(again.friction.back().position_m, rest_m);
  EXPECT_NEAR(again.friction.back().friction_N.most, 3.75, 0.05);
}

TEST(Evaluation, RefusesAnAxisThatSwings) {
  Record record = run_experiment(UnknownAxis{}).record;
  double phase = 0;
  for (Reading& reading : record.readings) reading.position_m += 1e-4 * std::sin(phase += 0.4);
  EXPECT_NE(refusal(record).find("no single mass"), std::string::npos) << refusal(record);
}

// 0.4 kg and 0.6 kg that swing 60 times a second.
campaign::UnknownJoint belt() {
  campaign::UnknownJoint axis;
  axis.motor.mass_kg = axis.spring.motor_kg = 0.4;
  axis.load.mass_kg = axis.spring.load_kg = 0.6;
  axis.motor.friction_N = 2, axis.load.friction_N = 1.6;
  axis.spring.stiffness_N_per_m = 3.4e4;
  axis.damping = 0.02;
  return axis;
}

TEST(EvaluationOfALoad, FindsBothMassesTheSpringAndTheFrictionOfEitherSide) {
  const campaign::UnknownJoint axis = belt();
  const Identification found = evaluate(campaign::run_experiment<double>(axis).record, {}, Mechanism::load_on_spring);
  ASSERT_TRUE(found.spring);
  const SpringEstimate& spring = *found.spring;
  EXPECT_NEAR(spring.motor_kg, 0.4, 0.004);
  EXPECT_NEAR(spring.load_kg, 0.6, 0.006);
  EXPECT_NEAR(spring.resonance_Hz.least, axis.spring.resonance_Hz(), 0.2);
  EXPECT_LE(spring.stiffness_N_per_m, 3.4e4);
  EXPECT_GE(spring.stiffness_N_per_m, 0.85 * 3.4e4);
  EXPECT_LE(spring.motor_N.least, axis.motor.true_friction_N().least);
  EXPECT_GE(spring.motor_N.most, axis.motor.true_friction_N().most);
  EXPECT_LE(spring.load_N.least, axis.load.true_friction_N().least);
  EXPECT_GE(spring.load_N.most, axis.load.true_friction_N().most);
  EXPECT_NE(summary(found).find("stiffness      3.0"), std::string::npos) << summary(found);
}

TEST(EvaluationOfALoad, CountsOnNoDampingWhereItSeesNone) {
  campaign::UnknownJoint axis = belt();
  axis.damping = 0;
  const Identification found = evaluate(campaign::run_experiment<double>(axis).record, {}, Mechanism::load_on_spring);
  EXPECT_EQ(found.spring->damping_Ns_per_m, 0);
  EXPECT_NEAR(found.spring->load_kg, 0.6, 0.006);
}

// As the margins have it, half of nothing is left of a side, or a mass is not known well enough.
TEST(EvaluationOfALoad, RefusesMarginsThatLeaveNothingToCertify) {
  const Record record = campaign::run_experiment<double>(belt()).record;
  const auto with = [&](const Margins& margins) {
    try {
      static_cast<void>(evaluate(record, margins, Mechanism::load_on_spring));
    } catch (const InputError& error) {
      return std::string{error.what()};
    }
    return std::string{};
  };
  EXPECT_EQ(with({.masses = 0.09, .side = 0.9}), "");
  EXPECT_NE(with({.side = 1}).find("friction of motor or load comes out at 0 or less"), std::string::npos);
  EXPECT_NE(with({.masses = 0.11}).find("sure to within 0.11 only, and a certificate needs a tenth"),
            std::string::npos);
}

// Joints that were found among random ones, of which one side rubs less than is usual.
TEST(EvaluationOfALoad, SaysWhatKeepsItFromTellingASideThatRubsLittle) {
  struct Row {
    std::uint64_t seed;
    campaign::UnknownAxis campaign::UnknownJoint::*side;
    std::string_view said;
  };
  for (const Row& row : {Row{8, &campaign::UnknownJoint::motor, "or motor or load stopped on the way"},
                         Row{28, &campaign::UnknownJoint::load, "the switches of the force differ by so much"},
                         Row{124, &campaign::UnknownJoint::load, "friction of motor or load comes out at 0 or less"}}) {
    campaign::Random random{row.seed};
    campaign::UnknownJoint axis = campaign::random_unknown_joint(random, 10, 400);
    (axis.*row.side).friction_N *= random.decades(0.02, 1);
    const std::string said = refusal(campaign::run_experiment<double>(axis).record, Mechanism::load_on_spring);
    EXPECT_NE(said.find(row.said), std::string::npos) << row.seed << ": " << said;
  }
}

TEST(EvaluationOfALoad, NamesThePlayOfAJoint) {
  for (const double gap_m : {1e-5, 1e-4}) {
    campaign::UnknownJoint axis = belt();
    axis.spring.gap_m = gap_m;
    const std::string said = refusal(campaign::run_experiment<double>(axis).record, Mechanism::load_on_spring);
    EXPECT_NE(said.find("play"), std::string::npos) << gap_m << ": " << said;
  }
}

TEST(EvaluationOfALoad, NamesAnAxisThatIsOneMass) {
  UnknownAxis axis;
  auto known = testing::told<double>(axis);
  known.load_on_spring = true;
  testing::Slider slider{{.mass_kg = axis.mass_kg}, [](const testing::Moment&) { return 3.0; }, 0, 0};
  const Record record = testing::run_experiment_on(slider, known, 1).record;
  EXPECT_NE(refusal(record, Mechanism::load_on_spring).find("leave [plant.load] out"), std::string::npos)
      << refusal(record, Mechanism::load_on_spring);
}

TEST(EvaluationOfALoad, SaysOfARecordWithoutBendsThatItDoesNotTellWhatRubs) {
  const Record record = campaign::run_experiment<double>(belt(), {}, false).record;
  const std::string said = refusal(record, Mechanism::load_on_spring);
  EXPECT_NE(said.find("nothing tells how motor and load share the friction"), std::string::npos) << said;
  const std::string rigid = refusal(record);
  EXPECT_NE(rigid.find("swings on a spring, 59."), std::string::npos) << rigid;
  EXPECT_NE(rigid.find("[plant.load]"), std::string::npos) << rigid;
}

}  // namespace
}  // namespace breakaway::evaluation
