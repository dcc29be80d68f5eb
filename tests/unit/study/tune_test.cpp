// Tuning, on axes as `breakaway new` writes them.
#include "breakaway/study/tune.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/edited_file.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/new_node.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/study/friction_study.hpp"

namespace breakaway::study {
namespace {

using breakaway::testing::refusal;

const std::string table = config::new_node({12, 15, 28, 5e-7, 2000, 200, 0.4}).text;

std::string with(const std::string& text, const std::vector<config::Setting>& settings) {
  return config::with_settings(text, "axis.toml", "", settings);
}

Tuning tuned(const std::string& text, Objective objective, bool double_limits = false, int random_laws = 4) {
  TuneOptions options;
  options.objective = objective;
  options.random_laws = random_laws;
  options.double_limits = double_limits;
  return tune(text, "axis.toml", options);
}

// What a study of the file that was written says.
StudyRow study_of(const Tuning& tuning, int random_laws = 4) {
  const scenario::Scenario s = scenario::parse_scenario(tuning.text, "tuned.toml");
  EXPECT_EQ(config::why_not_certified(s.node, s.node.axes.front()), "");
  return run_study(s, {{{-tuning.distance_m, 0}}, random_laws, 1, 0, {}}).front();
}

TEST(Tune, IsAsFastAsTheFileWasWithoutOvershoot) {
  const Tuning t = tuned(table, Objective::time, false, 100);
  EXPECT_LE(t.chosen.worst_settling_s, 0.4);
  EXPECT_LE(t.chosen.worst_settling_s, overshoot_costs * t.least_time_s);
  EXPECT_LE(t.chosen.overshoot_m, t.chosen.gains.position_tolerance_m);
  const StudyRow row = study_of(t, 100);
  EXPECT_EQ(worst_settling_time_s(row), t.chosen.worst_settling_s);
  EXPECT_EQ(worst_excursions(row).overshoot_m, t.chosen.overshoot_m);
}

TEST(Tune, ChangesNothingOfTheFileButWhatItChose) {
  const Tuning t = tuned(table, Objective::time);
  EXPECT_EQ(std::ranges::count(t.text, '\n'), std::ranges::count(table, '\n'));
  EXPECT_NE(t.text.find("# everything that moves, reflected to the axis"), std::string::npos);
  EXPECT_NE(t.text.find("encoder_resolution_m = 5e-07\n"), std::string::npos);
  EXPECT_EQ(tuned(table, Objective::time).text, t.text) << "whatever the threads did";
}

TEST(Tune, SaysWhyOfEveryNumberItChose) {
  const Tuning t = tuned(table, Objective::time);
  for (const char* key : {"coast", "max_force_N", "max_approach_speed_m_s", "position_tolerance_m"})
    EXPECT_EQ(std::ranges::count(t.numbers, key, &ChosenNumber::key), 1) << key;
  for (const ChosenNumber& number : t.numbers) EXPECT_GT(number.why.size(), 10U) << number.key;
}

TEST(Tune, GoesNoFasterThanTheFileLetsIt) {
  const Tuning t = tuned(with(table, {{"controller", "max_approach_speed_m_s", "0.8"}}), Objective::time);
  EXPECT_LE(t.chosen.gains.max_approach_speed_m_s, 0.8);
  const Tuning limited = tuned(
      with(table, {{"limits", "speed_m_s", "1"}, {"controller", "max_approach_speed_m_s", "1"}}), Objective::time);
  for (const TunedPoint& p : limited.tried) EXPECT_LE(p.gains.max_approach_speed_m_s, 1);
  const Tuning moved = tuned(
      with(table, {{"move", "distance_m", "0.3"}, {"move", "speed_m_s", "1"}, {"move", "acceleration_m_s2", "8"}}),
      Objective::time);
  EXPECT_EQ(moved.distance_m, 0.3);
  for (const TunedPoint& p : moved.tried) {
    ASSERT_TRUE(p.gains.move);
    EXPECT_LE(p.gains.move->speed_m_s, 1);
    EXPECT_LE(p.gains.move->acceleration_m_s2, 8);
  }
}

TEST(Tune, IsGentleWithTheTimeItHas) {
  const Tuning fast = tuned(table, Objective::time), gentle = tuned(table, Objective::gentle);
  EXPECT_LT(gentle.chosen.peak_force_N, 0.6 * fast.chosen.peak_force_N);
  EXPECT_LE(gentle.chosen.worst_settling_s, gentle_share * gentle.least_time_s);
  EXPECT_GE(gentle.chosen.worst_settling_s, 1.3 * gentle.least_time_s) << "less force would have done";
  EXPECT_EQ(largest_force_N(study_of(gentle)), gentle.chosen.peak_force_N);
}

TEST(Tune, KeepsTheToleranceOfTheFileUnlessAccuracyIsWanted) {
  const std::string wide = with(table, {{"run", "settle_tolerance_m", "2e-5"}});
  const Tuning fast = tuned(wide, Objective::time), accurate = tuned(wide, Objective::accuracy);
  EXPECT_NEAR(fast.chosen.gains.position_tolerance_m, 2e-5 - 2.5e-7, 1e-7);
  EXPECT_EQ(fast.chosen.gains.settle_tolerance_m, 2e-5);
  EXPECT_EQ(accurate.chosen.gains.position_tolerance_m, 3e-7);
  EXPECT_EQ(accurate.chosen.gains.settle_tolerance_m, 5.5e-7);
  EXPECT_LT(fast.chosen.worst_settling_s, accurate.chosen.worst_settling_s);
  study_of(accurate);
}

TEST(Tune, TakesTheLeastToleranceWhereThatOfTheFileCannotBeCertified) {
  const Tuning t =
      tuned(with(table, {{"run", "settle_tolerance_m", "2.6e-7"}, {"controller", "position_tolerance_m", "1e-8"}}),
            Objective::time);
  EXPECT_EQ(t.chosen.gains.position_tolerance_m, 3e-7);
  EXPECT_EQ(t.chosen.gains.settle_tolerance_m, 5.5e-7);
}

// A target between two counts is off by more than the tolerance, which says nothing of how well the axis can be tuned.
TEST(Tune, CertifiesAsMuchWhereATargetIsNoWholeCount) {
  const std::string off = with(table, {{"controller", "target_m", "0.0100002"}});
  const Tuning whole = tuned(table, Objective::accuracy), between = tuned(off, Objective::accuracy);
  EXPECT_EQ(between.chosen.gains.position_tolerance_m, whole.chosen.gains.position_tolerance_m);
  EXPECT_NEAR(between.chosen.gains.settle_tolerance_m, whole.chosen.gains.settle_tolerance_m + 2e-7, 1e-9);
}

// What settles is said of all axes of a file at once, and one of them is tuned.
TEST(Tune, LeavesTheOtherAxesOfTheFileAsTheyAre) {
  const std::string file = std::string{BREAKAWAY_SOURCE_DIR} + "/firmware/examples/two_axes.toml";
  const std::string text = config::with_settings(
      config::with_settings(config::file_contents(file), file, "y", {{"controller", "position_tolerance_m", "2e-5"}}),
      file, "x", {{"run", "settle_tolerance_m", "2.1e-5"}});
  for (const auto& [objective, tolerance_m] : {std::pair{Objective::accuracy, 1.6e-6}, {Objective::time, 2e-6}}) {
    TuneOptions options;
    options.objective = objective;
    options.axis = "x";
    options.random_laws = 4;
    options.double_limits = false;
    const Tuning t = tune(text, file, options);
    EXPECT_EQ(t.chosen.gains.position_tolerance_m, tolerance_m);
    EXPECT_EQ(t.chosen.gains.settle_tolerance_m, 2.1e-5);
    const config::Node node = config::parse_node(t.text, "tuned.toml");
    for (const config::Axis& axis : node.axes) EXPECT_EQ(config::why_not_certified(node, axis), "") << axis.name;
  }
}

TEST(Tune, WritesADurationInWhichTheAxisSettles) {
  const Tuning t = tuned(with(table, {{"run", "duration_s", "0.2"}}), Objective::time);
  EXPECT_NE(std::ranges::find(t.numbers, "duration_s", &ChosenNumber::key), t.numbers.end());
  EXPECT_EQ(worst_settling_time_s(study_of(t)), t.chosen.worst_settling_s);
  Tuning cut_short = t;
  cut_short.text = with(t.text, {{"run", "duration_s", "0.2"}});
  EXPECT_EQ(settled_runs(study_of(cut_short)), 0U);
  EXPECT_EQ(limit_cycles(study_of(cut_short)), 0U) << "an axis on its way hunts for nothing";
}

// The time of a move is counted from its last target. Where that came soon, no gains "settled", as all were tried for
// so long only as the first needed; where it came late, some were judged by one move and some by another.
TEST(Tune, JudgesTheLongestMoveWhateverTargetsFollow) {
  const Tuning one = tuned(table, Objective::time);
  for (const char* at_s : {"0.15", "0.5"}) {
    const std::string targets = std::string{"[{ time_s = "} + at_s + ", position_m = 0.001 }]";
    const std::string text = with(table, {{"controller", "targets", targets}});
    const Tuning t = tuned(text, Objective::time);
    EXPECT_EQ(t.chosen.worst_settling_s, one.chosen.worst_settling_s) << at_s;
    EXPECT_EQ(t.chosen.gains.max_approach_speed_m_s, one.chosen.gains.max_approach_speed_m_s) << at_s;
    EXPECT_NE(t.text.find(targets), std::string::npos) << t.text;
  }
}

// As `breakaway new` writes it: a short way, on which no speed of a grid of the way's own is fast enough for the
// encoder.
TEST(Tune, TriesTheGainsOfTheFileWhereNoOthersAreCertified) {
  const std::string coarse = config::new_node({4.35278, 67.704, 168.057, 1e-3, 100, 2383, 0.003109}).text;
  const Tuning t = tuned(coarse, Objective::accuracy);
  EXPECT_EQ(worst_settling_time_s(study_of(t)), t.chosen.worst_settling_s);
}

// Gains, coast and tolerances are what tuning chooses.
TEST(Tune, TunesAFileThatIsWrongOnlyInWhatItChooses) {
  const std::vector<std::vector<config::Setting>> mistakes{
      {{"controller", "k21_Ns_per_m", "1e6"}},
      {{"controller", "k22_Ns_per_m", "1"}},
      {{"controller", "k1_N_per_m", "0"}},
      {{"controller", "k1_N_per_m", "\"stiff\""}},
      {{"controller", "coast", "\"none\""}},
      {{"controller", "coast", "\"pd\""},
       {"friction", "presliding_stiffness_N_per_m", "1e9"},
       {"drive", "current_loop_time_constant_s", "5e-5"}},  // as fast as such a friction asks for
      {{"controller", "coast", "\"work\""}, {"controller", "fine_stage", "false"}},
      {{"controller", "position_tolerance_m", "1"}},
      {{"controller", "position_tolerance_m", "-1"}},
      {{"controller", "position_tolerance_m", "0"}, {"run", "settle_tolerance_m", "1e-9"}},
      {{"run", "settle_tolerance_m", "0"}}};
  for (const std::vector<config::Setting>& mistake : mistakes) {
    const std::string text = with(table, mistake);
    std::string tuned_text;
    EXPECT_EQ(refusal([&] { tuned_text = tuned(text, Objective::time, false, 0).text; }), "") << mistake.front().key;
    const scenario::Scenario s = scenario::parse_scenario(tuned_text, "tuned.toml");
    EXPECT_EQ(config::why_not_certified(s.node, s.node.axes.front()), "") << mistake.front().key;
  }
}

TEST(Tune, TunesAFileWithoutWhatItChooses) {
  std::string text = table;
  for (const char* key : {"k1_N_per_m", "k21_Ns_per_m", "k22_Ns_per_m", "coast", "position_tolerance_m"}) {
    const auto begin = text.find(std::string{"\n"}.append(key).append(" = ")) + 1;
    ASSERT_NE(begin, 0U) << key;
    text.erase(begin, text.find('\n', begin) + 1 - begin);
  }
  const Tuning t = tuned(text, Objective::time, false, 0);
  EXPECT_TRUE(t.chosen.good());
  EXPECT_NE(t.text.find("# everything that moves, reflected to the axis"), std::string::npos);
}

TEST(Tune, KeepsTheToleranceOfTheFileWhereOnlyItsGainsAreWrong) {
  const Tuning t = tuned(with(table, {{"controller", "k22_Ns_per_m", "1"}, {"run", "settle_tolerance_m", "2e-5"}}),
                         Objective::time, false, 0);
  EXPECT_EQ(t.chosen.gains.settle_tolerance_m, 2e-5);
}

TEST(Tune, RefusesAFileThatIsWrongElsewhere) {
  const auto why = [](const std::vector<config::Setting>& settings) {
    return refusal([&] { tuned(with(table, settings), Objective::time, false, 0); });
  };
  EXPECT_NE(why({{"controller", "k22_Ns_per_m", "1"}, {"plant", "mass_kg", "-1"}}).find("mass_kg"), std::string::npos);
  EXPECT_NE(why({{"controller", "max_force_N", "300"}}).find("gives 200 N at most"), std::string::npos);
}

TEST(Tune, SaysOfTheCoastWhatWasWantedOfIt) {
  const auto why = [](Objective objective) { return tuned(table, objective, false, 0).numbers.front().why; };
  EXPECT_TRUE(why(Objective::time).starts_with("certified, and the fastest that is;")) << why(Objective::time);
  EXPECT_TRUE(why(Objective::accuracy).starts_with("certified to the least tolerance")) << why(Objective::accuracy);
  EXPECT_NE(why(Objective::gentle).find("before the force is lowered"), std::string::npos) << why(Objective::gentle);
}

TEST(Tune, TunesAgainWithEachNumberTwiceAsGood) {
  const std::string slow = config::new_node({12, 15, 28, 5e-7, 1000, 200, 0.4}).text;
  const Tuning t = tuned(slow, Objective::time, true);
  ASSERT_FALSE(t.limits.empty());
  EXPECT_EQ(t.limits.front().name, "the force") << "0.4 m are mostly acceleration";
  const Tuning stronger = tuned(
      with(slow, {{"drive", "max_torque_per_mille", "2000"}, {"controller", "max_force_N", "400"}}), Objective::time);
  EXPECT_NEAR(t.limits.front().best.worst_settling_s, stronger.chosen.worst_settling_s,
              0.06 * stronger.chosen.worst_settling_s);
  const auto period = std::ranges::find(t.limits, "the period", &DoubledLimit::name);
  ASSERT_NE(period, t.limits.end());
  EXPECT_TRUE(period->why_not.empty()) << period->why_not;
  EXPECT_LT(period->least_tolerance_m, 0.5 * t.least_tolerance_m) << "the floor falls with its square";
  const Tuning accurate = tuned(slow, Objective::accuracy, true);
  EXPECT_EQ(accurate.limits.front().name, "the period");
}

TEST(Tune, NamesTheNumberThatMakesAnAxisImpossibleAndOneThatWouldDo) {
  const std::string weak =
      with(table, {{"drive", "max_torque_per_mille", "141"}, {"controller", "max_force_N", "28.2"}});
  const std::string why = refusal([&] { tuned(weak, Objective::time); });
  EXPECT_NE(why.find("max_force_N = 28.2 makes it impossible; "), std::string::npos) << why;
  constexpr std::string_view key = "[controller] max_force_N = ";
  const auto at = why.find(key);
  ASSERT_NE(at, std::string::npos) << why;
  const std::string enough = why.substr(at + key.size(), why.find(' ', at + key.size()) - at - key.size());
  const Tuning t = tuned(with(table, {{"controller", "max_force_N", enough}}), Objective::time);
  EXPECT_TRUE(t.chosen.good()) << enough;
  EXPECT_LE(std::stod(enough), 1.3 * 28.2);
}

// A certified axis that does not settle lacks time or has a fault, and no number of its own would do.
TEST(Tune, NamesNoNumberOfAnAxisThatIsCertifiedButDoesNotSettleInTime) {
  const std::string slow = with(config::new_node({1, 2.5, 4.5, 1e-6, 1000, 50, 0.1}).text,
                                {{"drive", "current_loop_time_constant_s", "0.038"}, {"run", "duration_s", "2"}});
  const std::string why = refusal([&] { tuned(slow, Objective::time); });
  EXPECT_EQ(why.find("makes it impossible"), std::string::npos) << why;
  EXPECT_NE(why.find("a longer [run] duration_s may do"), std::string::npos) << why;
}

TEST(Tune, TunesTheIdealLaw) {
  const std::string file = std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/impulsive_example.toml";
  const Tuning t = tuned(config::file_contents(file), Objective::time);
  const TunedPoint& given =
      *std::ranges::find_if(t.tried, [](const TunedPoint& p) { return p.gains.approach_damping_Ns_per_m == 0.5; });
  EXPECT_LT(t.chosen.worst_settling_s, 0.8 * given.worst_settling_s);
  EXPECT_EQ(t.chosen.gains.stiffness_N_per_m, 1);
  const scenario::Scenario s = scenario::parse_scenario(t.text, "tuned.toml");
  EXPECT_EQ(config::why_not_certified(s.node, s.node.axes.front()), "");
}

// At its greatest speed the approach swings to and fro, which was taken for a force that nobody had commanded.
TEST(Tune, FindsThatAMoveAtItsGreatestSpeedSettlesUnderEveryLaw) {
  const std::string moved = with(
      table, {{"move", "distance_m", "0.4"}, {"move", "speed_m_s", "1.92"}, {"move", "acceleration_m_s2", "12.3"}});
  const scenario::Scenario s = scenario::parse_scenario(moved, "axis.toml");
  const StudyRow row = run_study(s, {{{-0.4, 0}}, 100, 1, 0, {}}).front();
  EXPECT_EQ(settled_runs(row), row.runs.size());
  EXPECT_EQ(faulted_runs(row), 0U);
}

TEST(Tune, SaysWhatItCannotTune) {
  const auto of = [](const char* name) {
    return refusal([&] {
      tuned(config::file_contents(std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/" + name), Objective::time);
    });
  };
  EXPECT_NE(of("can_axis_pid.toml").find("kind is \"pid\""), std::string::npos);
  EXPECT_NE(of("three_axes.toml").find("--axis NAME"), std::string::npos);
  const std::string of_a_machine = of("coupled_gantry.toml");
  EXPECT_NE(of_a_machine.find("share a machine"), std::string::npos);
  EXPECT_NE(of_a_machine.find("a [machine] into a file of its own, without axes"), std::string::npos)
      << "`synthesize` refuses this file: " << of_a_machine;
}

TEST(Tune, SaysOfANumberTwiceAsGoodWhatTuningTheFileWithItSays) {
  const Tuning t = tuned(table, Objective::time, true);
  int possible = 0;
  for (const DoubledLimit& limit : t.limits) {
    if (!limit.why_not.empty()) continue;
    ++possible;
    const Tuning typed = tuned(with(table, limit.settings), Objective::time);
    EXPECT_EQ(typed.chosen.worst_settling_s, limit.best.worst_settling_s) << limit.change;
    EXPECT_EQ(typed.chosen.gains.position_tolerance_m, limit.best.gains.position_tolerance_m) << limit.change;
  }
  EXPECT_GE(possible, 3);
}

}  // namespace
}  // namespace breakaway::study
