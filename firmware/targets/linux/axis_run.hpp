// One axis from set-up to stop: the control loop once a period, and what the operator wants of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "configuration.hpp"
#include "options.hpp"
#include "realtime.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

class AxisRun {
 public:
  // All arguments must outlive it.
  AxisRun(const Configuration& configuration, const Options& options, socketcan::KernelSocket& socket,
          Telemetry& telemetry);

  // Until the operator or --duration ends it; the axis is stopped then. Nothing in it waits but for the next tick.
  // Throws InputError, before anything moved, when the drive cannot be used.
  ExitCode run();

  // What happened, in lines; after run().
  std::string report() const;

 private:
  using SocketPort = socketcan::Port<socketcan::KernelSocket>;
  using Port = NotedPort<SocketPort>;
  using Loop = firmware::ControlLoop<Port, cia402::Drive<float>, law::AxisController<float>, float, 1>;

  void step();
  void set_up();
  void refuse_unusable_drive() const;
  [[noreturn]] void refuse_silent_drive();
  std::string nodes_on_bus();
  void move();
  void follow_visits(double moving_s);
  bool rests_on_target() const;
  bool stop_and_confirm();
  void release_drive();
  const firmware::AxisStatus<float>& status() const { return loop_.status(0); }

  const Configuration& c_;
  const Options& options_;
  Telemetry& telemetry_;
  SocketPort socket_port_;
  Port port_;
  Loop loop_;
  Ticker ticker_;
  hal::Time now_{};
  std::size_t visit_ = 0;
  std::optional<hal::Time> enabled_since_, resting_since_;
  bool heard_ = false;
  bool confirmed_ = false;
  bool reached_ = false;
  firmware::AxisFault last_fault_ = firmware::AxisFault::none;
};

}  // namespace breakaway::linux_node
