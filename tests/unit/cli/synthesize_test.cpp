// `breakaway synthesize` as a user's script sees it.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;

const std::string scenarios = BREAKAWAY_SOURCE_DIR "/sim/scenarios/";

struct Ended {
  int exit_code;
  std::string out, err;
};

class Synthesize : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "breakaway-synthesize-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const char* name) const { return (folder_ / name).string(); }

  static std::string content(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream{path}.rdbuf();
    return text.str();
  }

  Ended command(const std::string& arguments, const std::string& environment = "") const {
    const std::string line =
        environment + " '" BREAKAWAY_COMMAND "' " + arguments + " > " + path("out") + " 2> " + path("err");
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(path("out")), content(path("err"))};
  }

  // Of the actuated two masses.
  Ended run(const std::string& arguments, const std::string& environment = "") const {
    return command("synthesize " + scenarios + "two_mass_actuated.toml " + arguments, environment);
  }

  void expect_refused(const std::string& arguments, const std::string& named, const std::string& environment = "") {
    const Ended ended = run(arguments, environment);
    EXPECT_EQ(ended.exit_code, 2) << arguments;
    EXPECT_NE(ended.err.find(named), std::string::npos) << named << " in " << ended.err;
  }

  fs::path folder_;
};

double figure(const std::string& json, const std::string& name) {
  const auto at = json.find('"' + name + "\": ");
  return at == std::string::npos ? std::nan("") : std::strtod(json.c_str() + at + name.size() + 4, nullptr);
}

// Figure 4: rho* = 1 / (d1 - 0.75)^2 by hand; identical gains need no solver.
TEST_F(Synthesize, MeetsItsWantsAndSweepsTheGain) {
  const Ended ended =
      run("--want resting-error=1 --want region=16 --gains identical --sweep 0.3,0.74,0.75 --trajectories 20 --json -",
          "PATH=");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_NEAR(figure(ended.out, "resting_error_m"), 1, 1e-6);
  EXPECT_NEAR(figure(ended.out, "rho_star_J"), 16, 1e-6);
  EXPECT_EQ(figure(ended.out, "at_rest"), 20);
  EXPECT_NE(ended.out.find("{\"d1\": 0.3, \"rho_star_J\": 4.938"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("{\"d1\": 0.75, \"rho_star_J\": null, \"global\": true"), std::string::npos) << ended.out;
}

// The last one counted, and the others were forgotten.
TEST_F(Synthesize, MeetsEveryOneOfItsWants) {
  const auto found = [&](const std::string& wants) {
    const Ended ended = run(wants + " --gains identical --trajectories 0 --json -", "PATH=");
    EXPECT_EQ(ended.exit_code, 0) << wants << ": " << ended.err;
    return ended.out;
  };
  const std::string least = "--want resting-error=0.5 --want region=16";
  for (const char* wants : {"--want resting-error=0.5 --want resting-error=5 --want region=16 --want region=4",
                            "--want resting-error=5 --want resting-error=0.5 --want region=4 --want region=16"})
    EXPECT_EQ(found(wants), found(least)) << wants;
  for (const char* wants : {"--want resting-error=1 --want global --want region=16",
                            "--want resting-error=1 --want region=16 --want global --want global"})
    EXPECT_EQ(found(wants), found("--want resting-error=1 --want global")) << wants;
  EXPECT_EQ(found("--want resting-error=1 --want reach=2 --want reach=1"),
            found("--want resting-error=1 --want reach=2"));
}

// What it writes is a scenario that the other commands take, and they find the same.
TEST_F(Synthesize, WritesTheClosedLoop) {
  const std::string wants = "--want resting-error=0.5 --want region=9 --gains identical --trajectories 0 ";
  ASSERT_EQ(run(wants + "--scenario " + path("closed.toml")).exit_code, 0);
  const Ended again = command("synthesize " + path("closed.toml") + " " + wants + " --json -");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, run(wants + "--json -").out) << "gains in the file are replaced";
  const Ended basin = command("basin " + path("closed.toml") + " --grid 3 --window 1 --json -");
  EXPECT_NEAR(figure(basin.out, "rho_star_J"), 9, 1e-6) << basin.err;
  EXPECT_EQ(command("simulate " + path("closed.toml")).exit_code, 0);
}

TEST_F(Synthesize, RefusesWantsByName) {
  expect_refused("", "--want");
  expect_refused("--want beauty", "--want beauty");
  expect_refused("--want region=-1", "--want region=-1");
  expect_refused("--want region=1e999", "region=1e999");
  expect_refused("--want region=4 --gains identical", "resting error");
  expect_refused("--want resting-error=1 --gains some", "--gains");
  expect_refused("--want resting-error=1 --picture a.pdf", "a.pdf");
  expect_refused("--want resting-error=1 --json a --scenario a", "two outputs");
  expect_refused("--want resting-error=1", "install the package sdpa", "PATH=");
  const Ended axis = command("synthesize " + scenarios + "can_axis.toml --want global");
  EXPECT_EQ(axis.exit_code, 2);
  EXPECT_NE(axis.err.find("machine"), std::string::npos) << axis.err;
}

TEST_F(Synthesize, DrawsTheSweep) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const Ended ended = run("--want resting-error=1 --want global --gains identical --picture " + path("a.svg"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_NE(content(path("a.svg")).find("everywhere"), std::string::npos);
}

}  // namespace
