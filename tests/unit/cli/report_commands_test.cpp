// The pages that simulate, study and design write, with their pictures.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>

#include "command.hpp"

namespace breakaway::testing {
namespace {

// What is signed explains the coast of the axis, and calls no more proved than is.
TEST_F(Command, ExplainsInAReportToSignTheCoastOfItsAxis) {
  const std::string pd = "under a PD law", brake = "Coast \"brake\"", work = "Coast \"work\"";
  const std::string unused = "which this axis does not use";
  const auto page = [&](const std::string& file) {
    EXPECT_EQ(run("design " + file + " --report " + path("signed.html")).exit_code, 0) << file;
    return content(path("signed.html"));
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  const std::string of_pd = page(scenarios + "can_axis.toml"), of_brake = page(scenarios + "braked_axis.toml");
  const std::string of_work = page(scenarios + "belt_axis.toml");
  EXPECT_TRUE(has(of_pd, pd) && has(of_pd, "Of a sampled loop it is tested"));
  EXPECT_FALSE(has(of_pd, brake) || has(of_pd, work) || has(of_pd, unused) || has(of_pd, "The checks prove"));
  EXPECT_TRUE(has(of_brake, brake) && has(of_brake, unused));
  EXPECT_FALSE(has(of_brake, pd) || has(of_brake, work));
  EXPECT_TRUE(has(of_work, work) && has(of_work, unused));
  EXPECT_FALSE(has(of_work, pd) || has(of_work, brake));
  EXPECT_TRUE(has(of_pd, "Kick damping"));
  EXPECT_FALSE(has(of_brake, "Kick damping") || has(of_work, "Kick damping"));
  ASSERT_EQ(run("simulate " + scenarios + "braked_axis.toml --report " + path("run.html")).exit_code, 0);
  const std::string of_run = content(path("run.html"));
  EXPECT_TRUE(has(of_run, "Coast"));
  EXPECT_FALSE(has(of_run, "Kick damping"));
}

TEST_F(Command, DrawsTheKicksOfTheCoastBrake) {
  const Ended ended = run("design " + scenarios + "braked_axis.toml --report " + path("braked.html"));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const std::string page = content(path("braked.html"));
  for (const char* part :
       {"The kicks", "Accuracy against control period and lag", "lag of five periods", "Least tolerance"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(page.find("Error after each kick"), std::string::npos) << "that is of k3";
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

// It never leaves its set-up, so that there is nothing to draw.
TEST_F(Command, ReportsARunWhoseDriveCannotBeSetUp) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  std::string text = content(scenarios + "can_axis.toml");
  const std::string file = scenario(text.insert(text.find("[bus]"), "[drive.quirks]\nfixed_mapping = \"differs\"\n\n"));
  for (const std::string& command : {"simulate " + file, "study " + file + " --laws 0 --start -4 -4"}) {
    const Ended ended = run(command + " --report " + path("a.html"));
    EXPECT_EQ(ended.exit_code, 1) << command << ended.err;
    EXPECT_TRUE(content(path("a.html")).ends_with("</html>\n")) << command;
    EXPECT_EQ(ended.out.find("inf"), std::string::npos) << ended.out;
    EXPECT_NE(ended.out.find(command.starts_with("study") ? "never" : "way            -4 to -4 m"), std::string::npos)
        << ended.out;
  }
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

// A section of a page, from its title on; empty where there is none.
std::string section(const std::string& page, const std::string& title) {
  const auto from = page.find("<h2>" + title + "</h2>");
  return from == std::string::npos ? "" : page.substr(from, page.find("</section>", from) - from);
}

TEST_F(Command, DrawsOfEachCoastWhatPlaysAPartInIt) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const auto page_of = [&](const std::string& file) {
    EXPECT_EQ(run("simulate " + scenarios + file + " --report " + path("a.html")).exit_code, 0) << file;
    return content(path("a.html"));
  };
  const std::string near = "Phase plane near the target";
  const std::string pd = page_of("can_axis.toml");
  for (const std::string title : {"Phase plane", near.c_str()})
    EXPECT_NE(section(pd, title).find("minimal stick set"), std::string::npos) << title;
  EXPECT_NE(section(pd, "Impulse law k₃"), "");
  EXPECT_EQ(section(pd, "Kick table"), "");
  for (const std::string file : {"braked_axis.toml", "move_axis.toml", "belt_axis.toml"}) {
    const std::string kicked = page_of(file);
    EXPECT_EQ(kicked.find("minimal stick set"), std::string::npos) << file;
    EXPECT_EQ(section(kicked, "Impulse law k₃"), "") << file;
    EXPECT_EQ(section(kicked, "Kick table").empty(), file == "belt_axis.toml") << file << ": its pulses end by work";
    for (const char* part : {"tolerance", "kicks"})
      EXPECT_NE(section(kicked, near).find(part), std::string::npos) << part << ", " << file;
  }
}

TEST_F(Command, DrawsTheKicksOfTheCoastBrakeOverAsFarAsTheyGo) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const std::string scene = "simulate " + scenarios + "braked_axis.toml --report " + path("a.html") + " --json -";
  const double first_m = std::fabs(figure(run(scene).out.substr(run(scene).out.find("\"kicks\"")), "error_m"));
  const std::string picture = section(content(path("a.html")), "Phase plane near the target");
  // The number below an axis is "n×10" with the exponent raised.
  const std::regex tick{"(-?[0-9.]+)×10</tspan><tspan[^>]*>(-[0-9]+)<"};
  double furthest_m = 0;
  for (std::sregex_iterator found{picture.begin(), picture.end(), tick}, end; found != end; ++found)
    furthest_m = std::max(furthest_m, std::stod((*found)[1].str() + "e" + (*found)[2].str()));
  EXPECT_GT(furthest_m, 0.7 * first_m);
  EXPECT_LT(furthest_m, 1.4 * first_m) << "or the kicks are too small to be seen";
}

}  // namespace
}  // namespace breakaway::testing
