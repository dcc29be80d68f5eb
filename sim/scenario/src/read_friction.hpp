// Friction laws from a file.
#pragma once

#include "breakaway/config/toml_section.hpp"
#include "breakaway/model/friction_law.hpp"

namespace breakaway::scenario {

// A place between the bounds: its `kind`, and the keys of that.
model::ShapePtr read_shape(const config::Section& section);
config::Value shape_value(model::ShapePtr& to);

// lower_N, upper_N and a law between them.
model::FrictionLaw read_friction_law(const config::Section& section);

}  // namespace breakaway::scenario
