// FlashedMachine: a FlashedNode whose axes push each other. One coordinator moves them all, with the numbers of one
// certificate.
//
// Its axes move together or not at all. A fault of one of them stops the others in the same period, each with the fault
// "stopped with another axis": the node is refused unless its fault_scope is all_axes. An axis that is stopped as asked
// leaves the others without force from the next period on, until all run again (law/kick_coordinator.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/fault_scope.hpp"
#include "breakaway/firmware/flashed_node.hpp"
#include "breakaway/law/coordinator_parameters.hpp"

namespace breakaway::firmware {

// What its coordinator knows of an axis stands there.
template <class Scalar>
struct FlashedMachineAxis {
  AxisName name{};
  cia402::DriveConfig<Scalar> drive{};
  AxisLimits<Scalar> limits{};
};

// There is room for `Axes` axes, 1..8, and the first `count` of them are there.
template <class Scalar, std::size_t Axes>
struct FlashedMachine {
  LoopConfig loop{};
  Wiring wiring{};
  std::uint8_t count = Axes;
  std::array<FlashedMachineAxis<Scalar>, Axes> axes{};
  law::CoordinatorParameters<Scalar, Axes> coordinator{};  // of as many axes
  bool certified = false;                                  // by breakaway design, with these very numbers
  std::uint32_t checksum{};                                // checksum_of(), made by the generator

  static constexpr std::size_t capacity = Axes;

  constexpr hal::AxisScale<Scalar> scale(std::size_t axis) const noexcept {
    return {coordinator.axes[axis].resolution_m, coordinator.axes[axis].max_force_N};
  }
};

namespace internal {

template <class Axis, class Visitor>
constexpr void visit_coordinated_axis(Axis& axis, std::size_t count, Visitor& visit) {
  visit.value("position_gain_N_per_m", axis.position_gain_N_per_m, "N/m, P");
  visit.value("velocity_gain_Ns_per_m", axis.velocity_gain_Ns_per_m, "N s/m, D");
  visit.value("mass_kg", axis.mass_kg, "kg");
  visit.value("lower_N", axis.lower_N, "N, A");
  visit.value("upper_N", axis.upper_N, "N, B");
  visit.value("sure_N", axis.sure_N, "N");
  visit.value("brake_N", axis.brake_N, "N, b");
  visit.value("kick_N", axis.kick_N, "N");
  visit.value("max_force_N", axis.max_force_N, "N");
  visit.value("gate_m", axis.gate_m, "m");
  visit.value("tolerance_m", axis.tolerance_m, "m");
  visit.value("resolution_m", axis.resolution_m, "m, one count");
  visit.row("hold_off", std::span{axis.hold_off}.first(std::min(count, axis.hold_off.size())));
}

template <class Coordinator, class Visitor>
constexpr void visit_coordinator(Coordinator& coordinator, Visitor& visit) {
  visit.value("period_s", coordinator.period_s, "s");
  visit.value("count", coordinator.count, "");
  visit.value("settling_periods", coordinator.settling_periods, "");
  visit.value("still_periods", coordinator.still_periods, "");
  visit.value("release_periods", coordinator.release_periods, "");
  visit.value("most_kicks", coordinator.most_kicks, "");
  const std::size_t count = std::min<std::size_t>(coordinator.count, coordinator.axes.size());
  visit.list("axes", std::span{coordinator.axes}.first(count),
             [&](auto& axis) { visit_coordinated_axis(axis, count, visit); });
}

}  // namespace internal

// As of a FlashedNode.
template <class Machine, class Visitor>
requires requires(Machine& machine) { machine.coordinator; }
[[gnu::cold]] constexpr void visit_numbers(Machine& machine, Visitor& visit) {
  visit.group("loop", [&] { internal::visit_loop(machine.loop, visit); });
  visit.group("wiring", [&] { internal::visit_wiring(machine.wiring, visit); });
  visit.value("count", machine.count, "");
  visit.list("axes", present_axes(machine), [&](auto& axis) {
    visit.value("name", axis.name, "");
    visit.group("drive", [&] { internal::visit_drive(axis.drive, visit); });
    visit.group("limits", [&] { internal::visit_limits(axis.limits, visit); });
  });
  visit.group("coordinator", [&] { internal::visit_coordinator(machine.coordinator, visit); });
  visit.value("certified", machine.certified, "");
}

template <class Scalar, std::size_t Axes>
[[gnu::cold]] constexpr std::uint32_t checksum_of(const FlashedMachine<Scalar, Axes>& machine) noexcept {
  internal::ChecksumVisitor visit;
  visit_numbers(machine, visit);
  return visit.crc.value();
}

namespace internal {

template <class Scalar, std::size_t Axes>
constexpr NodeError check_axis(const FlashedMachine<Scalar, Axes>& machine, std::uint8_t i) noexcept {
  const FlashedMachineAxis<Scalar>& axis = machine.axes[i];
  const auto& law = machine.coordinator.axes[i];
  if (const NodeError error = check_drive(axis.drive, machine.loop, machine.scale(i)); error != NodeError::none)
    return error;
  const AxisLimits<Scalar>& l = axis.limits;
  const bool wide = l.force_N >= law.max_force_N && l.following_error_m >= law.tolerance_m &&
                    l.position_min_m < l.position_max_m && l.speed_m_s > 0;
  return wide ? check_against_others(machine, i) : NodeError::limits_below_law;
}

}  // namespace internal

// A controller asks this before it moves anything. The comparisons are written so that a NaN is refused.
template <class Scalar, std::size_t Axes>
[[gnu::cold]] constexpr NodeVerdict verify(const FlashedMachine<Scalar, Axes>& machine) noexcept {
  if (checksum_of(machine) != machine.checksum) return {NodeError::checksum_differs};
  if (machine.count < 1 || machine.count > Axes || machine.coordinator.count != machine.count)
    return {NodeError::count_impossible};
  if (!law::are_usable(machine.coordinator)) return {NodeError::law_invalid};
  if (!machine.certified) return {NodeError::not_certified};
  if (!internal::is_period_of(machine.coordinator.period_s, machine.loop)) return {NodeError::period_differs};
  if (machine.loop.fault_scope != FaultScope::all_axes) return {NodeError::axes_stop_apart};
  for (std::uint8_t i = 0; i < machine.count; ++i) {
    if (const NodeError error = internal::check_axis(machine, i); error != NodeError::none) return {error, i};
  }
  return {internal::check_surroundings(machine)};
}

}  // namespace breakaway::firmware
