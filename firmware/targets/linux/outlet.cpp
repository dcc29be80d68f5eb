#include "outlet.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

#include "breakaway/input/input_error.hpp"

namespace breakaway::linux_node {
namespace {

// Some twenty seconds of all that a bus can carry.
constexpr std::size_t most_waiting = std::size_t{1} << 24;

// In which a thread inherits that no signal is for it: the operator's are taken elsewhere, and SIGPIPE, that a reader
// is gone, comes as an error of the write.
class WithoutSignals {
 public:
  WithoutSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  WithoutSignals(const WithoutSignals&) = delete;
  WithoutSignals& operator=(const WithoutSignals&) = delete;
  ~WithoutSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

bool has_content(int descriptor) {
  struct stat about {};
  return fstat(descriptor, &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0;
}

std::uint64_t lines_in(std::string_view text) { return static_cast<std::uint64_t>(std::ranges::count(text, '\n')); }

std::string sentence(std::string_view what) { return fmt::format("breakaway-node: {}\n", what); }

}  // namespace

struct Outlet::State {
  std::string name;
  int descriptor = -1;
  bool is_file = false;

  std::mutex mutex;
  std::condition_variable changed;
  std::string waiting;
  bool kept = false;      // an older file
  bool replaces = false;  // it, once it is not kept any more
  bool flushed = false, ending = false, ended = false;
  bool given_up = false;                           // and said to be
  std::uint64_t put = 0, written = 0, header = 0;  // lines
  int error = 0;

  bool has_something() const { return !kept && !waiting.empty() && (flushed || ending); }

  void run() {
    while (write_next()) {
    }
    if (is_file && ::close(descriptor) != 0) fail(errno);
    const std::string why = reason();
    // Nobody waits for this thread any longer than for its file, so it may as well wait here.
    if (!why.empty() && descriptor != STDERR_FILENO) static_cast<void>(write_to(STDERR_FILENO, sentence(why)));
    const std::lock_guard lock{mutex};
    ended = true;
    changed.notify_all();
  }

  // False: there is nothing more to be written.
  bool write_next() {
    std::string text;
    {
      std::unique_lock lock{mutex};
      changed.wait(lock, [this] { return ending || has_something(); });
      if (!has_something()) return false;
      text.swap(waiting);
      flushed = false;
    }
    if (std::exchange(replaces, false) && ftruncate(descriptor, 0) != 0) return fail(errno);
    return write(text);
  }

  bool write(std::string_view text) {
    constexpr std::size_t piece = 65536;
    while (!text.empty()) {
      const ssize_t taken = write_to(descriptor, text.substr(0, piece));
      if (taken < 0) return fail(errno);
      const std::lock_guard lock{mutex};
      written += lines_in(text.substr(0, static_cast<std::size_t>(taken)));
      text.remove_prefix(static_cast<std::size_t>(taken));
    }
    return true;
  }

  static ssize_t write_to(int descriptor, std::string_view text) {
    for (;;) {
      const ssize_t taken = ::write(descriptor, text.data(), text.size());
      if (taken >= 0 || (errno != EINTR && errno != EAGAIN)) return taken;
      // A terminal that is shared with others may have been told by one of them not to wait.
      pollfd room{.fd = descriptor, .events = POLLOUT, .revents = 0};
      poll(&room, 1, -1);
    }
  }

  bool fail(int why) {
    const std::lock_guard lock{mutex};
    if (error == 0) error = why;
    waiting.clear();
    return false;
  }

  std::string reason() {
    const std::lock_guard lock{mutex};
    if (given_up) return {};
    if (error != 0) return fmt::format("{}: cannot be written: {}", name, std::strerror(error));
    if (!kept && put > written)
      return fmt::format("{}: {} lines are lost: it does not take them as fast as they come", name, put - written);
    return {};
  }
};

Outlet::Outlet(const std::string& path, std::string_view header) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) throw InputError{fmt::format("{}: cannot be written: {}", path, std::strerror(errno))};
  auto state = std::make_shared<State>();
  state->name = path;
  state->descriptor = descriptor;
  state->is_file = true;
  state->kept = state->replaces = has_content(descriptor);
  state->header = lines_in(header);
  start(std::move(state));
  put(header);
}

Outlet::Outlet(const std::string& name, int descriptor) {
  auto state = std::make_shared<State>();
  state->name = name;
  state->descriptor = descriptor;
  start(std::move(state));
}

void Outlet::start(std::shared_ptr<State> state) {
  state_ = std::move(state);
  const WithoutSignals inherited;
  std::thread{[state = state_] { state->run(); }}.detach();
}

void Outlet::begin() {
  const std::lock_guard lock{state_->mutex};
  state_->kept = false;
  state_->changed.notify_all();
}

void Outlet::put(std::string_view lines) {
  State& state = *state_;
  const std::lock_guard lock{state.mutex};
  state.put += lines_in(lines);
  if (state.error != 0) return;
  if (state.waiting.size() + lines.size() <= most_waiting) state.waiting += lines;
  // A set-up that has come this far is none that is refused for a cable.
  if (state.waiting.size() > most_waiting / 2) state.kept = false;
}

void Outlet::flush() {
  const std::lock_guard lock{state_->mutex};
  state_->flushed = true;
  state_->changed.notify_all();
}

void Outlet::close(Clock::time_point latest) {
  if (std::exchange(closed_, true)) return;
  std::unique_lock lock{state_->mutex};
  state_->ending = true;
  state_->changed.notify_all();
  if (state_->changed.wait_until(lock, latest, [this] { return state_->ended; })) return;
  if (state_->error != 0 || state_->descriptor == STDERR_FILENO) return;
  state_->given_up = true;
  lock.unlock();
  say(fmt::format("{}: cannot be written: nobody takes what is written to it", state_->name));
}

std::uint64_t Outlet::lost() const {
  const std::lock_guard lock{state_->mutex};
  return std::min(state_->put - state_->written, state_->put - state_->header);
}

bool Outlet::wrote_everything() const {
  const std::lock_guard lock{state_->mutex};
  return state_->ended && state_->error == 0 && state_->put == state_->written;
}

void say(std::string_view what) {
  Outlet standard_error{"standard error", STDERR_FILENO};
  standard_error.put(sentence(what));
  standard_error.close(Outlet::Clock::now() + std::chrono::seconds{1});
}

}  // namespace breakaway::linux_node
