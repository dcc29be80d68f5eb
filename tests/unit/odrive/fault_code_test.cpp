#include "breakaway/odrive/fault_code.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "breakaway/odrive/setup_status.hpp"

namespace breakaway::odrive {
namespace {

TEST(FaultCode, NamesEveryErrorBitOfFirmware06) {
  std::set<std::string_view> names;
  for (const unsigned bit :
       {0U, 1U, 2U, 3U, 4U, 5U, 6U, 8U, 9U, 10U, 11U, 12U, 13U, 14U, 15U, 16U, 24U, 25U, 26U, 27U, 28U, 30U}) {
    const auto name = fault_text(error_code(1U << bit));
    EXPECT_EQ(name.find("does not know"), name.npos) << bit;
    EXPECT_TRUE(names.insert(name).second) << name;
  }
  EXPECT_NE(fault_text(error_code(error::watchdog_timer_expired)).find("watchdog"), std::string_view::npos);
  EXPECT_NE(fault_text(error_code(error::estop_requested)).find("emergency stop"), std::string_view::npos);
}

TEST(FaultCode, NamesTheLowestOfSeveralBitsAndKeepsUnknownOnes) {
  EXPECT_EQ(error_code(error::watchdog_timer_expired | error::missing_input), error_code(error::missing_input));
  EXPECT_EQ(error_code(0), 0);
  EXPECT_EQ(error_code(1U << 31U), 32);
  EXPECT_NE(fault_text(32).find("does not know"), std::string_view::npos);
}

TEST(FaultCode, HasATextForEveryNumber) {
  for (unsigned code = 0; code <= 0xFFFF; ++code) EXPECT_FALSE(fault_text(static_cast<std::uint16_t>(code)).empty());
  EXPECT_NE(fault_text(procedure_code(14)).find("not calibrated"), std::string_view::npos);
  EXPECT_NE(fault_text(procedure_code(200)).find("procedure_result"), std::string_view::npos);
}

TEST(FaultCode, TellsTheDrivesErrorsResultsAndOwnFaultsApart) {
  EXPECT_EQ(error_code(1), 1);
  EXPECT_EQ(procedure_code(0), 0x100);
  EXPECT_EQ(procedure_code(255), 0x1FF);
  const auto has = [](unsigned code, std::string_view words) {
    return fault_text(static_cast<std::uint16_t>(code)).find(words) != std::string_view::npos;
  };
  EXPECT_EQ(fault_text(0), "no error");
  EXPECT_TRUE(has(1, "still starts"));
  EXPECT_TRUE(has(31, "calibration"));
  EXPECT_EQ(fault_text(33), "unknown error");
  EXPECT_EQ(fault_text(0xFF), "unknown error");
  EXPECT_TRUE(has(0x100, "procedure_result"));
  EXPECT_TRUE(has(0x103, "disarmed"));
  EXPECT_TRUE(has(0x10F, "converge"));
  EXPECT_TRUE(has(0x110, "procedure_result"));
  EXPECT_TRUE(has(0x1FF, "procedure_result"));
  EXPECT_EQ(fault_text(0x200), "unknown error");
  EXPECT_TRUE(has(static_cast<unsigned>(OwnFault::position_not_a_number), "position that is not a number"));
  EXPECT_TRUE(has(static_cast<unsigned>(OwnFault::position_too_coarse), "coarser than encoder_resolution_m"));
  EXPECT_TRUE(has(static_cast<unsigned>(OwnFault::torque_not_a_number), "torque that is not a number"));
  EXPECT_TRUE(has(static_cast<unsigned>(OwnFault::torque_not_reported), "torques_msg_rate_ms"));
  EXPECT_EQ(fault_text(0x205), "unknown error");
}

TEST(SetupStatus, SaysWhatToDo) {
  struct Row {
    SetupStatus status;
    std::string_view words;
  };
  for (const Row& row :
       {Row{SetupStatus::ready, "is set up"}, Row{SetupStatus::no_heartbeat, "heartbeat_msg_rate_ms"},
        Row{SetupStatus::starting, "still starts"}, Row{SetupStatus::no_version, "Get_Version"},
        Row{SetupStatus::no_estimates, "encoder_msg_rate_ms"}, Row{SetupStatus::being_told, "being set up"},
        Row{SetupStatus::config_invalid, "check()"}, Row{SetupStatus::firmware_too_old, "older than 0.6"},
        Row{SetupStatus::force_step_too_coarse, "max_force_N"}, Row{SetupStatus::stop_not_obeyed, "power off"}})
    EXPECT_NE(to_string(row.status).find(row.words), std::string_view::npos) << row.words;
  EXPECT_EQ(to_string(static_cast<SetupStatus>(200)), "unknown set-up status");
}

}  // namespace
}  // namespace breakaway::odrive
