// What [plant] says of the world beyond mass and start: each table is read by a function of its own.
#pragma once

#include "breakaway/config/toml_section.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

void read_presliding(const config::Section& section, AxisWorld& world);
void read_load(const config::Section& section, AxisWorld& world);
void read_backlash(const config::Section& section, AxisWorld& world);  // into world.gap_m
void read_cogging(const config::Section& section, AxisWorld& world);
void read_ripple(const config::Section& section, AxisWorld& world);
void read_encoder_error(const config::Section& section, AxisWorld& world);
void read_drift(const config::Section& section, AxisWorld& world);

}  // namespace breakaway::scenario
