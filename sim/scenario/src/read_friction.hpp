// The part of a scenario that says how friction is bounded and how it varies between its bounds.
#pragma once

#include "breakaway/scenario/scenario.hpp"
#include "toml_section.hpp"

namespace breakaway::scenario {

// mass_kg turns coefficients into newtons.
Friction read_friction(const Section& section, double mass_kg);

}  // namespace breakaway::scenario
