// The controller node on a CAN controller of the processing system: what the image, and its twin for emulation, run.
#pragma once

#include <cstdint>
#include <type_traits>

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/bare_metal/start_message.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/xilinx_can/port.hpp"
#include "can_filters.hpp"
#include "flashed_node.hpp"
#include "memory_protection.hpp"
#include "reset_cause.hpp"
#include "start_result.hpp"
#include "ticker.hpp"
#include "watchdog.hpp"

namespace breakaway::zynqmp_r5 {

template <std::uintptr_t Base>
struct Peripheral {
  static std::uint32_t read(std::uint32_t offset) noexcept { return bare_metal::reg32(Base + offset); }
  static void write(std::uint32_t offset, std::uint32_t value) noexcept { bare_metal::reg32(Base + offset) = value; }
};
template <unsigned Controller>
using Can = Peripheral<0xFF06'0000 + 0x1'0000 * Controller>;
using SystemWatchdog = Peripheral<0xFF15'0000>;

inline constexpr std::uint32_t core_Hz = BREAKAWAY_CORE_HZ, can_Hz = BREAKAWAY_CAN_HZ,
                               watchdog_Hz = BREAKAWAY_WATCHDOG_HZ;

class CanNode {
 public:
  using Registers = Can<flashed::node.wiring.rpu_can_controller>;
  using Port = xilinx_can::Port<Registers>;

  CanNode() noexcept : port_{can_}, watchdog_{watchdog_registers_}, node_{port_, flashed::node} {}

  StartResult start(ResetCause cause) noexcept {
    protect_memory();
    bare_metal::tell(node_.verdict());
    if (!node_.verdict().ok()) return StartResult::node_refused;
    if (cause == ResetCause::watchdog) node_.note_watchdog_reset();
    const auto& network = flashed::node.loop.network;
    const auto timing = hal::bit_timing(can_Hz, network.bit_rate, xilinx_can::largest_prescaler);
    if (!timing) return StartResult::rate_impossible;
    constexpr Filters accepted = filters_for(flashed::node);
    if (!port_.start({*timing, network.bit_rate, accepted}, polls)) return StartResult::no_idle_bus;
    const bool started = ticker_.start(core_Hz, network.period) && watchdog_.start(watchdog_Hz, 3 * network.period);
    return started ? StartResult::running : StartResult::period_impossible;
  }

  // Once a period, one after the other. A period that is not over in time does not serve the watchdog.
  hal::Time wait() noexcept {
    return ticker_.wait([this](hal::Time now) { look_at_bus(now); });
  }
  void command(hal::Time now) noexcept {
    port_.poll(now);
    node_.command(now);
  }
  hal::Time wait_for_sync() noexcept {
    if (const auto due = node_.sync_due()) ticker_.wait_until(*due, [this](hal::Time now) { look_at_bus(now); });
    return ticker_.now();
  }
  void sync(hal::Time now) noexcept {
    node_.sync(now);
    if (ticker_.in_time()) watchdog_.serve();
  }

  // Whether the last step was over before the next was due.
  bool in_time() const noexcept { return ticker_.in_time(); }
  const Port& port() const noexcept { return port_; }

 private:
  // Some 100 ns a poll over the peripherals' bus: 100 ms, in which a bus at 10 kbit/s is idle for 11 bits many times.
  static constexpr std::uint32_t polls = 1'000'000;

  void look_at_bus(hal::Time now) noexcept {
    port_.poll(now);
    pause();
  }

  Registers can_;
  SystemWatchdog watchdog_registers_;
  Port port_;
  Watchdog<SystemWatchdog> watchdog_;
  firmware::ControlNode<Port, std::remove_const_t<decltype(flashed::node)>> node_;
  Ticker ticker_;
};

}  // namespace breakaway::zynqmp_r5
