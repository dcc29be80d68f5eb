// Moves with limits on speed, acceleration and jerk, from the plan alone to the axis that ends in kicks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../../campaign/random_braked_axis.hpp"
#include "breakaway/law/move_plan.hpp"

namespace breakaway::law {
namespace {

using breakaway::testing::axes_of_the_scenes;
using breakaway::testing::Retarget;
using breakaway::testing::RunEnd;
using campaign::friction_of_kind;

// One that follows the plan exactly: the speed changes by what is planned.
struct Follower {
  MovePlan<double> plan;
  double distance_m, speed_m_s = 0, acceleration = 0;

  double step(double period_s) {
    const double before = acceleration;
    acceleration = plan.next(distance_m, speed_m_s, speed_m_s < 0);
    distance_m -= (speed_m_s + acceleration * period_s / 2) * period_s;
    speed_m_s += acceleration * period_s;
    return (acceleration - before) / period_s;
  }
};

TEST(MovePlan, KeepsEveryLimitAndEndsWhereTheBrakeTakesOver) {
  std::mt19937_64 random{1};
  std::uniform_real_distribution<> share{0, 1};
  const double T = 1e-3;
  for (int run = 0; run < 500; ++run) {
    const double a = 2 * std::pow(20, share(random)), j = a / T / (4 * std::pow(20, share(random)));
    const double V = 0.05 * std::pow(40, share(random)), gentle = 0.3 * a * share(random);
    const double w1 = 0.05 * V, e1 = 0.5 * w1 * w1 / gentle;
    const MoveLimits<double> limits{V, a, a, j};
    Follower axis{{limits, {e1, w1, gentle}, 0.95 * a, T}, e1 + 1e-3 * std::pow(1000, share(random))};
    const double turn_at = share(random) < 0.5 ? 0.3 * share(random) : 1e9;
    int k = 0;
    for (; k < 100000 && !(axis.distance_m <= e1 && axis.speed_m_s <= 1.25 * w1); ++k) {
      if (std::fabs(k * T - turn_at) < T / 2) axis.distance_m += 0.3 * (share(random) - 0.3);
      const double jerk = axis.step(T);
      ASSERT_LE(std::fabs(jerk), j * (1 + 1e-9)) << run << " at " << k;
      ASSERT_LE(std::fabs(axis.acceleration), a * (1 + 1e-12)) << run << " at " << k;
      ASSERT_LE(axis.speed_m_s, V * 1.001 + 0.5 * j * T * T) << run << " at " << k;
    }
    EXPECT_LT(k, 100000) << run;
    EXPECT_LT(std::fabs(axis.speed_m_s), 1.25 * w1 + a * T) << run;
  }
}

TEST(MovePlan, TakesLittleLongerThanAnyMoveMust) {
  const MoveLimits<double> limits{1, 20, 20, 2000};
  Follower axis{{limits, {0, 0, 0}, 20, 1e-4}, 0.4};
  int k = 0;
  for (; k < 10000 && !(axis.distance_m < 1e-5 && axis.speed_m_s < 0.01); ++k) axis.step(1e-4);
  const double least_s = design::least_move_s({0.4, 1, 20, 2000});
  EXPECT_NEAR(least_s, 0.46, 1e-12);
  EXPECT_NEAR(design::least_move_s({0.4, 1, 20, {}}), 0.45, 1e-12);
  EXPECT_NEAR(design::least_move_s({0.01, 1, 20, 2000}), 0.05583, 1e-5);
  EXPECT_NEAR(design::least_move_s({1e-6, 1, 20, 2000}), 4 * std::cbrt(1e-6 / 2 / 2000), 1e-9);
  EXPECT_LT(k * 1e-4, least_s + 0.004);
}

TEST(MoveLimits, TellTheTimeOfTheDoubleSAndTheSpeedThatTakesIt) {
  std::mt19937_64 random{3};
  std::uniform_real_distribution<> share{0, 1};
  for (int run = 0; run < 1000; ++run) {
    const double a = 2 * std::pow(20, share(random)), v = 0.05 * std::pow(40, share(random));
    const double j = run % 2 == 0 ? 0 : a / (0.002 * std::pow(20, share(random)));
    const double d = 1e-3 * std::pow(1000, share(random));
    const MoveLimits<double> limits{v, a, a, j};
    const double time_s = limits.time_s(d, v);
    const double least_s = design::least_move_s({d, v, a, j > 0 ? std::optional{j} : std::nullopt});
    EXPECT_NEAR(time_s, least_s, 1e-9 * least_s) << run;
    const double longer_s = time_s * (1.001 + share(random)), slower = limits.speed_for_m_s(d, longer_s);
    EXPECT_LT(slower, v);
    EXPECT_NEAR(limits.time_s(d, slower), longer_s, 1e-9 * longer_s) << run;
  }
}

struct Moves {
  double worst_s = 0, m_s = 0, m_s2 = 0, beyond_m = 0;
  int kicks = 0;
};

// Under every kind of friction, some of them from several seeds.
Moves run_moves(const design::MoveRequest& move, const Retarget& retarget = {}) {
  design::BrakedClass c = axes_of_the_scenes(1e-4);
  c.move = move;
  const auto design = design::design_braked_kicks<float>(c);
  auto p = campaign::parameters(c, 2.5e-6);
  p.max_approach_speed_m_s = 1e6F;
  const K3Table<float> unused;
  Moves all;
  for (int run = 0; run < 8 * campaign::kinds; ++run) {
    const int kind = run % campaign::kinds, seed = run / campaign::kinds;
    const auto friction = friction_of_kind(kind, c, static_cast<std::uint64_t>(run), 1e-5 * (1 + seed), 2.5e-6);
    const double start_m = seed % 2 == 0 ? -move.distance_m : move.distance_m;
    const RunEnd end = breakaway::testing::run_kicked_axis<float>(p, unused, design.kicks, {1, 1, 1e-4, 0, 1}, friction,
                                                                  start_m, 0, 5, 4, 50, 0.3, retarget);
    EXPECT_TRUE(end.held) << "friction " << kind << ", seed " << seed << ": " << to_string(end.fault);
    all.worst_s = std::max(all.worst_s, end.time_s);
    all.m_s = std::max(all.m_s, end.approach_m_s);
    all.m_s2 = std::max(all.m_s2, end.approach_m_s2);
    all.beyond_m = std::max(all.beyond_m, end.approach_beyond_m);
    all.kicks = std::max(all.kicks, end.kicks);
  }
  EXPECT_GT(design.kicks.approach.move.acceleration_m_s2, 0);
  if (!(retarget.at_s < 5)) {
    EXPECT_LE(all.beyond_m, design::hand_over_m(design));
  }
  EXPECT_LE(all.m_s, move.speed_m_s);
  EXPECT_LE(all.m_s2, 1.0001 * move.acceleration_m_s2);
  EXPECT_LE(all.kicks, 10);
  return all;
}

TEST(Move, KeepsItsLimitsUnderEveryFrictionAndIsQuick) {
  EXPECT_LE(run_moves({0.4, 1, 20, {}}).worst_s, 0.5);
  EXPECT_LE(run_moves({0.4, 1, 20, 2000}).worst_s, 0.504);
  EXPECT_LE(run_moves({0.01, 1, 20, {}}).worst_s, 0.0801);
  EXPECT_LE(run_moves({0.01, 1, 20, 2000}).worst_s, 0.0801);
}

TEST(Move, KeepsItsLimitsWhereItsTargetMovesOnTheWay) {
  for (const double shift_m : {0.2, -0.215, -0.24, -0.3, -0.6, 1e-3}) {
    run_moves({0.4, 1, 20, {}}, {0.2, shift_m});
    run_moves({0.4, 1, 20, 2000}, {0.2, shift_m});
  }
}

// The axis of the scenes under its least friction, a tenth of a second after it set out from -0.4 m.
struct UnderWay {
  explicit UnderWay(const design::BrakedClass& c)
      : kicks{design::design_braked_kicks<float>(c).kicks}, controller{parameters(c), unused, kicks} {
    for (int k = 0; k < 100; ++k) go_on();
  }
  void go_on() {
    force_N = controller.update({x}).force_N;
    const float gain_m_s = (force_N - 2.5F) * 1e-3F;
    x += (v + gain_m_s / 2) * 1e-3F;
    v += gain_m_s;
  }
  static AxisParameters<float> parameters(const design::BrakedClass& c) {
    auto p = campaign::parameters(c, 2.5e-6);
    p.max_approach_speed_m_s = 1;
    return p;
  }

  K3Table<float> unused;
  BrakedKicks<float> kicks;
  AxisController<float> controller;
  float x = -0.4F, v = 0, force_N = 0;
};

TEST(Move, GoesOnFromItsSpeedWhenItsTargetMovesOn) {
  design::BrakedClass c = axes_of_the_scenes(1e-4);
  c.move = design::MoveRequest{0.4, 1, 20, 2000};
  UnderWay axis{c};
  axis.controller.shift_target(0.1F);
  const auto out = axis.controller.update({axis.x - 0.1F});
  EXPECT_EQ(out.mode, Mode::approach);
  EXPECT_NEAR(axis.controller.velocity_m_s(), axis.v, 0.01F);
  EXPECT_LE(std::fabs(out.force_N - axis.force_N), 2.1F) << "the force changes by the mass times what the jerk allows";
}

// Where readings are coarse a new estimate would take as long to see the speed as it trusts them little.
TEST(Move, WithoutLimitsKnowsItsSpeedWhenItsTargetMovesBehindIt) {
  design::BrakedClass c = axes_of_the_scenes(1e-4);
  c.encoder_resolution_m = 1e-3;
  UnderWay axis{c};
  axis.controller.shift_target(-0.6F);
  const auto out = axis.controller.update({axis.x + 0.6F});
  EXPECT_EQ(out.mode, Mode::approach);
  EXPECT_NEAR(axis.controller.velocity_m_s(), axis.v, 0.01F);
  EXPECT_LT(out.force_N, 0) << "it brakes";
}

// The axis of the scenes under one constant friction, read late, whose target may move in any period.
class LateAxis {
 public:
  LateAxis(const design::BrakedClass& c, double friction_N)
      : kicks_{design::design_braked_kicks<float>(c).kicks},
        p_{campaign::parameters(c, 2.5e-6)},
        slider_{{1, 1, c.lag_s.most, 0, c.latency_periods}, [=](const auto&) { return friction_N; }, -0.4, 0},
        readings_(static_cast<std::size_t>(c.latency_periods), slider_.position_m()) {
    p_.max_approach_speed_m_s = 1e6F;
    controller_ = {p_, unused_, kicks_};
  }

  ControlOutput<float> step() {
    readings_.push_back(std::round(slider_.position_m() / 1e-6) * 1e-6);
    const auto out = controller_.update({static_cast<float>(readings_.front() - target_m_)});
    readings_.erase(readings_.begin());
    const double before_m_s = slider_.velocity_m_s();
    slider_.run(static_cast<double>(out.force_N), 1e-3, 4);
    m_s2_ = std::fabs(slider_.velocity_m_s() - before_m_s) / 1e-3;
    return out;
  }
  void go_to(double target_m) {
    controller_.shift_target(static_cast<float>(target_m - target_m_));
    target_m_ = target_m;
  }
  double position_m() const { return slider_.position_m(); }
  double velocity_m_s() const { return slider_.velocity_m_s(); }
  double acceleration_m_s2() const { return m_s2_; }  // of the last period, either way

 private:
  K3Table<float> unused_;
  BrakedKicks<float> kicks_;
  AxisParameters<float> p_;
  breakaway::testing::Slider slider_;
  std::vector<double> readings_;
  AxisController<float> controller_{p_, unused_, kicks_};
  double target_m_ = 0, m_s2_ = 0;
};

// It is reckoned past its target for some periods before a reading shows it. Taken for as many turns, it would be let
// go at full speed, and go eight times as far.
TEST(Move, BrakesAllTheWayWhereItPassesItsTargetAndIsReadLate) {
  design::BrakedClass c = axes_of_the_scenes(1e-4);
  c.move = design::MoveRequest{0.4, 1, 20, {}};
  for (const int latency : {0, 1, 2, 3, 4, 8}) {
    c.latency_periods = latency;
    for (const double left_m : {0.002, 0.005, 0.01, 0.02}) {
      LateAxis axis{c, 2.5};
      for (int k = 0; k < 200; ++k) axis.step();
      const double target_m = std::round((axis.position_m() + left_m) / 1e-6) * 1e-6;
      axis.go_to(target_m);
      double furthest_m = 0;
      for (int k = 0; k < 1000; ++k) {
        axis.step();
        furthest_m = std::max(furthest_m, axis.position_m() - target_m);
      }
      EXPECT_LT(furthest_m, 0.04) << latency << " periods late, " << left_m << " m before it";
      EXPECT_NEAR(axis.position_m(), target_m, 3e-6) << latency << " periods late, " << left_m << " m before it";
    }
  }
}

// What was read of its speed says nothing of which way it moves once it was sent back and forth since then.
TEST(Move, KeepsItsAccelerationWhereItsTargetMovesToAndFro) {
  design::BrakedClass c = axes_of_the_scenes(0);
  std::mt19937_64 random{1};
  std::uniform_real_distribution<> share{0, 1};
  for (const double jerk_m_s3 : {0.0, 2000.0}) {
    c.move = design::MoveRequest{0.4, 1, 20, {}};
    if (jerk_m_s3 > 0) c.move->jerk_m_s3 = jerk_m_s3;
    for (int run = 0; run < 60; ++run) {
      c.latency_periods = run % 4;
      LateAxis axis{c, run % 2 == 0 ? 2.5 : 4.5};
      double hardest_m_s2 = 0;
      for (int k = 0; k < 400; ++k) {
        // As far away as no brake and no kick begins.
        if (share(random) < 0.15) axis.go_to(axis.position_m() + (share(random) < 0.5 ? 0.2 : -0.2));
        axis.step();
        hardest_m_s2 = std::max(hardest_m_s2, axis.acceleration_m_s2());
      }
      EXPECT_LE(hardest_m_s2, 20.02) << "run " << run << ", " << jerk_m_s3 << " m/s3";
    }
  }
}

// One that was sent back meanwhile would be driven on by the last force.
TEST(Move, HasNoForceWhereTheAxisIsReckonedToBeThereAndNothingIsRead) {
  UnderWay axis{axes_of_the_scenes(0)};
  const auto lost = [&axis] { return AxisController<float>{axis.controller}.update({0, 0, false}); };
  int steered = 0;
  for (; lost().force_N != 0; ++steered) {
    ASSERT_LT(steered, 1000);
    axis.go_on();
  }
  EXPECT_GT(steered, 10) << "before that it goes on by its plan";
  EXPECT_EQ(lost().mode, Mode::approach);
  EXPECT_LT(std::fabs(axis.x), 10 * axis.kicks.approach.switch_distance_m);
  EXPECT_NE(axis.force_N, 0) << "which is the last force";
}

// What the tests of the time that a move takes share: the axis of the scenes, asked for moves of up to 0.4 m.
struct TimedMove {
  TimedMove() {
    design::BrakedClass c = axes_of_the_scenes(1e-4);
    c.move = design::MoveRequest{0.4, 1, 20, 2000};
    kicks = design::design_braked_kicks<float>(c).kicks;
    p = campaign::parameters(c, 2.5e-6);
    p.max_approach_speed_m_s = 1;
  }
  // Periods until there is a force, from rest at x, up to `most`.
  static int waits(AxisController<float>& controller, float x, int most) {
    int k = 0;
    while (k < most && controller.update({x}).force_N == 0) ++k;
    return k;
  }

  K3Table<float> unused;
  BrakedKicks<float> kicks;
  AxisParameters<float> p;
};

TEST(Move, SetsOffLaterWhereItWouldHaveToCreep) {
  const TimedMove t;
  AxisController<float> controller{t.p, t.unused, t.kicks};
  const float own_s = controller.move_time_s(0.002F);
  controller.take_time(own_s + 0.3F, 0.002F);
  // Goes as slowly as it may, and waits for what is left.
  const int waited = TimedMove::waits(controller, -0.002F, 1000);
  EXPECT_GT(waited, 200);
  EXPECT_LT(waited, 300);
  EXPECT_EQ(controller.mode(), Mode::approach);
  EXPECT_EQ(controller.velocity_m_s(), 0);
}

TEST(Move, OfATargetThatMovesOnWhileItWaitsIsTimedAnew) {
  const TimedMove t;
  AxisController<float> controller{t.p, t.unused, t.kicks};
  controller.take_time(0.5F, 0.002F);
  EXPECT_EQ(TimedMove::waits(controller, -0.002F, 50), 50);
  controller.shift_target(0.1F);
  EXPECT_EQ(TimedMove::waits(controller, -0.102F, 1000), 0);
  controller.reset();
  controller.take_time(0.5F, 0.002F);
  EXPECT_EQ(TimedMove::waits(controller, -0.002F, 50), 50);
  controller.shift_target(0.001F);
  controller.take_time(0.2F, 0.003F);
  EXPECT_NEAR(TimedMove::waits(controller, -0.003F, 1000), 170, 20);
}

TEST(Move, DoesNotWaitWhereItIsUnderWayOrThere) {
  const TimedMove t;
  AxisController<float> moving{t.p, t.unused, t.kicks};
  float x = -0.4F;
  for (int k = 0; k < 100; ++k) moving.update({x += 5e-4F});
  moving.shift_target(-0.25F);
  x += 0.25F;
  moving.take_time(3, std::fabs(x));
  EXPECT_EQ(TimedMove::waits(moving, x, 1000), 0);
  // A pulse that is under way when the target moves has the axis in motion.
  AxisController<float> kicked{t.p, t.unused, t.kicks};
  x = -1e-5F;
  for (int k = 0; k < 2000 && kicked.mode() != Mode::kick; ++k) kicked.update({x});
  ASSERT_EQ(kicked.mode(), Mode::kick);
  kicked.shift_target(0.002F);
  kicked.take_time(3, 0.00201F);
  EXPECT_FALSE(kicked.waits());
  EXPECT_EQ(TimedMove::waits(kicked, -0.00201F, 1000), 0);
  AxisController<float> there{t.p, t.unused, t.kicks};
  there.take_time(3, 1e-6F);
  for (int k = 0; k < 200; ++k) there.update({1e-6F});
  EXPECT_EQ(there.mode(), Mode::hold);
}

// The wait of an axis that rests is not what a proof of sticking counts, and a sample that is lost in it costs a
// period.
TEST(Move, IsNotTakenForStuckWhereItWaits) {
  const TimedMove t;
  AxisController<float> controller{t.p, t.unused, t.kicks};
  controller.take_time(20, 0.002F);
  for (int k = 0; k < 19000; ++k) {
    const auto out = controller.update({-0.002F, 0, k % 97 != 0});
    ASSERT_EQ(out.mode, Mode::approach) << k;
    ASSERT_EQ(out.force_N, 0) << k;
    ASSERT_TRUE(controller.waits()) << k;
  }
  EXPECT_LT(TimedMove::waits(controller, -0.002F, 2000), 1300);
  EXPECT_EQ(controller.mode(), Mode::approach);
}

}  // namespace
}  // namespace breakaway::law
