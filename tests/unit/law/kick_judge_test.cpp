// What kicks show of an axis that is not what was stated, and how many of them it takes.
#include "breakaway/law/kick_judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scripted_axis.hpp"

namespace breakaway::law {
namespace {

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

TEST(KickJudge, NamesAnAxisThatDoesNotMove) {
  Scripted axis{0};
  for (int i = 0; i < 20'000 && axis.controller().fault() == ControlFault::none; ++i) axis.show(-1e-4F);
  EXPECT_EQ(axis.controller().fault(), ControlFault::jammed);
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
