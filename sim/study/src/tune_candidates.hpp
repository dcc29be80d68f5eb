// The gains that tune() tries.
#pragma once

#include <vector>

#include "breakaway/study/tune.hpp"
#include "tune_search.hpp"
#include "tuned_axis.hpp"

namespace breakaway::study {

// Those that could be the fastest, the ones that are most likely to be certified first.
std::vector<Gains> fast_gains(const TunedAxis& axis, law::Coast coast, GainGrid grid);

// The same with this share of the force that the axis has.
Gains with_force(const TunedAxis& axis, Gains gains, double share);

}  // namespace breakaway::study
