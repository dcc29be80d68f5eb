// SetupStatus: how the set-up of a drive stands, and what to do when it does not come to its end.
#pragma once

#include <cstdint>
#include <string_view>

namespace breakaway::odrive {

enum class SetupStatus : std::uint8_t {
  ready,
  no_heartbeat,           // nothing was heard of the node; it is waited for
  starting,               // its heartbeat says that it still starts
  no_version,             // it does not answer Get_Version
  no_estimates,           // it sends no position
  being_told,             // the mode and the limits are on their way
  config_invalid,         // check() refuses what the drive was configured with
  firmware_too_old,       // before 0.6
  force_step_too_coarse,  // one step of the torque's grid is more than the axis' force limit
  stop_not_obeyed,        // the drive was told to stop and is not seen without force
};

constexpr std::string_view to_string(SetupStatus status) noexcept {
  switch (status) {
    case SetupStatus::ready:
      return "the drive is set up";
    case SetupStatus::no_heartbeat:
      return "the drive sends no heartbeat; check its power, the wiring, node_id, the bit rate and "
             "heartbeat_msg_rate_ms";
    case SetupStatus::starting:
      return "the drive still starts; wait";
    case SetupStatus::no_version:
      return "the drive does not answer Get_Version, as firmware before 0.6 does not; update its firmware";
    case SetupStatus::no_estimates:
      return "the drive sends no encoder estimates; set its encoder_msg_rate_ms and torques_msg_rate_ms to "
             "estimate_period_s, or let them be polled (estimates = \"polled\")";
    case SetupStatus::being_told:
      return "the drive is being set up; wait";
    case SetupStatus::config_invalid:
      return "the drive's configuration cannot be used; odrive::check() names the field";
    case SetupStatus::firmware_too_old:
      return "the drive's firmware is older than 0.6, whose messages are others; update it";
    case SetupStatus::force_step_too_coarse:
      return "a step of the torque, of which max_torque_Nm has 16384, is more than max_force_N; raise max_force_N, or "
             "correct max_torque_Nm";
    case SetupStatus::stop_not_obeyed:
      return "the drive does not obey a stop, and is told again by Set_Axis_State and Estop; switch its power off "
             "where force must not stay on, and look for what else commands it";
  }
  return "unknown set-up status";
}

}  // namespace breakaway::odrive
