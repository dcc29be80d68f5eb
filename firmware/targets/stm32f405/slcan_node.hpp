// The controller node over slcan on USART1: what the image, and its twin for emulation, run.
#pragma once

#include "breakaway/bare_metal/start_message.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/slcan/port.hpp"
#include "clocks.hpp"
#include "flashed_node.hpp"
#include "start_result.hpp"
#include "ticker.hpp"
#include "usart.hpp"

namespace breakaway::stm32f405 {

inline constexpr std::uint32_t baud = 1'000'000;

inline constinit Ticker ticker;
inline constinit Usart usart;

class SlcanNode {
 public:
  using Port = slcan::Port<Usart>;

  SlcanNode() noexcept : port_{usart, flashed::node.loop.network.bit_rate}, node_{port_, flashed::node} {}

  StartResult start() noexcept {
    bare_metal::tell(node_.verdict());
    if (!node_.verdict().ok()) return StartResult::node_refused;
    // A serial line bears the 1 % of the internal oscillator.
    const Clocks clocks = start_clocks(BREAKAWAY_CRYSTAL_HZ);
    if (!usart.start(clocks.apb2_Hz, baud)) return StartResult::rate_impossible;
    return ticker.start(clocks.core_Hz, flashed::node.loop.network.period) ? StartResult::running
                                                                           : StartResult::period_impossible;
  }

  // Once a period, one after the other.
  void step(hal::Time now) noexcept {
    port_.poll(now);
    node_.step(now);
  }
  void send(hal::Time now) noexcept { port_.flush(now); }

  Port& port() noexcept { return port_; }

 private:
  Port port_;
  firmware::ControlNode<Port, flashed::node.capacity> node_;
};

}  // namespace breakaway::stm32f405
