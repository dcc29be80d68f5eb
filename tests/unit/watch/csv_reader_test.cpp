#include "breakaway/watch/csv_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../refusal.hpp"

namespace {

using namespace breakaway;
using breakaway::testing::refusal;
using watch::CsvReader;
using watch::Sample;

constexpr const char* node_header =
    "time_s,latency_us,target_m,position_m,command_N,reported_N,mode,drive,fault,fault_code,axis";

TEST(WatchCsv, ReadsALineOfTheNode) {
  const Sample s = CsvReader{node_header}.read(
      "1763870000.123456,4.200,0.25,0.24999,12.5,-3,kick,enabled,drive emergency,2310,gantry");
  EXPECT_EQ(s.axis, "gantry");
  EXPECT_DOUBLE_EQ(s.time_s, 1763870000.123456);
  EXPECT_DOUBLE_EQ(s.latency_us, 4.2);
  EXPECT_DOUBLE_EQ(s.target_m, 0.25);
  EXPECT_DOUBLE_EQ(s.position_m, 0.24999);
  EXPECT_DOUBLE_EQ(s.command_N, 12.5);
  EXPECT_DOUBLE_EQ(s.reported_N, -3);
  EXPECT_EQ(s.mode, law::Mode::kick);
  EXPECT_EQ(s.drive, hal::DriveState::enabled);
  EXPECT_EQ(s.fault, firmware::AxisFault::emergency);
  EXPECT_EQ(s.fault_code, 0x2310);
  EXPECT_TRUE(std::isnan(s.bus_load));
}

TEST(WatchCsv, ReadsALineOfASimulation) {
  const CsvReader reader{"time_s,position_m,velocity_m_s,target_m,force_N,friction_level_N,bus_load,mode\r"};
  const Sample s = reader.read("0.001,-4,0.5,0,49.975000000000001,nan,0.33,approach\r");
  EXPECT_EQ(s.axis, "");
  EXPECT_DOUBLE_EQ(s.time_s, 0.001);
  EXPECT_DOUBLE_EQ(s.position_m, -4);
  EXPECT_DOUBLE_EQ(s.reported_N, 49.975);
  EXPECT_DOUBLE_EQ(s.bus_load, 0.33);
  EXPECT_EQ(s.mode, law::Mode::approach);
  EXPECT_FALSE(s.drive);
  EXPECT_TRUE(std::isnan(s.command_N));
}

TEST(WatchCsv, ADashIsAModeThatIsNotKnown) { EXPECT_FALSE(CsvReader{"time_s,position_m,mode"}.read("1,2,-").mode); }

TEST(WatchCsv, EveryNameOfModeDriveAndFaultIsReadBack) {
  const CsvReader reader{"time_s,position_m,mode,drive,fault"};
  for (int n = 0; const auto fault = watch::enumerator<firmware::AxisFault>(n); ++n)
    EXPECT_EQ(reader.read("1,2,hold,homing," + std::string{to_string(*fault)}).fault, fault);
  EXPECT_TRUE(watch::enumerator<firmware::AxisFault>(static_cast<int>(firmware::AxisFault::external_motion)));
  EXPECT_EQ(reader.read("1,2,fault,homing,none").drive, hal::DriveState::homing);
}

TEST(WatchCsv, LinesThatDoNotFitSayWhatIsWrong) {
  const CsvReader reader{"time_s,position_m,mode,fault_code"};
  const auto refused = [&](const std::string& line) { return refusal([&] { static_cast<void>(reader.read(line)); }); };
  EXPECT_EQ(refused("1,2,hold,0000"), "");
  EXPECT_NE(refused("1,2,hold").find("has 3 columns, and the first line names 4"), std::string::npos);
  EXPECT_NE(refused("").find("has 1 columns"), std::string::npos);
  EXPECT_NE(refused("1,two,hold,0000").find("position_m is \"two\", not a number"), std::string::npos);
  EXPECT_NE(refused("1,2 ,hold,0000").find("position_m"), std::string::npos);
  EXPECT_NE(refused("1,,hold,0000").find("position_m"), std::string::npos);
  EXPECT_NE(refused("nan,2,hold,0000").find("not a finite number"), std::string::npos);
  EXPECT_NE(refused("1,inf,hold,0000").find("not a finite number"), std::string::npos);
  EXPECT_NE(refused("1,2,flying,0000").find("mode is \"flying\""), std::string::npos);
  EXPECT_NE(refused("1,2,hold,12345").find("fault_code"), std::string::npos);
}

TEST(WatchCsv, AFileThatIsNoRunIsRefusedByItsFirstLine) {
  for (const char* header : {"", "time,position", "time_s,q1,v1,slides1",
                             "\x7f"
                             "ELF"})
    EXPECT_NE(refusal([&] { CsvReader{header}; }).find("breakaway-node --csv"), std::string::npos) << header;
}

// Spreadsheets write one.
TEST(WatchCsv, AByteOrderMarkIsPassedOver) {
  EXPECT_DOUBLE_EQ(CsvReader{"\xEF\xBB\xBFtime_s,position_m"}.read("1,2").time_s, 1);
}

TEST(WatchCsv, AColumnThatStandsTwiceIsRefusedByName) {
  EXPECT_NE(refusal([] { CsvReader{"time_s,position_m,position_m"}; }).find("more than one column position_m"),
            std::string::npos);
  EXPECT_EQ(refusal([] { CsvReader{"time_s,position_m,,"}; }), "") << "without names they are passed over";
}

}  // namespace
