// A certificate takes in everything that a file says, or is refused.
#include <gtest/gtest.h>

#include <fstream>
#include <initializer_list>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/certificate_keys.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "two_axes.hpp"

namespace breakaway::config {
namespace {

using breakaway::testing::refusal;
using testing::with;

// Every table of an axis, with a line that more can be put behind.
const std::string scene = R"(
[loop]
period_s = 0.001
[bus]
bit_rate = 1_000_000
[plant]
mass_kg = 1
[friction]
lower_N = 2.5
upper_N = 4.5
[told]
[uncertainty]
mass = 0.02
force_gain = 0.02
force_N = 0.3
current_loop_time_constant = 0.2
[controller]
k1_N_per_m = 400
k21_Ns_per_m = 32
k22_Ns_per_m = 60
kick = "two_phase"
coast = "brake"
max_force_N = 48
max_approach_speed_m_s = 5
position_tolerance_m = 5e-6
target_m = 0
[limits]
position_m = 1
speed_m_s = 20
force_N = 60
following_error_m = 2
[move]
distance_m = 0.4
speed_m_s = 1
acceleration_m_s2 = 20
jerk_m_s3 = 2000
[drive]
rated_torque_Nm = 0.5
max_torque_per_mille = 2000
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
current_loop_time_constant_s = 1e-4
[run]
duration_s = 1
)";

std::string joined(std::initializer_list<std::string_view> parts) {
  std::string all;
  for (const std::string_view part : parts) all += part;
  return all;
}

// More lines in a table.
std::string more(const std::string& table, const std::string& lines, const std::string& text = scene) {
  return with(text, joined({table, "\n"}), joined({table, "\n", lines, "\n"}));
}

std::string under_pd(std::string text = scene) {
  text = with(text, "coast = \"brake\"", "coast = \"pd\"");
  const auto move = text.find("[move]");
  text.erase(move, text.find("[drive]") - move);
  for (const char* line :
       {"mass = 0.02\n", "force_gain = 0.02\n", "force_N = 0.3\n", "current_loop_time_constant = 0.2\n"})
    text = with(text, line, "");
  return text;
}

// Why the axis is not certified; empty where it is. The simulation must be able to read what the node reads.
std::string why_not(const std::string& text) {
  const Node node = scenario::parse_scenario(text, "axis.toml").node;
  const Node alone = parse_node(text, "axis.toml");
  const auto report = examine(node).front();
  EXPECT_EQ(report.reasons, examine(alone).front().reasons);
  return report.certified ? "" : report.reasons.front();
}

void expect_refused(const std::string& text, const std::string& named) {
  EXPECT_NE(why_not(text).find(named), std::string::npos) << named << ": " << why_not(text);
}

TEST(Certificate, IsGivenToTheSceneThatTheseTestsSpoil) {
  EXPECT_EQ(why_not(scene), "");
  EXPECT_EQ(why_not(under_pd()), "");
}

TEST(Certificate, RefusesByNameWhatIsNoRigidAxisOnFrictionThatHolds) {
  const std::string load = "load = { mass_kg = 1, stiffness_N_per_m = 1e6 }";
  for (const std::string& text : {scene, under_pd()}) {
    expect_refused(more("[plant]", load, text), "[plant] load: ");
    expect_refused(more("[plant]", joined({load, "\nbacklash = { gap_m = 1e-5 }"}), text), "[plant] backlash: ");
    expect_refused(more("[plant]", "presliding = { stiffness_N_per_m = 1e7 }", text), "[plant] presliding: ");
    expect_refused(more("[plant]", "encoder_error = { noise_m = 1e-7 }", text), "[plant] encoder_error: ");
    EXPECT_EQ(why_not(more("[plant]", "encoder_error = { noise_m = 0 }", text)), "");
  }
}

// Motor and load of 0.4 and 0.6 kg, which the controller takes for one.
std::string with_load(const std::string& stiffness_N_per_m, const std::string& friction) {
  std::string text = with(scene, "mass_kg = 1", "mass_kg = 0.4");
  text = with(text, "lower_N = 2.5\nupper_N = 4.5", "lower_N = 1.3\nupper_N = 2.4");
  text = more("[told]", "mass_kg = 1\nfriction_lower_N = 2.5\nfriction_upper_N = 4.5", text);
  const auto move = text.find("[move]");
  text.erase(move, text.find("[drive]") - move);
  return more("[plant]", joined({"load = { mass_kg = 0.6, stiffness_N_per_m = ", stiffness_N_per_m, friction, " }"}),
              text);
}

TEST(Certificate, TakesALoadInThatResonatesFastEnough) {
  const std::string friction = ", friction_lower_N = 1.2, friction_upper_N = 2.1";
  EXPECT_EQ(why_not(with_load("2e8", friction)), "");
  expect_refused(with_load("1e6", friction), "the load resonates at 324.874 Hz");
  expect_refused(with_load("1e6", friction), "is safe from ");
  expect_refused(with_load("2e8", ""), "[plant] load: without friction of its own");
  expect_refused(with(with_load("2e8", friction), "mass_kg = 1\n", "mass_kg = 0.7\n"),
                 "[told] mass_kg = 0.7 is truly 1");
  expect_refused(with(with_load("2e8", friction), "friction_lower_N = 2.5", "friction_lower_N = 2.6"),
                 "friction may be between 2.5 and 4.5 N");
}

TEST(Certificate, OfTheCoastWorkTakesALoadAndItsBacklashIn) {
  const std::string friction = ", friction_lower_N = 1.2, friction_upper_N = 2.1";
  const auto by_work = [](const std::string& text) {
    return with(with(text, "coast = \"brake\"", "coast = \"work\""), "tolerance_m = 5e-6", "tolerance_m = 2e-3");
  };
  const std::string belt = by_work(with_load("3.4e4", friction));
  EXPECT_EQ(why_not(belt), "");
  EXPECT_EQ(why_not(more("[plant]", "backlash = { gap_m = 1e-5 }", belt)), "");
  expect_refused(with_load("3.4e4", friction), "take coast = \"work\"");
  expect_refused(by_work(with_load("3.4e4", friction + ", encoder = \"load\"")), "encoder_is_on_the_motor");
  expect_refused(by_work(with_load("3.4e4", "")), "[plant] load: without friction of its own");
  expect_refused(by_work(with_load("2e7", friction)), "swing_is_sampled");
  expect_refused(with(belt, "tolerance_m = 2e-3", "tolerance_m = 1e-4"), "tolerance_above_floor");
  expect_refused(more("[uncertainty]", "encoder_noise_m = 1e-6", belt), "work_keeps_time");
  expect_refused(with(belt, "mass = 0.02", "mass = 0.2"), "masses_and_gain_are_known");
  const std::string rigid = with(under_pd(), "coast = \"pd\"", "coast = \"work\"");
  expect_refused(rigid, "[controller] coast = \"work\" is for a load on a spring");
}

TEST(Certificate, OfTheCoastWorkIsWrittenAsItIsFlashed) {
  const Node node = parse_node(with(with(with_load("3.4e4", ", friction_lower_N = 1.2, friction_upper_N = 2.1"),
                                         "coast = \"brake\"", "coast = \"work\""),
                                    "tolerance_m = 5e-6", "tolerance_m = 2e-3"),
                               "axis.toml");
  ASSERT_TRUE(is_by_work(node));
  const auto reports = examine(node);
  const WorkNode<float> flashed = certified_by_work(node, reports);
  const auto design = design::design_work_kicks<float>(braked_class(node, node.axes[0]));
  EXPECT_EQ(flashed.axes[0].kicks.table.entries[3].a0, design.kicks.table.entries[3].a0);
  EXPECT_TRUE(flashed.axes[0].kicks.metered);
  const std::string header = node_header(flashed, node, reports);
  EXPECT_NE(header.find("FlashedNode<float, 1, law::WorkKicks<float>> node"), std::string::npos);
  EXPECT_NE(header.find("law::Coast::work"), std::string::npos);
  WorkNode<float> spoiled = flashed;
  spoiled.axes[0].kicks.spring_m += 1e-6F;
  EXPECT_EQ(firmware::verify(spoiled).error, firmware::NodeError::checksum_differs);
  spoiled.axes[0].kicks.table.count = 0;
  spoiled.checksum = checksum_of(spoiled);
  EXPECT_EQ(firmware::verify(spoiled).error, firmware::NodeError::law_invalid);
  spoiled = flashed;
  spoiled.axes[0].law.coast = law::Coast::brake;
  spoiled.checksum = checksum_of(spoiled);
  EXPECT_EQ(firmware::verify(spoiled).error, firmware::NodeError::law_invalid) << "its kicks are of another coast";
}

// Without limits of a move, which are certified for a loop without jitter only.
TEST(Certificate, TakesNoiseAndJitterInUpToTheStatedBounds) {
  std::string still = scene;
  const auto move = still.find("[move]");
  still.erase(move, still.find("[drive]") - move);
  still = with(still, "position_tolerance_m = 5e-6", "position_tolerance_m = 5e-5");
  const std::string noisy = more("[uncertainty]", "encoder_noise_m = 1e-6", still);
  EXPECT_EQ(why_not(more("[plant]", "encoder_error = { noise_m = 1.6e-7 }", noisy)), "");
  expect_refused(more("[plant]", "encoder_error = { noise_m = 1.7e-7 }", noisy), "[uncertainty] encoder_noise_m");
  const std::string shaken = more("[uncertainty]", "jitter_s = 1e-4", still);
  EXPECT_EQ(why_not(more("[bus]", "delay_max_s = 1e-4", shaken)), "");
  expect_refused(more("[bus]", "delay_max_s = 1.1e-4", shaken), "jitter_s = 0.0001 is less");
  expect_refused(more("[uncertainty]", "jitter_s = 1e-4"), "move_keeps_time");
  EXPECT_NE(refusal([&] {
              parse_node(more("[uncertainty]", "jitter_s = 6e-4", still), "axis.toml");
            }).find("more than half the period"),
            std::string::npos);
}

// Bristles of 1e7 N/m on an axis that is told of at least this stiffness.
std::string bending(const std::string& told, const std::string& plant = "presliding = { stiffness_N_per_m = 1e7 }") {
  const std::string key = told.empty() ? "" : joined({"presliding_stiffness_N_per_m = ", told});
  const std::string stiff = more("[friction]", key, more("[plant]", plant));
  return with(stiff, "force_N = 0.3\n", "force_N = 0.2\n");
}

TEST(Certificate, TakesInFrictionThatBendsWhereItIsToldHowStiffItIsAtLeast) {
  EXPECT_EQ(why_not(bending("1e7")), "");
  EXPECT_EQ(why_not(bending("1e6")), "");
  EXPECT_EQ(why_not(bending("1e7", "")), "") << "what holds at once is stiffer than any bound";
  expect_refused(bending(""), "state [friction] presliding_stiffness_N_per_m = 1e+07");
  expect_refused(bending("1.1e7"), "is below [friction] presliding_stiffness_N_per_m = 1.1e+07; lower that");
  expect_refused(bending("1e7", "presliding = { stiffness_N_per_m = 1e7, damping_Ns_per_m = 6400 }"),
                 "damping_Ns_per_m = 6400 is above");
}

TEST(Certificate, NamesWhatIsSimulatedButNotCertifiedOfFrictionThatBends) {
  expect_refused(bending("6e4"), "bending_is_few_counts");
  const std::string lag = "current_loop_time_constant_s = ";
  const std::string wide = with(bending("1e7"), "position_tolerance_m = 5e-6", "position_tolerance_m = 8e-6");
  expect_refused(with(wide, joined({lag, "1e-4"}), joined({lag, "3e-4"})), "bending_loop_is_fast");
  expect_refused(with(bending("1e7"), "force_N = 0.2\n", "force_N = 0.3\n"), "bending_load_is_small");
  expect_refused(with(bending("1e7"), "upper_N = 4.5", "upper_N = 3"), "bending_bounds_are_apart");
}

TEST(Certificate, PromisesTheFloorAndNotTheToleranceUnderTheFineStage) {
  const std::string below = with(scene, "position_tolerance_m = 5e-6", "position_tolerance_m = 1e-6");
  expect_refused(below, "tolerance_above_floor");
  const std::string fine = more("[run]", "settle_tolerance_m = 9e-6", below);
  EXPECT_EQ(why_not(fine), "");
  expect_refused(more("[controller]", "fine_stage = false", fine), "tolerance_above_floor");
  expect_refused(more("[run]", "settle_tolerance_m = 3e-6", below), "tolerance_above_floor");
  const auto promise = *examine(parse_node(fine, "axis.toml")).front().braked;
  EXPECT_DOUBLE_EQ(promise.error_m, promise.least_tolerance_m + 0.5e-6);
  EXPECT_DOUBLE_EQ(promise.beyond_m, 1.35 * promise.least_tolerance_m + 0.5e-6);
}

TEST(Certificate, RefusesAFineStageUnderTheCoastPd) {
  const std::string error =
      refusal([&] { parse_node(more("[controller]", "fine_stage = false", under_pd()), "a.toml"); });
  EXPECT_NE(error.find("fine_stage"), std::string::npos) << error;
  EXPECT_NE(error.find("set coast = \"brake\""), std::string::npos) << error;
}

TEST(Certificate, RefusesToTellTheCoastPdOfFrictionThatBends) {
  const std::string text = more("[friction]", "presliding_stiffness_N_per_m = 1e7", under_pd());
  const std::string error = refusal([&] { parse_node(text, "axis.toml"); });
  EXPECT_NE(error.find("set [controller] coast = \"brake\""), std::string::npos) << error;
}

std::string without_move() {
  std::string text = scene;
  const auto move = text.find("[move]");
  return text.erase(move, text.find("[drive]") - move);
}

TEST(Certificate, IsRefusedWhereTheApproachMayNotBeFastEnoughToGetOn) {
  const std::string text = without_move(), slow = with(text, "approach_speed_m_s = 5", "approach_speed_m_s = 0.005");
  EXPECT_EQ(why_not(text), "");
  expect_refused(slow, "approach_gets_on");
}

TEST(Certificate, TakesForcesBesideTheDrivesInUnderTheBrakeUpToTheStatedBound) {
  EXPECT_EQ(why_not(more("[plant]", "force_N = -0.3")), "");
  expect_refused(more("[plant]", "force_N = -0.31"), "raise that");
  EXPECT_EQ(why_not(more("[plant]", "force_N = 0.1\ncogging = { amplitude_N = 0.2, period_m = 1e-3 }")), "");
  expect_refused(more("[plant]", "force_N = 0.1\ncogging = { amplitude_N = 0.21, period_m = 1e-3 }"), "0.31 N act");
  EXPECT_EQ(why_not(more("[plant]", "ripple = { share = 0.006, period_m = 1e-3 }")), "");
  expect_refused(more("[plant]", "ripple = { share = 0.007, period_m = 1e-3 }"), "0.336 N act");
  expect_refused(more("[plant]", "force_N = 0.01", under_pd()), "the coast \"pd\" knows nothing");
}

TEST(Certificate, CountsWhatTheFeedforwardLeavesOfAKnownForce) {
  const std::string weight = more("[plant]", "force_N = -2");
  expect_refused(weight, "2 N act");
  // The force gain is off by as much as [uncertainty] says, and so is what is given against the weight.
  EXPECT_EQ(why_not(more("[controller]", "feedforward_N = 2", weight)), "");
  EXPECT_EQ(why_not(more("[controller]", "feedforward_N = 1.8", weight)), "");
  expect_refused(more("[controller]", "feedforward_N = 1.7", weight), "0.334 N act");
  expect_refused(more("[controller]", "feedforward_N = -2", weight), "4.04 N act");
  const std::string exact = more("[plant]", "force_N = -2", under_pd());
  EXPECT_EQ(why_not(more("[controller]", "feedforward_N = 2", exact)), "");
  expect_refused(more("[controller]", "feedforward_N = 2.03", exact), "0.025 N act");
}

TEST(Certificate, HoldsFrictionAgainstTheBoundsThatTheControllerIsTold) {
  const std::string drift = more("[plant]", "drift = { share = 0.1, period_s = 3 }");
  expect_refused(drift, "friction may be between 2.25 and 4.95 N");
  EXPECT_EQ(why_not(more("[told]", "friction_lower_N = 2.25\nfriction_upper_N = 4.95", drift)), "");
  expect_refused(more("[told]", "friction_lower_N = 2.6"), "outside the 2.6 to 4.5 N");
}

TEST(Certificate, HoldsWhatIsToldAgainstTheTruth) {
  EXPECT_EQ(why_not(more("[told]", "mass_kg = 1.01")), "");
  expect_refused(more("[told]", "mass_kg = 1.03"), "[told] mass_kg = 1.03 is truly 1");
  EXPECT_EQ(why_not(more("[told]", "force_gain = 0.99")), "");
  expect_refused(more("[told]", "force_gain = 1.05"), "[told] force_gain = 1");
  expect_refused(more("[told]", "latency_periods = 2"), "[told] latency_periods = 2");
  expect_refused(more("[told]", "mass_kg = 1.001", under_pd()), "nothing allows for that");
}

TEST(Certificate, OfTheCoastPdRefusesFrictionThatRisesWithSpeedUnlessItsSlopeIsStated) {
  const std::string rising = "law = { kind = \"complement\", part = { kind = \"stribeck\", velocity_m_s = 0.5 } }";
  expect_refused(more("[friction]", rising, under_pd()), "by 4 N s/m at its steepest");
  EXPECT_EQ(why_not(more("[friction]", joined({rising, "\nsmooth_slope_Ns_per_m = 4"}), under_pd())), "");
  EXPECT_EQ(why_not(more("[friction]", rising)), "") << "under the brake friction is free inside its bounds";
  const std::string falling =
      "law = { kind = \"mean\", parts = [{ kind = \"stribeck\", velocity_m_s = 2 }, { kind = "
      "\"sine_in_time\", angular_frequency_rad_s = 4 }] }";
  EXPECT_EQ(why_not(more("[friction]", falling, under_pd())), "");
  const std::string jump = "law = { kind = \"static_kinetic\", static_value = 0, kinetic_value = 1 }";
  expect_refused(more("[friction]", jump, under_pd()), "rises with speed");
  expect_refused(more("[friction]", "smooth_slope_Ns_per_m = 4"), "the coast \"brake\" does not know");
}

TEST(Certificate, RefusesKeysThatTheCoastIgnores) {
  expect_refused(more("[uncertainty]", "mass = 0.01", under_pd()), "[uncertainty] is stated");
  for (const std::string& text : {scene, under_pd()})
    expect_refused(with(text, "\"two_phase\"", "\"naive\""), "kick = \"naive\"");
}

TEST(Certificate, RefusesABusThatMakesKicksLongerOrReadingsLate) {
  expect_refused(more("[bus]", "loss_probability = 0.001"), "loss_probability");
  expect_refused(more("[bus]", "delay_max_s = 1e-5"), "[uncertainty] jitter_s = 0 is less");
  expect_refused(more("[bus]", "delay_max_s = 1e-5", under_pd()), "delay_max_s");
  EXPECT_EQ(why_not(more("[bus]", "delay_min_s = 1e-5\ndelay_max_s = 1e-5")), "");
  EXPECT_EQ(why_not(more("[drive]", "tpdo_delay_max_s = 4e-4")), "");
  expect_refused(more("[drive]", "tpdo_delay_max_s = 9e-4"), "too late for its period");
}

TEST(Certificate, RefusesMovesThatTheAxisOrItsLimitsCannotTake) {
  expect_refused(with(scene, "acceleration_m_s2 = 20", "acceleration_m_s2 = 4"), "move_can_be_made");
  expect_refused(with(scene, "jerk_m_s3 = 2000", "jerk_m_s3 = 5000"), "jerk_can_be_followed");
  const auto message = [](const std::string& from, const std::string& to) {
    return refusal([&] { examine(parse_node(with(scene, from, to), "axis.toml")); });
  };
  EXPECT_NE(message("distance_m = 0.4", "distance_m = 3").find("between the [limits]"), std::string::npos);
  EXPECT_NE(message("target_m = 0", "target_m = 0.99999").find("keep targets between"), std::string::npos);
  const std::string narrow = with(with(scene, "max_approach_speed_m_s = 5\n", ""), "speed_m_s = 20", "speed_m_s = 1");
  EXPECT_NE(refusal([&] { parse_node(narrow, "axis.toml"); }).find("less than 1 % above"), std::string::npos);
  EXPECT_NE(refusal([&] { parse_node(with(scene, "\"brake\"", "\"pd\""), "axis.toml"); }).find("is for the coast"),
            std::string::npos);
}

std::string source(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream{BREAKAWAY_SOURCE_DIR "/" + file}.rdbuf();
  return text.str();
}

TEST(Certificate, KnowsEveryKeyThatAReaderOfAxesKnows) {
  std::string text;
  for (const char* file :
       {"firmware/config/src/axis_tables.cpp", "firmware/config/src/read_node.cpp", "firmware/config/src/read_told.cpp",
        "firmware/config/src/wiring.cpp", "sim/scenario/src/read_scenario.cpp", "sim/scenario/src/read_quirks.cpp"})
    text += source(file);
  std::set<std::string, std::less<>> known;
  for (const CertificateKey& key : certificate_keys()) {
    known.emplace(key.key);
    EXPECT_NE(text.find(joined({"\"", key.key, "\""})), std::string::npos) << key.key << " is no key any more";
    EXPECT_EQ(key.standing == Standing::refused, !key.remedy.empty()) << key.key;
  }
  const std::regex row{R"re((?:optional|required|keep_table)\(\s*"(\w+)")re"};
  int rows = 0;
  for (std::sregex_iterator match{text.begin(), text.end(), row}, end; match != end; ++match, ++rows)
    EXPECT_TRUE(known.contains((*match)[1].str())) << (*match)[1] << ": say where the certificate stands to it";
  EXPECT_GE(rows, 60);
}

// Everything that is certified of an axis, or why nothing is.
std::string certificate(const std::string& text) {
  std::ostringstream out;
  out.precision(12);
  const std::string error = refusal([&] {
    const Node node = parse_node(text, "axis.toml");
    const design::DesignReport report = examine(node).front();
    for (const design::Check& check : report.checks) out << check.name << check.holds << check.margin << check.reason;
    for (const std::string& condition : report.conditions) out << condition;
    if (report.braked)
      out << report.braked->promise << report.braked->peak_speed_m_s << report.braked->hand_over_m
          << report.braked->least_move_s;
  });
  return error + out.str();
}

TEST(Certificate, ChangesWithEachKeyThatItCountsWith) {
  const std::map<std::string, std::pair<std::string, std::string>> changes{
      {"plant.mass_kg", {"mass_kg = 1\n", "mass_kg = 1.1\n"}},
      {"friction.lower_N", {"lower_N = 2.5", "lower_N = 2.4"}},
      {"friction.upper_N", {"upper_N = 4.5", "upper_N = 4.6"}},
      {"friction.mu_lower", {"lower_N = 2.5\nupper_N = 4.5", "mu_lower = 0.2\nmu_upper = 0.4\ngravity_m_s2 = 9.81"}},
      {"friction.mu_upper", {"lower_N = 2.5\nupper_N = 4.5", "mu_lower = 0.25\nmu_upper = 0.5\ngravity_m_s2 = 9.81"}},
      {"friction.gravity_m_s2", {"lower_N = 2.5\nupper_N = 4.5", "mu_lower = 0.25\nmu_upper = 0.45\ngravity_m_s2 = 9"}},
      {"friction.smooth_slope_Ns_per_m", {"lower_N = 2.5", "lower_N = 2.5\nsmooth_slope_Ns_per_m = 1"}},
      {"friction.presliding_stiffness_N_per_m", {"lower_N = 2.5", "lower_N = 2.5\npresliding_stiffness_N_per_m = 1e7"}},
      {"controller.kind", {"k1_N_per_m = 400", "kind = \"pid\"\nk1_N_per_m = 400"}},
      {"controller.k1_N_per_m", {"k1_N_per_m = 400", "k1_N_per_m = 410"}},
      {"controller.k21_Ns_per_m", {"k21_Ns_per_m = 32", "k21_Ns_per_m = 31"}},
      {"controller.k22_Ns_per_m", {"k22_Ns_per_m = 60", "k22_Ns_per_m = 61"}},
      {"controller.kick", {"\"two_phase\"", "\"naive\""}},
      {"controller.coast", {"\"brake\"", "\"pd\""}},
      {"controller.feedforward_N", {"max_force_N = 48", "max_force_N = 48\nfeedforward_N = 1"}},
      {"controller.fine_stage", {"position_tolerance_m = 1e-6", "fine_stage = false\nposition_tolerance_m = 1e-6"}},
      {"controller.max_force_N", {"max_force_N = 48", "max_force_N = 45"}},
      {"controller.max_approach_speed_m_s", {"max_approach_speed_m_s = 5", "max_approach_speed_m_s = 0.5"}},
      {"controller.position_tolerance_m", {"position_tolerance_m = 5e-6", "position_tolerance_m = 6e-6"}},
      {"controller.target_m", {"target_m = 0", "target_m = 2"}},
      {"controller.targets", {"target_m = 0", "targets = [{ time_s = 1, position_m = 2 }]"}},
      {"drive.rated_torque_Nm", {"rated_torque_Nm = 0.5", "rated_torque_Nm = 0.6"}},
      {"drive.max_torque_per_mille", {"max_torque_per_mille = 2000", "max_torque_per_mille = 1000"}},
      {"drive.force_per_torque_N_per_Nm", {"force_per_torque_N_per_Nm = 50", "force_per_torque_N_per_Nm = 55"}},
      {"drive.torque_relative_to", {"rated_torque_Nm = 0.5", "rated_torque_Nm = 0.5\ntorque_relative_to = \"max\""}},
      {"drive.peak_force_N", {"rated_torque_Nm = 0.5", "rated_torque_Nm = 0.5\npeak_force_N = 40"}},
      {"drive.encoder_resolution_m", {"resolution_m = 1e-6", "resolution_m = 2e-6"}},
      {"drive.current_loop_time_constant_s", {"constant_s = 1e-4", "constant_s = 2e-4"}},
      {"limits.position_m", {"target_m = 0\n[limits]\nposition_m = 1", "target_m = 0.9\n[limits]\nposition_m = 0.8"}},
      {"limits.position_min_m",
       {"target_m = 0\n[limits]\nposition_m = 1", "target_m = 0.9\n[limits]\nposition_min_m = 1"}},
      {"limits.position_max_m",
       {"target_m = 0\n[limits]\nposition_m = 1", "target_m = 0.9\n[limits]\nposition_max_m = 0.8"}},
      {"limits.speed_m_s", {"speed_m_s = 20", "speed_m_s = 1e-3"}},
      {"limits.force_N", {"force_N = 60", "force_N = 40"}},
      {"limits.following_error_m", {"following_error_m = 2", "following_error_m = 1e-6"}},
      {"told.mass_kg", {"[told]", "[told]\nmass_kg = 1.01"}},
      {"told.force_gain", {"[told]", "[told]\nforce_gain = 1.01"}},
      {"told.friction_lower_N", {"[told]", "[told]\nfriction_lower_N = 2.4"}},
      {"told.friction_upper_N", {"[told]", "[told]\nfriction_upper_N = 4.6"}},
      {"told.latency_periods", {"[told]", "[told]\nlatency_periods = 3"}},
      {"uncertainty.mass", {"mass = 0.02", "mass = 0.03"}},
      {"uncertainty.force_gain", {"force_gain = 0.02", "force_gain = 0.03"}},
      {"uncertainty.force_N", {"force_N = 0.3", "force_N = 0.4"}},
      {"uncertainty.current_loop_time_constant", {"constant = 0.2", "constant = 0.3"}},
      {"uncertainty.jitter_s", {"[uncertainty]", "[uncertainty]\njitter_s = 1e-5"}},
      {"uncertainty.encoder_noise_m", {"[uncertainty]", "[uncertainty]\nencoder_noise_m = 1e-6"}},
      {"move.distance_m", {"distance_m = 0.4", "distance_m = 0.3"}},
      {"move.speed_m_s", {"speed_m_s = 1\n", "speed_m_s = 0.9\n"}},
      {"move.acceleration_m_s2", {"acceleration_m_s2 = 20", "acceleration_m_s2 = 19"}},
      {"move.jerk_m_s3", {"jerk_m_s3 = 2000", "jerk_m_s3 = 1900"}},
      {"loop.period_s", {"period_s = 0.001", "period_s = 0.002"}},
      {"bus.bit_rate", {"1_000_000", "125_000"}},
      {"run.settle_tolerance_m", {"position_tolerance_m = 5e-6", "# none"}},
  };
  const std::string plain = certificate(scene);
  for (const CertificateKey& key : certificate_keys()) {
    if (key.standing != Standing::counted || key.table.empty() || key.table == "axis") continue;
    const std::string name = joined({key.table, ".", key.key});
    ASSERT_TRUE(changes.contains(name)) << name << ": say how the certificate changes with it";
    std::string text = scene;
    if (name == "run.settle_tolerance_m")
      text = with(text, "duration_s = 1", "settle_tolerance_m = 9e-6\nduration_s = 1");
    if (name == "controller.fine_stage")
      text = with(more("[run]", "settle_tolerance_m = 9e-6", text), "tolerance_m = 5e-6", "tolerance_m = 1e-6");
    const auto& [from, to] = changes.at(name);
    EXPECT_NE(certificate(with(text, from, to)), name == "controller.fine_stage" ? certificate(text) : plain) << name;
  }
}

}  // namespace
}  // namespace breakaway::config
