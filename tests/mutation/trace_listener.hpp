// Included at the end of every test file of a mutated copy: writes, for each test, its time and the mutants that would
// have made a difference in it. BREAKAWAY_MUTANT_TRACE names the file, a line a test: name, milliseconds, numbers.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace mutation {

class TraceListener : public testing::EmptyTestEventListener {
 public:
  explicit TraceListener(std::FILE* file) : file_{file} {}

 private:
  void OnTestEnd(const testing::TestInfo& info) override {
    std::fprintf(file_, "%s.%s %lld %d", info.test_suite_name(), info.name(),
                 static_cast<long long>(info.result()->elapsed_time()), info.result()->Failed() ? 1 : 0);
    for (int id = 1; marks != nullptr && id < most_mutants; ++id) {
      if (marks[id] != 0) std::fprintf(file_, " %d", id);
    }
    std::fputc('\n', file_);
    std::fflush(file_);
    if (marks != nullptr) std::memset(marks, 0, most_mutants);
  }

  std::FILE* file_;
};

inline bool listen() {
  const char* const path = std::getenv("BREAKAWAY_MUTANT_TRACE");
  std::FILE* const file = path == nullptr ? nullptr : std::fopen(path, "w");
  if (file != nullptr) testing::UnitTest::GetInstance()->listeners().Append(new TraceListener{file});
  return file != nullptr;
}

inline const bool listens = listen();

}  // namespace mutation
