// `breakaway eds`; what its files hold is tested in tests/unit/eds, and that others read them in tests/package.
#include "command.hpp"

namespace breakaway::testing {
namespace {

class EdsCommandTest : public Command {
 protected:
  const std::string three_axes = scenarios + "three_axes.toml", one_axis = scenarios + "can_axis.toml";
};

TEST_F(EdsCommandTest, WritesTheNodesDataSheetByDefault) {
  const std::string fixed = "SOURCE_DATE_EPOCH=0";
  const Ended node = run("eds " + one_axis, fixed);
  EXPECT_EQ(node.exit_code, 0) << node.err;
  EXPECT_NE(node.out.find("CreationDate=01-01-1970\n"), std::string::npos);
  EXPECT_EQ(run("eds --node " + one_axis, fixed).out, node.out);
}

TEST_F(EdsCommandTest, RefusesADateThatIsNone) {
  for (const char* const seconds : {"", "-1", "tomorrow", "253402300800", "9999999999999999999"})
    expect_refused("eds " + one_axis, {"SOURCE_DATE_EPOCH"}, std::string{"SOURCE_DATE_EPOCH="} + seconds);
}

TEST_F(EdsCommandTest, NamesTheFileThatItWrites) {
  EXPECT_EQ(run("eds --drive " + one_axis + " -o " + path("own.eds")).exit_code, 0);
  EXPECT_EQ(content(path("own.eds")).rfind("[FileInfo]\nFileName=own.eds\n", 0), 0U);
}

TEST_F(EdsCommandTest, WritesTheDriveOfANamedAxis) {
  EXPECT_EQ(run("eds " + three_axes + " --drive --axis slide").exit_code, 0);
  expect_refused("eds " + three_axes + " --drive", {"three_axes.toml", "several axes", "--axis NAME"});
  expect_refused("eds " + three_axes + " --drive --axis w", {"w"});
}

TEST_F(EdsCommandTest, RefusesWhatHasNoNode) {
  expect_refused("eds " + scenarios + "impulsive_example.toml", {"[loop] is missing"});
  expect_refused("eds --drive " + scenarios + "impulsive_example.toml", {"has no [drive]"});
  expect_refused("eds " + scenarios + "can_axis_pid.toml", {"\"pid\""});
  expect_refused("eds --node --drive " + one_axis, {"--node", "--drive"});
  expect_refused("eds --axis slide " + three_axes, {"--drive"});
}

TEST_F(EdsCommandTest, RefusesAFileOverItsOwnScenario) {
  expect_refused("eds " + scenario("title = \"t\"\n") + " -o " + path("axis.toml"), {"axis.toml"});
}

}  // namespace
}  // namespace breakaway::testing
