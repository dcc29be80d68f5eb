// The thread beside the loop: writes the logs and the status line, and takes the operator's signals.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "options.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

class Reporter {
 public:
  // From here on SIGINT, SIGTERM and SIGUSR1 arrive as wishes in `telemetry`. Call it before there is another thread,
  // and before the caller takes a real-time priority. Throws InputError: a log cannot be written.
  Reporter(const Options& options, Telemetry& telemetry, double encoder_resolution_m);
  Reporter(const Reporter&) = delete;
  Reporter& operator=(const Reporter&) = delete;
  ~Reporter() { finish(); }

  // Returns when everything is written.
  void finish();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;

  static File open(const std::string& path);
  void run();
  void take_signals();
  void drain();
  void write(const StepRecord& step);
  void write(const FrameRecord& record);
  void show(const StepRecord& step, bool live);
  void put(const File& file) const;

  Telemetry& telemetry_;
  std::string interface_;
  double resolution_m_;
  File csv_, candump_;
  std::string line_;
  hal::Duration to_realtime_{};  // of CLOCK_MONOTONIC
  hal::Time start_{};
  StepRecord shown_{};
  hal::Time shown_at_{};
  bool any_shown_ = false;
  bool terminal_ = false;
  std::thread thread_;
};

}  // namespace breakaway::linux_node
