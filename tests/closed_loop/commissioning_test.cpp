// From power-on to the first command, as a simulation has it: drives that seek their home, that are slow, and that
// never get ready.
#include <gtest/gtest.h>

#include <string>

#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"

namespace breakaway::closed_loop {
namespace {

// The axis of braked_axis.toml, nearer to its target and at rest.
std::string axis_text(const std::string& name, const std::string& drive, const std::string& quirks) {
  return "[[axis]]\nname = \"" + name +
         "\"\n[axis.plant]\nmass_kg = 1\nposition_m = -0.5\n[axis.friction]\nlower_N = 2.5\nupper_N = 4.5\n"
         "[axis.controller]\nk1_N_per_m = 400\nk21_Ns_per_m = 32\nk22_Ns_per_m = 60\nmax_force_N = 50\n"
         "max_approach_speed_m_s = 5\nposition_tolerance_m = 2e-6\n[axis.drive]\nrated_torque_Nm = 0.5\n"
         "max_torque_per_mille = 2000\nforce_per_torque_N_per_Nm = 50\nencoder_resolution_m = 1e-6\n"
         "current_loop_time_constant_s = 1e-4\n" +
         drive + "[axis.drive.quirks]\n" + quirks + "[axis.limits]\nposition_m = 10\nspeed_m_s = 20\n";
}

sil::Result simulated(const std::string& axes) {
  const std::string text = "[loop]\nperiod_s = 0.001\n[bus]\n[run]\nduration_s = 5\nsettle_tolerance_m = 3e-6\n" + axes;
  return sil::run_loop_scenario(scenario::parse_scenario(text, "axes.toml"), {});
}

void expect_settled(const sil::Result& result) {
  for (const auto& axis : result.axes) {
    EXPECT_TRUE(axis.settled) << axis.name;
    for (const auto& fault : axis.faults) ADD_FAILURE() << axis.name << ": " << fault.name;
  }
}

// Past half a minute, in which the other axis stands behind its brake.
TEST(Commissioning, ADriveThatSeeksItsHomeMovesBeforeAllAxesBegin) {
  const std::string homes =
      "home = \"drive\"\nhome_method = 17\nhome_speed_m_s = 0.02\nhome_zero_speed_m_s = 0.01\n"
      "home_position_m = -1\n";
  const std::string switches = "low_limit_switch_m = -1\nhigh_limit_switch_m = 1\n";
  const auto result = simulated(axis_text("seeks", homes, switches) + axis_text("waits", "", ""));
  expect_settled(result);
  EXPECT_LE(result.axes[0].excursions->lowest_m, -0.99) << "from its home";
  EXPECT_GE(result.axes[1].excursions->lowest_m, -0.5);
}

TEST(Commissioning, ADriveThatAnswersSlowlyIsWaitedForAsOnAMachine) {
  expect_settled(simulated(axis_text("slow", "", "sdo_response_delay_s = 0.2\n")));
}

TEST(Commissioning, ADriveThatIsNeverSetUpIsNamedWithWhatItTells) {
  const auto result = simulated(axis_text("refuses", "", "refuses_start_with = 0x6320\n") + axis_text("waits", "", ""));
  ASSERT_EQ(result.axes[0].faults.size(), 1U);
  EXPECT_EQ(result.axes[0].faults[0].name, "drive was not set up in time (error code 6320h)");
  ASSERT_EQ(result.axes[1].faults.size(), 1U);
  EXPECT_EQ(result.axes[1].faults[0].name, "not enabled: the drive of another axis was not set up in time");
  EXPECT_EQ(result.axes[1].max_force_N, 0);
}

}  // namespace
}  // namespace breakaway::closed_loop
