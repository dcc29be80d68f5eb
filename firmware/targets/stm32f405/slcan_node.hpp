// The controller node over slcan on USART1: what the image, and its twin for emulation, run.
#pragma once

#include <type_traits>

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/bare_metal/start_message.hpp"
#include "breakaway/cia402/pdo_layout.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/slcan/port.hpp"
#include "clocks.hpp"
#include "flashed_node.hpp"
#include "reset_cause.hpp"
#include "start_result.hpp"
#include "ticker.hpp"
#include "usart.hpp"
#include "watchdog.hpp"

namespace breakaway::stm32f405 {

inline constinit Ticker ticker;
inline constinit Usart usart;

// Whether the frames that leave in a period fit on the line: the axes' commands, SYNC, and one more of eight bytes. A
// frame is a letter, the identifier, the length, two digits a byte and the end; a character is ten bits.
constexpr bool fits_line(std::size_t axes, hal::Duration period, std::uint32_t baud) noexcept {
  constexpr std::size_t command = 6 + 2 * cia402::command_pdo(1).size_bytes(), sync = 6, acyclic = 6 + 2 * 8;
  const auto bits = static_cast<std::int64_t>(10 * (axes * command + sync + acyclic));
  return bits * 1'000'000 <= period / std::chrono::microseconds{1} * std::int64_t{baud};
}

class SlcanNode {
 public:
  using Port = slcan::Port<Usart>;

  [[gnu::cold]] SlcanNode() noexcept : port_{usart, flashed::node.loop.network.bit_rate}, node_{port_, flashed::node} {}

  [[gnu::cold]] StartResult start(ResetCause cause) noexcept {
    bare_metal::tell(node_.verdict());
    if (!node_.verdict().ok()) return StartResult::node_refused;
    if (cause == ResetCause::watchdog) node_.note_watchdog_reset();
    const hal::Duration period = flashed::node.loop.network.period;
    if (!fits_line(flashed::node.count, period, flashed::node.wiring.serial_baud)) return StartResult::line_too_slow;
    // A serial line bears the 1 % of the internal oscillator.
    const Clocks clocks = ClockTree{chip_}.start(BREAKAWAY_CRYSTAL_HZ);
    if (!usart.start(clocks.apb2_Hz, flashed::node.wiring)) return StartResult::rate_impossible;
    if (!ticker.start(clocks.core_Hz, period)) return StartResult::period_impossible;
    if (!watchdog_.start(3 * period)) return StartResult::watchdog_impossible;
    return clocks.crystal == Crystal::runs ? StartResult::running : StartResult::running_on_internal;
  }

  // Once a period, one after the other. A period that is not over in time does not serve the watchdog. SYNC waits for
  // nothing: when it gets onto the bus is up to the line and the adapter.
  void step(hal::Time now) noexcept {
    port_.poll(now);
    node_.step(now);
  }
  void send(hal::Time now) noexcept {
    port_.flush(now);
    if (ticker.in_time()) watchdog_.serve();
  }

  Port& port() noexcept { return port_; }

 private:
  bare_metal::Memory chip_;
  Watchdog<bare_metal::Memory> watchdog_{chip_};
  Port port_;
  firmware::ControlNode<Port, std::remove_const_t<decltype(flashed::node)>> node_;
};

}  // namespace breakaway::stm32f405
