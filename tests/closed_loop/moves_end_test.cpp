// Axes whose targets move at once arrive at once, where the file asks for it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"

namespace breakaway::closed_loop {
namespace {

// The axis of move_axis.toml, twice: one has a long way and the other a short one, there and back.
std::string axis_text(const std::string& name, int node_id, double target_m, bool limits_jerk) {
  return "[[axis]]\nname = \"" + name + "\"\n[axis.controller]\nk1_N_per_m = 400\nk21_Ns_per_m = 32\n" +
         "k22_Ns_per_m = 60\ncoast = \"brake\"\nmax_force_N = 50\nposition_tolerance_m = 2e-6\n" +
         "targets = [{ time_s = 0.5, position_m = " + std::to_string(target_m) +
         " }, { time_s = 2, position_m = 0 }]\n[axis.drive]\nnode_id = " + std::to_string(node_id) + R"(
rated_torque_Nm = 0.5
max_torque_per_mille = 2000
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
current_loop_time_constant_s = 1e-4
[axis.plant]
mass_kg = 1
[axis.friction]
lower_N = 2.5
upper_N = 4.5
law = { kind = "stribeck", velocity_m_s = 0.5 }
[axis.move]
distance_m = 0.5
speed_m_s = 1
acceleration_m_s2 = 20
)" + (limits_jerk ? "jerk_m_s3 = 2000\n" : "");
}

scenario::Scenario two_axes(const std::string& moves_end, double near_m, bool limits_jerk) {
  return scenario::parse_scenario("[loop]\nperiod_s = 0.001\nmoves_end = \"" + moves_end +
                                      "\"\n[bus]\nbit_rate = 1_000_000\n[run]\nduration_s = 3.5\n" +
                                      "settle_tolerance_m = 3e-6\n" + axis_text("far", 1, 0.4, limits_jerk) +
                                      axis_text("near", 2, near_m, limits_jerk),
                                  "moves.toml");
}

// When each axis came within a tenth of a millimetre of its target for good, counted from when that moved at `from_s`.
std::array<double, 2> arrivals_s(const scenario::Scenario& s, double from_s, double until_s, double near_m) {
  const auto result = sil::run_loop_scenario(s, {.trace = true});
  std::array<double, 2> arrival{};
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(result.axes[i].settled) << i;
    EXPECT_TRUE(result.axes[i].faults.empty()) << i;
    const double target_m = from_s > 1 ? 0 : (i == 0 ? 0.4 : near_m);
    for (const auto& sample : result.axes[i].trace) {
      if (sample.time_s > from_s && sample.time_s < until_s && std::fabs(sample.position_m - target_m) > 1e-4)
        arrival[i] = sample.time_s - from_s;
    }
  }
  return arrival;
}

TEST(MovesEnd, TogetherTheQuickerAxisTakesAsLongAsTheOther) {
  for (const bool limits_jerk : {false, true}) {
    for (const double near_m : {0.05, 0.2}) {
      const auto alone = two_axes("each", near_m, limits_jerk), matched = two_axes("together", near_m, limits_jerk);
      for (const auto& [from_s, until_s] : {std::pair{0.5, 2.0}, {2.0, 3.5}}) {
        const auto each = arrivals_s(alone, from_s, until_s, near_m),
                   both = arrivals_s(matched, from_s, until_s, near_m);
        EXPECT_LT(each[1], 0.75 * each[0]) << near_m;
        EXPECT_NEAR(both[0], each[0], 0.002) << "the slower one is as quick as alone";
        EXPECT_NEAR(both[1], both[0], 0.1 * both[0]) << near_m << ' ' << limits_jerk << " from " << from_s;
      }
    }
  }
}

}  // namespace
}  // namespace breakaway::closed_loop
