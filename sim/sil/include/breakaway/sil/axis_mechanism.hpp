// A scenario's axis as the mechanism of its drive. Apart from BrakedSlide, which an image without files has, too.
#pragma once

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/braked_slide.hpp"

namespace breakaway::sil {

// The axis as its drive moves it. Requires axis.drive.
inline BrakedSlide braked_slide(const config::Axis& axis, const scenario::AxisWorld& world) {
  return BrakedSlide{{axis.mass_kg, world.friction, {0.0, world.position_m, world.velocity_m_s}},
                     axis.drive->invert_direction ? Mounting::inverted : Mounting::straight};
}

}  // namespace breakaway::sil
