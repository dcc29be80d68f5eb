// What a record tells of a load on a spring: resonance, masses, stiffness, and the friction of either side.
#pragma once

#include <optional>
#include <vector>

#include "breakaway/evaluation/identification.hpp"
#include "swing_fit.hpp"

namespace breakaway::evaluation {

// The swing that all switches of the force share; nothing where fewer than four show one of two counts and more.
std::optional<Swing> swing_of(const Record& record, const std::vector<SwitchInMotion>& switches);

// Throws InputError where the record does not tell.
Identification evaluate_sprung(const Record& record, const std::vector<Stretch>& stretches, const Margins& margins);

}  // namespace breakaway::evaluation
