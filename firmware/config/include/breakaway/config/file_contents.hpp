// The text of a scenario file.
#pragma once

#include <filesystem>
#include <string>

namespace breakaway::config {

// Throws InputError: not readable, a folder, larger than 1 MiB.
std::string file_contents(const std::filesystem::path& file);

}  // namespace breakaway::config
