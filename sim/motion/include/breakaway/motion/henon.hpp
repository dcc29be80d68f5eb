// Event location by exchange of the independent variable (Henon 1982): to reach y[e] = target exactly, integrate with
// y[e] as the independent variable. No root finding, no interpolation; the event's accuracy is the integrator's own.
#pragma once

#include <cstddef>

#include "breakaway/motion/gragg_bulirsch_stoer.hpp"

namespace breakaway::motion {

// The right-hand side after component E has changed places with t: z = y but for z[E] = t, as a function of s = y[E].
// Valid while the derivative of y[E] does not vanish.
template <std::size_t N, std::size_t E, class RightHandSide>
class Exchanged {
  static_assert(E < N);

 public:
  explicit Exchanged(RightHandSide& slope) : slope_(slope) {}

  void operator()(double s, const Vector<N>& z, Vector<N>& derivative) const {
    Vector<N> y = z;
    y[E] = s;
    slope_(z[E], y, derivative);
    const double rate = derivative[E];
    for (double& component : derivative) component /= rate;
    derivative[E] = 1 / rate;
  }

 private:
  RightHandSide& slope_;
};

}  // namespace breakaway::motion
