// A machine of up to four axes that push each other, with friction that may be anything between its bounds at any time:
// a plain time-stepping plant of its own, to hold theorems against.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace breakaway::campaign {

constexpr std::size_t most_axes = 4;
using Forces = std::array<double, most_axes>;
using Square = std::array<Forces, most_axes>;

// M(q) = mass + sum_c q_c slope[c], each slope symmetric: Coriolis forces follow from it.
struct CoupledTruth {
  std::size_t axes = 0;
  Square mass{}, damping{}, stiffness{};
  std::array<Square, most_axes> slope{};
  bool curved = false;
  Forces load_N{};
  double lag_s = 0;
};

// Moreau's time stepping, with the friction of each step solved by projected Gauss-Seidel sweeps. Positions follow the
// mean of the speeds at both ends, which is exact under constant acceleration.
class CoupledPlant {
 public:
  explicit CoupledPlant(const CoupledTruth& truth) : t_{truth} { invert(); }

  Forces q{}, v{};
  Forces command_N{};   // what the drives are told
  Forces friction_N{};  // how much each axis has, now

  const Forces& force_N() const { return force_; }

  void step(double h) {
    follow_commands(h);
    if (t_.curved) invert();
    Forces pushed = pushed_N();
    if (held(pushed)) return;
    solve(pushed, h);
  }

 private:
  void follow_commands(double h) {
    const double share = t_.lag_s > 0 ? -std::expm1(-h / t_.lag_s) : 1;
    for (std::size_t i = 0; i < t_.axes; ++i) force_[i] += share * (command_N[i] - force_[i]);
  }

  Forces pushed_N() const {
    Forces f{};
    for (std::size_t i = 0; i < t_.axes; ++i) {
      f[i] = force_[i] + t_.load_N[i];
      for (std::size_t j = 0; j < t_.axes; ++j) f[i] -= t_.damping[i][j] * v[j] + t_.stiffness[i][j] * q[j];
    }
    if (t_.curved) add_coriolis(f);
    return f;
  }

  // c_a = sum_bc (dM_ab/dq_c - dM_bc/dq_a / 2) v_b v_c.
  void add_coriolis(Forces& f) const {
    for (std::size_t a = 0; a < t_.axes; ++a) {
      for (std::size_t b = 0; b < t_.axes; ++b) {
        for (std::size_t c = 0; c < t_.axes; ++c) f[a] -= (t_.slope[c][a][b] - t_.slope[a][b][c] / 2) * v[b] * v[c];
      }
    }
  }

  bool held(const Forces& pushed) const {
    for (std::size_t i = 0; i < t_.axes; ++i) {
      if (v[i] != 0 || std::abs(pushed[i]) > friction_N[i]) return false;
    }
    return true;
  }

  void solve(const Forces& pushed, double h) {
    Forces end = v;
    for (std::size_t i = 0; i < t_.axes; ++i) {
      for (std::size_t j = 0; j < t_.axes; ++j) end[i] += inverse_[i][j] * (h * pushed[j] + impulse_[j]);
    }
    bool changed = true;
    for (int sweep = 0; sweep < 500 && changed; ++sweep) changed = this->sweep(end, h);
    for (std::size_t i = 0; i < t_.axes; ++i) {
      // What friction holds has no speed, not even one of rounding.
      if (std::abs(impulse_[i]) < h * friction_N[i]) end[i] = 0;
      q[i] += h * (v[i] + end[i]) / 2;
      v[i] = end[i];
    }
  }

  bool sweep(Forces& end, double h) {
    bool changed = false;
    for (std::size_t i = 0; i < t_.axes; ++i) {
      const double most = h * friction_N[i];
      const double next = std::clamp(impulse_[i] - end[i] / inverse_[i][i], -most, most);
      const double more = next - impulse_[i];
      if (std::abs(more) > 1e-13 * most) changed = true;
      impulse_[i] = next;
      for (std::size_t j = 0; j < t_.axes; ++j) end[j] += inverse_[j][i] * more;
    }
    return changed;
  }

  // Gauss and Jordan, without pivots: M is positive definite.
  void invert() {
    const std::size_t n = t_.axes;
    Square m = t_.mass, x{};
    for (std::size_t c = 0; t_.curved && c < n; ++c) {
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) m[i][j] += q[c] * t_.slope[c][i][j];
      }
    }
    for (std::size_t i = 0; i < n; ++i) x[i][i] = 1;
    for (std::size_t k = 0; k < n; ++k) {
      const double pivot = 1 / m[k][k];
      for (std::size_t j = 0; j < n; ++j) m[k][j] *= pivot, x[k][j] *= pivot;
      for (std::size_t i = 0; i < n; ++i) {
        if (i == k) continue;
        const double factor = m[i][k];
        for (std::size_t j = 0; j < n; ++j) m[i][j] -= factor * m[k][j], x[i][j] -= factor * x[k][j];
      }
    }
    inverse_ = x;
  }

  CoupledTruth t_;
  Forces force_{}, impulse_{};
  Square inverse_{};
};

}  // namespace breakaway::campaign
