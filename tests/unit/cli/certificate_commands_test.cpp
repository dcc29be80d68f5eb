// What design, simulate and study say of a certificate, and of which files and runs there is none.
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "../number_after.hpp"
#include "command.hpp"

namespace breakaway::testing {
namespace {

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

TEST_F(Command, SaysTheSameOfACertificateWhicheverIsAsked) {
  const std::vector<std::pair<std::string, std::string>> scenes{{"can_axis.toml", ""},
                                                                {"presliding_axis.toml", ""},
                                                                {"fine_axis.toml", ""},
                                                                {"belt_axis.toml", ""},
                                                                {"worn_axis.toml", "[plant] backlash: "}};
  for (const auto& [file, reason] : scenes) {
    const Ended design = run("design " + scenarios + file), motion = run("simulate " + scenarios + file);
    const Ended study = run("study --laws 0 --start -0.01 0 " + scenarios + file);
    EXPECT_EQ(design.exit_code, reason.empty() ? 0 : 1) << file;
    for (const Ended* ended : {&design, &motion, &study})
      EXPECT_NE(ended->out.find(reason.empty() ? "certifi" : reason), std::string::npos) << file << ended->out;
    EXPECT_NE(motion.out.find(reason.empty() ? "certificate    yes" : "certificate    none"), std::string::npos)
        << file;
    EXPECT_NE(study.out.find(reason.empty() ? ": certified" : ": not certified"), std::string::npos) << file;
  }
}

// What is printed is rounded, to the side on which it holds.
TEST_F(Command, CertifiesTheLeastToleranceThatItPrintsAndNoLessThanTheErrorThatNewPromises) {
  const auto number_after = [](const std::string& text, const std::string& name) {
    const std::size_t at = text.find(name);
    return at == std::string::npos ? std::nan("") : std::strtod(text.c_str() + at + name.size(), nullptr);
  };
  std::string text = content(scenarios + "braked_axis.toml");
  const std::string printed = run("design " + scenarios + "braked_axis.toml").out;
  const double least_m = number_after(printed, "least tolerance ");
  const std::string key = "position_tolerance_m = ";
  const std::size_t value = text.find(key) + key.size();
  text.replace(value, text.find_first_of(" \n", value) - value, std::to_string(1e6 * least_m) + "e-6");
  text.insert(text.find(key), "fine_stage = false\n");
  const Ended typed = run("design " + scenario(text));
  EXPECT_EQ(typed.exit_code, 0) << least_m << typed.out;
  EXPECT_EQ(number_after(typed.out, "least tolerance "), least_m);

  const std::string known =
      "--mass 602.797 --friction-lower 4740.52 --friction-upper 4748.3 --encoder 2.65681e-09 --rate 250 "
      "--force 64105.6 --move 0.300609 --overwrite -o ";
  const double said_m = number_after(run("new " + known + path("new.toml")).out, "true error at rest at most ");
  const std::string design = run("design " + path("new.toml") + " --json -").out;
  EXPECT_GE(said_m, figure(design, "error_m"));
  EXPECT_LE(said_m, 1.01 * figure(design, "error_m"));
}

// What a certificate takes of the bus is held against the bus of the run.
TEST_F(Command, SaysWhereSyncWasOffWholePeriodsByMoreThanACertificateTakesIn) {
  for (const char* name : {"braked_axis.toml", "move_axis.toml", "three_axes.toml"})
    EXPECT_EQ(figure(run("simulate " + scenarios + name + " --json -").out, "sync_off_s"), 0) << name;

  std::string file = content(scenarios + "braked_axis.toml");
  file.insert(file.find("[bus]"),
              "emcy_information = [\"4210h\"]\n[drive.quirks]\ninforms_with = 0x4210\ninforms_every_s = 0.00137\n");
  std::ofstream{path("busy.toml")} << file;
  const Ended busy = run("simulate " + path("busy.toml"));
  EXPECT_NE(busy.out.find("  SYNC           off whole periods by up to "), std::string::npos) << busy.out;
  const double off_s = figure(run("simulate " + path("busy.toml") + " --json -").out, "sync_off_s");
  EXPECT_GT(off_s, 60e-6) << "the drive's message was on the wire";
  EXPECT_LE(off_s, 135e-6) << "a frame of eight bytes takes no longer";

  const std::string study = run("study " + path("busy.toml") + " --laws 0 --start -0.01 0").out;
  EXPECT_NE(study.find("SYNC of these runs was off whole periods by up to "), std::string::npos) << study;

  file.insert(file.find("current_loop_time_constant = 0.2"), "jitter_s = 1.35e-4\n");
  file.replace(file.find("position_tolerance_m = 2e-6"), 27, "position_tolerance_m = 3e-6");
  file.replace(file.find("settle_tolerance_m = 3e-6"), 25, "settle_tolerance_m = 4e-6");
  std::ofstream{path("told.toml")} << file;
  const Ended told = run("simulate " + path("told.toml"));
  EXPECT_NE(told.out.find("  certificate    yes"), std::string::npos) << told.out;
  EXPECT_EQ(told.out.find("  SYNC "), std::string::npos) << told.out;
}

// What the file says of the world is read by the same rules, whether a node is told of it or not.
TEST_F(Command, DesignRefusesTheFrictionLawThatSimulateRefuses) {
  std::string text = content(scenarios + "braked_axis.toml");
  const auto from = text.find("[friction.law]"), to = text.find("[controller]");
  for (const char* law :
       {"kind = \"sine_in_position\"\nperiod_m = 1e-6\n", "kind = \"constant\"\nvalue = 2\n", "kind = \"unknown\"\n"}) {
    const std::string file = scenario(text.substr(0, from) + "[friction.law]\n" + law + text.substr(to));
    for (const char* command : {"simulate ", "design ", "study "}) expect_refused(command + file, {"[friction.law] "});
  }
}

// A certificate is for moves of up to [move] distance_m.
TEST_F(Command, SaysWhichRunsAreLongerThanTheCertificateIsFor) {
  const std::string file = scenarios + "move_axis.toml", says = "longer than [move] distance_m = 0.5";
  const std::string starts = "study " + file + " --laws 0 --start -0.5 0 --start 0.51 0 --start 0.1 0";
  const std::string printed = run(starts).out;
  EXPECT_NE(printed.find("from 0.51 m it is not: a move of 0.51 m is " + says), std::string::npos) << printed;
  EXPECT_EQ(printed.find("it is not"), printed.rfind("it is not")) << printed;
  const std::string json = run(starts + " --json -").out;
  const auto second = json.find("\"position_m\": 0.51,");
  ASSERT_NE(second, std::string::npos);
  EXPECT_NE(json.rfind("\"certified\": false", second), std::string::npos);
  EXPECT_EQ(json.find("\"certified\": false", second), std::string::npos);

  std::string text = content(file);
  text.replace(text.find("position_m = 0.4 }"), 18, "position_m = -0.4 }");
  text.replace(text.find("position_m = -0.1 }"), 19, "position_m = 0.2 }");
  const std::string motion = run("simulate " + scenario(text)).out;
  EXPECT_NE(motion.find("certificate    yes, but not of this run: a move of 0.6 m is " + says), std::string::npos)
      << motion;
}

// It overshoots by 63 mm where 1 mm is certified from rest.
TEST_F(Command, SaysThatTheCertificateIsNotForAnAxisThatBeginsInMotion) {
  std::string text = content(scenarios + "can_axis.toml");
  text.replace(text.find("position_m = -4"), 15, "position_m = -0.1");
  text.replace(text.find("velocity_m_s = -4"), 17, "velocity_m_s = 4");
  const std::string motion = run("simulate " + scenario(text)).out;
  EXPECT_NE(motion.find("certificate    yes, but not of this run: it begins at 4 m/s"), std::string::npos) << motion;
  for (const std::string file : {"can_axis.toml", "braked_axis.toml"}) {
    EXPECT_NE(run("design " + scenarios + file).out.find("the axis rests when it is enabled"), std::string::npos);
    const std::string starts = "study " + scenarios + file + " --laws 0 --start -0.01 0 --start -0.1 -1";
    const std::string printed = run(starts).out;
    EXPECT_NE(printed.find(": certified"), std::string::npos) << printed;
    EXPECT_NE(printed.find("from -0.1 m it is not: it begins at -1 m/s"), std::string::npos) << printed;
    EXPECT_EQ(printed.find("it is not"), printed.rfind("it is not")) << printed;
    const std::string json = run(starts + " --json -").out;
    EXPECT_NE(json.find("\"certified\": true"), std::string::npos);
    EXPECT_NE(json.find("\"certified\": false"), std::string::npos);
  }
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

TEST_F(Command, CertifiesNoDriveWhoseWholeStepsAreTooWeak) {
  std::string text = content(scenarios + "can_axis.toml");
  text.replace(text.find("rated_torque_Nm = 0.5"), 21, "rated_torque_Nm = 80");  // steps of 4 N
  text.replace(text.find("max_force_N = 50"), 16, "max_force_N = 7");
  const Ended ended = run("design " + scenario(text));
  EXPECT_EQ(ended.exit_code, 1) << ended.out;
  EXPECT_NE(ended.out.find("6.75 is not at most 4"), std::string::npos) << ended.out;
}

}  // namespace
}  // namespace breakaway::testing
