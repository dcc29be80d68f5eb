// Example 3: run two axes on one bus, and lose the drive of one.
//
// two_axes.toml describes the whole node: the loop, and for each axis its mass, friction, gains, drive and limits. The
// same file goes to `breakaway simulate`, `breakaway design --header` (for a board) and `breakaway-node` (on Linux).
// Here the loop is built from it by hand, so that the program can look inside.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/node_laws.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/simulated_network.hpp"

using namespace breakaway;

using Port = sil::SimulatedNetwork::Port;
using Loop = firmware::ControlLoop<Port, cia402::Drive<float>, law::AxisController<float>, float>;

void show(const char* name, const sil::BrakedMechanism& axis, firmware::AxisFault fault) {
  std::printf("  %s is at %8.4f mm, fault: %s\n", name, 1e3 * axis.state().position_m,
              std::string{to_string(fault)}.c_str());
}

int main() try {
  const scenario::Scenario scenario = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/firmware/examples/two_axes.toml");
  if (scenario.axes() != 2) throw InputError{"this example runs two axes: give it a file with two [[axis]]"};
  const auto node = config::certified(scenario.node, config::examine(scenario.node));
  const auto near = [&](const sil::BrakedMechanism& axis, double place_m) {
    return std::abs(axis.state().position_m - place_m) <=
           config::judged_tolerance_m(scenario.node, scenario.node.axes[0]);
  };

  // The world: a bus with two emulated drives, and an axis behind each.
  const sil::AxisMechanism x = sil::axis_mechanism(scenario.node.axes[0], scenario.worlds[0]);
  const sil::AxisMechanism y = sil::axis_mechanism(scenario.node.axes[1], scenario.worlds[1]);
  x.axis->release(0);
  y.axis->release(0);
  sil::SimulatedNetwork network{*scenario.bus};
  network.add_drive(*scenario.worlds[0].drive, x.seen_by_drive());
  drive_emulator::DriveEmulator& drive_of_y = network.add_drive(*scenario.worlds[1].drive, y.seen_by_drive());

  // The loop, as on a board.
  Loop loop{network.controller_port(), node.loop};
  firmware::add_axes(loop, node);
  const Loop::AxisId axis_x = *loop.axis(0), axis_y = *loop.axis(1);
  hal::Time now{};
  const auto run_for = [&](hal::Duration time) {
    for (const hal::Time end = now + time; now < end; now += node.loop.network.period) network.begin_period(loop, now);
  };

  loop.request_enable(axis_x);
  loop.request_enable(axis_y);
  loop.set_target_m(axis_x, 0.010F);
  loop.set_target_m(axis_y, -0.025F);
  run_for(std::chrono::seconds{3});
  std::printf("sent to 10 mm and -25 mm:\n");
  show("x", *x.axis, loop.status(axis_x).fault);
  show("y", *y.axis, loop.status(axis_y).fault);
  const bool arrived = near(*x.axis, 0.010) && near(*y.axis, -0.025);

  drive_of_y.power_off(now);
  loop.set_target_m(axis_x, 0.020F);
  run_for(std::chrono::seconds{3});
  std::printf("the drive of y has lost its power, and x was sent to 20 mm:\n");
  show("x", *x.axis, loop.status(axis_x).fault);
  show("y", *y.axis, loop.status(axis_y).fault);
  const bool went_on = near(*x.axis, 0.020) && loop.status(axis_x).fault == firmware::AxisFault::none;
  const bool named = loop.status(axis_y).fault != firmware::AxisFault::none;
  return arrived && went_on && named ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
