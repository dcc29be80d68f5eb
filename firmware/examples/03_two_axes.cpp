// Example 3: two axes on one bus.
//
// One description holds the node: the loop, and for each axis its mass, friction, gains, drive and limits. The same text in a file goes to
// `breakaway simulate`, to `breakaway design --header` for a board, and to `breakaway-node` on a PC. Here it is joined with a loop by hand.
//
// Then the drive of one axis dies. The loop names what happened, and the other axis goes on, for the file says fault_stops = "axis".
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/braked_slide.hpp"
#include "breakaway/sil/simulated_network.hpp"

using namespace breakaway;

constexpr const char* description = R"(
[loop]
period_s = 0.001
fault_stops = "axis"    # or "all"

[bus]
bit_rate = 1000000

[[axis]]
name = "x"
plant = { mass_kg = 1.0 }
friction = { lower_N = 2.5, upper_N = 4.5 }
controller = { kind = "impulsive", k1_N_per_m = 400.0, k21_Ns_per_m = 32.0, k22_Ns_per_m = 60.0, kick = "two_phase", max_force_N = 50.0, position_tolerance_m = 2e-6 }
drive = { node_id = 1, rated_torque_Nm = 1.0, rated_current_A = 1.0, max_torque_per_mille = 2000, force_per_torque_N_per_Nm = 25.0, encoder_resolution_m = 1e-6 }

[[axis]]
name = "y"
plant = { mass_kg = 2.5 }
friction = { lower_N = 6.0, upper_N = 9.0 }
controller = { kind = "impulsive", k1_N_per_m = 1000.0, k21_Ns_per_m = 80.0, k22_Ns_per_m = 150.0, kick = "two_phase", max_force_N = 100.0, position_tolerance_m = 2e-6 }
drive = { node_id = 2, rated_torque_Nm = 2.0, rated_current_A = 2.0, max_torque_per_mille = 2000, force_per_torque_N_per_Nm = 25.0, encoder_resolution_m = 1e-6 }
)";

int main() {
  const scenario::Scenario scenario = scenario::parse_scenario(description, "03_two_axes");
  const auto node = config::certified(scenario.node, config::examine(scenario.node));

  // The world: a bus, and on it two emulated drives with an axis each.
  sil::SimulatedNetwork network{*scenario.bus};
  sil::BrakedSlide x{motion::Slide{1.0, scenario.worlds[0].friction, {}}}, y{motion::Slide{2.5, scenario.worlds[1].friction, {}}};
  x.release(0);
  y.release(0);
  network.add_drive(*scenario.worlds[0].drive, x);
  auto& drive_of_y = network.add_drive(*scenario.worlds[1].drive, y);

  // The loop, as on a board: everything it needs stands in the node.
  using Port = sil::SimulatedNetwork::Port;
  using Loop = firmware::ControlLoop<Port, cia402::Drive<float>, law::AxisController<float>, float>;
  Loop loop{network.controller_port(), node.loop};
  firmware::add_axes(loop, node);
  const auto axis_x = *loop.axis(0), axis_y = *loop.axis(1);
  loop.request_enable(axis_x);
  loop.request_enable(axis_y);
  loop.set_target_m(axis_x, 0.010F);
  loop.set_target_m(axis_y, -0.025F);

  const auto run_for = [&, now = hal::Time{}](std::chrono::milliseconds time) mutable {
    for (const hal::Time end = now + time; now < end; now += node.loop.network.period) {
      network.advance_to(now);
      loop.step(now);
    }
  };
  const auto show = [&](const char* moment) {
    std::printf("%s\n", moment);
    for (const auto& [name, id, slide] : {std::tuple{"x", axis_x, &x.slide()}, std::tuple{"y", axis_y, &y.slide()}})
      std::printf("  %s at %10.4f mm, %s\n", name, 1e3 * slide->state().position_m, std::string{to_string(loop.status(id).fault)}.c_str());
  };

  run_for(std::chrono::seconds{3});
  show("both have arrived:");
  const bool arrived = std::abs(x.slide().state().position_m - 0.010) < 3e-6 && std::abs(y.slide().state().position_m + 0.025) < 3e-6;

  drive_of_y.power_off();
  loop.set_target_m(axis_x, 0.020F);
  run_for(std::chrono::seconds{3});
  show("the drive of y has died, and x was sent on:");
  const bool went_on = std::abs(x.slide().state().position_m - 0.020) < 3e-6;
  const bool named = loop.status(axis_y).fault != firmware::AxisFault::none && loop.status(axis_x).fault == firmware::AxisFault::none;
  return arrived && went_on && named ? 0 : 1;
}
