// K3Table: the impulse law k3 as data, for the control loop.
//
// Source: van de Wouw & Leine, "Impulsive Control of Mechanical Motion Systems with Uncertain Friction", (10)-(15) and
// Proposition 1. k3(y) starts with infinite slope at y = 0, so it is not tabulated itself: R = |k3| / sqrt|y| is an
// analytic function of s = sqrt|y| that tends to m sqrt(2 f_lo / m) at rest on the target. A piecewise cubic in s is
// therefore as accurate in the last micrometre as far out.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace breakaway::law {

// Made by design::build_k3_table; a default-constructed table answers zero to every question.
//
// 267 nodes of float are the most that fit in 2150 bytes; they keep the proved error below 4e-7 for zeta <= 10 and
// f_lower / f_upper >= 0.1.
//
// Nothing here can fail, and no argument, not even a damaged table, leads to a read outside `nodes`.
template <class Scalar, std::size_t Nodes = 267>
struct K3Table {
  static_assert(Nodes >= 2, "a table needs at least one interval");

  struct Node {
    Scalar value;  // R at the node [N s / sqrt(m)]
    Scalar slope;  // dR/ds at the node times the distance between nodes [N s / sqrt(m)]
  };

  Scalar root_max{};                // sqrt of the largest position error covered [sqrt(m)]
  Scalar nodes_per_root{};          // (Nodes - 1) / root_max [1 / sqrt(m)]
  std::array<Node, Nodes> nodes{};  // node i stands at s = i / nodes_per_root

  // R(s) = |k3| / s [N s / sqrt(m)] at root s = sqrt|position error| [sqrt(m)], by cubic Hermite interpolation. `root`
  // is clamped to [0, root_max]; NaN counts as zero.
  Scalar reduced(Scalar root) const noexcept { return interpolated(clamped(root, root_max)); }

  // k3(y) [N s] for the position error y = position - target [m]: opposite in sign to y, and odd. Beyond the table the
  // answer stays at its end value: a kick that stops short is safe, one for an untested distance is not. NaN gives
  // zero.
  Scalar impulse_Ns(Scalar position_error_m) const noexcept {
    // std::sqrt is one hardware instruction; the branch to libm for negative arguments is never taken.
    const Scalar root = clamped(std::sqrt(std::fabs(position_error_m)), root_max);
    const Scalar size = root * interpolated(root);
    return position_error_m > 0 ? -size : size;
  }

 private:
  Scalar interpolated(Scalar root) const noexcept {
    constexpr auto last = static_cast<Scalar>(Nodes - 1);
    const Scalar place = clamped(root * nodes_per_root, last);
    auto index = static_cast<std::int32_t>(place);
    if (index > static_cast<std::int32_t>(Nodes) - 2) index = static_cast<std::int32_t>(Nodes) - 2;
    const Node& left = nodes[static_cast<std::size_t>(index)];
    const Node& right = nodes[static_cast<std::size_t>(index) + 1];
    const Scalar t = place - static_cast<Scalar>(index);
    const Scalar rise = right.value - left.value;
    // The value at the node is added last: the terms before it are small, so their rounding does not show.
    const Scalar cubic = left.slope + right.slope - (rise + rise);
    const Scalar square = (rise - left.slope) - cubic;
    return left.value + t * (left.slope + t * (square + t * cubic));
  }

  // Returns x within [0, most], and zero when x is NaN.
  static constexpr Scalar clamped(Scalar x, Scalar most) noexcept {
    if (!(x > 0)) return 0;
    return x < most ? x : most;
  }
};

}  // namespace breakaway::law
