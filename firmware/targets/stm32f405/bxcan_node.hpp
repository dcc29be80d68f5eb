// The controller node on CAN1 or CAN2, as the node's file says.
#pragma once

#include <type_traits>

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/bare_metal/start_message.hpp"
#include "breakaway/bxcan/port.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "can_controller.hpp"
#include "clocks.hpp"
#include "flashed_node.hpp"
#include "reset_cause.hpp"
#include "start_result.hpp"
#include "ticker.hpp"
#include "watchdog.hpp"

namespace breakaway::stm32f405 {

inline constinit Ticker ticker;

using Can = CanController<flashed::node.wiring.can_controller>;

class BxcanNode {
 public:
  using Port = bxcan::Port<Can>;

  [[gnu::cold]] BxcanNode() noexcept : port_{can_}, node_{port_, flashed::node} {}

  [[gnu::cold]] StartResult start(ResetCause cause) noexcept {
    bare_metal::tell(node_.verdict());
    if (!node_.verdict().ok()) return StartResult::node_refused;
    if (cause == ResetCause::watchdog) node_.note_watchdog_reset();
    const Clocks clocks = ClockTree{chip_}.start(BREAKAWAY_CRYSTAL_HZ);
    if (clocks.crystal != Crystal::runs) return without_crystal(clocks.crystal);
    const auto timing = hal::bit_timing(clocks.apb1_Hz, flashed::node.loop.network.bit_rate, bxcan::largest_prescaler);
    if (!timing) return StartResult::rate_impossible;
    can_.connect(flashed::node.wiring);
    if (!port_.start(*timing, polls)) return StartResult::no_idle_bus;
    can_.enable_interrupts();
    const hal::Duration period = flashed::node.loop.network.period;
    if (!ticker.start(clocks.core_Hz, period)) return StartResult::period_impossible;
    if (!watchdog_.start(3 * period)) return StartResult::watchdog_impossible;
    return StartResult::running;
  }

  // Once a period. SYNC waits for its time, which interrupts may use. A step that takes longer than its period does not
  // serve the watchdog.
  void step(hal::Time now) noexcept {
    port_.poll(now);
    node_.command(now);
    if (const auto due = node_.sync_due()) ticker.wait_until(*due);
    node_.sync(ticker.now());
    if (ticker.in_time()) watchdog_.serve();
  }

  Port& port() noexcept { return port_; }

 private:
  // Some 8 cycles a poll: 50 ms, in which a bus at 10 kbit/s is idle for 11 bits many times.
  static constexpr std::uint32_t polls = 1'000'000;

  bare_metal::Memory chip_;
  Watchdog<bare_metal::Memory> watchdog_{chip_};
  Can can_{chip_};
  Port port_;
  firmware::ControlNode<Port, std::remove_const_t<decltype(flashed::node)>> node_;
};

}  // namespace breakaway::stm32f405
