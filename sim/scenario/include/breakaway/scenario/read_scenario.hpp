// Scenarios from TOML files: the node's keys are read by firmware/config, those of the world here.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "breakaway/config/known_tables.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

// Throws InputError as config::read_node, and for the keys of the simulation, which stand in read_scenario.cpp, one row
// each.
Scenario read_scenario(const std::filesystem::path& file);

// The same from text; `name` stands for the file in errors, and `known` gathers what is read.
Scenario parse_scenario(std::string_view text, const std::string& name, config::KnownTables* known = nullptr);

// Says why an axis cannot begin at this position; nothing where it can. One that stands at home when it begins does so
// there; where its encoder counts from power-on or the drive looks for its home, the position says nothing of what is
// read, and any will do.
std::string start_problem(const config::Axis& axis, const AxisWorld& world, double position_m);

}  // namespace breakaway::scenario
