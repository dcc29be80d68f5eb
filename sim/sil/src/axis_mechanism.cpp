#include "breakaway/sil/axis_mechanism.hpp"

#include "breakaway/sil/compliant_mechanism.hpp"

namespace breakaway::sil {
namespace {

model::FrictionLaw friction_of(const scenario::AxisWorld& world) {
  return world.drift ? model::drifting(world.friction, *world.drift) : world.friction;
}

EncoderPlace encoder_place(const scenario::AxisWorld& world) {
  if (!world.plant.load) return EncoderPlace::axis;
  return world.encoder_on_load ? EncoderPlace::load : EncoderPlace::motor;
}

std::unique_ptr<BrakedMechanism> plant_of(const config::Axis& axis, const scenario::AxisWorld& world) {
  const Mounting mounting = axis.drive->invert_direction ? Mounting::inverted : Mounting::straight;
  const motion::SlideState start{0.0, world.position_m, world.velocity_m_s};
  model::CompliantPlant plant = world.plant;
  plant.mass_kg = config::truth_of(axis).mass_kg;
  const double tolerance = world.tolerance.value_or(motion::Slide::usual_tolerance);
  if (plant.rigid())
    return std::make_unique<BrakedSlide>(motion::Slide{plant.mass_kg, friction_of(world), start, tolerance}, mounting,
                                         plant.force_N);
  return std::make_unique<CompliantMechanism>(
      motion::CompliantAxis{std::move(plant), friction_of(world), start, tolerance}, mounting, encoder_place(world));
}

}  // namespace

AxisMechanism axis_mechanism(const config::Axis& axis, const scenario::AxisWorld& world) {
  AxisMechanism mechanism;
  mechanism.axis = plant_of(axis, world);
  if (world.encoder_error) mechanism.encoder = std::make_unique<MisreadEncoder>(*mechanism.axis, *world.encoder_error);
  return mechanism;
}

}  // namespace breakaway::sil
