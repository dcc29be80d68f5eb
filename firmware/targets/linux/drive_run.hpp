// Drives from set-up to stop, whatever moves them: what NodeRun and IdentifyRun have in common.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "breakaway/canopen/pdo.hpp"
#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/node_laws.hpp"
#include "breakaway/firmware/node_objects.hpp"
#include "breakaway/firmware/served_port.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "configuration.hpp"
#include "experiment_node.hpp"
#include "options.hpp"
#include "realtime.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

inline hal::Duration duration_of(double seconds) { return hal::Duration{std::llround(seconds * 1e9)}; }

// Flashed: config::AnyNode<float>, config::WorkNode<float>, config::MachineNode<float> or ExperimentNode.
template <class Flashed>
class DriveRun {
 protected:
  using SocketPort = socketcan::Port<socketcan::KernelSocket>;
  using Port = NotedPort<SocketPort>;
  using Served = firmware::ServedPort<Port>;
  using Laws = firmware::NodeLaws<Flashed>;
  using Loop = firmware::ControlLoop<Served, cia402::Drive<float>, typename Laws::Law, float, config::most_axes>;

  struct Axis {
    typename Loop::AxisId id;
    bool heard = false;          // anything, of its drive
    bool confirmed = false;      // stopped, as its drive says
    bool reset_refused = false;  // in this step
    firmware::AxisFault last_fault = firmware::AxisFault::none;
  };

  // All arguments must outlive it.
  DriveRun(const Flashed& flashed, const Configuration& configuration, const Options& options,
           socketcan::KernelSocket& socket, Telemetry& telemetry);

  // Sets the drives up. Throws InputError, before anything moved, when a drive cannot be used or another master is on
  // the bus.
  void get_ready();
  void enable();
  // One period.
  void step();
  // Stops the axes, and gives the drives back.
  void stop();
  // It had no fault, and its drive says that it has no force.
  bool ended_well(std::size_t place) const;

  std::string stop_text(std::size_t place) const;
  std::string torque_limit_text(std::size_t place) const;
  std::string figures() const;  // of timing and bus, in lines

  const firmware::AxisStatus<float>& status(std::size_t place) const { return loop_.status(axes_[place].id); }
  const AxisPlan& plan(std::size_t place) const { return c_.axes[place]; }

  const Flashed& flashed_;
  const Configuration& c_;
  const Options& options_;
  Telemetry& telemetry_;
  SocketPort socket_port_;
  Port port_;
  Served served_;
  Laws laws_;
  Loop loop_;
  firmware::NodeObjects<Loop, Flashed> objects_;
  Ticker ticker_;
  hal::Time now_{};
  std::vector<Axis> axes_;

 private:
  void poll();
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
  std::string fault_text(const Axis& axis) const;
  bool stops_are_confirmed();
  void stop_and_confirm();
  void release_drives();
  void release(std::size_t place);
  void write(canopen::SdoClient& sdo, canopen::ObjectWrite object);
  std::string named(std::size_t place) const;
};

extern template class DriveRun<config::AnyNode<float>>;
extern template class DriveRun<config::WorkNode<float>>;
extern template class DriveRun<config::MachineNode<float>>;
extern template class DriveRun<ExperimentNode>;

}  // namespace breakaway::linux_node
