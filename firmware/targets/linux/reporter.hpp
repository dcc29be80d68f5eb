// The thread beside the loop: gives the logs and the status line to who writes them, takes the operator's signals, and
// tells the service manager that the node lives. That the thread which obeys SIGTERM tells it proves that this thread
// lives, too. It waits for nobody, least of all for who takes a log.
#pragma once

#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "breakaway/hal/bus_load.hpp"
#include "configuration.hpp"
#include "options.hpp"
#include "outlet.hpp"
#include "sample_stream.hpp"
#include "service_manager.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

class Reporter {
 public:
  // From here on SIGINT, SIGTERM, SIGHUP and SIGUSR1 arrive as wishes in `telemetry`. Call it before there is another
  // thread, and before the caller takes a real-time priority. Throws InputError: a log cannot be written.
  Reporter(const Options& options, Telemetry& telemetry, const Configuration& configuration, ServiceManager& manager);
  Reporter(const Reporter&) = delete;
  Reporter& operator=(const Reporter&) = delete;
  // Of a run that is refused: an older log stays as it was.
  ~Reporter();

  // Returns when the logs are written, or cannot be within a while. What they lack is in `telemetry` then.
  void finish();

  // What was streamed and what was not, in a line; after finish(). Empty where nothing was to be streamed.
  std::string stream_report() const;

  // The last word on standard output; after finish().
  void print(const std::string& report);
  // All logs and all of standard output; after print().
  bool wrote_everything() const;

 private:
  void run();
  void end();
  void take_signals();
  void drain();
  void replace_older_logs();
  void write(const StepRecord& step);
  void write(const FrameRecord& record);
  void show_change(const StepRecord& step);
  void show_live(hal::Time time);
  void print_line(bool live);
  void append_fault(const StepRecord& step);
  void tell_manager();
  double metres(const StepRecord& step, std::int32_t counts) const { return counts * axes_[step.axis].resolution_m; }
  double seconds(hal::Time time) const;
  // Since the epoch of CLOCK_REALTIME.
  hal::Duration on_realtime_clock(hal::Time time) const { return time.time_since_epoch() + to_realtime_; }

  Telemetry& telemetry_;
  std::string interface_;
  const std::vector<AxisPlan>& axes_;
  ServiceManager& manager_;
  std::optional<Outlet> csv_, candump_;
  Outlet standard_output_;
  std::optional<SampleStream> stream_;
  hal::BusLoad bus_load_;
  std::string line_;
  hal::Duration to_realtime_{};  // of CLOCK_MONOTONIC
  hal::Time start_{};
  std::vector<std::optional<StepRecord>> shown_;  // of each axis, as it was when it last changed
  std::vector<StepRecord> newest_;
  hal::Time shown_at_{};
  bool any_shown_ = false;
  bool terminal_ = false;
  std::thread thread_;
};

}  // namespace breakaway::linux_node
