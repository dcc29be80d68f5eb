// Text on its way to a file, a fifo or a terminal. A thread of its own writes it, because each of them may stall for as
// long as it likes, and whoever has the text also obeys SIGTERM.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace breakaway::linux_node {

class Outlet {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds patience{2};  // usual, with what takes nothing

  // A file that begins with `header`. An older one that has content keeps it until begin(), for a run that is refused
  // is no reason to lose the record of another. Throws InputError: it cannot be opened.
  Outlet(const std::string& path, std::string_view header);
  // What is open already, and stays open.
  Outlet(const std::string& name, int descriptor);
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;
  ~Outlet() { close(Clock::now() + patience); }

  // From here on an older file is replaced; where a great many lines wait for it, earlier.
  void begin();
  // Takes a line, or several, and never waits: what has no room any more is lost.
  void put(std::string_view lines);
  // What was put is to be written now.
  void flush();
  // Ends it when everything is written, and then at the latest. What an older file was kept from is dropped. What went
  // wrong is said on standard error, once.
  void close(Clock::time_point latest);

  // After close(): the lines that were put and not written; the header is none of them.
  std::uint64_t lost() const;
  bool wrote_everything() const;

 private:
  struct State;

  void start(std::shared_ptr<State> state);

  std::shared_ptr<State> state_;  // the thread's, too, which may outlive this
  bool closed_ = false;
};

// A line on standard error of a program that must end, even if nobody takes it.
void say(std::string_view what);

}  // namespace breakaway::linux_node
