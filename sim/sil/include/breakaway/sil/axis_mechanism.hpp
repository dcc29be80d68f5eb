// A scenario's axis as the mechanism of its drive. Apart from BrakedSlide, which an image without files has, too.
#pragma once

#include <memory>
#include <vector>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/braked_slide.hpp"
#include "breakaway/sil/driven_machine.hpp"
#include "breakaway/sil/misread_encoder.hpp"

namespace breakaway::sil {

// What a drive moves, and what its encoder makes of it.
struct AxisMechanism {
  std::unique_ptr<BrakedMechanism> axis;
  std::unique_ptr<MisreadEncoder> encoder;         // none: the encoder is perfect
  std::shared_ptr<const DrivenMachine> machine{};  // that it shares with other axes; none: it moves alone

  drive_emulator::Mechanism& seen_by_drive() const {
    return encoder ? static_cast<drive_emulator::Mechanism&>(*encoder) : *axis;
  }
};

// The friction of an axis, with its drift.
model::FrictionLaw friction_of(const scenario::AxisWorld& world);

// An axis that moves alone, as its drive moves it. Requires axis.drive. A rigid axis is a BrakedSlide. The budget, if
// there is one, must outlive it.
AxisMechanism axis_mechanism(const config::Axis& axis, const scenario::AxisWorld& world,
                             motion::WorkBudget* budget = nullptr);

// All axes of the scenario, in order, each alone or all on one machine. Requires a drive of each. Throws InputError for
// a machine that cannot be followed. The budget is for all together.
std::vector<AxisMechanism> axis_mechanisms(const scenario::Scenario& scenario, motion::WorkBudget* budget = nullptr);

}  // namespace breakaway::sil
