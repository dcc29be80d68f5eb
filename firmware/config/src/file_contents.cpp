#include "breakaway/config/file_contents.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>

#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

bool is_standard_input(const std::filesystem::path& file) { return file == "-"; }

// One byte more than `most` where there are more.
std::string read_from(std::istream& in, std::size_t most) {
  std::string text(most + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

// A process reads one input there, so that the bound of the first call is that of all.
const std::string& standard_input(std::size_t most) {
  static const std::string text = read_from(std::cin, most);
  return text;
}

std::string contents_of(const std::filesystem::path& file, std::size_t most) {
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(file, ignored);
  errno = 0;
  std::ifstream in{file, std::ios::binary};
  std::string text = folder || !in ? std::string{} : read_from(in, most);
  if (folder || !in.is_open() || in.bad())
    throw InputError{
        fmt::format("cannot be read: {}; check the path", folder ? "it is a folder" : std::strerror(errno))}
        .in_file(file.string());
  return text;
}

}  // namespace

std::string shown_name(const std::filesystem::path& file) {
  return is_standard_input(file) ? "standard input" : file.string();
}

std::string file_contents(const std::filesystem::path& file, std::size_t most) {
  if (file.empty()) throw InputError{"the name of a file to read is empty; give one, or - for standard input"};
  std::string text = is_standard_input(file) ? standard_input(most) : contents_of(file, most);
  if (text.size() > most)
    throw InputError{fmt::format("is larger than {} MiB; give {}", most >> 20U,
                                 most == most_of_a_scenario ? "a scenario" : "less of it")}
        .in_file(shown_name(file));
  return text;
}

}  // namespace breakaway::config
