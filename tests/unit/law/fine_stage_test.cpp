// Kicks for errors below the floor.
#include "breakaway/law/fine_stage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../kicked_axis.hpp"
#include "law_fixture.hpp"
#include "scripted_axis.hpp"

namespace breakaway::law {
namespace {

using breakaway::testing::axes_of_the_scenes;
using breakaway::testing::Moment;
using breakaway::testing::RunEnd;
using testing::no_k3;

constexpr float asked_m = 0.6e-6F, slow_period_s = 4e-3F;

// The axis of the scenes at 250 Hz, whose floor is 24 um.
BrakedKicks<float> kicks_for(double fine_tolerance_m) {
  design::BrakedClass c = axes_of_the_scenes(0);
  c.period_s = slow_period_s;
  c.fine_tolerance_m = fine_tolerance_m;
  return design::design_braked_kicks<float>(c).kicks;
}

AxisParameters<float> slow_axis() {
  auto p = testing::braked_axis();
  p.period_s = slow_period_s;
  p.position_tolerance_m = asked_m;
  return p;
}

const BrakedKicks<float> fine = kicks_for(asked_m);
const BrakedKicks<float> table_alone = kicks_for(0);

void expect_same(const Pulse<float>& a, const Pulse<float>& b) {
  EXPECT_EQ(a.force_N, b.force_N);
  EXPECT_EQ(a.periods, b.periods);
  EXPECT_EQ(a.cut_periods, b.cut_periods);
}

// How far a pulse moves 1 kg under constant friction.
float travel_m(const Pulse<float>& pulse, float friction_N) {
  const float t = static_cast<float>(pulse.periods) * slow_period_s, b = fine.brake_N;
  if (pulse.force_N <= friction_N) return 0;
  return t * t * (pulse.force_N - friction_N) * (pulse.force_N + b) / (2 * (friction_N + b));
}

TEST(FineStage, IsThereOnlyWhereTheToleranceIsBelowTheFloor) {
  EXPECT_NEAR(fine.fine_floor_m, 24.3e-6F, 0.1e-6F);
  EXPECT_EQ(table_alone.fine_floor_m, 0);
  EXPECT_EQ(kicks_for(25e-6).fine_floor_m, 0);
  EXPECT_EQ(kicks_for(0.5e-6).fine_floor_m, 0) << "no reading tells half a count";
}

TEST(FineStage, LeavesAnAxisWithoutItToTheTable) {
  FineStage<float> stage{table_alone, slow_axis()};
  for (float x = 1e-6F; x < 0.01F; x *= 1.7F) {
    expect_same(stage.pulse(-x), table_alone.table.pulse(x));
    stage.learn(-x, 1);
    EXPECT_EQ(stage.tolerance_m(), asked_m);
    EXPECT_FALSE(stage.kicked());
  }
}

TEST(FineStage, LeavesWhatIsBeyondTheFloorToTheTable) {
  FineStage<float> stage{fine, slow_axis()};
  expect_same(stage.pulse(-25e-6F), fine.table.pulse(25e-6F));
  EXPECT_FALSE(stage.kicked());
  EXPECT_LT(stage.pulse(-10e-6F).force_N, fine.table.pulse(10e-6F).force_N);
  EXPECT_TRUE(stage.kicked());
}

TEST(FineStage, TriesALittleMoreUntilTheAxisMoves) {
  FineStage<float> stage{fine, slow_axis()};
  float before_N = stage.pulse(-5e-6F).force_N;
  EXPECT_GT(before_N, 2.5F);
  for (int i = 0; i < 10; ++i) {
    stage.learn(-5e-6F, before_N);
    const float now_N = stage.pulse(-5e-6F).force_N;
    EXPECT_NEAR(now_N - before_N, 0.02F * 4.5F, 1e-5F);
    before_N = now_N;
  }
}

TEST(FineStage, AimsWithTheFrictionThatTheLastKickThatWayShowed) {
  constexpr float friction_N = 3.3F;
  for (const float direction : {-1.0F, 1.0F}) {
    FineStage<float> stage{fine, slow_axis()};
    Pulse<float> pulse = stage.pulse(direction * 20e-6F);
    for (int i = 0; i < 30 && travel_m(pulse, friction_N) == 0; ++i) {
      stage.learn(direction * 20e-6F, pulse.force_N);
      pulse = stage.pulse(direction * 20e-6F);
    }
    stage.learn(direction * (20e-6F - travel_m(pulse, friction_N)), pulse.force_N);
    EXPECT_NEAR(travel_m(stage.pulse(direction * 12e-6F), friction_N), 12e-6F, 0.3e-6F);
  }
}

TEST(FineStage, NeverGoesFurtherThanTheTableForSoMuchMore) {
  std::mt19937_64 bits{3};
  std::uniform_real_distribution<float> share{-1, 1};
  FineStage<float> stage{fine, slow_axis()};
  for (int i = 0; i < 20'000; ++i) {
    const float x = 24e-6F * share(bits);
    const Pulse<float> pulse = stage.pulse(x);
    const Pulse<float> most = fine.table.pulse(std::abs(x) + 1.35F * fine.fine_floor_m);
    EXPECT_LE(pulse.force_N, most.force_N);
    EXPECT_EQ(pulse.periods, most.periods);
    EXPECT_LE(travel_m(pulse, 2.5F), std::abs(x) + stage.beyond_m());
    stage.learn(60e-6F * share(bits), pulse.force_N);
    if (i % 35 == 0) stage.restart();
  }
}

TEST(FineStage, WidensTheToleranceToTheFloorAndLeavesTheRestToTheTable) {
  FineStage<float> stage{fine, slow_axis()};
  float before_m = asked_m;
  // Every second kick moves it.
  for (int i = 1; i < most_fine_kicks; ++i) {
    stage.pulse(-20e-6F);
    stage.learn(i % 2 == 0 ? -15e-6F : -20e-6F, 3);
    EXPECT_EQ(stage.tolerance_m() > asked_m, i / 2 > 6) << i;
    EXPECT_GE(stage.tolerance_m(), before_m);
    EXPECT_LE(stage.tolerance_m(), fine.fine_floor_m);
    before_m = stage.tolerance_m();
  }
  EXPECT_LT(stage.tolerance_m(), fine.fine_floor_m);
  stage.pulse(-20e-6F);
  EXPECT_EQ(stage.tolerance_m(), fine.fine_floor_m);
  stage.learn(-15e-6F, 3);
  EXPECT_EQ(stage.tolerance_m(), fine.fine_floor_m) << "what the last kick of all shows changes nothing";
  expect_same(stage.pulse(-20e-6F), fine.table.pulse(20e-6F));
  stage.restart();
  EXPECT_EQ(stage.tolerance_m(), asked_m);
}

TEST(FineStage, EndsNearTheTargetUnderConstantFrictionOfAnySize) {
  for (const double friction_N : {2.5, 2.9, 3.3, 4.0, 4.5}) {
    for (const double start_m : {-1e-3, 20e-6, -5e-6}) {
      const auto friction = [=](const Moment&) { return friction_N; };
      const RunEnd end =
          breakaway::testing::run_kicked_axis<float>(slow_axis(), no_k3, fine, {}, friction, start_m, 0, 60);
      EXPECT_TRUE(end.held) << friction_N << ", " << start_m << ": " << to_string(end.fault);
      EXPECT_LE(std::abs(end.error_m), 3e-6) << friction_N << ", " << start_m;
    }
  }
}

TEST(FineStage, ChoosesItsNextKickAPeriodAfterThatInWhichItsAxisIsProvedAtRest) {
  const auto periods_between_kicks = [](const BrakedKicks<float>& kicks) {
    AxisController<float> controller{slow_axis(), no_k3, kicks};
    const auto periods_to_kick = [&] {
      for (int periods = 1; periods < 400; ++periods) {
        if (controller.update({-40e-6F}).kicked) return periods;
      }
      return 0;
    };
    periods_to_kick();
    return periods_to_kick();
  };
  EXPECT_GT(periods_between_kicks(table_alone), 2);
  EXPECT_EQ(periods_between_kicks(fine), periods_between_kicks(table_alone) + 1);
}

// What the axis reads at its next kicks.
class Shown {
 public:
  bool kicked_at(float position_m) {
    for (int i = 0; i < 400 && controller_.fault() == ControlFault::none; ++i) {
      const auto out = controller_.update({position_m});
      if (out.kicked) return true;
      if (out.mode == Mode::hold) return false;
    }
    return false;
  }
  void show(float position_m) { controller_.update({position_m}); }
  void hold_at(float position_m, int periods) {
    for (int i = 0; i < periods; ++i) controller_.update({position_m});
  }
  ControlFault fault() const { return controller_.fault(); }
  float seen_friction_N() const { return controller_.seen_friction_N(); }

 private:
  AxisController<float> controller_{slow_axis(), no_k3, fine};
};

TEST(FineStage, MayLeadAnAxisFurtherAwayAgainAndAgainWithoutAFault) {
  Shown axis;
  for (int i = 1; i <= 12; ++i) {
    const float position_m = 2e-6F * static_cast<float>(i % 2 == 0 ? i : -i);
    EXPECT_TRUE(axis.kicked_at(position_m)) << i << ": " << to_string(axis.fault());
  }
}

// Where a fine kick leads says nothing about what was told, but that the brake drives the axis back does.
TEST(FineStage, NamesAnAxisThatItsBrakeDrivesBack) {
  Shown axis;
  float position_m = -22e-6F;
  int kicks = 0;
  for (; kicks < 10 && axis.kicked_at(position_m); ++kicks) {
    axis.show(position_m + 8e-6F);
    axis.show(position_m += 4e-6F);
  }
  EXPECT_EQ(axis.fault(), ControlFault::contradicted);
  EXPECT_EQ(kicks, KickJudge<float>::most_contradictions);
  EXPECT_EQ(axis.seen_friction_N(), fine.brake_N);
}

TEST(FineStage, BeginsAnewWhereAHeldAxisIsPushed) {
  Shown axis;
  for (int i = 1; i <= 12; ++i) EXPECT_TRUE(axis.kicked_at(i % 2 == 0 ? 8e-6F : -8e-6F)) << i;
  EXPECT_FALSE(axis.kicked_at(-3e-6F)) << "six times the tolerance are left to it by now";
  axis.hold_at(-3e-6F, 10 * fine.patient_periods);
  EXPECT_TRUE(axis.kicked_at(-20e-6F));
  EXPECT_TRUE(axis.kicked_at(-3e-6F)) << "the tolerance is what was asked for again";
}

}  // namespace
}  // namespace breakaway::law
