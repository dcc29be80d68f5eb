// Axes on one machine under their coordinator, behind emulated drives on the bus.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/machine_design.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"

namespace breakaway::sil {
namespace {

scenario::Scenario scene(const char* name) {
  return scenario::read_scenario(std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/" + name);
}

class CoordinatedScene : public ::testing::TestWithParam<const char*> {};

TEST_P(CoordinatedScene, SettlesAsItsCertificateSays) {
  const scenario::Scenario s = scene(GetParam());
  const auto certificate = config::examine_machine(s.node);
  ASSERT_TRUE(certificate.certified) << certificate.reason;
  const Result result = run_loop_scenario(s, {});
  EXPECT_TRUE(result.settled());
  std::size_t kicks = 0;
  for (const AxisResult& axis : result.axes) {
    for (const FaultRecord& fault : axis.faults)
      ADD_FAILURE() << axis.name << ": " << fault.name << " at " << fault.time_s;
    kicks += axis.kicks.size();
    for (const KickRecord& kick : axis.kicks) EXPECT_GT(kick.periods, 0) << axis.name;
  }
  EXPECT_GT(kicks, 0U);
  EXPECT_LE(kicks, certificate.most_kicks);
}

double first_kick_s(const AxisResult& axis) {
  return axis.kicks.empty() ? std::numeric_limits<double>::infinity() : axis.kicks.front().time_s;
}

// The axis that is kicked later stands until then; the other one stands from then on.
TEST_P(CoordinatedScene, NoKickMovesAnotherAxisOrGoesBeyond) {
  const scenario::Scenario s = scene(GetParam());
  const Result result = run_loop_scenario(s, {.trace = true});
  ASSERT_EQ(result.axes.size(), 2U);
  const AxisResult &one = result.axes[0], &two = result.axes[1];
  const bool one_first = first_kick_s(one) < first_kick_s(two);
  const AxisResult &first = one_first ? one : two, &second = one_first ? two : one;
  for (const AxisResult* axis : {&first, &second}) {
    ASSERT_FALSE(axis->kicks.empty());
    const double side = axis->kicks.front().error_m > 0 ? 1 : -1;
    for (const Sample& sample : axis->trace) {
      const bool stands = axis == &first ? sample.time_s > first_kick_s(second)
                                         : sample.time_s > first_kick_s(first) && sample.time_s < first_kick_s(second);
      const double stands_at_m = axis == &first ? axis->final_error_m : axis->kicks.front().error_m;
      const double error_m = sample.position_m - sample.target_m;
      if (stands) {
        EXPECT_NEAR(error_m, stands_at_m, 2e-9) << axis->name << " at " << sample.time_s << " s";
      }
      if (sample.time_s > first_kick_s(first)) {
        EXPECT_GE(error_m * side, 0) << axis->name << " at " << sample.time_s;
      }
    }
  }
}

// What a drive holds off another axis' kicks with is whole steps of its force as well.
TEST(CoordinatedMachine, SettlesWhereADriveGivesNotAllOfItsLimit) {
  std::string text = config::file_contents(BREAKAWAY_SOURCE_DIR "/sim/scenarios/coupled_gantry.toml");
  const auto replace = [&](const std::string& old, const std::string& by) {
    const auto at = text.rfind(old);
    ASSERT_NE(at, std::string::npos) << old;
    text.replace(at, old.size(), by);
  };
  replace("q = [-0.03, -0.028]", "q = [-0.01, -0.009]");
  replace("start_m = 0.03", "start_m = 0.01");
  replace("max_force_N = 100", "max_force_N = 30.9");
  replace("force_per_torque_N_per_Nm = 50", "force_per_torque_N_per_Nm = 1000");
  const scenario::Scenario s = scenario::parse_scenario(text, "coarse.toml");
  const auto certificate = config::examine_machine(s.node);
  ASSERT_TRUE(certificate.certified) << certificate.reason;
  EXPECT_EQ(certificate.axes[0].tightest.held_N, 30);
  const Result result = run_loop_scenario(s, {});
  EXPECT_TRUE(result.settled());
  for (const AxisResult& axis : result.axes) EXPECT_TRUE(axis.faults.empty()) << axis.name;
}

// As near to its limits as is certified, a machine of little damping and the least friction goes far past its targets.
TEST(CoordinatedMachine, GoesNoFurtherThanItsLimitsMustLeave) {
  std::string text = config::file_contents(BREAKAWAY_SOURCE_DIR "/sim/scenarios/coupled_gantry.toml");
  const auto replace_all = [&](const std::string& old, const std::string& by) {
    ASSERT_NE(text.find(old), std::string::npos) << old;
    for (auto at = text.find(old); at != std::string::npos; at = text.find(old, at + by.size()))
      text.replace(at, old.size(), by);
  };
  replace_all("k21_Ns_per_m = 60", "k21_Ns_per_m = 12");
  replace_all("lower_N = 8, upper_N = 12", "lower_N = 4, upper_N = 8");
  replace_all("friction_N = [9, 11]", "friction_N = [4, 4]");
  const auto limited = [&](const std::string& position_m, const std::string& error_m) {
    std::string limits = text;
    for (auto at = limits.find("position_m = 1,"); at != std::string::npos; at = limits.find("position_m = 1,"))
      limits.replace(at, 15, "position_m = " + position_m + ", following_error_m = " + error_m + ",");
    return scenario::parse_scenario(limits, "limits.toml");
  };
  const auto reason = [](const scenario::Scenario& s) { return config::examine_machine(s.node).reason; };
  EXPECT_NE(reason(limited("0.035", "0.1")).find("an approach may take it 0.043 m from there"), std::string::npos);
  EXPECT_NE(reason(limited("0.1", "0.035")).find("following_error_m is 0.035"), std::string::npos);
  const scenario::Scenario s = limited("0.043", "0.043");
  EXPECT_EQ(reason(s), "");
  const Result result = run_loop_scenario(s, {});
  EXPECT_TRUE(result.settled());
  EXPECT_GT(result.axes[0].excursions->overshoot_m, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Scenes, CoordinatedScene, ::testing::Values("coupled_gantry.toml", "two_link_arm.toml"));

}  // namespace
}  // namespace breakaway::sil
