#include "usart.hpp"

#include "breakaway/bare_metal/mmio.hpp"
#include "pins.hpp"
#include "rcc.hpp"

namespace breakaway::stm32f405 {
namespace {

using bare_metal::reg32;

constexpr std::uintptr_t usart1 = 0x40011000;
constexpr std::uintptr_t status = usart1, data = usart1 + 0x04, baud_rate = usart1 + 0x08, control1 = usart1 + 0x0C;
constexpr std::uint32_t overrun = 1U << 3, not_empty = 1U << 5, transmit_empty = 1U << 7;

}  // namespace

bool Usart::start(std::uint32_t apb2_Hz, const firmware::Wiring& wiring) noexcept {
  const std::uint32_t baud = wiring.serial_baud;
  const std::uint32_t divider = (apb2_Hz + baud / 2) / baud;
  if (divider < 16 || divider > 0xFFFF) return false;
  const std::uint32_t made = apb2_Hz / divider;
  if (made > baud + baud / 50 || made < baud - baud / 50) return false;
  // A byte takes 10 bits of `divider` cycles of APB2, which is half the core clock, and a poll 8 cycles or more.
  polls_per_byte_ = 10 * divider;

  bare_metal::Memory chip;
  bare_metal::set_bits(chip, rcc::apb2_enable, 1U << 4);
  connect_pin(chip, wiring.serial_transmit, usart1_function);
  connect_pin(chip, wiring.serial_receive, usart1_function);
  constexpr std::uint32_t receive = 1U << 2, transmit = 1U << 3, interrupt_on_receive = 1U << 5, on = 1U << 13;
  reg32(baud_rate) = divider;
  reg32(control1) = on | interrupt_on_receive | transmit | receive;
  enable_interrupt(chip, interrupt_number);
  return true;
}

bool Usart::read(char& character) noexcept {
  const std::uint32_t next = read_.load(std::memory_order_relaxed);
  if (next == written_.load(std::memory_order_acquire)) return false;
  character = ring_[next % capacity];
  read_.store(next + 1, std::memory_order_release);
  return true;
}

bool Usart::write(std::span<const char> text) noexcept {
  if (!bare_metal::await_bits(status, transmit_empty, transmit_empty, polls_per_byte_)) return false;
  for (const char character : text) {
    reg32(data) = static_cast<std::uint8_t>(character);
    bare_metal::await_bits(status, transmit_empty, transmit_empty, polls_per_byte_);
  }
  return true;
}

void Usart::on_interrupt() noexcept {
  const std::uint32_t flags = reg32(status);
  if ((flags & (overrun | not_empty)) == 0) return;
  const char character = static_cast<char>(reg32(data));  // reading status, then data, clears both flags
  const std::uint32_t next = written_.load(std::memory_order_relaxed);
  const bool full = next - read_.load(std::memory_order_acquire) == capacity;
  if (full || (flags & overrun) != 0) lost_.fetch_add(1, std::memory_order_relaxed);
  if (full) return;
  ring_[next % capacity] = character;
  written_.store(next + 1, std::memory_order_release);
}

}  // namespace breakaway::stm32f405
