// The tie: a push that equals what static friction can bear, to rounding.
#pragma once

namespace breakaway::motion {

// Static friction gives way a little above its limit. At the limit itself a push that equals it to rounding would let
// the axis stick and slip for ever; so every limit is widened by this share of itself.
inline constexpr double tie = 1e-12;

constexpr double widened(double limit) { return limit * (1 + tie); }

}  // namespace breakaway::motion
