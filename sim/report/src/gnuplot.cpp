#include "breakaway/report/gnuplot.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "breakaway/report/output_file.hpp"
#include "breakaway/scenario/input_error.hpp"

namespace breakaway::report {
namespace {

// A new empty folder that goes away with its content.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code none;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(none);
    std::string name = (parent / "breakaway-XXXXXX").string();
    if (none || mkdtemp(name.data()) == nullptr) {
      throw scenario::InputError{
          "cannot make a temporary folder for gnuplot; set TMPDIR to a folder that you may write"};
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct Ended {
  int exit_code;
  std::string output;  // both streams
};

Ended run(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {127, ""};
  std::string output;
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), n);
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 127, output};
}

std::string shell_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string{"'\\''"} : std::string{c};
  return quoted + "'";
}

}  // namespace

std::string draw_svg(const std::string& name, int width_px, int height_px, const std::string& commands) {
  const TemporaryFolder folder;
  const std::string script = (folder.path() / "picture.gp").string();
  // `name` keeps the identifiers of pictures in one document apart.
  write_output(script, fmt::format("set terminal svg size {},{} dynamic name '{}' font 'Helvetica,Arial,sans-serif,14' "
                                   "linewidth 1.2 background 'white'\n{}",
                                   width_px, height_px, name, commands));
  const auto [exit_code, output] = run(fmt::format("gnuplot {} 2>&1", shell_quoted(script)));
  if (exit_code == 127) {
    throw scenario::InputError{"gnuplot cannot be run, and the report needs it; install the package gnuplot-nox"};
  }
  const auto begin = output.find("<svg");
  const auto end = output.rfind("</svg>");
  if (exit_code != 0 || begin == std::string::npos || end == std::string::npos) {
    std::string first_line = output.substr(0, output.find('\n', 1));
    throw scenario::InputError{fmt::format("gnuplot failed on the picture {}: {}", name, first_line)};
  }
  return output.substr(begin, end + 6 - begin);
}

}  // namespace breakaway::report
