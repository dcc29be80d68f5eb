// The steps of an evaluation one by one, on records that are made by hand: what each takes for what it looks for, and
// what it leaves alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "../../../controller/identify/evaluation/src/bends.hpp"
#include "../../../controller/identify/evaluation/src/break_aways.hpp"
#include "../../../controller/identify/evaluation/src/sprung.hpp"
#include "../../../controller/identify/evaluation/src/switches.hpp"
#include "../../../controller/identify/evaluation/src/totals.hpp"
#include "../refusal.hpp"
#include "breakaway/evaluation/summary.hpp"

namespace breakaway::evaluation {
namespace {

constexpr double period_s = 1e-3, count_m = 1e-6;

Record empty_record() { return {period_s, count_m, 0.01, {}}; }

double counted(double position_m) { return std::round(position_m / count_m) * count_m; }

Swing swing_of_Hz(double Hz) { return {2 * std::numbers::pi * Hz, 0, 2e-3}; }

LatencyEstimate late_by(int periods) {
  LatencyEstimate latency;
  latency.periods = periods;
  return latency;
}

// Bends of the spring

struct BendOfRecord {
  int readings_up = 200;       // by 0.02 N each, from no force
  double motor_N = 1;          // friction of the motor, which a load holds by a spring of 10 N/mm
  double motor_back_N = 1;     // the same on the way back
  double runs_away_m = 0;      // in the last readings of the way back
  std::size_t readings = 700;  // in all
};

Record record_of(const BendOfRecord& one) {
  constexpr double stiffness_N_per_m = 1e4, step_N = 0.02;
  Record record = empty_record();
  double motor_m = 0, force_N = 0, late_N[2] = {0, 0};
  for (int i = 0; i < static_cast<int>(one.readings); ++i) {
    const int ramp = i - 150;
    if (ramp >= 0 && ramp < one.readings_up) force_N += step_N;
    if (ramp >= one.readings_up && ramp < one.readings_up + 300) force_N -= step_N;
    record.readings.push_back({counted(motor_m), force_N, true});
    motor_m = std::max(motor_m, (late_N[1] - one.motor_N) / stiffness_N_per_m);
    motor_m = std::min(motor_m, (late_N[1] + one.motor_back_N) / stiffness_N_per_m);
    if (ramp >= one.readings_up + 290 && ramp < one.readings_up + 300) motor_m -= one.runs_away_m / 10;
    late_N[1] = late_N[0], late_N[0] = force_N;
  }
  return record;
}

std::vector<Bend> bends_of(const BendOfRecord& one) { return bends_in(record_of(one), swing_of_Hz(50), 1e4); }

TEST(Bends, TellTheFrictionOfTheMotorFromBothWays) {
  const std::vector<Bend> found = bends_of({});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].motor_N, 1, 0.03);
  EXPECT_NEAR(found[0].slack_N, 0, 0.05);
  EXPECT_NEAR(found[0].position_m, 2.94e-4, 1e-6) << "as it was read when the force turned, two readings late";
}

TEST(Bends, TellASpringThatIsStifferThanThatOfTheSwing) {
  const auto said = [](double stiffness_N_per_m) {
    const std::vector<Bend> found(least_bends, bends_in(record_of({}), swing_of_Hz(50), stiffness_N_per_m).at(0));
    return testing::refusal([&] { require_tight(found, stiffness_N_per_m, count_m); });
  };
  EXPECT_EQ(said(1e4), "");
  EXPECT_EQ(said(0.9e4), "") << "a stiffness is sure to a tenth";
  EXPECT_NE(said(100).find("another swing than that of the load"), std::string::npos) << said(100);
}

TEST(Bends, AreNoneWhereOneWayIsMissing) {
  EXPECT_TRUE(bends_of({.readings_up = 8}).empty()) << "the force turned before there was a way";
  EXPECT_TRUE(bends_of({.motor_back_N = 100}).empty()) << "the motor did not come back";
  EXPECT_TRUE(bends_of({.runs_away_m = 2e-3}).empty()) << "the load broke away at the end";
  EXPECT_TRUE(bends_of({.readings = 649}).empty()) << "the record ends before the last of the force is seen";
  EXPECT_EQ(bends_of({.readings = 660}).size(), 1U);
}

// Breaking away with a load

// The force grows by 0.02 N a reading while motor and load go by a count each.
Record steady_slide(int readings) {
  Record record = empty_record();
  for (int i = 0; i < 120; ++i) record.readings.push_back({0, 0, true});
  for (int i = 0; i < readings; ++i) record.readings.push_back({count_m * i, 0.02 * (i + 1), true});
  for (int i = 0; i < 120; ++i) record.readings.push_back({count_m * readings, 0, true});
  return record;
}

TEST(SprungBreakAways, AreRampsThatLastForSomeSwings) {
  const auto found = sprung_break_aways_in(steady_slide(200), swing_of_Hz(50), 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].direction, 1);
  // Of the force as it was half a window of 30 readings and the delay of two before the end.
  EXPECT_NEAR(found[0].both_N, 0.02 * (200 - 17), 0.03);
  EXPECT_TRUE(sprung_break_aways_in(steady_slide(200), swing_of_Hz(10), 1).empty()) << "a swing lasts half of the ramp";
}

TEST(SprungBreakAways, AreNoneWhereReadingsDoNotTellASwingFromRest) {
  EXPECT_FALSE(sprung_break_aways_in(steady_slide(200), swing_of_Hz(400), 1).empty());
  EXPECT_TRUE(sprung_break_aways_in(steady_slide(200), swing_of_Hz(1000), 1).empty()) << "one a period is not seen";
}

// Breaking away as one mass

struct RampOfRecord {
  double from_N = 0;
  int readings = 300;  // by 0.01 N each
  int counts_a_reading = 3;
  int counts = 1000;  // to which the axis goes
};

Record record_of(const RampOfRecord& ramp) {
  Record record = empty_record();
  for (int i = 0; i < ramp.readings + 60; ++i) {
    const int counts = std::clamp((i - ramp.readings) * ramp.counts_a_reading, 0, ramp.counts);
    record.readings.push_back({count_m * counts, ramp.from_N + 0.01 * i, true});
  }
  return record;
}

TEST(BreakAways, AreRestsThatARampEnds) {
  const auto found = break_aways_in(record_of(RampOfRecord{}), late_by(1), 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].at, 301U);
  EXPECT_NEAR(found[0].seen.friction_N.most, 3.0, 0.011);
  EXPECT_EQ(found[0].seen.direction, 1);
  EXPECT_EQ(found[0].seen.speed_m_s, 0);
}

TEST(BreakAways, AreNoneWhereTheAxisGoesOnByACountOnly) {
  EXPECT_TRUE(break_aways_in(record_of({.counts_a_reading = 1, .counts = 1}), late_by(1), 1).empty());
  EXPECT_EQ(break_aways_in(record_of({.counts_a_reading = 1, .counts = 3}), late_by(1), 1).size(), 1U);
}

// The slope of a ramp is that of the twenty readings before the force that broke the axis away.
TEST(BreakAways, AreNoneWhereTheRecordBeginsInTheRamp) {
  const Record record = record_of({.from_N = 3, .readings = 20});
  EXPECT_EQ(break_aways_in(record, late_by(1), 1).size(), 1U);
  EXPECT_TRUE(break_aways_in(record, late_by(2), 1).empty());
}

// An axis that bends by F/K before it slides at 3 N.
struct BentOfRecord {
  double stiffness_N_per_m = 1e5;
  double before_N = 0;  // until the ramp begins
  double from_N = 0;    // where it begins
  int rest = 50;        // readings before it
  double step_N = 0.01;
};

void append(Record& record, std::vector<BreakAway>& broken, const BentOfRecord& bent) {
  for (int i = 0; i < bent.rest; ++i) record.readings.push_back({0, bent.before_N, true});
  for (double force_N = bent.from_N; force_N < 3; force_N += bent.step_N)
    record.readings.push_back({counted(std::max(force_N, 0.0) / bent.stiffness_N_per_m), force_N, true});
  broken.push_back({record.readings.size() - 1, {.direction = 1, .friction_N = {2.9, 3}}});
}

double stiffness_of(std::initializer_list<BentOfRecord> ramps, int latency_periods = 1) {
  Record record = empty_record();
  std::vector<BreakAway> broken;
  for (const BentOfRecord& ramp : ramps) append(record, broken, ramp);
  return presliding_stiffness_N_per_m(record, broken, late_by(latency_periods)).value_or(0);
}

TEST(PreslidingStiffness, IsTheLeastOfAllRampsThatBeganWithoutForce) {
  const double stiff = stiffness_of({{.stiffness_N_per_m = 1e5}}), soft = stiffness_of({{.stiffness_N_per_m = 5e4}});
  EXPECT_LE(stiff, 1e5);
  EXPECT_GT(stiff, 0.85e5);
  EXPECT_LE(soft, 5e4);
  EXPECT_EQ(stiffness_of({{.stiffness_N_per_m = 5e4}, {.stiffness_N_per_m = 1e5}}), soft);
  EXPECT_EQ(stiffness_of({{.stiffness_N_per_m = 1e5}, {.stiffness_N_per_m = 5e4}}), soft);
  EXPECT_NEAR(stiffness_of({{.before_N = 1, .from_N = 0.02}}), stiff, 0.05 * stiff) << "the force was another before";
}

TEST(PreslidingStiffness, IsNotToldByARampThatDidNotBeginWithoutForceOrBentTooLittle) {
  EXPECT_EQ(stiffness_of({{.stiffness_N_per_m = 1e8}}), 0) << "less than two counts";
  EXPECT_EQ(stiffness_of({{.from_N = 1.6, .rest = 0}}), 0) << "above half of it from the first reading on";
  EXPECT_EQ(stiffness_of({{.from_N = 0.5, .rest = 0}}), 0) << "the beginning was not recorded";
  EXPECT_GT(stiffness_of({{.step_N = 0.14}}, 1), 0);
  EXPECT_EQ(stiffness_of({{.step_N = 0.14}}, 12), 0) << "it slid before it was seen under half of the force";
}

// Switches of the force

// 1 kg on 1 N of friction, pushed by 5 N for 100 readings and then braked by 5 N for 40, from rest.
Record push_and_brake(std::size_t lost = 1000) {
  Record record{period_s, 1e-9, 0.01, {}};
  double x = 0, v = 0;
  for (std::size_t i = 0; i < 140; ++i) {
    const double force_N = i < 100 ? 5 : -5;
    record.readings.push_back({x, force_N, i != lost});
    x += (v + (force_N - 1) * period_s / 2) * period_s, v += (force_N - 1) * period_s;
  }
  return record;
}

TEST(Switches, AreOfTwoForcesThatFollowOneAnotherWithoutALoss) {
  const Record record = push_and_brake(), lossy = push_and_brake(100);
  const auto found = switches_in(record, stretches_of(record), {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].mass_kg(), 1, 1e-4);
  EXPECT_TRUE(switches_in(lossy, stretches_of(lossy), {}).empty());
  const auto in_motion = switches_in_motion(record, stretches_of(record));
  ASSERT_EQ(in_motion.size(), 1U);
  EXPECT_EQ(in_motion[0].at, 100U);
  EXPECT_EQ(in_motion[0].before_N, 5);
  EXPECT_EQ(in_motion[0].after_N, -5);
  EXPECT_TRUE(switches_in_motion(lossy, stretches_of(lossy)).empty());
}

TEST(Switches, AreNoneWhereTheMotionDoesNotShowTheForce) {
  Record against = push_and_brake(), too_coarse = push_and_brake();
  for (Reading& reading : against.readings) reading.command_N *= -1;
  EXPECT_TRUE(switches_in(against, stretches_of(against), {}).empty()) << "it sped up against its force";
  too_coarse.resolution_m = 1e-3;
  for (Reading& reading : too_coarse.readings) reading.position_m = std::round(reading.position_m / 1e-3) * 1e-3;
  EXPECT_TRUE(switches_in(too_coarse, stretches_of(too_coarse), {}).empty());
}

// A switch from -change_N / 2 to change_N / 2 that shows this mass.
Switch switch_of(double change_N, double mass_kg, double residual_m = 0.3 * count_m) {
  Switch one;
  one.change_N = change_N;
  one.before.acceleration_m_s2 = -change_N / 2 / mass_kg, one.after.acceleration_m_s2 = change_N / 2 / mass_kg;
  one.after.residual_m = residual_m;
  return one;
}

TEST(MassOfSwitches, IsOfSixAtLeastWhereOneIsMuchGreaterThanAllOthers) {
  std::vector<Switch> switches(8, switch_of(10, 2));
  switches.push_back(switch_of(40, 1.93));
  const MassEstimate mass = mass_of(switches, empty_record());
  EXPECT_EQ(mass.switches, 9U);
  EXPECT_DOUBLE_EQ(mass.mass_kg, 2);
  EXPECT_NEAR(mass.spread, 0.035, 1e-9) << "it says how far one is off, though most agree";
}

TEST(MassOfSwitches, CountsNoneInWhichTheForceStepsWithinAParabola) {
  std::vector<Switch> switches(8, switch_of(40, 2));
  for (int i = 0; i < 3; ++i) switches.push_back(switch_of(60, 2.5, 20 * count_m));
  const MassEstimate mass = mass_of(switches, empty_record());
  EXPECT_EQ(mass.switches, 8U);
  EXPECT_EQ(mass.spread, 0);
  for (Switch& one : switches) one.after.residual_m = 20 * count_m;
  EXPECT_GT(mass_of(switches, empty_record()).spread, 0.2) << "where all are off alike, none is left out";
}

// Great ones at one place say nothing of the others, where friction or the drive may differ.
TEST(MassOfSwitches, IsAsUncertainAsSmallerOnesAreOffInProportionToTheirForce) {
  std::vector<Switch> switches(8, switch_of(100, 2));
  switches.push_back(switch_of(35, 2.2));
  const MassEstimate mass = mass_of(switches, empty_record());
  EXPECT_EQ(mass.switches, 8U);
  EXPECT_DOUBLE_EQ(mass.mass_kg, 2);
  EXPECT_EQ(mass.spread_of_greatest(), 0);
  EXPECT_NEAR(mass.spread, 0.05, 1e-9) << "0.1 of half the change that counts as great";
}

// Fits of a swing

TEST(SwingFit, IsNoneWhereTheReadingsDoNotTellItsCoefficients) {
  const Record record = push_and_brake();
  const SwitchInMotion whole{.first = 60, .at = 100, .last = 140, .before_N = 5, .after_N = -5};
  const auto fit = fit_swing(record, whole, swing_of_Hz(50));
  ASSERT_TRUE(fit);
  EXPECT_LT(fit->residual_m, 1e-4);
  SwitchInMotion few = whole;
  few.first = 97, few.last = 106;
  EXPECT_FALSE(fit_swing(record, few, swing_of_Hz(50))) << "nine readings for eight coefficients";
  EXPECT_FALSE(fit_swing(record, whole, swing_of_Hz(0))) << "a swing that stands still is a place";
  EXPECT_FALSE(swing_of(record, {few, few, few, few})) << "no rate of a swing suits so few readings";
  EXPECT_FALSE(swing_of(record, {whole, whole, whole})) << "three switches tell no swing";
}

TEST(SwingFit, SaysWhetherBothSlideAllTheTime) {
  const SwitchInMotion one{.first = 0, .at = 20, .last = 40, .before_N = 0, .after_N = 1};
  const Swing swing = swing_of_Hz(50);
  SwingFit sliding;
  sliding.cubic = {0, 0.1, 0, 0};
  sliding.per_kg = 1, sliding.swing_m_per_N = 1e-5;
  EXPECT_TRUE(both_slide(sliding, one, swing, period_s));
  SwingFit fit = sliding;
  fit.per_kg = -1;
  EXPECT_FALSE(both_slide(fit, one, swing, period_s)) << "no mass is below 0";
  fit = sliding, fit.swing_m_per_N = -1e-5;
  EXPECT_FALSE(both_slide(fit, one, swing, period_s)) << "nor is a share of it";
  fit = sliding, fit.ringing = {1e-3, 0};
  EXPECT_FALSE(both_slide(fit, one, swing, period_s)) << "0.3 m/s of swinging on 0.1 m/s turn the motor round";
  fit = sliding, fit.cubic[1] = -0.1;
  EXPECT_FALSE(both_slide(fit, one, swing, period_s)) << "it goes the other way";
}

// Totals

FrictionSample sample(double position_m, double speed_m_s, int direction, double friction_N = 3) {
  return {position_m, speed_m_s, direction, {friction_N, friction_N}, 0};
}

TEST(Totals, CountAMotionFromEachRestTurnAndWayBack) {
  Identification found;
  found.friction = {sample(0.0, 0, 1),   sample(0.1, 1, 1),    sample(0.2, 1, 1),  // one motion
                    sample(0.15, 1, 1),                                            // it was led back in between
                    sample(0.1, -1, -1), sample(0.05, -1, -1),                     // it turned
                    sample(0.05, 0, -1)};                                          // and broke away again
  number_motions(found);
  std::vector<std::size_t> numbers;
  for (const FrictionSample& one : found.friction) numbers.push_back(one.motion);
  EXPECT_EQ(numbers, (std::vector<std::size_t>{1, 1, 1, 2, 3, 3, 4}));
  EXPECT_EQ(found.motions, 4U);
}

TEST(Totals, TakeTheUncertaintyOfTheMassFromTwiceTheSpreadOrSmallerSwitchesAndTheMarginAtLeast) {
  Identification found;
  found.friction = {sample(0, 1, 1)};
  const auto uncertainty = [&](double least_kg, double spread) {
    found.mass_uncertainty = 0, found.mass = {1, {least_kg, 1}, 8, spread};
    sum_up(found, {});
    return found.mass_uncertainty;
  };
  EXPECT_NEAR(uncertainty(0.97, 0.03), 0.06, 1e-12);
  EXPECT_NEAR(uncertainty(0.97, 0.08), 0.08, 1e-12) << "smaller switches are further off, in proportion";
  EXPECT_DOUBLE_EQ(uncertainty(0.999, 0.001), 0.01);
}

TEST(Totals, RefuseAFrictionThatPushes) {
  Identification found;
  found.mass = {1, {1, 1}, 3};
  found.friction = {sample(0, 1, 1, 3), sample(0, 1, -1, -0.5)};
  sum_up(found, {});
  const std::string said = testing::refusal([&] { require_friction(found); });
  EXPECT_NE(said.find("friction comes out at -0.5 N at the least"), std::string::npos) << said;
  EXPECT_NE(said.find("balance a weight"), std::string::npos) << said;
  found.friction.pop_back();
  sum_up(found, {});
  EXPECT_EQ(testing::refusal([&] { require_friction(found); }), "");
}

// What is said

// The words are the same whatever decides, so that a page can show them.
TEST(Summary, SaysOfWhatTheUncertaintyOfTheMassIsTheMost) {
  Identification found;
  found.mass = {1, {0.99, 1.01}, 8, 0.03, 0.02};
  const std::string said = summary(found);
  EXPECT_NE(said.find("the most of twice their spread (2.0 %), what smaller ones are off in proportion (3.0 %), twice "
                      "what longer and shorter looks differ by (4.0 %) and 1 %"),
            std::string::npos)
      << said;
  found.spring = SpringEstimate{};
  EXPECT_NE(summary(found).find("the most of twice the spread of motor and load, and 3 %"), std::string::npos);
}

TEST(Summary, SaysOfLatencyLagAndBendingWhatWasSeen) {
  Identification found;
  found.mass = {1, {1, 1}, 3};
  found.latency = late_by(1);
  EXPECT_NE(summary(found).find("latency        1 period, and a current loop too fast to be seen"), std::string::npos)
      << summary(found);
  EXPECT_EQ(summary(found).find("bends"), std::string::npos);
  found.latency = late_by(2);
  found.latency.lag_s = 1.25e-3, found.latency.lag_is_seen = true;
  found.presliding_N_per_m = 2.5e6;
  EXPECT_NE(summary(found).find("latency        2 periods, and a current loop of 1.2 ms"), std::string::npos)
      << summary(found);
  EXPECT_NE(summary(found).find("before sliding it bends: 2.5e+06 N/m at least"), std::string::npos) << summary(found);
}

}  // namespace
}  // namespace breakaway::evaluation
