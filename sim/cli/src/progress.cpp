#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace breakaway::cli {
namespace {

std::string duration(double seconds) {
  if (seconds < 99.5) return fmt::format("{:.0f} s", seconds);
  if (seconds < 99.5 * 60) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.0f} h", seconds / 3600);
}

}  // namespace

Progress::Progress(std::string what, bool asked)
    : Progress{std::move(what), asked, stderr, isatty(STDERR_FILENO) == 1} {}

Progress::Progress(std::string what, bool asked, std::FILE* to, bool terminal)
    : what_{std::move(what)}, terminal_{terminal}, asked_{asked}, to_{to} {}

Progress::~Progress() {
  if (terminal_ && written_) std::fputs("\r\033[K", to_);
}

void Progress::tell(double share) {
  if (!shown() || !(share > 0)) return;
  share = std::min(share, 1.0);
  const std::scoped_lock lock{mutex_};
  const auto now = Clock::now();
  const int tenths = static_cast<int>(10 * share);
  const bool due = terminal_ ? !written_ || now - *written_ >= std::chrono::milliseconds{100} : tenths > tenths_;
  if (!due) return;
  tenths_ = tenths;
  const double passed_s = std::chrono::duration<double>(now - begin_).count();
  write(fmt::format("{}: {:.0f} %, {} to go", what_, std::floor(100 * share), duration(passed_s * (1 / share - 1))));
}

void Progress::say(const std::string& what) {
  if (!shown()) return;
  const std::scoped_lock lock{mutex_};
  write(fmt::format("{}: {} ...", what_, what));
}

void Progress::write(const std::string& line) {
  fmt::print(to_, "{}{}{}", terminal_ ? "\r\033[K" : "", line, terminal_ ? "" : "\n");
  std::fflush(to_);
  written_ = Clock::now();
}

void add_progress(CLI::App& command, bool& asked) {
  command.add_flag("--progress", asked,
                   "Tell every tenth of the way on standard error; on a terminal progress is shown in any case");
}

}  // namespace breakaway::cli
