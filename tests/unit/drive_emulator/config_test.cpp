#include <functional>
#include <limits>
#include <string>

#include "drive_bench.hpp"

namespace breakaway::drive_emulator {
namespace {

TEST(EmulatorConfig, DefaultIsValid) { EXPECT_NO_THROW(validate(EmulatorConfig{})); }

TEST(EmulatorConfig, NamesTheMemberThatIsOutOfRange) {
  struct Row {
    std::string member;
    std::function<void(EmulatorConfig&)> spoil;
  };
  const Row rows[] = {
      {"node_id", [](EmulatorConfig& c) { c.node_id = 0; }},
      {"node_id", [](EmulatorConfig& c) { c.node_id = 128; }},
      {"rated_torque_mNm", [](EmulatorConfig& c) { c.rated_torque_mNm = 0; }},
      {"rated_current_mA", [](EmulatorConfig& c) { c.rated_current_mA = 0; }},
      {"max_torque_per_mille", [](EmulatorConfig& c) { c.max_torque_per_mille = 0; }},
      {"force_per_torque_N_per_Nm", [](EmulatorConfig& c) { c.force_per_torque_N_per_Nm = 0; }},
      {"force_per_torque_N_per_Nm",
       [](EmulatorConfig& c) { c.force_per_torque_N_per_Nm = std::numeric_limits<double>::quiet_NaN(); }},
      {"peak_force_N", [](EmulatorConfig& c) { c.peak_force_N = -1; }},
      {"current_loop_time_constant_s", [](EmulatorConfig& c) { c.current_loop_time_constant_s = -1e-9; }},
      {"encoder_resolution_m", [](EmulatorConfig& c) { c.encoder_resolution_m = 0; }},
      {"min_tpdo_delay", [](EmulatorConfig& c) { c.min_tpdo_delay = milliseconds{2}; }},
      {"sdo_response_delay", [](EmulatorConfig& c) { c.sdo_response_delay = milliseconds{-1}; }},
      {"sdo_timeout", [](EmulatorConfig& c) { c.sdo_timeout = milliseconds{0}; }},
      {"error_behaviour", [](EmulatorConfig& c) { c.error_behaviour = 3; }},
      {"informs_every", [](EmulatorConfig& c) { c.quirks.informs_every = {}; }},
      {"valid_pdos", [](EmulatorConfig& c) { c.valid_pdos = 5; }},
  };
  for (const Row& row : rows) {
    EmulatorConfig config;
    row.spoil(config);
    try {
      validate(config);
      ADD_FAILURE() << row.member << " was accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string{error.what()}.find(row.member), std::string::npos) << error.what();
    }
  }
}

TEST(EmulatorConfig, EmulatorRefusesABadOne) {
  EmulatorConfig config;
  config.node_id = 0;
  BenchMechanism mechanism;
  EXPECT_THROW(DriveEmulator(config, mechanism, [](const hal::CanFrame&, hal::Time) {}), InputError);
}

}  // namespace
}  // namespace breakaway::drive_emulator
