// NodeHost: what breakaway-node runs on, in simulated time. Its program has a clock and a CAN socket of its own, in
// place of those of linux_node and socketcan: the node sleeps while the drives and axes of a scenario go on, and its
// frames pass over their simulated bus.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/simulated_network.hpp"
#include "options.hpp"
#include "telemetry.hpp"

namespace breakaway::closed_loop {

class NodeHost {
 public:
  // One at a time. The scenario must outlive it.
  explicit NodeHost(const scenario::Scenario& s);
  ~NodeHost();
  NodeHost(const NodeHost&) = delete;
  NodeHost& operator=(const NodeHost&) = delete;
  static NodeHost& running();

  // Called whenever the node wakes, before it goes on.
  std::function<void()> at_wake_up = [] {};
  // The node's next sleep takes so much longer.
  void oversleep(hal::Duration time) { late_ = time; }

  hal::Time now() const { return network_.bus().now(); }
  hal::Time sleep_until(hal::Time time);
  sil::SimulatedNetwork::Port& port() { return network_.controller_port(); }
  // Another tool's door to the bus.
  sil::SimulatedNetwork::Port& other_tool() { return other_tool_; }
  std::size_t axes() const { return axes_.size(); }
  drive_emulator::EmulatedDrive& drive(std::size_t axis) { return *axes_[axis].drive; }
  sil::AxisState state(std::size_t axis) const { return axes_[axis].mechanism.axis->state(); }
  // Its drive is enabled.
  bool holds_axis(std::size_t axis) const { return axes_[axis].holds(); }
  double force_N(std::size_t axis) const;

 private:
  struct Axis {
    sil::AxisMechanism mechanism;
    drive_emulator::EmulatedDrive* drive = nullptr;
    std::function<bool()> holds{};
  };

  void add_drive(Axis& axis, const scenario::AxisWorld& world);

  std::vector<Axis> axes_;
  sil::SimulatedNetwork network_;
  sil::SimulatedNetwork::Port& other_tool_;
  hal::Duration late_{};
};

// How a run of the node ended.
struct NodeEnd {
  int exit_code = 0;
  std::string said;
};

// breakaway-node with these options on the host, without its logs. Throws InputError where it would say so and end.
NodeEnd run_node(const linux_node::Options& options, linux_node::Telemetry& telemetry);

}  // namespace breakaway::closed_loop
