// A node as it is flashed: intact and certified, or refused by name.
#include "breakaway/firmware/flashed_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "../explained_enum.hpp"
#include "two_axes.hpp"

namespace breakaway::firmware {
namespace {

using config::testing::flashed_pair;
using Pair = FlashedNode<float, 2>;

// The same node with a checksum that fits it: what a generator that is wrong would write.
NodeVerdict verdict_of(Pair node) {
  node.checksum = checksum_of(node);
  return verify(node);
}

// Which bytes of a node are those of a number.
class ByteMarker {
 public:
  explicit ByteMarker(const Pair& node) : begin_{reinterpret_cast<const unsigned char*>(&node)} {
    visit_numbers(node, *this);
    mark(node.checksum);
  }
  template <class T>
  void value(const char*, const T& number, const char*) {
    mark(number);
  }
  template <class Body>
  void group(const char*, const Body& body) {
    body();
  }
  template <class Items, class Body>
  void list(const char*, const Items& items, const Body& body) {
    for (const auto& item : items) body(item);
  }
  template <class Items>
  void row(const char*, const Items& items) {
    for (const auto& item : items) mark(item);
  }
  const std::array<bool, sizeof(Pair)>& marked() const { return marked_; }

 private:
  template <class T>
  void mark(const T& number) {
    const auto offset = static_cast<std::size_t>(reinterpret_cast<const unsigned char*>(&number) - begin_);
    for (std::size_t i = offset; i < offset + sizeof number; ++i) {
      EXPECT_FALSE(marked_[i]) << "visited twice: " << i;
      marked_[i] = true;
    }
  }
  const unsigned char* begin_;
  std::array<bool, sizeof(Pair)> marked_{};
};

TEST(FlashedNode, OfCertifiedAxesIsAccepted) {
  EXPECT_TRUE(verify(flashed_pair()).ok());
  EXPECT_TRUE(verify(config::testing::certified_node()).ok());
}

TEST(FlashedNode, RoomForMoreAxesDoesNotChangeTheChecksum) {
  EXPECT_EQ(checksum_of(flashed_pair()), checksum_of(config::testing::certified_node()));
}

// IEEE 802.3, by zlib.crc32(b"12345678").
TEST(FlashedNode, ChecksumIsTheCrc32OfIeee802) {
  Crc32 crc;
  crc.add(0x34333231U);
  crc.add(0x38373635U);
  EXPECT_EQ(crc.value(), 0x9AE0DAAFU);
}

TEST(FlashedNode, EveryBitOfEveryNumberThatFlipsIsNoticed) {
  const Pair intact = flashed_pair();
  const auto is_number = ByteMarker{intact}.marked();
  std::size_t flipped = 0;
  for (std::size_t byte = 0; byte < sizeof(Pair); ++byte) {
    for (unsigned bit = 0; is_number[byte] && bit < 8; ++bit, ++flipped) {
      Pair damaged = intact;
      reinterpret_cast<unsigned char*>(&damaged)[byte] ^= static_cast<unsigned char>(1U << bit);
      ASSERT_EQ(verify(damaged).error, NodeError::checksum_differs) << "byte " << byte << ", bit " << bit;
    }
  }
  EXPECT_GT(flipped, 8 * 2 * sizeof(law::K3Table<float>));
}

template <class Whole, class... Members>
std::size_t padding_of(const Whole&, const Members&...) {
  return sizeof(Whole) - (sizeof(Members) + ...);
}

// Does not compile when a struct gets another member: then visit_numbers() needs another line, too.
std::size_t padding_in(const LoopConfig& loop) {
  const auto& [network, fault_scope, moves_end, command_timeout] = loop;
  const auto& [period, bit_rate, node_id, heartbeat_period] = network;
  return padding_of(loop, network, fault_scope, moves_end, command_timeout) +
         padding_of(network, period, bit_rate, node_id, heartbeat_period);
}
std::size_t padding_in(const Wiring& wiring) {
  const auto& [rpu_can, can, can_receive, can_transmit, standby, awake, baud, serial_receive, serial_transmit] = wiring;
  return padding_of(wiring, rpu_can, can, can_receive, can_transmit, standby, awake, baud, serial_receive,
                    serial_transmit);
}
std::size_t padding_in(const law::AxisParameters<float>& law) {
  const auto& [mass, k1, k21, k22, friction, force, speed, tolerance, resolution, period, latency, coast, noise,
               feedforward] = law;
  const auto& [lower, upper] = friction;
  return padding_of(law, mass, k1, k21, k22, friction, force, speed, tolerance, resolution, period, latency, coast,
                    noise, feedforward) +
         padding_of(friction, lower, upper);
}
// Of a kick table the entries that are not there count as padding.
std::size_t padding_in(const law::BrakedKicks<float>& braked) {
  const auto& [brake, step, preload, resting, holding, fast, slow, short_lag, coast, breakaway, lost, least, most,
               still, either_way, patient, settling, fine_floor, sure, spring, approach, table] = braked;
  const auto& [sure_share, from, sure_most] = sure;
  const auto& [reach, led_step, most_kept, gain, share, longest, ringing] = spring;
  const auto& [mass, friction, hard, gentle, speed, distance, gap, response, lag, correction, standing, move] =
      approach;
  const auto& [move_speed, acceleration, deceleration, jerk] = move;
  const auto& [entries, periods, cuts, first, count, list] = table;
  const auto& [a0, a1, a2, a3] = entries[0];
  const std::size_t absent = entries.size() - count;
  return padding_of(braked, brake, step, preload, resting, holding, fast, slow, short_lag, coast, breakaway, lost,
                    least, most, still, either_way, patient, settling, fine_floor, sure, spring, approach, table) +
         padding_of(sure, sure_share, from, sure_most) +
         padding_of(spring, reach, led_step, most_kept, gain, share, longest, ringing) +
         padding_of(approach, mass, friction, hard, gentle, speed, distance, gap, response, lag, correction, standing,
                    move) +
         padding_of(move, move_speed, acceleration, deceleration, jerk) +
         padding_of(table, entries, periods, cuts, first, count, list) + padding_of(entries[0], a0, a1, a2, a3) +
         absent * (sizeof entries[0] + sizeof periods[0] + sizeof cuts[0]);
}
std::size_t padding_in(const FlashedAxis<float>& axis) {
  const auto& [name, drive, limits, law, table, braked, certified] = axis;
  const auto& [node_id, force, rated, heartbeat_period, heartbeat_timeout, sdo_timeout, torque_base, user_unit,
               inverted, absolute, homing, information] = drive;
  const auto& [first, last] = information;
  const auto& [home, home_counts, method, search, zero, acceleration, homing_timeout] = homing;
  const auto& [low, high, speed, limit_N, following, feedback_timeout, progress_timeout] = limits;
  const auto& [root_max, nodes_per_root, nodes] = table;
  const auto& [value, slope] = nodes[0];
  return padding_of(axis, name, drive, limits, law, table, braked, certified) + padding_in(braked) +
         padding_of(drive, node_id, force, rated, heartbeat_period, heartbeat_timeout, sdo_timeout, torque_base,
                    user_unit, inverted, absolute, homing, information) +
         padding_of(information, first, last) +
         padding_of(homing, home, home_counts, method, search, zero, acceleration, homing_timeout) +
         padding_of(limits, low, high, speed, limit_N, following, feedback_timeout, progress_timeout) +
         padding_in(law) + padding_of(table, root_max, nodes_per_root, nodes) +
         nodes.size() * padding_of(nodes[0], value, slope);
}

TEST(FlashedNode, AllBytesButPaddingAreVisited) {
  const Pair node = flashed_pair();
  const auto& [loop, wiring, count, axes, checksum] = node;
  const std::size_t padding = padding_of(node, loop, wiring, count, axes, checksum) + padding_in(loop) +
                              padding_in(wiring) + axes.size() * padding_in(axes[0]);
  const auto is_number = ByteMarker{node}.marked();
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(is_number, true)), sizeof node - padding);
}

// The error that one change of the second axis or of the node leads to, with a checksum that fits.
struct Spoiled {
  const char* label;
  NodeError expected;
  int axis;
  void (*spoil)(Pair&);
};

class SpoiledNode : public ::testing::TestWithParam<Spoiled> {};

TEST_P(SpoiledNode, IsRefusedByName) {
  Pair node = flashed_pair();
  GetParam().spoil(node);
  EXPECT_EQ(verdict_of(node).error, GetParam().expected) << to_string(verdict_of(node).error);
  EXPECT_EQ(verdict_of(node).axis, GetParam().axis);
}

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Table, SpoiledNode,
    ::testing::Values(
        Spoiled{"NoAxis", NodeError::count_impossible, 0, [](Pair& n) { n.count = 0; }},
        Spoiled{"MoreAxesThanRoom", NodeError::count_impossible, 0, [](Pair& n) { n.count = 3; }},
        Spoiled{"NotCertified", NodeError::not_certified, 1, [](Pair& n) { n.axes[1].certified = false; }},
        Spoiled{"MassNotANumber", NodeError::law_invalid, 1, [](Pair& n) { n.axes[1].law.mass_kg = not_a_number; }},
        Spoiled{"GainsOutOfRange", NodeError::law_invalid, 0,
                [](Pair& n) { n.axes[0].law.kick_damping_Ns_per_m = 30; }},
        Spoiled{"NoNodeId", NodeError::drive_invalid, 1, [](Pair& n) { n.axes[1].drive.node_id = 0; }},
        Spoiled{"NoForce", NodeError::drive_invalid, 1,
                [](Pair& n) { n.axes[1].drive.force_per_torque_N_per_Nm = not_a_number; }},
        Spoiled{"LawOfAnotherPeriod", NodeError::period_differs, 1, [](Pair& n) { n.axes[1].law.period_s = 2e-3F; }},
        Spoiled{"LoopOfAnotherPeriod", NodeError::period_differs, 0,
                [](Pair& n) { n.loop.network.period = std::chrono::milliseconds{2}; }},
        Spoiled{"TwoDrivesOfOneNodeId", NodeError::node_id_taken, 1, [](Pair& n) { n.axes[1].drive.node_id = 1; }},
        Spoiled{"DriveWithTheNodesId", NodeError::node_id_taken, 1, [](Pair& n) { n.axes[1].drive.node_id = 127; }},
        Spoiled{"TwoAxesOfOneName", NodeError::name_taken, 1, [](Pair& n) { n.axes[1].name = n.axes[0].name; }},
        Spoiled{"ForceLimitBelowLaw", NodeError::limits_below_law, 1, [](Pair& n) { n.axes[1].limits.force_N = 49; }},
        Spoiled{"ForceLimitNotANumber", NodeError::limits_below_law, 1,
                [](Pair& n) { n.axes[1].limits.force_N = not_a_number; }},
        Spoiled{"SpeedLimitBelowLaw", NodeError::limits_below_law, 0, [](Pair& n) { n.axes[0].limits.speed_m_s = 4; }},
        Spoiled{"FollowingErrorBelowTolerance", NodeError::limits_below_law, 1,
                [](Pair& n) { n.axes[1].limits.following_error_m = 1e-6F; }},
        Spoiled{"NoRoomBetweenPositions", NodeError::limits_below_law, 1,
                [](Pair& n) { n.axes[1].limits.position_max_m = n.axes[1].limits.position_min_m; }},
        Spoiled{"PinOfAnotherController", NodeError::wiring_impossible, 0,
                [](Pair& n) { n.wiring.can_receive = pin('B', 5); }},
        Spoiled{"BusTooSlow", NodeError::bus_overloaded, 0, [](Pair& n) { n.loop.network.bit_rate = 250'000; }}),
    [](const auto& row) { return std::string{row.param.label}; });

TEST(FlashedNode, AHandEditedNumberIsRefusedAtTheStart) {
  Pair node = flashed_pair();
  node.axes[1].law.max_force_N = 49;
  EXPECT_EQ(verify(node).error, NodeError::checksum_differs);
}

// As a drive makes a position of its counts, far from zero and rounded twice.
TEST(AxisLimits, HoldEveryCountWithinThem) {
  std::uint32_t random = 1;
  for (int i = 0; i < 20000; ++i) {
    config::Axis axis;
    axis.drive.emplace();
    axis.drive->encoder_resolution_m = 1e-6 * (1 + 1e-3 * (i % 997));
    random = 1664525 * random + 1013904223;
    const auto last = static_cast<std::int32_t>(random >> 1);
    axis.limits.position_max_m = last * axis.drive->encoder_resolution_m;
    axis.limits.position_min_m = -axis.limits.position_max_m;
    const AxisLimits<float> limits = config::axis_limits<float>(axis);
    const float shown_m = static_cast<float>(last) * static_cast<float>(axis.drive->encoder_resolution_m);
    ASSERT_LE(shown_m, limits.position_max_m) << last;
    ASSERT_GE(-shown_m, limits.position_min_m) << last;
    ASSERT_NEAR(limits.position_max_m, axis.limits.position_max_m, 2e-7 * axis.limits.position_max_m);
  }
}

TEST(NodeError, SaysWhatIsWrongAndWhatToDo) {
  test::expect_sentences<NodeError>(
      {{NodeError::none, {"intact and certified"}},
       {NodeError::checksum_differs, {"damaged or", "edited", "breakaway design --header"}},
       {NodeError::count_impossible, {"count", "breakaway design --header"}},
       {NodeError::not_certified, {"not certified", "breakaway design"}},
       {NodeError::law_invalid, {"axis' law", "law::validate()"}},
       {NodeError::drive_invalid, {"axis' drive", "cia402::check()"}},
       {NodeError::period_differs, {"period", "design the axis again"}},
       {NodeError::node_id_taken, {"node id", "give each its own"}},
       {NodeError::name_taken, {"name", "give each its own"}},
       {NodeError::limits_below_law, {"limit", "raise the limit"}},
       {NodeError::bus_overloaded, {"bus", "canopen::bus_budget()"}},
       {NodeError::wiring_impossible, {"[target]", "breakaway design"}},
       {NodeError::axes_stop_apart, {"stop together", "fault_stops"}}});
}

}  // namespace
}  // namespace breakaway::firmware
