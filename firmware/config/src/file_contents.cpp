#include "breakaway/config/file_contents.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "breakaway/input/input_error.hpp"

namespace breakaway::config {

std::string file_contents(const std::filesystem::path& file) {
  constexpr std::size_t most = std::size_t{1} << 20;  // far above any scenario, far below the machine's memory
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(file, ignored);
  errno = 0;
  std::ifstream in{file, std::ios::binary};
  std::string text(most + 1, '\0');
  if (folder || !in || (!in.read(text.data(), static_cast<std::streamsize>(text.size())) && in.bad())) {
    throw InputError{fmt::format("{}: cannot be read: {}; check the path", file.string(),
                                 folder ? "it is a folder" : std::strerror(errno))};
  }
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > most) throw InputError{fmt::format("{}: is larger than 1 MiB; give a scenario", file.string())};
  return text;
}

}  // namespace breakaway::config
