// SetupStatus: how the set-up of a drive stands, and what to do when it does not come to its end.
#pragma once

#include <cstdint>
#include <string_view>

namespace breakaway::cia402 {

enum class SetupStatus : std::uint8_t {
  ready,
  in_progress,
  no_answer,              // an SDO transfer was not answered; the drive is waited for, and set up when it comes
  config_invalid,         // check() refuses what the drive was configured with
  not_a_cia402_drive,     // 1000h shows another device profile
  no_torque_mode,         // 6502h lacks cyclic synchronous torque
  no_homing_mode,         // the file has the drive find its home, and 6502h lacks homing or 6061h never showed it
  mode_refused,           // 6061h never showed cyclic synchronous torque
  no_rated_torque,        // 6076h is 0, so there is no unit to command torque in
  rated_torque_differs,   // 6076h is not what the axis was described with
  rated_torque_unit,      // 6076h is that times a thousand, or a thousandth of it
  no_max_torque,          // 6072h is 0
  object_refused,         // the drive aborted a transfer that it must not abort
  value_not_kept,         // an object that was written shows another value, and must not
  protocol_error,         // the drive answered a transfer with what CiA 301 forbids
  force_step_too_coarse,  // one per mille of the rated torque is more than the axis' force limit
  torque_base_differs,    // the file says that 6071h counts in 6072h, and that is not the axis' limit
  position_reversed,      // 607Eh reverses the position, and not the torque
  position_wraps,         // 607Bh keeps the position within a range
  position_scaled,        // 608Fh, 6091h, 6092h: a unit of 6064h is no encoder count, and the file does not expect it
  position_too_fine,      // they make a unit of 6064h a fraction of an encoder count
  stop_not_obeyed,        // the drive was told to stop and is not seen without force; it is told by other means
};

constexpr std::string_view to_string(SetupStatus status) noexcept {
  switch (status) {
    case SetupStatus::ready:
      return "the drive is set up";
    case SetupStatus::in_progress:
      return "the drive is being set up; wait";
    case SetupStatus::no_answer:
      return "the drive does not answer; check its power, the wiring, node_id and the bit rate";
    case SetupStatus::config_invalid:
      return "the drive's configuration cannot be used; cia402::check() names the field";
    case SetupStatus::not_a_cia402_drive:
      return "the node is not a CiA 402 drive (1000h); check node_id";
    case SetupStatus::no_torque_mode:
      return "the drive has no cyclic synchronous torque mode (6502h, bit 9); take a drive, or a firmware of it, that "
             "has";
    case SetupStatus::no_homing_mode:
      return "the drive has no homing mode, or refuses it (6502h, bit 5; 6061h never showed 6); let it stand at its "
             "home when it is enabled (home = \"here\"), or end what else commands it";
    case SetupStatus::mode_refused:
      return "the drive refuses the cyclic synchronous torque mode (6061h never showed 10); end what else commands it, "
             "its commissioning software, say, and look for an interlock on the mode in its manual";
    case SetupStatus::no_rated_torque:
      return "the drive states no rated torque (6076h is 0); set up the motor's data in the drive first";
    case SetupStatus::rated_torque_differs:
      return "the drive states another rated torque (6076h) than rated_torque_Nm; correct the one that is wrong";
    case SetupStatus::rated_torque_unit:
      return "the drive states a rated torque (6076h) that is a thousand times rated_torque_Nm or a thousandth of it, "
             "so "
             "one of the two is in another unit; set the drive to mNm, or give rated_torque_Nm as the drive has it and "
             "correct force_per_torque_N_per_Nm by the same factor";
    case SetupStatus::no_max_torque:
      return "the drive allows no torque (6072h is 0); set up the motor's data in the drive first";
    case SetupStatus::object_refused:
      return "the drive refuses an object of the set-up; its manual says why";
    case SetupStatus::value_not_kept:
      return "the drive does not keep the value that the set-up writes to an object; end what else writes to it, and "
             "look in its manual for what fixes it";
    case SetupStatus::protocol_error:
      return "the drive answers the set-up with what CiA 301 forbids; look for a second node with its node_id";
    case SetupStatus::force_step_too_coarse:
      return "the drive moves in steps of force larger than max_force_N; raise max_force_N, or take a drive of a lower "
             "rated torque (6076h)";
    case SetupStatus::torque_base_differs:
      return "the drive's largest torque (6072h) is not the axis' limit, and cannot be lowered to it, so that a target "
             "torque that counts in it (torque_relative_to = \"max\") is not the force that the axis was designed for; "
             "raise 6072h to max_force_N, or lower max_force_N";
    case SetupStatus::position_reversed:
      return "the drive reverses its position, and not its torque (607Eh); set 607Eh to 0, and use invert_direction";
    case SetupStatus::position_wraps:
      return "the drive keeps its position within a range (607Bh); set both of its limits to 0";
    case SetupStatus::position_scaled:
      return "the drive scales its position (608Fh, 6091h, 6092h), so that a unit of 6064h is no encoder count; set "
             "its factor group to one unit a count, or, where encoder_resolution_m is the travel of such a unit, say "
             "position_unit = \"user\"";
    case SetupStatus::position_too_fine:
      return "the drive shows its position in units that are finer than its encoder's counts (608Fh, 6091h, 6092h), so "
             "that its readings jump; set its factor group so that a unit is a count or several, and "
             "encoder_resolution_m to the travel of a unit";
    case SetupStatus::stop_not_obeyed:
      return "the drive does not obey a stop, and is told again by SDO and NMT, and then kept from PDOs until a reset; "
             "switch its power off where force must not stay on, and look for what else commands it";
  }
  return "unknown set-up status";
}

}  // namespace breakaway::cia402
