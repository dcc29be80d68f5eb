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

TEST(SetupStatus, SaysWhatToDo) {
  for (int i = 0; i <= static_cast<int>(SetupStatus::stop_not_obeyed); ++i)
    EXPECT_NE(to_string(static_cast<SetupStatus>(i)), "unknown set-up status");
}

}  // namespace
}  // namespace breakaway::odrive
