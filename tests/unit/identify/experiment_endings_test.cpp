// How an experiment ends on an axis that is not what it expects, and what it says then.
#include <gtest/gtest.h>

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
