// The numbers of a node, each named once with its unit: the checksum counts them, the generator writes them, and tests
// spoil them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace breakaway::firmware {

namespace internal {

template <class Drive, class Visitor>
[[gnu::cold]] constexpr void visit_drive(Drive& drive, Visitor& visit) {
  visit.value("node_id", drive.node_id, "");
  visit.value("force_per_torque_N_per_Nm", drive.force_per_torque_N_per_Nm, "N/(N m)");
  visit.value("rated_torque_mNm", drive.rated_torque_mNm, "mN m");
  visit.value("heartbeat_period", drive.heartbeat_period, "ns");
  visit.value("heartbeat_timeout", drive.heartbeat_timeout, "ns");
  visit.value("sdo_timeout", drive.sdo_timeout, "ns");
  visit.value("torque_base", drive.torque_base, "");
  visit.value("user_position_unit", drive.user_position_unit, "");
  visit.value("invert_direction", drive.invert_direction, "");
  visit.value("absolute_encoder", drive.absolute_encoder, "");
  visit.group("homing", [&] {
    visit.value("home", drive.homing.home, "");
    visit.value("position_counts", drive.homing.position_counts, "");
    visit.value("method", drive.homing.method, "");
    visit.value("search_counts_s", drive.homing.search_counts_s, "1/s");
    visit.value("zero_counts_s", drive.homing.zero_counts_s, "1/s");
    visit.value("acceleration_counts_s2", drive.homing.acceleration_counts_s2, "1/s^2");
    visit.value("timeout", drive.homing.timeout, "ns");
  });
  visit.group("emcy_information", [&] {
    visit.row("first", drive.emcy_information.first);
    visit.row("last", drive.emcy_information.last);
  });
}

template <class Limits, class Visitor>
[[gnu::cold]] constexpr void visit_limits(Limits& limits, Visitor& visit) {
  visit.value("position_min_m", limits.position_min_m, "m");
  visit.value("position_max_m", limits.position_max_m, "m");
  visit.value("speed_m_s", limits.speed_m_s, "m/s");
  visit.value("force_N", limits.force_N, "N");
  visit.value("following_error_m", limits.following_error_m, "m");
  visit.value("feedback_timeout", limits.feedback_timeout, "ns");
  visit.value("progress_timeout", limits.progress_timeout, "ns");
}

template <class Parameters, class Visitor>
[[gnu::cold]] constexpr void visit_law(Parameters& p, Visitor& visit) {
  visit.value("mass_kg", p.mass_kg, "kg");
  visit.value("stiffness_N_per_m", p.stiffness_N_per_m, "N/m, k1");
  visit.value("approach_damping_Ns_per_m", p.approach_damping_Ns_per_m, "N s/m, k21");
  visit.value("kick_damping_Ns_per_m", p.kick_damping_Ns_per_m, "N s/m, k22");
  visit.group("friction", [&] {
    visit.value("lower_N", p.friction.lower_N, "N");
    visit.value("upper_N", p.friction.upper_N, "N");
  });
  visit.value("max_force_N", p.max_force_N, "N");
  visit.value("max_approach_speed_m_s", p.max_approach_speed_m_s, "m/s");
  visit.value("position_tolerance_m", p.position_tolerance_m, "m");
  visit.value("encoder_resolution_m", p.encoder_resolution_m, "m, one count");
  visit.value("period_s", p.period_s, "s");
  visit.value("latency_periods", p.latency_periods, "");
  visit.value("coast", p.coast, "");
  visit.value("flicker_m", p.flicker_m, "m");
  visit.value("feedforward_N", p.feedforward_N, "N");
}

template <class Table, class Visitor>
[[gnu::cold]] constexpr void visit_table(Table& table, Visitor& visit) {
  visit.value("root_max", table.root_max, "sqrt(m)");
  visit.value("nodes_per_root", table.nodes_per_root, "1/sqrt(m)");
  visit.list("nodes", table.nodes, [&](auto& k3) {
    visit.value("value", k3.value, "");
    visit.value("slope", k3.slope, "");
  });
}

template <class Approach, class Visitor>
[[gnu::cold]] constexpr void visit_approach(Approach& approach, Visitor& visit) {
  visit.value("mass_kg", approach.mass_kg, "kg");
  visit.value("friction_N", approach.friction_N, "N");
  visit.value("hard_m_s2", approach.hard_m_s2, "m/s^2");
  visit.value("gentle_m_s2", approach.gentle_m_s2, "m/s^2");
  visit.value("switch_speed_m_s", approach.switch_speed_m_s, "m/s");
  visit.value("switch_distance_m", approach.switch_distance_m, "m");
  visit.value("short_of_target_m", approach.short_of_target_m, "m");
  visit.value("response_s", approach.response_s, "s");
  visit.value("lag_s", approach.lag_s, "s");
  visit.value("correction", approach.correction, "");
  visit.value("standing_m_s", approach.standing_m_s, "m/s");
  visit.group("move", [&] {
    visit.value("speed_m_s", approach.move.speed_m_s, "m/s");
    visit.value("acceleration_m_s2", approach.move.acceleration_m_s2, "m/s^2, 0: no limits are asked for");
    visit.value("deceleration_m_s2", approach.move.deceleration_m_s2, "m/s^2");
    visit.value("jerk_m_s3", approach.move.jerk_m_s3, "m/s^3, 0: no limit");
  });
}

// Of a table only the entries that are there.
template <class Table, class Visitor>
[[gnu::cold]] constexpr void visit_kick_table(Table& table, Visitor& visit) {
  const auto present = [&](auto& items) {
    return std::span{items}.first(std::min<std::size_t>(table.count, items.size()));
  };
  visit.list("entries", present(table.entries), [&](auto& entry) {
    visit.value("a0", entry.a0, "");
    visit.value("a1", entry.a1, "");
    visit.value("a2", entry.a2, "");
    visit.value("a3", entry.a3, "");
  });
  visit.row("periods", present(table.periods));
  visit.row("cut_periods", present(table.cut_periods));
  visit.value("first", table.first, "");
  visit.value("count", table.count, "");
  visit.value("list", table.list, "");
}

// const or not
template <class Kicks>
concept by_work = requires(Kicks& kicks) {
  kicks.metered;
};

template <class Kicks, class Visitor>
requires by_work<Kicks>
[[gnu::cold]] constexpr void visit_kicks(Kicks& kicks, Visitor& visit) {
  visit.value("force_step_N", kicks.force_step_N, "N");
  visit.value("slow_lag", kicks.slow_lag, "");
  visit.value("breakaway_N", kicks.breakaway_N, "N");
  visit.value("lost_motion_m", kicks.lost_motion_m, "m");
  visit.value("spring_m", kicks.spring_m, "m");
  visit.value("creep_m", kicks.creep_m, "m");
  visit.value("friction_per_gain_N", kicks.friction_per_gain_N, "N");
  visit.value("speeding_s_per_kg", kicks.speeding_s_per_kg, "s/kg");
  visit.value("held_back_N", kicks.held_back_N, "N");
  visit.value("late_periods", kicks.late_periods, "");
  visit.value("still_periods", kicks.still_periods, "");
  visit.value("patient_periods", kicks.patient_periods, "");
  visit.value("longest_coast_periods", kicks.longest_coast_periods, "");
  visit.value("metered", kicks.metered, "");
  visit.group("approach", [&] {
    auto& approach = kicks.approach;
    visit.value("mass_kg", approach.mass_kg, "kg");
    visit.value("friction_N", approach.friction_N, "N");
    visit.value("acceleration_m_s2", approach.acceleration_m_s2, "m/s^2");
    visit.value("stiffness_N_per_m", approach.stiffness_N_per_m, "N/m");
    visit.value("damping_Ns_per_m", approach.damping_Ns_per_m, "N s/m");
    visit.value("short_of_target_m", approach.short_of_target_m, "m");
    visit.value("begin_m", approach.begin_m, "m");
    visit.value("swing_periods", approach.swing_periods, "");
    visit.value("speed_periods", approach.speed_periods, "");
    visit.value("mean_periods", approach.mean_periods, "");
  });
  visit.group("table", [&] { visit_kick_table(kicks.table, visit); });
}

template <class Kicks, class Visitor>
[[gnu::cold]] constexpr void visit_kicks(Kicks& kicks, Visitor& visit) {
  visit.value("brake_N", kicks.brake_N, "N");
  visit.value("force_step_N", kicks.force_step_N, "N");
  visit.value("preload_N", kicks.preload_N, "N");
  visit.value("resting_force_N", kicks.resting_force_N, "N");
  visit.value("holding_force_N", kicks.holding_force_N, "N");
  visit.value("fast_lag", kicks.fast_lag, "");
  visit.value("slow_lag", kicks.slow_lag, "");
  visit.value("short_lag", kicks.short_lag, "");
  visit.value("coast_per_N", kicks.coast_per_N, "1/N");
  visit.value("breakaway_N", kicks.breakaway_N, "N");
  visit.value("lost_motion_m", kicks.lost_motion_m, "m");
  visit.value("least_seen_N", kicks.least_seen_N, "N");
  visit.value("most_seen_N", kicks.most_seen_N, "N");
  visit.value("still_periods", kicks.still_periods, "");
  visit.value("either_way_periods", kicks.either_way_periods, "");
  visit.value("patient_periods", kicks.patient_periods, "");
  visit.value("settling_periods", kicks.settling_periods, "");
  visit.value("fine_floor_m", kicks.fine_floor_m, "m, 0: no fine stage");
  visit.group("sure", [&] {
    visit.value("share", kicks.sure.share, "0: nothing is sure");
    visit.value("from_m", kicks.sure.from_m, "m");
    visit.value("most_m", kicks.sure.most_m, "m");
  });
  visit.group("spring", [&] {
    visit.value("reach_m", kicks.spring.reach_m, "m, 0: friction holds at once");
    visit.value("step_m", kicks.spring.step_m, "m");
    visit.value("most_N", kicks.spring.most_N, "N");
    visit.value("gain_N_per_m", kicks.spring.gain_N_per_m, "N/m");
    visit.value("share", kicks.spring.share, "");
    visit.value("longest_periods", kicks.spring.longest_periods, "");
    visit.value("ringing_periods", kicks.spring.ringing_periods, "");
  });
  visit.group("approach", [&] { visit_approach(kicks.approach, visit); });
  visit.group("table", [&] { visit_kick_table(kicks.table, visit); });
}

template <class Loop, class Visitor>
[[gnu::cold]] constexpr void visit_loop(Loop& loop, Visitor& visit) {
  visit.group("network", [&] {
    visit.value("period", loop.network.period, "ns");
    visit.value("bit_rate", loop.network.bit_rate, "bit/s");
    visit.value("node_id", loop.network.node_id, "of this node");
    visit.value("heartbeat_period", loop.network.heartbeat_period, "ns");
  });
  visit.value("fault_scope", loop.fault_scope, "");
  visit.value("moves_end", loop.moves_end, "");
  visit.value("command_timeout", loop.command_timeout, "ns");
}

template <class Wires, class Visitor>
[[gnu::cold]] constexpr void visit_wiring(Wires& wiring, Visitor& visit) {
  visit.value("rpu_can_controller", wiring.rpu_can_controller, "");
  visit.value("can_controller", wiring.can_controller, "");
  visit.value("can_receive", wiring.can_receive, "");
  visit.value("can_transmit", wiring.can_transmit, "");
  visit.value("can_standby", wiring.can_standby, "");
  visit.value("can_awake", wiring.can_awake, "level of can_standby");
  visit.value("serial_baud", wiring.serial_baud, "Bd");
  visit.value("serial_receive", wiring.serial_receive, "");
  visit.value("serial_transmit", wiring.serial_transmit, "");
}

}  // namespace internal

// Visits the numbers of a node, one line each. They are counted into the checksum, written into the header and spoiled
// in the tests. `visit` has value(name, value, unit) for a number, group(name, body) for a struct, list(name, items,
// body) for an array of structs and row(name, items) for one of numbers. Node: a FlashedNode, or a const one.
template <class Node, class Visitor>
[[gnu::cold]] constexpr void visit_numbers(Node& node, Visitor& visit) {
  visit.group("loop", [&] { internal::visit_loop(node.loop, visit); });
  visit.group("wiring", [&] { internal::visit_wiring(node.wiring, visit); });
  visit.value("count", node.count, "");
  visit.list("axes", present_axes(node), [&](auto& axis) {
    visit.value("name", axis.name, "");
    visit.group("drive", [&] { internal::visit_drive(axis.drive, visit); });
    visit.group("limits", [&] { internal::visit_limits(axis.limits, visit); });
    visit.group("law", [&] { internal::visit_law(axis.law, visit); });
    visit.group("k3_table", [&] { internal::visit_table(axis.k3_table, visit); });
    visit.group("kicks", [&] { internal::visit_kicks(axis.kicks, visit); });
    visit.value("certified", axis.certified, "");
  });
}

// Visits what the law of an axis is made of, as visit_numbers() does: enough for a program that has a drive of its own.
template <class Axis, class Visitor>
[[gnu::cold]] constexpr void visit_law_numbers(Axis& axis, Visitor& visit) {
  visit.value("name", axis.name, "");
  visit.group("law", [&] { internal::visit_law(axis.law, visit); });
  visit.group("k3_table", [&] { internal::visit_table(axis.k3_table, visit); });
  visit.group("kicks", [&] { internal::visit_kicks(axis.kicks, visit); });
  visit.value("certified", axis.certified, "");
}

}  // namespace breakaway::firmware
