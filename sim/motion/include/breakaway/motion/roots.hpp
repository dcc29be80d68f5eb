// Bracketed roots.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace breakaway::motion {

inline constexpr double never = std::numeric_limits<double>::infinity();  // the instant of what does not happen

struct ValueAndSlope {
  double value;
  double slope;
};

// The root of a function with one sign change in [low, high], by Newton's method kept inside the bracket: to the last
// few bits of the root. `rising`: the function is negative at low.
template <class Function>
double bracketed_newton(Function&& function, double low, double high, bool rising) {
  double root = 0.5 * (low + high), before = high - low;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const auto [value, slope] = function(root);
    if (value == 0) return root;
    ((value < 0) == rising ? low : high) = root;
    double next = root - value / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double change = std::abs(next - root);
    root = next;
    // Once small, a change that no longer shrinks is rounding.
    if (change <= 4e-16 * std::abs(root) || (change <= 1e-13 * std::abs(root) && change >= before)) break;
    before = change;
  }
  return root;
}

// The first argument in (low, high] where a predicate that turns true once is true, to the last bit.
template <class Predicate>
double first_true(Predicate&& predicate, double low, double high) {
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return high;
    (predicate(middle) ? high : low) = middle;
  }
}

struct Sample {
  double argument;
  double value;
};

// The first argument in (low, high] at which a function whose slope is at most `steepest` in size is positive; infinity
// if it is nowhere. Not positive at low. Intervals are ruled out by the slope and else halved, `depth` times at most: a
// maximum above zero that is narrower than that may be passed over.
template <class Function>
double first_excess(Function&& function, Sample low, Sample high, double steepest, int depth) {
  // Between the samples the function lies below two lines of the steepest slope, which meet at this height.
  const double ceiling = 0.5 * (low.value + high.value + steepest * (high.argument - low.argument));
  if (ceiling <= 0 && high.value <= 0) return never;
  if (depth == 0) {
    if (high.value <= 0) return never;
    return first_true([&](double argument) { return function(argument) > 0; }, low.argument, high.argument);
  }
  const double argument = 0.5 * (low.argument + high.argument);
  const Sample middle{argument, function(argument)};
  const double first = first_excess(function, low, middle, steepest, depth - 1);
  return first < never || middle.value > 0 ? first : first_excess(function, middle, high, steepest, depth - 1);
}

}  // namespace breakaway::motion
