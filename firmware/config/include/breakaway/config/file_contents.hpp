// file_contents() reads a file of text, with a bound on its size.
#pragma once

#include <filesystem>
#include <string>

namespace breakaway::config {

// Throws InputError for what cannot be read, is a folder, or is larger than 1 MiB.
std::string file_contents(const std::filesystem::path& file);

}  // namespace breakaway::config
