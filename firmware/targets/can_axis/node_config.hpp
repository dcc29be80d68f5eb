// The node of sim/scenarios/can_axis.toml: bus, drive and limits around the axis that was designed. A machine of your
// own has a folder of its own with such a file; BREAKAWAY_NODE_FOLDER names it.
#pragma once

#include "breakaway/firmware/control_node.hpp"
#include "flashed_axis.hpp"

namespace breakaway::flashed {

inline constexpr firmware::NodeConfig<float> node{
    .loop = {.period = std::chrono::milliseconds{1}, .bit_rate = 1'000'000},
    .drive = {.node_id = 1, .force_per_torque_N_per_Nm = 50},
    .limits = {.position_min_m = -10, .position_max_m = 10, .speed_m_s = 20},
    .axis = &axis};

}  // namespace breakaway::flashed
