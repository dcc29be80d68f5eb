// The header that `breakaway design --header` writes, compiled as firmware compiles it.
#include <gtest/gtest.h>

#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "flashed_axis.hpp"

namespace {

using namespace breakaway;

TEST(FlashedHeader, CompilesToAConfigurationThatIsAccepted) {
  EXPECT_EQ(law::verify(flashed::axis), law::FlashedAxisError::none);
}

// Bit for bit what the simulation runs, but for the force limit, which is that of the drive.
TEST(FlashedHeader, HoldsTheParametersAndTheTableOfTheScene) {
  const auto scene = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml");
  const auto p = scenario::axis_parameters<float>(scene);
  const auto& flashed = flashed::axis.parameters;
  EXPECT_EQ(flashed.mass_kg, p.mass_kg);
  EXPECT_EQ(flashed.stiffness_N_per_m, p.stiffness_N_per_m);
  EXPECT_EQ(flashed.approach_damping_Ns_per_m, p.approach_damping_Ns_per_m);
  EXPECT_EQ(flashed.kick_damping_Ns_per_m, p.kick_damping_Ns_per_m);
  EXPECT_EQ(flashed.friction.lower_N, p.friction.lower_N);
  EXPECT_EQ(flashed.friction.upper_N, p.friction.upper_N);
  EXPECT_EQ(flashed.max_approach_speed_m_s, p.max_approach_speed_m_s);
  EXPECT_EQ(flashed.position_tolerance_m, p.position_tolerance_m);
  EXPECT_EQ(flashed.encoder_resolution_m, p.encoder_resolution_m);
  EXPECT_EQ(flashed.period_s, p.period_s);
  EXPECT_EQ(flashed.latency_periods, p.latency_periods);
  EXPECT_EQ(flashed.kick_shape, p.kick_shape);
  EXPECT_LE(flashed.max_force_N, static_cast<float>(scenario::drive_force_N(*scene.drive)));

  const auto built = design::build_k3_table<float>(
      {p.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N}, p.stick_radius_upper_m());
  const auto& table = flashed::axis.k3_table;
  EXPECT_EQ(table.root_max, built.table.root_max);
  EXPECT_EQ(table.nodes_per_root, built.table.nodes_per_root);
  for (std::size_t i = 0; i < table.nodes.size(); ++i) {
    EXPECT_EQ(table.nodes[i].value, built.table.nodes[i].value) << i;
    EXPECT_EQ(table.nodes[i].slope, built.table.nodes[i].slope) << i;
  }
}

}  // namespace
