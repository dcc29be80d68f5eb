// How an approach under the coast "brake" ends where it does not lead near, and what follows.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scripted_axis.hpp"

namespace breakaway::law {
namespace {

using testing::Scripted;

struct Outcome {
  int approaches = 0;
  int kicks = 0;
};

// The axis stands at `ends_m` of each approach from its first sample on.
template <class Ends>
Outcome run(Scripted& axis, const Ends& ends_m) {
  Outcome outcome;
  Mode before = Mode::hold;
  for (int i = 0; i < 20'000 && outcome.kicks == 0; ++i) {
    const auto out = axis.show(ends_m(outcome.approaches));
    if (out.mode == Mode::approach && before != Mode::approach) ++outcome.approaches;
    before = out.mode;
    outcome.kicks += out.kicked ? 1 : 0;
  }
  return outcome;
}

TEST(ApproachEnd, BeginsKicksAtMostAsFarAwayAsTheyAreFor) {
  Scripted near{0}, far{0};
  const float begin_m = near.kicks().begin_m();
  const Outcome kicked = run(near, [&](int) { return -0.999F * begin_m; });
  EXPECT_EQ(kicked.kicks, 1);
  EXPECT_EQ(kicked.approaches, 1);
  const Outcome again = run(far, [&](int approaches) { return (approaches < 3 ? -1.001F : -0.999F) * begin_m; });
  EXPECT_EQ(again.kicks, 1);
  EXPECT_EQ(again.approaches, 3);
}

TEST(ApproachEnd, IsWhereKicksBeginWhenAFewApproachesDoNotLeadNear) {
  Scripted axis{0};
  const float far_m = 2 * axis.kicks().begin_m();
  const auto stuck = [&](int) { return far_m; };
  const Outcome first = run(axis, stuck);
  EXPECT_EQ(first.kicks, 1);
  EXPECT_EQ(first.approaches, KickJudge<float>::most_far_ends);
  const Outcome next = run(axis, stuck);
  EXPECT_EQ(next.kicks, 1);
  EXPECT_EQ(next.approaches, 0);
  // They are counted anew for a new target.
  axis.controller().shift_target(0);
  EXPECT_EQ(run(axis, stuck).approaches, KickJudge<float>::most_far_ends);
}

// The periods until the approach is given up of an axis that has come this far after so many periods.
template <class Way>
int given_up_after(const Way& way_m) {
  Scripted axis{0};
  for (int i = 0; i < 5000; ++i) {
    if (axis.show(-1 + way_m(static_cast<float>(i))).mode != Mode::approach) return i;
  }
  return 5000;
}

TEST(ApproachEnd, ComesSoonForAnAxisThatCreepsAndNotForAHeavyOne) {
  const auto kicks = Scripted{0}.kicks();
  const float periods = kicks.patient_periods, slow_m = kicks.approach.switch_speed_m_s / 64 * 1e-3F;
  EXPECT_LE(given_up_after([&](float i) { return slow_m / 2 * i; }), 5 * kicks.patient_periods);
  // As slow as that for two times as many periods, but ever faster.
  EXPECT_EQ(given_up_after([&](float i) { return slow_m / 4 * i * i / periods; }), 5000);
}

// Where the first kick begins on an axis under its greatest friction that is approached no faster than this.
double first_kick_m(const design::BrakedClass& axes, double share_of_least_speed) {
  const auto design = design::design_braked_kicks<float>(axes);
  auto p = testing::braked_axis();
  p.friction = {static_cast<float>(axes.friction.lower_N), static_cast<float>(axes.friction.upper_N)};
  p.max_approach_speed_m_s = static_cast<float>(share_of_least_speed * design::least_approach_speed_m_s(axes, design));
  const auto greatest = [&](const breakaway::testing::Moment&) { return axes.friction.upper_N; };
  const auto end = breakaway::testing::run_kicked_axis<float>(p, testing::no_k3, design.kicks,
                                                              {.lag_s = axes.lag_s.most}, greatest, -0.1, 0, 60);
  return end.first_kick_m;
}

// Of what the least speed covers, a constant friction shows one: that its greatest asks for more force than the plan
// gives from a speed far below. Bounds that hardly differ leave next to nothing of that, and rest on what a reading is
// off.
TEST(ApproachEnd, IsNearWhereItsSpeedLeavesTheForceThatBreaksTheAxisAway) {
  for (const double lag_s : {0.0, 1e-3, 5e-3}) {
    design::BrakedClass axes = breakaway::testing::axes_of_the_scenes(lag_s);
    for (const double least_N : {2.5, 4.3, 4.45, 4.49}) {
      SCOPED_TRACE(std::to_string(lag_s) + " s, " + std::to_string(least_N) + " N");
      axes.friction.lower_N = least_N;
      EXPECT_LT(first_kick_m(axes, 1.001), 1e-3);
    }
    axes.friction.lower_N = 2.5;
    EXPECT_GT(first_kick_m(axes, 0.25), 0.0999);
    axes.friction.lower_N = 4.49;
    EXPECT_GT(first_kick_m(axes, 0.01), 0.0999);
  }
}

TEST(AxisControllerVelocity, IsNoneOfATargetThatMovesThoughTheLawHasAFault) {
  Scripted axis{0};
  axis.pulse_at(-1e-3F);
  axis.show(-1e-3F);
  axis.show(-0.9e-3F);
  EXPECT_NEAR(axis.controller().velocity_m_s(), 0.1F, 1e-5F);
  axis.show(std::nanf(""));
  axis.controller().shift_target(2e-3F);
  EXPECT_EQ(axis.controller().mode(), Mode::fault);
  EXPECT_NEAR(axis.controller().velocity_m_s(), 0.1F, 1e-5F);
}

}  // namespace
}  // namespace breakaway::law
