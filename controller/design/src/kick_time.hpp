// How long one kick of the coast "brake" takes at most, from one proof of rest to the next.
#pragma once

#include <algorithm>
#include <cmath>

#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/law/force_interval.hpp"

namespace breakaway::design::detail {

// Readings of an axis that rests differ by noise, and the last one before it rested may hide until then that it moved:
// such a proof begins anew, once.
inline int proofs_of_rest(const BrakedClass& axes) { return axes.encoder_noise_m > 0 ? 2 : 1; }

class KickTime {
 public:
  template <class Real>
  KickTime(const BrakedClass& axes, const law::BrakedKicks<Real>& kicks)
      : axes_{axes},
        brake_N_{static_cast<double>(kicks.brake_N)},
        preload_N_{static_cast<double>(kicks.preload_N)},
        resting_N_{static_cast<double>(kicks.resting_force_N)},
        holding_N_{static_cast<double>(kicks.holding_force_N)},
        fast_{static_cast<double>(kicks.fast_lag)},
        slow_{static_cast<double>(kicks.slow_lag)},
        coast_per_N_{static_cast<double>(kicks.coast_per_N)},
        still_{kicks.still_periods},
        either_way_{kicks.either_way_periods},
        patient_{kicks.patient_periods},
        settling_{kicks.settling_periods},
        choice_periods_{kicks.fine_floor_m > 0 ? 1 : 0},
        preload_periods_{preload_periods()} {}

  double periods(double force_N, int pulse_periods, int cut_periods, double cut_N) const {
    const int latency = axes_.latency_periods;
    const double given = preload_periods_ + pulse_periods;
    const double calm = cut_periods + periods_to_calm(force_N, pulse_periods, cut_periods, cut_N);
    const int proofs = proofs_of_rest(axes_);
    const double braking =
        std::max(calm, stop_periods(force_N, pulse_periods)) + proofs * still_ + latency + 2 + choice_periods_;
    // An axis that rests later than the controller waits for has its brake taken off, and the longer proof begins.
    const double waited = force_N * coast_per_N_ * pulse_periods + still_ + settling_ + latency + 3;
    return given + braking + (braking - cut_periods > waited ? proofs * either_way_ + latency + 2 : 0);
  }

 private:
  double preload_periods() const {
    if (!(slow_ > 0)) return 0;
    law::ForceInterval<double> force{-std::max(holding_N_, brake_N_), std::max(holding_N_, brake_N_)};
    const double most_N = brake_N_ + (holding_N_ - brake_N_) / 512;
    int periods = 0;
    for (; periods < patient_ + settling_ && (force.lower_N < preload_N_ || force.upper_N > most_N); ++periods) {
      // From a force that may be above the brake's the controller commands the brake's.
      force.follow(brake_N_, fast_, slow_);
    }
    return periods + 1;
  }

  // Of brake, until the force is sure to let an axis that is seen still rest.
  double periods_to_calm(double force_N, int pulse_periods, int cut_periods, double cut_N) const {
    if (!(slow_ > 0)) return 0;
    law::ForceInterval<double> force{std::min(preload_N_, brake_N_), std::max(holding_N_, brake_N_)};
    for (int i = 0; i < pulse_periods; ++i) force.follow(force_N, fast_, slow_);
    for (int i = 0; i < cut_periods; ++i) force.follow(-cut_N, fast_, slow_);
    int periods = 0;
    for (; periods < patient_ && (force.upper_N > resting_N_ || force.lower_N < -holding_N_); ++periods)
      force.follow(-brake_N_, fast_, slow_);
    return periods;
  }

  // From the end of the pulse to the first sample of the axis at rest.
  double stop_periods(double force_N, int pulse_periods) const {
    const double gain = axes_.force_gain.most, T = axes_.period_s;
    const double impulse_Ns = force_N * (pulse_periods * T + axes_.jitter_s) + 2 * brake_N_ * axes_.lag_s.most;
    const double rest_N = axes_.friction.lower_N - axes_.load_N + gain * brake_N_;
    return std::ceil((gain * impulse_Ns / rest_N + 2 * axes_.jitter_s) / T);
  }

  const BrakedClass& axes_;
  double brake_N_, preload_N_, resting_N_, holding_N_, fast_, slow_, coast_per_N_;
  int still_, either_way_, patient_, settling_;
  int choice_periods_;  // until a fine stage chooses the next kick
  double preload_periods_;
};

}  // namespace breakaway::design::detail
