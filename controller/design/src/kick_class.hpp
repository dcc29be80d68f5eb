// The numbers that follow from a BrakedClass: brake, preload, and what a pulse does at the corners of the class.
//
// With jitter a pulse lasts up to that much longer or shorter than its periods, and so does its cut. The cut is made
// for the shortest pulse and the longest cut, so that the force never falls below the brake's; furthest goes an axis
// whose pulse is the longest and whose cut the shortest.
#pragma once

#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design::detail {

constexpr double surely_above = 1.002;  // of the greatest friction

class KickClass {
 public:
  explicit KickClass(const BrakedClass& axes);

  double brake_N() const { return brake_N_; }
  double preload_N() const { return preload_N_; }
  // From which a pulse may start at most, as the law compares: a 512th of the way to holding_force_N above the brake.
  double most_start_N() const { return axes_.lag_s.most > 0 ? brake_N_ + (held_N() - brake_N_) / 1000 : brake_N_; }
  double least_friction_N() const { return least_friction_N_; }                // A'
  double most_friction_N() const { return most_friction_N_; }                  // B'
  double held_N() const { return least_friction_N_ / axes_.force_gain.most; }  // A' as a command
  double limit_N() const { return limit_N_; }                                  // whole steps within max_force_N
  double spring_N() const { return spring_N_; }                                // of a force that is kept at rest
  double rounded_down_N(double force_N) const;
  double longest_period_s() const { return axes_.period_s + axes_.jitter_s; }
  double shortest_period_s() const { return axes_.period_s - axes_.jitter_s; }
  // There are so few forces that each pulse is known with its very cut.
  bool listed() const { return limit_N_ / axes_.force_step_N <= most_listed_steps; }

  // The least cut that lets the fastest loop come down to the brake's force within these periods.
  double cut_N(double force_N, int periods, int cut_periods) const;
  // The least number of periods in which a cut within the limit does.
  int cut_periods(double force_N, int periods) const;

  double most_travel_m(double force_N, int periods, int cut_periods) const;
  double least_travel_m(double force_N, int periods, int cut_periods) const;
  // The force with most_travel_m = distance_m.
  double force_N(double distance_m, int periods, int cut_periods) const;
  // The least force that is sure to exceed B' within the periods, by 0.2 %, in whole steps.
  double needed_N(int periods) const;

 private:
  // An axis at an end of the class, and the force from which its pulse starts.
  struct Corner {
    double force_gain, mass_kg, friction_N, lag_s, start_N;
    double longer_s;  // the pulse, by so much; the cut is as much shorter
  };

  double travel_at(const Corner& corner, double force_N, int periods, int cut_periods, double cut_N) const;

  static constexpr double most_listed_steps = 64;

  BrakedClass axes_;
  double least_friction_N_, most_friction_N_, brake_N_, spring_N_, preload_N_, limit_N_;
};

}  // namespace breakaway::design::detail
