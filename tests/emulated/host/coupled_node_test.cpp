// The node that is flashed for coupled_gantry.toml, commanded over the virtual bus, with emulated drives on its
// machine.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <type_traits>
#include <vector>

#include "breakaway/config/machine_design.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"
#include "breakaway/sil/simulated_network.hpp"
#include "flashed_node.hpp"

namespace breakaway::emulated {
namespace {

using namespace std::chrono_literals;
using firmware::AxisFault;

scenario::Scenario gantry() {
  return scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/coupled_gantry.toml");
}

constexpr std::size_t axes = flashed::node.capacity;

// The controller's port, with the commands of another node between the frames of the drives.
class CommandedBusPort {
 public:
  using Port = sil::SimulatedNetwork::Port;
  explicit CommandedBusPort(Port& port) : port_{&port} {}

  void command(const firmware::MotionCommand& command) {
    commands_.push_back({firmware::encode_command(command, flashed::node.loop.network.node_id), {}});
  }

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    return port_->send(frame, deadline);
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (commands_.empty()) return port_->receive(received);
    received = commands_.front();
    commands_.pop_front();
    return true;
  }
  void purge_transmit_queue() noexcept { port_->purge_transmit_queue(); }
  hal::BusState bus_state() const noexcept { return port_->bus_state(); }

 private:
  Port* port_;
  std::deque<hal::ReceivedFrame> commands_;
};

class FlashedGantry {
 public:
  FlashedGantry() {
    for (std::size_t i = 0; i < axes; ++i)
      drives_.push_back(&network_.add_drive(*scene_.worlds[i].drive, mechanisms_[i].seen_by_drive()));
  }

  const auto& status(std::size_t axis) const { return node_.loop().status(*node_.loop().axis(axis)); }
  const auto& coordinator() const { return node_.loop().controller(*node_.loop().axis(0)).coordinator(); }

  // Until all axes run and their brakes are open.
  bool start() {
    say(false);
    run(1s);
    say(true);
    for (int n = 0; n < 5000 && !all_run(); ++n) step();
    for (auto& mechanism : mechanisms_) mechanism.axis->release(hal::seconds(now_));
    return all_run();
  }
  void say(bool enable, bool reset = false) {
    enables_ = enable;
    for (std::uint8_t i = 0; i < axes; ++i) port_.command({.axis = i, .enable = enable, .reset_fault = reset});
  }
  void say_of(std::size_t axis, bool enable) {
    port_.command({.axis = static_cast<std::uint8_t>(axis), .enable = enable});
  }
  void step() {
    now_ += flashed::node.loop.network.period;
    network_.advance_to(now_);
    node_.step(now_);
    // The commander says its commands again.
    if (++steps_ % 100 == 0 && said_) say(enables_);
  }
  void repeat(bool said) { said_ = said; }
  void run(hal::Duration duration) {
    for (const hal::Time end = now_ + duration; now_ < end;) step();
  }
  bool run_to(law::CoordinatorPhase phase, hal::Duration patience = 5s) {
    for (const hal::Time end = now_ + patience; now_ < end && coordinator().phase() != phase;) step();
    return coordinator().phase() == phase;
  }

  firmware::NodeVerdict verdict() const { return node_.verdict(); }
  drive_emulator::DriveEmulator& drive(std::size_t axis) { return *drives_[axis]; }
  double position_m(std::size_t axis) const { return mechanisms_[axis].axis->state().position_m; }
  double force_N(std::size_t axis) const { return drives_[axis]->force().at_N(hal::seconds(now_), 0, 0); }
  hal::Time now() const { return now_; }
  bool all_run() const { return status(0).running && status(1).running; }

 private:
  scenario::Scenario scene_ = gantry();
  std::vector<sil::AxisMechanism> mechanisms_ = sil::axis_mechanisms(scene_);
  sil::SimulatedNetwork network_{*scene_.bus};
  CommandedBusPort port_{network_.controller_port()};
  firmware::ControlNode<CommandedBusPort, std::remove_const_t<decltype(flashed::node)>> node_{port_, flashed::node};
  std::vector<drive_emulator::DriveEmulator*> drives_;
  hal::Time now_{};
  int steps_ = 0;
  bool said_ = true, enables_ = false;
};

TEST(CoupledNode, IsFlashedAsItsFileIsCertified) {
  const config::Node node = gantry().node;
  EXPECT_TRUE(verify(flashed::node).ok());
  EXPECT_EQ(config::certified_machine(node, config::examine_machine(node)).checksum, flashed::node.checksum);
}

TEST(CoupledNode, ReachesItsTargetsInTheKicksThatSimulateSays) {
  const sil::Result simulated = sil::run_loop_scenario(gantry(), {});
  FlashedGantry gantry;
  ASSERT_TRUE(gantry.verdict().ok()) << to_string(gantry.verdict().error);
  ASSERT_TRUE(gantry.start());
  ASSERT_TRUE(gantry.run_to(law::CoordinatorPhase::hold));
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
    FlashedGantry gantry;
    ASSERT_TRUE(gantry.start());
    ASSERT_TRUE(gantry.run_to(law::CoordinatorPhase::pulse)) << "both drives have force";
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
  FlashedGantry gantry;
  ASSERT_TRUE(gantry.start());
  ASSERT_TRUE(gantry.run_to(law::CoordinatorPhase::pulse));
  gantry.drive(1).trip_fault(0x2310, gantry.now());
  gantry.run(500ms);
  gantry.repeat(false);
  gantry.say(false);
  gantry.run(100ms);
  gantry.say(false, true);
  gantry.run(100ms);
  gantry.repeat(true);
  gantry.say(true);
  ASSERT_TRUE(gantry.run_to(law::CoordinatorPhase::hold, 10s));
  EXPECT_EQ(gantry.coordinator().end(), law::CoordinatorEnd::on_target);
  for (std::size_t i = 0; i < axes; ++i) EXPECT_EQ(gantry.status(i).fault, AxisFault::none) << i;
}

TEST(CoupledNode, AnAxisThatIsStoppedAsAskedLeavesTheOtherWithoutForceUntilItRunsAgain) {
  FlashedGantry gantry;
  ASSERT_TRUE(gantry.start());
  ASSERT_TRUE(gantry.run_to(law::CoordinatorPhase::pulse));
  gantry.repeat(false);
  gantry.say_of(1, false);
  for (int n = 0; n < 10 && gantry.status(1).running; ++n) gantry.step();
  ASSERT_FALSE(gantry.status(1).running);
  for (int n = 0; n < 300; ++n) {
    gantry.step();
    EXPECT_EQ(gantry.status(0).output.force_N, 0.0F) << n;
  }
  EXPECT_TRUE(gantry.status(0).running);
  EXPECT_EQ(gantry.coordinator().phase(), law::CoordinatorPhase::gather);
  gantry.repeat(true);
  gantry.say(true);
  ASSERT_TRUE(gantry.run_to(law::CoordinatorPhase::hold, 10s));
  EXPECT_EQ(gantry.coordinator().end(), law::CoordinatorEnd::on_target);
}

}  // namespace
}  // namespace breakaway::emulated
