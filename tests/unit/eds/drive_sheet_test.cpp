// [drive] eds: a drive's data sheet is held against the set-up, stands in for what the file leaves out, and is played
// by the emulated drive. The sheet is one that was written here, spoilt.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "../scratch_folder.hpp"
#include "breakaway/config/data_sheet.hpp"
#include "breakaway/config/drive_sheet.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/eds/to_eds.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"

namespace breakaway::config {
namespace {

const std::string scene_file = BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

// Of the drive of can_axis.toml.
std::string written_sheet() {
  const auto scene = scenario::read_scenario(scene_file);
  return eds::to_eds(eds::drive_device(*scene.worlds.front().drive), "drive.eds",
                     std::chrono::system_clock::from_time_t(0));
}

// A section with its heading, from "[name]" to the next one.
std::string section_of(const std::string& sheet, const std::string& name) {
  const std::size_t begin = sheet.find("[" + name + "]\n");
  EXPECT_NE(begin, std::string::npos) << name;
  return sheet.substr(begin, sheet.find("\n[", begin) + 1 - begin);
}

std::string with_line(const std::string& sheet, const std::string& section, const std::string& line) {
  const std::string before = section_of(sheet, section), key = line.substr(0, line.find('=') + 1);
  std::string after = before;
  const std::size_t at = after.find("\n" + key);
  if (at == std::string::npos)
    after.insert(after.find('\n') + 1, line + "\n");
  else
    after.replace(at + 1, after.find('\n', at + 1) - at - 1, line);
  return replaced(sheet, before, after);
}

std::string without(const std::string& sheet, const std::string& object) {
  std::string text = replaced(sheet, section_of(sheet, object), "");
  const std::size_t at = text.find("=0x" + object + "\n"), line = text.rfind('\n', at) + 1;
  return text.erase(line, text.find('\n', line) + 1 - line);
}

class DriveSheet : public breakaway::testing::ScratchFolder {
 protected:
  scenario::Scenario scene(const std::string& sheet, const std::string& rows = "") const {
    std::ofstream{path("drive.eds")} << sheet;
    std::string text = file_contents(scene_file);
    for (const char* key : {"rated_torque_Nm", "max_torque_per_mille"}) {
      const std::size_t at = text.find(key);
      text.erase(at, text.find('\n', at) + 1 - at);
    }
    text.insert(text.find('\n', text.find("\n[drive]") + 1) + 1, "eds = \"drive.eds\"\n" + rows);
    std::ofstream{path("axis.toml")} << text;
    return scenario::read_scenario(path("axis.toml"));
  }
  std::string said(const std::string& sheet, const std::string& rows = "") const {
    return breakaway::testing::refusal([&] { static_cast<void>(scene(sheet, rows)); });
  }
  void expect_said(const std::string& sheet, const std::string& words, const std::string& rows = "") const {
    const std::string sentence = said(sheet, rows);
    EXPECT_NE(sentence.find(words), std::string::npos) << words << ": " << sentence;
    EXPECT_EQ(sentence.find('\n'), std::string::npos);
  }
};

TEST_F(DriveSheet, StandsInForWhatTheFileLeavesOutAndTheAxisRunsAsBefore) {
  const auto before = scenario::read_scenario(scene_file), with_sheet = scene(written_sheet());
  const Drive &told = *before.node.axes[0].drive, &taken = *with_sheet.node.axes[0].drive;
  EXPECT_EQ(taken.rated_torque_mNm, told.rated_torque_mNm);
  EXPECT_EQ(taken.max_torque_per_mille, told.max_torque_per_mille);
  const auto first = sil::run_loop_scenario(before, {}), second = sil::run_loop_scenario(with_sheet, {});
  EXPECT_TRUE(second.axes[0].settled);
  EXPECT_EQ(first.axes[0].final_error_m, second.axes[0].final_error_m);
  EXPECT_EQ(first.axes[0].settling_time_s, second.axes[0].settling_time_s);
}

TEST_F(DriveSheet, NamesWhatTheDriveLacks) {
  const std::string sheet = written_sheet();
  expect_said(without(sheet, "6071"), "drive.eds has no 6071h: every period exchanges it");
  expect_said(without(sheet, "6060"), "drive.eds has no 6060h: the drive is not set up without it");
  expect_said(replaced(sheet, section_of(sheet, "6077"), ""), "drive.eds lists and does not describe 6077h");
  expect_said(with_line(sheet, "6060", "AccessType=ro"), "lets 6060h not be written");
  expect_said(with_line(sheet, "6502", "AccessType=wo"), "lets 6502h not be read");
  expect_said(with_line(sheet, "6060", "HighLimit=9"), "lets 6060h not be 10");
  expect_said(with_line(sheet, "6060", "LowLimit=11"), "lets 6060h not be 10");
  expect_said(with_line(sheet, "6064", "PDOMapping=0"), "lets 6064h not be mapped into a PDO");
  expect_said(with_line(sheet, "6071", "DataType=0x0004"), "has 4 bytes for 6071h, which has 2");
  expect_said(with_line(sheet, "6060", "DataType=0x0003"), "has 2 bytes for 6060h, which has 1");
  expect_said(with_line(sheet, "6502", "DefaultValue=0x1FF"), "no cyclic synchronous torque mode");
  expect_said(with_line(sheet, "1000", "DefaultValue=401"), "device profile 401");
  expect_said(with_line(sheet, "DeviceInfo", "BaudRate_1000=0"), "does not have 1000 kbit/s");
  for (const char* section : {"1800sub1", "1600sub2", "1A00sub3", "1400sub2"}) {
    const std::string shown = std::string{section}.substr(0, 4) + "h:0" + section[7];
    expect_said(replaced(sheet, section_of(sheet, section), ""), "has no " + shown);
  }
  EXPECT_EQ(said(with_line(sheet, "6060", "HighLimit=10")), "");
  EXPECT_EQ(said(with_line(sheet, "6060", "LowLimit=-1")), "");
}

TEST_F(DriveSheet, ContradictingTheFileIsRefused) {
  const std::string sheet = written_sheet(), set = "\n[DeviceComissioning]\nNodeID=5\nBaudrate=1000\n";
  expect_said(sheet, "has 0.5 for rated_torque_Nm, in 6076h, where the file has 0.7", "rated_torque_Nm = 0.7\n");
  EXPECT_EQ(said(sheet, "rated_torque_Nm = 0.504\n"), "") << "within a hundredth, as the drive's set-up compares it";
  EXPECT_EQ(scene(sheet + set).node.axes[0].drive->node_id, 5);
  EXPECT_EQ(scene(sheet + set).worlds[0].drive->node_id, 5);
  expect_said(sheet + set, "has 5 for node_id", "node_id = 4\n");
  expect_said(sheet + replaced(set, "1000", "500"), "has the drive set to 500 kbit/s");
  expect_said(with_line(sheet, "6076", "DefaultValue="), "rated_torque_Nm is missing, and " + path("drive.eds"));
  EXPECT_EQ(said(with_line(sheet, "6076", "DefaultValue="), "rated_torque_Nm = 0.5\n"), "");
  // A DCF says how the drive is set, beside what it is by default.
  const auto raised = scene(with_line(sheet, "6072", "ParameterValue=3000"));
  EXPECT_EQ(raised.node.axes[0].drive->max_torque_per_mille, 3000);
}

TEST_F(DriveSheet, IsPlayedByTheEmulatedDrive) {
  std::string sheet = written_sheet();
  for (const char* object : {"60B2", "1006", "605B"}) sheet = without(sheet, object);
  sheet = with_line(sheet, "DeviceInfo", "ProductName=Another drive");
  const auto scene_without = scene(sheet);
  const auto& drive = *scene_without.worlds[0].drive;
  EXPECT_EQ(drive.device_name, "Another drive");
  EXPECT_EQ(drive.quirks.refused_objects, (std::vector<double>{0x60B2, 0x605B, 0x1006, 0x6007}))
      << "6007h is one that the emulated drive never had";
  EXPECT_EQ(drive.quirks.refusal_code, 0x0602'0000U);
  EXPECT_EQ(drive.quirks.fixed_mapping, drive_emulator::FixedMapping::none);
  EXPECT_TRUE(sil::run_loop_scenario(scene_without, {}).axes[0].settled);
}

TEST_F(DriveSheet, AFixedMappingIsTakenWhereItFits) {
  std::string sheet = written_sheet();
  for (const char* mapping : {"1600sub0", "1A00sub0"}) sheet = with_line(sheet, mapping, "AccessType=const");
  expect_said(sheet, "has a fixed 1600h that carries something other");
  for (const auto& [section, value] :
       {std::pair{"1600sub0", "2"}, std::pair{"1600sub1", "0x60400010"}, std::pair{"1600sub2", "0x60710010"},
        std::pair{"1A00sub0", "3"}, std::pair{"1A00sub1", "0x60410010"}, std::pair{"1A00sub2", "0x60640020"}})
    sheet = with_line(sheet, section, std::string{"DefaultValue="} + value);
  expect_said(with_line(sheet, "1A00sub3", "DefaultValue=0x60740010"), "has a fixed 1A00h");
  sheet = with_line(sheet, "1A00sub3", "DefaultValue=0x60770010");
  const auto fitting = scene(sheet);
  EXPECT_EQ(fitting.worlds[0].drive->quirks.fixed_mapping, drive_emulator::FixedMapping::fits);
  EXPECT_TRUE(sil::run_loop_scenario(fitting, {}).axes[0].settled);
  expect_said(with_line(with_line(sheet, "1800sub2", "AccessType=const"), "1800sub2", "DefaultValue=255"),
              "has a fixed 1800h:02, whose PDO does not follow every SYNC");
}

TEST_F(DriveSheet, ThatIsNoneIsRefusedByName) {
  const std::string sheet = written_sheet();
  expect_said("", "drive.eds: has no [DeviceInfo]");
  expect_said("a letter\n", "drive.eds: has no [DeviceInfo]");
  expect_said(sheet + "[6040]\n", "[6040] stands twice, first in line ");
  expect_said(sheet + "[6040\n", "a section's name does not end");
  expect_said(with_line(sheet, "6040", "AccessType=yes"), "AccessType = yes is none of ro, wo,");
  expect_said(with_line(sheet, "6040", "DataType=seven"), "datatype = seven is no whole number");
  expect_said(with_line(sheet, "6040", "DataType=-1"), "datatype = -1 is no whole number");
  expect_said(with_line(sheet, "6040", "PDOMapping=2"), "pdomapping = 2 is no whole number from 0 to 1");
  expect_said(sheet + "[6040subXY]\n", "a sub-index is one or two hexadecimal digits");
  std::filesystem::remove(path("drive.eds"));
  const std::string gone =
      breakaway::testing::refusal([&] { static_cast<void>(scenario::read_scenario(path("axis.toml"))); });
  EXPECT_NE(gone.find("drive.eds: cannot be read"), std::string::npos) << gone;
  const std::string scene = content(path("axis.toml"));
  const auto line = 1 + std::ranges::count(scene.substr(0, scene.find("\neds = ") + 1), '\n');
  EXPECT_TRUE(gone.starts_with(path("axis.toml") + ":" + std::to_string(line) + ": [drive] eds names ")) << gone;
}

// Makers' files differ in all that CiA 306 leaves open.
TEST(DataSheet, ReadsNumbersNamesAndLinesAsTheyAreWritten) {
  const DataSheet sheet = DataSheet::parse(
      "\xEF\xBB\xBF; a comment\r\n[DEVICEINFO]\r\nPRODUCTNAME = A drive \r\nBaudRate_500=1\r\n"
      "[DeviceComissioning]\r\nNodeID=0x05\r\nbroken comment\r\n"
      "[6060]\r\nDataType=0x2\r\nAccessType=RW\r\nDefaultValue=-3\r\n"
      "[6072]\r\nDataType=0006\r\nAccessType=ro\r\nDefaultValue=0x3E8\r\n"
      "[6075]\r\nDataType=7\r\nAccessType=const\r\nDefaultValue=010\r\nLowLimit=\r\nHighLimit=0x7F\r\n"
      "[1800sub1]\r\nDataType=7\r\nAccessType=rww\r\nDefaultValue=$NODEID+0x180\r\n"
      "[1400SUB1]\r\nDataType=7\r\nAccessType=rwr\r\nDefaultValue = 0x200 + $NodeID\r\n"
      "[1003]\r\nObjectType=8\r\nDataType=7\r\nAccessType=ro\r\nCompactSubObj=3\r\n"
      "[1003Value]\r\nNrOfEntries=1\r\n2=0x99\r\n"
      "[1018]\r\nObjectType=9\r\nSubNumber=2\r\n"
      "[6099sub1]\r\nDataType=8\r\nAccessType=wo\r\nDefaultValue=1.5\r\nPDOMapping=1",
      "a.eds");
  EXPECT_EQ(sheet.name(), "a.eds");
  EXPECT_EQ(sheet.product(), "A drive");
  EXPECT_EQ(sheet.node_id(), 5);
  EXPECT_EQ(sheet.bit_rate(), std::nullopt);
  EXPECT_TRUE(sheet.has_bit_rate(500'000));
  EXPECT_FALSE(sheet.has_bit_rate(1'000'000));
  EXPECT_EQ(sheet.value(0x6060, 0), 0xFFFF'FFFDU);
  EXPECT_TRUE(sheet.find(0x6060, 0)->writable && sheet.find(0x6060, 0)->readable);
  EXPECT_EQ(sheet.find(0x6060, 0)->bytes(), 1U);
  EXPECT_EQ(sheet.value(0x6072, 0), 1000U);
  EXPECT_FALSE(sheet.find(0x6072, 0)->writable);
  EXPECT_EQ(sheet.find(0x6072, 0)->bytes(), 2U);
  EXPECT_EQ(sheet.value(0x6075, 0), 8U);
  EXPECT_EQ(sheet.find(0x6075, 0)->least, std::nullopt);
  EXPECT_EQ(sheet.find(0x6075, 0)->most, 127);
  EXPECT_EQ(sheet.value(0x1800, 1), 0x185U);
  EXPECT_EQ(sheet.value(0x1400, 1), 0x205U);
  EXPECT_EQ(sheet.value(0x1003, 0), 3U);
  EXPECT_EQ(sheet.value(0x1003, 2), 0x99U);
  EXPECT_EQ(sheet.value(0x1003, 3), std::nullopt);
  EXPECT_NE(sheet.find(0x1003, 3), nullptr);
  EXPECT_EQ(sheet.find(0x1003, 4), nullptr);
  EXPECT_EQ(sheet.find(0x1018, 0), nullptr) << "a record has sections of its entries";
  EXPECT_FALSE(sheet.find(0x6099, 1)->readable);
  EXPECT_TRUE(sheet.find(0x6099, 1)->mappable);
  EXPECT_EQ(sheet.value(0x6099, 1), std::nullopt) << "no whole number";
  EXPECT_TRUE(DataSheet::parse("[DeviceInfo]\n", "b").has_bit_rate(20'000)) << "names none";
}

TEST_F(DriveSheet, SpoiltAnywhereIsReadOrRefusedInASentence) {
  const std::string sheet = written_sheet();
  std::mt19937 random{3};  // NOLINT: the same bytes every time
  for (int i = 0; i < 300; ++i) {
    std::string spoilt = sheet;
    for (int n = 0; n < 4; ++n) spoilt[random() % spoilt.size()] = static_cast<char>(random() % 256);
    if (random() % 3 == 0) spoilt.erase(random() % spoilt.size(), random() % 2000);
    EXPECT_EQ(said(spoilt).find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace breakaway::config
