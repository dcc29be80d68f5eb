// Drives from set-up to stop, whatever moves them: what NodeRun and IdentifyRun have in common.
#pragma once

#include <bitset>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "breakaway/canopen/pdo.hpp"
#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/node_laws.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "canopen_side.hpp"
#include "configuration.hpp"
#include "experiment_node.hpp"
#include "odrive_side.hpp"
#include "options.hpp"
#include "realtime.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

using Nodes = std::bitset<128>;  // by their numbers on the bus

inline hal::Duration duration_of(double seconds) { return hal::Duration{std::llround(seconds * 1e9)}; }

// Flashed: config::AnyNode<float>, config::WorkNode<float>, config::MachineNode<float> or ExperimentNode.
// Side: CanopenSide, or OdriveSide with the first or the last of them.
template <class Flashed, class Side>
class DriveRun {
 protected:
  using SocketPort = socketcan::Port<socketcan::KernelSocket>;
  using Port = NotedPort<SocketPort>;
  using Served = typename Side::template Served<Port>;
  using Laws = firmware::NodeLaws<Flashed>;
  using Loop = firmware::ControlLoop<Served, typename Side::Drive, typename Laws::Law, float, config::most_axes>;

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
  std::string last_words(std::size_t place) const;
  std::string figures() const;  // of timing and bus, in lines

  const firmware::AxisStatus<float>& status(std::size_t place) const { return loop_.status(axes_[place].id); }
  const typename Side::Drive& drive(std::size_t place) const { return loop_.drive(axes_[place].id); }
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
  typename Side::template Objects<Loop, Flashed> objects_;
  Ticker ticker_;
  hal::Time now_{};
  std::vector<Axis> axes_;

 private:
  void add_axes();
  void poll();
  void sync();
  void answer();
  void reset_faults();
  void note(std::size_t place);
  void refuse_other_master();
  void set_up();
  bool any_configuring() const;
  void refuse_unusable_drives() const;
  void refuse_silent_drives();
  void refuse_standing_drives() const;
  Nodes nodes_on_bus();
  void ask_node(std::uint8_t node);
  std::string fault_text(std::size_t place) const;
  StepRecord record(std::size_t place) const;
  bool stops_are_confirmed();
  void stop_and_confirm();
  void release_drives();
  void release(std::size_t place);
  void write(canopen::SdoClient& sdo, canopen::ObjectWrite object);
  std::string named(std::size_t place) const;
};

extern template class DriveRun<config::AnyNode<float>, CanopenSide>;
extern template class DriveRun<config::WorkNode<float>, CanopenSide>;
extern template class DriveRun<config::MachineNode<float>, CanopenSide>;
extern template class DriveRun<ExperimentNode, CanopenSide>;
extern template class DriveRun<config::AnyNode<float>, OdriveSide>;
extern template class DriveRun<ExperimentNode, OdriveSide>;

}  // namespace breakaway::linux_node
