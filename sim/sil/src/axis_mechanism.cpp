#include "breakaway/sil/axis_mechanism.hpp"

#include <utility>

#include "breakaway/hybrid/refused.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/compliant_mechanism.hpp"
#include "breakaway/sil/machine_axis.hpp"

namespace breakaway::sil {
namespace {

EncoderPlace encoder_place(const scenario::AxisWorld& world) {
  if (!world.plant.load) return EncoderPlace::axis;
  return world.encoder_on_load ? EncoderPlace::load : EncoderPlace::motor;
}

Mounting mounting_of(const config::Axis& axis) {
  return axis.drive->invert_direction ? Mounting::inverted : Mounting::straight;
}

std::unique_ptr<BrakedMechanism> plant_of(const config::Axis& axis, const scenario::AxisWorld& world,
                                          motion::WorkBudget* budget) {
  const Mounting mounting = mounting_of(axis);
  const motion::SlideState start{0.0, world.position_m, world.velocity_m_s};
  model::CompliantPlant plant = world.plant;
  plant.mass_kg = config::truth_of(axis).mass_kg;
  const double tolerance = world.tolerance.value_or(motion::Slide::usual_tolerance);
  if (plant.rigid()) {
    motion::Slide slide{plant.mass_kg, friction_of(world), start, tolerance};
    slide.limit_work(budget);
    return std::make_unique<BrakedSlide>(std::move(slide), mounting, plant.force_N);
  }
  motion::CompliantAxis compliant{std::move(plant), friction_of(world), start, tolerance};
  compliant.limit_work(budget);
  return std::make_unique<CompliantMechanism>(std::move(compliant), mounting, encoder_place(world));
}

AxisMechanism with_encoder(std::unique_ptr<BrakedMechanism> axis, const scenario::AxisWorld& world) {
  AxisMechanism mechanism;
  mechanism.axis = std::move(axis);
  if (world.encoder_error) mechanism.encoder = std::make_unique<MisreadEncoder>(*mechanism.axis, *world.encoder_error);
  return mechanism;
}

std::shared_ptr<DrivenMachine> driven_machine(const scenario::Scenario& s, motion::WorkBudget* budget) {
  std::vector<DrivenMachine::Axis> axes;
  for (const scenario::AxisWorld& world : s.worlds)
    axes.push_back({*world.place, world.drive->current_loop_time_constant_s});
  try {
    auto machine = std::make_shared<DrivenMachine>(*s.machine, std::move(axes));
    machine->limit_work(budget);
    return machine;
  } catch (const hybrid::Refused& refusal) {
    throw refusal.without_another_method().in_file(s.node.file);
  } catch (const InputError& error) {
    throw error.in_file(s.node.file);
  }
}

}  // namespace

model::FrictionLaw friction_of(const scenario::AxisWorld& world) {
  return world.drift ? model::drifting(world.friction, *world.drift) : world.friction;
}

AxisMechanism axis_mechanism(const config::Axis& axis, const scenario::AxisWorld& world, motion::WorkBudget* budget) {
  return with_encoder(plant_of(axis, world, budget), world);
}

std::vector<AxisMechanism> axis_mechanisms(const scenario::Scenario& s, motion::WorkBudget* budget) {
  std::vector<AxisMechanism> mechanisms;
  const auto machine = s.machine ? driven_machine(s, budget) : nullptr;
  for (std::size_t i = 0; i < s.axes(); ++i) {
    const config::Axis& axis = s.node.axes[i];
    mechanisms.push_back(with_encoder(
        machine ? std::make_unique<MachineAxis>(machine, i, mounting_of(axis)) : plant_of(axis, s.worlds[i], budget),
        s.worlds[i]));
    mechanisms.back().machine = machine;
  }
  return mechanisms;
}

}  // namespace breakaway::sil
