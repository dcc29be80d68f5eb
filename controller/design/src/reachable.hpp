// What a tolerance that no certificate can promise would take.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design::detail {

// The true error at rest that is promised where readings within this tolerance are reached.
double error_at_rest_m(const BrakedClass& axes, double reached_m);

// Whether axes of another class with this design keep what is asked of them beside the tolerance.
using Keeps = std::function<bool(const BrakedClass&, const BrakedDesign<float>&)>;

// In words and numbers, each of which makes the tolerance reachable, all else being equal: a tolerance, a period, and
// an error up to which the fine stage may fall short of it; or, where no reading tells the tolerance, a count of the
// encoder, its noise, and what else it takes. What does not make it reachable by itself, or breaks what else is kept,
// is left out.
std::string ways_to_reach(const BrakedClass& axes, const BrakedDesign<float>& design, double tolerance_m,
                          double least_period_s, const Keeps& keeps = {});

// About the largest time constant of the current loop, below that of the class and as little known, with which the axes
// are certified. With a coarse step of force less lag may need a wider tolerance, so that it is looked for downwards.
std::optional<double> longest_lag_s(const BrakedClass& axes, const std::function<bool(const BrakedClass&)>& certified);

}  // namespace breakaway::design::detail
