#include "node_host.hpp"

#include <linux/can.h>

#include <algorithm>
#include <span>
#include <utility>

#include "any_run.hpp"
#include "breakaway/cia402/state.hpp"
#include "breakaway/odrive/messages.hpp"
#include "breakaway/socketcan/frames.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "clock.hpp"
#include "configuration.hpp"

namespace breakaway::closed_loop {
namespace {

NodeHost* host = nullptr;

}  // namespace

NodeHost::NodeHost(const scenario::Scenario& s)
    : network_{s.bus.value_or(virtual_bus::VirtualBusConfig{})}, other_tool_{network_.add_port()} {
  auto mechanisms = sil::axis_mechanisms(s);
  axes_.reserve(mechanisms.size());
  for (std::size_t i = 0; i < mechanisms.size(); ++i) {
    axes_.push_back({.mechanism = std::move(mechanisms[i])});
    add_drive(axes_.back(), s.worlds[i]);
  }
  host = this;
}

NodeHost::~NodeHost() { host = nullptr; }

NodeHost& NodeHost::running() { return *host; }

void NodeHost::add_drive(Axis& axis, const scenario::AxisWorld& world) {
  if (world.odrive) {
    auto& drive = network_.add_drive(*world.odrive, axis.mechanism.seen_by_drive());
    axis.drive = &drive;
    axis.holds = [&drive] { return drive.state() == odrive::AxisState::closed_loop_control; };
  } else {
    auto& drive = network_.add_drive(*world.drive, axis.mechanism.seen_by_drive());
    axis.drive = &drive;
    axis.holds = [&drive] { return drive.state() == cia402::State::operation_enabled; };
  }
}

// The brake of an axis opens when its drive first holds it.
hal::Time NodeHost::sleep_until(hal::Time time) {
  network_.advance_to(std::max(time, now()) + std::exchange(late_, {}));
  for (const Axis& axis : axes_)
    if (axis.holds() && !axis.mechanism.axis->released()) axis.mechanism.axis->release(hal::seconds(now()));
  at_wake_up();
  return now();
}

double NodeHost::force_N(std::size_t axis) const { return axes_[axis].drive->force().at_N(hal::seconds(now()), 0, 0); }

NodeEnd run_node(const linux_node::Options& options, linux_node::Telemetry& telemetry) {
  const linux_node::Configuration configuration =
      options.identify ? linux_node::read_experiment(options) : linux_node::read_configuration(options);
  socketcan::KernelSocket socket;
  return linux_node::with_run(configuration, options, socket, telemetry, [](auto& run) {
    const int code = run.run();
    return NodeEnd{code, run.report()};
  });
}

}  // namespace breakaway::closed_loop

// In place of clock.cpp.
namespace breakaway::linux_node {

hal::Time monotonic_now() noexcept { return closed_loop::NodeHost::running().now(); }
hal::Time sleep_until(hal::Time time) noexcept { return closed_loop::NodeHost::running().sleep_until(time); }

}  // namespace breakaway::linux_node

// In place of kernel_socket.cpp.
namespace breakaway::socketcan {

using closed_loop::NodeHost;

OpenResult KernelSocket::open(const char*, std::span<const Filter>) noexcept { return OpenResult::done; }
bool KernelSocket::reopen() noexcept { return true; }
void KernelSocket::close() noexcept {}

Io KernelSocket::write(const can_frame& frame) const noexcept {
  const auto ours = from_kernel(frame);
  if (!ours) return Io::refused;
  const auto result = NodeHost::running().port().send(*ours, hal::Time::max());
  if (result == hal::SendResult::queued) return Io::done;
  return result == hal::SendResult::bus_off ? Io::down : Io::again;
}

Io KernelSocket::read(can_frame& frame, hal::Time& received) noexcept {
  hal::ReceivedFrame ours;
  if (!NodeHost::running().port().receive(ours)) return Io::again;
  frame = to_kernel(ours.frame);
  received = ours.time;
  return Io::done;
}

std::size_t KernelSocket::unsent_bytes() const noexcept { return 0; }
bool KernelSocket::on_bus() const noexcept { return NodeHost::running().port().bus_state() != hal::BusState::bus_off; }

}  // namespace breakaway::socketcan
