#include <functional>
#include <limits>
#include <string>

#include "drive_bench.hpp"

namespace breakaway::drive {
namespace {

TEST(DriveConfig, DefaultIsValid) { EXPECT_NO_THROW(validate(DriveConfig{})); }

TEST(DriveConfig, NamesTheMemberThatIsOutOfRange) {
  struct Row {
    std::string member;
    std::function<void(DriveConfig&)> spoil;
  };
  const Row rows[] = {
      {"node_id", [](DriveConfig& c) { c.node_id = 0; }},
      {"node_id", [](DriveConfig& c) { c.node_id = 128; }},
      {"rated_torque_mNm", [](DriveConfig& c) { c.rated_torque_mNm = 0; }},
      {"rated_current_mA", [](DriveConfig& c) { c.rated_current_mA = 0; }},
      {"max_torque_per_mille", [](DriveConfig& c) { c.max_torque_per_mille = 0; }},
      {"force_per_torque_N_per_Nm", [](DriveConfig& c) { c.force_per_torque_N_per_Nm = 0; }},
      {"force_per_torque_N_per_Nm",
       [](DriveConfig& c) { c.force_per_torque_N_per_Nm = std::numeric_limits<double>::quiet_NaN(); }},
      {"peak_force_N", [](DriveConfig& c) { c.peak_force_N = -1; }},
      {"current_loop_time_constant_s", [](DriveConfig& c) { c.current_loop_time_constant_s = -1e-9; }},
      {"encoder_resolution_m", [](DriveConfig& c) { c.encoder_resolution_m = 0; }},
      {"min_tpdo_delay", [](DriveConfig& c) { c.min_tpdo_delay = milliseconds{2}; }},
      {"sdo_response_delay", [](DriveConfig& c) { c.sdo_response_delay = milliseconds{-1}; }},
      {"sdo_timeout", [](DriveConfig& c) { c.sdo_timeout = milliseconds{0}; }},
      {"error_behaviour", [](DriveConfig& c) { c.error_behaviour = 3; }},
      {"valid_pdos", [](DriveConfig& c) { c.valid_pdos = 5; }},
  };
  for (const Row& row : rows) {
    DriveConfig config;
    row.spoil(config);
    try {
      validate(config);
      ADD_FAILURE() << row.member << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string{error.what()}.find(row.member), std::string::npos) << error.what();
    }
  }
}

TEST(DriveConfig, EmulatorRefusesABadOne) {
  DriveConfig config;
  config.node_id = 0;
  BenchMechanism mechanism;
  EXPECT_THROW(DriveEmulator(config, mechanism, [](const hal::CanFrame&, hal::Time) {}), std::invalid_argument);
}

}  // namespace
}  // namespace breakaway::drive
