// The kicks of the coast "pd": which pulse ends on the target under the least friction, as a table for the loop as it
// runs.
//
// [I] asks this for an impulse and a coast whose feedback acts at once, and k3 is the answer. The loop gives a force
// for whole periods, within its limit, and its feedback (16) is sampled, late, and damps by a velocity that is taken
// from readings and filtered. Here that loop is followed from rest to rest, and the pulse is looked for that ends on
// the target. As the period tends to 0, F n T tends to k3.
#pragma once

#include <cstdint>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/kick_table.hpp"

namespace breakaway::design {

enum class PulseAim : std::uint8_t {
  target,  // that the axis ends there
  k3,      // the impulse of [I], spread over whole periods: goes too far, and is there to compare with
};

template <class Real>
struct PdKicks {
  law::KickTable<Real> table{};  // over the root of the distance: see law::PdCycle
  double aim_lost = 0;           // largest share of the distance by which a pulse aims short
  double beyond = 0;             // and beyond, where the spring alone leads there and no pulse would be right
};

// p: valid, with a period; lag_s: time constant of the current loop. Distances from what is left alone, or a 64th of
// the accuracy floor, up to where the axis may stick. Throws InputError for any other p.
template <class Real>
PdKicks<Real> design_pd_kicks(const law::AxisParameters<Real>& p, double lag_s = 0, PulseAim aim = PulseAim::target);

// How far a pulse takes an axis from rest at distance_m before its target, under the least friction until it rests
// again: force_N in all as the pulse begins, 0 < force_N, for 1 to 255 periods [m]. A force that lags counts as one
// that begins a time constant later, within a period: its impulse is the same, and so is where its middle lies.
double pd_travel_m(const law::AxisParameters<double>& p, double lag_s, double distance_m, double force_N, int periods);

}  // namespace breakaway::design
