// Example 3: run two axes on one bus, and lose the drive of one.
//
// One description holds the whole node: the loop, and for each axis its mass, friction, gains, drive and limits. As a
// file it is what `breakaway simulate`, `breakaway design --header` (for a board) and `breakaway-node` (on Linux) read.
// Here the loop is built from it by hand, so that the program can look inside.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/braked_slide.hpp"
#include "breakaway/sil/simulated_network.hpp"

using namespace breakaway;

constexpr const char* description = R"(
[loop]
period_s = 0.001
fault_stops = "axis"    # what stops when one axis has a fault: that "axis", or "all"

[bus]
bit_rate = 1_000_000

[[axis]]
name = "x"
plant = { mass_kg = 1 }
friction = { lower_N = 2.5, upper_N = 4.5 }
controller = { k1_N_per_m = 400, k21_Ns_per_m = 32, k22_Ns_per_m = 60, max_force_N = 50, position_tolerance_m = 2e-6 }
drive = { node_id = 1, rated_torque_Nm = 1, max_torque_per_mille = 2000, force_per_torque_N_per_Nm = 25, encoder_resolution_m = 1e-6 }

[[axis]]
name = "y"
plant = { mass_kg = 2.5 }
friction = { lower_N = 6, upper_N = 9 }
controller = { k1_N_per_m = 1000, k21_Ns_per_m = 80, k22_Ns_per_m = 150, max_force_N = 100, position_tolerance_m = 2e-6 }
drive = { node_id = 2, rated_torque_Nm = 2, max_torque_per_mille = 2000, force_per_torque_N_per_Nm = 25, encoder_resolution_m = 1e-6 }
)";

using Port = sil::SimulatedNetwork::Port;
using Loop = firmware::ControlLoop<Port, cia402::Drive<float>, law::AxisController<float>, float>;

bool near(const sil::BrakedSlide& axis, double place_m) {
  return std::abs(axis.slide().state().position_m - place_m) < 3e-6;
}

void show(const char* name, const sil::BrakedSlide& axis, firmware::AxisFault fault) {
  std::printf("  %s is at %8.4f mm, fault: %s\n", name, 1e3 * axis.slide().state().position_m,
              std::string{to_string(fault)}.c_str());
}

int main() try {
  const scenario::Scenario scenario = scenario::parse_scenario(description, "03_two_axes");
  const auto node = config::certified(scenario.node, config::examine(scenario.node));

  // The world: a bus with two emulated drives, and an axis behind each.
  sil::BrakedSlide x{motion::Slide{1.0, scenario.worlds[0].friction, {}}};
  sil::BrakedSlide y{motion::Slide{2.5, scenario.worlds[1].friction, {}}};
  x.release(0);
  y.release(0);
  sil::SimulatedNetwork network{*scenario.bus};
  network.add_drive(*scenario.worlds[0].drive, x);
  drive_emulator::DriveEmulator& drive_of_y = network.add_drive(*scenario.worlds[1].drive, y);

  // The loop, as on a board.
  Loop loop{network.controller_port(), node.loop};
  firmware::add_axes(loop, node);
  const Loop::AxisId axis_x = *loop.axis(0), axis_y = *loop.axis(1);
  hal::Time now{};
  const auto run_for = [&](hal::Duration time) {
    for (const hal::Time end = now + time; now < end; now += node.loop.network.period) {
      network.advance_to(now);
      loop.step(now);
    }
  };

  loop.request_enable(axis_x);
  loop.request_enable(axis_y);
  loop.set_target_m(axis_x, 0.010F);
  loop.set_target_m(axis_y, -0.025F);
  run_for(std::chrono::seconds{3});
  std::printf("sent to 10 mm and -25 mm:\n");
  show("x", x, loop.status(axis_x).fault);
  show("y", y, loop.status(axis_y).fault);
  const bool arrived = near(x, 0.010) && near(y, -0.025);

  drive_of_y.power_off(now);
  loop.set_target_m(axis_x, 0.020F);
  run_for(std::chrono::seconds{3});
  std::printf("the drive of y has lost its power, and x was sent to 20 mm:\n");
  show("x", x, loop.status(axis_x).fault);
  show("y", y, loop.status(axis_y).fault);
  const bool went_on = near(x, 0.020) && loop.status(axis_x).fault == firmware::AxisFault::none;
  const bool named = loop.status(axis_y).fault != firmware::AxisFault::none;
  return arrived && went_on && named ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
