#include "breakaway/format/gnuplot.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::format {
namespace {

// A new empty folder that goes away with its content.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code none;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(none);
    std::string name = (parent / "breakaway-XXXXXX").string();
    if (none || mkdtemp(name.data()) == nullptr) {
      throw InputError{"cannot make a temporary folder for gnuplot; set TMPDIR to a folder that you may write"};
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

std::string contents(const std::filesystem::path& file) {
  std::ifstream in{file, std::ios::binary};
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// Returns what gnuplot writes for this terminal; `name` stands for the picture in errors.
std::string draw(const std::string& name, const std::string& terminal, const std::string& commands) {
  const TemporaryFolder folder;
  const std::string script = (folder.path() / "picture.gp").string();
  const std::filesystem::path picture = folder.path() / "picture";
  write_output(script, fmt::format("set terminal {} linewidth 1.2 background 'white'\nset output '{}'\n{}", terminal,
                                   picture.string(), commands));
  const auto [exit_code, output] = run(fmt::format("gnuplot {} 2>&1", shell_quoted(script)));
  if (exit_code == 127) {
    throw InputError{"gnuplot cannot be run, and pictures need it; install the package gnuplot-nox"};
  }
  std::string drawn = contents(picture);
  if (exit_code != 0 || drawn.empty()) {
    throw InputError{fmt::format("gnuplot failed on the picture {}: {}", name, output.substr(0, output.find('\n', 1)))};
  }
  return drawn;
}

std::string svg_terminal(const std::string& name, int width_px, int height_px) {
  // `name` keeps the identifiers of pictures in one document apart.
  return fmt::format("svg size {},{} dynamic name '{}' font 'Helvetica,Arial,sans-serif,14'", width_px, height_px,
                     name);
}

}  // namespace

std::string draw_svg(const std::string& name, int width_px, int height_px, const std::string& commands) {
  const std::string output = draw(name, svg_terminal(name, width_px, height_px), commands);
  const auto begin = output.find("<svg");
  const auto end = output.rfind("</svg>");
  if (begin == std::string::npos || end == std::string::npos) {
    throw InputError{fmt::format("gnuplot failed on the picture {}: it is no SVG", name)};
  }
  return output.substr(begin, end + 6 - begin);
}

void require_picture_ending(const std::string& path) {
  if (path.ends_with(".svg") || path.ends_with(".png")) return;
  throw InputError{fmt::format("{}: a picture's name ends in .svg or .png; rename it", path)};
}

std::string draw_file(const std::string& path, int width_px, int height_px, const std::string& commands) {
  require_picture_ending(path);
  if (path.ends_with(".svg")) return draw(path, svg_terminal("picture", width_px, height_px), commands);
  return draw(path, fmt::format("pngcairo size {},{} font 'Helvetica,14'", width_px, height_px), commands);
}

}  // namespace breakaway::format
