// Bracketed roots.
#pragma once

#include <algorithm>
#include <cmath>

namespace breakaway::integrators {

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

}  // namespace breakaway::integrators
