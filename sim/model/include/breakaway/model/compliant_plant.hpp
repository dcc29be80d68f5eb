// CompliantPlant: an axis that is more than a rigid mass on dry friction, as equations. See motion/compliant_axis.hpp
// for how it moves.
//
//   m x'' = u(t) (1 + ripple(x)) + cogging(x) + force - friction - coupling
//   M y'' = coupling - load friction
//
// Without a load the coupling is zero. Friction is dry, -f Sign(x'), or has a presliding range.
#pragma once

#include <optional>

#include "breakaway/model/elastic_coupling.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/model/position_sine.hpp"
#include "breakaway/model/presliding.hpp"

namespace breakaway::model {

struct FlexibleLoad {
  double mass_kg = 1;  // > 0
  ElasticCoupling coupling{};
  std::optional<FrictionLaw> friction{};  // dry; none: the load moves freely
};

struct CompliantPlant {
  double mass_kg = 1;  // of what the drive pushes, > 0
  double force_N = 0;  // constant, on what the drive pushes
  std::optional<Presliding> presliding{};
  std::optional<FlexibleLoad> load{};
  PositionSine cogging{};  // amplitude 0: none
  PositionSine ripple{};   // amplitude 0: none

  // A rigid axis under the drive's force and a constant one, which motion::Slide follows.
  bool rigid() const { return !presliding && !load && cogging.amplitude == 0 && ripple.amplitude == 0; }
};

// Throws InputError naming the member that is out of its range or not finite.
void require_valid(const CompliantPlant& plant);

}  // namespace breakaway::model
