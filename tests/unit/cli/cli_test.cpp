// The command as a user's script sees it: exit codes, one line on standard error, the contracts of its JSON.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "../scratch_folder.hpp"

namespace {

namespace fs = std::filesystem;

const std::string scenarios = BREAKAWAY_SOURCE_DIR "/sim/scenarios/";
const std::string plant = "k3 --mass 1 --k1 1 --k22 3 --friction-lower 2.5 --position -1 ";

struct Ended {
  int exit_code;
  std::string out, err;
};

class Command : public breakaway::testing::ScratchFolder {
 protected:
  Ended run(const std::string& arguments, const std::string& environment = "") const {
    const std::string command =
        environment + " '" BREAKAWAY_COMMAND "' " + arguments + " > " + path("out") + " 2> " + path("err");
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(path("out")), content(path("err"))};
  }

  void expect_refused(const std::string& arguments, const std::vector<std::string>& named,
                      const std::string& environment = "") const {
    const Ended ended = run(arguments, environment);
    EXPECT_EQ(ended.exit_code, 2) << arguments;
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
    for (const auto& part : named) EXPECT_NE(ended.err.find(part), std::string::npos) << part << " in " << ended.err;
  }

  std::string scenario(const std::string& text) const {
    std::ofstream{path("axis.toml")} << text;
    return path("axis.toml");
  }
};

// The number after the first "name": in JSON text; NaN if it is not there.
double figure(const std::string& json, const std::string& name) {
  const auto at = json.find('"' + name + "\": ");
  return at == std::string::npos ? std::nan("") : std::strtod(json.c_str() + at + name.size() + 4, nullptr);
}

void expect_keys(const std::string& json, const std::vector<std::string>& names) {
  for (const auto& name : names) EXPECT_NE(json.find('"' + name + "\":"), std::string::npos) << name;
}

TEST_F(Command, RefusesBadInputInOneLineThatNamesIt) {
  expect_refused("", {"subcommand"});
  expect_refused("simulat", {"simulat ", "--help"});
  expect_refused("k3 --mass 1", {"--k1", "k3 --help"});
  expect_refused("simulate", {"scenario"});
  expect_refused("simulate /nowhere.toml", {"/nowhere.toml", "No such file"});
  expect_refused("simulate " + folder_.string(), {folder_.string(), "folder"});
  expect_refused("simulate /dev/zero", {"/dev/zero", "1 MiB"});
  expect_refused("simulate " + scenario(""), {"axis.toml:1", "plant", "missing"});
  expect_refused("simulate " + scenarios + "impulsive_example.toml --jason x", {"--jason"});
  expect_refused(plant + "--position nan", {"--position", "nan"});
  expect_refused(plant + "--position inf", {"--position", "inf"});
  expect_refused(plant + "--position 1e308", {"--position", "1e+308", "beyond"});
  expect_refused("k3 --mass nan --k1 1 --k22 3 --friction-lower 2.5 --position 1", {"--mass", "nan"});
  expect_refused("k3 --mass -1 --k1 1 --k22 3 --friction-lower 2.5 --position 1", {"--mass", "-1"});
  expect_refused("k3 --mass 1 --k1 1 --k22 2 --friction-lower 2.5 --position 1", {"k22", "zeta"});
  expect_refused("k3 --mass 1 --k1 1 --k22 3 --position 1", {"--friction-lower"});
  expect_refused("k3 --mass one --k1 1 --k22 3 --friction-lower 2.5 --position 1", {"--mass", "one"});
  expect_refused("simulate " + scenario("[plant]\nmas_kg = 1\n"), {"axis.toml:2", "mas_kg", "mass_kg"});
}

TEST_F(Command, RefusesOutputsThatCannotAllBeWritten) {
  const std::string example = "simulate " + scenarios + "impulsive_example.toml ";
  expect_refused(example + "--json ''", {"--json", "empty"});
  expect_refused(example + "--json - --csv -", {"two outputs"});
  expect_refused(example + "--json " + path("a") + " --csv " + path("a"), {path("a"), "two outputs"});
  expect_refused(example + "--candump " + path("a"), {"--candump", "[loop]"});
  EXPECT_FALSE(fs::exists(path("a")));
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

TEST_F(Command, CertifiesNoAxisWhoseDriveIsTooWeak) {
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = content(scenarios + "can_axis.toml");
    return scenario(text.replace(text.find(from), from.size(), to));
  };
  const Ended weak = run("design " + with("max_force_N = 50", "max_force_N = 4"));
  EXPECT_EQ(weak.exit_code, 1) << weak.err;
  EXPECT_NE(weak.out.find("force_breaks_away"), std::string::npos);
  expect_refused("design " + with("max_torque_per_mille = 2000", "max_torque_per_mille = 100"),
                 {"axis.toml", "max_force_N is 50", "gives 2.5 N"});
  expect_refused("simulate " + with("max_force_N = 50", "max_force_N = 4"), {"axis.toml", "max_force_N", "4", "4.5"});
}

TEST_F(Command, NamesTheMissingPartOfAScenario) {
  const std::string axis =
      "[plant]\nmass_kg = 1\n[friction]\nlower_N = 2.5\nupper_N = 4.5\n"
      "[controller]\nk1_N_per_m = 1\nk21_Ns_per_m = 0.5\nk22_Ns_per_m = 3\n";
  expect_refused("simulate " + scenario(axis), {"[run]"});
  expect_refused("simulate " + scenario(axis + "[run]\nduration_s = 1\n[loop]\nperiod_s = 0.001\n"), {"[drive]"});
  EXPECT_EQ(run("design " + scenario(axis)).exit_code, 0);
}

TEST_F(Command, LeavesNoFileWhenAnOutputCannotBeWritten) {
  const std::string simulate = "simulate " + scenarios + "impulsive_example.toml ";
  expect_refused(simulate + "--json " + path("none/a.json"), {"none/a.json", "No such file"});
  expect_refused(simulate + "--json /dev/full", {"/dev/full", "No space left"});
  expect_refused(plant + "--json /dev/full", {"/dev/full", "No space left"});
  expect_refused(simulate + "--report " + path("a.html") + " --json " + path("a.json"), {"gnuplot-nox"},
                 "PATH=/nowhere");
  for (const auto& entry : fs::directory_iterator{folder_}) {
    EXPECT_TRUE(entry.path().filename() == "out" || entry.path().filename() == "err") << entry.path();
  }
}

TEST_F(Command, ReportsAFullDiskBehindStandardOutput) {
  const int status =
      std::system(("'" BREAKAWAY_COMMAND "' " + plant + "--json - > /dev/full 2> " + path("err")).c_str());
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_NE(content(path("err")).find("standard output"), std::string::npos);
}

TEST_F(Command, HelpsWithAnExampleAndTheExitCodes) {
  for (const char* subcommand : {"", "simulate ", "k3 ", "design ", "study ", "attract ", "basin ", "tradeoff "}) {
    const Ended help = run(std::string{subcommand} + "--help");
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("Example: breakaway "), std::string::npos) << subcommand;
    EXPECT_NE(help.out.find("Exit codes: 0 "), std::string::npos) << subcommand;
  }
}

// k3 and the time to go at -1 m from the closed form of (12): inverted here by bisection on its printed form, which has
// enough digits at this distance.
TEST_F(Command, PrintsK3Rows) {
  const Ended ended = run(plant + "--position 1e-300 --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_TRUE(ended.err.empty());
  const double s = std::sqrt(1.25), slow = -1.5 + s, fast = -1.5 - s, c = 2.5;
  const auto distance = [&](double t) {
    return c * (1 - fast / (fast - slow) * std::exp(-slow * t) + slow / (fast - slow) * std::exp(-fast * t));
  };
  double low = 0, high = 5;
  while (std::nextafter(low, high) < high) {
    const double middle = (low + high) / 2;
    (distance(middle) < 1 ? low : high) = middle;
  }
  const double speed = c * slow * fast / (fast - slow) * (std::exp(-slow * low) - std::exp(-fast * low));
  expect_keys(ended.out, {"rows", "position_m", "k3_Ns", "time_to_go_s"});
  EXPECT_EQ(figure(ended.out, "position_m"), -1);
  EXPECT_NEAR(figure(ended.out, "time_to_go_s"), low, 1e-13);
  EXPECT_NEAR(figure(ended.out, "k3_Ns"), std::fabs(speed), 1e-13);  // opposite in sign to the position
  const std::string second = ended.out.substr(ended.out.find("1e-300"));
  // Close to the target k3 = m sqrt(2 f / m |y|).
  EXPECT_NEAR(figure(second, "k3_Ns") / -std::sqrt(5e-300), 1, 1e-14);
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

TEST_F(Command, KeepsTheContractOfTheAxisOnCan) {
  const Ended ended = run("simulate " + scenarios + "can_axis.toml --json - --candump " + path("can.log"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"settled", "settling_time_s", "final_error_m", "max_force_N", "kicks", "ticks",
                          "missed_ticks", "bus_load", "faults"});
  EXPECT_LE(std::fabs(figure(ended.out, "final_error_m")), 3e-6);
  EXPECT_LE(figure(ended.out, "max_force_N"), 50);
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
    expect_keys(axis, {"settling_time_s", "final_error_m", "max_force_N", "kicks", "faults"});
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
  expect_refused("study --axis z " + scenarios + "three_axes.toml", {"\"z\"", "gantry, slide, table"});
}

// What a node could not run or would stop on is refused before it is certified, with --header and without.
TEST_F(Command, DesignsNothingThatTheNodeWouldRefuseOrStopOn) {
  const std::string can_axis = content(scenarios + "can_axis.toml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = can_axis;
    return scenario(text.replace(text.find(from), from.size(), to));
  };
  const auto expect_no_design = [&](const std::string& file, const std::vector<std::string>& named) {
    expect_refused("design " + file, named);
    expect_refused("design " + file + " --header " + path("no.hpp"), named);
    EXPECT_FALSE(fs::exists(path("no.hpp")));
  };
  const std::string drive =
      can_axis.substr(can_axis.find("[drive]"), can_axis.find("[limits]") - can_axis.find("[drive]"));
  expect_no_design(with(drive, ""), {"[drive] is missing"});
  expect_no_design(with("[loop]", "[loop]\nheartbeat_period_s = 0.3"),
                   {"heartbeat_timeout_s", "heartbeat_period_s = 0.3"});
  expect_no_design(with("[controller]", "[controller]\ntarget_m = 20"), {"target_m", "[limits]", "-10 to 10"});
  expect_no_design(with("speed_m_s = 20", "speed_m_s = 20\nfeedback_timeout_s = 0.0009"),
                   {"feedback_timeout_s", "period_s"});
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
  EXPECT_LE(figure(ended.out, "max_force_N"), 19.1340602);
}

TEST_F(Command, CertifiesNoDriveWhoseWholeStepsAreTooWeak) {
  std::string text = content(scenarios + "can_axis.toml");
  text.replace(text.find("rated_torque_Nm = 0.5"), 21, "rated_torque_Nm = 80");  // steps of 4 N
  text.replace(text.find("max_force_N = 50"), 16, "max_force_N = 7");
  const Ended ended = run("design " + scenario(text));
  EXPECT_EQ(ended.exit_code, 1) << ended.out;
  EXPECT_NE(ended.out.find("4.5 is not below 4"), std::string::npos) << ended.out;
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

// Quick: no instructions are counted. Midpoint steps are of the first order, and each method is in its place.
TEST_F(Command, KeepsTheContractOfTradeoff) {
  const Ended ended = run("tradeoff --quick --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out,
              {"quick", "cost_unit", "integrators", "step_s", "error_m", "order", "wrong_verdict_share", "instructions",
               "time_ratio", "impulsive_time_stepping", "ball_m", "predicted_ball_m", "k3_evaluators", "bytes",
               "relative_error", "control_periods", "accuracy_floor_m", "worst_error_m", "scene_parts"});
  EXPECT_NE(ended.out.find("\"cost_unit\": \"time_ratio\""), std::string::npos);
  const auto after = [&](const std::string& text) { return ended.out.substr(ended.out.find(text)); };
  EXPECT_LT(figure(after("\"event-driven\""), "error_m"), 1e-13);
  const std::string midpoint = after("\"method\": \"midpoint\", \"step_s\": 0.01");
  EXPECT_NEAR(figure(midpoint, "order"), 1, 0.2);
  EXPECT_EQ(figure(midpoint, "wrong_verdict_share"), 0);
  EXPECT_GT(figure(after("\"implicit Euler\""), "wrong_verdict_share"), 0.05);
  const std::string flashed = after("\"cubic Hermite\", \"scalar\": \"float\", \"nodes\": 267");
  EXPECT_LT(figure(flashed, "relative_error_hard"), 4e-7);
  EXPECT_LE(figure(flashed, "bytes"), 2150);
  EXPECT_NEAR(figure(after("\"control_periods\""), "accuracy_floor_m"), 1.8 * 0.0005 * 0.0005, 1e-15);
}

TEST_F(Command, DrawsAndDescribesTheTradeoff) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  ASSERT_EQ(run("tradeoff --quick --picture " + path("a.svg") + " --page " + path("a.md")).exit_code, 0);
  EXPECT_NE(content(path("a.svg")).find("<svg"), std::string::npos);
  EXPECT_TRUE(content(path("a.md")).starts_with("# Speed against accuracy\n"));
  EXPECT_NE(content(path("a.md")).find("## Which method to take"), std::string::npos);
  expect_refused("tradeoff --quick --json " + path("none/a.json"), {"none/a.json"});
  expect_refused("tradeoff --work nothing", {"--work", "nothing"});
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

// An axis that has no time to get near its target; and one that stands on it from the start.
TEST_F(Command, ReportsRunsInWhichLittleHappens) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const auto exit_code_with = [&](const std::string& from, const std::string& to) {
    std::string text = content(scenarios + "can_axis.toml");
    const Ended ended =
        run("simulate " + scenario(text.replace(text.find(from), from.size(), to)) + " --report " + path("a.html"));
    EXPECT_TRUE(content(path("a.html")).ends_with("</html>\n")) << ended.err;
    fs::remove(path("a.html"));
    return ended.exit_code;
  };
  EXPECT_EQ(exit_code_with("duration_s = 30", "duration_s = 0.05"), 1);
  EXPECT_EQ(exit_code_with("position_m = -4\nvelocity_m_s = -4", "position_m = 0"), 0);
}

TEST_F(Command, KeepsTheReportOfALongRunModest) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const std::string text = content(scenarios + "can_axis.toml") + "stop_when_settled = false\n";  // 30 s
  ASSERT_EQ(run("simulate " + scenario(text) + " --report " + path("a.html")).exit_code, 0);
  EXPECT_LT(fs::file_size(path("a.html")), 1'000'000u);
}

TEST_F(Command, WritesASelfContainedReport) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  ASSERT_EQ(run("simulate " + scenarios + "impulsive_example.toml --report " + path("a.html")).exit_code, 0);
  const std::string html = content(path("a.html"));
  EXPECT_TRUE(html.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(html.ends_with("</html>\n"));
  EXPECT_EQ(html.find("src="), std::string::npos);  // nothing is fetched
  EXPECT_EQ(html.find("<link"), std::string::npos);
  for (const char* title : {"Response", "Phase plane", "Impulse law", "Friction", "Kicks"}) {
    EXPECT_NE(html.find("<h2>" + std::string{title}), std::string::npos) << title;
  }
}

const std::string two_masses = scenarios + "two_mass_example.toml";

TEST_F(Command, KeepsTheContractOfASimulatedMachine) {
  const Ended ended = run("simulate " + two_masses + " --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"modes", "events", "time_s", "kind", "dof", "settled", "settling_time_s", "q_end", "v_end"});
  EXPECT_NE(ended.out.find("\"settled\": true"), std::string::npos);
  expect_refused("simulate " + two_masses + " --candump " + path("a.log"), {"--candump", "bus"});
}

TEST_F(Command, KeepsTheContractOfBasin) {
  const Ended ended = run("basin " + two_masses + " --grid 41 --window 6 --json - --csv " + path("a.csv"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_TRUE(ended.err.empty()) << "progress is for terminals";
  expect_keys(ended.out, {"attracted", "lost", "undecided", "area_true", "area_certified", "trajectories_per_s"});
  EXPECT_NEAR(figure(ended.out, "area_true"), 106.372, 0.5);  // 41 points an axis tell it to a few tenths
  EXPECT_NEAR(figure(ended.out, "area_certified"), 58.0416, 1e-4);
  const std::string csv = content(path("a.csv"));
  EXPECT_TRUE(csv.starts_with("x1,x2,attracted,time_s\n-6,-6,1,"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 41 * 41 + 1);
}

TEST_F(Command, KeepsTheContractOfAttract) {
  const Ended ended = run("attract " + two_masses + " --depth 7 --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out,
              {"conditions", "name", "holds", "margin", "reason", "alpha", "beta", "rho_star", "rho_star_closed_form",
               "equilibrium_set", "vertices", "extent", "E_certified", "global", "certified_area", "sweep", "d1"});
  EXPECT_NEAR(figure(ended.out, "alpha"), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(figure(ended.out, "rho_star"), 16, 1e-10);
  EXPECT_NEAR(figure(ended.out, "rho_star_closed_form"), 4, 1e-12);
  EXPECT_NEAR(figure(ended.out, "window"), 6, 1e-12);
  EXPECT_GT(figure(ended.out, "certified_area"), 0.9 * 106.372);
  EXPECT_LT(figure(ended.out, "certified_area"), 106.372);
  EXPECT_NE(ended.out.find("{\"d1\": 0.75, \"rho_star\": null, \"E_certified\": true, \"global\": true"),
            std::string::npos);
}

TEST_F(Command, RefusesOrDoubtsWhatCannotBeAttracted) {
  expect_refused("attract " + two_masses + " --plane 1,5", {"--plane", "1,5"});
  expect_refused("attract " + two_masses + " --depth 99", {"--depth"});
  expect_refused("attract " + two_masses + " --picture a.pdf", {"a.pdf", ".svg"});
  expect_refused("attract " + scenarios + "can_axis.toml", {"can_axis.toml", "machine"});
  const auto machine = [&](const std::string& stiffness, const std::string& friction) {
    return scenario("[machine]\nmass = [[1, 0], [0, 1]]\ndamping = [[-0.1, 0], [0, -0.1]]\nstiffness = " + stiffness +
                    "\ndirections = [[1, 0], [0, 1]]\nfriction_N = " + friction + "\n");
  };
  const Ended soft = run("attract " + machine("[[1, 2], [2, 1]]", "[1, 1]") + " --json -");
  EXPECT_EQ(soft.exit_code, 1);
  EXPECT_NE(soft.out.find("stiffness is not symmetric and positive definite"), std::string::npos) << soft.out;
  const Ended frictionless = run("attract " + machine("[[2, 0], [0, 2]]", "[1, 0]") + " --depth 3");
  EXPECT_EQ(frictionless.exit_code, 1);
  EXPECT_NE(frictionless.out.find("condition 2"), std::string::npos) << frictionless.out;
}

TEST_F(Command, MergesShardsToTheSameTable) {
  const std::string basin = "basin " + two_masses + " --grid 15 --window 6 ";
  ASSERT_EQ(run(basin + "--csv " + path("whole") + " --threads 1").exit_code, 0);
  ASSERT_EQ(run(basin + "--shard 1/2 --csv " + path("1")).exit_code, 0);
  expect_refused(basin + "--merge " + path("1") + " --csv " + path("all"), {"--merge", "missing"});
  EXPECT_FALSE(fs::exists(path("all")));
  ASSERT_EQ(run(basin + "--shard 2/2 --resume " + path("2")).exit_code, 0);
  ASSERT_EQ(run(basin + "--merge " + path("1") + " " + path("2") + " --csv " + path("all")).exit_code, 0);
  EXPECT_EQ(content(path("all")), content(path("whole")));
}

TEST_F(Command, RefusesBasinsThatCannotBe) {
  const std::string basin = "basin " + two_masses + " --grid 15 --window 6 ";
  expect_refused("basin " + two_masses + " --window 6", {"--grid"});
  expect_refused("basin " + two_masses + " --grid 1 --window 6", {"--grid"});
  expect_refused("basin " + two_masses + " --grid 15 --window nan", {"--window", "nan"});
  expect_refused("basin " + two_masses + " --grid 100000 --window 6", {"--grid", "--shard"});
  expect_refused(basin + "--plane 1,5", {"--plane", "1,5"});
  expect_refused(basin + "--plane 2,2", {"--plane"});
  expect_refused(basin + "--shard 3/2", {"--shard", "3/2"});
  expect_refused(basin + "--shard 1", {"--shard"});
  expect_refused(basin + "--picture a.pdf", {"a.pdf", ".svg"});
  expect_refused(basin + "--csv a --json a", {"two outputs"});
  expect_refused(basin + "--merge /nowhere", {"/nowhere"});
  expect_refused(basin + "--resume /nowhere/a", {"/nowhere/a"});
  expect_refused("basin " + scenarios + "can_axis.toml --grid 15 --window 6", {"can_axis.toml", "machine"});
  expect_refused(basin + "--csv /nowhere/a", {"/nowhere/a"});
}

}  // namespace
