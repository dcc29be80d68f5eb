// What the kicks do on friction that bends before it slides, which their table knows nothing of: tried on Dahl's, whose
// level is constant, at the ends of the class.
//
// Until it has bent, friction takes less of a kick than it would of one that slides, so that the axis goes further; and
// what has bent leads it back, while it rings, as far as a force beside the drive's lets it creep.
#pragma once

#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design::detail {

// As shares of the distance that a kick starts from.
struct BentKicks {
  // So far does a kick lead the axis at most that starts where the spring does not lead it. One that went twice as far
  // would leave it as far away on the other side.
  double furthest = 0;
  double furthest_from_m = 0;
  // So much nearer do a kick and the spring after it lead an axis at least.
  double least_on = 0;
  double least_on_from_m = 0;
};

// Of an axis for which the design is possible, and whose friction bends.
BentKicks try_bent_kicks(const BrakedClass& axes, const law::BrakedKicks<float>& kicks, double tolerance_m);

}  // namespace breakaway::design::detail
