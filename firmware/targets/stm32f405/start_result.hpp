// Why a node does not run, for a debugger to read: `start_result` in the image's symbols.
#pragma once

#include <cstdint>

#include "breakaway/firmware/control_node.hpp"

namespace breakaway::stm32f405 {

enum class StartResult : std::uint32_t {
  not_started,
  running,
  configuration_refused,  // node_error says why
  no_crystal,             // CAN needs better than 0.5 %; check BREAKAWAY_CRYSTAL_HZ and the board
  rate_impossible,        // this bit or baud rate cannot be made of the clock
  period_impossible,      // longer than the tick timer counts
  no_idle_bus,            // the CAN controller sees no 11 recessive bits: check transceiver, wiring, termination
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

}  // namespace breakaway::stm32f405
