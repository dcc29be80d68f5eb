// The way from an unknown axis to a certified one: new, tune and identify, what a study says and requires, and all that
// by pipes.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "../number_after.hpp"
#include "command.hpp"

namespace breakaway::testing {
namespace {

constexpr const char* seven_numbers =
    " --mass 12 --friction-lower 15 --friction-upper 28 --encoder 5e-7 --rate 1000 --force 200 --move 0.4";

TEST_F(Command, WritesAFileFromSevenNumbersThatEveryOtherCommandTakes) {
  const std::string file = path("new.toml");
  const Ended made = run("new" + std::string{seven_numbers} + " -o " + file);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_NE(made.out.find("certified"), std::string::npos) << made.out;
  EXPECT_EQ(run("design " + file).exit_code, 0);
  const Ended motion = run("simulate " + file + " --json -");
  EXPECT_EQ(motion.exit_code, 0) << motion.err;
  EXPECT_LE(figure(motion.out, "beyond_m"), 2.5e-7);
  EXPECT_EQ(run("study --laws 2 " + file).exit_code, 0);
  const std::string kept = content(file);
  expect_refused("new" + std::string{seven_numbers} + " -o " + file, {"new.toml", "is there already", "--overwrite"});
  EXPECT_EQ(content(file), kept);
  EXPECT_EQ(run("new --overwrite" + std::string{seven_numbers} + " -o " + file).exit_code, 0);
}

// What is tuned again for time with a number twice as good, and is slower all the same, is said to gain nothing.
void expect_that_no_loss_is_called_a_gain(const std::string& printed) {
  const std::regex line{": ([0-9.]+) s instead of ([0-9.]+) s([^\n]*)"};
  int lines = 0;
  for (std::sregex_iterator found{printed.begin(), printed.end(), line}, end; found != end; ++found, ++lines) {
    const double after_s = std::stod((*found)[1]), before_s = std::stod((*found)[2]);
    if (after_s == before_s) continue;
    EXPECT_EQ((*found)[3].str().ends_with("gains nothing"), after_s > before_s) << found->str();
  }
  EXPECT_GE(lines, 4) << printed;
}

TEST_F(Command, TunesAnAxisIntoAFileThatEveryOtherCommandTakes) {
  const std::string file = path("new.toml"), tuned = path("tuned.toml");
  ASSERT_EQ(run("new" + std::string{seven_numbers} + " -o " + file).exit_code, 0);
  const Ended ended = run("tune --laws 2 " + file + " --for time -o " + tuned + " --json " + path("tuned.json") +
                          " --picture " + path("tuned.svg"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_NE(ended.out.find("settling time is limited most by the force"), std::string::npos) << ended.out;
  EXPECT_NE(content(path("tuned.svg")).find("<svg"), std::string::npos);
  expect_that_no_loss_is_called_a_gain(ended.out);
  const std::string json = content(path("tuned.json"));
  expect_keys(json, {"objective", "distance_m", "least_tolerance_m", "chosen", "numbers", "limits", "tried", "why"});
  const Ended study = run("study --laws 2 --start -0.4 0 --json - " + tuned);
  ASSERT_EQ(study.exit_code, 0) << study.err;
  EXPECT_EQ(figure(study.out, "worst_settling_s"), figure(json, "worst_settling_s"));
  EXPECT_EQ(run("design " + tuned).exit_code, 0);
  const std::string kept = content(tuned);
  expect_refused("tune --laws 0 " + file + " -o " + tuned, {"tuned.toml", "is there already", "--overwrite"});
  expect_refused("tune --laws 0 " + file + " -o - --json -", {"two outputs"});
  expect_refused("tune --laws 0 " + file + " --picture tuned.pdf", {"tuned.pdf", ".svg"});
  expect_refused("tune " + file + " --for speed", {"--for", "speed"});
  expect_refused("tune " + file + " --seed -1", {"--seed: -1 is not a whole number, 0 or above"});
  expect_refused("tune " + path("none.toml"), {"none.toml"});
  EXPECT_EQ(content(tuned), kept);
}

TEST_F(Command, RequiresWhatAScriptAsksOfAStudy) {
  const std::string study = "study " + scenarios + "braked_axis.toml --laws 0 --start -0.1 0";
  EXPECT_EQ(run(study + " --require 'worst_settling_s<=0.5' --require 'settled>=4'").exit_code, 0);
  const Ended slow =
      run(study + " --require 'worst_settling_s<=0.01' --require 'faulted<=0' --junit " + path("study.xml"));
  EXPECT_EQ(slow.exit_code, 1);
  EXPECT_EQ(std::ranges::count(slow.err, '\n'), 1) << slow.err;
  for (const char* part : {"braked_axis.toml", "worst_settling_s<=0.01", "it is 0.1"})
    EXPECT_NE(slow.err.find(part), std::string::npos) << part << " in " << slow.err;
  const std::string junit = content(path("study.xml"));
  EXPECT_NE(junit.find("tests=\"6\" failures=\"1\""), std::string::npos) << junit;
  EXPECT_NE(junit.find("worst_settling_s&lt;=0.01"), std::string::npos) << junit;
  expect_refused(study + " --require 'speed<=1'", {"speed", "worst_settling_s", "overshoot_m"});
  EXPECT_EQ(run(study + " --require ' worst_settling_s <= 0.5 '").exit_code, 0)
      << "spaces are those of the shell's word";
  expect_refused(study + " --require 'worst_settling_s<=fast'", {"fast", "not a finite number"});
  expect_refused(study + " --require worst_settling_s", {"worst_settling_s<=0.5"});
  expect_refused(study + " --json - --junit -", {"two outputs"});
  expect_refused(study + " --start -0.1", {"--start", "POSITION VELOCITY"});
  expect_refused(study + " --start -0.1 0 -0.2", {"not expected: -0.2"});
  EXPECT_EQ(run("study " + scenarios + "braked_axis.toml --laws 0 --start=-0.1,0").exit_code, 0);
}

TEST_F(Command, NamesTheWorstLawOfAStudyAndTheCommandThatRunsItAgain) {
  const Ended all = run("study " + scenarios + "can_axis_pid.toml --laws 12 --start -0.01 0");
  const auto worst = all.out.find("worst from -0.01 m: random, seed "), again = all.out.find("again: breakaway ");
  ASSERT_NE(worst, std::string::npos) << all.out;
  ASSERT_NE(again, std::string::npos) << all.out;
  const std::string command = all.out.substr(again + 17, all.out.find('\n', again) - again - 17);
  const std::string law = all.out.substr(worst, again - worst);
  EXPECT_NE(run(command).out.find(law), std::string::npos) << command << law;

  fs::copy(scenarios + "can_axis_pid.toml", path("a b.toml"));
  const Ended spaced = run("study '" + path("a b.toml") + "' --laws 0 --start -0.01 0");
  EXPECT_NE(spaced.out.find("again: breakaway study '" + path("a b.toml") + "' --start"), std::string::npos);
}

TEST_F(Command, RefusesANewAxisThatMayRestAsFarAwayAsItsLongestMove) {
  const auto axis = [](const std::string& encoder, const std::string& move) {
    return "new --mass 12 --friction-lower 15 --friction-upper 28 --rate 1000 --force 200 --encoder " + encoder +
           " --move " + move + " -o -";
  };
  expect_refused(axis("0.5", "0.4"), {"0.51 m away", "longest move is 0.4 m", "the encoder", "SI units"});
  EXPECT_EQ(run(axis("0.5e-3", "0.4")).exit_code, 0) << "a count of half a millimetre";
}

TEST_F(Command, AsksForTheNumbersOfANewAxisThatAreNotGiven) {
  const auto answered = [&](const std::string& answers, const std::string& given) {
    std::ofstream{path("answers")} << answers;
    return run("new -o - " + given + " < " + path("answers"));
  };
  const Ended given = run("new -o -" + std::string{seven_numbers});
  const Ended asked = answered("15\nmany\n\n-28\n10\n28\n 5e-7 \n300\n1000\n200\n0.4\n", "--mass 12");
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_EQ(asked.out, given.out);
  for (const char* problem : {"many is not a finite number above 0", "nothing is not a finite number above 0",
                              "15 and 10 N; the lower one must be below the upper", "take 250 or 312.5 Hz"})
    EXPECT_NE(asked.err.find(problem), std::string::npos) << asked.err;
  EXPECT_EQ(asked.err.find("Mass"), std::string::npos) << asked.err;
  const Ended silent = answered("15\n", "--mass 12");
  EXPECT_EQ(silent.exit_code, 2);
  EXPECT_NE(silent.err.find("add --friction-upper NUMBER"), std::string::npos) << silent.err;
  expect_refused("new --mass nan", {"nan", "--mass"});
}

// Writes to standard output.
const std::string new_axis = "new" + std::string{seven_numbers} + " -o - ";

TEST_F(Command, ReadsStandardInputWhereAFileIsTaken) {
  const std::string piped = new_axis + "| '" BREAKAWAY_COMMAND "' ";
  for (const char* command : {"design - --json - ", "simulate - --json - ", "study - --laws 1 --json - ",
                              "identify - --json - ", "tune - --laws 0 --json - "}) {
    const Ended ended = run(piped + command);
    EXPECT_EQ(ended.exit_code, 0) << command << ended.err;
    EXPECT_TRUE(ended.out.starts_with("{\n")) << command << ended.out;
  }
}

TEST_F(Command, CallsStandardInputByItsName) {
  const std::string piped = new_axis + "| sed s/^mass_kg/mass/ | '" BREAKAWAY_COMMAND "' ";
  for (const char* command : {"design -", "simulate -", "study -", "identify -", "tune -"})
    expect_refused(piped + command, {"breakaway: standard input:", "[plant] mass", "nearest valid key"});
  expect_refused("identify - --log - < /dev/null", {"-: two inputs would come from there", "--log"});
}

// A path of [drive] eds leads from the folder of its file, and tune and identify may be told to write into another one.
TEST_F(Command, WritesAFileIntoAnotherFolderThatStillFindsItsDataSheet) {
  const std::string own = path("own/axis.toml"), tuned = path("other/tuned.toml"), found = path("other/found.toml");
  for (const char* folder : {"own", "other"}) std::filesystem::create_directory(path(folder));
  ASSERT_EQ(run("new" + std::string{seven_numbers} + " -o " + own).exit_code, 0);
  ASSERT_EQ(run("eds --drive " + own + " -o " + path("own/drive.eds")).exit_code, 0);
  std::string text = content(own);
  text.insert(text.find("rated_torque_Nm"), "eds = \"drive.eds\"\n");
  std::ofstream{own} << text;
  ASSERT_EQ(run("tune --laws 0 " + own + " -o " + tuned).exit_code, 0);
  const Ended design = run("design " + tuned), identified = run("identify " + own + " -o " + found);
  EXPECT_EQ(design.exit_code, 0) << design.err;
  EXPECT_EQ(identified.exit_code, 0) << identified.err;
  EXPECT_NE(content(found).find("../own/drive.eds"), std::string::npos);
}

// What --require takes stands in --json under the same name, so that a bound is the figure that was read there.
TEST_F(Command, RequiresQuantitiesByTheirNamesInTheJsonOfAStudy) {
  const std::string study = "study " + scenarios + "braked_axis.toml --laws 0 --start -0.1 0";
  const std::string refusal = run(study + " --require 'no<=1'").err, json = run(study + " --json -").out;
  const std::string_view introduction = "there are ";
  const std::size_t names = refusal.find(introduction);
  ASSERT_NE(names, std::string::npos) << refusal;
  std::istringstream listed{refusal.substr(names + introduction.size())};
  int found = 0;
  for (std::string name; listed >> name; ++found) {
    if (name.ends_with(',')) name.pop_back();
    EXPECT_NE(json.find("\"" + name + "\": "), std::string::npos) << name;
  }
  EXPECT_GE(found, 11);
}

TEST_F(Command, ReportsAStudyWithTheWorstLawAndTheCommandThatRunsItAgain) {
  const Ended ended =
      run("study " + scenarios + "braked_axis.toml --laws 6 --start -0.01 0 --report " + path("study.html"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const std::string page = content(path("study.html"));
  for (const char* part : {"Settling times", "Errors", "Worst law", "Response", "Position error", "<svg"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  const auto at = page.find("breakaway study ");
  ASSERT_NE(at, std::string::npos);
  const std::string again = page.substr(at, page.find('<', at) - at);
  EXPECT_NE(ended.out.find(again), std::string::npos) << again;
  const auto worst = [](const Ended& e) { return figure(e.out, "worst_settling_s"); };
  const Ended all = run("study " + scenarios + "braked_axis.toml --laws 6 --start -0.01 0 --json -");
  EXPECT_EQ(worst(run(again.substr(std::string{"breakaway "}.size()) + " --json -")), worst(all)) << again;
}

TEST_F(Command, IdentifiesAnAxisAndWritesAFileThatDesignTakes) {
  const std::string range = " --from -4.5 --to -3.5", axis = scenarios + "braked_axis.toml";
  const std::string outputs =
      " -o " + path("found.toml") + " --csv " + path("run.csv") + " --json " + path("found.json");
  const Ended ended = run("identify " + axis + range + outputs);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_NE(ended.out.find("latency        1 period"), std::string::npos) << ended.out;
  const std::string found = content(path("found.json"));
  expect_keys(found,
              {"mass_kg", "mass_uncertainty", "friction_bounds_N", "latency_periods", "chance_outside", "friction"});
  EXPECT_NEAR(figure(found, "mass_kg"), 1, 0.02);
  EXPECT_EQ(figure(found, "latency_periods"), 1);
  EXPECT_NE(run("design " + path("found.toml")).exit_code, 2);
  EXPECT_NE(content(path("found.toml")).find("# a drum of 20 mm radius"), std::string::npos);
  const Ended again = run("identify " + axis + " --log " + path("run.csv") + " --json -");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NEAR(figure(again.out, "mass_kg"), figure(found, "mass_kg"), 1e-6);
}

// They would be passed over without a word.
TEST_F(Command, RefusesOptionsOfAnExperimentBesideARecord) {
  for (const char* option : {"--from -4.5", "--to -3.5", "--duration 60"}) {
    const std::string name{option, std::string_view{option}.find(' ')};
    expect_refused("identify " + scenarios + "braked_axis.toml --log " + path("run.csv") + " " + option,
                   {name + ": says how to make an experiment", "--log"});
  }
}

// The record of a run whose forces had been commanded by so many periods earlier.
std::string with_forces_commanded_earlier(const std::string& record, int periods) {
  std::istringstream in{record};
  std::string header, line;
  std::getline(in, header);
  std::vector<std::string> read, commanded;
  while (std::getline(in, line)) {
    const std::size_t comma = line.rfind(',');
    read.push_back(line.substr(0, comma));
    commanded.push_back(line.substr(comma));
  }
  std::string out = header + '\n';
  for (int i = 0; i < std::ssize(read); ++i) {
    const auto from = std::clamp<std::ptrdiff_t>(i + periods, 0, std::ssize(read) - 1);
    out += read[static_cast<std::size_t>(i)];
    out += commanded[static_cast<std::size_t>(from)];
    out += '\n';
  }
  return out;
}

TEST_F(Command, SaysOfARecordWithAnotherLatencyThatItIsOfAnotherLoop) {
  const std::string axis = scenarios + "braked_axis.toml", record = path("run.csv"), found = path("found.toml");
  std::string text = content(axis);
  const std::string lag = "current_loop_time_constant_s = 1e-4";
  text.replace(text.find(lag), lag.size(), "current_loop_time_constant_s = 3e-4");
  ASSERT_EQ(run("identify " + axis + " --from -4.5 --to -3.5 --csv " + record).exit_code, 0);
  const std::string kept = content(record);
  const auto identify = [&](int periods_earlier) {
    std::ofstream{record} << with_forces_commanded_earlier(kept, periods_earlier);
    return run("identify " + scenario(text) + " --log " + record + " --overwrite -o " + found);
  };
  const auto lag_in_file = [&] { return number_after(content(found), "current_loop_time_constant_s = "); };

  EXPECT_NE(identify(0).out.find("next: breakaway design"), std::string::npos);
  EXPECT_NEAR(lag_in_file(), 1e-4, 2e-5) << "the lag of the loop that the file is for";

  const Ended at_once = identify(-1);
  EXPECT_NE(at_once.out.find("latency        0 periods"), std::string::npos) << at_once.out;
  EXPECT_NE(at_once.out.find("whose forces act before the next sample"), std::string::npos) << at_once.out;
  EXPECT_EQ(lag_in_file(), 3e-4) << "of another loop: the file's stays";

  const Ended late = identify(1);
  EXPECT_NE(late.out.find("latency        2 periods"), std::string::npos) << late.out;
  EXPECT_NE(late.out.find("find what takes 2: a drive that answers late"), std::string::npos) << late.out;
  EXPECT_NE(late.out.find("certificate    none: the forces of this loop act too late"), std::string::npos) << late.out;
  EXPECT_EQ(late.out.find("breakaway design"), std::string::npos) << late.out;
  EXPECT_EQ(lag_in_file(), 3e-4);
}

// From seven numbers and an experiment to an axis at rest, by the commands that the one before names.
TEST_F(Command, LeadsFromAnExperimentToACertifiedAxis) {
  const std::string axis = path("the axis.toml"), found = path("found it.toml"), tuned = path("tuned.toml");
  ASSERT_EQ(run("new" + std::string{seven_numbers} + " -o '" + axis + "'").exit_code, 0);
  std::string under_pd = content(axis);
  under_pd.replace(under_pd.find("coast = \"brake\""), 15, "coast = \"pd\"");
  std::ofstream{path("pd.toml")} << under_pd;
  for (const std::string& file : {axis, path("pd.toml")}) {
    const Ended identified = run("identify '" + file + "' --overwrite -o '" + found + "'");
    ASSERT_EQ(identified.exit_code, 0) << identified.err;
    EXPECT_EQ(run("design '" + found + "'").exit_code, 1) << "the tolerance is below that of the wider bounds";
    EXPECT_NE(identified.out.find("certificate    none: tolerance_above_floor"), std::string::npos) << identified.out;
    const std::string next = "next: breakaway tune '" + found + "' -o '" + path("found it_tuned.toml") + "'";
    EXPECT_NE(identified.out.find(next), std::string::npos) << identified.out;
    const Ended tuning = run("tune --laws 0 '" + found + "' --overwrite -o " + tuned);
    ASSERT_EQ(tuning.exit_code, 0) << tuning.err;
    EXPECT_EQ(run("design " + tuned).exit_code, 0);
    EXPECT_EQ(run("simulate " + tuned).exit_code, 0);
  }
  const Ended again = run("identify " + tuned + " --overwrite -o " + tuned);
  EXPECT_NE(again.out.find("next: breakaway "), std::string::npos) << again.out;
}

TEST_F(Command, LeadsToDesignWhereWhatWasIdentifiedIsCertified) {
  const std::string found = path("found.toml");
  const Ended ended = run("identify " + scenarios + "braked_axis.toml --from -4.5 --to -3.5 -o " + found);
  EXPECT_NE(ended.out.find("next: breakaway design " + found + "\n"), std::string::npos) << ended.out;
  EXPECT_EQ(run("design " + found).exit_code, 0);
}

TEST_F(Command, IdentifiesWithinTheTravelThatIsGivenWhereTheFileHasNone) {
  std::string text = content(scenarios + "braked_axis.toml");
  const std::string limit = "position_m = 10\n";
  text.erase(text.rfind(limit), limit.size());
  const std::string identify = "identify " + scenario(text);
  expect_refused(identify, {"[limits] position_m", "is missing"});
  expect_refused(identify + " --from -4.5", {"[limits] position_m", "is missing"});
  EXPECT_EQ(run(identify + " --from -4.5 --to -3.5").exit_code, 0);
}

// Nothing of either shows in the motor: a spring so soft, or damped so much.
TEST_F(Command, RefusesToIdentifyALoadWhoseSwingCannotBeSeen) {
  ASSERT_EQ(run("new" + std::string{seven_numbers} + " -o " + path("rigid.toml")).exit_code, 0);
  const std::pair<const char*, const char*> loads[] = {
      {"mass_kg = 2.696\nstiffness_N_per_m = 380.44\ndamping_Ns_per_m = 6.405\n", "no swing of a load"},
      {"mass_kg = 17.83\nstiffness_N_per_m = 4.6387e5\ndamping_Ns_per_m = 575.2\n", "nothing tells"}};
  for (const auto& [load, said] : loads) {
    std::string text = content(path("rigid.toml"));
    text.insert(text.find("[friction]"), std::string{"[plant.load]\n"} + load + "\n");
    std::ofstream{path("sprung.toml")} << text;
    expect_refused("identify " + path("sprung.toml") + " -o " + path("found.toml"), {"sprung.toml", said});
    EXPECT_FALSE(fs::exists(path("found.toml")));
  }
}

// A drive of 500 N at 250 Hz is beyond 0.1 m/s within a period.
TEST_F(Command, KeepsTheRecordOfAnExperimentThatAFaultStopped) {
  const std::string axis = path("strong.toml"), record = path("run.csv");
  const Ended made = run(
      "new --mass 1 --friction-lower 100 --friction-upper 150 --encoder 1e-6 --rate 250 --force 500 --move 0.1 -o -");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto slower = [](const std::string& text) {
    return std::regex_replace(std::regex_replace(text, std::regex{"\nspeed_m_s = [0-9.]+"}, "\nspeed_m_s = 0.1"),
                              std::regex{"max_approach_speed_m_s = [0-9.]+"}, "max_approach_speed_m_s = 0.04");
  };
  std::ofstream{axis} << slower(made.out);
  expect_refused("identify " + axis + " --csv " + record,
                 {"strong.toml", "the experiment was stopped by \"speed limit\"\n"});
  EXPECT_GT(content(record).size(), 1000u);
}

// Its tolerance is the only one of the scene that what was seen is too wide for.
TEST_F(Command, IdentifiesTheLoadOfABeltSoThatItsFileIsCertifiedAndSettles) {
  std::string text = content(scenarios + "belt_axis.toml");
  for (const auto& [from, to] : {std::pair{"position_tolerance_m = 3.2e-4", "position_tolerance_m = 4e-4"},
                                 std::pair{"settle_tolerance_m = 3.21e-4", "settle_tolerance_m = 4.01e-4"}})
    text.replace(text.find(from), std::string_view{from}.size(), to);
  const std::string found = path("belt_found.toml");
  const Ended ended = run("identify " + scenario(text) + " --from -0.3 --to 0.2 -o " + found);
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_NE(ended.out.find("load           swings on a spring, 59."), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("next: breakaway design " + found), std::string::npos) << ended.out;
  EXPECT_EQ(run("design " + found).exit_code, 0);
  EXPECT_EQ(run("simulate " + found).exit_code, 0);
}

TEST_F(Command, NamesWhatCannotBeIdentified) {
  expect_refused("identify " + scenarios + "two_axes.toml", {"--axis NAME"});
  expect_refused("identify " + scenarios + "impulsive_example.toml", {"[loop] period_s", "missing"});
  expect_refused("identify " + scenarios + "braked_axis.toml --from 1 --to 2",
                 {"outside its travel", "begins at -4 m", "1 to 2 m"});
  expect_refused("identify " + scenarios + "braked_axis.toml --duration 2", {"out of time", "give it more time"});
  expect_refused("identify " + scenarios + "braked_axis.toml --duration 0.1", {"--duration 0.1", "2 to 3600 s"});
  expect_refused("identify " + scenarios + "braked_axis.toml --log " + scenarios + "braked_axis.toml",
                 {"braked_axis.toml", "no column"});
  const Ended nowhere = run("identify " + scenarios + "braked_axis.toml --log " + path("none.csv"));
  EXPECT_EQ(nowhere.err.find("none.csv"), nowhere.err.rfind("none.csv")) << nowhere.err;
}

TEST_F(Command, SharesAStudyOutAndMergesItToTheSameBits) {
  const std::string axis = scenarios + "braked_axis.toml --laws 6 --start -0.1 0 --start -0.01 0 ";
  ASSERT_EQ(run("study " + axis + "--json " + path("whole.json") + " --csv " + path("whole.csv")).exit_code, 0);
  std::string tables;
  for (const char* part : {"3/3", "1/3", "2/3"}) {
    const std::string table = path(std::string{part[0]} + ".csv");
    const Ended ended = run("study " + axis + "--shard " + part + " --csv " + table);
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_NE(ended.out.find(std::string{"part "} + part[0] + " of 3 only"), std::string::npos) << ended.out;
    tables += " " + table;
  }
  const Ended merged = run("study " + axis + "--merge" + tables + " --json " + path("all.json") + " --csv " +
                           path("all.csv") + " --report " + path("study.html"));
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(content(path("all.csv")), content(path("whole.csv")));
  EXPECT_EQ(content(path("all.json")), content(path("whole.json")));
  expect_refused("study " + axis + "--merge " + path("1.csv"), {"of 20 runs are in none of the files"});
  expect_refused("study " + axis + "--seed 2 --merge" + tables, {"another file, --axis, --laws or --seed"});
  expect_refused("study " + axis + "--shard 4/3", {"--shard 4/3", "i from 1 to n"});
  expect_refused("study " + axis + "--shard 1/11", {"--shard 1/11", "10 laws"});
  expect_refused("study " + axis + "--shard 1/2 --merge " + path("1.csv"), {"leave out --shard"});
  expect_refused("study " + axis + "--csv x.csv --against " + scenarios + "can_axis.toml",
                 {"--against", "one scenario"});
}

TEST_F(Command, OfATaskOfAClusterDoesItsPart) {
  const std::string script = "PATH=\"$(dirname '" BREAKAWAY_COMMAND "'):$PATH\" bash '" BREAKAWAY_SOURCE_DIR
                             "/sim/study/cluster/study.sbatch' ";
  const std::string axis = scenarios + "braked_axis.toml --laws 2 --start -0.01 0 ";
  for (const char* task : {"1", "2"}) {
    const std::string call = "cd " + folder_.string() + " && export SLURM_ARRAY_TASK_ID=" + task +
                             " SLURM_ARRAY_TASK_COUNT=2; " + script + axis + "> said 2>&1";
    ASSERT_EQ(std::system(call.c_str()), 0) << content(path("said"));
  }
  const Ended merged = run("study " + axis + "--merge " + path("braked_axis.toml.*.csv"));
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_NE(merged.out.find("6/6"), std::string::npos) << merged.out;
  EXPECT_NE(std::system((script + axis + "> " + path("said") + " 2>&1").c_str()), 0);
  EXPECT_NE(content(path("said")).find("submit this by sbatch --array"), std::string::npos) << content(path("said"));
}

}  // namespace
}  // namespace breakaway::testing
