// A node's file: what it says arrives, and what contradicts itself is refused in one line that names file, key and
// remedy.
#include "breakaway/config/read_node.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "two_axes.hpp"

namespace breakaway::config {
namespace {

using namespace std::chrono_literals;
using testing::axis_text;
using testing::certified_node;
using testing::two_axes;
using testing::with;

struct BadNode {
  const char* label;
  std::string text;
  std::vector<std::string> named;
};

class BadNodeIsRefused : public ::testing::TestWithParam<BadNode> {};

TEST_P(BadNodeIsRefused, InOneLineThatNamesFileKeyAndRemedy) {
  const std::string message = breakaway::testing::refusal([] { certified_node(GetParam().text); });
  EXPECT_TRUE(message.starts_with("node.toml:")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const std::string& part : GetParam().named)
    EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
}

// The first axis, with another line in one of its tables.
std::string with_line(const std::string& table, const std::string& line) {
  return with(two_axes, "[axis." + table + "]\n", "[axis." + table + "]\n" + line + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadNodeIsRefused,
    ::testing::Values(
        BadNode{"NodeIdTwice",
                with(two_axes, "node_id = 2", "node_id = 1"),
                {"[axis.drive] node_id", "is 1", "axis x", "give every drive its own"}},
        BadNode{"NodeIdOfTheNode",
                with(two_axes, "[loop]\n", "[loop]\nnode_id = 2\n"),
                {"[axis.drive] node_id", "is 2", "[loop]", "change"}},
        BadNode{"NameTwice", with(two_axes, "\"y\"", "\"x\""), {"name", "\"x\"", "a name of its own"}},
        BadNode{"NameTooLong", with(two_axes, "\"y\"", "\"abcdefghijklmnopqrstuvwx\""), {"name", "1 to 23"}},
        BadNode{"NameWithSpace", with(two_axes, "\"y\"", "\"y z\""), {"name", "y z", "letters, digits"}},
        BadNode{"NameMissing", with(two_axes, "name = \"y\"\n", ""), {"[axis] name", "missing", "text"}},
        BadNode{"NineAxes",
                two_axes + axis_text("a", 3) + axis_text("b", 4) + axis_text("c", 5) + axis_text("d", 6) +
                    axis_text("e", 7) + axis_text("f", 8) + axis_text("g", 9),
                {"axis", "9 times", "8"}},
        BadNode{"AxisBesideTables", "[plant]\nmass_kg = 1\n" + two_axes, {"plant", "beside [[axis]]"}},
        BadNode{"ForceLimitBelowLaw",
                with_line("limits", "force_N = 40"),
                {"[axis.limits] force_N", "40", "max_force_N = 50", "raise"}},
        BadNode{"ForceLimitBelowDrive",
                with(with_line("limits", "force_N = 40"), "max_force_N = 50\n", ""),
                {"[axis.limits] force_N", "40", "[drive] gives = 50", "raise"}},
        BadNode{"SpeedLimitBelowLaw",
                with(two_axes, "speed_m_s = 20", "speed_m_s = 4"),
                {"[axis.limits] speed_m_s", "4", "max_approach_speed_m_s = 5", "raise"}},
        BadNode{"FollowingErrorBelowTolerance",
                with_line("limits", "following_error_m = 1e-6"),
                {"following_error_m", "position_tolerance_m", "raise"}},
        BadNode{
            "PositionLimitTwice", with_line("limits", "position_m = 1\nposition_max_m = 2"), {"position_m", "alone"}},
        BadNode{"PositionLimitsSwapped",
                with_line("limits", "position_min_m = 2\nposition_max_m = 1"),
                {"position_min_m", "swap"}},
        BadNode{"PositionLimitsBeyondTheCount",
                with_line("limits", "position_m = 1100"),
                {"[axis.limits] position_m", "2200 m", "less than 2147 m", "1e-06", "above 1.03e-06 m"}},
        BadNode{"PositionLimitBeyondTheCount",
                with_line("limits", "position_min_m = -2148"),
                {"[axis.limits] position_min_m", "2148 m", "narrow the range"}},
        BadNode{"TargetsBeyondTheCount",
                with_line("controller",
                          "targets = [{ time_s = 1, position_m = 1100 }, "
                          "{ time_s = 2, position_m = -1100 }]"),
                {"[axis.controller] targets", "2200 m apart", "closer"}},
        BadNode{"DriveTooWeak",
                with(two_axes, "max_force_N = 50", "max_force_N = 51"),
                {"[axis.controller] max_force_N", "51", "50 N at most", "lower it"}},
        BadNode{"DriveTooWeakByAHair",
                with(two_axes, "N_per_Nm = 50", "N_per_Nm = 49.999999"),
                {"[axis.controller] max_force_N", "is 50,", "gives 49.999999 N at most"}},
        BadNode{"PeriodThatDrivesAreNotTold",
                with(two_axes, "period_s = 0.001", "period_s = 0.0012345"),
                {"[loop] period_s", "60C2h", "round"}},
        BadNode{"HeartbeatTimeoutShort",
                with_line("drive", "heartbeat_timeout_s = 0.05"),
                {"[axis.drive] heartbeat_timeout_s", "heartbeat_period_s", "raise"}},
        BadNode{"HeartbeatInEveryPeriod",
                with(two_axes, "[loop]\n", "[loop]\nheartbeat_period_s = 0.001\n"),
                {"[loop] heartbeat_period_s", "is 0.001", "below two periods", "raise it to 0.002"}},
        BadNode{"HeartbeatSlowerThanTimeout",
                with(two_axes, "[loop]\n", "[loop]\nheartbeat_period_s = 0.3\n"),
                {"[axis.drive] heartbeat_timeout_s", "is 0.25", "heartbeat_period_s = 0.3", "raise"}},
        BadNode{
            "PidIsNotCertified",
            with(two_axes, "[axis.controller]\nk1_N_per_m = 400\nk21_Ns_per_m = 32\nk22_Ns_per_m = 60\ncoast = \"pd\"",
                 "[axis.controller]\nkind = \"pid\"\nkp_N_per_m = 400\nki_N_per_ms = 1\nkd_Ns_per_m = 30"),
            {"axis x", "kind", "pid", "impulsive"}},
        BadNode{"HomeOfAnAbsoluteEncoder",
                with_line("drive", "encoder = \"absolute\"\nhome = \"here\""),
                {"home", "encoder = \"absolute\"", "leave out the one that is wrong"}},
        BadNode{"HomingOfAnAxisThatStandsAtHome",
                with_line("drive", "home = \"here\"\nhome_method = 17"),
                {"home_method", "set home = \"drive\""}},
        BadNode{"PlaceOfNoHome", with_line("drive", "home_position_m = 0.1"), {"home_position_m", "needs a home"}},
        BadNode{"HomeBeyondTheCounts",
                with_line("drive", "home = \"here\"\nhome_position_m = 3000"),
                {"home_position_m", "that a drive can count", "lower it"}},
        BadNode{"NotCertified",
                with(two_axes, "k22_Ns_per_m = 60", "k22_Ns_per_m = 300"),
                {"axis x: not certified", "breakaway design node.toml"}}),
    [](const auto& row) { return std::string{row.param.label}; });

TEST(ReadNode, ABusThatIsTooSlowIsRefusedWithTheLeastPeriodThatWouldDo) {
  const std::string slow = with(two_axes, "1_000_000", "250_000");
  const std::string message = breakaway::testing::refusal([&] { certified_node(slow); });
  const std::string remedy = "choose a period_s of at least ";
  const auto at = message.find(remedy);
  ASSERT_NE(at, std::string::npos) << message;
  EXPECT_TRUE(message.starts_with("node.toml: 2 axes at [loop] period_s = 0.001 do not fit")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  const std::string least = message.substr(at + remedy.size());
  const auto node_at = [&](const std::string& period) {
    return parse_node(with(slow, "period_s = 0.001", "period_s = " + period), "node.toml");
  };
  EXPECT_NO_THROW(require_fitting_bus(node_at(least))) << least;
  EXPECT_THROW(require_fitting_bus(node_at(std::to_string(std::stod(least) - 10e-6))), InputError)
      << "less does not do";
}

// One key of the file and the field of the drive that it sets.
TEST(ReadNode, EveryFieldOfADriveCanBeSet) {
  const auto drive_of = [](const std::string& line) { return certified_node(with_line("drive", line)).axes[0].drive; };
  // Does not compile when DriveConfig gets another field: then it needs a key and a line here.
  const auto [node_id, force, rated, heartbeat_period, heartbeat_timeout, sdo_timeout, torque_base, user_unit, inverted,
              absolute, homing, information] = drive_of("");
  EXPECT_EQ(node_id, 1);
  EXPECT_EQ(force, 50);
  EXPECT_EQ(rated, 500U);
  EXPECT_EQ(heartbeat_period, 100ms);
  EXPECT_EQ(heartbeat_timeout, 250ms);
  EXPECT_EQ(sdo_timeout, 50ms);
  EXPECT_EQ(torque_base, cia402::TorqueBase::rated);
  EXPECT_FALSE(user_unit);
  EXPECT_FALSE(inverted);
  EXPECT_FALSE(absolute);
  EXPECT_EQ(homing.home, cia402::Home::none);
  EXPECT_EQ(information, canopen::EmcyCodes{});
  EXPECT_EQ(drive_of("emcy_information = [\"42xxh\", \"ff0Ah\"]").emcy_information,
            (canopen::EmcyCodes{.first = {0x4200, 0xFF0A}, .last = {0x42FF, 0xFF0A}}));
  EXPECT_EQ(certified_node(with(two_axes, "node_id = 1", "node_id = 99")).axes[0].drive.node_id, 99);
  EXPECT_EQ(drive_of("heartbeat_period_s = 0.2").heartbeat_period, 200ms);
  EXPECT_EQ(drive_of("heartbeat_timeout_s = 0.5").heartbeat_timeout, 500ms);
  EXPECT_EQ(drive_of("sdo_timeout_s = 0.3").sdo_timeout, 300ms);
  EXPECT_TRUE(drive_of("invert_direction = true").invert_direction);
  const auto homed = drive_of(
                         "home = \"drive\"\nhome_method = 17\nhome_speed_m_s = 0.1\nhome_zero_speed_m_s = 0.01\n"
                         "home_acceleration_m_s2 = 2\nhome_timeout_s = 20\nhome_position_m = -0.2")
                         .homing;
  EXPECT_EQ(homed.home, cia402::Home::by_drive);
  EXPECT_EQ(homed.method, 17);
  EXPECT_EQ(homed.search_counts_s, 100'000U);
  EXPECT_EQ(homed.zero_counts_s, 10'000U);
  EXPECT_EQ(homed.acceleration_counts_s2, 2'000'000U);
  EXPECT_EQ(homed.timeout, 20s);
  EXPECT_EQ(homed.position_counts, -200'000);
  EXPECT_EQ(drive_of("home = \"here\"").homing.home, cia402::Home::here);
  EXPECT_TRUE(drive_of("position_unit = \"user\"").user_position_unit);
  EXPECT_FALSE(drive_of("position_unit = \"encoder\"").user_position_unit);
  EXPECT_EQ(drive_of("torque_relative_to = \"max\"").torque_base, cia402::TorqueBase::largest);
  EXPECT_EQ(drive_of("torque_relative_to = \"rated\"").torque_base, cia402::TorqueBase::rated);
  EXPECT_TRUE(drive_of("encoder = \"absolute\"").absolute_encoder);
  EXPECT_FALSE(drive_of("encoder = \"incremental\"").absolute_encoder);
  const std::string geared = with(two_axes, "force_per_torque_N_per_Nm = 50", "force_per_torque_N_per_Nm = 100");
  EXPECT_EQ(certified_node(geared).axes[0].drive.force_per_torque_N_per_Nm, 100);
}

TEST(ReadNode, CodesOfInformationAreRefusedWithTheRemedyWhereTheyAreNone) {
  struct Wrong {
    const char *codes, *says;
  };
  const char* const no_code =
      ", must be an array of error codes of EMCY in quotes, each as \"FF01h\", or \"42xxh\" for a whole class";
  for (const auto& [codes, says] :
       {Wrong{"\"FF01h\"", no_code},
        Wrong{"[0xFF01]", no_code},
        Wrong{"[\"fan\"]", no_code},
        Wrong{"[\"FF01\"]", no_code},
        Wrong{"[\"0xFF01\"]", no_code},
        Wrong{"[\"1h\"]", no_code},
        Wrong{"[\"-F01h\"]", no_code},
        Wrong{"[\"4xxxh\"]", no_code},
        Wrong{"[\"h\"]", no_code},
        Wrong{"[\"0000h\"]", "has \"0000h\", and 00xxh is how a drive says that errors are gone; leave it out"},
        Wrong{"[\"00xxh\"]", "has \"00xxh\", and 00xxh is how"},
        Wrong{"[\"00FFh\"]", "has \"00FFh\", and 00xxh is how"},
        Wrong{"[\"10000h\"]", "has \"10000h\", which is above FFFFh, the last error code of EMCY; give it four digits"},
        Wrong{"[\"FFFFFFFFFFFFFFFFFFh\"]", "which is above FFFFh"},
        Wrong{"[\"FF01h\", \"4210h\", \"ff01h\"]", "has \"FF01h\" twice; leave one out"},
        Wrong{"[\"42xxh\", \"42xxh\"]", "has \"42xxh\" twice; leave one out"},
        Wrong{"[\"4210h\", \"42xxh\"]", "has \"4210h\", which \"42xxh\" holds as well; leave one of the two out"},
        Wrong{"[\"42xxh\", \"4200h\"]", "has \"4200h\", which \"42xxh\" holds as well; leave one of the two out"},
        Wrong{"[\"42xxh\", \"42FFh\"]", "has \"42FFh\", which \"42xxh\" holds as well"},
        Wrong{"[\"1001h\",\"1002h\",\"1003h\",\"1004h\",\"1005h\",\"1006h\",\"1007h\",\"1008h\",\"1009h\"]",
              "has 9 entries, and a drive has room for 8; name a class, as \"FFxxh\", in the place of several"}}) {
    const std::string text = with_line("drive", std::string{"emcy_information = "} + codes);
    const std::string message = breakaway::testing::refusal([&] { parse_node(text, "node.toml"); });
    EXPECT_TRUE(message.starts_with("node.toml:")) << message;
    EXPECT_NE(message.find(".drive] emcy_information "), message.npos) << message;
    EXPECT_NE(message.find(says), message.npos) << codes << ": " << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
  }
  const std::string widest = R"(emcy_information = ["0100h","0101h","01FFh","41xxh","43xxh","42FFh","4200h","FFxxh"])";
  EXPECT_EQ(certified_node(with_line("drive", widest)).axes[0].drive.emcy_information.last[7], 0xFFFF);
}

TEST(ReadNode, EveryFieldOfTheLoopCanBeSet) {
  const auto loop_of = [](const std::string& line) {
    return certified_node(with(two_axes, "[loop]\n", "[loop]\n" + line + "\n")).loop;
  };
  const auto [network, fault_scope, moves_end, command_timeout] = loop_of("");
  const auto [period, bit_rate, node_id, heartbeat_period] = network;
  EXPECT_EQ(period, 1ms);
  EXPECT_EQ(bit_rate, 1'000'000U);
  EXPECT_EQ(node_id, 127);
  EXPECT_EQ(heartbeat_period, 50ms);
  EXPECT_EQ(fault_scope, firmware::FaultScope::axis);
  EXPECT_EQ(moves_end, firmware::MovesEnd::each);
  EXPECT_EQ(loop_of("moves_end = \"together\"").moves_end, firmware::MovesEnd::together);
  EXPECT_EQ(command_timeout, 500ms);
  EXPECT_EQ(loop_of("command_timeout_s = 0.1").command_timeout, 100ms);
  EXPECT_EQ(loop_of("node_id = 20").network.node_id, 20);
  EXPECT_EQ(loop_of("heartbeat_period_s = 0.02").network.heartbeat_period, 20ms);
  EXPECT_EQ(loop_of("fault_stops = \"all\"").fault_scope, firmware::FaultScope::all_axes);
  EXPECT_EQ(certified_node(with(two_axes, "1_000_000", "800_000")).loop.network.bit_rate, 800'000U);
}

// An axis that hardly rubs.
config::AnyNode<float> slow_node(const std::string& mass_kg, const std::string& controller,
                                 const std::string& count_m) {
  return certified_node("[loop]\nperiod_s = 0.01\n[bus]\nbit_rate = 1_000_000\n[plant]\nmass_kg = " + mass_kg + R"(
[friction]
lower_N = 0.1
upper_N = 0.15
[limits]
position_m = 100
speed_m_s = 20
[controller]
k1_N_per_m = 0.1
max_force_N = 10
)" + controller + R"(
[drive]
rated_torque_Nm = 0.5
max_torque_per_mille = 2000
force_per_torque_N_per_Nm = 10
encoder_resolution_m = )" +
                        count_m + "\n");
}

// 10 t, read by millimetres: kicks and their proofs of rest take minutes.
TEST(ReadNode, GivesASlowAxisTheTimeThatItsCertificateNeeds) {
  const auto node = slow_node("1e4", "k21_Ns_per_m = 10\nk22_Ns_per_m = 100\nposition_tolerance_m = 2e-3", "1e-3");
  EXPECT_GT(node.axes[0].limits.progress_timeout, 200s);
}

// A tonne on a soft spring: once it has passed its target it comes no nearer for minutes, until its kicks lead it back.
TEST(ReadNode, GivesASlowAxisUnderTheCoastPdTheTimeThatItsCertificateNeeds) {
  const auto node =
      slow_node("1e3", "coast = \"pd\"\nk21_Ns_per_m = 7\nk22_Ns_per_m = 32\nposition_tolerance_m = 2e-5", "1e-6");
  EXPECT_GT(node.axes[0].limits.progress_timeout, 600s);
}

TEST(ReadNode, EveryLimitOfAnAxisCanBeSet) {
  const auto limits_of = [](const std::string& lines) {
    return certified_node(with_line("limits", lines)).axes[0].limits;
  };
  const auto [low, high, speed, force, following, feedback_timeout, progress_timeout] = limits_of(
      "position_min_m = -2\nposition_max_m = 3\nforce_N = 60\nfollowing_error_m = 0.1\nfeedback_timeout_s = 0.004");
  EXPECT_EQ(low, -2);
  EXPECT_EQ(high, 3);
  EXPECT_EQ(speed, 20);
  EXPECT_EQ(force, 60);
  EXPECT_EQ(following, 0.1F);
  EXPECT_EQ(feedback_timeout, 4ms);
  EXPECT_EQ(progress_timeout, 60s) << "no line of the file: what the certificate of a slow axis needs, and a minute";
  EXPECT_EQ(limits_of("position_m = 5").position_min_m, -5);
}

TEST(ReadNode, AFileWithoutAxisEntriesIsANodeOfOneAxis) {
  const Node node = read_node(std::filesystem::path{BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml"});
  ASSERT_EQ(node.axes.size(), 1U);
  EXPECT_EQ(node.axes[0].name, "axis");
}

TEST(ReadNode, DrivesAreNumberedInTheirOrderUnlessToldOtherwise) {
  const Node node = parse_node(with(with(two_axes, "node_id = 1\n", ""), "node_id = 2\n", ""), "");
  EXPECT_EQ(node.axes[0].drive->node_id, 1);
  EXPECT_EQ(node.axes[1].drive->node_id, 2);
}

}  // namespace
}  // namespace breakaway::config
