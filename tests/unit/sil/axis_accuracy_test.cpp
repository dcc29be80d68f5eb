#include "breakaway/sil/axis_accuracy.hpp"

#include <gtest/gtest.h>

#include <string>

#include "../refusal.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_scenario.hpp"

namespace {

using namespace breakaway;
using scenario::Integrator;

scenario::Scenario scene(const char* name) {
  return scenario::read_scenario(std::string{BREAKAWAY_SOURCE_DIR "/sim/scenarios/"} + name);
}

sil::Accuracy choose(scenario::Scenario s, double accuracy_m) {
  s.run->accuracy_m = accuracy_m;
  return sil::choose_method(s);
}

// The rounding of this very way leaves 1.1e-10 m of it, and less than that is refused.
TEST(AxisAccuracy, HoldsWhatIsAskedOnTheWholeWay) {
  for (const char* name : {"can_axis.toml", "vertical_axis.toml", "impulsive_example.toml"}) {
    scenario::Scenario s = scene(name);
    const sil::Result exact = sil::run_scenario(s, {.trace = !s.ideal()});
    for (const double accuracy_m : {1e-3, 1e-6, 2e-10}) {
      s.run->accuracy_m = accuracy_m;
      const sil::Result result = sil::run_scenario(s, {.trace = !s.ideal()});
      ASSERT_TRUE(result.accuracy) << name;
      const double error_m = sil::distance_m(result, exact, s.ideal());
      EXPECT_LE(error_m, accuracy_m) << name;
      EXPECT_LE(error_m, 2 * result.accuracy->error_estimate_m) << name;
      EXPECT_EQ(result.accuracy->method.integrator, Integrator::adaptive);
    }
  }
}

TEST(AxisAccuracy, CostsLessWhereLessIsAsked) {
  const sil::Accuracy coarse = choose(scene("can_axis.toml"), 1e-3), fine = choose(scene("can_axis.toml"), 2e-10);
  EXPECT_GT(coarse.method.tolerance, 1e3 * fine.method.tolerance);
  EXPECT_LT(coarse.cost_s, fine.cost_s);
}

TEST(AxisAccuracy, NeedsNoToleranceWhereFrictionIsConstant) {
  scenario::Scenario s = scene("can_axis.toml");
  s.worlds.front().friction = {s.node.axes.front().friction.bounds, model::shape::constant(0.5)};
  const sil::Accuracy accuracy = choose(s, 1e-9);
  EXPECT_EQ(accuracy.method.integrator, Integrator::event_driven);
  EXPECT_LE(accuracy.error_estimate_m, 1e-9);
}

TEST(AxisAccuracy, ComparesTheRestOfTheLongerRunWithWhereTheShorterOneStands) {
  sil::Result a, b;
  a.axes.resize(1);
  b.axes.resize(1);
  for (const double position_m : {0.0, 1.0}) a.axes[0].trace.push_back({.position_m = position_m});
  for (const double position_m : {0.0, 1.0, 1.5}) b.axes[0].trace.push_back({.position_m = position_m});
  EXPECT_EQ(sil::distance_m(a, b, false), 0.5);
  b.axes[0].final_error_m = 0.75;
  EXPECT_EQ(sil::distance_m(b, a, false), 0.75);
}

TEST(AxisAccuracy, RefusesWhatRoundingForbids) {
  try {
    choose(scene("can_axis.toml"), 1e-18);
    FAIL() << "rounding alone is more";
  } catch (const sil::AccuracyRefused& refusal) {
    for (const char* part : {"can_axis.toml", "1e-18", "adaptive errs by", "rounding"}) {
      EXPECT_NE(std::string{refusal.what()}.find(part), std::string::npos) << refusal.what();
    }
  }
}

// A run over friction that changes every 50 um takes some two fifths of what a run may cost, and its error is judged by
// twelve more.
TEST(AxisAccuracy, RefusesWhatIsTooCostlyToJudge) {
  scenario::Scenario s = scene("impulsive_example.toml");
  s.worlds.front().friction = {s.node.axes.front().friction.bounds, model::shape::sine_in_position(5e-5, 0)};
  const std::string said = breakaway::testing::refusal([&] { choose(s, 1e-3); });
  EXPECT_NE(said.find("judging the error would take 13 runs, and one takes"), std::string::npos) << said;
  EXPECT_NE(said.find("leave accuracy_m out"), std::string::npos) << said;
}

}  // namespace
