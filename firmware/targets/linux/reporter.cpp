#include "reporter.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <ctime>
#include <iterator>
#include <string_view>

#include "clock.hpp"
#include "error_text.hpp"

namespace breakaway::linux_node {
namespace {

// A signal that is blocked would wait here even if it is ignored, as nohup has it for SIGHUP.
bool is_ignored(int signal) {
  struct sigaction now {};
  return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

sigset_t operator_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaddset(&set, signal);
  if (!is_ignored(SIGHUP)) sigaddset(&set, SIGHUP);
  return set;
}

std::string_view mode_of(const StepRecord& step) { return step.controlled ? law::to_string(step.mode) : "-"; }

hal::Duration realtime_minus_monotonic() {
  timespec t{};
  clock_gettime(CLOCK_REALTIME, &t);
  return std::chrono::seconds{t.tv_sec} + hal::Duration{t.tv_nsec} - monotonic_now().time_since_epoch();
}

}  // namespace

Reporter::Reporter(const Options& options, Telemetry& telemetry, const Configuration& configuration,
                   ServiceManager& manager)
    : telemetry_{telemetry},
      interface_{options.interface},
      axes_{configuration.axes},
      manager_{manager},
      standard_output_{"standard output", STDOUT_FILENO},
      bus_load_{configuration.loop().network.bit_rate},
      to_realtime_{realtime_minus_monotonic()},
      start_{monotonic_now()},
      shown_(axes_.size()),
      newest_(axes_.size()),
      terminal_{isatty(STDOUT_FILENO) == 1} {
  for (std::size_t place = 0; place < axes_.size(); ++place) newest_[place].axis = static_cast<std::uint8_t>(place);
  if (!options.csv.empty())
    csv_.emplace(
        options.csv,
        fmt::format("time_s,latency_us,target_m,position_m,command_N,reported_N,mode,drive,fault,fault_code{}\n",
                    axes_.size() > 1 ? ",axis" : ""));
  if (!options.candump.empty()) candump_.emplace(options.candump, "");
  if (!options.stream.empty()) stream_.emplace(options.stream, axes_);
  const sigset_t signals = operator_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  thread_ = std::thread{[this] { run(); }};
}

Reporter::~Reporter() { end(); }

void Reporter::finish() {
  replace_older_logs();
  end();
  if (csv_) telemetry_.csv_unwritten = csv_->lost();
  if (candump_) telemetry_.candump_unwritten = candump_->lost();
}

void Reporter::end() {
  if (!thread_.joinable()) return;
  telemetry_.finished = true;
  thread_.join();
  const auto latest = Outlet::Clock::now() + Outlet::patience;
  if (csv_) csv_->close(latest);
  if (candump_) candump_->close(latest);
}

void Reporter::print(const std::string& report) {
  standard_output_.put(report);
  standard_output_.close(Outlet::Clock::now() + Outlet::patience);
}

bool Reporter::wrote_everything() const {
  return (!csv_ || csv_->wrote_everything()) && (!candump_ || candump_->wrote_everything()) &&
         standard_output_.wrote_everything();
}

std::string Reporter::stream_report() const { return stream_ ? stream_->report(telemetry_.lost) : std::string{}; }

void Reporter::run() {
  for (bool last = false; !last;) {
    take_signals();
    last = telemetry_.finished;
    drain();
    tell_manager();
  }
  if (any_shown_ && terminal_) standard_output_.put("\n");
}

void Reporter::take_signals() {
  const sigset_t signals = operator_signals();
  constexpr timespec patience{.tv_sec = 0, .tv_nsec = 20'000'000};
  const int signal = sigtimedwait(&signals, nullptr, &patience);
  if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) telemetry_.stop = true;
  if (signal == SIGUSR1) telemetry_.reset = true;
}

void Reporter::drain() {
  if (telemetry_.ready) replace_older_logs();
  for (Record record; telemetry_.records.pop(record);) std::visit([this](const auto& r) { write(r); }, record);
  if (csv_) csv_->flush();
  if (candump_) candump_->flush();
  standard_output_.flush();
}

void Reporter::replace_older_logs() {
  if (csv_) csv_->begin();
  if (candump_) candump_->begin();
}

double Reporter::seconds(hal::Time time) const { return hal::seconds(time - start_); }

void Reporter::write(const StepRecord& step) {
  if (csv_) {
    const hal::Duration time = on_realtime_clock(step.time);
    line_.clear();
    fmt::format_to(std::back_inserter(line_), "{}.{:06},{:.3f},{:.12g},{:.12g},{:.6g},{:.6g},{},{},{},{:04X}{}\n",
                   time / std::chrono::seconds{1}, time % std::chrono::seconds{1} / std::chrono::microseconds{1},
                   std::chrono::duration<double, std::micro>(step.latency).count(), metres(step, step.target_counts),
                   metres(step, step.position_counts), step.command_N, step.reported_N, mode_of(step),
                   to_string(step.drive), firmware::to_string(step.fault), step.fault_code,
                   axes_.size() > 1 ? "," + axes_[step.axis].name : std::string{});
    csv_->put(line_);
  }
  if (stream_) stream_->send(step, on_realtime_clock(step.time), bus_load_.share(step.time), telemetry_.lost);
  newest_[step.axis] = step;
  const auto& shown = shown_[step.axis];
  const bool changed = !shown || step.drive != shown->drive || step.fault != shown->fault ||
                       step.stop_not_obeyed != shown->stop_not_obeyed || step.fault_code != shown->fault_code ||
                       step.link_lost != shown->link_lost || step.reset_refused;
  if (changed) show_change(step);
  constexpr auto interval = std::chrono::milliseconds{100};
  if (!changed && terminal_ && step.time - shown_at_ >= interval) show_live(step.time);
}

// A change stays on the screen.
void Reporter::show_change(const StepRecord& step) {
  line_.clear();
  const auto out = std::back_inserter(line_);
  fmt::format_to(out, "{:10.3f} s  ", seconds(step.time));
  if (axes_.size() > 1) fmt::format_to(out, "{:<8}  ", axes_[step.axis].name);
  fmt::format_to(out, "{:<11}  {:<8}  target {:+.6f} m  position {:+.6f} m  force {:+.3f} N", to_string(step.drive),
                 mode_of(step), metres(step, step.target_counts), metres(step, step.position_counts), step.reported_N);
  append_fault(step);
  print_line(false);
  shown_[step.axis] = step;
  shown_at_ = step.time;
}

void Reporter::append_fault(const StepRecord& step) {
  const auto out = std::back_inserter(line_);
  if (step.fault != firmware::AxisFault::none) fmt::format_to(out, "  FAULT: {}", firmware::to_string(step.fault));
  if (step.stop_not_obeyed && step.fault != firmware::AxisFault::stop_not_obeyed)
    fmt::format_to(out, ", {}", firmware::to_string(firmware::AxisFault::stop_not_obeyed));
  if (step.fault == firmware::AxisFault::enable_timed_out) fmt::format_to(out, " ({})", why_disabled(step));
  if (step.reset_refused) fmt::format_to(out, " (reset refused: not seen without force yet, or no bus; try again)");
  if (step.link_lost) fmt::format_to(out, " (the interface is down)");
  if (step.fault_code != 0) line_ += " (" + error_text(step) + ")";
}

// The state of every axis and what is wrong with it: not its mode, which changes too often for a manager's log.
void Reporter::tell_manager() {
  if (!manager_.present()) return;
  line_.clear();
  for (const StepRecord& step : newest_) {
    fmt::format_to(std::back_inserter(line_), "{}{}{}", step.axis == 0 ? "" : "; ",
                   axes_.size() > 1 ? axes_[step.axis].name + " " : std::string{}, to_string(step.drive));
    append_fault(step);
  }
  manager_.poll(monotonic_now(), telemetry_, line_);
}

// The live line is written over.
void Reporter::show_live(hal::Time time) {
  line_.clear();
  const auto out = std::back_inserter(line_);
  fmt::format_to(out, "{:10.3f} s", seconds(time));
  for (const StepRecord& step : newest_)
    fmt::format_to(out, "  {}{:<8} {:+.6f} m {:+.3f} N", axes_.size() > 1 ? axes_[step.axis].name + " " : std::string{},
                   mode_of(step), metres(step, step.position_counts), step.reported_N);
  print_line(true);
  shown_at_ = time;
}

void Reporter::print_line(bool live) {
  if (terminal_) line_.insert(0, "\r\x1b[K");
  if (!live) line_ += '\n';
  standard_output_.put(line_);
  any_shown_ = true;
}

void Reporter::write(const FrameRecord& record) {
  bus_load_.add(record.frame, record.time);
  if (!candump_) return;
  const hal::Duration time = on_realtime_clock(record.time);
  line_.clear();
  const auto out = std::back_inserter(line_);
  fmt::format_to(out, "({:010}.{:06}) {} {:03X}#", time / std::chrono::seconds{1},
                 time % std::chrono::seconds{1} / std::chrono::microseconds{1}, interface_, record.frame.id);
  if (record.frame.remote) fmt::format_to(out, "R{}", record.frame.size);
  if (!record.frame.remote)
    for (const auto byte : record.frame.payload()) fmt::format_to(out, "{:02X}", byte);
  line_ += '\n';
  candump_->put(line_);
}

}  // namespace breakaway::linux_node
