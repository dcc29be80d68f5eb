// The axes of a node from set-up to stop: the control loop once a period, and what the operator wants of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/canopen/pdo.hpp"
#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/node_objects.hpp"
#include "breakaway/firmware/served_port.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "configuration.hpp"
#include "options.hpp"
#include "realtime.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

class NodeRun {
 public:
  // All arguments must outlive it.
  NodeRun(const Configuration& configuration, const Options& options, socketcan::KernelSocket& socket,
          Telemetry& telemetry);

  // Until the operator or --duration ends it; the axes are stopped then. Nothing in it waits but for the next tick.
  // Throws InputError, before anything moved, when a drive cannot be used or another master is on the bus.
  ExitCode run();

  // What happened, in lines; after run().
  std::string report() const;

 private:
  using SocketPort = socketcan::Port<socketcan::KernelSocket>;
  using Port = NotedPort<SocketPort>;
  using Served = firmware::ServedPort<Port>;
  using Loop =
      firmware::ControlLoop<Served, cia402::Drive<float>, law::AxisController<float>, float, config::most_axes>;

  struct Axis {
    Loop::AxisId id;
    std::size_t visit = 0;
    bool heard = false;  // anything, of its drive
    std::optional<hal::Time> enabled_since{};
    bool reached = false;
    bool confirmed = false;      // stopped, as its drive says
    bool reset_refused = false;  // in this step
    firmware::AxisFault last_fault = firmware::AxisFault::none;
  };

  void poll();
  void step();
  void answer();
  void reset_faults();
  void note(std::size_t place);
  void refuse_other_master();
  void set_up();
  bool any_configuring() const;
  void refuse_unusable_drives() const;
  void refuse_silent_drives();
  void refuse_standing_drives() const;
  std::string nodes_on_bus();
  void move();
  void follow_times();
  void follow_tour();
  void visit(std::size_t place, std::size_t visit);
  bool rests_on_target(std::size_t place) const;
  std::string torque_limit_text(std::size_t place) const;
  std::string fault_text(const Axis& axis) const;
  bool stops_are_confirmed();
  void stop_and_confirm();
  void release_drives();
  void release(std::size_t place);
  void write(canopen::SdoClient& sdo, canopen::ObjectWrite object);
  const firmware::AxisStatus<float>& status(std::size_t place) const { return loop_.status(axes_[place].id); }
  const AxisPlan& plan(std::size_t place) const { return c_.axes[place]; }
  const firmware::FlashedAxis<float>& flashed(std::size_t place) const { return c_.node.axes[place]; }
  std::string named(std::size_t place) const;

  const Configuration& c_;
  const Options& options_;
  Telemetry& telemetry_;
  SocketPort socket_port_;
  Port port_;
  Served served_;
  Loop loop_;
  firmware::NodeObjects<Loop, config::AnyNode<float>> objects_;
  Ticker ticker_;
  hal::Time now_{};
  std::vector<Axis> axes_;
  std::optional<hal::Time> resting_since_;  // all axes, on a tour
};

}  // namespace breakaway::linux_node
