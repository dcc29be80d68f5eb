// How an experiment ends on an axis that is not what it expects, and what it says then.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../unknown_axis.hpp"
#include "../explained_enum.hpp"
#include "breakaway/identify/experiment.hpp"

namespace breakaway::identify {
namespace {

using testing::Moment;
using testing::Slider;
using testing::UnknownAxis;

ExperimentParameters<double> told() { return testing::told<double>(UnknownAxis{}); }

TEST(ExperimentEndings, SayWhatToDo) {
  using E = Ending;
  test::expect_sentences<E>({{E::none, {"goes on"}},
                             {E::complete, {"complete"}},
                             {E::out_of_time, {"more time", "less travel"}},
                             {E::asked, {"asked"}},
                             {E::no_room, {"check the limits of position"}},
                             {E::jammed, {"check brake and clutch", "more force"}},
                             {E::drifting, {"pulled by a load"}},
                             {E::noisy, {"filter the noise", "damp what rings"}},
                             {E::not_a_number, {"check encoder and bus"}}});
}

TEST(ExperimentEndings, ASecondBeforeItsTimeIsOverItBringsTheAxisToRest) {
  auto p = told();
  p.duration_s = 1.2;
  Experiment<double> experiment{p};
  int periods = 0;
  while (!experiment.finished() && ++periods < 10'000) experiment.update({0.0, 0.0, true});
  EXPECT_EQ(experiment.ending(), Ending::out_of_time);
  EXPECT_GE(periods, 199);
  EXPECT_LE(periods, 1200);
  EXPECT_EQ(experiment.update({0.0, 0.0, true}).force_N, 0);
}

// Whatever jumps further than the axis may move in its first rest, or never lets it seem to rest in a later one.
TEST(ExperimentEndings, NameReadingsThatJumpToAndFro) {
  std::mt19937_64 bits{3};
  for (const double counts : {1.5, 3.0, 30.0}) {
    std::normal_distribution<> noise{0, counts};
    Experiment<double> experiment{told()};
    int periods = 0;
    while (!experiment.finished() && ++periods < 20'000) {
      const double reading_m = std::round(noise(bits)) * told().encoder_resolution_m;
      ASSERT_LE(std::abs(experiment.update({reading_m, 0.0, true}).force_N), told().max_force_N);
    }
    EXPECT_EQ(experiment.ending(), Ending::noisy) << counts << " counts: " << to_string(experiment.ending());
    EXPECT_EQ(experiment.fault(), law::ControlFault::drifting) << "the loop takes the force off";
  }
}

// An axis that is pulled away is not noisy, however fast it goes, also where its readings flicker by a count.
TEST(ExperimentEndings, AnAxisThatIsPulledAwayDrifts) {
  for (const double counts_a_period : {0.05, 0.3, 3.0, 300.0}) {
    Experiment<double> experiment{told()};
    for (int k = 0; k < 20'000 && !experiment.finished(); ++k)
      experiment.update({(std::floor(k * counts_a_period) + k % 2) * told().encoder_resolution_m, 0.0, true});
    EXPECT_EQ(experiment.ending(), Ending::drifting) << counts_a_period << ": " << to_string(experiment.ending());
  }
}

TEST(ExperimentEndings, ThereIsNoRoomBelowTheTravelAsThereIsNoneAbove) {
  for (const double start_m : {-0.3, 0.3}) {
    Experiment<double> experiment{told()};
    EXPECT_EQ(experiment.update({start_m, 0.0, true}).force_N, 0);
    EXPECT_EQ(experiment.ending(), Ending::no_room) << start_m;
  }
}

TEST(ExperimentEndings, ThereIsNoRoomInATravelOfLessThanAThousandCounts) {
  for (const int counts : {990, 1010}) {
    auto p = told();
    p.highest_m = 0.5 * counts * p.encoder_resolution_m, p.lowest_m = -p.highest_m;
    Experiment<double> experiment{p};
    experiment.update({0.0, 0.0, true});
    EXPECT_EQ(experiment.ending(), counts < 1000 ? Ending::no_room : Ending::none) << counts;
  }
}

TEST(ExperimentEndings, ItBeginsWithTheFirstSampleThatIsNotLost) {
  Experiment<double> late{told()}, prompt{told()};
  for (int k = 0; k < 500; ++k) EXPECT_EQ(late.update({0.0, 0.0, false}).force_N, 0);
  for (int k = 0; k < 2000; ++k)
    ASSERT_EQ(late.update({0.0, 0.0, true}).force_N, prompt.update({0.0, 0.0, true}).force_N) << k;
}

TEST(ExperimentEndings, AnAxisThatNoBrakingStopsIsLeftWithoutForceAfterAWhile) {
  Experiment<double> experiment{told()};
  double position_m = -0.2;
  for (int k = 0; k < 400; ++k) experiment.update({position_m, 0.0, true});
  experiment.request_end();
  int periods = 0;
  while (!experiment.finished() && ++periods < 30'000) experiment.update({position_m += 1e-5, 0.0, true});
  EXPECT_LT(periods, 30'000);
  EXPECT_EQ(experiment.update({position_m += 1e-5, 0.0, true}).force_N, 0);
  EXPECT_EQ(experiment.ending(), Ending::asked);
}

// From this stage on nothing that the drive gives moves the axis.
Ending ending_of_one_that_sticks_from(Stage stage) {
  Experiment<double> experiment{told()};
  double friction_N = 3;
  Slider slider{{}, [&](const Moment&) { return friction_N; }, 0, 0};
  for (int k = 0; !experiment.finished() && k < 100'000; ++k) {
    if (experiment.stage() == stage) friction_N = 1e3;
    const double force_N = experiment.update({std::round(slider.position_m() / 1e-6) * 1e-6, 0.0, true}).force_N;
    EXPECT_TRUE(force_N == 0 || experiment.fault() == law::ControlFault::none)
        << "force in the very period that ends it";
    slider.run(force_N, 1e-3, 4);
  }
  EXPECT_EQ(friction_N, 1e3) << "it never came so far";
  EXPECT_EQ(experiment.update({0.0, 0.0, true}).force_N, 0);
  return experiment.ending();
}

TEST(ExperimentEndings, AnAxisThatSticksAfterItMovedIsNamedByItsNextRamp) {
  EXPECT_EQ(ending_of_one_that_sticks_from(Stage::ramps), Ending::jammed);
  EXPECT_EQ(ending_of_one_that_sticks_from(Stage::pairs), Ending::jammed) << "pushes that move nothing come to an end";
  EXPECT_EQ(ending_of_one_that_sticks_from(Stage::sweep), Ending::jammed);
}

}  // namespace
}  // namespace breakaway::identify
