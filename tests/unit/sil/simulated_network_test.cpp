#include "breakaway/sil/simulated_network.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "breakaway/hybrid/refused.hpp"

namespace {

using namespace breakaway;
using namespace std::chrono_literals;

struct StubbornMechanism final : drive_emulator::Mechanism {
  void advance_to(double time_s, const model::AppliedForce& /*force*/) override {
    if (time_s > 0.008) throw hybrid::Refused{"cannot move on", "ask for less"};
  }
  double position_m() const override { return 0; }
};

// The drive moves its mechanism when a SYNC arrives, which the bus delivers by a function that lets no exception
// through.
TEST(SimulatedNetwork, LetsARefusalOfAMechanismOutThatASyncBroughtAbout) {
  sil::SimulatedNetwork network{{}};
  StubbornMechanism mechanism;
  network.add_drive(drive_emulator::EmulatorConfig{}, mechanism);
  const auto send = [&](const hal::CanFrame& frame) {
    ASSERT_EQ(network.controller_port().send(frame, network.bus().now() + 1s), hal::SendResult::queued);
  };
  network.advance_to(hal::Time{7ms});
  send({.id = 0x000, .size = 2, .data = {1, 1}});  // NMT: node 1, start
  network.advance_to(hal::Time{7999us});
  send({.id = 0x080, .size = 0, .data = {}});
  EXPECT_THROW(network.advance_to(hal::Time{20ms}), hybrid::Refused);
}

}  // namespace
