// The node that is flashed for coupled_gantry.toml: its certificate, its kicks, and how a stop and a reset of one axis
// are those of both.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstddef>

#include "breakaway/config/machine_design.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"
#include "flashed_gantry.hpp"

namespace breakaway::emulated {
namespace {

using namespace std::chrono_literals;
using firmware::AxisFault;

scenario::Scenario scene() {
  return scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/coupled_gantry.toml");
}

void say(FlashedGantry& g, const firmware::MotionCommand& wish) { g.wish.fill(wish); }

bool both_run(const FlashedGantry& g) { return g.status(0).running && g.status(1).running; }

// Until both axes run and their brakes are open.
bool start(FlashedGantry& g) {
  g.run(1s);
  say(g, {.enable = true});
  for (int n = 0; n < 5000 && !both_run(g); ++n) g.step();
  return both_run(g);
}

bool run_to(FlashedGantry& g, law::CoordinatorPhase phase, hal::Duration patience = 5s) {
  for (const hal::Time end = g.now() + patience; g.now() < end && g.coordinator().phase() != phase;) g.step();
  return g.coordinator().phase() == phase;
}

TEST(CoupledNode, IsFlashedAsItsFileIsCertified) {
  const config::Node node = scene().node;
  EXPECT_TRUE(verify(flashed::node).ok());
  EXPECT_EQ(config::certified_machine(node, config::examine_machine(node)).checksum, flashed::node.checksum);
}

TEST(CoupledNode, ReachesItsTargetsInTheKicksThatSimulateSays) {
  const sil::Result simulated = sil::run_loop_scenario(scene(), {});
  FlashedGantry gantry{1};
  ASSERT_TRUE(gantry.verdict().ok()) << to_string(gantry.verdict().error);
  ASSERT_TRUE(start(gantry));
  ASSERT_TRUE(run_to(gantry, law::CoordinatorPhase::hold));
  gantry.run(300ms);
  EXPECT_EQ(gantry.coordinator().end(), law::CoordinatorEnd::on_target);
  EXPECT_EQ(gantry.coordinator().kicks(), simulated.axes[0].kicks.size() + simulated.axes[1].kicks.size());
  for (std::size_t i = 0; i < axes; ++i) {
    EXPECT_EQ(gantry.status(i).fault, AxisFault::none);
    EXPECT_EQ(gantry.status(i).output.mode, law::Mode::hold);
    // The drives were set up at other instants within a period.
    EXPECT_NEAR(gantry.position_m(i), simulated.axes[i].final_error_m, 1e-6) << i;
  }
}

TEST(CoupledNode, AFaultOfOneAxisStopsTheOtherInTheSamePeriodAndByName) {
  for (const std::size_t faulty : {0UL, 1UL}) {
    FlashedGantry gantry{1};
    ASSERT_TRUE(start(gantry));
    ASSERT_TRUE(run_to(gantry, law::CoordinatorPhase::pulse)) << "both drives have force";
    gantry.drive(faulty).trip_fault(0x2310, gantry.now());
    for (int n = 0; n < 20 && gantry.status(faulty).fault == AxisFault::none; ++n) gantry.step();
    EXPECT_EQ(gantry.status(faulty).fault, AxisFault::emergency);
    EXPECT_EQ(gantry.status(1 - faulty).fault, AxisFault::stopped_with_another) << "in the same period";
    gantry.run(300ms);
    for (std::size_t i = 0; i < axes; ++i) {
      EXPECT_EQ(gantry.force_N(i), 0) << i;
      EXPECT_FALSE(gantry.status(i).running) << i;
    }
    const std::array<double, axes> at_m{gantry.position_m(0), gantry.position_m(1)};
    gantry.run(300ms);
    for (std::size_t i = 0; i < axes; ++i) EXPECT_EQ(gantry.position_m(i), at_m[i]) << i;
  }
}

TEST(CoupledNode, AfterAResetOfAllItStartsAgainAndReachesItsTargets) {
  FlashedGantry gantry{1};
  ASSERT_TRUE(start(gantry));
  ASSERT_TRUE(run_to(gantry, law::CoordinatorPhase::pulse));
  gantry.drive(1).trip_fault(0x2310, gantry.now());
  gantry.run(500ms);
  say(gantry, {.enable = false});
  gantry.run(100ms);
  say(gantry, {.enable = false, .reset_fault = true});
  gantry.run(100ms);
  say(gantry, {.enable = true});
  ASSERT_TRUE(run_to(gantry, law::CoordinatorPhase::hold, 10s));
  EXPECT_EQ(gantry.coordinator().end(), law::CoordinatorEnd::on_target);
  for (std::size_t i = 0; i < axes; ++i) EXPECT_EQ(gantry.status(i).fault, AxisFault::none) << i;
}

TEST(CoupledNode, AnAxisThatIsStoppedAsAskedLeavesTheOtherWithoutForceUntilItRunsAgain) {
  FlashedGantry gantry{1};
  ASSERT_TRUE(start(gantry));
  ASSERT_TRUE(run_to(gantry, law::CoordinatorPhase::pulse));
  gantry.wish[1].enable = false;
  for (int n = 0; n < 10 && gantry.status(1).running; ++n) gantry.step();
  ASSERT_FALSE(gantry.status(1).running);
  for (int n = 0; n < 300; ++n) {
    gantry.step();
    EXPECT_EQ(gantry.status(0).output.force_N, 0.0F) << n;
  }
  EXPECT_TRUE(gantry.status(0).running);
  EXPECT_EQ(gantry.coordinator().phase(), law::CoordinatorPhase::gather);
  gantry.wish[1].enable = true;
  ASSERT_TRUE(run_to(gantry, law::CoordinatorPhase::hold, 10s));
  EXPECT_EQ(gantry.coordinator().end(), law::CoordinatorEnd::on_target);
}

}  // namespace
}  // namespace breakaway::emulated
