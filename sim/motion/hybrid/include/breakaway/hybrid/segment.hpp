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
#include "breakaway/hybrid/refused.hpp"
#include "breakaway/hybrid/stick_set.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/motion/roots.hpp"

namespace breakaway::hybrid {

using motion::never;

// A motion whose sums are below this is no longer rounded relatively, and has decayed to nothing.
inline constexpr double faded = std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();

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

// Where `now` and x cancel, c = start + sign first . Y tells more of it, as long as the motion has changed little.
struct WatchedChange {
  double start;
  double scale;  // of the terms that cancel in start
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
    changes_.clear();
    cancels_ = false;
  }
  void watch(const Watch<N>& watch) { watches_.push_back(watch); }
  // Of the watch that came last: of each, or of none.
  void watch_change(const WatchedChange& change) {
    changes_.push_back(change);
    cancels_ = true;
  }

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
    if (watch.direction < 0 || elapsed_s_ < watch.departs_s) return false;
    const double first = slope(watch);
    return first < 0 && is_below(64, sum(watch), first);
  }
  // Says whether the direction's speed is above zero beyond all rounding.
  bool slides(const Watch<N>& watch) const { return watch.direction >= 0 && !is_below(1024, sum(watch), slope(watch)); }
  const std::vector<Watch<N>>& watches() const { return watches_; }

 private:
  using Row = typename Line<N>::Row;

  std::size_t place(const Watch<N>& watch) const { return static_cast<std::size_t>(&watch - watches_.data()); }

  // A sum, and the sum of the sizes of its terms.
  struct Sum {
    double value, size;
  };
  static Sum sum(const Row& row, const Coordinates& vector) {
    const auto terms = row.transpose().cwiseProduct(vector);
    return {terms.sum(), terms.cwiseAbs().sum()};
  }
  static double dot(const Row& row, const Coordinates& vector) { return row.transpose().cwiseProduct(vector).sum(); }
  static double dot_abs(const Row& row, const Coordinates& vector) {
    return row.transpose().cwiseProduct(vector).cwiseAbs().sum();
  }

  double value(const Watch<N>& watch) const { return sum(watch).value; }
  double slope(const Watch<N>& watch) const { return watch.sign * dot(watch.line->first, x_); }
  Sum sum(const Watch<N>& watch) const { return cancels_ ? sum_by_change(watch) : sum_by_state(watch); }
  Sum sum_by_state(const Watch<N>& watch) const {
    const Sum now = sum(watch.line->now, x_);
    if (watch.facet < 0) return {watch.sign * now.value, now.size};
    return {watch.offset + watch.sign * (dot(watch.line->integral, y_) + now.value), watch.scale + now.size};
  }
  // Out of line, as ordinary machines have none.
  [[gnu::noinline]] Sum sum_by_change(const Watch<N>& watch) const;
  static double rounding(const Sum& of) { return 2 * std::numeric_limits<double>::epsilon() * of.size; }
  // After the start the instant is rounded, too.
  double rounding(const Sum& of, double slope) const {
    return rounding(Sum{of.value, of.size + std::abs(slope) * elapsed_s_});
  }
  bool is_below(double roundings, const Sum& of, double slope) const {
    return of.value <= roundings * rounding(of, slope);
  }
  bool is_significant(const Sum& of, const Row& row) const {
    return std::abs(of.value) > significance * of.size + dot_abs(row, noise_);
  }
  void measure_amplitudes();
  double curvature(const Row& bound) const { return dot(bound, amplitude_); }
  static double part(const Block& block, const Row& row, const Coordinates& vector) {
    return row.segment(block.first, block.size).dot(vector.segment(block.first, block.size));
  }
  [[gnu::noinline]] double slow_pace(const Watch<N>& watch, double rounding) const;
  double slow_phase_s(double left_s, int steps) const;
  [[gnu::noinline]] double slow_step(const Watch<N>& watch, double c, double first, double second) const;
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
  bool at_crossing() const {
    const Watch<N>& watch = watches_[ended_by_];
    return is_below(1, sum(watch), slope(watch));
  }
  bool set_departures();
  [[gnu::noinline]] void depart_again();
  [[gnu::noinline]] double departure_s(const Watch<N>& watch) const;
  void advance_derivative(ExtendedMatrix& row, Row& bound) const;
  // Steps that are shorter than this are not for want of time, but because a quantity is next to zero.
  double short_step_s() const { return 1e-3 / set_->flow.fastest(); }
  double step_to_zero(const Watch<N>& watch, double c, double first) const;
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
  std::vector<WatchedChange> changes_;  // by watch, or none
  bool cancels_ = false;                // there are any
  Coordinates amplitude_;
  std::size_t ended_by_ = 0;
};

// A quantity is told from its change since the start as long as that is known better than the state.
template <int N, int M>
typename Segment<N, M>::Sum Segment<N, M>::sum_by_change(const Watch<N>& watch) const {
  const Sum by_state = sum_by_state(watch), since = sum(watch.line->first, y_);
  const WatchedChange& change = changes_[place(watch)];
  const double size = change.scale + since.size;
  if (!(size < by_state.size)) return by_state;
  return {change.start + watch.sign * since.value, size};
}

template <int N, int M>
void Segment<N, M>::measure_amplitudes() {
  const Flow& flow = set_->flow;
  for (const Block& block : flow.blocks()) flow.amplitudes(block, x_.data(), amplitude_.data());
}

// Quantities that start at zero are not looked at before they are proved to have left it. False: one leaves it the
// wrong way at once, which ends the segment.
template <int N, int M>
bool Segment<N, M>::set_departures() {
  const double window_s = set_->flow.window_s(), short_s = short_step_s();
  measure_amplitudes();
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch<N>& watch = watches_[i];
    watch.departs_s = 0;
    const Sum start = sum(watch);
    if (!(start.value <= 8 * rounding(start))) continue;
    ended_by_ = i;
    double departs_s = 0;
    const Sum first = sum(watch.line->first, x_);
    if (is_significant(first, watch.line->first))
      departs_s = watch.sign * first.value / curvature(watch.line->second_bound);
    if (std::abs(departs_s) < short_s) departs_s = departure_s(watch);
    if (departs_s < 0) return false;
    if (departs_s == 0) departs_s = slow_pace(watch, rounding(start));
    watch.departs_s = std::min(departs_s, window_s);
  }
  return true;
}

// A quantity that stays zero as far as rounding can tell is looked at again at its slow pace: proved steps would be as
// short as its rounding. A direction that slides without speed, held to its very limit by a constant force, is one.
template <int N, int M>
void Segment<N, M>::depart_again() {
  for (Watch<N>& watch : watches_) {
    const Sum now = sum(watch);
    if (elapsed_s_ < watch.departs_s || now.value > 8 * rounding(now) || departure_s(watch) != 0) continue;
    watch.departs_s = elapsed_s_ + std::min(slow_pace(watch, rounding(now)), set_->flow.window_s());
  }
}

// A quantity that is zero leaves it as the first of its derivatives says that is not zero, too: at a start from rest
// the forces on a mass may change with the third or fourth power of time. It is positive for half of the time that the
// bound of the derivative above one that is positive allows, if those below are not negative. Before its terms exceed
// its rounding nothing can be seen of it. Returns the greater time, a negative one if it leaves downwards at once, and
// 0 if all derivatives are zero as far as rounding can tell.
template <int N, int M>
double Segment<N, M>::departure_s(const Watch<N>& watch) const {
  const Flow& flow = set_->flow;
  const double unseen = 64 * rounding(sum(watch));
  Row derivative = watch.line->first, bound = Row::Zero(x_.size());
  ExtendedMatrix row = derivative.head(flow.size()).template cast<Extended>();
  double positive_s = 0, unseen_s = never, factorial = 1;
  for (Eigen::Index order = 1; order <= flow.size() && positive_s * flow.fastest() < 0.1; ++order) {
    const Sum change = sum(derivative, x_);
    const bool significant = is_significant(change, derivative);
    const double rate = watch.sign * change.value, power = static_cast<double>(order);
    if (significant && rate < 0) return positive_s > 0 ? positive_s : -never;
    advance_derivative(row, bound);
    derivative.head(flow.size()) = row.template cast<double>();
    factorial *= power;
    if (!significant) continue;
    positive_s = std::max(positive_s, 0.5 * (power + 1) * rate / curvature(bound));
    unseen_s = std::min(unseen_s, std::pow(unseen * factorial / rate, 1 / power));
  }
  return unseen_s < never ? std::max(positive_s, unseen_s) : 0;
}

// Takes the next derivative of row x, and its bound.
template <int N, int M>
void Segment<N, M>::advance_derivative(ExtendedMatrix& row, Row& bound) const {
  const Flow& flow = set_->flow;
  for (const Block& block : flow.blocks()) {
    const auto columns = Eigen::seqN(block.first, block.size);
    row(0, columns) = (row(0, columns) * flow.generator()(columns, columns)).eval();
    flow.bound(block, row, Flow::Horizon::window, bound.data());
  }
}

// When to look again at a quantity that stays zero as far as rounding can tell: a tenth of the time in which its slope
// can change, less the vibrations that are lost in its rounding, but no motion changes anything before a tenth of its
// own time. Only where there is no motion left it stays for ever.
template <int N, int M>
double Segment<N, M>::slow_pace(const Watch<N>& watch, double rounding) const {
  const Line<N>& line = *watch.line;
  double lost = 0, slope = 0, curvature = 0, speed = 0;
  for (const Block& block : set_->flow.blocks()) {  // the fastest first
    lost += 2 * part(block, line.settled_bound, amplitude_);
    if (lost <= rounding && !line.drifts) continue;
    slope += line.first.segment(block.first, block.size).cwiseAbs().dot(x_.segment(block.first, block.size).cwiseAbs());
    curvature += part(block, line.second_bound, amplitude_);
    speed = std::max(speed, block.speed);
  }
  return curvature > 0 ? 0.1 * std::max(slope / curvature, 1 / speed) : never;
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

// The longest step with c > 0 for any number of fastest blocks that are bounded by their amplitudes. One in which the
// quantity drifts has no such bound, and neither it nor a slower one is taken out. Where the second derivative is too
// coarse a bound for a quantity that has just left zero, higher ones tell more.
template <int N, int M>
double Segment<N, M>::slow_step(const Watch<N>& watch, double c, double first, double second) const {
  const Line<N>& line = *watch.line;
  double longest = safe_step(c, first, second);
  const bool just_left = elapsed_s_ * set_->flow.fastest() < 1;
  if (just_left && first >= 0 && longest < short_step_s()) longest = std::max(longest, departure_s(watch));
  for (const Block& block : set_->flow.blocks()) {
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
  const double window_s = set_->flow.window_s(), short_s = short_step_s(), work = work_of_a_step();
  for (int step = 1;; ++step) {
    budget.spend(work);
    const double left_s = duration_s - elapsed_s_;
    if (budget.judgement_due()) {
      budget.judge(left_s, slow_phase_s(left_s, step));
      if (budget.exhausted()) return Ending::exhausted;
    }
    const Proof proof = look_ahead(window_s, step > steps_before_stiff);
    const double motion = amplitude_.sum();
    if (motion < faded) {
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
    if (!(motion < never)) refuse_growth();
    if (proof.free_s < short_s) [[unlikely]]
      depart_again();
    const double least = 1e-15 * elapsed_s_;  // where rounding eats the proof, the crossing is here
    move(std::max(proof.free_s, least));
    measure_amplitudes();
  }
}

template <int N, int M>
typename Segment<N, M>::Proof Segment<N, M>::look_ahead(double window_s, bool stiff) {
  double free_s = window_s, others_s = never, crossing_s = never;
  bool falls = false;
  for (const Watch<N>& watch : watches_) {
    const double departs_s = watch.departs_s - elapsed_s_;
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
  const double newton = c / -first, second = watch.sign * dot(watch.line->second, x_) / first;
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
  for (int iteration = 0; iteration < most_polishing; ++iteration) {
    const Sum c = sum(watch);
    const double first = slope(watch);
    if (std::abs(c.value) <= rounding(c, first)) return;
    const double step_s = step_to_zero(watch, c.value, first);
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
