// Every number that is flashed counts into the checksum, whatever the code that visits them leaves out.
#include <gtest/gtest.h>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "breakaway/firmware/flashed_node.hpp"
#include "certified_node.hpp"

namespace breakaway::firmware {
namespace {

using Axis = FlashedAxis<float>;
using Node = FlashedNode<float, 2>;

// Another value of its type, also where there is nothing larger.
template <class T>
void change(T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    value = !value;
  } else if constexpr (std::is_enum_v<T>) {
    value = value == T{} ? static_cast<T>(1) : T{};
  } else if constexpr (std::is_floating_point_v<T>) {
    value = value == T{1} ? T{2} : T{1};
  } else if constexpr (std::integral<T>) {
    value = static_cast<T>(value ^ 1);
  } else {
    value += T{1};
  }
}

template <class Whole>
struct Edit {
  const char* label;
  void (*make)(Whole&);
};

constexpr Edit<Axis> edits_of_an_axis[] = {
    {"drive.node_id", [](Axis& a) { change(a.drive.node_id); }},
    {"drive.force_per_torque_N_per_Nm", [](Axis& a) { change(a.drive.force_per_torque_N_per_Nm); }},
    {"drive.rated_torque_mNm", [](Axis& a) { change(a.drive.rated_torque_mNm); }},
    {"drive.heartbeat_period", [](Axis& a) { change(a.drive.heartbeat_period); }},
    {"drive.heartbeat_timeout", [](Axis& a) { change(a.drive.heartbeat_timeout); }},
    {"drive.sdo_timeout", [](Axis& a) { change(a.drive.sdo_timeout); }},
    {"drive.torque_base", [](Axis& a) { change(a.drive.torque_base); }},
    {"drive.user_position_unit", [](Axis& a) { change(a.drive.user_position_unit); }},
    {"drive.invert_direction", [](Axis& a) { change(a.drive.invert_direction); }},
    {"drive.absolute_encoder", [](Axis& a) { change(a.drive.absolute_encoder); }},
    {"drive.homing.home", [](Axis& a) { change(a.drive.homing.home); }},
    {"drive.homing.position_counts", [](Axis& a) { change(a.drive.homing.position_counts); }},
    {"drive.homing.method", [](Axis& a) { change(a.drive.homing.method); }},
    {"drive.homing.search_counts_s", [](Axis& a) { change(a.drive.homing.search_counts_s); }},
    {"drive.homing.zero_counts_s", [](Axis& a) { change(a.drive.homing.zero_counts_s); }},
    {"drive.homing.acceleration_counts_s2", [](Axis& a) { change(a.drive.homing.acceleration_counts_s2); }},
    {"drive.homing.timeout", [](Axis& a) { change(a.drive.homing.timeout); }},
    {"drive.emcy_information.first[0]", [](Axis& a) { change(a.drive.emcy_information.first[0]); }},
    {"drive.emcy_information.last[7]", [](Axis& a) { change(a.drive.emcy_information.last[7]); }},
    {"limits.position_min_m", [](Axis& a) { change(a.limits.position_min_m); }},
    {"limits.position_max_m", [](Axis& a) { change(a.limits.position_max_m); }},
    {"limits.speed_m_s", [](Axis& a) { change(a.limits.speed_m_s); }},
    {"limits.force_N", [](Axis& a) { change(a.limits.force_N); }},
    {"limits.following_error_m", [](Axis& a) { change(a.limits.following_error_m); }},
    {"limits.feedback_timeout", [](Axis& a) { change(a.limits.feedback_timeout); }},
    {"law.mass_kg", [](Axis& a) { change(a.law.mass_kg); }},
    {"law.stiffness_N_per_m", [](Axis& a) { change(a.law.stiffness_N_per_m); }},
    {"law.approach_damping_Ns_per_m", [](Axis& a) { change(a.law.approach_damping_Ns_per_m); }},
    {"law.kick_damping_Ns_per_m", [](Axis& a) { change(a.law.kick_damping_Ns_per_m); }},
    {"law.friction.lower_N", [](Axis& a) { change(a.law.friction.lower_N); }},
    {"law.friction.upper_N", [](Axis& a) { change(a.law.friction.upper_N); }},
    {"law.max_force_N", [](Axis& a) { change(a.law.max_force_N); }},
    {"law.max_approach_speed_m_s", [](Axis& a) { change(a.law.max_approach_speed_m_s); }},
    {"law.position_tolerance_m", [](Axis& a) { change(a.law.position_tolerance_m); }},
    {"law.encoder_resolution_m", [](Axis& a) { change(a.law.encoder_resolution_m); }},
    {"law.period_s", [](Axis& a) { change(a.law.period_s); }},
    {"law.latency_periods", [](Axis& a) { change(a.law.latency_periods); }},
    {"law.coast", [](Axis& a) { change(a.law.coast); }},
    {"law.flicker_m", [](Axis& a) { change(a.law.flicker_m); }},
    {"law.feedforward_N", [](Axis& a) { change(a.law.feedforward_N); }},
    {"k3_table.root_max", [](Axis& a) { change(a.k3_table.root_max); }},
    {"k3_table.nodes_per_root", [](Axis& a) { change(a.k3_table.nodes_per_root); }},
    {"kicks.brake_N", [](Axis& a) { change(a.kicks.brake_N); }},
    {"kicks.force_step_N", [](Axis& a) { change(a.kicks.force_step_N); }},
    {"kicks.preload_N", [](Axis& a) { change(a.kicks.preload_N); }},
    {"kicks.resting_force_N", [](Axis& a) { change(a.kicks.resting_force_N); }},
    {"kicks.holding_force_N", [](Axis& a) { change(a.kicks.holding_force_N); }},
    {"kicks.fast_lag", [](Axis& a) { change(a.kicks.fast_lag); }},
    {"kicks.slow_lag", [](Axis& a) { change(a.kicks.slow_lag); }},
    {"kicks.short_lag", [](Axis& a) { change(a.kicks.short_lag); }},
    {"kicks.coast_per_N", [](Axis& a) { change(a.kicks.coast_per_N); }},
    {"kicks.breakaway_N", [](Axis& a) { change(a.kicks.breakaway_N); }},
    {"kicks.lost_motion_m", [](Axis& a) { change(a.kicks.lost_motion_m); }},
    {"kicks.least_seen_N", [](Axis& a) { change(a.kicks.least_seen_N); }},
    {"kicks.most_seen_N", [](Axis& a) { change(a.kicks.most_seen_N); }},
    {"kicks.still_periods", [](Axis& a) { change(a.kicks.still_periods); }},
    {"kicks.either_way_periods", [](Axis& a) { change(a.kicks.either_way_periods); }},
    {"kicks.patient_periods", [](Axis& a) { change(a.kicks.patient_periods); }},
    {"kicks.fine_floor_m", [](Axis& a) { change(a.kicks.fine_floor_m); }},
    {"kicks.settling_periods", [](Axis& a) { change(a.kicks.settling_periods); }},
    {"kicks.sure.share", [](Axis& a) { change(a.kicks.sure.share); }},
    {"kicks.sure.from_m", [](Axis& a) { change(a.kicks.sure.from_m); }},
    {"kicks.sure.most_m", [](Axis& a) { change(a.kicks.sure.most_m); }},
    {"kicks.spring.reach_m", [](Axis& a) { change(a.kicks.spring.reach_m); }},
    {"kicks.spring.step_m", [](Axis& a) { change(a.kicks.spring.step_m); }},
    {"kicks.spring.most_N", [](Axis& a) { change(a.kicks.spring.most_N); }},
    {"kicks.spring.gain_N_per_m", [](Axis& a) { change(a.kicks.spring.gain_N_per_m); }},
    {"kicks.spring.share", [](Axis& a) { change(a.kicks.spring.share); }},
    {"kicks.spring.longest_periods", [](Axis& a) { change(a.kicks.spring.longest_periods); }},
    {"kicks.spring.ringing_periods", [](Axis& a) { change(a.kicks.spring.ringing_periods); }},
    {"kicks.approach.mass_kg", [](Axis& a) { change(a.kicks.approach.mass_kg); }},
    {"kicks.approach.friction_N", [](Axis& a) { change(a.kicks.approach.friction_N); }},
    {"kicks.approach.hard_m_s2", [](Axis& a) { change(a.kicks.approach.hard_m_s2); }},
    {"kicks.approach.gentle_m_s2", [](Axis& a) { change(a.kicks.approach.gentle_m_s2); }},
    {"kicks.approach.switch_speed_m_s", [](Axis& a) { change(a.kicks.approach.switch_speed_m_s); }},
    {"kicks.approach.switch_distance_m", [](Axis& a) { change(a.kicks.approach.switch_distance_m); }},
    {"kicks.approach.short_of_target_m", [](Axis& a) { change(a.kicks.approach.short_of_target_m); }},
    {"kicks.approach.response_s", [](Axis& a) { change(a.kicks.approach.response_s); }},
    {"kicks.approach.lag_s", [](Axis& a) { change(a.kicks.approach.lag_s); }},
    {"kicks.approach.correction", [](Axis& a) { change(a.kicks.approach.correction); }},
    {"kicks.approach.standing_m_s", [](Axis& a) { change(a.kicks.approach.standing_m_s); }},
    {"kicks.approach.move.speed_m_s", [](Axis& a) { change(a.kicks.approach.move.speed_m_s); }},
    {"kicks.approach.move.acceleration_m_s2", [](Axis& a) { change(a.kicks.approach.move.acceleration_m_s2); }},
    {"kicks.approach.move.deceleration_m_s2", [](Axis& a) { change(a.kicks.approach.move.deceleration_m_s2); }},
    {"kicks.approach.move.jerk_m_s3", [](Axis& a) { change(a.kicks.approach.move.jerk_m_s3); }},
    {"kicks.table.first", [](Axis& a) { change(a.kicks.table.first); }},
    {"kicks.table.count", [](Axis& a) { change(a.kicks.table.count); }},
    {"kicks.table.list", [](Axis& a) { change(a.kicks.table.list); }},
    {"k3_table.nodes[0].value", [](Axis& a) { change(a.k3_table.nodes[0].value); }},
    {"k3_table.nodes[0].slope", [](Axis& a) { change(a.k3_table.nodes[0].slope); }},
    {"k3_table.nodes[1].value", [](Axis& a) { change(a.k3_table.nodes[1].value); }},
    {"certified", [](Axis& a) { change(a.certified); }},
    {"name.characters[0]", [](Axis& a) { change(a.name.characters[0]); }},
    {"name.characters[1]", [](Axis& a) { change(a.name.characters[1]); }},
    {"kicks.table.entries[0].a0", [](Axis& a) { change(a.kicks.table.entries[0].a0); }},
    {"kicks.table.entries[0].a1", [](Axis& a) { change(a.kicks.table.entries[0].a1); }},
    {"kicks.table.entries[0].a2", [](Axis& a) { change(a.kicks.table.entries[0].a2); }},
    {"kicks.table.entries[0].a3", [](Axis& a) { change(a.kicks.table.entries[0].a3); }},
    {"kicks.table.entries[1].a0", [](Axis& a) { change(a.kicks.table.entries[1].a0); }},
    {"kicks.table.periods[1]", [](Axis& a) { change(a.kicks.table.periods[1]); }},
    {"kicks.table.cut_periods[1]", [](Axis& a) { change(a.kicks.table.cut_periods[1]); }},
};

constexpr Edit<Node> edits_of_the_node[] = {
    {"loop.network.period", [](Node& n) { change(n.loop.network.period); }},
    {"loop.network.bit_rate", [](Node& n) { change(n.loop.network.bit_rate); }},
    {"loop.network.node_id", [](Node& n) { change(n.loop.network.node_id); }},
    {"loop.network.heartbeat_period", [](Node& n) { change(n.loop.network.heartbeat_period); }},
    {"loop.fault_scope", [](Node& n) { change(n.loop.fault_scope); }},
    {"loop.moves_end", [](Node& n) { change(n.loop.moves_end); }},
    {"loop.command_timeout", [](Node& n) { change(n.loop.command_timeout); }},
    {"wiring.can_controller", [](Node& n) { change(n.wiring.can_controller); }},
    {"wiring.can_receive", [](Node& n) { change(n.wiring.can_receive); }},
    {"wiring.can_transmit", [](Node& n) { change(n.wiring.can_transmit); }},
    {"wiring.can_standby", [](Node& n) { change(n.wiring.can_standby); }},
    {"wiring.can_awake", [](Node& n) { change(n.wiring.can_awake); }},
    {"wiring.serial_baud", [](Node& n) { change(n.wiring.serial_baud); }},
    {"wiring.serial_receive", [](Node& n) { change(n.wiring.serial_receive); }},
    {"wiring.serial_transmit", [](Node& n) { change(n.wiring.serial_transmit); }},
    {"count", [](Node& n) { change(n.count); }},
};

// Of a law whose kicks are measured by their work.
using WorkNode = FlashedNode<float, 1, law::WorkKicks<float>>;
using WorkKicks = law::WorkKicks<float>;

constexpr Edit<WorkKicks> edits_of_work_kicks[] = {
    {"force_step_N", [](WorkKicks& k) { change(k.force_step_N); }},
    {"slow_lag", [](WorkKicks& k) { change(k.slow_lag); }},
    {"breakaway_N", [](WorkKicks& k) { change(k.breakaway_N); }},
    {"lost_motion_m", [](WorkKicks& k) { change(k.lost_motion_m); }},
    {"spring_m", [](WorkKicks& k) { change(k.spring_m); }},
    {"creep_m", [](WorkKicks& k) { change(k.creep_m); }},
    {"friction_per_gain_N", [](WorkKicks& k) { change(k.friction_per_gain_N); }},
    {"speeding_s_per_kg", [](WorkKicks& k) { change(k.speeding_s_per_kg); }},
    {"held_back_N", [](WorkKicks& k) { change(k.held_back_N); }},
    {"late_periods", [](WorkKicks& k) { change(k.late_periods); }},
    {"still_periods", [](WorkKicks& k) { change(k.still_periods); }},
    {"patient_periods", [](WorkKicks& k) { change(k.patient_periods); }},
    {"longest_coast_periods", [](WorkKicks& k) { change(k.longest_coast_periods); }},
    {"metered", [](WorkKicks& k) { change(k.metered); }},
    {"approach.mass_kg", [](WorkKicks& k) { change(k.approach.mass_kg); }},
    {"approach.friction_N", [](WorkKicks& k) { change(k.approach.friction_N); }},
    {"approach.acceleration_m_s2", [](WorkKicks& k) { change(k.approach.acceleration_m_s2); }},
    {"approach.stiffness_N_per_m", [](WorkKicks& k) { change(k.approach.stiffness_N_per_m); }},
    {"approach.damping_Ns_per_m", [](WorkKicks& k) { change(k.approach.damping_Ns_per_m); }},
    {"approach.short_of_target_m", [](WorkKicks& k) { change(k.approach.short_of_target_m); }},
    {"approach.begin_m", [](WorkKicks& k) { change(k.approach.begin_m); }},
    {"approach.swing_periods", [](WorkKicks& k) { change(k.approach.swing_periods); }},
    {"approach.speed_periods", [](WorkKicks& k) { change(k.approach.speed_periods); }},
    {"approach.mean_periods", [](WorkKicks& k) { change(k.approach.mean_periods); }},
    {"table.first", [](WorkKicks& k) { change(k.table.first); }},
    {"table.entries[0].a0", [](WorkKicks& k) { change(k.table.entries[0].a0); }},
};

// With two kicks in each table, since of a table only what is there counts.
Node node_with_tables() {
  Node node = testing::certified_node();
  for (Axis& axis : node.axes) axis.kicks.table.count = 2;
  return node;
}

TEST(Checksum, CountsEveryNumberOfEveryAxis) {
  const Node whole = node_with_tables();
  for (const auto& edit : edits_of_an_axis) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      Node edited = whole;
      edit.make(edited.axes[axis]);
      EXPECT_NE(checksum_of(edited), checksum_of(whole)) << edit.label << " of axis " << axis;
    }
  }
}

TEST(Checksum, CountsEveryNumberOfKicksByTheirWork) {
  WorkNode whole;
  whole.axes[0].kicks.table.count = 2;
  for (const auto& edit : edits_of_work_kicks) {
    WorkNode edited = whole;
    edit.make(edited.axes[0].kicks);
    EXPECT_NE(checksum_of(edited), checksum_of(whole)) << edit.label;
  }
}

TEST(Checksum, CountsEveryNumberOfTheNodeButItself) {
  const Node whole = node_with_tables();
  for (const auto& edit : edits_of_the_node) {
    Node edited = whole;
    edit.make(edited);
    EXPECT_NE(checksum_of(edited), checksum_of(whole)) << edit.label;
  }
  Node other = whole;
  change(other.checksum);
  EXPECT_EQ(checksum_of(other), checksum_of(whole));
}

TEST(Checksum, CountsOnlyWhatIsThere) {
  const Node whole = node_with_tables();
  Node beyond = whole;
  change(beyond.axes[0].kicks.table.entries[2].a0);
  change(beyond.axes[0].kicks.table.periods[2]);
  EXPECT_EQ(checksum_of(beyond), checksum_of(whole));
  Node alone = whole;
  alone.count = 1;
  Node changed = alone;
  change(changed.axes[1].law.mass_kg);
  EXPECT_EQ(checksum_of(changed), checksum_of(alone));
}

// CRC-32 of Ethernet and zip: every number as a little-endian word, a longer one as two.
TEST(Checksum, IsTheCrc32OfItsWords) {
  Crc32 words, doubled, byte, half;
  words.add_bits_of(std::uint32_t{0x34333231});
  words.add_bits_of(std::uint32_t{0x38373635});
  EXPECT_EQ(words.value(), 0x9AE0DAAFU) << "of the digits 1 to 8";
  doubled.add_bits_of(std::uint64_t{0x3837363534333231});
  EXPECT_EQ(doubled.value(), words.value());
  byte.add_bits_of('A');
  EXPECT_EQ(byte.value(), 0x2ECE044U);
  half.add_bits_of(std::uint16_t{'A'});
  EXPECT_EQ(half.value(), byte.value());
}

struct Refusal {
  const char* label;
  NodeError error;
  std::uint8_t axis;
  void (*spoil)(Node&);
};

constexpr float boundless = std::numeric_limits<float>::infinity();

constexpr Refusal refusals[] = {
    {"no axis", NodeError::count_impossible, 0, [](Node& n) { n.count = 0; }},
    {"three axes", NodeError::count_impossible, 0, [](Node& n) { n.count = 3; }},
    {"not certified", NodeError::not_certified, 1, [](Node& n) { n.axes[1].certified = false; }},
    {"no mass", NodeError::law_invalid, 1, [](Node& n) { n.axes[1].law.mass_kg = 0; }},
    {"no kicks", NodeError::law_invalid, 0, [](Node& n) { n.axes[0].law.coast = law::Coast::brake; }},
    {"no pulses", NodeError::law_invalid, 1, [](Node& n) { n.axes[1].kicks.table.count = 0; }},
    {"pulses that are not there", NodeError::law_invalid, 1,
     [](Node& n) { n.axes[1].kicks.table.count = law::KickTable<float>::most_entries + 1; }},
    {"shorter period", NodeError::period_differs, 0, [](Node& n) { n.axes[0].law.period_s = 0.999e-3F; }},
    {"longer period", NodeError::period_differs, 1, [](Node& n) { n.axes[1].law.period_s = 1.001e-3F; }},
    {"a little shorter", NodeError::period_differs, 1, [](Node& n) { n.axes[1].law.period_s = 1e-3F * (1 - 1.5e-6F); }},
    {"a little longer", NodeError::period_differs, 1, [](Node& n) { n.axes[1].law.period_s = 1e-3F * (1 + 1.5e-6F); }},
    {"id of the node", NodeError::node_id_taken, 1, [](Node& n) { n.axes[1].drive.node_id = n.loop.network.node_id; }},
    {"id of the other", NodeError::node_id_taken, 1, [](Node& n) { n.axes[1].drive.node_id = 1; }},
    {"id of nobody", NodeError::drive_invalid, 1, [](Node& n) { n.axes[1].drive.node_id = 0; }},
    {"information that is an end", NodeError::drive_invalid, 1,
     [](Node& n) { n.axes[1].drive.emcy_information.last[0] = 0x00FF; }},
    {"name of the other", NodeError::name_taken, 1, [](Node& n) { n.axes[1].name = n.axes[0].name; }},
    {"force", NodeError::limits_below_law, 0, [](Node& n) { n.axes[0].limits.force_N = 49.9F; }},
    {"following error", NodeError::limits_below_law, 1, [](Node& n) { n.axes[1].limits.following_error_m = 1.9e-6F; }},
    {"no room", NodeError::limits_below_law, 1,
     [](Node& n) { n.axes[1].limits.position_min_m = n.axes[1].limits.position_max_m = 1; }},
    {"speed", NodeError::limits_below_law, 1, [](Node& n) { n.axes[1].limits.speed_m_s = 4.9F; }},
    {"the largest number for a speed", NodeError::limits_below_law, 1,
     [](Node& n) {
       n.axes[1].law.max_approach_speed_m_s = std::numeric_limits<float>::max();
       n.axes[1].limits.speed_m_s = 5;
     }},
    {"force is no number", NodeError::limits_below_law, 1, [](Node& n) { n.axes[1].limits.force_N = std::nanf(""); }},
    {"slow bus", NodeError::bus_overloaded, 0, [](Node& n) { n.loop.network.bit_rate = 125'000; }},
};

TEST(Verify, RefusesByNameWhatContradictsItself) {
  for (const Refusal& refusal : refusals) {
    Node node = testing::certified_node();
    refusal.spoil(node);
    EXPECT_EQ(verify(node).error, NodeError::checksum_differs) << refusal.label;
    node.checksum = checksum_of(node);
    const NodeVerdict verdict = verify(node);
    EXPECT_EQ(verdict.error, refusal.error) << refusal.label << ": " << to_string(verdict.error);
    EXPECT_EQ(verdict.axis, refusal.axis) << refusal.label;
    EXPECT_FALSE(verdict.ok()) << refusal.label;
  }
}

struct Allowance {
  const char* label;
  void (*make)(Axis&);
};

constexpr Allowance allowances[] = {
    {"force of the law", [](Axis& a) { a.limits.force_N = a.law.max_force_N; }},
    {"tolerance", [](Axis& a) { a.limits.following_error_m = a.law.position_tolerance_m; }},
    {"speed of the law", [](Axis& a) { a.limits.speed_m_s = a.law.max_approach_speed_m_s; }},
    {"no speed asked for, and little allowed",
     [](Axis& a) {
       a.law.max_approach_speed_m_s = boundless;
       a.limits.speed_m_s = 0.1F;
     }},
    {"period but for rounding, shorter", [](Axis& a) { a.law.period_s = 1e-3F * (1 - 0.5e-6F); }},
    {"period but for rounding, longer", [](Axis& a) { a.law.period_s = 1e-3F * (1 + 0.5e-6F); }},
};

TEST(Verify, TakesLimitsThatTheLawJustKeeps) {
  EXPECT_TRUE(verify(testing::certified_node()).ok());
  Node alone = testing::certified_node();
  alone.count = 1;
  alone.checksum = checksum_of(alone);
  EXPECT_TRUE(verify(alone).ok()) << "room for two axes, and one there";
  for (const Allowance& allowance : allowances) {
    Node node = testing::certified_node();
    allowance.make(node.axes[1]);
    node.checksum = checksum_of(node);
    EXPECT_TRUE(verify(node).ok()) << allowance.label << ": " << to_string(verify(node).error);
  }
}

TEST(AxisName, EndsAtItsZeroAndAtItsEnd) {
  AxisName name;
  EXPECT_EQ(name.view(), "");
  name.characters = {'x', 'y'};
  EXPECT_EQ(name.view(), "xy");
  name.characters.fill('z');
  EXPECT_EQ(name.view().size(), longest_axis_name);
}

}  // namespace
}  // namespace breakaway::firmware
