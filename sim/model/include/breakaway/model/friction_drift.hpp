// FrictionDrift: the level of friction swells and falls slowly, as with temperature and grease.
#pragma once

#include "breakaway/model/friction_law.hpp"

namespace breakaway::model {

struct FrictionDrift {
  double share = 0;     // in (0, 1): the level is multiplied by 1 + share sin(2 pi t / period)
  double period_s = 1;  // > 0
};

// Returns the law whose level drifts so. Its bounds are lower (1 - share) and upper (1 + share): what a controller was
// told of the bounds no longer holds. Throws InputError naming the member that is out of its range.
FrictionLaw drifting(const FrictionLaw& law, const FrictionDrift& drift);

}  // namespace breakaway::model
