// Besides a stop, the edges of laws and static limits end a step. They are watched here.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adaptive_motion.hpp"

namespace breakaway::hybrid {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

// Returns the guard's value at the walk's present place.
double AdaptiveStep::value(const Guard& guard, double tau_s, const Vector& force) {
  if (guard.is_edge) return sign(guard.direction) * (guard.edge_m - walk_.position_m(guard.direction));
  return walk_.margin_N(guard.limit, force, walk_.time.after(tau_s));
}

// Returns the rate of what is left to a static limit under friction that does not change.
double AdaptiveStep::slope(const Guard& guard, const Vector& acceleration) const {
  const auto& facet = held_.facets[guard.limit.facet];
  return -guard.limit.side * (facet.stiffness.dot(walk_.v) + facet.damping.dot(held_.basis * acceleration));
}

// Stages lie within a sixth of the step, so that a guard falls by its steepest slope for at most a twelfth of it
// between two of them. One that only rises, or only falls, is least at one of the ends, where it is looked at.
bool AdaptiveStep::surely_kept(const Guard& guard, double duration_s) const {
  const Range& range = guard.range;
  const double steepest = std::max(std::abs(guard.slope.least), std::abs(guard.slope.greatest));
  if (range.least >= (range.greatest - range.least) / 8 && range.least >= duration_s * steepest / 8) return true;
  return constant_levels_ && (guard.slope.least >= 0 || guard.slope.greatest <= 0);
}

// Says whether a static limit was so near at a stage that it may have been exceeded in between.
bool AdaptiveStep::looks_again(const Trial& trial) {
  move_to(trial.path, trial.speeds);
  const Vector force = walk_.force(trial.duration_s);
  return std::any_of(guards_.begin(), guards_.end(), [&](Guard& guard) {
    if (guard.is_edge) return false;
    guard.range.include(value(guard, trial.duration_s, force));
    return !surely_kept(guard, trial.duration_s);
  });
}

bool AdaptiveStep::passes(const Trial& trial) {
  move_to(trial.path, trial.speeds);
  const Vector force = walk_.force(trial.duration_s);
  return std::any_of(guards_.begin(), guards_.end(),
                     [&](const Guard& guard) { return value(guard, trial.duration_s, force) < 0; });
}

// The shortest step that passes a guard, to the last bits: a step of its own for each duration that is tried.
AdaptiveStep::Trial AdaptiveStep::locate(const Trial& beyond) {
  Trial high = beyond;
  double low_s = 0;
  const auto least = [&](const Trial& trial) {
    move_to(trial.path, trial.speeds);
    const Vector force = walk_.force(trial.duration_s);
    double least_value = infinity;
    for (const Guard& guard : guards_) least_value = std::min(least_value, value(guard, trial.duration_s, force));
    return least_value;
  };
  Trial start{true, 0, Vector::Zero(u0_.size()), u0_, 0};
  double low_value = least(start), high_value = least(high);
  if (low_value <= 0) return start;
  // False position with halved ends (Illinois); it stalls where the value is rounding.
  for (int side = 0; high.duration_s - low_s > 4e-16 * high.duration_s;) {
    double middle_s = low_s + (high.duration_s - low_s) * (low_value / (low_value - high_value));
    if (!(middle_s > low_s && middle_s < high.duration_s)) middle_s = 0.5 * (low_s + high.duration_s);
    if (middle_s <= low_s || middle_s >= high.duration_s) break;
    Trial middle = step_in_time(middle_s);
    const double middle_value = least(middle);
    if (middle_value > 0) {
      low_s = middle_s;
      low_value = middle_value;
      if (side < 0) high_value /= 2;
      side = -1;
    } else {
      high = std::move(middle);
      high_value = middle_value;
      if (side > 0) low_value /= 2;
      side = 1;
    }
  }
  return high;
}

// Returns what ended a step that locate() found.
Ending AdaptiveStep::cause(const Trial& trial) {
  const Vector force = walk_.force(trial.duration_s);
  const auto first = std::min_element(guards_.begin(), guards_.end(), [&](const Guard& one, const Guard& other) {
    return value(one, trial.duration_s, force) < value(other, trial.duration_s, force);
  });
  if (first->is_edge) return {Ending::Kind::edge, 0, {}, first->direction, first->edge_m};
  return {Ending::Kind::limit, 0, first->limit, 0, 0};
}

}  // namespace breakaway::hybrid
