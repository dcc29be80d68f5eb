// Scenarios from TOML files: the node's keys are read by firmware/config, those of the world here.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

// Throws InputError as config::read_node, and for the keys of the simulation, which stand in read_scenario.cpp, one row
// each.
Scenario read_scenario(const std::filesystem::path& file);

// The same from text; `name` stands for the file in errors.
Scenario parse_scenario(std::string_view text, const std::string& name);

}  // namespace breakaway::scenario
