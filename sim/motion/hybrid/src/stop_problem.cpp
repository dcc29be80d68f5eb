#include "breakaway/hybrid/stop_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "breakaway/hybrid/lcp.hpp"
#include "breakaway/motion/tie.hpp"

namespace breakaway::hybrid {
namespace {

using Eigen::Index;

template <class Scalar>
std::optional<LcpSolution<Scalar>> solve_by_lemke(const StopProblem<Scalar>& problem) {
  const Index count = problem.acceleration.size();
  LcpMatrix<Scalar> a = LcpMatrix<Scalar>::Zero(2 * count, 2 * count);
  LcpVector<Scalar> b(2 * count);
  for (Index i = 0; i < count; ++i) {
    const Scalar weight = 1 / (problem.coupling(i, i) * problem.forward_N[i]);
    b[i] = weight * problem.acceleration[i];
    for (Index j = 0; j < count; ++j) {
      a(i, j) = weight * problem.coupling(i, j) * problem.forward_N[j];
      b[i] -= a(i, j);
    }
    a(i, count + i) = 1;
    a(count + i, i) = -1;
    b[count + i] = 1 + problem.backward_N[i] / problem.forward_N[i];
  }
  return solve_lcp(a, b);
}

// A solution: what sticks, what slides, and the friction forces with bounds of their rounding.
template <class Scalar>
class Checked {
 public:
  Checked(const StopProblem<Scalar>& problem, std::uint32_t basic)
      : problem_{problem},
        count_{problem.acceleration.size()},
        force_N_{Directional<Scalar>::Zero(count_)},
        error_N_{Directional<Scalar>::Zero(count_)} {
    for (Index i = 0; i < count_; ++i) {
      const bool bears = (basic >> i & 1U) != 0, slides_back = (basic >> (count_ + i) & 1U) != 0;
      if (bears && !slides_back) {
        stuck_[static_cast<std::size_t>(stuck_count_++)] = i;
      } else {
        force_N_[i] = bears ? problem.backward_N[i] : -problem.forward_N[i];
      }
    }
  }

  std::optional<Sliding> sliding() {
    if (!solve_for_stuck() || !bears()) return std::nullopt;
    Sliding result{DirectionVector::Zero(count_), force_N_.template cast<double>(), 0};
    for (Index i = 0; i < count_; ++i) {
      if (sticks(i)) continue;
      const Scalar gamma = acceleration(i), error = acceleration_error(i), size = acceleration_size(i);
      if (!(std::abs(gamma) > error + problem_.rounding[i])) {
        if (!(error <= doubt * size)) return std::nullopt;
        result.ties |= only(i);
      }
      if (std::abs(gamma) <= error) continue;
      if ((gamma > 0) != (force_N_[i] < 0)) return std::nullopt;
      result.signs[i] = gamma > 0 ? 1 : -1;
    }
    return result;
  }

 private:
  using Pairs = DirectionalPairs<Scalar>;
  static constexpr Scalar epsilon = std::numeric_limits<Scalar>::epsilon();

  Index stuck(Index r) const { return stuck_[static_cast<std::size_t>(r)]; }
  bool sticks(Index i) const {
    return std::find(stuck_.begin(), stuck_.begin() + stuck_count_, i) != stuck_.begin() + stuck_count_;
  }

  Scalar acceleration(Index i) const {
    Scalar sum = problem_.acceleration[i];
    for (Index j = 0; j < count_; ++j) sum += problem_.coupling(i, j) * force_N_[j];
    return sum;
  }
  Scalar acceleration_size(Index i) const {
    Scalar size = std::abs(problem_.acceleration[i]);
    for (Index j = 0; j < count_; ++j) size += std::abs(problem_.coupling(i, j) * force_N_[j]);
    return size;
  }
  // The rounding of the sum and of its terms.
  Scalar acceleration_error(Index i) const {
    Scalar error = static_cast<Scalar>(count_ + 4) * epsilon * acceleration_size(i);
    for (Index j = 0; j < count_; ++j) error += std::abs(problem_.coupling(i, j)) * error_N_[j];
    return error;
  }

  // The forces that hold what sticks, with one step of refinement.
  bool solve_for_stuck() {
    if (stuck_count_ == 0) return true;
    Pairs inverse;
    if (!invert(inverse)) return false;
    for (int pass = 0; pass < 2; ++pass) {
      Directional<Scalar> left(stuck_count_);
      for (Index r = 0; r < stuck_count_; ++r) left[r] = acceleration(stuck(r));
      for (Index r = 0; r < stuck_count_; ++r) {
        for (Index c = 0; c < stuck_count_; ++c) force_N_[stuck(r)] -= inverse(r, c) * left[c];
      }
    }
    Directional<Scalar> left(stuck_count_);
    for (Index c = 0; c < stuck_count_; ++c) left[c] = std::abs(acceleration(stuck(c))) + acceleration_error(stuck(c));
    for (Index r = 0; r < stuck_count_; ++r) {
      Scalar error = 0;
      for (Index c = 0; c < stuck_count_; ++c) error += std::abs(inverse(r, c)) * left[c];
      error_N_[stuck(r)] = error;
    }
    return true;
  }

  // Gauss and Jordan's method: the matrix is positive definite, and needs no exchange of rows.
  bool invert(Pairs& inverse) const {
    const Index size = stuck_count_;
    inverse.resize(size, size);
    for (Index r = 0; r < size; ++r) {
      for (Index c = 0; c < size; ++c) inverse(r, c) = problem_.coupling(stuck(r), stuck(c));
    }
    for (Index k = 0; k < size; ++k) {
      const Scalar pivot = inverse(k, k);
      if (!(pivot > 16 * epsilon * problem_.coupling(stuck(k), stuck(k)))) return false;
      inverse(k, k) = 1;
      for (Index c = 0; c < size; ++c) inverse(k, c) /= pivot;
      for (Index r = 0; r < size; ++r) {
        if (r == k) continue;
        const Scalar factor = std::exchange(inverse(r, k), Scalar{0});
        for (Index c = 0; c < size; ++c) inverse(r, c) -= factor * inverse(k, c);
      }
    }
    return true;
  }

  // Says whether the forces on what sticks are known, and within its limits.
  bool bears() const {
    for (Index r = 0; r < stuck_count_; ++r) {
      const Index i = stuck(r);
      const Scalar error_N = error_N_[i] + static_cast<Scalar>(motion::tie) * std::abs(force_N_[i]);
      if (!(force_N_[i] <= problem_.backward_N[i] + error_N) || !(force_N_[i] >= -problem_.forward_N[i] - error_N)) {
        return false;
      }
      if (!(error_N_[i] <= doubt * (problem_.backward_N[i] + problem_.forward_N[i]))) return false;
    }
    return true;
  }

  // The greatest error of a force that is said to be within its limits, as a share of them, and of an acceleration that
  // is said to be zero, as a share of its terms.
  static constexpr Scalar doubt = Scalar{1} / (1 << 20);

  const StopProblem<Scalar>& problem_;
  Index count_;
  std::array<Index, most_directions> stuck_{};
  Index stuck_count_ = 0;
  Directional<Scalar> force_N_, error_N_;
};

}  // namespace

template <class Scalar>
std::optional<Sliding> sliding_after_stop(const StopProblem<Scalar>& problem) {
  const auto solution = solve_by_lemke(problem);
  if (!solution) return std::nullopt;
  return Checked<Scalar>(problem, solution->basic).sliding();
}

template std::optional<Sliding> sliding_after_stop(const StopProblem<double>&);
template std::optional<Sliding> sliding_after_stop(const StopProblem<long double>&);

}  // namespace breakaway::hybrid
