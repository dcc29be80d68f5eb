// EmulatorConfig: the ODrive and motor that an emulator stands for.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "breakaway/hal/time.hpp"

namespace breakaway::odrive_emulator {

struct EmulatorConfig {
  std::uint8_t node_id = 1;
  std::uint8_t firmware_minor = 6;
  double force_per_torque_N_per_Nm = 1;
  double travel_per_turn_m = 1;
  double max_torque_Nm = 1;                // of the motor
  double torque_constant_Nm_per_A = 0.05;  // by which Set_Limits bounds the torque
  double current_loop_time_constant_s = 0;
  double encoder_resolution_m = 1e-6;  // of the estimate, before it becomes a float; 0: it has none
  bool counts_from_power_on = false;   // the position is 0 where it is switched on

  // By the drive's own clock, which runs slow by clock_error. 0: it does not send them by itself.
  hal::Duration heartbeat_period = std::chrono::milliseconds{100};
  hal::Duration estimate_period = std::chrono::milliseconds{1};
  hal::Duration torque_period = std::chrono::milliseconds{1};
  double clock_error = 0;

  hal::Duration boot_duration = std::chrono::milliseconds{300};
  hal::Duration response_delay = std::chrono::microseconds{50};    // of an answer
  hal::Duration watchdog_timeout = std::chrono::milliseconds{50};  // 0: it has none

  // What a drive may do wrong.
  bool calibrated = true;
  bool answers_questions = true;
  bool ignores_idle = false;
  bool ignores_estop = false;
};

}  // namespace breakaway::odrive_emulator
