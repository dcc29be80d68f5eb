// NodeLaws: the laws of a node's axes, made from what is flashed. A loop takes a copy of each, so that what they share
// stands here.
#pragma once

#include <cstddef>

#include "breakaway/firmware/flashed_machine.hpp"
#include "breakaway/firmware/flashed_node.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/law/coordinated_axis.hpp"

namespace breakaway::firmware {

// Node: a FlashedNode or a FlashedMachine, which must outlive its laws; and they the loop that they are added to.
template <class Node>
class NodeLaws;

// Each axis has a law of its own.
template <class Real, std::size_t Axes, class Kicks>
class NodeLaws<FlashedNode<Real, Axes, Kicks>> {
 public:
  using Scalar = Real;
  using Law = law::AxisController<Scalar, Kicks>;

  explicit NodeLaws(const FlashedNode<Scalar, Axes, Kicks>& node) noexcept : node_{&node} {}

  Law law_of(std::size_t axis) noexcept {
    const FlashedAxis<Scalar, Kicks>& flashed = node_->axes[axis];
    return {flashed.law, flashed.k3_table, flashed.kicks};
  }

 private:
  const FlashedNode<Scalar, Axes, Kicks>* node_;
};

// One coordinator moves all axes.
template <class Real, std::size_t Axes>
class NodeLaws<FlashedMachine<Real, Axes>> {
 public:
  using Scalar = Real;
  using Law = law::CoordinatedAxis<Scalar, Axes>;

  explicit NodeLaws(const FlashedMachine<Scalar, Axes>& machine) noexcept : coordinator_{machine.coordinator} {}
  NodeLaws(const NodeLaws&) = delete;
  NodeLaws& operator=(const NodeLaws&) = delete;

  Law law_of(std::size_t axis) noexcept { return {coordinator_, axis}; }
  const typename Law::Coordinator& coordinator() const noexcept { return coordinator_; }

 private:
  typename Law::Coordinator coordinator_;
};

// Puts the axes of a node that verify() has found to be good into a loop with room for them.
template <class Loop, class Node>
[[gnu::cold]] void add_axes(Loop& loop, const Node& node, NodeLaws<Node>& laws) noexcept {
  for (std::size_t i = 0; i < node.count; ++i)
    static_cast<void>(loop.add_axis(node.axes[i].drive, laws.law_of(i), node.axes[i].limits));
}

// The same where the laws share nothing. The node must outlive the loop.
template <class Loop, class Scalar, std::size_t Axes, class Kicks>
[[gnu::cold]] void add_axes(Loop& loop, const FlashedNode<Scalar, Axes, Kicks>& node) noexcept {
  NodeLaws<FlashedNode<Scalar, Axes, Kicks>> laws{node};
  add_axes(loop, node, laws);
}

}  // namespace breakaway::firmware
