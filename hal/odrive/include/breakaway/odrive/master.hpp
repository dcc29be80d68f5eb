// Master: what the loop does and hears on a bus of ODrives that concerns no single axis. There is neither SYNC nor a
// heartbeat of the master: a drive notices a lost master by its watchdog, which Set_Input_Torque feeds.
#pragma once

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/network_config.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/odrive/messages.hpp"

namespace breakaway::odrive {

class Master {
 public:
  constexpr explicit Master(const hal::NetworkConfig& /*network*/) noexcept {}

  // The node that the frame is from or for.
  static constexpr std::uint8_t node_of(const hal::CanFrame& frame) noexcept { return node_id_of(frame.id); }
  // No frame is the master's alone.
  static constexpr bool is_own(const hal::CanFrame& /*frame*/) noexcept { return false; }
  // Somebody else commands the node. An emergency stop may come from anybody, and is named by the drive itself; whoever
  // only asks does no harm.
  static constexpr bool is_command(const hal::CanFrame& frame, std::uint8_t node_id) noexcept {
    if (frame.remote || node_id_of(frame.id) != node_id) return false;
    const auto command = command_of(frame.id);
    return (command == Command::write_parameter && frame.data[0] != 0) || command == Command::set_axis_state ||
           (command >= Command::set_controller_mode && command <= Command::set_trajectory_inertia) ||
           (command >= Command::reboot && command <= Command::set_velocity_gains && command != bus_voltage);
  }
  static constexpr hal::Duration sync_offset(unsigned /*axes*/, const hal::NetworkConfig& /*network*/) noexcept {
    return hal::Duration::zero();
  }
  static constexpr bool next_sync(hal::CanFrame& /*frame*/) noexcept { return false; }
  static constexpr bool next_heartbeat(hal::CanFrame& /*frame*/, hal::Time /*now*/) noexcept { return false; }

 private:
  static constexpr auto bus_voltage = static_cast<Command>(0x17);  // a message of the drive
};

}  // namespace breakaway::odrive
