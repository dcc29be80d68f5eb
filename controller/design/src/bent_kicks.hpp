// What the kicks do on friction that bends before it slides, which their table knows nothing of: tried on Dahl's, whose
// level is constant, at the ends of the class.
//
// Until it has bent, friction takes less of a kick than it would of one that slides, so that the axis goes further; and
// what has bent leads it back, while it rings, as far as a force beside the drive's lets it creep.
#pragma once

#include <vector>

#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design::detail {

struct BentKicks {
  // As shares of the distance that a kick starts from: so far does a kick lead the axis at most, less the way on which
  // the spring leads it back. One that went twice as far would leave it as far away on the other side.
  double furthest = 1;
  double furthest_from_m = 0;
  // So much nearer do a kick and the spring after it lead an axis at least.
  double least_on = 1;
  double least_on_from_m = 0;

  // How much nearer a kick from there leads that would travel so far on friction that holds at once.
  double led_on_m(double from_m, double travel_m) const;

  std::vector<double> tried_from_m;  // from the nearest on
  std::vector<double> lost_m;        // from there, of that travel
  double spring_back_m = 0;          // lost at most from further away
};

constexpr double most_bending_counts = 30;  // that the least friction bends by: tests/campaign

// Of an axis for which the design is possible, and whose friction bends. Where it bends by more counts than is
// certified nothing is tried.
template <class Real>
BentKicks try_bent_kicks(const BrakedClass& axes, const law::BrakedKicks<Real>& kicks, double tolerance_m);

}  // namespace breakaway::design::detail
