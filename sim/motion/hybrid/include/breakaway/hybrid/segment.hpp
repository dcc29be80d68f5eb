// Segment: the motion in one hybrid mode, followed to the first instant at which the mode ends.
//
// Each watched quantity c >= 0 (a sliding speed, or what static friction has left) is a sum of exponentials, whose
// second derivative is bounded by that of its modal amplitudes. So c > 0 is proved up to the root of c + c' h - G h^2 /
// 2, and the search walks from one such root to the next: it cannot step over a pair of crossings. Near a crossing the
// walk becomes Newton's method, once Kantorovich's condition 2 G c <= c'^2 proves that there is one crossing and where.
//
// In a stiff machine G is that of the fastest vibration, however small. There the walk takes the fastest modes out of
// c, c' and G, and their amplitudes off c: what is left is followed at the pace of the slow modes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "breakaway/hybrid/budget.hpp"
#include "breakaway/hybrid/refused.hpp"
#include "breakaway/hybrid/watched_motion.hpp"

namespace breakaway::hybrid {

// A motion whose sums are below this is no longer rounded relatively, and has decayed to nothing.
inline constexpr double least_motion = std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();

[[noreturn]] inline void refuse_growth() {
  throw Refused{"the motion grew beyond the largest number",
                "end it earlier, or correct the damping or stiffness that is negative"};
}

// The largest h with c + c' h - bound h^2 / 2 >= 0, without products that could overflow.
[[gnu::always_inline]] inline double safe_step(double value, double slope, double bound) {
  if (slope < 0) {
    const double newton = value / -slope, bend = newton * (bound / -slope);
    return bend < 1e30 ? 2 * newton / (1 + std::sqrt(1 + 2 * bend)) : std::sqrt(2 * (value / bound));
  }
  if (bound == 0) return never;
  const double half = slope / bound;
  return half + std::sqrt(half * half + 2 * (value / bound));
}

// A segment of an ordinary machine takes fewer steps than this.
inline constexpr int steps_before_stiff = 8;
// Newton's method takes two or three steps, and many where several derivatives are zero at the crossing, too.
inline constexpr int most_polishing = 64;

template <int N, int M>
class Segment : public WatchedMotion<N, M> {
 public:
  enum class Ending { time, event, faded, forever, exhausted };

  using WatchedMotion<N, M>::elapsed_s, WatchedMotion<N, M>::x, WatchedMotion<N, M>::watches;

  const Watch<N>& ended_by() const { return watches()[ended_by_]; }

  // Moves to the first event within duration_s, or to duration_s. `forever`: proved that there never is an event, and
  // moved to duration_s if that is finite. `faded`: a direction slides, and all motion has died out. `exhausted`: the
  // budget was, on the way.
  Ending advance(double duration_s, Budget& budget);

 private:
  using Base = WatchedMotion<N, M>;
  using Base::amplitude, Base::amplitudes, Base::curvature, Base::depart_again, Base::departure_s, Base::dot;
  using Base::fade, Base::flow, Base::is_below, Base::keep, Base::measure_amplitudes, Base::move, Base::part;
  using Base::place, Base::return_to_kept, Base::rounding, Base::set_departures, Base::short_step_s, Base::slope;
  using Base::sum, Base::value;
  using typename Base::Sum;

  double slow_phase_s(double left_s, int steps) const;
  [[gnu::noinline]] double slow_step(const Watch<N>& watch, double c, double first, double second) const;
  double work_of_a_step() const {
    return (static_cast<double>(watches().size()) * 6 + 20) * static_cast<double>(x().size());
  }
  // Holds what is proved about the near future.
  struct Proof {
    double free_s;      // nothing crosses zero up to here
    double others_s;    // all but one do not up to here
    double crossing_s;  // Newton's step of that one, if it surely crosses
    bool falls;         // that one, which is ended_by_
  };
  Proof look_ahead(double window_s, bool stiff);
  // Says whether what falls is zero to rounding.
  bool at_crossing() const {
    const Watch<N>& watch = watches()[ended_by_];
    return is_below(1, sum(watch), slope(watch));
  }
  double step_to_zero(const Watch<N>& watch, double c, double first) const;
  void polish(double latest_s);
  bool eventless() const;
  bool anything_slides() const {
    return std::ranges::any_of(watches(), [](const Watch<N>& watch) { return watch.direction >= 0; });
  }

  std::size_t ended_by_ = 0;
};

// How long steps like those of this segment so far may be needed: until the vibrations that they follow have died away,
// if any of them dies, else to the end.
template <int N, int M>
double Segment<N, M>::slow_phase_s(double left_s, int steps) const {
  double phase_s = 0;
  for (const Block& block : flow().blocks()) {  // the fastest first
    if (block.speed * elapsed_s() < 0.01 * steps) break;
    const double life_s = block.rate < 0 ? 40 / -block.rate : never;
    if (life_s > elapsed_s()) phase_s = std::max(phase_s, life_s - elapsed_s());
  }
  return phase_s > 0 ? std::min(phase_s, left_s) : left_s;
}

// The longest step with c > 0 for any number of fastest blocks that are bounded by their amplitudes. One in which the
// quantity drifts has no such bound, and neither it nor a slower one is taken out. Where the second derivative is too
// coarse a bound for a quantity that has just left zero, higher ones tell more.
template <int N, int M>
double Segment<N, M>::slow_step(const Watch<N>& watch, double c, double first, double second) const {
  const Line<N>& line = *watch.line;
  double longest = safe_step(c, first, second);
  const bool just_left = elapsed_s() * flow().fastest() < 1;
  if (just_left && first >= 0 && longest < short_step_s()) longest = std::max(longest, departure_s(watch));
  for (const Block& block : flow().blocks()) {
    c -= watch.sign * part(block, line.settled, x()) + part(block, line.settled_bound, amplitudes());
    if (!(c > 0)) break;
    first -= watch.sign * part(block, line.first, x());
    second -= part(block, line.second_bound, amplitudes());
    // A difference that is lost in rounding bounds nothing.
    second = std::max(second, 1e-14 * curvature(line.second_bound));
    longest = std::max(longest, safe_step(c, first, second));
  }
  return longest;
}

template <int N, int M>
typename Segment<N, M>::Ending Segment<N, M>::advance(double duration_s, Budget& budget) {
  if (const Watch<N>* const leaves = set_departures()) {
    ended_by_ = place(*leaves);
    return Ending::event;
  }
  const double window_s = flow().window_s(), short_s = short_step_s(), work = work_of_a_step();
  for (int step = 1;; ++step) {
    budget.spend(work);
    const double left_s = duration_s - elapsed_s();
    if (budget.judgement_due()) {
      budget.judge(left_s, slow_phase_s(left_s, step));
      if (budget.exhausted()) return Ending::exhausted;
    }
    const Proof proof = look_ahead(window_s, step > steps_before_stiff);
    const double motion = amplitude();
    if (motion < least_motion) {
      fade();
      if (anything_slides()) return Ending::faded;
      if (duration_s < never) move(left_s);
      return Ending::forever;
    }
    if (proof.falls) {
      const double surely_s = 2 * proof.crossing_s;  // the crossing is unique up to here
      const bool surely = surely_s < proof.others_s && surely_s < left_s && surely_s < window_s;
      if (surely || at_crossing()) {
        polish(elapsed_s() + (surely ? surely_s : 0));
        return Ending::event;
      }
    }
    if (proof.free_s >= left_s && duration_s < never) {
      const bool for_ever = eventless();
      move(left_s);
      return for_ever ? Ending::forever : Ending::time;
    }
    if ((proof.free_s == never || step % 16 == 0) && eventless()) {
      if (duration_s < never) move(left_s);
      return Ending::forever;
    }
    if (!(motion < never)) refuse_growth();
    if (proof.free_s < short_s) [[unlikely]]
      depart_again();
    const double least = 1e-15 * elapsed_s();  // where rounding eats the proof, the crossing is here
    move(std::max(proof.free_s, least));
    measure_amplitudes();
  }
}

template <int N, int M>
typename Segment<N, M>::Proof Segment<N, M>::look_ahead(double window_s, bool stiff) {
  double free_s = window_s, others_s = never, crossing_s = never;
  bool falls = false;
  for (const Watch<N>& watch : watches()) {
    const double departs_s = watch.departs_s - elapsed_s();
    const bool departs = departs_s > 0;
    double first = 0, c = 0, second = 0, safe = departs_s;
    if (!departs) {
      c = std::max(value(watch), 0.0);
      first = slope(watch);
      second = curvature(watch.line->second_bound);
      safe = stiff ? slow_step(watch, c, first, second) : safe_step(c, first, second);
    }
    if (safe >= free_s) {
      others_s = std::min(others_s, safe);
      continue;
    }
    others_s = departs ? std::min(others_s, free_s) : free_s;
    free_s = safe;
    crossing_s = never;
    falls = first < 0;
    if (!falls) continue;
    ended_by_ = place(watch);
    const double newton = c / -first;
    // Kantorovich's condition is 1/2; the rest pays for the rounding of the bound.
    if (newton * (second / -first) < 0.25) crossing_s = newton;
  }
  return {free_s, others_s, crossing_s, falls};
}

// Newton's step, better by what the second and third derivatives say of the way: they cost less than another step.
template <int N, int M>
double Segment<N, M>::step_to_zero(const Watch<N>& watch, double c, double first) const {
  const double newton = c / -first, second = watch.sign * dot(watch.line->second, x()) / first;
  if (!(std::abs(newton * second) < 0.25)) return newton;
  const double h = 2 * newton / (1 + std::sqrt(1 + 2 * newton * second));
  const double third = watch.sign * dot(watch.line->third, x()) / first, bend = h * h * third / 6;
  return std::abs(bend) < 0.05 ? h - h * bend / (1 + h * second + 3 * bend) : h;
}

// Newton's method to rounding. The crossing is within the segment and not after latest_s, whatever a slope that is lost
// in rounding makes of it.
template <int N, int M>
void Segment<N, M>::polish(double latest_s) {
  const Watch<N>& watch = watches()[ended_by_];
  bool kept = false;
  for (int iteration = 0; iteration < most_polishing; ++iteration) {
    const Sum c = sum(watch);
    const double first = slope(watch);
    if (std::abs(c.value) <= rounding(c, first)) return;
    const double step_s = step_to_zero(watch, c.value, first);
    if (!std::isfinite(step_s)) return;
    const double h = std::clamp(step_s, -elapsed_s(), latest_s - elapsed_s());
    if (h == 0) return;
    // Back in time, vibrations that have died away would grow out of their rounding: a long step starts anew.
    if (h * flow().fastest() > 0.1) {
      keep();
      kept = true;
    }
    if (-h * flow().fastest() > 0.1 && kept) {
      const double until_s = elapsed_s() + h;
      return_to_kept();
      move(std::max(until_s - elapsed_s(), 0.0));
    } else {
      move(h);
    }
  }
}

// Says whether the bounds of what is watched exclude an event for all time.
template <int N, int M>
bool Segment<N, M>::eventless() const {
  if (!flow().bounded()) return false;
  for (const Watch<N>& watch : watches()) {
    if (watch.line->drifts) return false;
    const double least =
        value(watch) - watch.sign * dot(watch.line->settled, x()) - curvature(watch.line->settled_bound);
    if (!(least > 0) && watch.departs_s < never) return false;
  }
  return true;
}

extern template class Segment<2, 2>;
extern template class Segment<1, Eigen::Dynamic>;
extern template class Segment<2, Eigen::Dynamic>;
extern template class Segment<Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace breakaway::hybrid
