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
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "breakaway/hybrid/budget.hpp"
#include "breakaway/hybrid/stick_set.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/motion/roots.hpp"

namespace breakaway::hybrid {

using motion::never;

// A motion whose sums are below this is no longer rounded relatively, and has decayed to nothing.
inline constexpr double faded = std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();

// The largest h with c + c' h - bound h^2 / 2 >= 0, without products that could overflow.
inline double safe_step(double value, double slope, double bound) {
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

template <int N>
struct Watch {
  const Line<N>* line;
  double sign;  // c = offset + sign (integral . Y + now . x)
  double offset;
  double scale;      // of the constants that cancel in offset
  int direction;     // of a sliding speed, else -1
  int facet;         // else -1
  double departs_s;  // c = 0 at the start, and c > 0 is proved up to here
};

template <int N, int M>
class Segment {
 public:
  using Set = StickSet<N, M>;
  using Coordinates = typename Set::Coordinates;

  enum class Ending { time, event, faded, forever, exhausted };

  // `noise` is the rounding in x.
  void start(const Set& set, const Coordinates& x, const Coordinates& noise) {
    set_ = &set;
    x_ = x;
    noise_ = noise;
    y_.setZero(x.size());
    amplitude_.setZero(x.size());
    elapsed_s_ = 0;
    watches_.clear();
  }
  void watch(const Watch<N>& watch) { watches_.push_back(watch); }

  double elapsed_s() const { return elapsed_s_; }
  const Coordinates& x() const { return x_; }
  const Coordinates& integral() const { return y_; }
  const Watch<N>& ended_by() const { return watches_[ended_by_]; }

  // Moves to the first event within duration_s, or to duration_s. `forever`: proved that there never is an event, and
  // moved to duration_s if that is finite. `faded`: a direction slides, and all motion has died out. `exhausted`: the
  // budget was, on the way.
  Ending advance(double duration_s, Budget& budget);

  // Says whether the direction's speed is within rounding of zero and falling.
  bool stops_too(const Watch<N>& watch) const {
    return watch.direction >= 0 && elapsed_s_ >= watch.departs_s && value(watch) <= 64 * rounding(watch) &&
           slope(watch) < 0;
  }
  // Says whether the direction's speed is above zero beyond all rounding.
  bool slides(const Watch<N>& watch) const { return watch.direction >= 0 && value(watch) > 1024 * rounding(watch); }
  const std::vector<Watch<N>>& watches() const { return watches_; }

 private:
  using Row = typename Line<N>::Row;

  static double dot(const Row& row, const Coordinates& vector) { return row.transpose().cwiseProduct(vector).sum(); }
  static double dot_abs(const Row& row, const Coordinates& vector) {
    return row.transpose().cwiseProduct(vector).cwiseAbs().sum();
  }
  double value(const Watch<N>& watch) const {
    const double now = dot(watch.line->now, x_);
    return watch.facet < 0 ? watch.sign * now : watch.offset + watch.sign * (dot(watch.line->integral, y_) + now);
  }
  double slope(const Watch<N>& watch) const { return watch.sign * dot(watch.line->first, x_); }
  double rounding(const Watch<N>& watch) const {
    // The instant is rounded, too.
    return 2 * std::numeric_limits<double>::epsilon() *
           (watch.scale + dot_abs(watch.line->now, x_) + std::abs(slope(watch)) * elapsed_s_);
  }

  bool significant(const Row& row) const {
    return std::abs(dot(row, x_)) > significance * dot_abs(row, x_) + dot_abs(row, noise_);
  }
  void measure_amplitudes();
  double curvature(const Row& bound) const { return dot(bound, amplitude_); }
  static double part(const Block& block, const Row& row, const Coordinates& vector) {
    return row.segment(block.first, block.size).dot(vector.segment(block.first, block.size));
  }
  double slow_pace(const Watch<N>& watch) const;
  double slow_phase_s(double left_s, int steps) const;
  double slow_step(const Watch<N>& watch, double c, double first, double second) const;
  double work_of_a_step() const {
    return (static_cast<double>(watches_.size()) * 6 + 20) * static_cast<double>(x_.size());
  }
  void move(double h) {
    set_->flow.propagate(h, x_.data(), y_.data());
    elapsed_s_ += h;
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
  bool at_crossing() const { return value(watches_[ended_by_]) <= rounding(watches_[ended_by_]); }
  bool set_departures();
  double step_to_zero(const Watch<N>& watch, double c) const;
  void polish(double latest_s);
  bool eventless() const;
  bool anything_slides() const {
    return std::any_of(watches_.begin(), watches_.end(), [](const Watch<N>& watch) { return watch.direction >= 0; });
  }

  const Set* set_ = nullptr;
  Coordinates x_, y_, noise_;
  Coordinates before_x_, before_y_;  // before a long step of Newton's method
  double elapsed_s_ = 0;
  std::vector<Watch<N>> watches_;
  Coordinates amplitude_;
  std::size_t ended_by_ = 0;
};

template <int N, int M>
void Segment<N, M>::measure_amplitudes() {
  const Flow& flow = set_->flow;
  for (const Block& block : flow.blocks()) flow.amplitudes(block, x_.data(), amplitude_.data());
}

// Quantities that start at zero are not looked at before they are proved to have left it. False: one leaves it the
// wrong way at once, which ends the segment.
template <int N, int M>
bool Segment<N, M>::set_departures() {
  const double window_s = set_->flow.window_s();
  measure_amplitudes();
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch<N>& watch = watches_[i];
    watch.departs_s = 0;
    if (value(watch) > 8 * rounding(watch)) continue;
    ended_by_ = i;
    const double first = slope(watch);
    if (significant(watch.line->first)) {
      if (first < 0) return false;
      watch.departs_s = std::min(first / curvature(watch.line->second_bound), window_s);
      continue;
    }
    const double second = watch.sign * dot(watch.line->second, x_);
    if (significant(watch.line->second)) {
      if (second < 0) return false;
      watch.departs_s = std::min(second / curvature(watch.line->third_bound), window_s);
    } else {
      // It is zero and stays so, as far as rounding can tell. It is looked at again when the motion has had time to
      // change.
      const double pace_s = slow_pace(watch);
      watch.departs_s = pace_s > 0 ? std::min(pace_s, window_s) : never;
    }
  }
  return true;
}

// A tenth of the time in which the slope of a quantity can change, less the vibrations that are lost in its rounding.
template <int N, int M>
double Segment<N, M>::slow_pace(const Watch<N>& watch) const {
  const Line<N>& line = *watch.line;
  double lost = 0, slope = 0, curvature = 0;
  for (const Block& block : set_->flow.blocks()) {  // the fastest first
    lost += 2 * part(block, line.settled_bound, amplitude_);
    if (lost <= rounding(watch)) continue;
    slope += line.first.segment(block.first, block.size).cwiseAbs().dot(x_.segment(block.first, block.size).cwiseAbs());
    curvature += part(block, line.second_bound, amplitude_);
  }
  return 0.1 * slope / curvature;
}

// How long steps like those of this segment so far may be needed: until the vibrations that they follow have died away,
// if any of them dies, else to the end.
template <int N, int M>
double Segment<N, M>::slow_phase_s(double left_s, int steps) const {
  double phase_s = 0;
  for (const Block& block : set_->flow.blocks()) {  // the fastest first
    if (block.speed * elapsed_s_ < 0.01 * steps) break;
    const double life_s = block.rate < 0 ? 40 / -block.rate : never;
    if (life_s > elapsed_s_) phase_s = std::max(phase_s, life_s - elapsed_s_);
  }
  return phase_s > 0 ? std::min(phase_s, left_s) : left_s;
}

// The longest step with c > 0 for any number of fastest blocks that are bounded by their amplitudes.
template <int N, int M>
double Segment<N, M>::slow_step(const Watch<N>& watch, double c, double first, double second) const {
  const Line<N>& line = *watch.line;
  double longest = safe_step(c, first, second);
  for (const Block& block : set_->flow.blocks()) {
    if (block.speed == 0) break;
    c -= watch.sign * part(block, line.settled, x_) + part(block, line.settled_bound, amplitude_);
    if (!(c > 0)) break;
    first -= watch.sign * part(block, line.first, x_);
    second -= part(block, line.second_bound, amplitude_);
    // A difference that is lost in rounding bounds nothing.
    second = std::max(second, 1e-14 * curvature(line.second_bound));
    longest = std::max(longest, safe_step(c, first, second));
  }
  return longest;
}

template <int N, int M>
typename Segment<N, M>::Ending Segment<N, M>::advance(double duration_s, Budget& budget) {
  if (!set_departures()) return Ending::event;
  const double window_s = set_->flow.window_s(), work = work_of_a_step();
  for (int step = 1;; ++step) {
    budget.spend(work);
    const double left_s = duration_s - elapsed_s_;
    if (budget.judgement_due()) {
      budget.judge(left_s, slow_phase_s(left_s, step));
      if (budget.exhausted()) return Ending::exhausted;
    }
    const Proof proof = look_ahead(window_s, step > steps_before_stiff);
    if (amplitude_.sum() < faded) {
      x_.setZero();
      if (anything_slides()) return Ending::faded;
      if (duration_s < never) move(left_s);
      return Ending::forever;
    }
    if (proof.falls) {
      const double surely_s = 2 * proof.crossing_s;  // the crossing is unique up to here
      const bool surely = surely_s < proof.others_s && surely_s < left_s && surely_s < window_s;
      if (surely || at_crossing()) {
        polish(elapsed_s_ + (surely ? surely_s : 0));
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
    if (!(amplitude_.sum() < never)) {
      throw InputError{"the motion grew beyond the largest number: end it earlier, or by an early decision"};
    }
    const double least = 1e-15 * elapsed_s_;  // where rounding eats the proof, the crossing is here
    move(std::max(proof.free_s, least));
    measure_amplitudes();
  }
}

template <int N, int M>
typename Segment<N, M>::Proof Segment<N, M>::look_ahead(double window_s, bool stiff) {
  Proof proof{window_s, never, never, false};
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    const Watch<N>& watch = watches_[i];
    const double departs_s = watch.departs_s - elapsed_s_;
    if (departs_s > 0) {
      if (departs_s < proof.free_s) {
        proof = {departs_s, std::min(proof.others_s, proof.free_s), never, false};
      } else {
        proof.others_s = std::min(proof.others_s, departs_s);
      }
      continue;
    }
    const double c = std::max(value(watch), 0.0), first = slope(watch);
    const double second = curvature(watch.line->second_bound);
    const double safe = stiff ? slow_step(watch, c, first, second) : safe_step(c, first, second);
    if (safe >= proof.free_s) {
      proof.others_s = std::min(proof.others_s, safe);
      continue;
    }
    proof = {safe, proof.free_s, never, false};
    if (first >= 0) continue;
    ended_by_ = i;
    proof.falls = true;
    const double newton = c / -first;
    // Kantorovich's condition is 1/2; the rest pays for the rounding of the bound.
    if (newton * (second / -first) < 0.25) proof.crossing_s = newton;
  }
  return proof;
}

// Newton's step, better by what the second and third derivatives say of the way: they cost less than another step.
template <int N, int M>
double Segment<N, M>::step_to_zero(const Watch<N>& watch, double c) const {
  const double first = slope(watch), newton = c / -first, second = watch.sign * dot(watch.line->second, x_) / first;
  if (!(std::abs(newton * second) < 0.25)) return newton;
  const double h = 2 * newton / (1 + std::sqrt(1 + 2 * newton * second));
  const double third = watch.sign * dot(watch.line->third, x_) / first, bend = h * h * third / 6;
  return std::abs(bend) < 0.05 ? h - h * bend / (1 + h * second + 3 * bend) : h;
}

// Newton's method to rounding. The crossing is within the segment and not after latest_s, whatever a slope that is lost
// in rounding makes of it.
template <int N, int M>
void Segment<N, M>::polish(double latest_s) {
  const Watch<N>& watch = watches_[ended_by_];
  double before_s = never;
  for (int iteration = 0; iteration < 8; ++iteration) {
    const double c = value(watch);
    if (std::abs(c) <= rounding(watch)) return;
    const double step_s = step_to_zero(watch, c);
    if (!std::isfinite(step_s)) return;
    const double h = std::clamp(step_s, -elapsed_s_, latest_s - elapsed_s_);
    if (h == 0) return;
    // Back in time, vibrations that have died away would grow out of their rounding: a long step starts anew.
    if (h * set_->flow.fastest() > 0.1) {
      before_x_ = x_;
      before_y_ = y_;
      before_s = elapsed_s_;
    }
    if (-h * set_->flow.fastest() > 0.1 && before_s < never) {
      const double ahead_s = elapsed_s_ + h - before_s;
      x_ = before_x_;
      y_ = before_y_;
      elapsed_s_ = before_s;
      move(std::max(ahead_s, 0.0));
    } else {
      move(h);
    }
  }
}

// Says whether the bounds of what is watched exclude an event for all time.
template <int N, int M>
bool Segment<N, M>::eventless() const {
  if (!set_->flow.bounded()) return false;
  for (const Watch<N>& watch : watches_) {
    if (watch.line->drifts) return false;
    const double least =
        value(watch) - watch.sign * dot(watch.line->settled, x_) - curvature(watch.line->settled_bound);
    if (!(least > 0) && watch.departs_s < never) return false;
  }
  return true;
}

extern template class Segment<2, 2>;
extern template class Segment<1, Eigen::Dynamic>;
extern template class Segment<2, Eigen::Dynamic>;
extern template class Segment<Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace breakaway::hybrid
