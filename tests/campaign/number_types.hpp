// The two number types of the reference computation, and what counts as rounding in each.
#pragma once

#include <cfloat>
#include <cstddef>

namespace breakaway::campaign {

// Numbers of 113 bits, which software computes on most processors; and the widest that the processor itself has, some
// forty times faster: 64 bits on x86.
#if LDBL_MANT_DIG >= 113
using Quad = long double;
using Fast = double;
#else
using Quad = __float128;
using Fast = long double;
#endif

template <class Real>
struct Rounding;

template <>
struct Rounding<Quad> {
  static constexpr double unit = 1e-33;     // some units in the last place
  static constexpr double noise = 1e-25;    // of a quantity's scale: zero to rounding
  static constexpr std::size_t terms = 15;  // of the Taylor series: (1/256)^15 / 15! is 1e-48
};

template <>
struct Rounding<Fast> {
  static constexpr double unit = LDBL_MANT_DIG >= 113 ? 1e-15 : 5e-19;
  static constexpr double noise = LDBL_MANT_DIG >= 113 ? 1e-13 : 1e-16;
  static constexpr std::size_t terms = 8;  // (1/256)^8 / 8! is 1e-24
};

}  // namespace breakaway::campaign
