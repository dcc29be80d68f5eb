// The controller node over slcan on USART1: what the image, and its twin for emulation, run.
#pragma once

#include "axis_config.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/slcan/port.hpp"
#include "clocks.hpp"
#include "ticker.hpp"
#include "usart.hpp"

namespace breakaway::stm32f405 {

inline constexpr std::uint32_t crystal_Hz = BREAKAWAY_CRYSTAL_HZ;
inline constexpr std::uint32_t baud = 1'000'000;

inline constinit Ticker ticker;
inline constinit Usart usart;

class SlcanNode {
 public:
  using Port = slcan::Port<Usart>;

  SlcanNode() noexcept : port_{usart, config::node.loop.bit_rate}, node_{port_, config::node} {}

  // False: the configuration or the clocks do not allow it; nothing runs then.
  bool start() noexcept {
    const Clocks clocks = start_clocks(crystal_Hz);
    return node_.setup_status().ok() && usart.start(clocks.apb2_Hz, baud) &&
           ticker.start(clocks.core_Hz, config::node.loop.period);
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
  firmware::ControlNode<Port> node_;
};

}  // namespace breakaway::stm32f405
