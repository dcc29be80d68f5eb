// simulate, design and study, on scenarios with axes.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "../number_after.hpp"
#include "command.hpp"

namespace breakaway::testing {
namespace {

TEST_F(Command, TakesTheToleranceThatHoldsTheAccuracyOfAnAxis) {
  const Ended ended = run("simulate " + scenarios + "can_axis.toml --accuracy 1e-4 --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"accuracy_m", "method", "tolerance", "error_estimate_m", "refused"});
  EXPECT_LE(figure(ended.out, "error_estimate_m"), 1e-4);
  expect_refused("simulate " + scenarios + "can_axis.toml --accuracy 1e-20", {"can_axis.toml", "1e-20", "rounding"});
}

TEST_F(Command, NamesWhatAScenarioOnTheBusLacks) {
  const std::string can_axis = content(scenarios + "can_axis.toml");
  const auto without = [&](const std::string& line) {
    std::string text = can_axis;
    return scenario(text.erase(text.find(line), line.size()));
  };
  for (const char* command : {"simulate ", "study --laws 0 "}) {
    expect_refused(command + without("[run]\nduration_s = 30\nsettle_tolerance_m = 3e-6\nsettle_time_s = 0.2\n"),
                   {"axis.toml", "[run]", "missing"});
    expect_refused(command + without("[loop]\nperiod_s = 0.001\n"), {"axis.toml", "[loop]", "missing"});
  }
}

TEST_F(Command, CertifiesAndRunsAMoveWithinItsLimits) {
  const Ended design = run("design " + scenarios + "move_axis.toml --json -");
  ASSERT_EQ(design.exit_code, 0) << design.err;
  EXPECT_NEAR(figure(design.out, "least_move_s"), 0.56, 1e-9);
  const Ended motion = run("simulate " + scenarios + "move_axis.toml --json -");
  ASSERT_EQ(motion.exit_code, 0) << motion.err;
  EXPECT_LE(figure(motion.out, "peak_speed_m_s"), 1.01);
  EXPECT_GE(figure(motion.out, "peak_speed_m_s"), 0.97);
  EXPECT_LE(figure(motion.out, "settling_time_s"), 0.65) << "from 1.25 s on, with a turn on the way";
}

// The same error by `tune` and by `design` of what it wrote, in text never less than it is; under the coast "pd" it is
// not the tolerance alone. The counts have more digits than a sentence.
TEST_F(Command, SaysWhenTuningTheErrorThatDesignCertifies) {
  for (const std::string file : {"braked_axis.toml", "can_axis.toml"}) {
    std::string text = content(scenarios + file);
    const std::string count = "encoder_resolution_m = 1e-6", speed = "max_approach_speed_m_s = 5", far = "_m = -4";
    text.replace(text.find(count), count.size(), "encoder_resolution_m = 1.0486e-6");
    text.replace(text.find(speed), speed.size(), "max_approach_speed_m_s = 0.5");
    text.replace(text.find(far), far.size(), "_m = -0.1");
    text.insert(text.find("[limits]"), "[told]\nlatency_periods = 1\n");
    const std::string tuned = path("tuned_" + file), json = path("tuned_" + file + ".json");
    const Ended ended = run("tune " + scenario(text) + " --laws 0 -o " + tuned + " --json " + json);
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    const double certified_m = figure(run("design " + tuned + " --json -").out, "error_m");
    const double said_m = number_after(ended.out, "true error at rest certified ");
    EXPECT_GE(said_m, certified_m) << file;
    EXPECT_LE(said_m, 1.01 * certified_m) << file;
    EXPECT_DOUBLE_EQ(figure(content(json), "error_m"), certified_m) << file;
  }
}

TEST_F(Command, SaysHowFarAndHowFastKicksAndApproachesMayGo) {
  for (const std::string file : {"braked_axis.toml", "move_axis.toml"}) {
    const std::string text = run("design " + scenarios + file).out;
    const std::string json = run("design " + scenarios + file + " --json -").out;
    const std::string line = text.substr(std::min(text.find("\novershoot "), text.size()));
    const auto expect_at_most = [&](const std::string& words, const std::string& name) {
      const double said = number_after(line, words), known = figure(json, name);
      EXPECT_GE(said, known) << words << line.substr(0, 200);
      EXPECT_LE(said, 1.001 * known) << words << line.substr(0, 200);
    };
    expect_at_most("at most ", "beyond_m");
    expect_at_most("by a kick, and ", "approach_beyond_m");
    expect_at_most("by an approach (tested), which goes ", "approach_peak_m_s");
  }
  std::string unlimited = content(scenarios + "braked_axis.toml");
  const std::string limits = "[limits]\nposition_m = 10\nspeed_m_s = 20\n";
  unlimited.erase(unlimited.find(limits), limits.size());
  unlimited.insert(unlimited.find("max_approach_speed_m_s"), "# ");
  const std::string text = run("design " + scenario(unlimited)).out;
  EXPECT_NE(text.find("by an approach (tested)\n"), std::string::npos) << text;
}

// By the same names, of axes that set off at rest. A kick is faster than an approach that is allowed little.
TEST_F(Command, SimulatesNoMoreThanDesignPromisesByTheSameName) {
  const auto expect_no_more_than_promised = [&](const std::string& text) {
    const std::string design = run("design " + scenario(text) + " --json -").out;
    const std::string simulated = run("simulate " + scenario(text) + " --json -").out;
    for (const char* name : {"overshoot_m", "beyond_m", "peak_speed_m_s"})
      EXPECT_LE(figure(simulated, name), figure(design, name)) << name;
  };
  for (const std::string file : {"braked_axis", "can_axis"}) {
    SCOPED_TRACE(file + ", slow and near");
    const std::string slow = std::regex_replace(
        content(scenarios + file + ".toml"), std::regex{"max_approach_speed_m_s = 5"}, "max_approach_speed_m_s = 0.3");
    const std::string at_rest = std::regex_replace(slow, std::regex{"velocity_m_s = -4"}, "velocity_m_s = 0");
    expect_no_more_than_promised(std::regex_replace(at_rest, std::regex{"position_m = -4"}, "position_m = -0.01"));
  }
  for (const std::string file : {"braked_axis", "can_axis", "move_axis", "belt_axis", "fine_axis", "presliding_axis"}) {
    SCOPED_TRACE(file);
    std::string text = content(scenarios + file + ".toml");
    text = std::regex_replace(text, std::regex{"velocity_m_s = -4"}, "velocity_m_s = 0");
    expect_no_more_than_promised(text);
  }
}

TEST_F(Command, SaysHowExactHowFarAndHowLongUnderTheCoastPd) {
  const std::string text = run("design " + scenarios + "can_axis.toml").out;
  const std::string json = run("design " + scenarios + "can_axis.toml --json -").out;
  const std::string promise = text.substr(std::min(text.find("\ncoast \"pd\""), text.size()));
  for (const auto& [words, name] :
       std::initializer_list<std::pair<std::string, std::string>>{{"true error is at most ", "error_m"},
                                                                  {"overshoot             at most ", "beyond_m"},
                                                                  {"an approach goes ", "approach_peak_m_s"},
                                                                  {"m at most ", "approach_s"},
                                                                  {"first kick, and ", "kicks_s"}}) {
    const double said = number_after(promise, words), known = figure(json, name);
    EXPECT_GE(said, (1 - 1e-9) * known) << words << promise.substr(0, 400);
    EXPECT_LE(said, 1.001 * known) << words << promise.substr(0, 400);
  }
  EXPECT_EQ(number_after(promise, "time to rest          from "), figure(json, "longest_way_m"));
}

TEST_F(Command, SaysWhatLimitsTheAccuracyOfTheCoastBrake) {
  const Ended ended = run("design " + scenarios + "braked_axis.toml --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"limited_by", "least_tolerance_with_half_m"});
  EXPECT_LT(figure(ended.out, "least_tolerance_with_half_m"), 0.7 * figure(ended.out, "least_tolerance_m"));
}

TEST_F(Command, NamesTheMissingPartOfAScenario) {
  const std::string axis =
      "[plant]\nmass_kg = 1\n[friction]\nlower_N = 2.5\nupper_N = 4.5\n"
      "[controller]\nk1_N_per_m = 1\nk21_Ns_per_m = 0.5\nk22_Ns_per_m = 3\n";
  expect_refused("simulate " + scenario(axis), {"[run]"});
  expect_refused("simulate " + scenario(axis + "[run]\nduration_s = 1\n[loop]\nperiod_s = 0.001\n"), {"[drive]"});
  EXPECT_EQ(run("design " + scenario(axis)).exit_code, 0);
}

TEST_F(Command, KeepsTheContractOfTheExample) {
  const Ended ended = run("simulate " + scenarios + "impulsive_example.toml --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"t1_s", "t2_s", "y2_m", "t_inf_s", "bound_s", "final_error_m", "settled", "kicks", "time_s",
                          "position_m", "velocity_after_m_s", "wall_s", "steps"});
  std::ifstream reference{BREAKAWAY_SOURCE_DIR "/tests/reference/impulsive_example.csv"};
  int compared = 0;
  for (std::string line; std::getline(reference, line);) {
    const auto comma = line.find(',');
    if (line[0] == '#' || line.starts_with("kick")) continue;
    const double expected = std::stod(line.substr(comma + 1));
    EXPECT_NEAR(figure(ended.out, line.substr(0, comma)), expected, 1e-9 * std::fabs(expected)) << line;
    ++compared;
  }
  EXPECT_EQ(compared, 5);
}

std::string without_wall_time(const std::string& json) {
  return std::regex_replace(json, std::regex{R"("wall_s": [^,}\n]*)"}, "");
}

TEST_F(Command, WritesTheSameJsonTwice) {
  for (const std::string& command :
       {"design " + scenarios + "braked_axis.toml", "simulate " + scenarios + "can_axis.toml",
        "study " + scenarios + "braked_axis.toml --laws 9 --start -0.01 0",
        "identify " + scenarios + "braked_axis.toml --from -4.5 --to -3.5",
        "attract " + scenarios + "two_mass_example.toml"}) {
    const Ended first = run(command + " --json -"), second = run(command + " --json -");
    EXPECT_FALSE(first.out.empty()) << command << first.err;
    EXPECT_EQ(without_wall_time(first.out), without_wall_time(second.out)) << command;
  }
}

TEST_F(Command, TakesNegativeNumbers) {
  const Ended k3 = run("k3 --mass 1 --k1 1 --k22 3 --friction-lower 2.5 --position -0.1");
  EXPECT_EQ(k3.exit_code, 0) << k3.err;
  EXPECT_EQ(run("study " + scenarios + "braked_axis.toml --laws 0 --start -0.01 -0.001").exit_code, 0);
}

TEST_F(Command, KeepsTheContractOfTheAxisOnCan) {
  const Ended ended = run("simulate " + scenarios + "can_axis.toml --json - --candump " + path("can.log"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"settled", "settling_time_s", "final_error_m", "peak_force_N", "kicks", "ticks",
                          "missed_ticks", "bus_load", "sync_off_s", "faults"});
  EXPECT_LE(std::fabs(figure(ended.out, "final_error_m")), 3e-6);
  EXPECT_LE(figure(ended.out, "peak_force_N"), 50);
  EXPECT_TRUE(content(path("can.log")).starts_with("(0000000000."));
}

// The bus of three axes: every figure of an axis stands beside its name.
TEST_F(Command, KeepsTheContractOfSeveralAxes) {
  const Ended ended = run("simulate " + scenarios + "three_axes.toml --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_TRUE(ended.out.starts_with("{\n  \"title\": \"Three axes on one bus\",\n  \"settled\": true"));
  EXPECT_EQ(figure(ended.out, "missed_ticks"), 0);
  const std::vector<std::pair<std::string, double>> tolerances{
      {"gantry", 2.5e-6}, {"slide", 2.5e-6}, {"table", 2.5e-5}};
  for (const auto& [name, tolerance_m] : tolerances) {
    const auto at = ended.out.find("{\"name\": \"" + name + "\", \"settled\": true");
    ASSERT_NE(at, std::string::npos) << name;
    const std::string axis = ended.out.substr(at);
    expect_keys(axis, {"settling_time_s", "final_error_m", "peak_force_N", "kicks", "faults"});
    EXPECT_LE(std::fabs(figure(axis, "final_error_m")), tolerance_m) << name;
  }
}

TEST_F(Command, DesignsEveryAxisAndWritesNoHeaderUnlessAllAreCertified) {
  const Ended good = run("design " + scenarios + "three_axes.toml --json - --header " + path("good.hpp"));
  ASSERT_EQ(good.exit_code, 0) << good.err;
  expect_keys(good.out, {"certified", "axes", "name", "checks", "accuracy_floor_m"});
  EXPECT_NE(content(path("good.hpp")).find("FlashedNode<float, 3> node"), std::string::npos);

  std::string text = content(scenarios + "three_axes.toml");
  text.replace(text.find("position_tolerance_m = 2e-5"), 27, "position_tolerance_m = 1e-5");
  const Ended bad = run("design " + scenario(text) + " --header " + path("bad.hpp"));
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_NE(bad.err.find("axis table: not certified"), std::string::npos) << bad.err;
  EXPECT_FALSE(fs::exists(path("bad.hpp")));
}

TEST_F(Command, RefusesAxesThatContradictOneAnother) {
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = content(scenarios + "three_axes.toml");
    return scenario(text.replace(text.find(from), from.size(), to));
  };
  for (const char* command : {"simulate ", "design "}) {
    expect_refused(command + with("node_id = 2", "node_id = 1"), {"axis.toml:35", "node_id", "gantry"});
    expect_refused(command + with("\"slide\"", "\"gantry\""), {"axis.toml:", "name", "gantry"});
    expect_refused(command + with("period_s = 0.001", "period_s = 0.0005"), {"axis.toml", "bus", "us", "period"});
  }
  expect_refused("study " + scenarios + "three_axes.toml", {"--axis"});
  expect_refused("study --axis z " + scenarios + "three_axes.toml", {"\"z\"", "\"gantry\", \"slide\", \"table\""});
}

TEST_F(Command, SettlesBelowTheSpeedLimitUnderTheCoastPdWithoutALimitOfTheApproach) {
  std::string text = content(scenarios + "can_axis.toml");
  const std::vector<std::pair<std::string, std::string>> changes{{"max_approach_speed_m_s = 5\n", ""},
                                                                 {"position_m = -4", "position_m = -0.3"},
                                                                 {"velocity_m_s = -4", "velocity_m_s = 0"},
                                                                 {"speed_m_s = 20", "speed_m_s = 0.8"}};
  for (const auto& [from, to] : changes) text.replace(text.find(from), from.size(), to);
  EXPECT_EQ(run("design " + scenario(text)).exit_code, 0);
  const Ended ended = run("simulate " + scenario(text) + " --json -");
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_GT(figure(ended.out, "peak_speed_m_s"), 0.5);
  EXPECT_LT(figure(ended.out, "peak_speed_m_s"), 0.8);
}

TEST_F(Command, RefusesToCallSettledWhatTheLawNeverReaches) {
  std::string text = content(scenarios + "can_axis.toml");
  text.replace(text.find("settle_tolerance_m = 3e-6"), 25, "settle_tolerance_m = 2e-6");
  for (const char* command : {"simulate ", "design ", "study --laws 0 "})
    expect_refused(command + scenario(text), {"settle_tolerance_m is 2e-06", "position_tolerance_m", "2.3e-06"});
}

// A limit is for what is beyond it: the drive reports whole steps of force, which are the limit but for rounding.
TEST_F(Command, LetsTheForceReachItsLimit) {
  std::string text = content(scenarios + "can_axis.toml");
  text.replace(text.find("max_force_N = 50"), 16, "max_force_N = 19.1340602");
  text.replace(text.find("speed_m_s = 20"), 14, "speed_m_s = 20\nforce_N = 19.1340602");
  const Ended ended = run("simulate " + scenario(text) + " --json -");
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_LE(figure(ended.out, "peak_force_N"), 19.1340602);
}

TEST_F(Command, StudiesOneAxisOfSeveral) {
  const Ended ended = run("study --laws 4 --start 0.05 0 --axis slide " + scenarios + "three_axes.toml --json -");
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(figure(ended.out, "settled"), 8);
}

TEST_F(Command, KeepsTheContractOfDesign) {
  const Ended ended = run("design " + scenarios + "can_axis.toml --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err << ended.out;
  expect_keys(ended.out, {"certified", "reasons", "checks", "margin", "zeta_approach", "zeta_kick", "accuracy_floor_m",
                          "bound_s", "table", "bytes", "proved_error"});
  EXPECT_NE(ended.out.find("\"certified\": true"), std::string::npos);
}

TEST_F(Command, ExitsWithOneWhenTheAxisDoesNotSettleOrIsNotCertified) {
  std::string text = content(scenarios + "impulsive_example.toml");
  text.replace(text.find("duration_s = 60"), 15, "duration_s = 4");
  const Ended ended = run("simulate " + scenario(text));
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_NE(ended.out.find("NOT settled"), std::string::npos);

  // 1 ms periods and friction between 0.1 N and 4.5 N: the accuracy floor is far above 3 um.
  std::string weak = content(scenarios + "can_axis.toml");
  weak.replace(weak.find("mu_lower = 0.25"), 15, "mu_lower = 0.01");
  const Ended design = run("design " + scenario(weak) + " --json -");
  EXPECT_EQ(design.exit_code, 1);
  EXPECT_NE(design.out.find("\"certified\": false"), std::string::npos);
  EXPECT_NE(design.out.find("tolerance_above_floor"), std::string::npos);
}

TEST_F(Command, RefusesAForceThatTheDriveCannotGiveAndAPeriodThatTheBusCannotCarry) {
  const auto ended_with = [&](const std::string& command, const std::string& from, const std::string& to) {
    std::string text = content(scenarios + "can_axis.toml");
    return run(command + " " + scenario(text.replace(text.find(from), from.size(), to)));
  };
  const Ended weak = ended_with("simulate", "max_torque_per_mille = 2000", "max_torque_per_mille = 1000");
  EXPECT_EQ(weak.exit_code, 2);
  EXPECT_NE(weak.err.find("max_force_N is 50, but the [drive] gives 25 N"), std::string::npos) << weak.err;
  for (const char* command : {"simulate", "design", "study"}) {
    const Ended slow = ended_with(command, "bit_rate = 1_000_000", "bit_rate = 125_000");
    EXPECT_EQ(slow.exit_code, 2) << command;
    EXPECT_NE(slow.err.find("needs 3360 us on the bus and has 1000 us"), std::string::npos) << slow.err;
  }
}

// Both count from the last target.
TEST_F(Command, StudySeesAnAxisWithinAMillimetreNoLaterThanSettled) {
  const Ended ended = run("study " + scenarios + "move_axis.toml --laws 0");
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  std::smatch row;
  const std::regex times{R"(4/4 +[0-9.]+ s +([0-9.]+) s +([0-9.]+) s)"};
  ASSERT_TRUE(std::regex_search(ended.out, row, times)) << ended.out;
  EXPECT_LE(std::stod(row[2]), std::stod(row[1])) << ended.out;
}

// What controller/law/README.md says of one axis under both coasts, and toolchain/pictures.sh draws.
TEST_F(Command, SettlesSoonerAndByFewerKicksUnderTheBrake) {
  const std::pair<const char*, const char*> edits[] = {{"position_m = -4\n", "position_m = -0.1\n"},
                                                       {"velocity_m_s = -4\n", "velocity_m_s = 0\n"},
                                                       {"kind = \"mean\"", "kind = \"static_kinetic\""}};
  std::string brake = content(scenarios + "braked_axis.toml");
  for (const auto& [from, to] : edits) brake.replace(brake.find(from), std::string{from}.size(), to);
  brake = std::regex_replace(brake, std::regex{"(weights|parts) = .*\n"}, "");
  std::string pd = std::regex_replace(brake, std::regex{"\n\\[uncertainty\\][^\\[]*"}, "\n");
  pd.replace(pd.find("coast = \"brake\""), 15, "coast = \"pd\"");
  const auto expect_run = [&](const std::string& text, double settling_s, double error_m, std::ptrdiff_t kicks) {
    const Ended ended = run("simulate " + scenario(text) + " --json -");
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_NEAR(figure(ended.out, "settling_time_s"), settling_s, 0.5e-3);
    EXPECT_NEAR(figure(ended.out, "final_error_m"), error_m, 0.05e-6);
    const std::regex kick{"\"velocity_after_m_s\""};
    EXPECT_EQ(std::distance(std::sregex_iterator{ended.out.begin(), ended.out.end(), kick}, std::sregex_iterator{}),
              kicks);
  };
  expect_run(brake, 0.109, -1.1e-6, 1);
  expect_run(pd, 0.268, -1.35e-6, 5);
}

}  // namespace
}  // namespace breakaway::testing
