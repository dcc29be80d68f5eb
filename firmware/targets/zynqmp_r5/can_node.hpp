// The controller node on a CAN controller of the processing system: what the image, and its twin for emulation, run.
#pragma once

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/xilinx_can/port.hpp"
#include "memory_protection.hpp"
#include "node_config.hpp"
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
  using Registers = Can<BREAKAWAY_CAN_CONTROLLER>;
  using Port = xilinx_can::Port<Registers>;

  CanNode() noexcept : port_{can_}, watchdog_{watchdog_registers_}, node_{port_, flashed::node} {}

  StartResult start() noexcept {
    protect_memory();
    if (is_refused(node_)) return StartResult::configuration_refused;
    const auto& loop = flashed::node.loop;
    const auto timing = hal::bit_timing(can_Hz, loop.bit_rate, xilinx_can::largest_prescaler);
    if (!timing) return StartResult::rate_impossible;
    if (!port_.start({*timing, loop.bit_rate, accepted}, polls)) return StartResult::no_idle_bus;
    const bool started = ticker_.start(core_Hz, loop.period) && watchdog_.start(watchdog_Hz, 3 * loop.period);
    return started ? StartResult::running : StartResult::period_impossible;
  }

  // Once a period, one after the other. A step that takes longer than its period does not serve the watchdog.
  hal::Time wait() noexcept {
    return ticker_.wait([this](hal::Time now) {
      port_.poll(now);
      pause();
    });
  }
  void step(hal::Time now) noexcept {
    port_.poll(now);
    node_.step(now);
    if (ticker_.in_time()) watchdog_.serve();
  }

  // Whether the last step was over before the next was due.
  bool in_time() const noexcept { return ticker_.in_time(); }
  const Port& port() const noexcept { return port_; }

 private:
  // Some 100 ns a poll over the peripherals' bus: 100 ms, in which a bus at 10 kbit/s is idle for 11 bits many times.
  static constexpr std::uint32_t polls = 1'000'000;

  // All that the drive says, whatever the function, and the commands for this node: the rest stays out of the FIFO.
  static constexpr std::array<std::optional<xilinx_can::Filter>, xilinx_can::filters> accepted{
      xilinx_can::Filter{canopen::node_id_mask, flashed::node.drive.node_id},
      xilinx_can::Filter{0x7FF, canopen::rpdo_cob_id(1, flashed::node.loop.node_id)}};

  Registers can_;
  SystemWatchdog watchdog_registers_;
  Port port_;
  Watchdog<SystemWatchdog> watchdog_;
  firmware::ControlNode<Port> node_;
  Ticker ticker_;
};

}  // namespace breakaway::zynqmp_r5
