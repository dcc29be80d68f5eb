// Example 2: connect the controller to a CAN controller of your own.
//
// breakaway reaches the bus through the concept hal::CanPort: four calls, described in breakaway/hal/can_port.hpp. A
// CAN controller's registers, an adapter on a serial line and a socket all have them. The port below is the smallest
// one: two queues, with an emulated CiA 402 drive at their other end.
//
// Behind the port runs a whole controller, firmware::ControlNode, as it does on a board. It starts from a flashed node
// and obeys the commands that come over the bus.
#include <cmath>
#include <cstdio>
#include <deque>
#include <exception>
#include <string>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/sil/braked_slide.hpp"

using namespace breakaway;

class QueuePort {
 public:
  // Puts the frame behind those that wait. A port with hardware also drops it when it is not on the wire by `deadline`.
  hal::SendResult send(const hal::CanFrame& frame, hal::Time /*deadline*/) noexcept {
    if (to_bus.size() == 64) return hal::SendResult::queue_full;
    to_bus.push_back(frame);
    return hal::SendResult::queued;
  }

  // Takes the oldest frame that came in, if there is one.
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (from_bus.empty()) return false;
    received = from_bus.front();
    from_bus.pop_front();
    return true;
  }

  void purge_transmit_queue() noexcept { to_bus.clear(); }
  hal::BusState bus_state() const noexcept { return hal::BusState::error_active; }

  // Your hardware is at the other end of these. On a board they would be arrays of a fixed size.
  std::deque<hal::CanFrame> to_bus;
  std::deque<hal::ReceivedFrame> from_bus;
};

// Here the compiler checks the interface and names the call that is missing or wrong.
static_assert(hal::CanPort<QueuePort>);

int main() try {
  // For a board, `breakaway design can_axis.toml --header flashed_node.hpp` writes this node as a constant.
  const config::Node description = config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml");
  const auto flashed = config::certified(description, config::examine(description));
  const hal::NetworkConfig& network = flashed.loop.network;

  QueuePort port;
  firmware::ControlNode node{port, flashed};
  std::printf("%s\n", std::string{to_string(node.verdict().error)}.c_str());

  // The world: an axis of the mass in that file at position 0, with friction midway between its bounds, and its drive.
  const config::Truth truth = config::truth_of(description.axes[0]);
  sil::BrakedSlide axis{motion::Slide{truth.mass_kg, {truth.bounds, model::shape::constant(0.5)}, {}}};
  axis.release(0);
  const config::Drive& motor = *description.axes[0].drive;
  drive_emulator::EmulatorConfig drive_config;
  drive_config.node_id = motor.node_id;
  drive_config.rated_torque_mNm = motor.rated_torque_mNm;
  drive_config.max_torque_per_mille = motor.max_torque_per_mille;
  drive_config.force_per_torque_N_per_Nm = motor.force_per_torque_N_per_Nm;
  drive_config.encoder_resolution_m = motor.encoder_resolution_m;
  drive_emulator::DriveEmulator drive{drive_config, axis, [&](const hal::CanFrame& frame, hal::Time at) {
                                        port.from_bus.push_back({frame, at});
                                      }};
  drive.power_on(hal::Time{});

  hal::Time now{};
  for (int period = 0; period < 3000; ++period, now += network.period) {
    // Another node says ten times a second what is to be done. From 0.5 s on it sends the axis to 20 mm.
    const firmware::MotionCommand command{.axis = 0, .enable = period >= 500, .target_counts = 20'000};
    if (period % 100 == 0) port.from_bus.push_back({firmware::encode_command(command, network.node_id), now});
    node.step(now);
    for (; !port.to_bus.empty(); port.to_bus.pop_front()) drive.on_frame(port.to_bus.front(), now);
    drive.advance_to(now + network.period);
    drive.advance_mechanism_to(now + network.period);
  }
  const double error_m = axis.slide().state().position_m - 0.02;
  const bool arrived =
      axis.slide().sticking() && std::abs(error_m) <= config::judged_tolerance_m(description, description.axes[0]);
  std::printf("after 3 s the axis %s, %.2f um from 20 mm\n", arrived ? "rests" : "does NOT rest", 1e6 * error_m);
  return arrived ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
