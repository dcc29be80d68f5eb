// Experiments on axes that are much heavier, lighter or shorter than most, and on what changes on the way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../../campaign/random_unknown_joint.hpp"
#include "../../unknown_axis.hpp"
#include "breakaway/identify/experiment.hpp"

namespace breakaway::identify {
namespace {

using testing::ExperimentRun;
using testing::Moment;
using testing::run_experiment;
using testing::Slider;
using testing::UnknownAxis;

struct OddAxis {
  const char* what;
  double mass_kg, friction_N, max_force_N, force_step_N, half_travel_m;
  int latency_periods;
};

TEST(ExperimentEdges, SweepsTheTravelOfAxesThatAreMuchHeavierLighterOrShorterThanMost) {
  for (const OddAxis& odd :
       {OddAxis{"it coasts for more than a second after each push", 38, 0.43, 1.7, 0.002, 0.033, 1},
        OddAxis{"it is at speed before its push is seen", 0.05, 1, 20, 0.02, 0.25, 1},
        OddAxis{"its sweep ends at the third turn", 0.0455, 1.03, 28, 0.025, 0.0255, 3},
        OddAxis{"no push has room in its travel", 7, 19, 40, 0.04, 0.004, 3},
        OddAxis{"its pairs come to no end", 2.9, 0.0503, 0.1445, 0.025, 0.0107, 2}}) {
    UnknownAxis axis;
    axis.mass_kg = odd.mass_kg, axis.friction_N = odd.friction_N, axis.max_force_N = odd.max_force_N;
    axis.lowest_m = -odd.half_travel_m, axis.highest_m = odd.half_travel_m;
    axis.latency_periods = odd.latency_periods;
    axis.force_step_N = odd.force_step_N;
    axis.resolution_m = 2e-7;
    const ExperimentRun run = run_experiment(axis);
    EXPECT_EQ(run.ending, Ending::complete) << odd.what << ": " << to_string(run.ending);
    EXPECT_GE(run.lowest_m, axis.lowest_m) << odd.what;
    EXPECT_LE(run.highest_m, axis.highest_m) << odd.what;
    EXPECT_LE(run.fastest_m_s, axis.max_speed_m_s) << odd.what;
    EXPECT_EQ(run.speed_at_end_m_s, 0) << odd.what;
  }
}

// A push in a short travel is braked before it tells the mass. A brake that followed the speed late, as readings and
// forces are, would drive the axis to and fro, and out of its travel.
TEST(ExperimentEdges, IsNotDrivenOutOfItsTravelByABrakeThatActsLate) {
  for (const double mass_kg : {0.2, 0.5, 1.0}) {
    for (const double half_travel_m : {0.01, 0.02}) {
      UnknownAxis axis;
      axis.mass_kg = mass_kg, axis.friction_N = 5, axis.max_force_N = 22;
      axis.lowest_m = -half_travel_m, axis.highest_m = half_travel_m;
      axis.latency_periods = 3;
      const ExperimentRun run = run_experiment(axis);
      EXPECT_EQ(run.ending, Ending::complete) << mass_kg << " kg: " << to_string(run.ending);
      EXPECT_GE(run.lowest_m, axis.lowest_m) << mass_kg << " kg in " << half_travel_m;
      EXPECT_LE(run.highest_m, axis.highest_m) << mass_kg << " kg in " << half_travel_m;
    }
  }
}

// It turns as it is braked and creeps back: it is given two seconds to come to rest, and ten more before it is named.
TEST(ExperimentEdges, LeavesAnAxisWithoutForceThatNoBrakingStopsAndSaysThatItIsDriven) {
  Experiment<double> experiment{testing::told<double>(UnknownAxis{})};
  double position_m = 0;
  int periods = 0;
  const auto next_N = [&] {
    ++periods;
    return experiment.update({position_m, 0.0, true}).force_N;
  };
  while (experiment.stage() == Stage::rest || periods < 400) next_N();
  double most_N = 0;
  for (; position_m < 0.23; position_m += 1e-3) most_N = std::max(most_N, std::abs(next_N()));
  EXPECT_GT(most_N, 0);
  // It creeps back by two counts a period, whatever is commanded.
  int braked = 0;
  for (int k = 0; k < 2100; ++k, position_m -= 2e-6) braked += next_N() != 0;
  EXPECT_GT(braked, 0);
  EXPECT_LT(braked, 20) << "against what it did before it turned";
  for (int k = 0; k < 8000; ++k, position_m -= 2e-6) ASSERT_EQ(next_N(), 0) << k;
  EXPECT_EQ(experiment.ending(), Ending::none);
  for (int k = 0; k < 4000 && experiment.ending() == Ending::none; ++k, position_m -= 2e-6) next_N();
  EXPECT_EQ(experiment.ending(), Ending::drifting);
}

// Friction that falls once the sweep has begun lets the load break away while its spring is bent. The force is gone
// in that very period, and the next hop does without bending.
void expect_no_force_once_it_slides(double upwards_N, double downwards_N) {
  UnknownAxis axis;
  auto told = testing::told<double>(axis);
  told.load_on_spring = true;
  bool swept = false;
  Slider slider{{.mass_kg = axis.mass_kg},
                [&](const Moment& now) {
                  if (!swept) return 3.0;
                  return (now.velocity_m_s != 0 ? now.velocity_m_s : now.force_N) > 0 ? upwards_N : downwards_N;
                },
                0,
                0};
  Experiment<double> experiment{told};
  double lowest_m = 0, highest_m = 0;
  for (int k = 0; !experiment.finished() && k < 70'000; ++k) {
    swept = swept || experiment.stage() == Stage::sweep;
    slider.run(experiment.update({std::round(slider.position_m() / 1e-6) * 1e-6, 0.0, true}).force_N, 1e-3, 4);
    lowest_m = std::min(lowest_m, slider.position_m()), highest_m = std::max(highest_m, slider.position_m());
  }
  EXPECT_EQ(experiment.ending(), Ending::complete) << to_string(experiment.ending());
  EXPECT_GE(lowest_m, axis.lowest_m);
  EXPECT_LE(highest_m, axis.highest_m);
}

// A motor that hardly rubs is swung to and fro by its load while it halts, and braked again where it gets further.
TEST(ExperimentEdgesWithALoad, KeepsAMotorThatIsPulledAlongByItsLoadWithinTheTravel) {
  for (const double load_N : {0.5, 1.0, 2.4}) {
    campaign::UnknownJoint axis;
    axis.motor.mass_kg = axis.spring.motor_kg = 0.4;
    axis.load.mass_kg = axis.spring.load_kg = 1.4;
    axis.motor.friction_N = 0.05, axis.load.friction_N = load_N;
    axis.motor.latency_periods = 2;
    axis.spring.stiffness_N_per_m = std::pow(2 * std::numbers::pi * 13, 2) * 0.4 * 1.4 / 1.8;
    axis.damping = 0.005;
    const ExperimentRun run = campaign::run_experiment<double>(axis);
    EXPECT_NE(run.ending, Ending::none) << load_N;
    EXPECT_GE(run.lowest_m, axis.motor.lowest_m) << load_N;
    EXPECT_LE(run.highest_m, axis.motor.highest_m) << load_N;
  }
}

TEST(ExperimentEdgesWithALoad, GoesOnWithoutBendingWhereTheLoadBrokeAwayInABend) {
  expect_no_force_once_it_slides(1.2, 1.2);
  expect_no_force_once_it_slides(3, 1.2);
}

}  // namespace
}  // namespace breakaway::identify
