// Why tune() has chosen what it has, one sentence a number.
#pragma once

#include <vector>

#include "tune_search.hpp"
#include "tuned_axis.hpp"

namespace breakaway::study {

std::vector<ChosenNumber> reasons(const TunedAxis& axis, const Tolerance& tolerance, const Tuning& tuning);

}  // namespace breakaway::study
