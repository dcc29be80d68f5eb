#include "reporter.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "../scratch_folder.hpp"
#include "clock.hpp"

namespace {

using namespace std::chrono_literals;
using namespace breakaway::linux_node;
using breakaway::hal::DriveState;

class ReporterTest : public breakaway::testing::ScratchFolder {
 protected:
  ReporterTest() {
    pthread_sigmask(SIG_SETMASK, nullptr, &signals_);
    options_.configuration = BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml";
    options_.interface = "can0";
    configuration_ = read_configuration(options_);
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
  }
  ~ReporterTest() override {
    reporter_.reset();
    pthread_sigmask(SIG_SETMASK, &signals_, nullptr);
    ::testing::internal::GetCapturedStdout();
    ::testing::internal::GetCapturedStderr();
  }

  void start() { reporter_ = std::make_unique<Reporter>(options_, telemetry_, configuration_, manager_); }
  void step(int number = 1) {
    for (int n = 0; n < number; ++n) telemetry_.add(StepRecord{.time = monotonic_now(), .drive = DriveState::enabled});
  }
  // A busy machine has time.
  static bool comes_true(const auto& condition) {
    for (const auto latest = Outlet::Clock::now() + 60s; !condition(); std::this_thread::sleep_for(1ms))
      if (Outlet::Clock::now() > latest) return false;
    return true;
  }

  sigset_t signals_{};
  Options options_;
  Configuration configuration_;
  Telemetry telemetry_;
  ServiceManager manager_{{}, 1ms};
  std::unique_ptr<Reporter> reporter_;
};

TEST_F(ReporterTest, ObeysASignalWhileNobodyReadsALog) {
  options_.csv = path("fifo");
  ASSERT_EQ(mkfifo(options_.csv.c_str(), 0600), 0);
  const int reader = open(options_.csv.c_str(), O_RDWR);
  start();
  step(10'000);  // Many times what a pipe has room for.
  ASSERT_TRUE(comes_true([&] {
    int waiting = 0;
    return ioctl(reader, FIONREAD, &waiting) == 0 && waiting > 0;
  }));
  kill(getpid(), SIGTERM);
  if (!comes_true([this] { return telemetry_.stop.load(); })) {
    close(reader);  // lets go whoever waits for it
    FAIL() << "the signal was not obeyed";
  }
  reporter_->finish();
  EXPECT_GT(telemetry_.csv_unwritten, 0U);
  reporter_->print("");
  EXPECT_FALSE(reporter_->wrote_everything());
  close(reader);
}

TEST_F(ReporterTest, StopsWhenItsTerminalIsGone) {
  const auto before = std::signal(SIGHUP, SIG_DFL);  // whoever runs the tests may ignore it
  start();
  kill(getpid(), SIGHUP);
  EXPECT_TRUE(comes_true([this] { return telemetry_.stop.load(); }));
  std::signal(SIGHUP, before);
}

// Of two signals that wait the one with the lower number, SIGHUP, is taken first.
TEST_F(ReporterTest, GoesOnWithoutATerminalUnderNohup) {
  const auto before = std::signal(SIGHUP, SIG_IGN);
  start();
  kill(getpid(), SIGHUP);
  kill(getpid(), SIGUSR1);
  EXPECT_TRUE(comes_true([this] { return telemetry_.reset.load(); }));
  EXPECT_FALSE(telemetry_.stop);
  std::signal(SIGHUP, before);
}

TEST_F(ReporterTest, CountsWhatAFullDiskDoesNotTake) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  options_.csv = "/dev/full";
  options_.candump = path("log");
  start();
  step(100);
  telemetry_.add(FrameRecord{.time = monotonic_now(), .frame = {}});
  reporter_->finish();
  EXPECT_EQ(telemetry_.csv_unwritten, 100U);
  EXPECT_EQ(telemetry_.candump_unwritten, 0U);
  reporter_->print("");
  EXPECT_FALSE(reporter_->wrote_everything());
}

TEST_F(ReporterTest, KeepsAnOlderRecordWhereTheStartIsRefused) {
  options_.csv = path("record");
  std::ofstream{options_.csv} << "precious\n";
  start();
  step();
  reporter_.reset();
  EXPECT_EQ(content(options_.csv), "precious\n");
}

TEST_F(ReporterTest, ReplacesAnOlderRecordOnceTheDrivesAreSetUp) {
  options_.csv = path("record");
  std::ofstream{options_.csv} << "precious\n";
  start();
  step();
  telemetry_.ready = true;
  EXPECT_TRUE(comes_true([this] { return content(options_.csv).starts_with("time_s,"); }));
  step();
  reporter_->finish();
  reporter_->print("");
  EXPECT_TRUE(reporter_->wrote_everything());
  const std::string record = content(options_.csv);
  EXPECT_EQ(std::ranges::count(record, '\n'), 3) << record;
}

// 32 bits of counts have ten digits, and whoever evaluates the record has nothing else.
TEST_F(ReporterTest, WritesPlacesFarFromZeroToTheCount) {
  options_.csv = path("record");
  start();
  telemetry_.ready = true;
  EXPECT_TRUE(comes_true([this] { return content(options_.csv).starts_with("time_s,"); }));
  telemetry_.add(StepRecord{.time = monotonic_now(),
                            .target_counts = 2147483647,
                            .position_counts = 2147483646,
                            .drive = DriveState::enabled});
  reporter_->finish();
  EXPECT_NE(content(options_.csv).find(",2147.483647,2147.483646,"), std::string::npos) << content(options_.csv);
}

}  // namespace
