#include "breakaway/input/shell_word.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

namespace breakaway {
namespace {

TEST(ShellWord, IsThePlainTextWhereNothingInItMeansMore) {
  for (const char* text : {"axis.toml", "../a/b-c_2.toml", "ächse.toml", "AXIS-Z.toml"})
    EXPECT_EQ(shell_word(text), text);
  EXPECT_EQ(shell_word(""), "''");
}

TEST(ShellWord, IsReadAsTheTextByAShell) {
  for (const std::string text : {"a b.toml", "it's", "$HOME", "a;b", "~", "*?[x]", "a\"b\\c", "#1", "`id`"}) {
    const std::string command = "printf %s " + shell_word(text);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe{popen(command.c_str(), "r"), &pclose};
    ASSERT_NE(pipe, nullptr);
    std::array<char, 64> read{};
    const std::size_t length = std::fread(read.data(), 1, read.size(), pipe.get());
    EXPECT_EQ(std::string(read.data(), length), text) << command;
  }
}

}  // namespace
}  // namespace breakaway
