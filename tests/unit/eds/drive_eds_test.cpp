// The EDS of the emulated drive against the drive on the virtual bus.
#include <gtest/gtest.h>

#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/eds/to_eds.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "walked_device.hpp"

namespace breakaway::eds {
namespace {

using drive_emulator::EmulatorConfig;

class HeldMotor final : public drive_emulator::Mechanism {
 public:
  void advance_to(double, const model::AppliedForce&) override {}
  double position_m() const override { return 0.123; }
};

class WalkedDrive final : public WalkedDevice {
 public:
  explicit WalkedDrive(const EmulatorConfig& config)
      : WalkedDevice{config.node_id}, drive_{config, motor_, [this](const hal::CanFrame& frame, hal::Time) {
                                               EXPECT_EQ(device.send(frame, hal::Time::max()), hal::SendResult::queued);
                                             }} {
    device.set_listener(
        [](void* self, const hal::ReceivedFrame& received) noexcept {
          static_cast<WalkedDrive*>(self)->drive_.on_frame(received.frame, received.time);
        },
        this);
    drive_.power_on(hal::Time{});
    run_for(100ms);
  }

 private:
  void advance() override {
    while (bus.now() < now) {
      const hal::Time next = std::min({now, bus.next_event(), drive_.next_event().value_or(now)});
      bus.advance_to(std::max(next, bus.now()));
      drive_.advance_to(bus.now());
    }
  }

  HeldMotor motor_;
  drive_emulator::DriveEmulator drive_;
};

EdsFile eds_of(const EmulatorConfig& config) {
  return EdsFile{to_eds(drive_device(config), "drive.eds", std::chrono::system_clock::from_time_t(1'700'000'000))};
}

EmulatorConfig drive_of_scenario(const std::string& name) {
  return *scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/" + name).worlds.front().drive;
}

EmulatorConfig unusual_drive() {
  EmulatorConfig config;
  config.node_id = 0x55;
  config.valid_pdos = 3;
  config.error_behaviour = 2;
  config.producer_heartbeat_ms = 1500;
  config.rated_torque_mNm = 0xFFFF'FFFF;
  config.quirks.interpolation_in_ms_only = true;
  config.quirks.position_reversed = true;
  config.quirks.position_range_counts = 4096;
  config.quirks.feed_constant = 77;
  return config;
}

class DriveEds : public ::testing::TestWithParam<EmulatorConfig> {};

TEST_P(DriveEds, SaysWhatAnswersOnTheBus) {
  WalkedDrive drive{GetParam()};
  expect_device_as_written(drive, eds_of(GetParam()));
}

TEST_P(DriveEds, LeavesNoObjectOut) {
  WalkedDrive drive{GetParam()};
  expect_nothing_else(drive, eds_of(GetParam()));
}

TEST_P(DriveEds, ListsEveryObjectOnce) { expect_lists_complete(eds_of(GetParam())); }

// RPDO4 and TPDO4 are empty and not valid at power-on, so that they take whatever may be mapped.
TEST_P(DriveEds, SaysWhatMayBeMapped) {
  WalkedDrive drive{GetParam()};
  for (const Entry& entry : eds_of(GetParam()).entries()) {
    if (entry.is_text()) continue;
    const auto mapped = static_cast<std::uint32_t>(entry.index) << 16U | static_cast<std::uint32_t>(entry.sub) << 8U |
                        static_cast<std::uint32_t>(8 * entry.size());
    const Entry first{0x1603, 1, {{"DataType", "7"}}}, sent{0x1A03, 1, {{"DataType", "7"}}};
    const bool received = drive.write(first, mapped) == SdoAbort::none;
    const bool transmitted = drive.write(sent, mapped) == SdoAbort::none;
    EXPECT_EQ(received || transmitted, entry.keys.at("PDOMapping") == "1") << entry.name();
    EXPECT_TRUE(!received || entry.access() != "ro") << entry.name();
    EXPECT_TRUE(!(received || transmitted) || entry.access() == "ro" || (received && transmitted)) << entry.name();
  }
}

INSTANTIATE_TEST_SUITE_P(Drives, DriveEds,
                         ::testing::Values(EmulatorConfig{}, unusual_drive(), drive_of_scenario("can_axis.toml")));

TEST(DriveEdsText, FollowsTheNodeIdWhereTheDriveDoes) {
  const EdsFile file = eds_of({});
  EXPECT_EQ(file.sections.at("1014").at("DefaultValue"), "$NODEID+0x00000080");
  EXPECT_EQ(file.sections.at("1200sub1").at("DefaultValue"), "$NODEID+0x00000600");
  EXPECT_EQ(file.sections.at("1400sub1").at("DefaultValue"), "$NODEID+0x00000200");
  EXPECT_EQ(file.sections.at("1801sub1").at("DefaultValue"), "$NODEID+0x80000280");
  EXPECT_EQ(file.sections.at("1005").at("DefaultValue"), "0x00000080");
}

TEST(DriveEdsText, IsTheSameUnderEveryNodeId) {
  EmulatorConfig one, other;
  one.node_id = 1;
  other.node_id = 127;
  EXPECT_EQ(eds_of(one).sections, eds_of(other).sections);
}

TEST(DriveEdsText, SaysWhoWroteItAndWhen) {
  const EdsFile file = eds_of({});
  const Section& info = file.sections.at("FileInfo");
  EXPECT_EQ(info.at("FileName"), "drive.eds");
  EXPECT_EQ(info.at("CreationDate"), "11-14-2023");
  EXPECT_EQ(info.at("CreationTime"), "10:13PM");
  const Section& device = file.sections.at("DeviceInfo");
  EXPECT_EQ(device.at("ProductName"), EmulatorConfig{}.device_name);
  EXPECT_EQ(device.at("NrOfRXPDO"), "4");
  EXPECT_EQ(device.at("NrOfTXPDO"), "4");
  EXPECT_EQ(device.at("BaudRate_1000"), "1");
}

}  // namespace
}  // namespace breakaway::eds
