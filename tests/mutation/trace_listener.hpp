// Included at the end of every test file of a mutated copy: writes, for each test, its processor time (on a machine
// that others use, the clock tells little) and the mutants that would have made a difference in it.
// BREAKAWAY_MUTANT_TRACE names the file, a line a test: name, milliseconds, whether it failed, numbers.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace mutation {

inline long long milliseconds_of(int who) {
  rusage used{};
  getrusage(who, &used);
  return 1000LL * (used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         (used.ru_utime.tv_usec + used.ru_stime.tv_usec) / 1000;
}
// Of this process and of the children that it waited for.
inline long long processor_ms() { return milliseconds_of(RUSAGE_SELF) + milliseconds_of(RUSAGE_CHILDREN); }

class TraceListener : public ::testing::EmptyTestEventListener {
 public:
  explicit TraceListener(std::FILE* file) : file_{file} {}

 private:
  void OnTestStart(const ::testing::TestInfo& /*info*/) override { began_ms_ = processor_ms(); }
  void OnTestEnd(const ::testing::TestInfo& info) override {
    std::fprintf(file_, "%s.%s %lld %d", info.test_suite_name(), info.name(), processor_ms() - began_ms_,
                 info.result()->Failed() ? 1 : 0);
    for (int id = 1; marks != nullptr && id < most_mutants; ++id) {
      if (marks[id] != 0) std::fprintf(file_, " %d", id);
    }
    std::fputc('\n', file_);
    std::fflush(file_);
    if (marks != nullptr) std::memset(marks, 0, most_mutants);
  }

  std::FILE* file_;
  long long began_ms_ = 0;
};

inline bool listen() {
  const char* const path = std::getenv("BREAKAWAY_MUTANT_TRACE");
  std::FILE* const file = path == nullptr ? nullptr : std::fopen(path, "w");
  if (file != nullptr) ::testing::UnitTest::GetInstance()->listeners().Append(new TraceListener{file});
  return file != nullptr;
}

inline const bool listens = listen();

}  // namespace mutation
