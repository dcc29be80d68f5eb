// OdriveSide: what a run of drives does and says otherwise for ODrive's CANSimple than for CANopen.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/network_config.hpp"
#include "breakaway/odrive/drive.hpp"
#include "configuration.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

// Its identifiers leave no room for objects of the node.
template <hal::CanPort Port>
class UnservedPort {
 public:
  UnservedPort(Port& port, std::uint8_t /*node_id*/) noexcept : port_{&port} {}
  hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept { return port_->send(frame, deadline); }
  bool receive(hal::ReceivedFrame& received) noexcept { return port_->receive(received); }
  void purge_transmit_queue() noexcept { port_->purge_transmit_queue(); }
  hal::BusState bus_state() const noexcept { return port_->bus_state(); }

 private:
  Port* port_;
};

struct OdriveSide {
  using Drive = odrive::Drive<float>;
  template <class Port>
  using Served = UnservedPort<Port>;
  template <class Loop, class Flashed>
  struct Objects {
    Objects(Loop& /*loop*/, const Flashed& /*flashed*/) noexcept {}
  };

  static constexpr bool is_canopen = false;
  static constexpr const char* stop_means = "Set_Axis_State and Estop";

  static bool was_heard(const Drive& drive) { return drive.setup_status() != odrive::SetupStatus::no_heartbeat; }
  static hal::Duration extra_setup_time(const Drive& /*drive*/) { return {}; }
  // As those of CanopenSide.
  static std::optional<std::uint8_t> heard_node(const hal::CanFrame& frame);
  static std::string other_master(const hal::CanFrame& frame, const hal::NetworkConfig& network,
                                  std::span<const std::uint8_t> nodes);
  static std::string why_unusable(const Drive& drive) { return std::string{to_string(drive.setup_status())}; }
  static std::string why_standing(const Drive& drive);
  static void note(const Drive& drive, StepRecord& step);
  static std::string last_words(const Drive& /*drive*/, const AxisPlan& /*plan*/) { return {}; }
};

}  // namespace breakaway::linux_node
