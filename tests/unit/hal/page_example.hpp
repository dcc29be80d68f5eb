// Holds the example in a header's comment against the code that a test compiles and runs.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace breakaway::test {

// The lines of `test` between its two marks must stand in the comment at the top of `header`, one behind the other.
// Both paths are from the root of the source tree.
inline void expect_page_shows_example(const std::string& header, const std::string& test) {
  const std::string root = BREAKAWAY_SOURCE_DIR "/";
  std::string example, line;
  int marks = 0;
  for (std::ifstream in{root + test}; std::getline(in, line);) {
    if (line == "// [page]")
      ++marks;
    else if (marks == 1)
      example += line.empty() ? "//\n" : "//   " + line + "\n";
  }
  ASSERT_EQ(marks, 2) << test;
  std::ostringstream page;
  page << std::ifstream{root + header}.rdbuf();
  EXPECT_NE(page.str().find(example), std::string::npos) << header << " does not show this:\n" << example;
}

}  // namespace breakaway::test
