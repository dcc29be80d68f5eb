// Example 2: a CAN port of your own.
//
// breakaway talks to the bus through the concept hal::CanPort: four calls, described in breakaway/hal/can_port.hpp. Whatever
// has them will do: a controller's registers, an adapter on a serial line, a socket. The port below is the least that there is, two queues,
// as the mailboxes of a CAN controller are; an emulated drive listens at their other end.
//
// Behind the port runs a whole controller, ControlNode. It starts from a flashed node, as on a board, and obeys commands that come over the bus.
#include <chrono>
#include <cstdio>
#include <deque>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/sil/braked_slide.hpp"

using namespace breakaway;

class QueuePort {
 public:
  // The frame goes behind those that wait. A real port also drops what is not on the wire by `deadline`.
  hal::SendResult send(const hal::CanFrame& frame, hal::Time) noexcept {
    if (sent_.size() == 64) return hal::SendResult::queue_full;
    sent_.push_back(frame);
    return hal::SendResult::queued;
  }

  // The oldest frame that came in, if there is one.
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (received_.empty()) return false;
    received = received_.front();
    received_.pop_front();
    return true;
  }

  void purge_transmit_queue() noexcept { sent_.clear(); }
  hal::BusState bus_state() const noexcept { return hal::BusState::error_active; }

  // The other end, where your hardware is.

  bool take_sent(hal::CanFrame& frame) {
    if (sent_.empty()) return false;
    frame = sent_.front();
    sent_.pop_front();
    return true;
  }
  void deliver(const hal::CanFrame& frame, hal::Time time) { received_.push_back({frame, time}); }

 private:
  std::deque<hal::CanFrame> sent_;  // a port for a controller has arrays of a fixed size here
  std::deque<hal::ReceivedFrame> received_;
};

// The compiler checks the whole interface here, and says which call is missing or wrong.
static_assert(hal::CanPort<QueuePort>);

int main() {
  // What `breakaway design can_axis.toml --header flashed_node.hpp` writes for a board is made in memory here.
  const config::Node description = config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml");
  const auto flashed = config::certified(description, config::examine(description));
  const hal::Duration period = flashed.loop.network.period;
  const std::uint8_t node_id = flashed.loop.network.node_id;

  QueuePort port;
  firmware::ControlNode<QueuePort, config::most_axes> node{port, flashed};
  if (!node.verdict().ok()) {
    std::printf("%s\n", std::string{to_string(node.verdict().error)}.c_str());
    return 1;
  }

  // The world: an axis at 0 with friction, behind an emulated CiA 402 drive.
  sil::BrakedSlide axis{motion::Slide{1.0, {{2.5, 4.5}, model::shape::constant(0.5)}, {}}};
  axis.release(0);
  drive_emulator::EmulatorConfig drive_config;
  drive_config.rated_torque_mNm = 1000;
  drive_config.force_per_torque_N_per_Nm = flashed.axes[0].drive.force_per_torque_N_per_Nm;
  drive_config.encoder_resolution_m = 1e-6;
  drive_emulator::DriveEmulator drive{drive_config, axis,
                                      [&](const hal::CanFrame& frame, hal::Time at) { port.deliver(frame, at); }};
  drive.power_on(hal::Time{});

  hal::Time now{};
  for (int k = 0; k < 3000; ++k, now += period) {
    // Another node tells this one, once, to go to 20 mm. Nothing moves before.
    if (k == 500) port.deliver(firmware::encode_command({.axis = 0, .enable = true, .target_counts = 20'000}, node_id), now);
    node.step(now);
    for (hal::CanFrame frame; port.take_sent(frame);) drive.on_frame(frame, now);
    drive.advance_to(now + period);
    drive.advance_mechanism_to(now + period);
  }
  const double error_m = axis.slide().state().position_m - 0.02;
  std::printf("after %.1f s the axis is %.2f um from 20 mm\n", 1e-9 * static_cast<double>(now.time_since_epoch().count()),
              1e6 * error_m);
  return axis.slide().sticking() && std::abs(error_m) < 3e-6 ? 0 : 1;
}
