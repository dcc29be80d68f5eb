// FlashedNode: a whole controller node as `breakaway design --header` writes it and a controller starts from it: loop,
// and for each axis drive, limits, law and table, under one checksum.
//
// An image and the Linux node start from nothing else. What contradicts itself stops the compiler: the generated header
// asserts verify(), which is constexpr. What was damaged or edited afterwards stops the start.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/crc32.hpp"
#include "breakaway/firmware/loop_config.hpp"
#include "breakaway/firmware/node_numbers.hpp"
#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/firmware/wiring.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/braked_kicks.hpp"
#include "breakaway/law/k3_table.hpp"
#include "breakaway/law/work_kicks.hpp"

namespace breakaway::firmware {

// This many characters are in an axis' name at most.
inline constexpr std::size_t longest_axis_name = 23;

// Holds the name as text with a zero behind it.
struct AxisName {
  std::array<char, longest_axis_name + 1> characters{};

  constexpr std::string_view view() const noexcept {
    std::size_t length = 0;
    while (length < longest_axis_name && characters[length] != '\0') ++length;
    return {characters.data(), length};
  }
};

// Kicks: law::BrakedKicks, or law::WorkKicks for the coast "work".
template <class Scalar, class Kicks = law::BrakedKicks<Scalar>>
struct FlashedAxis {
  AxisName name{};
  cia402::DriveConfig<Scalar> drive{};
  AxisLimits<Scalar> limits{};
  law::AxisParameters<Scalar> law{};
  law::K3Table<Scalar> k3_table{};  // built for `law`
  Kicks kicks{};                    // not of the coast "pd"
  bool certified = false;           // by breakaway design, with these very numbers

  constexpr hal::AxisScale<Scalar> scale() const noexcept { return {law.encoder_resolution_m, law.total_force_N()}; }
};

// There is room for `Axes` axes, 1..8, and the first `count` of them are there.
// All of them give one kind of kicks.
template <class Scalar, std::size_t Axes, class Kicks = law::BrakedKicks<Scalar>>
struct FlashedNode {
  LoopConfig loop{};
  Wiring wiring{};
  std::uint8_t count = Axes;
  std::array<FlashedAxis<Scalar, Kicks>, Axes> axes{};
  std::uint32_t checksum{};  // checksum_of(), made by the generator

  static constexpr std::size_t capacity = Axes;
};

// Returns the axes that are there.
template <class Node>
constexpr auto present_axes(Node& node) noexcept {
  return std::span{node.axes}.first(node.count < Node::capacity ? node.count : Node::capacity);
}

namespace internal {

struct ChecksumVisitor {
  Crc32 crc;

  template <class T>
  constexpr void value(const char*, const T& number, const char*) noexcept {
    crc.add_bits_of(number);
  }
  constexpr void value(const char*, const AxisName& name, const char*) noexcept {
    for (const char c : name.characters) crc.add_bits_of(c);
  }
  constexpr void value(const char*, const hal::Duration& duration, const char*) noexcept {
    crc.add_bits_of(duration.count());
  }
  template <class Body>
  constexpr void group(const char*, const Body& body) noexcept {
    body();
  }
  template <class Items, class Body>
  constexpr void list(const char*, const Items& items, const Body& body) noexcept {
    for (const auto& item : items) body(item);
  }
  template <class Items>
  constexpr void row(const char*, const Items& items) noexcept {
    for (const auto& item : items) crc.add_bits_of(item);
  }
};

}  // namespace internal

// Counts every number of the node but the checksum itself. Of the axes it counts those that are there, because how many
// more there is room for says nothing about the node.
template <class Scalar, std::size_t Axes, class Kicks>
[[gnu::cold]] constexpr std::uint32_t checksum_of(const FlashedNode<Scalar, Axes, Kicks>& node) noexcept {
  internal::ChecksumVisitor visit;
  visit_numbers(node, visit);
  return visit.crc.value();
}

enum class NodeError : std::uint8_t {
  none,
  checksum_differs,
  count_impossible,
  not_certified,
  law_invalid,
  drive_invalid,
  period_differs,
  node_id_taken,
  name_taken,
  limits_below_law,
  bus_overloaded,
  wiring_impossible,
  axes_stop_apart,
};

constexpr std::string_view to_string(NodeError error) noexcept {
  switch (error) {
    case NodeError::none:
      return "the node is intact and certified";
    case NodeError::checksum_differs:
      return "the node is damaged or was edited by hand: generate it again with breakaway design --header";
    case NodeError::count_impossible:
      return "count is 0 or above the room for axes: generate the node again with breakaway design --header";
    case NodeError::not_certified:
      return "an axis is not certified: breakaway design says why";
    case NodeError::law_invalid:
      return "a parameter of an axis' law is out of its range: law::validate() names it";
    case NodeError::drive_invalid:
      return "a number of an axis' drive is out of its range: cia402::check() names it";
    case NodeError::period_differs:
      return "an axis' law was designed for another period than the loop's: design the axis again";
    case NodeError::node_id_taken:
      return "two drives, or a drive and the node itself, have one node id: give each its own";
    case NodeError::name_taken:
      return "two axes have one name: give each its own";
    case NodeError::limits_below_law:
      return "a limit of an axis is below what its law may use: raise the limit or lower the law's";
    case NodeError::bus_overloaded:
      return "the axes do not fit the bus at this period: canopen::bus_budget() names the least one that does";
    case NodeError::wiring_impossible:
      return "a pin or controller of [target] is none, cannot have its function, or has two: breakaway design names it";
    case NodeError::axes_stop_apart:
      return "axes that push each other must stop together: write all for fault_stops in [loop]";
  }
  return "unknown node error";
}

struct NodeVerdict {
  NodeError error = NodeError::none;
  std::uint8_t axis = 0;  // the first that is concerned, where one is

  constexpr bool ok() const noexcept { return error == NodeError::none; }
};

// Returns the period as the law counts it.
template <class Scalar>
constexpr Scalar period_s(const LoopConfig& loop) noexcept {
  return hal::seconds_as<Scalar>(loop.network.period);
}

namespace internal {

// The two periods may differ by the rounding of the scalar type.
template <class Scalar>
constexpr bool is_period_of(Scalar period_of_law_s, const LoopConfig& loop) noexcept {
  const Scalar difference_s = period_of_law_s - period_s<Scalar>(loop), most_s = Scalar(1e-6) * period_of_law_s;
  return difference_s <= most_s && -difference_s <= most_s;
}

template <class Scalar>
constexpr NodeError check_drive(const cia402::DriveConfig<Scalar>& drive, const LoopConfig& loop,
                                const hal::AxisScale<Scalar>& scale) noexcept {
  if (check(drive, loop.network, scale) == cia402::DriveConfigError::none) return NodeError::none;
  return drive.node_id == loop.network.node_id ? NodeError::node_id_taken : NodeError::drive_invalid;
}

// Those of its coast. Of the coast "pd" there is a table only.
template <class Scalar, class Kicks>
constexpr bool has_its_kicks(const FlashedAxis<Scalar, Kicks>& axis) noexcept {
  constexpr law::Coast kicked = by_work<Kicks> ? law::Coast::work : law::Coast::brake;
  if (axis.law.coast == law::Coast::pd) return axis.kicks.table.is_usable();
  return axis.law.coast == kicked && law::are_usable(axis.kicks);
}

template <class Scalar, class Kicks>
[[gnu::cold]] constexpr NodeError check_axis(const FlashedAxis<Scalar, Kicks>& axis, const LoopConfig& loop) noexcept {
  const law::AxisParameters<Scalar>& p = axis.law;
  if (validate(p) != law::ParameterError::none) return NodeError::law_invalid;
  if (!has_its_kicks(axis)) return NodeError::law_invalid;
  if (!axis.certified) return NodeError::not_certified;
  if (!is_period_of(p.period_s, loop)) return NodeError::period_differs;
  if (const NodeError error = check_drive(axis.drive, loop, axis.scale()); error != NodeError::none) return error;
  const AxisLimits<Scalar>& l = axis.limits;
  const bool wide = l.force_N >= p.total_force_N() && l.following_error_m >= p.position_tolerance_m &&
                    l.position_min_m < l.position_max_m &&
                    (p.max_approach_speed_m_s > AxisLimits<Scalar>::largest || l.speed_m_s >= p.max_approach_speed_m_s);
  return wide ? NodeError::none : NodeError::limits_below_law;
}

// An axis that is too like one before it.
template <class Node>
[[gnu::cold]] constexpr NodeError check_against_others(const Node& node, std::uint8_t i) noexcept {
  for (std::uint8_t before = 0; before < i; ++before) {
    if (node.axes[before].drive.node_id == node.axes[i].drive.node_id) return NodeError::node_id_taken;
    if (node.axes[before].name.view() == node.axes[i].name.view()) return NodeError::name_taken;
  }
  return NodeError::none;
}

// Bus and board.
template <class Node>
[[gnu::cold]] constexpr NodeError check_surroundings(const Node& node) noexcept {
  const auto& network = node.loop.network;
  if (canopen::check_bus_budget(node.count, network.period, network.bit_rate) != canopen::BusFit::fits)
    return NodeError::bus_overloaded;
  return is_possible(node.wiring) ? NodeError::none : NodeError::wiring_impossible;
}

}  // namespace internal

// A controller asks this before it moves anything. The comparisons are written so that a NaN is refused.
template <class Scalar, std::size_t Axes, class Kicks>
[[gnu::cold]] constexpr NodeVerdict verify(const FlashedNode<Scalar, Axes, Kicks>& node) noexcept {
  if (checksum_of(node) != node.checksum) return {NodeError::checksum_differs};
  if (node.count < 1 || node.count > Axes) return {NodeError::count_impossible};
  for (std::uint8_t i = 0; i < node.count; ++i) {
    const FlashedAxis<Scalar, Kicks>& axis = node.axes[i];
    if (const NodeError error = internal::check_axis(axis, node.loop); error != NodeError::none) return {error, i};
    if (const NodeError error = internal::check_against_others(node, i); error != NodeError::none) return {error, i};
  }
  return {internal::check_surroundings(node)};
}

}  // namespace breakaway::firmware
