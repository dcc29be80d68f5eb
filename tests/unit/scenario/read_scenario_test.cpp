// Bad input is refused in one line that names the place, the value and the remedy.
#include "breakaway/scenario/read_scenario.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "breakaway/config/node.hpp"
#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/machine_scenario.hpp"

namespace {

using breakaway::InputError;
using breakaway::scenario::parse_any_scenario;
using breakaway::scenario::parse_scenario;
using breakaway::scenario::read_any_scenario;
using breakaway::scenario::read_scenario;
using breakaway::scenario::Scenario;

const std::string sound = R"(
[plant]
mass_kg = 1
[friction]
lower_N = 2.5
upper_N = 4.5
[controller]
k1_N_per_m = 1
k21_Ns_per_m = 0.5
k22_Ns_per_m = 3
[run]
duration_s = 60
)";

const std::string drive =
    "[drive]\nrated_torque_Nm=1\nmax_torque_per_mille=1000\nforce_per_torque_N_per_Nm=10\nencoder_resolution_m=1e-6\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  try {
    parse_any_scenario(text, "axis.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

struct BadInput {
  const char* label;
  std::string text;
  std::vector<std::string> named;
};

class BadInputIsRefused : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputIsRefused, InOneLineThatNamesPlaceAndRemedy) {
  const std::string message = refusal(GetParam().text);
  EXPECT_TRUE(message.starts_with("axis.toml:")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const std::string& part : GetParam().named)
    EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadInputIsRefused,
    testing::Values(
        BadInput{"MisspeltKey", with(sound, "mass_kg", "mas_kg"), {":3:", "[plant]", "mas_kg", "mass_kg"}},
        BadInput{"EmptyKey", "\"\" = 1\n" + sound, {":1:", "not a key"}},
        BadInput{"KeyBeyondAscii", with(sound, "mass_kg", "\u00b5_kg"), {":3:", "not valid TOML"}},
        BadInput{"ThreeBrackets", "[[[plant]]]\n" + sound, {":1:", "not valid TOML"}},
        BadInput{"HeaderBeyondAscii", with(sound, "[plant]", "[\u00b5plant]"), {":2:", "not valid TOML"}},
        BadInput{"Latin1",
                 "# Gr\xF6\xDF"
                 "e\n" +
                     sound,
                 {":1:", "not valid TOML", "save the file as UTF-8"}},
        BadInput{"Utf16", std::string{"\xFF\xFE#\0", 4} + sound, {"UTF-16", "save it as UTF-8"}},
        BadInput{"KeyWithLineBreak", "\"a\\nb\" = 1\n" + sound, {":1:", "a b"}},
        BadInput{"BeyondAsciiInLongString", "title = \"\"\"\\\n\u00a7\"\"\"\n" + sound, {":2:", "ASCII"}},
        BadInput{"KeyWithoutItsUnit", with(sound, "k1_N_per_m", "k1"), {"[controller]", "k1 is", "key is k1_N_per_m"}},
        BadInput{"MisspeltSection", with(sound, "[friction]", "[fricton]"), {":4:", "fricton", "friction"}},
        BadInput{"MissingKey", with(sound, "mass_kg = 1", ""), {"[plant]", "mass_kg", "missing", "kg"}},
        BadInput{"MissingSection", with(sound, "[plant]\nmass_kg = 1", ""), {"plant", "missing"}},
        BadInput{"KeyBesideTheOnlyOneOfATable",
                 sound + "[plant.backlash]\ngap_m = 1e-5\nwidth_m = 1\n",
                 {"[plant.backlash]", "width_m", "gap_m"}},
        BadInput{"KeyWithoutItsHeader",
                 "mass_kg = 1\n" + with(sound, "mass_kg = 1", ""),
                 {":1:", "mass_kg", "stands below [plant] or [told]", "header"}},
        BadInput{"HeaderForgotten",
                 with(sound, "[friction]\n", ""),
                 {":4:", "[plant]", "lower_N", "stands below [friction]"}},
        BadInput{"HeaderOfAnAxisForgotten",
                 "[[axis]]\nname = \"x\"\n[axis.plant]\nmass_kg = 1\nlower_N = 2\n",
                 {":5:", "[axis.plant]", "lower_N", "stands below [axis.friction]"}},
        BadInput{"StartOutsideTheLimits",
                 with(sound, "mass_kg = 1", "mass_kg = 1\nposition_m = -0.3") + "[loop]\nperiod_s=0.001\n" + drive +
                     "[limits]\nposition_m = 0.2\n",
                 {"[plant] position_m = -0.3", "[limits], -0.2 to 0.2 m", "widen"}},
        BadInput{"WrongType", with(sound, "mass_kg = 1", "mass_kg = \"1\""), {":3:", "mass_kg", "'1'", "number"}},
        BadInput{"SectionIsNumber", "plant = 3\n" + with(sound, "[plant]\nmass_kg = 1", ""), {":1:", "plant", "table"}},
        BadInput{"ZeroMass", with(sound, "mass_kg = 1", "mass_kg = 0"), {":3:", "mass_kg", "0", "(0, ", "kg"}},
        BadInput{"PeriodInMilliseconds", sound + "[loop]\nperiod_s = 10\n" + drive, {"period_s", "10", "1] s"}},
        BadInput{"NotANumber", with(sound, "lower_N = 2.5", "lower_N = nan"), {":5:", "lower_N", "nan"}},
        BadInput{"Infinite", with(sound, "duration_s = 60", "duration_s = inf"), {"duration_s", "inf"}},
        BadInput{"BoundsReversed", with(sound, "lower_N = 2.5", "lower_N = 5"), {"lower_N", "5", "upper_N", "swap"}},
        BadInput{"MixedFrictionUnits", with(sound, "lower_N = 2.5", "mu_lower = 0.2"), {"upper_N", "mu_upper"}},
        BadInput{"ApproachOverdamped",
                 with(sound, "k21_Ns_per_m = 0.5", "k21_Ns_per_m = 2"),
                 {"k21", "zeta = 1;", "below 2 sqrt(k1 m) = 2 N s/m"}},
        BadInput{"KickUnderdamped", with(sound, "k22_Ns_per_m = 3", "k22_Ns_per_m = 2"), {"k22", "zeta = 1;", "above"}},
        BadInput{"UnknownController",
                 with(sound, "[controller]", "[controller]\nkind = \"pdi\""),
                 {"kind", "pdi", "\"impulsive\" or \"pid\""}},
        BadInput{"UnknownFrictionLaw",
                 sound + "[friction.law]\nkind = \"stribek\"\n",
                 {"[friction.law]", "stribek", "stribeck"}},
        BadInput{"BadCombination",
                 sound + "[friction.law]\nkind = \"mean\"\nweights = [1]\nparts = []\n",
                 {"friction.law", "parts", "one or more"}},
        BadInput{"IdealKickInALoop",
                 with(sound, "[controller]", "[controller]\nkick = \"ideal\"") + "[loop]\nperiod_s = 0.001\n" + drive,
                 {"kick", "two_phase"}},
        BadInput{"FrictionLawIsNumber",
                 sound + "[friction.law]\nkind = 3\n",
                 {"[friction.law]", "kind is 3", "\"stribeck\""}},
        BadInput{"FrictionTooFastToFollow",
                 sound + "[friction.law]\nkind = \"sine_in_position\"\nperiod_m = 1e-9\n",
                 {"period_m", "1e-09", "[1e-05, 1e+12] m"}},
        BadInput{"CurrentLoopTooFastToFollow",
                 sound + "[loop]\nperiod_s=0.001\n" + drive + "current_loop_time_constant_s = 1e-12\n",
                 {"current_loop_time_constant_s", "give 0"}},
        BadInput{"MotorTurnedAround",
                 sound + "[loop]\nperiod_s=0.001\n" + with(drive, "Nm=10", "Nm=-10"),
                 {"force_per_torque_N_per_Nm", "-10", "(0, 1e+12]"}},
        BadInput{"PreslidingWithoutStiffness",
                 sound + "[plant.presliding]\ndamping_Ns_per_m = 1\n",
                 {"[plant.presliding]", "stiffness_N_per_m", "missing"}},
        BadInput{"DahlWithDamping",
                 sound + "[plant.presliding]\nmodel=\"dahl\"\nstiffness_N_per_m=1e6\ndamping_Ns_per_m = 1\n",
                 {"damping_Ns_per_m", "dahl", "lugre"}},
        BadInput{"BacklashWithoutALoad",
                 sound + "[plant.backlash]\ngap_m = 1e-5\n",
                 {"[plant.backlash]", "needs a [plant.load]"}},
        BadInput{"LoadWithOneBound",
                 sound + "[plant.load]\nmass_kg=1\nstiffness_N_per_m=1e6\nfriction_lower_N=1\n",
                 {"[plant.load]", "friction_upper_N", "both"}},
        BadInput{"LoadBoundsReversed",
                 sound + "[plant.load]\nmass_kg=1\nstiffness_N_per_m=1e6\nfriction_lower_N=2\nfriction_upper_N=1\n",
                 {"[plant.load]", "friction_lower_N", "swap"}},
        BadInput{"SpringThatNoRunCouldFollow",
                 sound + "[plant.load]\nmass_kg=1e-6\nstiffness_N_per_m=1e8\n",
                 {"rad/s", "lower stiffness_N_per_m"}},
        BadInput{"InterpolationWithoutLines",
                 sound + "[plant.encoder_error]\ninterpolation_m=1e-7\n",
                 {"[plant.encoder_error]", "period_m", "lines"}},
        BadInput{"RippleOfAll", sound + "[plant.ripple]\nshare=1\nperiod_m=1e-3\n", {"share", "0.99"}},
        BadInput{"DriftWithoutPeriod", sound + "[plant.drift]\nshare=0.1\n", {"[plant.drift]", "period_s", "missing"}},
        BadInput{"TargetsOutOfOrder",
                 with(sound, "[controller]",
                      "[controller]\ntargets = [{time_s = 2, position_m = 0}, {time_s = 1, position_m = 1}]"),
                 {"targets", "time_s"}},
        BadInput{"NegativeNodeId",
                 sound + "[loop]\nperiod_s=0.001\n" + with(drive, "[drive]", "[drive]\nnode_id = -1"),
                 {"node_id", "-1", "[1, 127]"}},
        BadInput{"StartBeyondTheCount",
                 with(sound, "mass_kg = 1", "mass_kg = 1\nposition_m = -2148") + "[loop]\nperiod_s=0.001\n" + drive,
                 {"[plant] position_m = -2148", "is 2148 m from", "1e-06", "begin nearer"}},
        BadInput{"StartBeyondTheCountFromItsTarget",
                 with(with(sound, "mass_kg = 1", "mass_kg = 1\nposition_m = -1100"), "[controller]",
                      "[controller]\ntarget_m = 1100") +
                     "[loop]\nperiod_s=0.001\n" + drive,
                 {"[plant] position_m = -1100", "is 2200 m from", "begin nearer"}},
        BadInput{"SyntaxError", with(sound, "mass_kg = 1", "mass_kg = = 1"), {":3:", "TOML"}},
        BadInput{"KeyTwice", with(sound, "mass_kg = 1", "mass_kg = 1\nmass_kg = 2"), {":4:", "TOML"}}),
    [](const auto& row) { return std::string{row.param.label}; });

std::string file_text(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream{path}.rdbuf();
  return text.str();
}

// Every line "key = value" of every scenario of the project, spoilt in each of these ways.
TEST(ReadScenario, NamesEveryKeyThatIsSpoilt) {
  int spoilt = 0;
  for (const auto& entry : std::filesystem::directory_iterator{BREAKAWAY_SOURCE_DIR "/sim/scenarios"}) {
    const std::string text = file_text(entry.path());
    std::istringstream lines{text};
    for (std::string line; std::getline(lines, line);) {
      const auto equals = line.find(" = ");
      if (line.starts_with('#') || line.starts_with('[') || equals == std::string::npos) continue;
      const std::string key = line.substr(0, equals);
      const char first = line[equals + 3];
      if (first == '{') continue;  // a table, of which every key may be optional
      const bool is_text = first == '"';
      for (const std::string& other : {key + "x" + line.substr(equals), key + " = nan", key + " = {}", key + " = [[]]",
                                       key + (is_text ? " = 1" : " = \"1\""), key + " = 1979-05-27"}) {
        const std::string message = refusal(with(text, '\n' + line + '\n', '\n' + other + '\n'));
        EXPECT_TRUE(message.starts_with("axis.toml:")) << other << ": " << message;
        EXPECT_NE(message.find(key), std::string::npos) << other << ": " << message;
        ++spoilt;
      }
    }
  }
  EXPECT_GT(spoilt, 200);
}

// Certificate and simulation each know how late a drive answers that no file says more of.
TEST(ReadScenario, HasADriveAnswerAsLateAsItsCertificateCounts) {
  EXPECT_DOUBLE_EQ(breakaway::hal::seconds(breakaway::drive_emulator::EmulatorConfig{}.max_tpdo_delay),
                   breakaway::config::usual_feedback_delay_s);
}

TEST(ReadScenario, RefusesAFileThatIsNotThere) {
  EXPECT_THROW(read_scenario("/nowhere/axis.toml"), InputError);
  EXPECT_THROW(read_scenario(std::filesystem::temp_directory_path()), InputError);
}

TEST(ReadScenario, TakesCharactersBeyondAsciiInStringsAndComments) {
  const std::string title = "title = \"Schlitten \\\" \u00b5 # gr\u00f6\u00dfer\" # \u00b5 'm\n";
  EXPECT_EQ(parse_scenario("\xEF\xBB\xBF" + title + sound, "axis.toml").node.title,
            "Schlitten \" \u00b5 # gr\u00f6\u00dfer");
}

TEST(ReadScenario, ShowsThatANumberWithAPointIsNoInteger) {
  const std::string seeded =
      with(sound, "upper_N = 4.5", "upper_N = 4.5\nlaw = { kind = \"random_dwell\", seed = 1.0 }");
  EXPECT_NE(refusal(seeded).find("seed is 1.0, must be an integer in [0, "), std::string::npos) << refusal(seeded);
  const std::string large = refusal(with(seeded, "seed = 1.0", "seed = 1e300"));
  EXPECT_NE(large.find("seed is 1e+300, must be"), std::string::npos) << large;
}

// They make a table in a table, for each of which the parser called itself: the stack had no room for so many.
TEST(ReadScenario, RefusesKeysOfMorePartsThanAnyTableHas) {
  std::string deep = "a";
  for (int i = 0; i < 100'000; ++i) deep += ".a";
  const std::string quoted = "\"" + deep + "\"";
  std::string parts = quoted;
  for (int i = 0; i < 100; ++i) parts += " . " + quoted;
  for (const std::string& line : {deep + " = 1", "[" + deep + "]", "[[" + deep + "]]", "x = { " + deep + " = 1 }",
                                  parts + " = 1", "x = \"\"\"\n\\\"\"\"\"\"\n" + deep + " = 1"}) {
    const std::string said = refusal("# 1.\n\n" + line + "\n" + sound);
    const auto expected =
        "axis.toml:" + std::to_string(line.starts_with("x = \"") ? 5 : 3) + ": a key has more than 32";
    EXPECT_TRUE(said.starts_with(expected)) << said.substr(0, 200);
  }
  const std::string dots(100, '.');
  for (const std::string& title :
       {"\"" + dots + "\\\"" + dots + "\" # \"" + dots, "'" + dots + "\\' # '" + dots,
        "\"\"\"\n" + dots + "\"\"" + dots + "\"\"\"\"\"", "'''" + dots + "''" + dots + "'''"})
    EXPECT_EQ(refusal("title = " + title + "\n" + sound), "accepted");
}

const breakaway::config::Friction& friction(const Scenario& s) { return s.node.axes.front().friction; }

TEST(ReadScenario, TakesCoefficientsOrNewtons) {
  const Scenario newtons = parse_scenario(sound, "");
  const Scenario coefficients = parse_scenario(
      with(with(sound, "lower_N = 2.5", "gravity_m_s2 = 10\nmu_lower = 0.25"), "upper_N = 4.5", "mu_upper = 0.45"), "");
  EXPECT_DOUBLE_EQ(friction(coefficients).bounds.lower_N, friction(newtons).bounds.lower_N);
  EXPECT_DOUBLE_EQ(friction(coefficients).bounds.upper_N, friction(newtons).bounds.upper_N);
  EXPECT_FALSE(friction(newtons).normal_force_N.has_value());
  const std::string none = refusal(
      with(with(sound, "lower_N = 2.5", "gravity_m_s2 = 5e-324\nmu_lower = 0.25"), "upper_N = 4.5", "mu_upper = 0.45"));
  EXPECT_NE(none.find("[friction] mu_lower times [plant] mass_kg times gravity_m_s2 is 0 N, must be above 0 N"),
            std::string::npos)
      << none;
}

TEST(ReadScenario, ReadsTheExamplesFrictionLaw) {
  const Scenario s = read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/impulsive_example.toml");
  const auto mu = [](double t, double v) { return 0.1 / (1 + 0.5 * v) + 0.3 + 0.05 * std::sin(4 * t); };
  for (const double t : {0.0, 0.3, 2.0}) {
    for (const double v : {0.0, 0.5, 7.0})
      EXPECT_NEAR(s.worlds.front().friction.level_N(t, 0, v), 10 * mu(t, v), 1e-14);
  }
}

TEST(ReadScenario, NamesOnlyThePartsThatTheFileNames) {
  const Scenario ideal = parse_scenario(sound, "");
  EXPECT_TRUE(ideal.ideal());
  EXPECT_FALSE(ideal.node.axes.front().drive || ideal.worlds.front().drive || ideal.bus);
  const Scenario bus = parse_scenario(sound + "[loop]\nperiod_s = 0.001\n" + drive, "");
  const breakaway::config::Axis& axis = bus.node.axes.front();
  EXPECT_TRUE(bus.node.loop && axis.drive && bus.worlds.front().drive && bus.bus);
  EXPECT_EQ(axis.drive->rated_torque_mNm, 1000u);
  EXPECT_EQ(axis.controller.impulsive->kick, breakaway::config::Kick::two_phase);
}

TEST(ReadScenario, AcceptsEveryScenarioOfTheProject) {
  for (const auto& entry : std::filesystem::directory_iterator{BREAKAWAY_SOURCE_DIR "/sim/scenarios"}) {
    EXPECT_NO_THROW(read_any_scenario(entry.path())) << entry.path();
  }
}

TEST(ReadScenario, EveryQuirkOfTheEmulatedDriveCanBeSet) {
  using breakaway::drive_emulator::Quirks;
  const auto quirks_of = [](const std::string& line) {
    return parse_scenario(
               sound + "[loop]\nperiod_s=0.001\n[bus]\nbit_rate=1_000_000\n" + drive + "[drive.quirks]\n" + line + "\n",
               "axis.toml")
        .worlds.front()
        .drive->quirks;
  };
  EXPECT_EQ(quirks_of("mode_display_delay_s = 0.5").mode_display_delay, std::chrono::milliseconds{500});
  EXPECT_EQ(quirks_of("sdo_response_delay_s = 1").sdo_response_delay, std::chrono::seconds{1});
  EXPECT_EQ(quirks_of("sdo_busy_s = 2").sdo_busy, std::chrono::seconds{2});
  EXPECT_EQ(quirks_of("min_controlword_interval_s = 0.002").min_controlword_interval, std::chrono::milliseconds{2});
  EXPECT_EQ(quirks_of("sync_alarm_periods = 2").sync_alarm_periods, 2U);
  EXPECT_EQ(quirks_of("position_range_counts = 131072").position_range_counts, 131072U);
  EXPECT_EQ(quirks_of("refuses_start_with = 0x6100").refuses_start_with, 0x6100);
  EXPECT_EQ(quirks_of("informs_with = 0xFF01").informs_with, 0xFF01);
  EXPECT_EQ(quirks_of("informs_every_s = 0.005").informs_every, std::chrono::milliseconds{5});
  EXPECT_EQ(quirks_of("homing_gives_up_after_s = 3").homing_gives_up_after, std::chrono::seconds{3});
  EXPECT_EQ(quirks_of("fixed_mapping = \"fits\"").fixed_mapping, breakaway::drive_emulator::FixedMapping::fits);
  const Quirks refusing = quirks_of("refused_objects = [0x1006, 0x60B2]\nrefusal_code = 0x05040001");
  EXPECT_EQ(refusing.refused_objects, (std::vector<double>{0x1006, 0x60B2}));
  EXPECT_EQ(refusing.refusal_code, 0x05040001U);
  EXPECT_FALSE(quirks_of("").switches);
  EXPECT_EQ(quirks_of("low_limit_switch_m = -0.3").switches.value().low_limit_m, -0.3);
  EXPECT_EQ(quirks_of("high_limit_switch_m = 0.3").switches.value().high_limit_m, 0.3);
  EXPECT_EQ(quirks_of("home_switch_m = 0.1").switches.value().home_m, 0.1);
  EXPECT_EQ(quirks_of("home_switch_width_m = 0.03").switches.value().home_width_m, 0.03);
  EXPECT_EQ(quirks_of("index_distance_m = 0.01").switches.value().index_distance_m, 0.01);
  EXPECT_EQ(quirks_of("speed_gain_Ns_per_m = 70").switches.value().speed_gain_Ns_per_m, 70);
  struct Switch {
    const char* key;
    bool Quirks::*member;
  };
  for (const auto& [key, member] :
       {Switch{"needs_mode_to_enable", &Quirks::needs_mode_to_enable},
        Switch{"torque_relative_to_max", &Quirks::torque_relative_to_max},
        Switch{"interpolation_in_ms_only", &Quirks::interpolation_in_ms_only},
        Switch{"position_reversed", &Quirks::position_reversed}, Switch{"self_starting", &Quirks::self_starting},
        Switch{"maps_in_pre_operational_only", &Quirks::maps_in_pre_operational_only},
        Switch{"no_boot_up_message", &Quirks::no_boot_up_message},
        Switch{"counts_from_power_on", &Quirks::counts_from_power_on}}) {
    EXPECT_FALSE(quirks_of("").*member) << key;
    EXPECT_TRUE(quirks_of(std::string{key} + " = true").*member) << key;
  }
}

}  // namespace
