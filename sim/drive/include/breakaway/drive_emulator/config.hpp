// EmulatorConfig: the drive and motor that a drive emulator stands for.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/cia402/objects.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::drive_emulator {

// What a drive finds its home by, in metres of the axis as the drive counts it.
struct HomeSwitches {
  double low_limit_m = -HUGE_VAL, high_limit_m = HUGE_VAL;  // limit switches, on from here outwards
  double home_m = HUGE_VAL;                                 // of the home switch's edge, or of its lower one
  double home_width_m = 0.02;                               // of one that is on between two edges, > 0
  double index_distance_m = 1e-3;                           // between two index pulses, > 0
  double speed_gain_Ns_per_m = 200;                         // of the drive's loop of speed, > 0
};

enum class FixedMapping : std::uint8_t {
  none,
  fits,     // controlword and target torque; statusword, position and torque
  differs,  // what CiA 301 maps at power-on
};

// Departures from the profile that drives in the field are known for. All are off by default.
struct Quirks {
  // 6061h shows -1, and no torque is made, for so long after a mode was requested.
  hal::Duration mode_display_delay{};
  // The drive refuses to leave Switched on while 6060h is 0.
  bool needs_mode_to_enable = false;
  // The drive misses a controlword that differs sooner than this after the last change.
  hal::Duration min_controlword_interval{};
  // Operation enabled falls back to Switched on at this time, unannounced; the drive then waits for a controlword
  // without `enable operation`.
  std::optional<hal::Time> silent_drop_at{};
  // Fault 8700h comes when SYNC is late by so many periods (1006h); 0: never.
  std::uint32_t sync_alarm_periods = 0;
  // 6071h counts in per mille of 6072h's torque, not of the rated torque.
  bool torque_relative_to_max = false;
  // 60C2h:02 accepts -3 only.
  bool interpolation_in_ms_only = false;
  // 607Eh reverses the position at power-on, and not the torque.
  bool position_reversed = false;
  // 607Bh keeps 6064h in 0..n - 1 at power-on; 0: it does not.
  std::uint32_t position_range_counts = 0;
  // 6092h:01 at power-on, units of 6064h a revolution of `encoder_counts_per_revolution`; 0: as many as those.
  std::uint32_t feed_constant = 0;
  // SDO answers take so long; 0: as EmulatorConfig says.
  hal::Duration sdo_response_delay{};
  // For so long after its boot-up every SDO transfer is refused with 0800'0022h.
  hal::Duration sdo_busy{};
  // With these the drive plays the homing methods that move, too; without only 35 and 37.
  std::optional<HomeSwitches> switches{};
  // A homing that is started ends with an error.
  bool homing_fails = false;
  // An axis that is still in a homing that moves when this much time is over: the homing ends with an error; 0: never.
  hal::Duration homing_gives_up_after{};
  // The node goes on to Operational by itself after its boot-up.
  bool self_starting = false;
  // PDOs may be changed in Pre-operational only.
  bool maps_in_pre_operational_only = false;
  // What the first RPDO and TPDO carry cannot be changed.
  FixedMapping fixed_mapping = FixedMapping::none;
  // SDO transfers of these objects are refused with this code, whatever they ask for: 0504'0001h of a server that
  // wants another kind of transfer.
  std::vector<double> refused_objects{};
  std::uint32_t refusal_code = 0x0800'0000;
  // NMT Start is answered by an EMCY with this code, and the node stays where it is; 0: it starts.
  std::uint16_t refuses_start_with = 0;
  // An EMCY with this code is sent in Operation enabled, at once and at this interval, and is no error; 0: none is.
  std::uint16_t informs_with = 0;
  hal::Duration informs_every = std::chrono::milliseconds{100};  // > 0
  // There is no boot-up message.
  bool no_boot_up_message = false;
  // The encoder is incremental: 6064h is 0 where the axis stands at power-on and at NMT Reset node.
  bool counts_from_power_on = false;
};

// 608Fh:01 of every emulated drive.
inline constexpr std::uint32_t encoder_counts_per_revolution = 10'000;

struct EmulatorConfig {
  std::uint8_t node_id = 1;                              // 1..127
  std::string device_name = "breakaway drive emulator";  // 1008h

  std::uint32_t rated_torque_mNm = 1000;      // 6076h, > 0; torques are per mille of it
  std::uint32_t rated_current_mA = 1000;      // 6075h, > 0
  std::uint16_t max_torque_per_mille = 3000;  // 6072h at power-on, per mille of the rated torque
  double force_per_torque_N_per_Nm = 1.0;     // the transmission, > 0
  std::optional<double> peak_force_N{};       // the most that the motor can do, > 0; default: max_torque_per_mille
  double current_loop_time_constant_s = 0.0;  // of the first-order lag from demand to force, >= 0; 0: ideal
  double encoder_resolution_m = 1e-6;         // one count, > 0
  // 6502h; without bit 9 the drive makes no torque, and without bit 5 it finds no home.
  std::uint32_t supported_modes = cia402::supports_cyclic_torque | cia402::supports_homing;

  // A TPDO leaves between min and max after the SYNC or event that asks for it, uniformly distributed.
  hal::Duration min_tpdo_delay = std::chrono::microseconds{20};
  hal::Duration max_tpdo_delay = std::chrono::microseconds{20};
  std::uint64_t seed = 1;  // of the TPDO delays
  hal::Duration sdo_response_delay = std::chrono::microseconds{200};
  hal::Duration sdo_timeout = std::chrono::seconds{1};         // a segmented transfer that pauses longer is aborted
  hal::Duration boot_duration = std::chrono::milliseconds{5};  // from power-on or reset until the boot-up message
  hal::Duration stop_duration = std::chrono::milliseconds{1};  // quick stop and fault reaction last so long
  std::uint16_t producer_heartbeat_ms = 0;                     // 1017h at power-on
  // 1029h:01 at power-on: on a communication error 0 enters pre-operational, 1 keeps the state, 2 stops.
  std::uint8_t error_behaviour = 0;
  unsigned valid_pdos = 1;  // RPDO1..n and TPDO1..n exist at power-on, 0..4
  Quirks quirks{};
};

// Throws InputError that names the first member outside its range.
void validate(const EmulatorConfig& config);

}  // namespace breakaway::drive_emulator
