#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "breakaway/watch/csv_reader.hpp"
#include "breakaway/watch/source.hpp"

namespace breakaway::watch {
namespace {

bool is_standard_input(const std::string& path) { return path == "-"; }

// A file, or standard input, that others may still be writing.
class Input {
 public:
  explicit Input(const std::string& path)
      : descriptor_{is_standard_input(path) ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC)} {
    if (std::filesystem::is_directory(path)) throw InputError{path + ": is a folder; give a file of samples"};
    if (descriptor_ < 0)
      throw InputError{fmt::format("{}: cannot be read: {}; check the path", path, std::strerror(errno))};
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  ~Input() {
    if (descriptor_ > STDIN_FILENO) ::close(descriptor_);
  }

  // The file is shorter than what was read of it, as it is when another run is written into it: it is read from its
  // beginning. Of what is no file nothing is known.
  bool begins_anew() const {
    struct stat about {};
    if (::fstat(descriptor_, &about) != 0 || !S_ISREG(about.st_mode)) return false;
    if (about.st_size >= ::lseek(descriptor_, 0, SEEK_CUR)) return false;
    return ::lseek(descriptor_, 0, SEEK_SET) == 0;
  }

  // What is there now, some of it at a time; nothing where no more is there yet. It does not block.
  std::string_view next() {
    pollfd asked{.fd = descriptor_, .events = POLLIN, .revents = 0};
    if (::poll(&asked, 1, 0) != 1) return {};
    const ssize_t got = ::read(descriptor_, bytes_.data(), bytes_.size());
    return {bytes_.data(), got > 0 ? static_cast<std::size_t>(got) : 0};
  }

 private:
  int descriptor_;
  std::array<char, 65536> bytes_{};
};

class FollowedFile final : public Source {
 public:
  // The first line of a file is there; that of standard input may take a while.
  FollowedFile(const std::string& path, History& history)
      : name_{is_standard_input(path) ? "standard input" : path}, history_{history}, input_{path} {
    while (!reader_ && part_.size() < longest_line && take_next()) {
    }
    if (!reader_ && !is_standard_input(path))
      throw InputError{
          "has no whole first line: give a run that breakaway-node --csv or breakaway simulate --csv has written"}
          .in_file(name_);
    thread_ = std::jthread{[this](const std::stop_token& stop) { run(stop); }};
  }

  std::string description() const override { return name_; }

 private:
  static constexpr std::size_t longest_line = 4096;

  void run(const std::stop_token& stop) try {
    constexpr auto interval = std::chrono::milliseconds{100};
    std::mutex mutex;
    std::condition_variable_any asked;
    while (!stop.stop_requested()) {
      read_what_is_there(stop);
      std::unique_lock lock{mutex};
      asked.wait_for(lock, stop, interval, [] { return false; });
    }
  } catch (const InputError& error) {
    history_.complain(error.what());  // no line can be understood without the first
  }

  void read_what_is_there(const std::stop_token& stop) {
    while (!stop.stop_requested() && take_next()) {
    }
  }

  // False where nothing more is there yet. A line that is still being written waits in part_. Where another run begins
  // its first line may have other columns; that its time is less tells the page.
  bool take_next() {
    if (input_.begins_anew()) {
      reader_.reset();
      part_.clear();
      number_ = 0;
    }
    const std::string_view bytes = input_.next();
    for (const char c : bytes) {
      if (c != '\n') {
        if (part_.size() < longest_line) part_ += c;
        continue;
      }
      take(part_);
      part_.clear();
    }
    return !bytes.empty();
  }

  void take(const std::string& line) {
    ++number_;
    if (reader_)
      take_sample(line);
    else
      take_header(line);
  }

  void take_header(const std::string& line) try { reader_.emplace(line); } catch (const InputError& error) {
    throw error.in_file(name_);
  }

  void take_sample(const std::string& line) try { history_.add(reader_->read(line)); } catch (const InputError& error) {
    history_.complain(fmt::format("{}:{}: {}; the line is left out", name_, number_, error.what()));
  }

  std::string name_;
  History& history_;
  Input input_;
  std::optional<CsvReader> reader_;
  std::string part_;
  std::uint64_t number_ = 0;  // of the newest line
  std::jthread thread_;
};

}  // namespace

std::unique_ptr<Source> follow_file(const std::string& path, History& history) {
  return std::make_unique<FollowedFile>(path, history);
}

}  // namespace breakaway::watch
