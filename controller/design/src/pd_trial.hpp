// The coast "pd" tried in closed loop, on an axis whose friction is constant: what its approach passes its target by,
// and how many kicks follow.
//
// Of all friction within its bounds the least takes an approach furthest: at each place of the way the axis is at least
// as fast under it, because m v dv/dx = u(x, v) - f, and two ways with the same u do not cross. Of all bounds the
// greatest lets a kick lead least far. The loop is sampled and its force is late, so that both are tested, not proved.
//
// A drive that gives force in steps is off what the law asks for by up to half of one, whichever way. That acts as so
// much less friction where it pushes the axis on, and as so much more where it holds it back: the trials count with
// both.
#pragma once

#include "breakaway/design/report.hpp"
#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/k3_table.hpp"

namespace breakaway::design::detail {

// As they are flashed, under the coast "pd".
law::AxisParameters<float> parameters_of_pd(const AxisDesign& axis);

// Kicks that a certified axis is said to need, at most: four fifths of what the law gives. How many the last ones are,
// which lead less and less far, depends on where each begins.
int most_tried_kicks() noexcept;

// Of all trials of an axis together, after which they are given up.
inline constexpr long most_tried_periods = 20'000'000;

// Of an axis with a period whose other checks hold.
PdPromise try_pd(const AxisDesign& axis, const law::K3Table<float>& k3);

}  // namespace breakaway::design::detail
