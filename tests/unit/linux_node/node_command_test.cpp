#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

namespace breakaway::linux_node {
namespace {

struct Ended {
  int exit_code;
  std::string said;  // on the end of the pipe
};

Ended run_script(const std::string& script) {
  FILE* const pipe = ::popen(script.c_str(), "r");
  if (pipe == nullptr) return {-1, "no pipe"};
  std::string said;
  std::array<char, 4096> piece{};
  while (const std::size_t taken = std::fread(piece.data(), 1, piece.size(), pipe)) said.append(piece.data(), taken);
  const int status = ::pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, said};
}

Ended run(const std::string& arguments) { return run_script("'" BREAKAWAY_NODE "' " + arguments); }

TEST(NodeCommand, HelpNamesTheOptionsAsTheyAreTyped) {
  const Ended help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.said.find("--no-realtime "), std::string::npos) << help.said;
  EXPECT_EQ(help.said.find('{'), std::string::npos) << help.said;
}

TEST(NodeCommand, SaysThatStandardOutputTookNoHelp) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  for (const char* asked : {"--help", "--version"}) {
    const Ended ended = run(std::string{asked} + " 2>&1 >/dev/full");
    EXPECT_EQ(ended.exit_code, 1) << asked;
    EXPECT_EQ(ended.said, "breakaway-node: standard output: cannot be written\n") << asked;
  }
}

TEST(NodeCommand, TakesNoEmptyNameForAnOptionThatWasLeftOut) {
  for (const char* option : {"--can", "--csv", "--candump", "--stream"}) {
    const std::string can = option == std::string{"--can"} ? "" : " --can can0";
    const Ended ended = run("axis.toml" + can + " " + option + " '' 2>&1");
    EXPECT_EQ(ended.exit_code, 2) << option;
    EXPECT_NE(ended.said.find(std::string{option} + ": the name is empty"), std::string::npos) << ended.said;
  }
}

// The pipe opens once the node has begun to read its file.
TEST(NodeCommand, GoesOnAtAnAcknowledgementBeforeItHasReadItsFile) {
  const std::string folder = ::testing::TempDir() + "acknowledged_early", file = folder + "/axis.toml";
  std::filesystem::create_directories(folder);
  const std::string script = "rm -f '" + file + "'; mkfifo '" + file + "'; '" BREAKAWAY_NODE "' --can can0 '" + file +
                             "' 2>&1 & exec 3>'" + file + "'; kill -USR1 $!; echo no file >&3; exec 3>&-; wait $!";
  const Ended ended = run_script(script);
  EXPECT_EQ(ended.exit_code, 2) << ended.said;
  EXPECT_NE(ended.said.find(file), std::string::npos) << ended.said;
}

}  // namespace
}  // namespace breakaway::linux_node
