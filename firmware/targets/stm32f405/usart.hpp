// USART1 as a byte stream (RM0090, chapter 30). Reception by interrupt into a ring;
// transmission waits for each byte, and for no more than a few times as long as a byte takes.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "breakaway/firmware/wiring.hpp"

namespace breakaway::stm32f405 {

class Usart {
 public:
  static constexpr unsigned interrupt_number = 37;

  // False: this baud rate cannot be made from that clock within 2 %.
  bool start(std::uint32_t apb2_Hz, const firmware::Wiring& wiring) noexcept;

  // For the loop.
  bool read(char& character) noexcept;
  bool write(std::span<const char> text) noexcept;
  // Bytes lost because the ring was full, or by the hardware because the interrupt came too late.
  std::uint32_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

  // For the interrupt handler.
  void on_interrupt() noexcept;

 private:
  std::uint32_t polls_per_byte_ = 0;
  static constexpr std::size_t capacity = 1024;  // the longest a line can say in 10 ms at 1 Mbaud
  std::array<char, capacity> ring_{};
  std::atomic<std::uint32_t> written_{0}, read_{0}, lost_{0};
};

}  // namespace breakaway::stm32f405
