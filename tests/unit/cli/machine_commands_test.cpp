// simulate, attract and basin, on scenarios with a machine.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "command.hpp"

namespace breakaway::testing {
namespace {

const std::string two_masses = scenarios + "two_mass_example.toml";

TEST_F(Command, KeepsTheContractOfASimulatedMachine) {
  const Ended ended = run("simulate " + two_masses + " --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"modes", "events", "time_s", "kind", "dof", "settled", "settling_time_s", "q_end", "v_end"});
  EXPECT_NE(ended.out.find("\"settled\": true"), std::string::npos);
  expect_refused("simulate " + two_masses + " --candump " + path("a.log"), {"--candump", "bus"});
}

// Only damping ends the motion of the masses against each other, and a certificate knows no time.
TEST_F(Command, SaysOfACertifiedMotionThatIsNotAtRestWhatIsCertified) {
  std::ofstream{path("slow.toml")} << "[machine]\nmass = [[1, 0], [0, 1]]\ndamping = [[1e-9, 0], [0, 1e-9]]\n"
                                      "stiffness = [[2, -1], [-1, 2]]\ndirections = [[1], [1]]\nfriction_N = [1]\n"
                                      "[start]\nq = [3, -3]\n[run]\nduration_s = 10\n";
  const Ended ended = run("simulate " + path("slow.toml"));
  EXPECT_NE(ended.out.find("NOT at rest"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("certified      to come to rest, which says nothing of when"), std::string::npos)
      << ended.out;
  const std::string settled = run("simulate " + two_masses).out;
  EXPECT_NE(settled.find("certified      to come to rest\n"), std::string::npos) << settled;
}

TEST_F(Command, TakesTheMethodThatHoldsTheAccuracyAskedFor) {
  const Ended ended = run("simulate " + two_masses + " --accuracy 1e-6 --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"accuracy_m", "method", "error_estimate_m", "estimated_cost_s", "refused", "integrator"});
  EXPECT_NE(ended.out.find("\"name\": \"event_driven\""), std::string::npos);
  EXPECT_LT(figure(ended.out, "error_estimate_m"), 1e-12);
  const std::string coarse = run("simulate " + two_masses + " --accuracy 0.1 --json -").out;
  EXPECT_GT(figure(coarse, "step_s"), 0);
}

TEST_F(Command, WritesWhyNoMethodHoldsTheAccuracyAskedFor) {
  expect_refused("simulate " + two_masses + " --accuracy 1e-20 --json " + path("a.json"),
                 {"two_mass_example.toml", "1e-20", "event_driven", "rounding", "about"});
  const std::string json = content(path("a.json"));
  expect_keys(json, {"method", "error_estimate_m", "refused", "reason", "estimated_cost_s"});
  EXPECT_NE(json.find("\"method\": null"), std::string::npos);
  expect_refused("simulate " + two_masses + " --accuracy 0", {"--accuracy", "above 0"});
}

TEST_F(Command, TellsWhatAnAccuracyCostsOnASceneOfOnesOwn) {
  const std::string stribeck = scenarios + "two_mass_stribeck.toml";
  const Ended ended = run("tradeoff " + stribeck + " --accuracy 1e-5 --json - --picture " + path("a.svg"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"method", "error_estimate_m", "refused", "trials", "error_m", "estimated_cost_s", "holds",
                          "parts", "part", "may_be_left_out", "difference_on_the_way_m", "saves_share"});
  EXPECT_NE(content(path("a.svg")).find("chosen"), std::string::npos);
  const std::string chosen = run("simulate " + stribeck + " --accuracy 1e-5 --json -").out;
  EXPECT_EQ(figure(ended.out, "error_estimate_m"), figure(chosen, "error_estimate_m")) << "as simulate has it";
  const std::string table = run("tradeoff " + two_masses + " --accuracy 1e-2").out;
  for (const char* part : {"event_driven", "time_stepping", "chosen"}) EXPECT_NE(table.find(part), std::string::npos);
  expect_refused("tradeoff " + two_masses, {"--accuracy", "missing"});
  expect_refused("tradeoff --accuracy 1", {"--accuracy", "scenario"});
  expect_refused("tradeoff " + two_masses + " --accuracy 1e-20 --json " + path("b.json"), {"1e-20", "rounding"});
  EXPECT_NE(content(path("b.json")).find("\"method\": null"), std::string::npos);
}

TEST_F(Command, TellsWhichPartsOfAnAxisMayBeLeftOut) {
  const std::string json = run("tradeoff " + scenarios + "can_axis.toml --accuracy 1e-3 --json -").out;
  EXPECT_NE(json.find("{\"part\": \"lag of the drive\", \"may_be_left_out\": true"), std::string::npos) << json;
  EXPECT_NE(json.find("{\"part\": \"loop, drive and bus\", \"may_be_left_out\": false"), std::string::npos) << json;
}

TEST_F(Command, KeepsTheContractOfBasin) {
  const Ended ended = run("basin " + two_masses + " --grid 41 --window 6 --json - --csv " + path("a.csv"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_TRUE(ended.err.empty()) << "progress is for terminals";
  expect_keys(ended.out,
              {"attracted", "lost", "undecided", "true_area", "certified_area_theorem_1", "trajectories_per_s"});
  EXPECT_NEAR(figure(ended.out, "true_area"), 106.372, 0.5);  // 41 points an axis tell it to a few tenths
  EXPECT_NEAR(figure(ended.out, "certified_area_theorem_1"), 58.0416, 1e-4);
  const std::string csv = content(path("a.csv"));
  EXPECT_TRUE(csv.starts_with("# breakaway basin, 41 points, window 6, plane 1,2, system "));
  EXPECT_NE(csv.find("\nx1,x2,attracted,time_s\n-6,-6,1,"), std::string::npos);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 41 * 41 + 2);
}

TEST_F(Command, KeepsTheContractOfAttract) {
  const Ended ended = run("attract " + two_masses + " --depth 7 --json -");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  expect_keys(ended.out, {"conditions", "name", "holds", "margin", "reason", "alpha", "beta", "rho_star_J",
                          "rho_star_closed_form_J", "equilibrium_set", "vertices", "extent", "E_certified", "global",
                          "certified_area", "sweep", "d1"});
  EXPECT_NEAR(figure(ended.out, "alpha"), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(figure(ended.out, "rho_star_J"), 16, 1e-10);
  EXPECT_NEAR(figure(ended.out, "rho_star_closed_form_J"), 4, 1e-12);
  EXPECT_NEAR(figure(ended.out, "window"), 6, 1e-12);
  EXPECT_GT(figure(ended.out, "certified_area"), 0.9 * 106.372);
  EXPECT_LT(figure(ended.out, "certified_area"), 106.372);
  EXPECT_NE(ended.out.find("{\"d1\": 0.75, \"rho_star_J\": null, \"E_certified\": true, \"global\": true"),
            std::string::npos);
}

TEST_F(Command, RefusesOrDoubtsWhatCannotBeAttracted) {
  expect_refused("attract " + two_masses + " --plane 1,5", {"--plane", "1,5"});
  expect_refused("attract " + two_masses + " --depth 99", {"--depth"});
  expect_refused("attract " + two_masses + " --window 1e300", {"--window", "1e300", "at most 1e+09"});
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

// In a file there is no terminal: without --progress nothing is said, with it standard output stays the same.
TEST_F(Command, ShowsProgressWhenAskedAndChangesNothing) {
  const std::vector<std::string> commands{"attract " + two_masses + " --depth 6 --json -",
                                          "simulate " + two_masses + " --json -",
                                          "basin " + two_masses + " --grid 21 --window 6 --csv -",
                                          "study " + scenarios + "can_axis.toml --laws 2 --start -0.01 0 --json -"};
  for (const std::string& command : commands) {
    const Ended quiet = run(command), asked = run(command + " --progress");
    EXPECT_EQ(quiet.exit_code, asked.exit_code) << command;
    EXPECT_EQ(quiet.err, "") << command;
    EXPECT_EQ(quiet.out, asked.out) << command;
    EXPECT_NE(asked.err.find(" %, "), std::string::npos) << command << asked.err;
    EXPECT_NE(asked.err.find(" to go"), std::string::npos) << command << asked.err;
    // Of each of the two stages that attract has a line a tenth.
    EXPECT_LE(std::ranges::count(asked.err, '\n'), 2 * 11) << command << asked.err;
  }
}

// Two axes without coupling: the second one grows by itself, however small its numbers are beside the first one's.
TEST_F(Command, NeverCertifiesAMachineThatFliesApart) {
  const std::string machine = scenario(
      "[machine]\nmass = [[1e3, 0], [0, 1e-12]]\ndamping = [[1e4, 0], [0, -1e-12]]\n"
      "stiffness = [[1e6, 0], [0, 1e-6]]\ndirections = [[1, 0], [0, 1]]\nfriction_N = [1, 1e-15]\n"
      "[start]\nq = [0, 1e-3]\n[run]\nduration_s = 20\n");
  const Ended attract = run("attract " + machine + " --depth 3 --json -");
  EXPECT_NE(attract.out.find("\"global\": false"), std::string::npos) << attract.out;
  EXPECT_NEAR(figure(attract.out, "level_J") / 5e-19, 1, 1e-9);
  const Ended simulated = run("simulate " + machine);
  EXPECT_EQ(simulated.exit_code, 1);
  EXPECT_NE(simulated.out.find("certified      never to come to rest"), std::string::npos) << simulated.out;
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

TEST_F(Command, MergesNoShardsOfAnotherMachine) {
  const std::string shard = " --grid 6 --window 6 --shard 2/2 --csv " + path("other");
  const std::string other = scenario(
      "[machine]\nmass = [[1, 0], [0, 1]]\ndamping = [[0.125, 0.375], [0.375, 0.125]]\n"
      "stiffness = [[2, -1], [-1, 2]]\ndirections = [[1, 0], [0, 1]]\nfriction_N = [1, 1.5]\n"
      "[run]\nduration_s = 60\n");
  ASSERT_EQ(run("basin " + other + shard).exit_code, 0);
  expect_refused("basin " + two_masses + " --grid 6 --window 6 --merge " + path("other"),
                 {"other:1", "another system", "# breakaway basin, 6 points"});
}

TEST_F(Command, RefusesBasinsThatCannotBe) {
  const std::string basin = "basin " + two_masses + " --grid 15 --window 6 ";
  expect_refused("basin " + two_masses + " --window 6", {"--grid"});
  expect_refused("basin " + two_masses + " --grid 1 --window 6", {"--grid"});
  for (const char* window : {"nan", "0", "1.1e9", "1e308"})
    expect_refused("basin " + two_masses + " --grid 15 --window " + window, {"--window", window, "at most 1e+09"});
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
}  // namespace breakaway::testing
