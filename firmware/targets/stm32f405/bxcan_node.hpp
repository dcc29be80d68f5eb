// The controller node on CAN1, PB8 (in) and PB9 (out).
#pragma once

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/bare_metal/start_message.hpp"
#include "breakaway/bxcan/port.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "clocks.hpp"
#include "flashed_node.hpp"
#include "pins.hpp"
#include "reset_cause.hpp"
#include "start_result.hpp"
#include "ticker.hpp"
#include "watchdog.hpp"

namespace breakaway::stm32f405 {

inline constinit Ticker ticker;

struct Can1 {
  static constexpr std::uintptr_t base = 0x40006400;
  static constexpr unsigned transmit_interrupt = 19, receive_interrupt = 20;

  static std::uint32_t read(std::uint32_t offset) noexcept { return bare_metal::reg32(base + offset); }
  static void write(std::uint32_t offset, std::uint32_t value) noexcept { bare_metal::reg32(base + offset) = value; }
  static void pend_transmit_interrupt() noexcept {
    constexpr std::uintptr_t nvic_pend = 0xE000E200;
    bare_metal::reg32(nvic_pend) = 1U << transmit_interrupt;
  }
};

class BxcanNode {
 public:
  using Port = bxcan::Port<Can1>;

  BxcanNode() noexcept : port_{registers_}, node_{port_, flashed::node} {}

  StartResult start(ResetCause cause) noexcept {
    bare_metal::tell(node_.verdict());
    if (!node_.verdict().ok()) return StartResult::node_refused;
    if (cause == ResetCause::watchdog) node_.note_watchdog_reset();
    const Clocks clocks = ClockTree{chip_}.start(BREAKAWAY_CRYSTAL_HZ);
    if (clocks.crystal != Crystal::runs) return without_crystal(clocks.crystal);
    const auto timing = hal::bit_timing(clocks.apb1_Hz, flashed::node.loop.network.bit_rate, bxcan::largest_prescaler);
    if (!timing) return StartResult::rate_impossible;
    connect();
    if (!port_.start(*timing, polls)) return StartResult::no_idle_bus;
    enable_interrupt(Can1::transmit_interrupt);
    enable_interrupt(Can1::receive_interrupt);
    const hal::Duration period = flashed::node.loop.network.period;
    if (!ticker.start(clocks.core_Hz, period)) return StartResult::period_impossible;
    if (!watchdog_.start(3 * period)) return StartResult::watchdog_impossible;
    return StartResult::running;
  }

  // Once a period. A step that takes longer than its period does not serve the watchdog.
  void step(hal::Time now) noexcept {
    port_.poll(now);
    node_.step(now);
    if (ticker.in_time()) watchdog_.serve();
  }

  Port& port() noexcept { return port_; }

 private:
  // Some 8 cycles a poll: 50 ms, in which a bus at 10 kbit/s is idle for 11 bits many times.
  static constexpr std::uint32_t polls = 1'000'000;

  static void connect() noexcept {
    constexpr std::uintptr_t rcc_apb1enr = 0x40023840;
    bare_metal::set_bits(rcc_apb1enr, 1U << 25);
    connect_pin(Gpio::b, 8, 9);
    connect_pin(Gpio::b, 9, 9);
  }

  bare_metal::Memory chip_;
  Watchdog<bare_metal::Memory> watchdog_{chip_};
  Can1 registers_;
  Port port_;
  firmware::ControlNode<Port, flashed::node.capacity> node_;
};

}  // namespace breakaway::stm32f405
