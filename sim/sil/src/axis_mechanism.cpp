#include "breakaway/sil/axis_mechanism.hpp"

namespace breakaway::sil {
namespace {

model::FrictionLaw friction_of(const scenario::AxisWorld& world) {
  return world.drift ? model::drifting(world.friction, *world.drift) : world.friction;
}

}  // namespace

AxisMechanism axis_mechanism(const config::Axis& axis, const scenario::AxisWorld& world) {
  const Mounting mounting = axis.drive->invert_direction ? Mounting::inverted : Mounting::straight;
  const motion::SlideState start{0.0, world.position_m, world.velocity_m_s};
  AxisMechanism mechanism;
  mechanism.axis =
      std::make_unique<BrakedSlide>(motion::Slide{config::truth_of(axis).mass_kg, friction_of(world), start,
                                                  world.tolerance.value_or(motion::Slide::usual_tolerance)},
                                    mounting, world.plant.force_N);
  if (world.encoder_error) mechanism.encoder = std::make_unique<MisreadEncoder>(*mechanism.axis, *world.encoder_error);
  return mechanism;
}

}  // namespace breakaway::sil
