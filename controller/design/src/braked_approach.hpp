// How an axis is brought near its target before the first kick.
#pragma once

#include "kick_class.hpp"

namespace breakaway::design::detail {

// Within the limits of a move, where the class has one that it can keep.
template <class Real>
law::BrakedApproach<Real> braked_approach(const BrakedClass& axes, const KickClass& kicks);

}  // namespace breakaway::design::detail
