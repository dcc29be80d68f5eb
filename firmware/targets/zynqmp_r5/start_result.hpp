// Why a node does not run, for a debugger to read: `start_result` in the image's symbols.
#pragma once

#include <cstdint>

#include "breakaway/firmware/control_node.hpp"

namespace breakaway::zynqmp_r5 {

enum class StartResult : std::uint32_t {
  not_started,
  running,
  configuration_refused,  // node_error says why
  rate_impossible,        // this bit rate cannot be made of BREAKAWAY_CAN_HZ
  no_idle_bus,            // the CAN controller has no clock or sees no 11 recessive bits
  period_impossible,      // not a whole number of cycles of BREAKAWAY_CORE_HZ, or too long for the watchdog
};

inline constinit volatile StartResult start_result = StartResult::not_started;

// Why, when the configuration is refused: the first that is not none, or fits.
inline constinit volatile firmware::NodeError node_error = firmware::NodeError::none;
inline constinit volatile law::FlashedAxisError axis_error = law::FlashedAxisError::none;
inline constinit volatile cia402::DriveConfigError drive_error = cia402::DriveConfigError::none;
inline constinit volatile canopen::BusFit bus_fit = canopen::BusFit::fits;

// Leaves there what a node was refused for. False: it was not.
template <class Node>
bool is_refused(const Node& node) noexcept {
  node_error = node.error();
  axis_error = node.axis_error();
  drive_error = node.drive_error();
  bus_fit = node.bus_fit();
  return node.error() != firmware::NodeError::none;
}

}  // namespace breakaway::zynqmp_r5
