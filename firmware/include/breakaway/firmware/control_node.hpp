// ControlNode: a whole controller on one bus, commanded by another node, and open to whoever reads its objects by SDO.
// A target's main() adds a port and a tick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/flashed_node.hpp"
#include "breakaway/firmware/node_objects.hpp"
#include "breakaway/firmware/remote_control.hpp"
#include "breakaway/firmware/served_port.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway::firmware {

// Puts the axes of a node that verify() has found to be good into a loop with room for them. The node must outlive the
// loop.
template <class Loop, class Scalar, std::size_t Axes, class Kicks>
[[gnu::cold]] void add_axes(Loop& loop, const FlashedNode<Scalar, Axes, Kicks>& node) noexcept {
  for (std::size_t i = 0; i < node.count; ++i) {
    const FlashedAxis<Scalar, Kicks>& axis = node.axes[i];
    static_cast<void>(loop.add_axis(axis.drive, {axis.law, axis.k3_table, axis.kicks}, axis.limits));
  }
}

// Kicks: as those of the flashed node.
template <hal::CanPort Port, std::size_t Axes, class Scalar = float, class Kicks = law::BrakedKicks<Scalar>>
class ControlNode {
 public:
  // So many periods pass between two status frames of an axis.
  static constexpr std::uint32_t status_interval = 50;

  // The flashed node must outlive this one.
  ControlNode(Port& port, const FlashedNode<Scalar, Axes, Kicks>& node) noexcept
      : network_{node.loop.network},
        command_timeout_{node.loop.command_timeout},
        served_{port, network_.node_id},
        port_{served_, network_.node_id},
        loop_{port_, node.loop},
        objects_{loop_, node},
        verdict_{verify(node)} {
    if (verdict_.ok()) add_axes(loop_, node);
  }

  // Returns what keeps the node from running. If anything does, step() does nothing and the bus stays silent.
  NodeVerdict verdict() const noexcept { return verdict_; }

  // To be called before the first step when the watchdog ended the last run. Every axis then has the fault
  // "reset by the watchdog", which a commander sees in its status, and none is enabled before that was reset.
  void note_watchdog_reset() noexcept {
    for (std::size_t i = 0; i < Axes; ++i)
      if (const auto axis = loop_.axis(i)) loop_.start_with(*axis, AxisFault::watchdog_reset, hal::Time{});
  }

  // Its loop, to look at.
  const auto& loop() const noexcept { return loop_; }

  // Does the work of one period.
  void step(hal::Time now) noexcept {
    if (!verdict_.ok()) return;
    for (std::size_t i = 0; i < Axes; ++i) obey(i, now);
    loop_.step(now);
    tell(now);
  }

 private:
  using Served = ServedPort<Port>;
  using Tap = CommandedPort<Served, Axes>;
  using Loop = ControlLoop<Tap, cia402::Drive<Scalar>, law::AxisController<Scalar, Kicks>, Scalar, Axes>;

  void obey(std::size_t place, hal::Time now) noexcept {
    const auto axis = loop_.axis(place);
    if (!axis) return;
    if (const auto command = port_.take_command(place)) remote_[place].apply(loop_, *axis, *command, now);
    remote_[place].watch(loop_, *axis, now, command_timeout_);
  }

  // The axes take turns, so that no period has more than one status frame; an SDO answer waits for one without.
  void tell(hal::Time now) noexcept {
    static_assert(Axes <= status_interval);
    if (++periods_ == status_interval) periods_ = 0;
    const hal::Time deadline = now + network_.period;
    hal::CanFrame answer;
    if (const auto axis = loop_.axis(periods_))
      static_cast<void>(port_.send(status_frame(loop_, *axis, network_.node_id), deadline));
    else if (served_.server().next_frame(answer, objects_))
      static_cast<void>(port_.send(answer, deadline));
  }

  canopen::NetworkConfig network_;
  hal::Duration command_timeout_;
  Served served_;
  Tap port_;
  Loop loop_;
  NodeObjects<Loop, FlashedNode<Scalar, Axes, Kicks>> objects_;
  std::array<RemoteAxis, Axes> remote_{};
  NodeVerdict verdict_;
  std::uint32_t periods_ = 0;
};

}  // namespace breakaway::firmware
