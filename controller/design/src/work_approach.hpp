// The approach before the kicks of the coast "work".
#pragma once

#include "breakaway/law/shaped_move.hpp"
#include "jointed.hpp"

namespace breakaway::design::detail {

template <class Real>
law::ShapedApproach<Real> work_approach(const Jointed& axis, int swing_periods);
// By which share a swing of the joint grows in a radian of it under the feedback of this approach, at any stiffness of
// the class, which is not looked at further once it grows by more than is allowed.
template <class Real>
double worst_growth_of_swing(const Jointed& axis, const law::ShapedApproach<Real>& a);
// The greatest swing across the gap that this feedback keeps up without friction; nothing without a gap.
template <class Real>
GapSwing gap_swing(const Jointed& axis, const law::ShapedApproach<Real>& a);
// No swing grows, and friction ends those across the gap.
template <class Real>
bool ends_swings(const Jointed& axis, const law::ShapedApproach<Real>& a);
// For how long friction may hold an axis, or turn it back, that its approach leads on.
template <class Real>
double longest_stop_s(const Jointed& axis, const law::ShapedApproach<Real>& a, double max_speed_m_s);

}  // namespace breakaway::design::detail
