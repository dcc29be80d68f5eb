// Several axes in one loop: who is taken in, who stops with whom, and that nobody is taken for another.
#include <gtest/gtest.h>

#include <concepts>
#include <type_traits>
#include <vector>

#include "../explained_enum.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "fake_axis.hpp"

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;
using testing::DriveProbe;
using testing::FakePort;
using testing::Loop;

static_assert(!std::constructible_from<Loop::AxisId, std::size_t> && !std::default_initializable<Loop::AxisId>,
              "an axis is named by what add_axis() gave, and by no number");

class SeveralAxesTest : public ::testing::Test {
 protected:
  // A loop with three axes that run.
  void start(FaultScope scope) {
    loop.emplace(port, LoopConfig{.network = {.period = 1ms, .heartbeat_period = 0ms}, .fault_scope = scope});
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const auto added = loop->add_axis({&probes[i], static_cast<std::uint8_t>(i + 1)}, {}, testing::moderate_limits());
      ASSERT_TRUE(added.id.has_value());
      axes.push_back(*added.id);
      loop->request_enable(axes.back());
      probes[i].feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
    }
    step();
    for (const auto& axis : axes) ASSERT_TRUE(loop->status(axis).running);
  }
  void step() {
    now += 1ms;
    for (DriveProbe& probe : probes) probe.feedback.sample_time = now - 1ms;
    port.sent.clear();
    loop->step(now);
  }
  // The drives obeyed their stop, so that resets are taken; they are enabled again as soon as they are told to.
  void stop_obeyed() {
    for (DriveProbe& probe : probes) probe.feedback.state = hal::DriveState::disabled;
    step();
  }
  void enabled() {
    for (DriveProbe& probe : probes) probe.feedback.state = hal::DriveState::enabled;
    step();
  }
  std::vector<AxisFault> faults() const {
    std::vector<AxisFault> found;
    for (const auto& axis : axes) found.push_back(loop->status(axis).fault);
    return found;
  }

  FakePort port;
  std::vector<DriveProbe> probes{3};
  std::optional<Loop> loop;
  std::vector<Loop::AxisId> axes;
  hal::Time now{};
};

constexpr AxisFault none = AxisFault::none, with_another = AxisFault::stopped_with_another;

TEST_F(SeveralAxesTest, AFaultStopsItsAxisAlone) {
  start(FaultScope::axis);
  probes[1].heartbeat_lost = true;
  step();
  EXPECT_EQ(faults(), (std::vector{none, AxisFault::heartbeat_lost, none}));
  EXPECT_TRUE(loop->status(axes[0]).running && loop->status(axes[2]).running);
  EXPECT_EQ(probes[0].stops + probes[2].stops, 0);
  EXPECT_EQ(probes[1].stops, 1);
}

TEST_F(SeveralAxesTest, AFaultStopsAllAxesInTheSameStepWhereTheNodeSaysSo) {
  start(FaultScope::all_axes);
  for (DriveProbe& probe : probes) probe.feedback.position_offset_m = 0.01F;
  step();
  for (const auto& axis : axes) EXPECT_FLOAT_EQ(loop->status(axis).output.force_N, -0.1F);
  probes[1].heartbeat_lost = true;
  step();
  EXPECT_EQ(faults(), (std::vector{with_another, AxisFault::heartbeat_lost, with_another}));
  for (std::size_t i = 0; i < axes.size(); ++i) {
    EXPECT_EQ(loop->supervisor(axes[i]).fault_code(), 0) << i;
    EXPECT_FALSE(loop->status(axes[i]).running) << i;
    EXPECT_EQ(loop->status(axes[i]).output.force_N, 0) << i;
    EXPECT_EQ(probes[i].stops, 1) << i;
  }
}

TEST_F(SeveralAxesTest, AxesThatStopTogetherStartTogetherOnceEveryFaultIsReset) {
  start(FaultScope::all_axes);
  probes[1].heartbeat_lost = true;
  step();
  probes[1].heartbeat_lost = false;
  stop_obeyed();
  for (const std::size_t i : {1U, 0U}) {
    loop->reset_fault(axes[i]);
    for (int periods = 0; periods < 5; ++periods) step();
    EXPECT_EQ(loop->status(axes[i]).fault, none) << "resets may come one by one";
  }
  EXPECT_EQ(faults(), (std::vector{none, none, with_another}));
  for (const auto& axis : axes) EXPECT_FALSE(loop->status(axis).running) << "nobody moves alone";
  loop->reset_fault(axes[2]);
  step();
  for (const DriveProbe& probe : probes) EXPECT_EQ(probe.enables, 1);
  enabled();
  for (const auto& axis : axes) EXPECT_TRUE(loop->status(axis).running);
}

// Whichever of them it is, the last fault holds all of them.
TEST_F(SeveralAxesTest, NobodyStartsBeforeTheLastFaultIsReset) {
  for (std::size_t last = 0; last < 3; ++last) {
    axes.clear();
    probes.assign(3, {});
    start(FaultScope::all_axes);
    probes[1].heartbeat_lost = true;
    step();
    probes[1].heartbeat_lost = false;
    stop_obeyed();
    for (std::size_t i = 0; i < 3; ++i)
      if (i != last) loop->reset_fault(axes[i]);
    enabled();  // somebody else enables the drives
    for (int periods = 0; periods < 5; ++periods) step();
    for (const auto& axis : axes) EXPECT_FALSE(loop->status(axis).running) << last;
    stop_obeyed();
    EXPECT_TRUE(loop->reset_fault(axes[last]));
    step();
    for (const DriveProbe& probe : probes) EXPECT_EQ(probe.enables, 1) << last;
  }
}

TEST_F(SeveralAxesTest, NoDriveIsEnabledWhileAnotherHasAFaultWhereAxesStopTogether) {
  start(FaultScope::all_axes);
  probes[1].heartbeat_lost = true;
  step();
  stop_obeyed();
  loop->reset_fault(axes[0]);
  for (int periods = 0; periods < 5; ++periods) step();
  EXPECT_EQ(probes[0].enables, 0);
  loop->reset_fault(axes[1]);
  probes[1].heartbeat_lost = false;
  loop->reset_fault(axes[2]);
  step();
  EXPECT_EQ(probes[0].enables, 1);
}

TEST_F(SeveralAxesTest, AFaultThatComesAgainAfterItsResetStopsTheOthersAgain) {
  start(FaultScope::all_axes);
  probes[1].heartbeat_lost = true;
  step();
  stop_obeyed();
  for (const auto& axis : axes) EXPECT_TRUE(loop->reset_fault(axis));
  step();
  enabled();
  step();
  EXPECT_EQ(faults(), (std::vector{with_another, AxisFault::heartbeat_lost, with_another}));
}

TEST_F(SeveralAxesTest, AnAxisThatIsNotWantedGetsNoFaultOfAnother) {
  start(FaultScope::all_axes);
  loop->request_stop(axes[2]);
  step();
  probes[0].feedback.force_N = std::nanf("");
  step();
  EXPECT_EQ(faults(), (std::vector{AxisFault::not_a_number, with_another, none}));
}

TEST_F(SeveralAxesTest, AnAxisThatIsWantedLaterWaitsForTheResetOfTheOthers) {
  start(FaultScope::all_axes);
  loop->request_stop(axes[2]);
  probes[2].feedback.state = hal::DriveState::disabled;
  step();
  probes[0].heartbeat_lost = true;
  step();
  loop->request_enable(axes[2]);
  for (int periods = 0; periods < 5; ++periods) step();
  EXPECT_EQ(probes[2].enables, 0);
  EXPECT_EQ(loop->status(axes[2]).fault, none);
}

TEST_F(SeveralAxesTest, ADriveThatCannotBeUsedStopsTheOthersWhereTheNodeSaysSo) {
  start(FaultScope::all_axes);
  probes[2].feedback.state = hal::DriveState::unusable;
  step();
  EXPECT_EQ(faults(), (std::vector{with_another, with_another, AxisFault::drive_unusable}));
}

TEST_F(SeveralAxesTest, CommandsOfOneAxisLeaveTheOthersAlone) {
  start(FaultScope::axis);
  loop->set_target_counts(axes[1], 5000);
  EXPECT_EQ(probes[1].datum, 5000);
  EXPECT_EQ(probes[0].datum + probes[2].datum, 0);
  EXPECT_EQ(loop->controller(axes[0]).shifted, 0);
  probes[1].feedback.position_offset_m = 1e-4F;
  step();
  EXPECT_FLOAT_EQ(loop->status(axes[1]).output.force_N, -1e-3F);
  EXPECT_EQ(loop->status(axes[2]).output.force_N, 0);
}

TEST_F(SeveralAxesTest, LetsTheAxesTakeTurnsWithAcyclicFrames) {
  start(FaultScope::axis);
  for (DriveProbe& probe : probes) probe.wants_acyclic = true;
  std::vector<int> seen(4);
  for (int i = 0; i < 30; ++i) {
    step();
    ASSERT_EQ(port.sent.size(), 5U) << "three commands, SYNC, and one acyclic frame";
    ++seen[canopen::node_id_of(port.sent.back().id)];
  }
  EXPECT_EQ(seen, (std::vector<int>{0, 10, 10, 10}));
}

// A drive that is asked two questions a period.
struct QuestionedDrive : testing::FakeDrive {
  using FakeDrive::FakeDrive;
  int questions = 2;
  bool next_poll_frame(hal::CanFrame& frame) noexcept {
    frame.id = canopen::tpdo_cob_id(1, id);
    if (questions-- > 0) return true;
    questions = 2;
    return false;
  }
};

TEST(QuestionedDrivesInALoop, AreAskedAfterEveryCommandAndSyncAndBeforeTheAcyclicFrame) {
  FakePort port;
  DriveProbe probe;
  probe.wants_acyclic = true;
  ControlLoop<FakePort, QuestionedDrive, testing::ProportionalLaw, float> loop{
      port, {.network = {.period = 1ms, .heartbeat_period = 0ms}}};
  for (std::uint8_t node_id = 1; node_id <= 2; ++node_id) loop.add_axis({&probe, node_id}, {}, {});
  for (hal::Time now{1ms}; now < hal::Time{4ms}; now += 1ms) {
    port.sent.clear();
    loop.step(now);
    std::vector<std::uint16_t> ids;
    for (const hal::CanFrame& frame : port.sent) ids.push_back(frame.id);
    ASSERT_EQ(ids.size(), 8U);
    EXPECT_EQ((std::vector<std::uint16_t>{ids.begin() + 3, ids.end() - 1}),
              (std::vector<std::uint16_t>{canopen::tpdo_cob_id(1, 1), canopen::tpdo_cob_id(1, 1),
                                          canopen::tpdo_cob_id(1, 2), canopen::tpdo_cob_id(1, 2)}));
    EXPECT_EQ(port.deadlines.back(), now + 1ms);
  }
}

TEST_F(SeveralAxesTest, AnIdFromALargerLoopChangesNothingHere) {
  start(FaultScope::axis);
  Loop small{port, {.network = {.period = 1ms, .heartbeat_period = 0ms}}};
  DriveProbe alone;
  const auto only = *small.add_axis({&alone, 1}, {}, {}).id;
  small.request_stop(axes[2]);
  small.set_target_counts(axes[2], 77);
  small.reset_fault(axes[2]);
  small.request_enable(axes[2]);
  EXPECT_EQ(alone.stops + alone.resets + alone.datum, 0);
  EXPECT_EQ(&small.status(axes[2]), &small.status(only)) << "there is no other";
  EXPECT_FALSE(small.axis(1).has_value());
  EXPECT_EQ(small.axis(0), only);
}

class AddAxisTest : public ::testing::Test {
 protected:
  Loop::AddedAxis add(unsigned node_id, testing::ProportionalLaw controller = {}) {
    return loop.add_axis({&probe, static_cast<std::uint8_t>(node_id)}, controller, {});
  }

  FakePort port;
  DriveProbe probe;
  Loop loop{port, {.network = {.period = 1ms, .node_id = 100}}};
};

TEST_F(AddAxisTest, TakesNoMoreAxesThanThereIsRoomFor) {
  for (unsigned id = 1; id <= 8; ++id) ASSERT_EQ(add(id).error, AxisError::none);
  EXPECT_EQ(add(9).error, AxisError::no_room);
  EXPECT_FALSE(add(9).id.has_value());
  EXPECT_EQ(loop.axes(), 8U);
}

TEST_F(AddAxisTest, TakesNoControllerOfAnotherPeriod) {
  EXPECT_EQ(add(1, {.period = 2e-3F}).error, AxisError::period_differs);
  EXPECT_EQ(add(1, {.period = std::nanf("")}).error, AxisError::period_differs);
  EXPECT_EQ(loop.axes(), 0U);
}

TEST_F(AddAxisTest, TakesNoNodeIdTwiceAndNotTheLoopsOwn) {
  EXPECT_EQ(add(1).error, AxisError::none);
  EXPECT_EQ(add(1).error, AxisError::node_id_taken);
  EXPECT_EQ(add(100).error, AxisError::node_id_taken);
}

TEST_F(AddAxisTest, SaysWhetherTheAxesFitTheBus) {
  add(1);
  EXPECT_EQ(loop.check_bus(), canopen::BusFit::fits);
  for (unsigned id = 2; id <= 8; ++id) add(id);
  EXPECT_EQ(loop.check_bus(), canopen::BusFit::overloaded);
}

TEST(AxisError, SaysWhatIsWrongAndWhatToDo) {
  test::expect_sentences<AxisError>({{AxisError::none, {"in the loop"}},
                                     {AxisError::no_room, {"no room", "raise MaxAxes"}},
                                     {AxisError::period_differs, {"another period", "design it again"}},
                                     {AxisError::node_id_taken, {"node id", "give each its own"}}});
}

}  // namespace
}  // namespace breakaway::firmware
