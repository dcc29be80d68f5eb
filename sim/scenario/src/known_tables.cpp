#include "breakaway/scenario/known_tables.hpp"

#include <string_view>

#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::scenario {
namespace {

// Nothing counts here but which tables there are, and the words that decide which keys a table has. A table or a word
// that no file here has is named by KnownTables::unread().
constexpr std::string_view one_axis_text = R"(
title = "One axis with every table of its own"
[loop]
period_s = 0.001
[bus]
[run]
duration_s = 1
settle_tolerance_m = 1e-5
[target.stm32f405]
[target.zynqmp_r5]
[plant]
mass_kg = 1
presliding = { stiffness_N_per_m = 1e6 }
load = { mass_kg = 1, stiffness_N_per_m = 1e6 }
backlash = { gap_m = 1e-5 }
cogging = { amplitude_N = 0.1, period_m = 0.01 }
ripple = { share = 0.01, period_m = 0.01 }
encoder_error = { noise_m = 1e-7 }
drift = { share = 0.1, period_s = 3 }
[friction]
lower_N = 2.5
upper_N = 4.5
[friction.law]
kind = "maximum"
[[friction.law.parts]]
kind = "minimum"
[[friction.law.parts.parts]]
kind = "product"
parts = [{ kind = "constant" }, { kind = "static_kinetic" }, { kind = "random_dwell" }]
[[friction.law.parts.parts]]
kind = "mean"
parts = [{ kind = "stribeck", velocity_m_s = 0.1 }, { kind = "stribeck_gaussian", velocity_m_s = 0.1 }]
[[friction.law.parts]]
kind = "complement"
part = { kind = "sine_in_position", period_m = 0.01 }
[[friction.law.parts]]
kind = "sine_in_time"
angular_frequency_rad_s = 1
[[friction.law.parts]]
kind = "position_table"
edges_m = [0]
values = [0, 1]
[controller]
k1_N_per_m = 400
k21_Ns_per_m = 32
k22_Ns_per_m = 60
targets = [{ time_s = 0.5, position_m = 0.1 }]
[drive]
rated_torque_Nm = 1
max_torque_per_mille = 1000
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
quirks = {}
[limits]
position_m = 1
speed_m_s = 2
[told]
[uncertainty]
[move]
distance_m = 0.4
speed_m_s = 1
acceleration_m_s2 = 10
)";

// Without a loop other values are usual.
constexpr std::string_view ideal_axis_text = R"(
[plant]
mass_kg = 1
[friction]
mu_lower = 0.2
mu_upper = 0.4
gravity_m_s2 = 9.81
[controller]
k1_N_per_m = 1
k21_Ns_per_m = 0.5
k22_Ns_per_m = 3
)";

constexpr std::string_view pid_axis_text = R"(
[plant]
mass_kg = 1
[friction]
lower_N = 2.5
upper_N = 4.5
[controller]
kind = "pid"
kp_N_per_m = 400
ki_N_per_ms = 100
kd_Ns_per_m = 32
[loop]
period_s = 0.001
[drive]
rated_torque_Nm = 1
max_torque_per_mille = 1000
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
)";

constexpr std::string_view odrive_axis_text = R"(
[plant]
mass_kg = 1
[friction]
lower_N = 2.5
upper_N = 4.5
[controller]
k1_N_per_m = 400
k21_Ns_per_m = 32
k22_Ns_per_m = 60
[loop]
period_s = 0.001
[drive]
protocol = "odrive"
travel_per_turn_m = 0.1
max_torque_Nm = 1
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
[limits]
position_m = 1
)";

constexpr std::string_view axes_on_a_machine_text = R"(
[machine]
mass = [[1]]
damping = [[0]]
stiffness = [[0]]
directions = [[1]]
friction_N = [3]
[start]
q = [0.01]
[coupling]
mass = [[1]]
start_m = 0.03
[loop]
period_s = 0.001
[[axis]]
name = "x"
plant = { mass_kg = 1, machine = { push = 1 } }
friction = { lower_N = 2.5, upper_N = 4.5 }
controller = { k1_N_per_m = 400, k21_Ns_per_m = 32, k22_Ns_per_m = 60 }
[axis.drive]
rated_torque_Nm = 1
max_torque_per_mille = 1000
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
)";

constexpr std::string_view machine_text = R"(
[machine]
mass = [[1]]
damping = [[0]]
stiffness = [[1]]
directions = [[1]]
friction_N = [3]
[feedback]
position_gain = [[1]]
velocity_gain = [[1]]
[start]
q = [0.01]
[[impulse]]
time_s = 1
impulse_Ns = [1]
[sweep]
damping = [[0]]
d1 = [1]
[run]
duration_s = 2
)";

constexpr std::string_view machine_with_laws_text = R"(
[machine]
mass = [[1]]
damping = [[0]]
stiffness = [[1]]
directions = [[1]]
[[machine.friction]]
lower_N = 2
upper_N = 3
law = { kind = "static_kinetic" }
[run]
)";

}  // namespace

config::KnownTables known_tables() {
  config::KnownTables known;
  for (const std::string_view text : {one_axis_text, ideal_axis_text, pid_axis_text, odrive_axis_text,
                                      axes_on_a_machine_text, machine_text, machine_with_laws_text})
    static_cast<void>(parse_any_scenario(text, "a file of every table", &known));
  return known;
}

}  // namespace breakaway::scenario
