#include "outlet.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "../refusal.hpp"
#include "../scratch_folder.hpp"

namespace {

using namespace std::chrono_literals;
using breakaway::linux_node::Outlet;
using breakaway::testing::refusal;

// Nothing of what is not written is: a busy machine has time.
const auto long_from_now = [] { return Outlet::Clock::now() + 60s; };

class OutletTest : public breakaway::testing::ScratchFolder {
 protected:
  static std::string error_while(const auto& action) {
    ::testing::internal::CaptureStderr();
    action();
    return ::testing::internal::GetCapturedStderr();
  }
};

TEST_F(OutletTest, WritesEveryLineAfterTheHeader) {
  Outlet outlet{path("log"), "header\n"};
  for (int n = 0; n < 50'000; ++n) {
    outlet.put("a line of a log\n");
    if (n % 100 == 0) outlet.flush();
  }
  outlet.close(long_from_now());
  EXPECT_TRUE(outlet.wrote_everything());
  EXPECT_EQ(outlet.lost(), 0U);
  EXPECT_EQ(std::filesystem::file_size(path("log")), 7U + 50'000U * 16U);
  EXPECT_EQ(content(path("log")).substr(0, 23), "header\na line of a log\n");
}

TEST_F(OutletTest, WhatIsFlushedIsThereBeforeTheEnd) {
  Outlet outlet{path("log"), "header\n"};
  outlet.put("line\n");
  outlet.flush();
  for (const auto latest = long_from_now(); content(path("log")) != "header\nline\n";)
    ASSERT_LT(Outlet::Clock::now(), latest);
}

TEST_F(OutletTest, AnOlderFileStaysUntilItIsReplaced) {
  std::ofstream{path("log")} << "an older record, longer than what comes\n";
  {
    Outlet refused{path("log"), "header\n"};
    refused.put("line\n");
    refused.flush();
    refused.close(long_from_now());
    EXPECT_FALSE(refused.wrote_everything());
  }
  EXPECT_EQ(content(path("log")), "an older record, longer than what comes\n");
  Outlet outlet{path("log"), "header\n"};
  outlet.put("of the set-up\n");
  outlet.begin();
  outlet.put("line\n");
  outlet.close(long_from_now());
  EXPECT_TRUE(outlet.wrote_everything());
  EXPECT_EQ(content(path("log")), "header\nof the set-up\nline\n");
}

TEST_F(OutletTest, ALongSetUpLosesNothingForAnOlderFile) {
  std::ofstream{path("log")} << "an older record\n";
  const std::string lines(1 << 20, '\n');
  Outlet outlet{path("log"), ""};
  for (int n = 0; n < 9; ++n) outlet.put(lines);
  outlet.flush();
  for (const auto latest = long_from_now(); std::filesystem::file_size(path("log")) != 9 * lines.size();)
    ASSERT_LT(Outlet::Clock::now(), latest);
}

TEST_F(OutletTest, AFullDiskIsNamedOnceAndCosts) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  const std::string error = error_while([] {
    Outlet outlet{"/dev/full", "header\n"};
    for (int n = 0; n < 3; ++n) {
      outlet.put("line\nline\n");
      outlet.flush();
    }
    outlet.close(long_from_now());
    EXPECT_EQ(outlet.lost(), 6U);
    EXPECT_FALSE(outlet.wrote_everything());
  });
  EXPECT_EQ(error, "breakaway-node: /dev/full: cannot be written: No space left on device\n");
}

TEST_F(OutletTest, AReaderThatIsGoneIsNamedAndNoSignal) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  close(ends[0]);
  const std::string error = error_while([&] {
    Outlet outlet{"standard output", ends[1]};
    outlet.put("line\n");
    outlet.close(long_from_now());
    EXPECT_EQ(outlet.lost(), 1U);
  });
  EXPECT_EQ(error, "breakaway-node: standard output: cannot be written: Broken pipe\n");
  close(ends[1]);
}

TEST_F(OutletTest, AReaderThatStallsKeepsNobody) {
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  const int reader = open(path("fifo").c_str(), O_RDWR);
  const std::string error = error_while([&] {
    Outlet outlet{path("fifo"), ""};
    const std::string lines(1 << 20, '\n');
    // More than a pipe and the outlet have room for.
    for (int n = 0; n < 30; ++n) {
      outlet.put(lines);
      outlet.flush();
    }
    outlet.close(Outlet::Clock::now() + 10ms);
    EXPECT_GE(outlet.lost(), 13U << 20);
    EXPECT_FALSE(outlet.wrote_everything());
  });
  EXPECT_EQ(error, "breakaway-node: " + path("fifo") + ": cannot be written: nobody takes what is written to it\n");
  close(reader);
}

TEST_F(OutletTest, WhatCannotBeOpenedIsRefusedByName) {
  const std::string why = refusal([&] { Outlet{path("nowhere/log"), ""}; });
  EXPECT_EQ(why, path("nowhere/log") + ": cannot be written: No such file or directory");
}

}  // namespace
