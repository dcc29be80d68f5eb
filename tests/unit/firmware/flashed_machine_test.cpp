// A machine of axes that push each other, as it is flashed: intact and certified, or refused by name.
#include "breakaway/firmware/flashed_machine.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace breakaway::firmware {
namespace {

using Machine = FlashedMachine<float, 2>;

Machine certified_machine() {
  Machine m;
  m.loop.network.period = std::chrono::milliseconds{1};
  m.loop.fault_scope = FaultScope::all_axes;
  m.coordinator.period_s = 1e-3F;
  m.coordinator.most_kicks = 20;
  for (std::size_t i = 0; i < 2; ++i) {
    m.axes[i].name.characters[0] = i == 0 ? 'x' : 'y';
    m.axes[i].drive = {.node_id = static_cast<std::uint8_t>(i + 1), .force_per_torque_N_per_Nm = 50};
    m.coordinator.axes[i] = {.position_gain_N_per_m = 400,
                             .velocity_gain_Ns_per_m = 40,
                             .mass_kg = 2,
                             .lower_N = 2.5F,
                             .upper_N = 4.5F,
                             .sure_N = 4.51F,
                             .brake_N = 0.5F,
                             .kick_N = 40,
                             .max_force_N = 50,
                             .gate_m = 0.02F,
                             .tolerance_m = 1e-5F,
                             .resolution_m = 1e-6F,
                             .hold_off = {}};
    m.coordinator.axes[i].hold_off[1 - i] = 0.25F;
  }
  m.certified = true;
  m.checksum = checksum_of(m);
  return m;
}

// Marks the bytes of the numbers that are visited.
class ByteMarker {
 public:
  explicit ByteMarker(const Machine& machine) : begin_{reinterpret_cast<const unsigned char*>(&machine)} {
    visit_numbers(machine, *this);
  }
  template <class T>
  void value(const char*, const T& number, const char*) {
    const auto offset = static_cast<std::size_t>(reinterpret_cast<const unsigned char*>(&number) - begin_);
    for (std::size_t i = offset; i < offset + sizeof number; ++i) {
      EXPECT_FALSE(marked[i]) << "visited twice: " << i;
      marked[i] = true;
    }
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
    for (const auto& item : items) value("", item, "");
  }

  std::array<bool, sizeof(Machine)> marked{};

 private:
  const unsigned char* begin_;
};

TEST(FlashedMachine, IsAcceptedWholeAndRefusedWithAnyBitFlipped) {
  const Machine intact = certified_machine();
  ASSERT_TRUE(verify(intact).ok()) << to_string(verify(intact).error);
  const auto is_number = ByteMarker{intact}.marked;
  for (std::size_t byte = 0; byte < sizeof(Machine); ++byte) {
    for (unsigned bit = 0; is_number[byte] && bit < 8; ++bit) {
      Machine damaged = intact;
      reinterpret_cast<unsigned char*>(&damaged)[byte] ^= static_cast<unsigned char>(1U << bit);
      ASSERT_EQ(verify(damaged).error, NodeError::checksum_differs) << "byte " << byte << ", bit " << bit;
    }
  }
}

// Does not compile when a struct gets another member: then visit_numbers() needs another line, too.
TEST(FlashedMachine, EveryMemberOfItsCoordinatorCountsIntoTheChecksum) {
  const Machine machine = certified_machine();
  const auto is_number = ByteMarker{machine}.marked;
  const auto expect_visited = [&](const auto&... members) {
    const auto* const begin = reinterpret_cast<const unsigned char*>(&machine);
    const auto first = [&](const auto& member) {
      return is_number[static_cast<std::size_t>(reinterpret_cast<const unsigned char*>(&member) - begin)];
    };
    EXPECT_TRUE((first(members) && ...));
  };
  expect_visited(machine.loop.network.period, machine.wiring.can_controller, machine.wiring.serial_baud, machine.count,
                 machine.axes[0].name, machine.axes[1].drive.node_id, machine.axes[1].limits.force_N,
                 machine.certified);
  const auto& [period, count, settling, still, release, most_kicks, axes] = machine.coordinator;
  expect_visited(period, count, settling, still, release, most_kicks);
  for (const auto& axis : axes) {
    const auto& [p, d, mass, lower, upper, sure, brake, kick, most, gate, tolerance, resolution, hold_off] = axis;
    expect_visited(p, d, mass, lower, upper, sure, brake, kick, most, gate, tolerance, resolution, hold_off[0],
                   hold_off[1]);
  }
}

TEST(FlashedMachine, RoomForMoreAxesDoesNotChangeTheChecksum) {
  const Machine two = certified_machine();
  FlashedMachine<float, 8> eight;
  eight.loop = two.loop;
  eight.wiring = two.wiring;
  eight.count = 2;
  eight.certified = true;
  auto& c = eight.coordinator;
  c.period_s = two.coordinator.period_s;
  c.count = 2;
  c.most_kicks = two.coordinator.most_kicks;
  for (std::size_t i = 0; i < 2; ++i) {
    eight.axes[i] = two.axes[i];
    const auto& [p, d, mass, lower, upper, sure, brake, kick, most, gate, tolerance, resolution, hold_off] =
        two.coordinator.axes[i];
    c.axes[i] = {p, d, mass, lower, upper, sure, brake, kick, most, gate, tolerance, resolution, {}};
    for (std::size_t j = 0; j < 2; ++j) c.axes[i].hold_off[j] = hold_off[j];
  }
  EXPECT_EQ(checksum_of(eight), two.checksum);
}

struct Refusal {
  const char* label;
  NodeError error;
  std::uint8_t axis;
  void (*spoil)(Machine&);
};

constexpr Refusal refusals[] = {
    {"no axis", NodeError::count_impossible, 0, [](Machine& m) { m.count = m.coordinator.count = 0; }},
    {"a coordinator of fewer", NodeError::count_impossible, 0, [](Machine& m) { m.coordinator.count = 1; }},
    {"not certified", NodeError::not_certified, 0, [](Machine& m) { m.certified = false; }},
    {"stops apart", NodeError::axes_stop_apart, 0, [](Machine& m) { m.loop.fault_scope = FaultScope::axis; }},
    {"another period", NodeError::period_differs, 0, [](Machine& m) { m.coordinator.period_s = 2e-3F; }},
    {"no mass", NodeError::law_invalid, 0, [](Machine& m) { m.coordinator.axes[1].mass_kg = 0; }},
    {"a brake that friction does not exceed", NodeError::law_invalid, 0,
     [](Machine& m) { m.coordinator.axes[1].brake_N = 2.5F; }},
    {"an unsure force", NodeError::law_invalid, 0, [](Machine& m) { m.coordinator.axes[0].sure_N = 4.4F; }},
    {"a kick beyond the drive", NodeError::law_invalid, 0, [](Machine& m) { m.coordinator.axes[0].kick_N = 51; }},
    {"a kick that moves nothing", NodeError::law_invalid, 0, [](Machine& m) { m.coordinator.axes[0].kick_N = 3; }},
    {"a hold-off force beyond the other drive", NodeError::law_invalid, 0,
     [](Machine& m) { m.coordinator.axes[1].max_force_N = m.coordinator.axes[1].kick_N = 9; }},
    {"a hold-off force for itself", NodeError::law_invalid, 0,
     [](Machine& m) { m.coordinator.axes[1].hold_off[1] = 0.1F; }},
    {"no number", NodeError::law_invalid, 0, [](Machine& m) { m.coordinator.axes[1].hold_off[0] = std::nanf(""); }},
    {"id of the other", NodeError::node_id_taken, 1, [](Machine& m) { m.axes[1].drive.node_id = 1; }},
    {"id of nobody", NodeError::drive_invalid, 1, [](Machine& m) { m.axes[1].drive.node_id = 0; }},
    {"name of the other", NodeError::name_taken, 1, [](Machine& m) { m.axes[1].name = m.axes[0].name; }},
    {"force", NodeError::limits_below_law, 1, [](Machine& m) { m.axes[1].limits.force_N = 49.9F; }},
    {"following error", NodeError::limits_below_law, 0, [](Machine& m) { m.axes[0].limits.following_error_m = 9e-6F; }},
    {"no room", NodeError::limits_below_law, 1,
     [](Machine& m) { m.axes[1].limits.position_min_m = m.axes[1].limits.position_max_m = 1; }},
    {"no speed", NodeError::limits_below_law, 1, [](Machine& m) { m.axes[1].limits.speed_m_s = 0; }},
    {"slow bus", NodeError::bus_overloaded, 0, [](Machine& m) { m.loop.network.bit_rate = 125'000; }},
};

TEST(FlashedMachine, IsRefusedByNameWhereItContradictsItself) {
  for (const Refusal& refusal : refusals) {
    Machine machine = certified_machine();
    refusal.spoil(machine);
    EXPECT_EQ(verify(machine).error, NodeError::checksum_differs) << refusal.label;
    machine.checksum = checksum_of(machine);
    const NodeVerdict verdict = verify(machine);
    EXPECT_EQ(verdict.error, refusal.error) << refusal.label << ": " << to_string(verdict.error);
    EXPECT_EQ(verdict.axis, refusal.axis) << refusal.label;
  }
}

TEST(FlashedMachine, TakesLimitsThatItsLawJustKeepsAndAMachineOfOneAxis) {
  EXPECT_FALSE(Machine{}.certified) << "before a design has certified it";
  Machine machine = certified_machine();
  machine.axes[0].limits.force_N = machine.coordinator.axes[0].max_force_N;
  machine.axes[0].limits.following_error_m = machine.coordinator.axes[0].tolerance_m;
  machine.axes[1].limits.speed_m_s = 1e-3F;
  machine.checksum = checksum_of(machine);
  EXPECT_TRUE(verify(machine).ok()) << to_string(verify(machine).error);
  machine.count = machine.coordinator.count = 1;
  machine.coordinator.axes[0].hold_off = {};
  machine.checksum = checksum_of(machine);
  EXPECT_TRUE(verify(machine).ok()) << to_string(verify(machine).error);
}

TEST(FlashedMachine, AnAxisThatIsNeverKickedNeedsNoHoldOffForces) {
  Machine machine = certified_machine();
  machine.coordinator.axes[0].kick_N = 0;
  machine.coordinator.axes[0].hold_off[1] = 100;
  machine.checksum = checksum_of(machine);
  EXPECT_TRUE(verify(machine).ok()) << to_string(verify(machine).error);
}

}  // namespace
}  // namespace breakaway::firmware
