// The clock tree of the STM32F405 (RM0090, chapters 5 to 7): 168 MHz from the crystal, or 16 MHz from the internal
// oscillator when the crystal or the PLL does not come up.
#pragma once

#include <cstdint>

namespace breakaway::stm32f405 {

struct Clocks {
  std::uint32_t core_Hz = 0;
  std::uint32_t apb1_Hz = 0;  // CAN
  std::uint32_t apb2_Hz = 0;  // USART1
  bool crystal = false;       // false: the internal oscillator, 1 % accurate at room temperature
};

// Every wait in it is bounded: it returns after about a tenth of a second at worst. crystal_Hz: 4 to 26 MHz, a whole
// number of MHz.
Clocks start_clocks(std::uint32_t crystal_Hz) noexcept;

}  // namespace breakaway::stm32f405
