// Why a node does not run.
#pragma once

#include <cstdint>
#include <string_view>

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/bare_metal/start_message.hpp"
#include "reset_cause.hpp"

namespace breakaway::zynqmp_r5 {

enum class StartResult : std::uint8_t {
  running,
  node_refused,  // bare_metal::start_message says why
  rate_impossible,
  no_idle_bus,
  period_impossible,
};

constexpr std::string_view to_string(StartResult result) noexcept {
  switch (result) {
    case StartResult::running:
      return "running";
    case StartResult::node_refused:
      return "the node is refused";
    case StartResult::rate_impossible:
      return "the bit rate cannot be made of BREAKAWAY_CAN_HZ and be sampled at 85 to 90 % of a bit: choose one that "
             "divides it";
    case StartResult::no_idle_bus:
      return "the CAN controller has no clock or sees no 11 recessive bits: check clock and reset of the controller, "
             "pins, transceiver, wiring and termination";
    case StartResult::period_impossible:
      return "the period is no whole number of cycles of BREAKAWAY_CORE_HZ, or above 0.4 s, which the watchdog needs";
  }
  return "unknown start result";
}

// Starts the node, and says how that went, and what reset the system before, for a debugger to read.
template <class Node>
bool started(Node& node) noexcept {
  bare_metal::Memory system;
  const ResetCause cause = take_reset_cause(system);
  bare_metal::reset_message = to_string(cause).data();
  const StartResult result = node.start(cause);
  if (result != StartResult::node_refused) bare_metal::tell(to_string(result));
  return result == StartResult::running;
}

}  // namespace breakaway::zynqmp_r5
