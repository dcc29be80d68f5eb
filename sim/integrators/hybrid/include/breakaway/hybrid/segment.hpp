// Segment: the motion in one hybrid mode, followed to the first instant at which the mode ends.
//
// Each watched quantity c >= 0 (a sliding speed, or what static friction has left) is a sum of exponentials, whose
// second derivative is bounded by that of its modal amplitudes. So c > 0 is proved up to the root of c + c' h - G h^2 /
// 2, and the search walks from one such root to the next: it cannot step over a pair of crossings. Near a crossing the
// walk becomes Newton's method, once Kantorovich's condition 2 G c <= c'^2 proves that there is one crossing and where.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "breakaway/hybrid/stick_set.hpp"

namespace breakaway::hybrid {

inline constexpr double never = std::numeric_limits<double>::infinity();

// The largest h with c + c' h - bound h^2 / 2 >= 0, without products that could overflow.
inline double safe_step(double value, double slope, double bound) {
  if (slope < 0) {
    const double newton = value / -slope;
    return 2 * newton / (1 + std::sqrt(1 + 2 * newton * (bound / -slope)));
  }
  if (bound == 0) return never;
  const double half = slope / bound;
  return half + std::sqrt(half * half + 2 * (value / bound));
}

// |c'|, |c''| below this share of its own terms is rounding.
inline constexpr double significance = 1e-12;

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

  enum class Ending { time, event, forever };

  void start(const Set& set, const Coordinates& x) {
    set_ = &set;
    x_ = x;
    y_.setZero(x.size());
    elapsed_s_ = 0;
    fastest_growth_ = set.flow.fastest_growth();
    watches_.clear();
  }
  void watch(const Watch<N>& watch) { watches_.push_back(watch); }

  double elapsed_s() const { return elapsed_s_; }
  const Coordinates& x() const { return x_; }
  const Coordinates& integral() const { return y_; }
  const Watch<N>& ended_by() const { return watches_[ended_by_]; }

  // Moves to the first event within duration_s, or to duration_s. `forever`: proved that there never is an event, and
  // moved to duration_s if that is finite.
  Ending advance(double duration_s);

  // Whether the direction's speed is within rounding of zero and falling.
  bool stops_too(const Watch<N>& watch) const {
    return watch.direction >= 0 && elapsed_s_ >= watch.departs_s && value(watch) <= 64 * rounding(watch) &&
           slope(watch) < 0;
  }
  const std::vector<Watch<N>>& watches() const { return watches_; }

 private:
  using Row = typename Line<N>::Row;

  double dot(const Row& row, const Coordinates& vector) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < vector.size(); ++i) sum += row[i] * vector[i];
    return sum;
  }
  double dot_abs(const Row& row, const Coordinates& vector) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < vector.size(); ++i) sum += std::abs(row[i] * vector[i]);
    return sum;
  }
  double value(const Watch<N>& watch) const {
    const double now = dot(watch.line->now, x_);
    return watch.facet < 0 ? watch.sign * now : watch.offset + watch.sign * (dot(watch.line->integral, y_) + now);
  }
  double slope(const Watch<N>& watch) const { return watch.sign * dot(watch.line->first, x_); }
  double rounding(const Watch<N>& watch) const {
    return 2 * std::numeric_limits<double>::epsilon() * (watch.scale + dot_abs(watch.line->now, x_));
  }

  void measure_amplitudes(double window_s);
  double curvature(const Row& bound) const {
    double sum = 0;
    for (std::size_t b = 0; b < set_->flow.blocks().size(); ++b)
      sum += bound[static_cast<Eigen::Index>(b)] * amplitude_[b];
    return sum;
  }
  void move(double h) {
    set_->flow.propagate(h, x_.data(), y_.data());
    elapsed_s_ += h;
  }
  double longest_window() const { return fastest_growth_ > 0 ? 0.85 / fastest_growth_ : never; }

  bool set_departures();
  bool polish(std::size_t index);
  bool eventless() const;

  const Set* set_ = nullptr;
  Coordinates x_, y_;
  double elapsed_s_ = 0;
  double fastest_growth_ = 0;
  std::vector<Watch<N>> watches_;
  std::vector<double> amplitude_;
  std::vector<double> values_, slopes_;
  std::size_t ended_by_ = 0;
};

// Upper bounds of the blocks' amplitudes over the next window_s.
template <int N, int M>
void Segment<N, M>::measure_amplitudes(double window_s) {
  const auto& blocks = set_->flow.blocks();
  amplitude_.resize(blocks.size());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    amplitude_[b] = Flow::amplitude(blocks[b], x_.data()) * Flow::growth(blocks[b], window_s);
  }
}

// Quantities that start at zero are not looked at before they are proved to have left it. False: one leaves it the
// wrong way at once, which ends the segment.
template <int N, int M>
bool Segment<N, M>::set_departures() {
  const double window_s = longest_window();
  measure_amplitudes(0);
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch<N>& watch = watches_[i];
    watch.departs_s = 0;
    if (value(watch) > 8 * rounding(watch)) continue;
    ended_by_ = i;
    const auto departure = [&](double derivative, const Row& bound) {
      const double estimate = std::min(derivative / curvature(bound), window_s);
      measure_amplitudes(estimate);
      const double departs_s = std::min(derivative / curvature(bound), estimate);
      measure_amplitudes(0);
      return departs_s;
    };
    const double first = slope(watch);
    if (std::abs(first) > significance * dot_abs(watch.line->first, x_)) {
      if (first < 0) return false;
      watch.departs_s = departure(first, watch.line->second_bound);
      continue;
    }
    const double second = watch.sign * dot(watch.line->second, x_);
    if (std::abs(second) > significance * dot_abs(watch.line->second, x_)) {
      if (second < 0) return false;
      watch.departs_s = departure(second, watch.line->third_bound);
    } else {
      watch.departs_s = never;  // a quantity that is zero and stays so
    }
  }
  return true;
}

template <int N, int M>
typename Segment<N, M>::Ending Segment<N, M>::advance(double duration_s) {
  if (!set_departures()) return Ending::event;
  values_.resize(watches_.size());
  slopes_.resize(watches_.size());
  for (int step = 0;; ++step) {
    const double left_s = duration_s - elapsed_s_;
    // Two passes where amplitudes grow: how far to look decides how large they become.
    double h = never, second_h = never;
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < watches_.size(); ++i) {
      values_[i] = value(watches_[i]);
      slopes_[i] = slope(watches_[i]);
    }
    const auto look = [&](double window_s) {
      measure_amplitudes(window_s);
      h = second_h = never;
      for (std::size_t i = 0; i < watches_.size(); ++i) {
        const double until_s = watches_[i].departs_s - elapsed_s_;
        const double safe =
            until_s > 0 ? until_s
                        : safe_step(std::max(values_[i], 0.0), slopes_[i], curvature(watches_[i].line->second_bound));
        if (safe < h) {
          second_h = h;
          h = safe;
          nearest = i;
        } else if (safe < second_h) {
          second_h = safe;
        }
      }
    };
    look(0);
    const double window_s = std::min({2 * h, 2 * left_s, 2 * longest_window()});
    if (fastest_growth_ > 0 && window_s > 0) look(window_s);
    h = std::min(h, longest_window());
    if (h == never && duration_s == never) return Ending::forever;

    const bool sought = !watches_.empty() && elapsed_s_ >= watches_[nearest].departs_s && slopes_[nearest] < 0;
    if (sought) {
      const Watch<N>& watch = watches_[nearest];
      const double newton = values_[nearest] / -slopes_[nearest];
      const double bend = newton * (curvature(watch.line->second_bound) / -slopes_[nearest]);
      if (values_[nearest] <= rounding(watch) || (bend < 0.25 && 2 * newton < second_h && 2 * newton < left_s)) {
        ended_by_ = nearest;
        polish(nearest);
        return Ending::event;
      }
    }
    if (h >= left_s) {
      move(left_s);
      return Ending::time;
    }
    if (step >= 16 && step % 16 == 0 && eventless()) {
      if (duration_s < never) move(left_s);
      return Ending::forever;
    }
    if (elapsed_s_ + h == elapsed_s_) h = 1e-15 * elapsed_s_;  // rounding eats the proof: the crossing is here
    move(h);
  }
}

// Newton's method to rounding.
template <int N, int M>
bool Segment<N, M>::polish(std::size_t index) {
  const Watch<N>& watch = watches_[index];
  for (int iteration = 0; iteration < 8; ++iteration) {
    const double c = value(watch);
    const double h = c / -slope(watch);
    if (std::abs(c) <= rounding(watch) || !std::isfinite(h)) return true;
    move(h);
  }
  return false;
}

// Whether the bounds of what is watched over all time exclude an event.
template <int N, int M>
bool Segment<N, M>::eventless() const {
  if (fastest_growth_ > 0) return false;
  const auto& blocks = set_->flow.blocks();
  for (const Watch<N>& watch : watches_) {
    if (watch.line->drifts) return false;
    double least = value(watch) - watch.sign * dot(watch.line->settled, x_);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      least -= watch.line->settled_bound[static_cast<Eigen::Index>(b)] * Flow::amplitude(blocks[b], x_.data()) *
               Flow::growth(blocks[b], 0);
    }
    if (!(least > 0) && watch.departs_s < never) return false;
  }
  return true;
}

}  // namespace breakaway::hybrid
