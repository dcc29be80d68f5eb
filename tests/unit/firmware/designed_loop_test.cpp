// The loop with a law that says what it is designed for: what the loop then watches, and moves that end together. And
// what a loop forgets, and begins anew, with every start and reset.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "breakaway/firmware/control_loop.hpp"
#include "fake_axis.hpp"

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;
using testing::DriveProbe;
using testing::FakePort;

struct DesignedLaw : testing::ProportionalLaw {
  struct Friction {
    float upper_N = 4.5F;
  };
  struct Parameters {
    float mass_kg = 1, feedforward_N = 0, encoder_resolution_m = 1e-6F;
    Friction friction{};
  };
  Parameters told{};
  float breakaway = 4.5F, lag = 0;
  law::Mode mode_ = law::Mode::approach;
  bool waits_ = false;
  std::vector<float>* taken_times = nullptr;  // what it was told to take, and for which distance
  std::vector<float>* distances = nullptr;
  float seconds_per_metre = 1;

  const Parameters& parameters() const noexcept { return told; }
  float breakaway_N() const noexcept { return breakaway; }
  float slow_lag() const noexcept { return lag; }
  law::Mode mode() const noexcept { return mode_; }
  bool waits() const noexcept { return waits_; }
  float move_time_s(float distance_m) const noexcept { return seconds_per_metre * distance_m; }
  void take_time(float time_s, float distance_m) noexcept {
    if (taken_times == nullptr) return;
    taken_times->push_back(time_s);
    distances->push_back(distance_m);
  }
};

using DesignedLoop = ControlLoop<FakePort, testing::FakeDrive, DesignedLaw, float, 4>;

// A loop, and axes that it runs.
struct Rig {
  FakePort port;
  std::array<DriveProbe, 3> probes{};
  DesignedLoop loop;
  std::vector<DesignedLoop::AxisId> axes;
  hal::Time now{};

  explicit Rig(MovesEnd moves_end = MovesEnd::each)
      : loop{port, {.network = {.period = 1ms, .heartbeat_period = 0ms}, .moves_end = moves_end}} {}
  DesignedLoop::AxisId add(const DesignedLaw& law, const AxisLimits<float>& limits = testing::moderate_limits()) {
    DriveProbe& probe = probes.at(axes.size());
    axes.push_back(*loop.add_axis({&probe, static_cast<std::uint8_t>(axes.size() + 1)}, law, limits).id);
    loop.request_enable(axes.back());
    probe.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
    return axes.back();
  }
  void step() {
    now += 1ms;
    for (DriveProbe& probe : probes) probe.feedback.sample_time = now;
    loop.step(now);
  }
  AxisFault fault(std::size_t i = 0) const { return loop.status(axes[i]).fault; }
  int steps_until_fault(int most) {
    for (int n = 1; n <= most; ++n) {
      step();
      if (fault() != AxisFault::none) return n;
    }
    return most;
  }
};

TEST(DesignedLoop, NamesAnAxisThatShowsNoMotionUnderMoreThanItsFriction) {
  struct Row {
    DesignedLaw law;
    float force_N;
    bool must_move;
  };
  DesignedLaw plain, heavy, light, coarse, loaded, gripping;
  heavy.told.mass_kg = 1e6F;
  light.told.mass_kg = 0.5F;
  coarse.told.encoder_resolution_m = 1;
  loaded.told.feedforward_N = 10;
  gripping.breakaway = 30;
  for (const auto& [law, force_N, must_move] :
       {Row{plain, -20, true}, Row{plain, -4.4F, false}, Row{heavy, -20, false}, Row{light, -20, true},
        Row{coarse, -20, false}, Row{loaded, 14, false}, Row{loaded, -5, true}, Row{gripping, -20, false},
        Row{gripping, -31, true}}) {
    Rig rig;
    rig.add(law);
    rig.probes[0].feedback.position_offset_m = -force_N / 10;  // the law commands what is reported
    rig.step();
    rig.probes[0].feedback.force_N = force_N;
    const int steps = rig.steps_until_fault(100);
    EXPECT_EQ(rig.fault(), must_move ? AxisFault::no_motion_under_force : AxisFault::none) << force_N;
    EXPECT_EQ(steps, must_move ? 11 : 100) << force_N << ", of ten periods without motion";
  }
}

struct HoldingLaw : DesignedLaw {
  law::HeldAxis<float> held() const noexcept { return {.force_N = 2, .allowed_m = 0.01F, .is_rigid = true}; }
  law::ControlOutput<float> update(const law::Measurement<float>&) noexcept { return {1, 0, mode_, false}; }
};

TEST(DesignedLoop, NamesAnAxisThatIsMovedWhileItsLawHoldsIt) {
  for (const law::Mode mode : {law::Mode::hold, law::Mode::coast}) {
    FakePort port;
    DriveProbe probe;
    ControlLoop<FakePort, testing::FakeDrive, HoldingLaw, float> loop{
        port, {.network = {.period = 1ms, .heartbeat_period = 0ms}}};
    HoldingLaw law;
    law.mode_ = mode;
    AxisLimits<float> limits = testing::moderate_limits();
    limits.speed_m_s = 100;
    const auto axis = *loop.add_axis({&probe, 1}, law, limits).id;
    loop.request_enable(axis);
    probe.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
    int moves = 0;
    for (hal::Time now{1ms}; loop.status(axis).fault == AxisFault::none && now < hal::Time{50ms}; now += 1ms, ++moves) {
      probe.feedback.travel_m = -0.004F;
      probe.feedback.sample_time = now;
      loop.step(now);
    }
    EXPECT_EQ(loop.status(axis).fault, mode == law::Mode::hold ? AxisFault::external_motion : AxisFault::none);
    EXPECT_EQ(moves, mode == law::Mode::hold ? 4 : 49) << "the sample with which it starts, and three moves";
  }
}

// A law may be designed for its friction and not say how much of it there is by now.
struct LawOfItsParameters : testing::ProportionalLaw {
  DesignedLaw::Parameters told{};
  const DesignedLaw::Parameters& parameters() const noexcept { return told; }
};

TEST(DesignedLoop, TakesTheFrictionOfTheDesignWhereTheLawSaysNoOther) {
  for (const float force_N : {4.4F, 20.0F, -4.4F, -20.0F}) {
    FakePort port;
    DriveProbe probe;
    ControlLoop<FakePort, testing::FakeDrive, LawOfItsParameters, float> loop{
        port, {.network = {.period = 1ms, .heartbeat_period = 0ms}}};
    const auto axis = *loop.add_axis({&probe, 1}, {}, testing::moderate_limits()).id;
    loop.request_enable(axis);
    probe.feedback = {
        .state = hal::DriveState::enabled, .position_offset_m = -force_N / 10, .fresh = true, .ever_valid = true};
    for (hal::Time now{1ms}; now <= hal::Time{100ms}; now += 1ms) {
      probe.feedback.sample_time = now;
      loop.step(now);
      probe.feedback.force_N = force_N;
    }
    EXPECT_EQ(loop.status(axis).fault, std::abs(force_N) > 4.5F ? AxisFault::no_motion_under_force : AxisFault::none);
  }
}

TEST(DesignedLoop, AllowsTheForceThatASlowCurrentLoopStillHas) {
  for (const bool slow : {true, false}) {
    DesignedLaw law;
    law.lag = slow ? 0.99F : 0.0F;
    law.breakaway = 1000;
    Rig rig;
    rig.add(law);
    DriveProbe& probe = rig.probes[0];
    probe.feedback.position_offset_m = -4;
    for (int n = 0; n < 1000; ++n) rig.step();
    probe.feedback.position_offset_m = 0;
    for (int n = 0; n < 200; ++n) {
      probe.feedback.force_N = 40 * std::pow(0.99F, static_cast<float>(n));
      rig.step();
    }
    EXPECT_EQ(rig.fault(), slow ? AxisFault::none : AxisFault::force_not_commanded);
  }
}

TEST(DesignedLoop, NamesAnAxisThatComesNoNearerUnlessItHoldsOrWaits) {
  for (const auto& [mode, waits] :
       {std::pair{law::Mode::approach, false}, {law::Mode::approach, true}, {law::Mode::hold, false}}) {
    DesignedLaw law;
    law.mode_ = mode;
    law.waits_ = waits;
    Rig rig;
    rig.add(law);
    for (int n = 0; n < 60'100; ++n) rig.step();
    EXPECT_EQ(rig.fault(), mode == law::Mode::hold || waits ? AxisFault::none : AxisFault::target_not_reached);
  }
}

TEST(DesignedLoop, MovesThatSetOffAtOnceTakeTheTimeOfTheSlowest) {
  std::array<std::vector<float>, 3> times, distances;
  Rig rig{MovesEnd::together};
  for (std::size_t i = 0; i < 3; ++i) {
    DesignedLaw law;
    law.taken_times = &times[i];
    law.distances = &distances[i];
    law.seconds_per_metre = i == 1 ? 3.0F : 1.0F;
    rig.add(law);
  }
  rig.step();
  rig.step();  // they start at their targets
  for (auto& taken : times) EXPECT_EQ(taken, std::vector<float>{0}) << "once";
  rig.step();
  for (std::size_t i = 0; i < 3; ++i) times[i].clear(), distances[i].clear();
  rig.loop.set_target_counts(rig.axes[0], -100'000);
  rig.loop.set_target_counts(rig.axes[1], 50'000);
  rig.step();
  EXPECT_EQ(times[2], std::vector<float>{}) << "its target did not move";
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(times[i].size(), 1U);
    EXPECT_FLOAT_EQ(times[i][0], 0.15F) << "that of the second axis";
    EXPECT_FLOAT_EQ(distances[i][0], i == 0 ? 0.1F : 0.05F);
  }
  for (int n = 0; n < 10; ++n) rig.step();
  EXPECT_EQ(times[0].size(), 1U) << "they are on their way";
}

// A move that has begun waits for none.
TEST(DesignedLoop, MovesOfAxesThatStartAreMatchedBeforeTheirFirstForce) {
  for (const MovesEnd moves_end : {MovesEnd::together, MovesEnd::each}) {
    std::vector<float> times, distances;
    DesignedLaw law;
    law.taken_times = &times;
    law.distances = &distances;
    Rig rig{moves_end};
    rig.add(law);
    rig.probes[0].feedback.position_offset_m = -0.1F;
    while (rig.probes[0].commands.empty() || rig.probes[0].commands.back() == 0) {
      EXPECT_TRUE(times.empty());
      rig.step();
      ASSERT_LT(rig.now, hal::Time{1s});
    }
    EXPECT_EQ(times.size(), moves_end == MovesEnd::together ? 1U : 0U);
  }
}

TEST(DesignedLoop, AnAxisThatIsNotRunningHoldsNobodyUp) {
  std::array<std::vector<float>, 2> times, distances;
  Rig rig{MovesEnd::together};
  for (std::size_t i = 0; i < 2; ++i) {
    DesignedLaw law;
    law.taken_times = &times[i];
    law.distances = &distances[i];
    rig.add(law);
  }
  for (int n = 0; n < 3; ++n) rig.step();
  rig.loop.request_stop(rig.axes[1]);
  rig.probes[1].feedback.state = hal::DriveState::disabled;
  rig.step();
  for (auto& taken : times) taken.clear();
  rig.loop.set_target_counts(rig.axes[0], 100'000);
  rig.loop.set_target_counts(rig.axes[1], 900'000);
  rig.step();
  ASSERT_EQ(times[0].size(), 1U);
  EXPECT_FLOAT_EQ(times[0][0], 0.1F);
  EXPECT_TRUE(times[1].empty());
}

TEST(DesignedLoop, MovesOfTheirOwnEndAsTheyMay) {
  std::vector<float> times, distances;
  DesignedLaw law;
  law.taken_times = &times;
  law.distances = &distances;
  Rig rig{MovesEnd::each};
  rig.loop.set_target_counts(rig.add(law), 100'000);
  for (int n = 0; n < 5; ++n) rig.step();
  EXPECT_TRUE(times.empty());
}

TEST(LoopStart, BeginsTheLawAnewWithEveryStartAndEveryReset) {
  Rig rig;
  const auto axis = rig.add({});
  EXPECT_FALSE(rig.loop.status(axis).stop_not_obeyed);
  rig.step();
  EXPECT_EQ(rig.loop.controller(axis).resets, 1);
  rig.step();
  EXPECT_EQ(rig.loop.controller(axis).resets, 1) << "it goes on";
  rig.loop.request_stop(axis);
  rig.probes[0].feedback.state = hal::DriveState::disabled;
  rig.step();
  EXPECT_TRUE(rig.loop.reset_fault(axis));
  EXPECT_EQ(rig.loop.controller(axis).resets, 2);
}

TEST(LoopStart, ShowsNoForceOnceItStopped) {
  Rig rig;
  const auto axis = rig.add({});
  rig.probes[0].feedback.position_offset_m = 0.01F;
  rig.step();
  EXPECT_FLOAT_EQ(rig.loop.status(axis).output.force_N, -0.1F);
  rig.loop.request_stop(axis);
  rig.step();
  EXPECT_EQ(rig.loop.status(axis).output.force_N, 0);
}

TEST(LoopStart, NeedsAFreshSample) {
  Rig rig;
  const auto axis = rig.add({});
  rig.probes[0].feedback.fresh = false;
  for (int n = 0; n < 3; ++n) rig.step();
  EXPECT_FALSE(rig.loop.status(axis).running);
  EXPECT_TRUE(rig.probes[0].commands.empty());
  rig.probes[0].feedback.fresh = true;
  rig.step();
  EXPECT_TRUE(rig.loop.status(axis).running);
}

TEST(LoopStart, LetsAnAxisBeyondItsLimitComeBackFromWhereItStands) {
  AxisLimits<float> limits;
  limits.position_max_m = 1;
  Rig rig;
  rig.add({}, limits);
  DriveProbe& probe = rig.probes[0];
  for (const float position_m : {1.5F, 1.4F, 1.4F}) {
    probe.feedback.position_m = position_m;
    rig.step();
    EXPECT_EQ(rig.fault(), AxisFault::none) << position_m;
  }
  probe.feedback.position_m = 1.45F;
  rig.step();
  EXPECT_EQ(rig.fault(), AxisFault::position_limit);
}

// What it waited for before it ran is over.
TEST(LoopStart, GivesTheWholeTimeAgainToAnAxisThatRanMeanwhile) {
  Rig rig;
  const auto axis = rig.add({});
  DriveProbe& probe = rig.probes[0];
  probe.feedback.state = hal::DriveState::configuring;
  for (int n = 0; n < 15'000; ++n) rig.step();
  probe.feedback.state = hal::DriveState::enabled;
  rig.step();
  ASSERT_TRUE(rig.loop.status(axis).running);
  for (int n = 0; n < 10'000; ++n) rig.step();
  probe.feedback.ever_valid = false;
  for (int n = 0; n < 3; ++n) rig.step();
  EXPECT_FALSE(rig.loop.status(axis).running);
  EXPECT_EQ(rig.fault(), AxisFault::none);
}

TEST(LoopStart, AllowsTheErrorOfEveryTargetChangeSinceTheLastSample) {
  for (const int sign : {1, -1}) {
    AxisLimits<float> limits;
    limits.following_error_m = 0.001F;
    Rig rig;
    const auto axis = rig.add({}, limits);
    DriveProbe& probe = rig.probes[0];
    const auto off_by = [&](float error_m) {
      probe.feedback.position_offset_m = static_cast<float>(sign) * error_m;
      rig.step();
      return rig.fault();
    };
    EXPECT_EQ(off_by(0.002F), AxisFault::none);
    rig.loop.set_target_counts(axis, -sign * 10'000);
    EXPECT_EQ(off_by(0.0129F), AxisFault::none);
    rig.loop.set_target_counts(axis, -sign * 20'000);
    rig.loop.set_target_counts(axis, -sign * 30'000);
    EXPECT_EQ(off_by(0.0338F), AxisFault::none);
    EXPECT_EQ(off_by(0.0340F), AxisFault::following_error);
  }
}

TEST(LoopStart, CountsItsTicks) {
  Rig rig;
  rig.add({});
  for (int n = 0; n < 5; ++n) rig.step();
  EXPECT_EQ(rig.loop.statistics().ticks(), 5U);
}

TEST(LoopStart, GivesItsFramesOnePeriodToLeave) {
  Rig rig;
  rig.add({});
  rig.step();
  ASSERT_FALSE(rig.port.deadlines.empty());
  for (const hal::Time deadline : rig.port.deadlines) EXPECT_EQ(deadline, rig.now + 1ms);
}

TEST(LoopStart, NamesItsAxesInTheOrderOfTheirAddition) {
  Rig rig;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(rig.add({}).index(), i);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(rig.loop.axis(i)->index(), i);
  Rig smaller;
  smaller.add({});
  smaller.loop.request_stop(rig.axes[1]);
  EXPECT_EQ(smaller.probes[0].stops, 0);
  EXPECT_EQ(&smaller.loop.status(rig.axes[1]), &smaller.loop.status(smaller.axes[0])) << "the next id after the last";
}

TEST(LoopStart, AFaultOfItsOwnHasNoCodeOfTheDrive) {
  Rig rig;
  const auto axis = rig.add({});
  rig.step();
  rig.loop.stop_with(axis, AxisFault::commander_lost, rig.now);
  EXPECT_EQ(rig.loop.supervisor(axis).fault_code(), 0);
  Rig deaf;
  deaf.add({});
  deaf.step();
  deaf.probes[0].feedback.stop_not_obeyed = true;
  deaf.step();
  EXPECT_EQ(deaf.fault(), AxisFault::stop_not_obeyed);
  EXPECT_EQ(deaf.loop.supervisor(deaf.axes[0]).fault_code(), 0);
}

TEST(LoopStart, TakesAPeriodThatIsThatOfTheLoopButForRounding) {
  FakePort port;
  DriveProbe probe;
  for (const float off : {-1.5e-6F, -0.5e-6F, 0.5e-6F, 1.5e-6F}) {
    testing::Loop loop{port, {.network = {.period = 1ms}}};
    testing::ProportionalLaw law;
    law.period = 1e-3F * (1 + off);
    EXPECT_EQ(loop.add_axis({&probe, 1}, law, {}).error,
              std::abs(off) < 1e-6F ? AxisError::none : AxisError::period_differs)
        << off;
  }
}

}  // namespace
}  // namespace breakaway::firmware
