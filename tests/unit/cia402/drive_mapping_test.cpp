// PDOs of a drive that does not let anybody map what it sends and takes.
#include <gtest/gtest.h>

#include <array>

#include "drive_fixture.hpp"

namespace breakaway::test::drive_mapping {
namespace {

class DriveMappingTest : public DriveTest {
 protected:
  static constexpr std::array<std::uint32_t, 3> command_map{0x160000, 0x160001, 0x160002};
  static constexpr std::array<std::uint32_t, 4> feedback_map{0x1A0000, 0x1A0001, 0x1A0002, 0x1A0003};

  void fix_mapping() {
    for (const std::uint32_t object : command_map) node.read_only.insert(object);
    node.objects[ScriptedDrive::key(0x1600, 0)] = 2;
    node.objects[ScriptedDrive::key(0x1600, 1)] = 0x60400010;
    node.objects[ScriptedDrive::key(0x1600, 2)] = 0x60710010;
  }
  void fix_feedback_mapping() {
    for (const std::uint32_t object : feedback_map) node.read_only.insert(object);
    node.objects[ScriptedDrive::key(0x1A00, 0)] = 3;
    node.objects[ScriptedDrive::key(0x1A00, 1)] = 0x60410010;
    node.objects[ScriptedDrive::key(0x1A00, 2)] = 0x60640020;
    node.objects[ScriptedDrive::key(0x1A00, 3)] = 0x60770010;
  }
  void expect_refused(SetupStatus status, std::uint8_t subindex, std::uint16_t index = 0x1600) {
    node.boot();
    deliver();
    run_until_state(DriveState::unusable);
    EXPECT_EQ(drive.setup_status(), status);
    EXPECT_EQ(drive.setup_object(), (ObjectAddress{index, subindex}));
  }
};

TEST_F(DriveMappingTest, IsTakenWhereItIsFixedToWhatWouldBeMapped) {
  fix_mapping();
  set_up();
}

TEST_F(DriveMappingTest, IsTakenAgainWhenTheDriveBootsAnew) {
  fix_mapping();
  for (int boot = 0; boot < 2; ++boot) {
    node.boot();
    deliver();
    step();
    ASSERT_EQ(feedback.state, DriveState::configuring);
    run_until_state(DriveState::disabled);
  }
}

TEST_F(DriveMappingTest, IsTakenWhereWhatTheDriveSendsIsFixed) {
  fix_feedback_mapping();
  set_up();
  fix_mapping();
  set_up();
}

TEST_F(DriveMappingTest, IsRefusedWhereItIsFixedToSomethingElse) {
  fix_mapping();
  node.objects[ScriptedDrive::key(0x1600, 2)] = 0x607A0020;
  expect_refused(SetupStatus::value_not_kept, 2);
}

TEST_F(DriveMappingTest, IsRefusedWhereTheDriveSendsSomethingElse) {
  fix_feedback_mapping();
  node.objects[ScriptedDrive::key(0x1A00, 2)] = 0x606C0020;
  expect_refused(SetupStatus::value_not_kept, 2, 0x1A00);
}

TEST_F(DriveMappingTest, IsRefusedWhereItIsFixedAndCannotBeRead) {
  fix_mapping();
  node.refused[ScriptedDrive::key(0x1600, 0)] = SdoAbort::no_such_object;
  expect_refused(SetupStatus::object_refused, 0);
}

TEST_F(DriveMappingTest, IsRefusedWhereItMayBeClearedButNotBeAsLong) {
  node.most[ScriptedDrive::key(0x1600, 0)] = 1;
  expect_refused(SetupStatus::object_refused, 0);
  EXPECT_EQ(drive.setup_abort_code(), SdoAbort::value_too_high);
}

}  // namespace
}  // namespace breakaway::test::drive_mapping
