#include "breakaway/hybrid/stop_problem.hpp"

#include <cmath>

#include "breakaway/hybrid/lcp.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::hybrid {

using Eigen::Index;

DirectionVector sliding_after_stop(const StopProblem& problem) {
  const Index count = problem.acceleration.size();
  LcpMatrix a = LcpMatrix::Zero(2 * count, 2 * count);
  LcpVector b(2 * count);
  DirectionVector scale = DirectionVector::Zero(count);
  for (Index i = 0; i < count; ++i) {
    const double weight = 1 / (problem.coupling(i, i) * problem.forward_N[i]);
    b[i] = weight * problem.acceleration[i];
    for (Index j = 0; j < count; ++j) {
      a(i, j) = weight * problem.coupling(i, j) * problem.forward_N[j];
      b[i] -= a(i, j);
      scale[i] += std::abs(a(i, j));
    }
    scale[i] += std::abs(b[i]);
    a(i, count + i) = 1;
    a(count + i, i) = -1;
    b[count + i] = 1 + problem.backward_N[i] / problem.forward_N[i];
  }
  const auto z = solve_lcp(a, b);
  if (!z) throw InputError{"the friction forces at a stop could not be found: directions and mass are too ill-scaled"};
  DirectionVector signs(count);
  for (Index i = 0; i < count; ++i) {
    double slide = b[i];
    for (Index j = 0; j < count; ++j) slide += a(i, j) * (*z)[j];
    signs[i] = std::abs(slide) <= significance * scale[i] ? 0 : slide > 0 ? 1 : -1;
  }
  return signs;
}

}  // namespace breakaway::hybrid
