// What kicks show of an axis that is not what was stated, and how many of them it takes.
#include "breakaway/law/kick_judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scripted_axis.hpp"

namespace breakaway::law {
namespace {

using testing::braked_axis;
using testing::Scripted;

TEST(KickJudge, NamesAnAxisThatHunts) {
  Scripted axis{0};
  int kicks = 0;
  // Something throws it back by one count more than each kick brings it on.
  for (int i = 0; i < 20'000 && axis.controller().fault() == ControlFault::none; ++i) {
    if (axis.show(-1e-4F - 1e-6F * static_cast<float>(kicks)).kicked) ++kicks;
  }
  EXPECT_EQ(axis.controller().fault(), ControlFault::hunting);
  EXPECT_EQ(kicks, KickJudge<float>::most_kicks);
}

TEST(KickJudge, NamesAnAxisThatGoesFurtherThanWhatWasToldLetsIt) {
  Scripted axis{0};
  int kicks = 0;
  for (int i = 0; i < 20'000 && axis.controller().fault() == ControlFault::none; ++i) {
    if (axis.show(kicks % 2 == 0 ? -1e-4F : 1e-4F).kicked) ++kicks;
  }
  EXPECT_EQ(axis.controller().fault(), ControlFault::contradicted);
  EXPECT_EQ(kicks, KickJudge<float>::most_contradictions);
  // Twice the way that 2.5 N and the brake of 2.25 N allow.
  EXPECT_NEAR(axis.controller().seen_friction_N(), 4.75F / 2 - 2.25F, 0.3F);
}

// At its last kick the axis would also count as one that hunts: what its kicks show of the friction says more.
TEST(KickJudge, NamesOfOneKickTheFirstFaultThatItShows) {
  Scripted axis{0};
  constexpr int most = KickJudge<float>::most_kicks;
  int kicks = 0;
  for (int i = 0; i < 100'000 && axis.controller().fault() == ControlFault::none; ++i) {
    const int far = std::max(kicks - (most - KickJudge<float>::most_contradictions), 0);
    if (axis.show(far % 2 == 0 ? -1e-4F : 1e-4F).kicked) ++kicks;
  }
  EXPECT_EQ(kicks, most);
  EXPECT_EQ(axis.controller().fault(), ControlFault::contradicted);
}

TEST(KickJudge, NamesAnAxisThatGoesLessFarThanWhatWasToldMakesIt) {
  Scripted axis{0};
  int kicks = 0;
  for (int i = 0; i < 20'000 && axis.controller().fault() == ControlFault::none; ++i) {
    if (axis.show(-1e-3F + 2e-5F * static_cast<float>(kicks)).kicked) ++kicks;
  }
  EXPECT_EQ(axis.controller().fault(), ControlFault::contradicted);
  EXPECT_EQ(kicks, KickJudge<float>::most_contradictions);
  EXPECT_GT(axis.controller().seen_friction_N(), 4.5F);
}

TEST(KickJudge, NamesAnAxisThatItsBrakeDrivesBack) {
  Scripted axis{0};
  float position_m = -1e-3F;
  for (int i = 0; i < 20'000 && axis.controller().fault() == ControlFault::none; ++i) {
    if (!axis.show(position_m).kicked) continue;
    axis.show(position_m + 4e-4F);
    axis.show(position_m += 2e-4F);
  }
  EXPECT_EQ(axis.controller().fault(), ControlFault::contradicted);
  EXPECT_EQ(axis.controller().seen_friction_N(), axis.kicks().brake_N);
}

TEST(KickJudge, AccusesNoAxisThatHasArrived) {
  Scripted axis{0};
  float position_m = -8e-4F;
  int kicks = 0;
  for (int i = 0; i < 2'000 && axis.controller().fault() == ControlFault::none; ++i) {
    if (!axis.show(position_m).kicked) continue;
    ++kicks;
    axis.show(position_m + 4e-4F);
    axis.show(position_m += 2e-4F);
    if (kicks == KickJudge<float>::most_contradictions) position_m = 0;
  }
  EXPECT_EQ(kicks, KickJudge<float>::most_contradictions);
  EXPECT_EQ(axis.controller().fault(), ControlFault::none);
  EXPECT_EQ(axis.controller().mode(), Mode::hold);
}

// Kicks of an axis that reads this, until it is held or ends by name, or is kicked so often.
int kicks_at(Scripted& axis, float reading_m, int most = 1000) {
  int kicks = 0;
  for (int i = 0; i < 50'000 && kicks < most; ++i) {
    const ControlOutput<float> out = axis.show(reading_m);
    if (out.kicked) ++kicks;
    if (out.mode == Mode::hold || out.mode == Mode::fault) break;
  }
  return kicks;
}

// It may be 2.5 um away, and within a tolerance of 1.55 um a reading promises 2.05 um.
TEST(KickJudge, KnowsHowFarKicksAreSureToHaveLedAnAxisThatShowsNoneOfThem) {
  Scripted axis{0, braked_axis(1.55e-6F)};
  const float sure_m = axis.kicks().sure.from(2e-6F);
  ASSERT_GT(2 * sure_m, 0.45e-6F);
  ASSERT_LT(sure_m, 0.45e-6F);
  EXPECT_EQ(kicks_at(axis, -2e-6F), 2);
  EXPECT_EQ(axis.controller().mode(), Mode::hold);
}

TEST(KickJudge, KnowsNothingOfKicksToAnotherTarget) {
  Scripted axis{0, braked_axis(1.55e-6F)};
  EXPECT_EQ(kicks_at(axis, -2e-6F, 1), 1);
  axis.controller().shift_target(2e-6F);
  EXPECT_EQ(kicks_at(axis, -2e-6F), 2);
}

TEST(KickJudge, BelievesAReadingThatContradictsWhatIsKnown) {
  Scripted axis{0, braked_axis(1.55e-6F)};
  EXPECT_EQ(kicks_at(axis, -2e-6F, 1), 1);
  EXPECT_EQ(kicks_at(axis, -3e-6F, 1), 1) << "it may be 3.5 um away, whatever the last kick did";
  EXPECT_EQ(kicks_at(axis, -2e-6F), 2);
  EXPECT_EQ(axis.controller().mode(), Mode::hold);
}

// The last of all kicks counts as the others do.
TEST(KickJudge, AccusesNoAxisThatItsLastKickIsSureToHaveLedNearEnough) {
  constexpr int most = KickJudge<float>::most_kicks;
  Scripted axis{0, braked_axis(1.55e-6F)};
  EXPECT_EQ(kicks_at(axis, -4e-6F, most - 2), most - 2);
  EXPECT_EQ(kicks_at(axis, -2e-6F), 2);
  EXPECT_EQ(axis.controller().fault(), ControlFault::none);
  EXPECT_EQ(axis.controller().mode(), Mode::hold);
}

// The other side of the target is no nearer for it.
TEST(KickJudge, KnowsNothingOnTheOtherSideOfTheTarget) {
  Scripted axis{0, braked_axis(1.55e-6F)};
  EXPECT_EQ(kicks_at(axis, -2e-6F, 1), 1);
  EXPECT_EQ(kicks_at(axis, 2e-6F), 2);
}

TEST(KickJudge, KnowsNothingOfKicksThatALoweredLimitMakesWeaker) {
  Scripted axis{0, braked_axis(1.55e-6F)};
  axis.controller().limit_force(4.6F);
  EXPECT_EQ(kicks_at(axis, -2e-6F), KickJudge<float>::most_kicks);
  EXPECT_EQ(axis.controller().fault(), ControlFault::jammed);
}

TEST(KickJudge, KnowsNothingOfAKickThatIsMadeWeakerOnItsWay) {
  Scripted axis{0, braked_axis(1.55e-6F)};
  EXPECT_EQ(kicks_at(axis, -2e-6F, 1), 1);
  axis.controller().limit_force(40);
  EXPECT_EQ(kicks_at(axis, -2e-6F), 2) << "as many as without the first";
  EXPECT_EQ(axis.controller().mode(), Mode::hold);
}

// A reading that is further off than half a count beyond the tolerance is no end, whatever is known.
TEST(KickJudge, KeepsToTheTolerance) {
  Scripted axis{0, braked_axis(1.65e-6F)};
  EXPECT_EQ(kicks_at(axis, -3e-6F), KickJudge<float>::most_kicks);
  EXPECT_EQ(axis.controller().mode(), Mode::fault);
}

TEST(KickJudge, NamesAnAxisThatDoesNotMove) {
  Scripted axis{0};
  for (int i = 0; i < 20'000 && axis.controller().fault() == ControlFault::none; ++i) axis.show(-1e-4F);
  EXPECT_EQ(axis.controller().fault(), ControlFault::jammed);
}

// Where each kick leads to, when it is judged without a brake.
template <class Judge>
ControlFault fault_of(Judge judge, int kicks, float (*place_m)(int), int& judged) {
  KickJudge<float> all;
  ControlFault fault = ControlFault::none;
  all.forget();
  for (judged = 0; judged < kicks && fault == ControlFault::none; ++judged) {
    all.kicked(judged == 0 ? -1e-4F : place_m(judged - 1));
    fault = judge(all, place_m(judged));
  }
  return fault;
}

// The last kick of all does nothing, and those before only led to and fro. Under the coast "pd" all of them count,
// under "work" those since it was nearest.
TEST(KickJudge, CallsAnAxisHuntingThatMovedSinceItWasNearest) {
  int judged = 0;
  const auto to_and_fro = [](int kick) { return kick > 100 || kick % 2 == 0 ? -1.2e-4F : -1.1e-4F; };
  const auto judge = [](KickJudge<float>& all, float x) { return all.judge(testing::sampled_axis<float>(), x); };
  EXPECT_EQ(fault_of(judge, 1000, to_and_fro, judged), ControlFault::hunting);
  EXPECT_EQ(judged, KickJudge<float>::most_kicks);
  const auto of_work = [](KickJudge<float>& all, float x) { return all.judge_work(testing::sampled_axis<float>(), x); };
  const auto to_and_fro_for_ever = [](int kick) { return kick % 2 == 0 ? -1.2e-4F : -1.1e-4F; };
  EXPECT_EQ(fault_of(of_work, 1000, to_and_fro_for_ever, judged), ControlFault::hunting);
  EXPECT_EQ(judged, KickJudge<float>::most_kicks + 2) << "the two that led nearer than any before count for none";
}

TEST(KickJudge, NamesALoadOnASpringThatEachKickLeadsFurtherAway) {
  int judged = 0;
  const auto away = [](int kick) { return -1e-4F * static_cast<float>(kick + 2); };
  const auto judge = [](KickJudge<float>& all, float x) { return all.judge_work(testing::sampled_axis<float>(), x); };
  EXPECT_EQ(fault_of(judge, 1000, away, judged), ControlFault::diverging);
  EXPECT_EQ(judged, 8);
}

// Kicks under the coast "pd", each from where the axis rests.
struct Judged {
  AxisParameters<float> p = testing::sampled_axis<float>();
  KickJudge<float> judge;
  ControlFault kick(float from_m, float to_m) {
    judge.kicked(from_m);
    return judge.judge(p, to_m);
  }
  // So many in a row, none of which moves the axis.
  ControlFault futile(int kicks) {
    ControlFault fault = ControlFault::none;
    for (int i = 0; i < kicks && fault == ControlFault::none; ++i) fault = kick(1e-3F, 1e-3F);
    return fault;
  }
  // So many, each of which leads a millimetre further away.
  ControlFault growing(int kicks) {
    ControlFault fault = ControlFault::none;
    for (int i = 1; i <= kicks && fault == ControlFault::none; ++i)
      fault = kick(1e-3F * static_cast<float>(i), 1e-3F * static_cast<float>(i + 1));
    return fault;
  }
};

TEST(KickJudge, ForgetsWithAnotherTargetWhatTheKicksToTheLastOneShowed) {
  Judged axis;
  EXPECT_EQ(axis.futile(63), ControlFault::none);
  axis.judge.forget();
  EXPECT_EQ(axis.futile(63), ControlFault::none);
  EXPECT_EQ(axis.futile(1), ControlFault::jammed);
  axis.judge.forget();
  EXPECT_EQ(axis.kick(1e-3F, 5e-4F), ControlFault::none) << "nor is a fault that was proved";
  axis.judge.forget();
  EXPECT_EQ(axis.growing(7), ControlFault::none);
  axis.judge.forget();
  EXPECT_EQ(axis.growing(7), ControlFault::none);
  EXPECT_EQ(axis.growing(1), ControlFault::diverging);
  axis = {};
  EXPECT_EQ(axis.kick(1e-3F, 1e-6F), ControlFault::none);
  axis.judge.forget();
  const auto nearer = [&axis](int kick) {
    const float error_m = 0.02F - 5e-5F * static_cast<float>(kick);
    return axis.kick(error_m, error_m - 5e-5F);
  };
  for (int kick = 1; kick < KickJudge<float>::most_kicks; ++kick)
    ASSERT_EQ(nearer(kick), ControlFault::none) << "each leads nearer to this target";
  EXPECT_EQ(nearer(KickJudge<float>::most_kicks), ControlFault::hunting) << "but they are too many";
}

TEST(KickJudge, CountsThoseThatLeadAwayInARowOnly) {
  Judged axis;
  EXPECT_EQ(axis.growing(7), ControlFault::none);
  EXPECT_EQ(axis.kick(8e-3F, 7e-3F), ControlFault::none);
  EXPECT_EQ(axis.growing(7), ControlFault::none);
  EXPECT_EQ(axis.growing(1), ControlFault::diverging);
}

TEST(KickJudge, JudgesEachKickOnce) {
  Judged axis;
  EXPECT_EQ(axis.kick(1e-3F, 1e-3F), ControlFault::none);
  for (int period = 0; period < 500; ++period) ASSERT_EQ(axis.judge.judge(axis.p, 1e-3F), ControlFault::none);
}

TEST(KickJudge, AnAxisMayLeaveItsHoldAsOftenAsItMayBeKicked) {
  KickJudge<float> judge;
  for (int target = 0; target < 2; ++target) {
    for (int left = 0; left < KickJudge<float>::most_kicks; ++left) ASSERT_FALSE(judge.left_hold()) << left;
    EXPECT_TRUE(judge.left_hold());
    judge.forget();
  }
}

// It cannot even reach the force of the brake, from which a pulse behind a lag starts.
TEST(KickJudge, NamesAnAxisWhoseDriveGivesNextToNothing) {
  Scripted axis{2e-3};
  axis.controller().limit_force(1);
  for (int i = 0; i < 50'000 && axis.controller().fault() == ControlFault::none; ++i) axis.show(-1e-4F);
  EXPECT_EQ(axis.controller().fault(), ControlFault::jammed);
}

}  // namespace
}  // namespace breakaway::law
