// The motion of a rigid axis, computed independently of sim/motion: Runge and Kutta's classical method in long double
// with fixed steps far shorter than any scale of time of the axis, and stops located by halving the step. Friction laws
// are taken at their word, as equations; they must be smooth.
#pragma once

#include <vector>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::campaign {

// The first axis under the ideal law: the positions of its first `most` kicks.
std::vector<double> true_kicks_m(const scenario::Scenario& scenario, std::size_t most);

// The first axis behind its drive on the bus under the flashed loop: its position at each of the first `samples`
// periods.
std::vector<double> true_way_m(const scenario::Scenario& scenario, std::size_t samples);

}  // namespace breakaway::campaign
