// What Progress writes, by a file in place of the terminal.
#include "../../../sim/cli/src/progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace {

using breakaway::cli::Progress;

std::string written(bool asked, bool terminal, const auto& use) {
  std::FILE* const file = std::tmpfile();
  {
    Progress progress{"counting", asked, file, terminal};
    use(progress);
  }
  std::rewind(file);
  std::string text;
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) text += static_cast<char>(c);
  std::fclose(file);
  return text;
}

void count_to_a_thousand(Progress& progress) {
  for (int i = 0; i <= 1000; ++i) progress.tell(i / 1000.0);
}

TEST(Progress, WritesNothingUnlessAskedOrOnATerminal) {
  EXPECT_EQ(written(false, false, count_to_a_thousand), "");
  EXPECT_EQ(written(false, false, [](Progress& p) { p.say("waiting"); }), "");
}

TEST(Progress, TellsEveryTenthInALineOfItsOwnWhenAsked) {
  const std::string text = written(true, false, count_to_a_thousand);
  EXPECT_EQ(std::ranges::count(text, '\n'), 10);
  EXPECT_TRUE(text.starts_with("counting: 10 %, 0 s to go\n")) << text;
  EXPECT_NE(text.find("counting: 100 %, 0 s to go\n"), std::string::npos);
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

TEST(Progress, RenewsOneLineOnATerminalAndClearsIt) {
  const std::string text = written(false, true, count_to_a_thousand);
  EXPECT_TRUE(text.starts_with("\r\033[Kcounting: 0 %, ")) << text;
  EXPECT_TRUE(text.ends_with("\r\033[K"));
  EXPECT_EQ(text.find('\n'), std::string::npos);
}

TEST(Progress, SaysWhatIsDoneWhereItsLengthIsUnknown) {
  EXPECT_EQ(written(true, false, [](Progress& p) { p.say("drawing"); }), "counting: drawing ...\n");
}

TEST(Progress, TakesAnyShare) {
  const std::string text = written(true, false, [](Progress& p) {
    for (const double share : {-1.0, 0.0, std::nan(""), 2.0}) p.tell(share);
  });
  EXPECT_EQ(text, "counting: 100 %, 0 s to go\n");
}

}  // namespace
