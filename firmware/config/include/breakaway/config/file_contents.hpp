// file_contents() reads a file of text, with a bound on its size. The file "-" is standard input.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace breakaway::config {

inline constexpr std::size_t most_of_a_scenario = std::size_t{1} << 20;  // far above any, far below a PC's memory

// What a message calls the file: its name, or "standard input".
std::string shown_name(const std::filesystem::path& file);

// Standard input is read once and kept, so that it may be asked for again; not from two threads at once. Throws
// InputError for what cannot be read, is a folder, or has more bytes than `most`.
std::string file_contents(const std::filesystem::path& file, std::size_t most = most_of_a_scenario);

}  // namespace breakaway::config
