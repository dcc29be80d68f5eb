// What a drive says of its torque and of its units: what is made of it, and which drives are refused for it.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "drive_fixture.hpp"

namespace breakaway::test {
namespace {

TEST_F(DriveTest, LowersTheDrivesTorqueLimitToTheAxisOwnAndNeverRaisesIt) {
  set_up();
  EXPECT_EQ(node.value_of(0x6072, 0), 1200U) << "60 N of 0.05 N a per mille";
  EXPECT_FLOAT_EQ(drive.max_force_N(), 60.0F);
  EXPECT_EQ(drive.rating().found_max_torque_per_mille, 2000) << "for whoever is to use the drive next";
  node.objects[ScriptedDrive::key(0x6072, 0)] = 400;
  set_up();
  EXPECT_EQ(node.value_of(0x6072, 0), 400U);
  EXPECT_FLOAT_EQ(drive.max_force_N(), 20.0F);
  EXPECT_EQ(drive.rating().found_max_torque_per_mille, 400) << "it booted meanwhile";
  EXPECT_EQ(std::count(node.written.begin(), node.written.end(), ScriptedDrive::key(0x6072, 0)), 1);
}

TEST_F(DriveTest, TakesTheTorqueLimitThatTheDriveKeeps) {
  node.refused[ScriptedDrive::key(0x6072, 0)] = SdoAbort::read_only;
  set_up();
  EXPECT_FLOAT_EQ(drive.max_force_N(), 50.0F) << "of a drive that does not say, its rated torque";
}

TEST_F(DriveTest, ReadsATorqueLimitThatItCannotLower) {
  node.read_only.insert(ScriptedDrive::key(0x6072, 0));
  set_up();
  EXPECT_EQ(node.value_of(0x6072, 0), 2000U);
  EXPECT_EQ(drive.rating().found_max_torque_per_mille, 2000);
}

struct RatedTorque {
  const char* label;
  std::uint32_t told_mNm, shown_mNm;
  std::optional<SetupStatus> refused;
};
class DriveWithARatedTorque : public DriveTest, public testing::WithParamInterface<RatedTorque> {
 protected:
  static DriveConfig<float> told() {
    DriveConfig<float> changed = config;
    changed.rated_torque_mNm = GetParam().told_mNm;
    return changed;
  }
  DriveWithARatedTorque() : DriveTest{told()} {}
};

TEST_P(DriveWithARatedTorque, IsTakenWhereTheFileAgreesAndRefusedByNameElsewhere) {
  node.objects[ScriptedDrive::key(0x6076, 0)] = GetParam().shown_mNm;
  node.boot();
  deliver();
  run_until_state(GetParam().refused ? DriveState::unusable : DriveState::disabled);
  EXPECT_EQ(drive.setup_status(), GetParam().refused.value_or(SetupStatus::ready));
}
INSTANTIATE_TEST_SUITE_P(
    Of, DriveWithARatedTorque,
    testing::Values(RatedTorque{"NothingTold", 0, 7, {}}, RatedTorque{"TheSame", 500, 500, {}},
                    RatedTorque{"ARoundedFigure", 500, 496, {}}, RatedTorque{"OneOff", 7, 8, {}},
                    RatedTorque{"AHundredthOfTheLarger", 10'000, 9'900, {}},
                    RatedTorque{"MoreThanAHundredth", 10'000, 9'899, SetupStatus::rated_torque_differs},
                    RatedTorque{"AThousandTimesToAHundredth", 500, 495'000, SetupStatus::rated_torque_unit},
                    RatedTorque{"AThousandthToAHundredth", 4'950, 5, SetupStatus::rated_torque_unit},
                    RatedTorque{"More", 500, 520, SetupStatus::rated_torque_differs},
                    RatedTorque{"Less", 500, 480, SetupStatus::rated_torque_differs},
                    RatedTorque{"TenTimes", 500, 5000, SetupStatus::rated_torque_differs},
                    RatedTorque{"AThousandTimes", 500, 500'000, SetupStatus::rated_torque_unit},
                    RatedTorque{"AThousandth", 5000, 5, SetupStatus::rated_torque_unit},
                    RatedTorque{"TheMostThereIs", 4'294'968, 0xFFFFFFFF, SetupStatus::rated_torque_unit}),
    [](const auto& row) { return row.param.label; });

class DriveOfTheLargestTorque : public DriveTest {
 protected:
  DriveOfTheLargestTorque() : DriveTest{counting_in_the_largest()} {}
  static DriveConfig<float> counting_in_the_largest() {
    DriveConfig<float> told = config;
    told.torque_base = breakaway::cia402::TorqueBase::largest;
    return told;
  }
};

// 0.05 N a per mille: 60 N are 1200.
TEST_F(DriveOfTheLargestTorque, HasItLoweredToTheAxisLimitAndIsSentPerMilleOfThat) {
  enable();
  EXPECT_EQ(node.value_of(0x6072, 0), 1200U);
  step(30.0F);
  EXPECT_EQ(node.target, 500);
  step(-1000.0F);
  EXPECT_EQ(node.target, -1000);
}

TEST_F(DriveOfTheLargestTorque, IsRefusedByNameWhereItCannotBeTheAxisLimit) {
  node.objects[ScriptedDrive::key(0x6072, 0)] = 1100;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::torque_base_differs);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x6072, 0}));
}

TEST_F(DriveOfTheLargestTorque, IsRefusedByNameWhereItKeepsAnother) {
  node.kept[ScriptedDrive::key(0x6072, 0)] = 2000;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::torque_base_differs);
}

// 608Fh is 10000 counts a turn; 6092h:01 is `feed`.
struct Units {
  std::uint32_t feed;
  bool told;  // position_unit = "user"
  SetupStatus status;
};
class DriveWithUnits : public DriveTest, public testing::WithParamInterface<Units> {
 protected:
  DriveWithUnits() : DriveTest{told_units()} {}
  static DriveConfig<float> told_units() {
    DriveConfig<float> told = config;
    told.user_position_unit = GetParam().told;
    return told;
  }
};
TEST_P(DriveWithUnits, AreTakenWhereTheFileExpectsThemAndRefusedByNameElsewhere) {
  node.objects[ScriptedDrive::key(0x608F, 1)] = 10'000;
  node.objects[ScriptedDrive::key(0x6092, 1)] = GetParam().feed;
  node.boot();
  deliver();
  const bool good = GetParam().status == SetupStatus::ready;
  run_until_state(good ? DriveState::disabled : DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), GetParam().status);
  EXPECT_EQ(drive.setup_object(), good ? ObjectAddress{} : (ObjectAddress{0x6092, 2}));
}
INSTANTIATE_TEST_SUITE_P(
    Of, DriveWithUnits,
    testing::Values(Units{10'000, false, SetupStatus::ready}, Units{10'000, true, SetupStatus::ready},
                    Units{3'600, false, SetupStatus::position_scaled}, Units{3'600, true, SetupStatus::ready},
                    Units{36'000, false, SetupStatus::position_scaled},
                    Units{36'000, true, SetupStatus::position_too_fine}),
    [](const auto& row) { return std::to_string(row.param.feed) + (row.param.told ? "Told" : "Untold"); });

TEST_F(DriveTest, UnitsThatAreMendedAreTakenAtTheNextReset) {
  node.objects[ScriptedDrive::key(0x6091, 1)] = 3;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  node.objects[ScriptedDrive::key(0x6091, 1)] = 1;
  drive.reset_fault();
  run_until_state(DriveState::disabled);
  EXPECT_EQ(drive.setup_status(), SetupStatus::ready);
}

TEST_F(DriveTest, UnitsOfADriveThatBootsAreItsOwn) {
  const auto key = ScriptedDrive::key;
  node.objects[key(0x6091, 1)] = 3;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  node.objects.erase(key(0x6091, 1));
  set_up();
}

class WeakAxisTest : public DriveTest {
 protected:
  // The limit is less than one per mille of the rated torque.
  WeakAxisTest() : DriveTest{config, {.encoder_resolution_m = 1e-6F, .max_force_N = 0.04F}} {}
};

TEST_F(WeakAxisTest, LimitBelowOneQuantumIsUnusable) {
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::force_step_too_coarse);
  EXPECT_EQ(drive.config_error(), DriveConfigError::none);
  node.boot();
  deliver();
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::unusable) << "it is the same drive";
  EXPECT_EQ(drive.setup_status(), SetupStatus::force_step_too_coarse);
}

TEST_F(WeakAxisTest, AReadingOfTheRatingThatWasWrongIsMendedByAReset) {
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  node.objects[ScriptedDrive::key(0x6076, 0)] = 500;
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::unusable);
  drive.reset_fault();
  run_for(1ms);
  EXPECT_NE(feedback.state, DriveState::unusable) << "or the fault would be latched again";
  run_until_state(DriveState::disabled);
  EXPECT_EQ(drive.setup_status(), SetupStatus::ready);
}

}  // namespace
}  // namespace breakaway::test
