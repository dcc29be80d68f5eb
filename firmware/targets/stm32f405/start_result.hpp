// Why a node does not run.
#pragma once

#include <cstdint>
#include <string_view>

#include "breakaway/bare_metal/start_message.hpp"

namespace breakaway::stm32f405 {

enum class StartResult : std::uint8_t {
  running,
  node_refused,  // bare_metal::start_message says why
  no_crystal,
  rate_impossible,
  period_impossible,
  no_idle_bus,
};

constexpr std::string_view to_string(StartResult result) noexcept {
  switch (result) {
    case StartResult::running:
      return "running";
    case StartResult::node_refused:
      return "the node is refused";
    case StartResult::no_crystal:
      return "no crystal, and CAN needs one: check BREAKAWAY_CRYSTAL_HZ and the board";
    case StartResult::rate_impossible:
      return "the bit or baud rate cannot be made of the clock: choose one that divides it";
    case StartResult::period_impossible:
      return "the period is longer than the tick timer counts: choose one below 99 ms";
    case StartResult::no_idle_bus:
      return "the CAN controller sees no 11 recessive bits: check transceiver, wiring and termination";
  }
  return "unknown start result";
}

// Starts the node, and says how that went for a debugger to read.
template <class Node>
bool started(Node& node) noexcept {
  const StartResult result = node.start();
  if (result != StartResult::node_refused) bare_metal::tell(to_string(result));
  return result == StartResult::running;
}

}  // namespace breakaway::stm32f405
