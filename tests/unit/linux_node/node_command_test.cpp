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

Ended run(const std::string& arguments) {
  FILE* const pipe = ::popen(("'" BREAKAWAY_NODE "' " + arguments).c_str(), "r");
  if (pipe == nullptr) return {-1, "no pipe"};
  std::string said;
  std::array<char, 4096> piece{};
  while (const std::size_t taken = std::fread(piece.data(), 1, piece.size(), pipe)) said.append(piece.data(), taken);
  const int status = ::pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, said};
}

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

}  // namespace
}  // namespace breakaway::linux_node
