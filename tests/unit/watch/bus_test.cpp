// A controller node with two axes on emulated drives, and the listener and the commander of the page on the same bus.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/overheard.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/simulated_network.hpp"
#include "breakaway/watch/bus_listener.hpp"
#include "breakaway/watch/commander.hpp"

namespace {

using namespace breakaway;
using namespace std::chrono_literals;
using watch::Action;
using watch::BusListener;
using watch::Commander;
using watch::Sample;

class WatchedNode : public ::testing::Test {
 protected:
  using Port = sil::SimulatedNetwork::Port;

  WatchedNode() {
    for (std::size_t i = 0; i < mechanisms_.size(); ++i) {
      drives_.push_back(&network_.add_drive(*scenario_.worlds[i].drive, mechanisms_[i].seen_by_drive()));
      mechanisms_[i].axis->release(0);
    }
    run(500ms);
  }

  void run(hal::Duration duration) {
    for (const hal::Time end = now_ + duration; now_ < end;) {
      now_ += 1ms;
      network_.advance_to(now_);
      if (node_runs_) node_.step(now_);
      for (hal::ReceivedFrame received; page_port_.receive(received);)
        if (auto sample = listener_.on_frame(received)) samples_.push_back(*sample);
      if (page_is_open_) commander_.page_is_seen(now_);
      for (const auto& frame : commander_.due(now_)) send(frame);
    }
  }
  void send(const hal::CanFrame& frame) {
    ++sent_;
    ASSERT_EQ(page_port_.send(frame, now_ + 50ms), hal::SendResult::queued);
  }
  std::string asked(Action action, std::size_t axis = 0, double target_m = 0) {
    return commander_.obey({.axis = axis, .action = action, .target_m = target_m}, now_);
  }
  const auto& status(std::size_t axis = 0) const { return node_.loop().status(*node_.loop().axis(axis)); }
  double position_m(std::size_t axis = 0) const { return mechanisms_[axis].axis->state().position_m; }
  bool is_enabled(std::size_t axis = 0) const { return status(axis).feedback.state == hal::DriveState::enabled; }
  const Sample& newest(const std::string& axis) const {
    for (std::size_t n = samples_.size(); n-- > 0;)
      if (samples_[n].axis == axis) return samples_[n];
    ADD_FAILURE() << "no sample of " << axis;
    return samples_.front();
  }

  scenario::Scenario scenario_ = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/two_axes.toml");
  config::AnyNode<float> flashed_ = config::certified(scenario_.node, config::examine(scenario_.node));
  std::vector<sil::AxisMechanism> mechanisms_ = sil::axis_mechanisms(scenario_);
  sil::SimulatedNetwork network_{virtual_bus::VirtualBusConfig{}};
  std::vector<drive_emulator::DriveEmulator*> drives_;
  firmware::ControlNode<Port, config::AnyNode<float>> node_{network_.controller_port(), flashed_};
  Port& page_port_ = network_.add_port();
  BusListener listener_{scenario_.node};
  Commander commander_{scenario_.node, listener_};
  std::vector<Sample> samples_;
  hal::Time now_{};
  bool page_is_open_ = true, node_runs_ = true;
  int sent_ = 0;
};

TEST_F(WatchedNode, IsSeenWithoutAWordFromThePage) {
  EXPECT_EQ(sent_, 0);
  for (std::size_t i = 0; i < mechanisms_.size(); ++i) {
    const Sample& sample = newest(scenario_.node.axes[i].name);
    EXPECT_NEAR(sample.position_m, position_m(i), 1e-6);
    EXPECT_EQ(sample.drive, hal::DriveState::disabled);
    EXPECT_EQ(sample.mode, law::Mode::approach);
    EXPECT_EQ(sample.fault, firmware::AxisFault::none);
    EXPECT_GT(sample.bus_load, 0.1);
    EXPECT_LT(sample.bus_load, 0.9);
    EXPECT_TRUE(std::isnan(sample.target_m)) << "nobody has said one yet";
  }
}

// Somebody may have moved it meanwhile, and it would go back.
TEST_F(WatchedNode, AnAxisWhoseDriveIsNotHeardIsNotEnabledToWhereItStoodBefore) {
  drives_[0]->power_off(now_);
  run(1500ms);
  EXPECT_NE(asked(Action::enable).find("not heard any more"), std::string::npos);
  EXPECT_EQ(asked(Action::enable, 1), "") << "the other one is heard";
  run(500ms);
  EXPECT_TRUE(is_enabled(1));
  drives_[0]->power_on(now_);
  run(3s);
  EXPECT_FALSE(is_enabled());
  EXPECT_EQ(asked(Action::enable), "");
}

TEST_F(WatchedNode, AnAxisThatIsEnabledStaysWhereItIsAndThenGoesToItsTarget) {
  const double start_m = position_m();
  EXPECT_EQ(asked(Action::enable), "");
  run(500ms);
  EXPECT_TRUE(is_enabled());
  EXPECT_FALSE(is_enabled(1)) << "the other axis was not asked for";
  EXPECT_NEAR(position_m(), start_m, 5e-6);
  EXPECT_EQ(asked(Action::target, 0, 0.1), "");
  run(3s);
  EXPECT_NEAR(position_m(), 0.1, 5e-6);
  const Sample& sample = newest(scenario_.node.axes[0].name);
  EXPECT_DOUBLE_EQ(sample.target_m, 0.1);
  EXPECT_EQ(sample.mode, law::Mode::hold);
  EXPECT_EQ(sample.drive, hal::DriveState::enabled);
  EXPECT_TRUE(std::isfinite(sample.command_N));
}

TEST_F(WatchedNode, AStopIsObeyedWhileTheAxisMoves) {
  EXPECT_EQ(asked(Action::enable), "");
  run(300ms);
  EXPECT_EQ(asked(Action::target, 0, 0.4), "");
  run(200ms);
  EXPECT_TRUE(is_enabled());
  EXPECT_EQ(asked(Action::stop), "");
  run(300ms);
  EXPECT_FALSE(is_enabled());
  EXPECT_EQ(status().fault, firmware::AxisFault::none);
}

TEST_F(WatchedNode, AxesAreStoppedWhenThePageThatCommandsThemIsClosed) {
  EXPECT_EQ(asked(Action::enable), "");
  run(500ms);
  page_is_open_ = false;
  run(Commander::page_timeout - 200ms);
  EXPECT_TRUE(is_enabled());
  run(400ms + 2 * commander_.interval());
  EXPECT_FALSE(is_enabled());
  EXPECT_EQ(status().fault, firmware::AxisFault::none) << "it was stopped, and did not miss its commander";
  page_is_open_ = true;
  run(500ms);
  EXPECT_FALSE(is_enabled()) << "a page that comes back enables nothing";
}

TEST_F(WatchedNode, AFaultIsShownByNameAndResetOnce) {
  EXPECT_EQ(asked(Action::enable), "");
  run(500ms);
  // The page's machine stands still: the node misses its commander.
  const auto frames = commander_.farewell();
  ASSERT_EQ(frames.size(), 1U);
  for (int n = 0; n < 700; ++n) {
    now_ += 1ms;
    network_.advance_to(now_);
    node_.step(now_);
  }
  EXPECT_EQ(status().fault, firmware::AxisFault::commander_lost);
  run(200ms);
  EXPECT_EQ(newest(scenario_.node.axes[0].name).fault, firmware::AxisFault::commander_lost);
  EXPECT_NE(asked(Action::enable).find("commander lost"), std::string::npos);
  EXPECT_EQ(asked(Action::reset), "");
  run(1s);
  EXPECT_EQ(status().fault, firmware::AxisFault::none);
  EXPECT_FALSE(is_enabled());
  EXPECT_EQ(asked(Action::enable), "");
  run(500ms);
  EXPECT_TRUE(is_enabled());
}

TEST_F(WatchedNode, WhatCannotBeDoneIsRefusedWithTheReason) {
  EXPECT_NE(asked(Action::enable, 2).find("has 2 axes"), std::string::npos);
  EXPECT_NE(asked(Action::target, 0, 0.1).find("enable it first"), std::string::npos);
  EXPECT_EQ(asked(Action::enable), "");
  EXPECT_NE(asked(Action::enable).find("enabled already"), std::string::npos);
  const config::Limits& limits = scenario_.node.axes[0].limits;
  for (const double beyond_m : {limits.position_max_m + 1e-3, limits.position_min_m - 1e-3, 1e300})
    EXPECT_NE(asked(Action::target, 0, beyond_m).find("[limits]"), std::string::npos) << beyond_m;
  EXPECT_EQ(asked(Action::stop), "");
}

TEST_F(WatchedNode, ThereIsOneCommanderAtATime) {
  Port& other = network_.add_port();
  for (int n = 0; n < 10; ++n) {
    const auto frame = firmware::encode_command({.axis = 0, .target_counts = 5}, scenario_.node.loop->node_id);
    EXPECT_EQ(other.send(frame, now_ + 50ms), hal::SendResult::queued);
    run(20ms);
  }
  EXPECT_NEAR(newest(scenario_.node.axes[0].name).target_m, 5e-6, 1e-12);
  EXPECT_NE(asked(Action::enable).find("another commander"), std::string::npos);
  EXPECT_NE(asked(Action::stop).find("another commander"), std::string::npos);
  run(500ms);
  EXPECT_EQ(sent_, 0);
  run(1s);
  EXPECT_EQ(asked(Action::enable), "");
}

TEST_F(WatchedNode, ANodeThatIsNotThereIsNotCommanded) {
  node_runs_ = false;
  run(1500ms);
  EXPECT_NE(asked(Action::enable).find("no status of node 127"), std::string::npos);
  EXPECT_EQ(sent_, 0);
}

TEST(WatchBus, FramesOfAnybodyBringItNotDown) {
  const auto scenario = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/two_axes.toml");
  BusListener listener{scenario.node};
  hal::ReceivedFrame received;
  std::uint64_t bits = 20261123;
  int samples = 0;
  for (unsigned n = 0; n < 200'000; ++n) {
    bits = bits * 6364136223846793005ULL + 1442695040888963407ULL;
    received.frame.id = static_cast<std::uint16_t>(bits >> 53);
    received.frame.size = static_cast<std::uint8_t>((bits >> 40) % 9);
    received.frame.remote = (bits >> 39 & 7U) == 0;
    for (auto& byte : received.frame.data) byte = static_cast<std::uint8_t>((bits >> 8) * (n + 1) >> 16);
    received.time += 100us;
    if (listener.on_frame(received)) ++samples;
  }
  EXPECT_GT(samples, 0);
}

// Two axes that push each other rest at 0 and 0.01 m, as their node and their drives tell.
class WatchedMachine : public ::testing::Test {
 protected:
  WatchedMachine() {
    for (std::size_t place = 0; place < 2; ++place) tell(place, law::Mode::hold);
  }
  void tell(std::size_t place, law::Mode mode) {
    const config::Axis& axis = node_.axes[place];
    const auto counts = static_cast<std::int32_t>(place) * 10'000;
    hal::CanFrame status{.id = canopen::tpdo_cob_id(1, node_.loop->node_id), .size = 8};
    status.data = {static_cast<std::uint8_t>(place), 0, static_cast<std::uint8_t>(mode),
                   static_cast<std::uint8_t>(hal::DriveState::enabled)};
    canopen::store_little_endian(status.data, counts, 4);
    listener_.on_frame({status, now_});
    hal::CanFrame drive{.id = canopen::tpdo_cob_id(1, axis.drive->node_id), .size = 8};
    drive.data = {0x37, 0x02};
    canopen::store_little_endian(drive.data, axis.drive->invert_direction ? -counts : counts, 2);
    listener_.on_frame({drive, now_});
  }
  std::string asked(Action action, std::size_t axis, double target_m = 0) {
    return commander_.obey({.axis = axis, .action = action, .target_m = target_m}, now_);
  }

  config::Node node_ = config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/coupled_gantry.toml");
  BusListener listener_{node_};
  Commander commander_{node_, listener_};
  hal::Time now_{10s};
};

TEST_F(WatchedMachine, IsGivenTargetsThatItsCertificateIsAboutOnly) {
  for (std::size_t place = 0; place < 2; ++place) EXPECT_EQ(asked(Action::enable, place), "");
  EXPECT_NE(asked(Action::target, 0, 0.9).find("from 0 m to 0.9 m at once, and [coupling] start_m is 0.03"),
            std::string::npos);
  EXPECT_EQ(asked(Action::target, 0, 0.03), "");
  EXPECT_NE(asked(Action::target, 1, -0.021).find("from 0.01 m to -0.021 m at once"), std::string::npos);
  EXPECT_EQ(asked(Action::target, 1, 0.04), "");
  tell(1, law::Mode::approach);
  EXPECT_NE(asked(Action::target, 1, 0.02).find("does not hold yet"), std::string::npos);
}

}  // namespace
