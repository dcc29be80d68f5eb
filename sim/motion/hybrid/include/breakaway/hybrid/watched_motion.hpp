// WatchedMotion: the motion in one hybrid mode, and what is watched on it.
//
// Each watched quantity c >= 0 (a sliding speed, or what static friction has left) is a sum of exponentials whose terms
// cancel, so that it comes with their size and is known up to their rounding. Nothing can be seen of one that is zero
// before it has left its rounding: its derivatives say when that is, and until then it is not looked at.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "breakaway/hybrid/stick_set.hpp"
#include "breakaway/motion/roots.hpp"

namespace breakaway::hybrid {

using motion::never;

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
class WatchedMotion {
 public:
  using Set = StickSet<N, M>;
  using Coordinates = typename Set::Coordinates;

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
  const std::vector<Watch<N>>& watches() const { return watches_; }

  // Says whether the direction's speed is within rounding of zero and falling.
  bool stops_too(const Watch<N>& watch) const {
    if (watch.direction < 0 || elapsed_s_ < watch.departs_s) return false;
    const double first = slope(watch);
    return first < 0 && is_below(64, sum(watch), first);
  }
  // Says whether the direction's speed is above zero beyond all rounding.
  bool slides(const Watch<N>& watch) const { return watch.direction >= 0 && !is_below(1024, sum(watch), slope(watch)); }

 protected:
  using Row = typename Line<N>::Row;

  const Flow& flow() const { return set_->flow; }
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
  double amplitude() const { return amplitude_.sum(); }
  const Coordinates& amplitudes() const { return amplitude_; }

  void move(double h) {
    flow().propagate(h, x_.data(), y_.data());
    elapsed_s_ += h;
  }
  void fade() { x_.setZero(); }
  // Keeps this instant, which return_to_kept() goes back to without the rounding of the way.
  void keep() {
    kept_x_ = x_;
    kept_y_ = y_;
    kept_s_ = elapsed_s_;
  }
  void return_to_kept() {
    x_ = kept_x_;
    y_ = kept_y_;
    elapsed_s_ = kept_s_;
  }

  const Watch<N>* set_departures();
  [[gnu::noinline]] void depart_again();
  [[gnu::noinline]] double departure_s(const Watch<N>& watch) const;
  // Steps that are shorter than this are not for want of time, but because a quantity is next to zero.
  double short_step_s() const { return 1e-3 / flow().fastest(); }

 private:
  void advance_derivative(ExtendedMatrix& row, Row& bound) const;
  [[gnu::noinline]] double slow_pace(const Watch<N>& watch, double rounding) const;

  const Set* set_ = nullptr;
  Coordinates x_, y_, noise_;
  double elapsed_s_ = 0;
  Coordinates kept_x_, kept_y_;
  double kept_s_ = 0;
  std::vector<Watch<N>> watches_;
  std::vector<WatchedChange> changes_;  // by watch, or none
  bool cancels_ = false;                // there are any
  Coordinates amplitude_;
};

// A quantity is told from its change since the start as long as that is known better than the state.
template <int N, int M>
typename WatchedMotion<N, M>::Sum WatchedMotion<N, M>::sum_by_change(const Watch<N>& watch) const {
  const Sum by_state = sum_by_state(watch), since = sum(watch.line->first, y_);
  const WatchedChange& change = changes_[place(watch)];
  const double size = change.scale + since.size;
  if (!(size < by_state.size)) return by_state;
  return {change.start + watch.sign * since.value, size};
}

template <int N, int M>
void WatchedMotion<N, M>::measure_amplitudes() {
  const Flow& flow = set_->flow;
  for (const Block& block : flow.blocks()) flow.amplitudes(block, x_.data(), amplitude_.data());
}

// Quantities that start at zero are not looked at before they are proved to have left it. Returns one that leaves it
// the wrong way at once, which ends the segment, or nothing.
template <int N, int M>
const Watch<N>* WatchedMotion<N, M>::set_departures() {
  const double window_s = flow().window_s(), short_s = short_step_s();
  measure_amplitudes();
  for (Watch<N>& watch : watches_) {
    watch.departs_s = 0;
    const Sum start = sum(watch);
    if (!(start.value <= 8 * rounding(start))) continue;
    double departs_s = 0;
    const Sum first = sum(watch.line->first, x_);
    if (is_significant(first, watch.line->first))
      departs_s = watch.sign * first.value / curvature(watch.line->second_bound);
    if (std::abs(departs_s) < short_s) departs_s = departure_s(watch);
    if (departs_s < 0) return &watch;
    if (departs_s == 0) departs_s = slow_pace(watch, rounding(start));
    watch.departs_s = std::min(departs_s, window_s);
  }
  return nullptr;
}

// A quantity that stays zero as far as rounding can tell is looked at again at its slow pace: proved steps would be as
// short as its rounding. A direction that slides without speed, held to its very limit by a constant force, is one.
template <int N, int M>
void WatchedMotion<N, M>::depart_again() {
  for (Watch<N>& watch : watches_) {
    const Sum now = sum(watch);
    if (elapsed_s_ < watch.departs_s || now.value > 8 * rounding(now) || departure_s(watch) != 0) continue;
    watch.departs_s = elapsed_s_ + std::min(slow_pace(watch, rounding(now)), flow().window_s());
  }
}

// A quantity that is zero leaves it as the first of its derivatives says that is not zero, too: at a start from rest
// the forces on a mass may change with the third or fourth power of time. It is positive for half of the time that the
// bound of the derivative above one that is positive allows, if those below are not negative. Before its terms exceed
// its rounding nothing can be seen of it. Returns the greater time, a negative one if it leaves downwards at once, and
// 0 if all derivatives are zero as far as rounding can tell.
template <int N, int M>
double WatchedMotion<N, M>::departure_s(const Watch<N>& watch) const {
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
void WatchedMotion<N, M>::advance_derivative(ExtendedMatrix& row, Row& bound) const {
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
double WatchedMotion<N, M>::slow_pace(const Watch<N>& watch, double rounding) const {
  const Line<N>& line = *watch.line;
  double lost = 0, slope = 0, curvature = 0, speed = 0;
  for (const Block& block : flow().blocks()) {  // the fastest first
    lost += 2 * part(block, line.settled_bound, amplitude_);
    if (lost <= rounding && !line.drifts) continue;
    slope += line.first.segment(block.first, block.size).cwiseAbs().dot(x_.segment(block.first, block.size).cwiseAbs());
    curvature += part(block, line.second_bound, amplitude_);
    speed = std::max(speed, block.speed);
  }
  return curvature > 0 ? 0.1 * std::max(slope / curvature, 1 / speed) : never;
}

extern template class WatchedMotion<2, 2>;
extern template class WatchedMotion<1, Eigen::Dynamic>;
extern template class WatchedMotion<2, Eigen::Dynamic>;
extern template class WatchedMotion<Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace breakaway::hybrid
