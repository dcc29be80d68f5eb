// Why a node does not run.
#pragma once

#include <cstdint>
#include <string_view>

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/bare_metal/start_message.hpp"
#include "clocks.hpp"
#include "reset_cause.hpp"

namespace breakaway::stm32f405 {

enum class StartResult : std::uint8_t {
  running,
  running_on_internal,  // as well, without the crystal
  node_refused,         // bare_metal::start_message says why
  no_crystal,
  wrong_crystal,
  no_lock,
  rate_impossible,
  period_impossible,
  no_idle_bus,
  watchdog_impossible,
  line_too_slow,
};

constexpr std::string_view to_string(StartResult result) noexcept {
  switch (result) {
    case StartResult::running:
      return "running";
    case StartResult::running_on_internal:
      return "running from the internal oscillator, 1 % accurate: the crystal does not start, or is not of "
             "BREAKAWAY_CRYSTAL_HZ";
    case StartResult::node_refused:
      return "the node is refused";
    case StartResult::no_crystal:
      return "no crystal, and CAN needs one: check BREAKAWAY_CRYSTAL_HZ and the board";
    case StartResult::wrong_crystal:
      return "the crystal is more than a tenth off BREAKAWAY_CRYSTAL_HZ: build with the frequency that the board has";
    case StartResult::no_lock:
      return "the PLL does not lock, or the core does not take its clock: check the crystal and the supply";
    case StartResult::rate_impossible:
      return "the bit rate, or serial_baud, cannot be made of the clock: choose one that divides it";
    case StartResult::period_impossible:
      return "the period is longer than the tick timer counts: choose one below 99 ms";
    case StartResult::no_idle_bus:
      return "the CAN controller sees no 11 recessive bits: check transceiver, wiring and termination";
    case StartResult::watchdog_impossible:
      return "the independent watchdog does not take its time: its oscillator does not run, the chip is broken";
    case StartResult::line_too_slow:
      return "the frames of a period take longer than that on the serial line: raise serial_baud, or the period";
  }
  return "unknown start result";
}

constexpr bool is_running(StartResult result) noexcept {
  return result == StartResult::running || result == StartResult::running_on_internal;
}

constexpr StartResult without_crystal(Crystal crystal) noexcept {
  switch (crystal) {
    case Crystal::runs:
      return StartResult::running;
    case Crystal::none:
      return StartResult::no_crystal;
    case Crystal::wrong_frequency:
      return StartResult::wrong_crystal;
    case Crystal::no_lock:
      break;
  }
  return StartResult::no_lock;
}

// Starts the node, and says how that went, and what reset the chip before, for a debugger to read.
template <class Node>
bool started(Node& node) noexcept {
  bare_metal::Memory chip;
  const ResetCause cause = take_reset_cause(chip);
  bare_metal::reset_message = to_string(cause).data();
  const StartResult result = node.start(cause);
  if (result != StartResult::node_refused) bare_metal::tell(to_string(result));
  return is_running(result);
}

}  // namespace breakaway::stm32f405
