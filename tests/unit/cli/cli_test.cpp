// What holds for every subcommand, and those that need no scenario.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "command.hpp"

namespace breakaway::testing {
namespace {

const std::string plant = "k3 --mass 1 --k1 1 --k22 3 --friction-lower 2.5 --position -1 ";

TEST_F(Command, RefusesBadInputInOneLineThatNamesIt) {
  expect_refused("", {"subcommand"});
  expect_refused("simulat", {"simulat ", "did you mean simulate?", "--help"});
  expect_refused("xyzzy", {"xyzzy is neither", "option (breakaway"});
  expect_refused("k3 --mass 1", {"--k1", "k3 --help"});
  expect_refused("simulate", {"scenario"});
#ifdef __linux__
  expect_refused("watch --file /nowhere.csv --bind ''", {"--bind", "the address is empty"});
  for (const char* option : {"--duration", "--mode-delay"}) {
    for (const char* time_s : {"1e-10", "1e10", "1e300", "inf", "nan", "0", "-1", "soon"})
      expect_refused(std::string{"drive --can can9 axis.toml "} + option + " " + time_s,
                     {option, time_s, "from 1e-9 to 1e9"});
  }
#endif
  for (const char* laws : {"1e3", "-1", "1000001", "many"})
    expect_refused("study " + scenarios + "braked_axis.toml --laws " + laws,
                   {"--laws", laws + std::string{" is not a whole number from 0 to 1000000"}});
  expect_refused("simulate /nowhere.toml", {"/nowhere.toml", "No such file"});
  expect_refused("simulate ''", {"empty", "standard input"});
  expect_refused("simulate " + folder_.string(), {folder_.string(), "folder"});
  expect_refused("simulate /dev/zero", {"/dev/zero", "1 MiB"});
  expect_refused("simulate " + scenario(""), {"axis.toml:1", "plant", "missing"});
  expect_refused("simulate " + scenarios + "impulsive_example.toml --jason x", {"--jason", "did you mean --json?"});
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

TEST_F(Command, TellsOfItselfToPeopleShellsAndManuals) {
  EXPECT_EQ(run("help design").out, run("design --help").out);
  EXPECT_EQ(run("help").out, run("--help").out);
  expect_refused("help desing", {"desing is no subcommand", "did you mean design?"});
  expect_refused("help --man --completion", {"--man", "--completion"});
  const std::string page = run("help --man").out;
  for (const char* part : {".TH BREAKAWAY 1", ".SS simulate", "\\-\\-report", "Exit codes"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
}

TEST_F(Command, WritesAPageToNothingButHtml) {
  for (const std::string command : {"simulate ", "study ", "design "})
    expect_refused(command + scenarios + "can_axis.toml --report " + path("page.pdf"), {"page.pdf", ".pdf", ".html"});
  EXPECT_FALSE(fs::exists(path("page.pdf")));
}

TEST_F(Command, StudiesNoStartOutsideTheLimits) {
  expect_refused("study " + scenarios + "worn_axis.toml --start 2 0", {"--start 2 0", "worn_axis.toml", "-1 to 1 m"});
}

// What it holds is tested where there is a validator, by package.schema_of_the_files.
TEST_F(Command, WritesTheSameSchemaToAFileAndToStandardOutput) {
  const Ended written = run("schema");
  EXPECT_EQ(written.exit_code, 0);
  EXPECT_NE(written.out.find("https://json-schema.org/draft/2020-12/schema"), std::string::npos);
  EXPECT_EQ(run("schema -o " + path("schema.json")).exit_code, 0);
  EXPECT_EQ(content(path("schema.json")), written.out);
}

// Runs the completion as bash does.
TEST_F(Command, CompletesSubcommandsAndTheirOptions) {
  std::ofstream{path("completion")} << run("help --completion").out;
  const auto completed = [&](const std::string& words, int place) {
    const std::string script = "source " + path("completion") + "; COMP_WORDS=(breakaway " + words +
                               "); COMP_CWORD=" + std::to_string(place) + "; _breakaway; echo ${COMPREPLY[*]}";
    EXPECT_EQ(std::system(("bash -c '" + script + "' > " + path("completed")).c_str()), 0);
    return content(path("completed"));
  };
  EXPECT_EQ(completed("sim", 1), "simulate\n");
  EXPECT_EQ(completed("design --re", 2), "--report\n");
  EXPECT_EQ(completed("help stu", 2), "study\n");
  EXPECT_EQ(completed("tradeoff --w", 2), "\n") << "what the command calls itself with is no option for people";
}

TEST_F(Command, RefusesOutputsThatCannotAllBeWritten) {
  const std::string example = "simulate " + scenarios + "impulsive_example.toml ";
  expect_refused(example + "--json ''", {"--json", "empty"});
  // Without its name the experiment would be run again, the comparison be left out, or all be measured for minutes.
  for (const std::string& call :
       {"identify " + scenarios + "braked_axis.toml --from -4.5 --to -3.5 --log",
        "study " + scenarios + "braked_axis.toml --laws 0 --against", std::string{"tradeoff --quick"}})
    expect_refused(call + " ''", {"the name is empty", "standard input"});
  expect_refused(example + "--json - --csv -", {"two outputs"});
  expect_refused(example + "--json " + path("a") + " --csv " + path("a"), {path("a"), "two outputs"});
  expect_refused("design " + scenarios + "braked_axis.toml --header " + path("a") + " --law-image " + path("./a"),
                 {"two outputs would go there, --header and --law-image"});
  expect_refused(example + "--candump " + path("a"), {"--candump", "[loop]"});
  EXPECT_FALSE(fs::exists(path("a")));
}

// Every command that reads a file and writes one, with each of its outputs.
TEST_F(Command, WritesOverNoFileThatItReads) {
  const std::string axis = path("an.toml"), machine = path("machine.toml"), table = path("1.csv");
  fs::copy(scenarios + "braked_axis.toml", axis);
  fs::copy(scenarios + "two_mass_example.toml", machine);
  std::ofstream{table} << "of a shard";
  const std::vector<std::pair<std::string, std::vector<std::string>>> calls{
      {"simulate " + axis, {"--json", "--csv", "--candump", "--report"}},
      {"design " + axis, {"--json", "--report", "--header", "--law-image"}},
      {"study --laws 0 " + axis, {"--json", "--junit"}},
      {"study --laws 0 " + scenarios + "can_axis.toml --against " + axis, {"--json", "--junit"}},
      {"tune --laws 0 " + axis, {"--json", "--picture"}},
      {"identify " + axis, {"--json", "--csv", "--report"}},
      {"identify " + scenarios + "braked_axis.toml --log " + axis, {"--json", "--csv", "--report"}},
      {"tradeoff --accuracy 1e-5 " + axis, {"--json", "--picture"}},
      {"attract " + machine, {"--json", "--picture"}},
      {"synthesize --want global " + machine, {"--json", "--picture"}},
      {"basin --grid 3 --window 1 " + machine, {"--json", "--csv", "--picture", "--resume"}},
      {"basin --grid 3 --window 1 " + scenarios + "two_mass_example.toml --merge " + machine, {"--json", "--csv"}}};
  for (const auto& [call, outputs] : calls) {
    const std::string file = call.find(axis) != std::string::npos ? axis : machine, kept = content(file);
    for (const std::string& option : outputs) {
      expect_refused(call + " " + option + " " + file, {file, option + " would write over", "give another name"});
      expect_refused(call + " " + option + " " + path("./") + fs::path{file}.filename().string(), {option});
      EXPECT_EQ(content(file), kept);
    }
  }
}

// What a person may have changed since; results replace older ones.
TEST_F(Command, ReplacesAFileToGoOnFromOnlyWhereItIsTold) {
  const std::string axis = path("an.toml"), machine = path("machine.toml");
  fs::copy(scenarios + "braked_axis.toml", axis);
  fs::copy(scenarios + "two_mass_actuated.toml", machine);
  for (const std::string& call : {"identify " + axis + " -o " + axis, "tune --laws 0 " + axis + " -o " + axis,
                                  "synthesize --want global " + machine + " --scenario " + machine}) {
    const std::string file = call.find(axis) != std::string::npos ? axis : machine, kept = content(file);
    expect_refused(call, {file, "is there already", "--overwrite"});
    EXPECT_EQ(content(file), kept);
  }
  const Ended in_place = run("identify --from -4.5 --to -3.5 " + axis + " --overwrite -o " + axis);
  EXPECT_EQ(in_place.exit_code, 0) << in_place.err;
  EXPECT_NE(content(axis), content(scenarios + "braked_axis.toml"));
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

// As `| head` is after its lines.
TEST_F(Command, AReaderThatIsGoneIsNamedAndLeavesWholeFiles) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  close(ends[0]);
  const int ours = dup(STDOUT_FILENO);
  dup2(ends[1], STDOUT_FILENO);
  const auto usual = std::signal(SIGPIPE, SIG_DFL);
  const int status = std::system(("'" BREAKAWAY_COMMAND "' simulate " + scenarios + "impulsive_example.toml --csv " +
                                  path("run.csv") + " 2> " + path("err"))
                                     .c_str());
  std::signal(SIGPIPE, usual);
  dup2(ours, STDOUT_FILENO);
  for (const int descriptor : {ours, ends[1]}) close(descriptor);
  ASSERT_TRUE(WIFEXITED(status)) << status;
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_EQ(content(path("err")), "breakaway: standard output: cannot be written\n");
  EXPECT_TRUE(content(path("run.csv")).ends_with('\n'));
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

// A number that is smaller than all with 53 bits has few digits, and a fixed count of them would invent the others.
TEST_F(Command, PrintsNumbersOfK3AsItsJsonHasThem) {
  const std::string table = run(plant + "--position 1e-320 --position -0.1").out;
  EXPECT_NE(table.find(" 1e-320 "), std::string::npos) << table;
  EXPECT_NE(table.find(" -0.1 "), std::string::npos) << table;
}

// Quick: no instructions are counted. Midpoint steps are of the first order, and each method is in its place.
TEST_F(Command, KeepsTheContractOfTradeoffAndDrawsAndDescribesIt) {
  const bool draws = std::system("command -v gnuplot > /dev/null") == 0;
  const Ended ended =
      run("tradeoff --quick --json - --page " + path("a.md") + (draws ? " --picture " + path("a.svg") : ""));
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
  EXPECT_TRUE(content(path("a.md")).starts_with("# Speed against accuracy\n"));
  EXPECT_NE(content(path("a.md")).find("## Which method to take"), std::string::npos);
  if (draws) {
    EXPECT_NE(content(path("a.svg")).find("<svg"), std::string::npos);
  }
}

TEST_F(Command, RefusesATradeoffThatItCannotWriteOrDoesNotKnow) {
  expect_refused("tradeoff --quick --json " + path("none/a.json"), {"none/a.json"});
  expect_refused("tradeoff --work nothing", {"--work", "nothing"});
}

}  // namespace
}  // namespace breakaway::testing
