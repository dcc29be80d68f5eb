#include "breakaway/format/output_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "breakaway/input/input_error.hpp"

namespace breakaway::format {
namespace {

[[noreturn]] void fail(const std::string& path) {
  throw InputError{fmt::format("{}: cannot be written: {}; choose another place", path, std::strerror(errno))};
}

using Parts = std::function<std::string()>;

// False, with errno, unless every byte reached the operating system.
bool write_all(std::FILE* file, const Parts& next) {
  for (std::string part = next(); !part.empty(); part = next()) {
    if (std::fwrite(part.data(), 1, part.size(), file) != part.size()) return false;
  }
  return std::fflush(file) == 0;
}

bool write_file(const std::string& path, const Parts& next) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return false;
  const bool written = write_all(file, next);
  const int reason = errno;
  const bool closed = std::fclose(file) == 0;
  if (!written) errno = reason;
  return written && closed;
}

}  // namespace

void write_output(const std::string& path, std::string_view text) {
  write_output(path, [rest = std::string{text}]() mutable { return std::exchange(rest, ""); });
}

void write_output(const std::string& path, const Parts& next) {
  if (path == "-") {
    if (!write_all(stdout, next)) fail("standard output");
    return;
  }
  std::error_code ignored;
  const std::filesystem::path target =
      std::filesystem::exists(path, ignored) ? std::filesystem::canonical(path, ignored) : std::filesystem::path{path};
  // A device or a pipe cannot be replaced by a file of its name.
  if (std::filesystem::exists(target, ignored) && !std::filesystem::is_regular_file(target, ignored)) {
    if (!write_file(path, next)) fail(path);
    return;
  }
  const std::string part = fmt::format("{}.{}.part", target.string(), getpid());
  if (!write_file(part, next) || std::rename(part.c_str(), target.c_str()) != 0) {
    const int reason = errno;
    std::remove(part.c_str());
    errno = reason;
    fail(path);
  }
}

}  // namespace breakaway::format
