// Scenarios from TOML files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

// Throws InputError: file not readable, TOML syntax, unknown or missing key, wrong type, value outside its range, or
// parts that do not fit together. Keys, units and ranges stand in read_scenario.cpp, one row each.
Scenario read_scenario(const std::filesystem::path& file);

// The same from text; `name` stands for the file in errors.
Scenario parse_scenario(std::string_view text, const std::string& name);

}  // namespace breakaway::scenario
