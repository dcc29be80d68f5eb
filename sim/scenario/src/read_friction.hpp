// The part of a scenario that says how friction is bounded and how it varies between its bounds.
#pragma once

#include "breakaway/config/toml_section.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

using namespace config;

// mass_kg turns coefficients into newtons.
Friction read_friction(const Section& section, double mass_kg);

// The friction of one direction of a machine: lower_N, upper_N and law.
model::FrictionLaw read_friction_law(const Section& section);

}  // namespace breakaway::scenario
