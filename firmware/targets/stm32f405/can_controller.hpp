// One of the two CAN controllers (RM0090, chapter 32). The first is the master of the second: it holds the filters of
// both, and its clock must run for either.
#pragma once

#include <cstdint>

#include "breakaway/bare_metal/mmio.hpp"
#include "breakaway/bxcan/registers.hpp"
#include "breakaway/firmware/wiring.hpp"
#include "pins.hpp"
#include "rcc.hpp"

namespace breakaway::stm32f405 {

template <unsigned Controller, bare_metal::Registers R = bare_metal::Memory>
class CanController {
  static_assert(Controller == 1 || Controller == 2);

 public:
  static constexpr unsigned transmit_interrupt = Controller == 1 ? 19 : 63, receive_interrupt = transmit_interrupt + 1;

  explicit CanController(R& chip) noexcept : chip_{&chip} {}

  std::uint32_t read(std::uint32_t offset) noexcept { return chip_->read(base_of(offset) + offset); }
  void write(std::uint32_t offset, std::uint32_t value) noexcept { chip_->write(base_of(offset) + offset, value); }
  void pend_transmit_interrupt() noexcept {
    constexpr std::uintptr_t nvic_pend = 0xE000E200;
    chip_->write(nvic_pend + 4 * (transmit_interrupt / 32), 1U << (transmit_interrupt % 32));
  }

  // Clock, filters, transceiver and pins; then its port may start.
  void connect(const firmware::Wiring& wiring) noexcept {
    constexpr std::uint32_t first_clock = 1U << 25, second_clock = 1U << 26;
    bare_metal::set_bits(*chip_, rcc::apb1_enable, Controller == 1 ? first_clock : first_clock | second_clock);
    if (Controller == 2) take_all_filters();
    drive_pin(*chip_, wiring.can_standby, wiring.can_awake);
    connect_pin(*chip_, wiring.can_receive, can_function);
    connect_pin(*chip_, wiring.can_transmit, can_function);
  }
  void enable_interrupts() noexcept {
    enable_interrupt(*chip_, transmit_interrupt);
    enable_interrupt(*chip_, receive_interrupt);
  }

 private:
  static constexpr std::uintptr_t first = 0x40006400, second = 0x40006800;

  static constexpr std::uintptr_t base_of(std::uint32_t offset) noexcept {
    return Controller == 1 || offset >= bxcan::reg::fmr ? first : second;
  }

  // The banks of the second controller begin at bank 0, the one that its port uses.
  void take_all_filters() noexcept {
    constexpr std::uint32_t first_bank_of_second = 0b11'1111U << 8;
    bare_metal::set_bits(*chip_, first + bxcan::reg::fmr, bxcan::bit::fmr_finit);
    bare_metal::change_bits(*chip_, first + bxcan::reg::fmr, first_bank_of_second, 0);
  }

  R* chip_;
};

}  // namespace breakaway::stm32f405
