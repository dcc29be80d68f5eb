#include "breakaway/drive_emulator/config.hpp"

#include <cmath>

namespace breakaway::drive_emulator {

namespace {

void require(bool condition, const std::string& remedy) {
  if (!condition) throw InputError{"drive: " + remedy};
}

bool positive(double value) { return std::isfinite(value) && value > 0; }

}  // namespace

void validate(const EmulatorConfig& config) {
  require(config.node_id >= 1 && config.node_id <= 127, "node_id must be 1..127");
  require(config.rated_torque_mNm > 0, "rated_torque_mNm must be above 0");
  require(config.rated_current_mA > 0, "rated_current_mA must be above 0");
  require(positive(config.force_per_torque_N_per_Nm), "force_per_torque_N_per_Nm must be finite and above 0");
  require(!config.peak_force_N || positive(*config.peak_force_N), "peak_force_N must be finite and above 0");
  require(config.peak_force_N || config.max_torque_per_mille > 0,
          "max_torque_per_mille must be above 0 unless peak_force_N is given");
  require(std::isfinite(config.current_loop_time_constant_s) && config.current_loop_time_constant_s >= 0,
          "current_loop_time_constant_s must be finite and not negative");
  require(positive(config.encoder_resolution_m), "encoder_resolution_m must be finite and above 0");
  require(config.min_tpdo_delay.count() >= 0 && config.min_tpdo_delay <= config.max_tpdo_delay,
          "min_tpdo_delay must not be negative nor above max_tpdo_delay");
  require(config.sdo_response_delay.count() >= 0, "sdo_response_delay must not be negative");
  require(config.sdo_timeout.count() > 0, "sdo_timeout must be above 0");
  require(config.boot_duration.count() >= 0, "boot_duration must not be negative");
  require(config.stop_duration.count() >= 0, "stop_duration must not be negative");
  require(config.error_behaviour <= 2, "error_behaviour must be 0, 1 or 2");
  require(config.valid_pdos <= 4, "valid_pdos must be 0..4");
  require(config.quirks.sdo_response_delay.count() >= 0, "quirks.sdo_response_delay must not be negative");
  require(config.quirks.sdo_busy.count() >= 0, "quirks.sdo_busy must not be negative");
  require(config.quirks.informs_every.count() > 0, "quirks.informs_every must be above 0");
  const HomeSwitches switches = config.quirks.switches.value_or(HomeSwitches{});
  require(positive(switches.index_distance_m), "quirks.index_distance_m must be finite and above 0");
  require(positive(switches.speed_gain_Ns_per_m), "quirks.speed_gain_Ns_per_m must be finite and above 0");
  require(config.quirks.mode_display_delay.count() >= 0, "quirks.mode_display_delay must not be negative");
}

}  // namespace breakaway::drive_emulator
