// Progress: how far a long command is, and how long it will take, on standard error.
//
// It is for people: nothing is written unless standard error is a terminal, where one line is renewed ten times a
// second at most, or --progress asks for it, where every tenth of the way has a line of its own. Standard output and
// every result are the same with it and without.
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>

namespace breakaway::cli {

class Progress {
 public:
  // As of now.
  explicit Progress(std::string what, bool asked = false);
  Progress(std::string what, bool asked, std::FILE* to, bool terminal);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `share` of the way, 0 to 1, is behind. Any thread may call it.
  void tell(double share);

  // What is being done, where its length is not known.
  void say(const std::string& what);

  // Says whether anything is written at all; otherwise the caller may save itself the calls.
  bool shown() const { return terminal_ || asked_; }

 private:
  using Clock = std::chrono::steady_clock;

  void write(const std::string& line);

  std::string what_;
  bool terminal_, asked_;
  std::FILE* to_;
  Clock::time_point begin_ = Clock::now();
  std::optional<Clock::time_point> written_;
  int tenths_ = 0;
  std::mutex mutex_;
};

// Adds --progress.
void add_progress(CLI::App& command, bool& asked);

}  // namespace breakaway::cli
