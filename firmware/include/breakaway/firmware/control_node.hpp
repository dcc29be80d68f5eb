// ControlNode: a whole controller on one bus, commanded by another node, and open to whoever reads its objects by SDO.
// A target's main() adds a port and a tick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/node_laws.hpp"
#include "breakaway/firmware/node_objects.hpp"
#include "breakaway/firmware/remote_control.hpp"
#include "breakaway/firmware/served_port.hpp"

namespace breakaway::firmware {

// Node: a FlashedNode or a FlashedMachine.
template <hal::CanPort Port, class Node>
class ControlNode {
 public:
  // So many periods pass between two status frames of an axis.
  static constexpr std::uint32_t status_interval = 50;
  static constexpr std::size_t Axes = Node::capacity;

  // The flashed node must outlive this one.
  ControlNode(Port& port, const Node& node) noexcept
      : network_{node.loop.network},
        command_timeout_{node.loop.command_timeout},
        served_{port, network_.node_id},
        port_{served_, network_.node_id},
        laws_{node},
        loop_{port_, node.loop},
        objects_{loop_, node},
        verdict_{verify(node)} {
    if (verdict_.ok()) add_axes(loop_, node, laws_);
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

  // The two halves of a period's work, as ControlLoop has them: command(now) as it begins, sync(now) at sync_due().
  void command(hal::Time now) noexcept {
    if (!verdict_.ok()) return;
    for (std::size_t i = 0; i < Axes; ++i) obey(i, now);
    loop_.command(now);
    began_ = now;
  }
  std::optional<hal::Time> sync_due() const noexcept { return loop_.sync_due(); }
  void sync(hal::Time now) noexcept {
    if (!verdict_.ok() || !loop_.sync_due()) return;
    loop_.sync(now);
    tell(began_ + network_.period);
  }

  // Both at once, for who cannot wait within a period.
  void step(hal::Time now) noexcept {
    command(now);
    sync(now);
  }

 private:
  using Laws = NodeLaws<Node>;
  using Scalar = typename Laws::Scalar;
  using Served = ServedPort<Port>;
  using Tap = CommandedPort<Served, Axes>;
  using Loop = ControlLoop<Tap, cia402::Drive<Scalar>, typename Laws::Law, Scalar, Axes>;

  void obey(std::size_t place, hal::Time now) noexcept {
    const auto axis = loop_.axis(place);
    if (!axis) return;
    // A command is as old as the step that took it in: nobody may stand behind it any more where the loop stood still
    // since.
    const auto command = port_.take_command(place);
    if (command && now - began_ <= command_timeout_) remote_[place].apply(loop_, *axis, *command, began_);
    remote_[place].watch(loop_, *axis, now, command_timeout_);
  }

  // The axes take turns, so that no period has more than one status frame; an SDO answer waits for one without.
  void tell(hal::Time deadline) noexcept {
    static_assert(Axes <= status_interval);
    if (++periods_ == status_interval) periods_ = 0;
    hal::CanFrame answer;
    if (const auto axis = loop_.axis(periods_))
      static_cast<void>(port_.send(status_frame(loop_, *axis, network_.node_id), deadline));
    else if (served_.server().next_frame(answer, objects_))
      static_cast<void>(port_.send(answer, deadline));
  }

  hal::NetworkConfig network_;
  hal::Duration command_timeout_;
  Served served_;
  Tap port_;
  Laws laws_;
  Loop loop_;
  NodeObjects<Loop, Node> objects_;
  std::array<RemoteAxis, Axes> remote_{};
  NodeVerdict verdict_;
  std::uint32_t periods_ = 0;
  hal::Time began_{};  // the newest period
};

}  // namespace breakaway::firmware
