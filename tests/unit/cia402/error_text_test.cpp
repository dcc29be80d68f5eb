// What a user reads when a drive cannot be used.
#include <gtest/gtest.h>

#include "../explained_enum.hpp"
#include "breakaway/cia402/drive_config.hpp"
#include "breakaway/cia402/setup_status.hpp"

namespace breakaway::cia402 {
namespace {

TEST(DriveConfigError, NamesTheFieldAndWhatItMustBe) {
  using E = DriveConfigError;
  test::expect_sentences<E>(
      {{E::none, {"can be used"}},
       {E::node_id, {"drive's node_id must be 1 to 127"}},
       {E::master_node_id, {"master's node_id must be 1 to 127", "another than the drive's"}},
       {E::heartbeat_period, {"heartbeat_period must be 1 to 65535 ms"}},
       {E::heartbeat_timeout, {"heartbeat_timeout must be longer than", "heartbeat_period", "at most 65535 ms"}},
       {E::master_heartbeat_period, {"master's heartbeat_period must be 0 or at least two periods"}},
       {E::sdo_timeout, {"sdo_timeout must be above 0"}},
       {E::homing_timeout, {"homing.timeout must be above 0"}},
       {E::emcy_information, {"emcy_information must hold codes of 0100h to FFFFh", "its class"}},
       {E::period, {"period must be 1 to 255 times 1 us"}},
       {E::encoder_resolution, {"encoder_resolution_m must be a finite number above 0"}},
       {E::force_per_torque, {"force_per_torque_N_per_Nm must be a finite number above 0"}},
       {E::max_force, {"max_force_N must be a finite number above 0"}}});
}

TEST(SetupStatus, NamesWhatIsWrongAndTheRemedy) {
  using S = SetupStatus;
  test::expect_sentences<S>(
      {{S::ready, {"is set up"}},
       {S::in_progress, {"is being set up", "wait"}},
       {S::no_answer, {"does not answer", "check its power", "wiring", "node_id", "bit rate"}},
       {S::config_invalid, {"configuration cannot be used", "cia402::check()"}},
       {S::not_a_cia402_drive, {"not a CiA 402 drive", "1000h", "check node_id"}},
       {S::no_torque_mode, {"no cyclic synchronous torque mode", "6502h", "take a drive"}},
       {S::no_homing_mode, {"no homing mode", "6502h, bit 5", "home = \"here\""}},
       {S::mode_refused, {"refuses the cyclic synchronous torque mode", "6061h", "end what else commands it"}},
       {S::no_rated_torque, {"no rated torque", "6076h", "set up the motor's data"}},
       {S::rated_torque_differs, {"another rated torque", "6076h", "rated_torque_Nm", "correct the one"}},
       {S::rated_torque_unit,
        {"6076h", "a thousand times rated_torque_Nm or a thousandth", "another unit", "set the drive"}},
       {S::no_max_torque, {"no torque", "6072h", "set up the motor's data"}},
       {S::object_refused, {"refuses an object", "its manual says why"}},
       {S::value_not_kept, {"does not keep the value", "end what else writes to it", "its manual"}},
       {S::protocol_error, {"CiA 301 forbids", "look for a second node"}},
       {S::force_step_too_coarse, {"steps of force larger than max_force_N", "raise max_force_N", "6076h"}},
       {S::torque_base_differs, {"6072h", "torque_relative_to = \"max\"", "raise 6072h", "lower max_force_N"}},
       {S::position_reversed, {"607Eh", "invert_direction"}},
       {S::position_wraps, {"607Bh", "set both of its limits to 0"}},
       {S::position_scaled, {"608Fh, 6091h, 6092h", "one unit a count", "position_unit = \"user\""}},
       {S::position_too_fine, {"finer than its encoder's counts", "encoder_resolution_m"}},
       {S::stop_not_obeyed, {"does not obey a stop", "switch its power off", "look for what else commands it"}}});
}

}  // namespace
}  // namespace breakaway::cia402
