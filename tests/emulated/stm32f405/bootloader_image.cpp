// A bootloader that tidies nothing away before it starts the image behind it: its interrupts are on and pending and go
// to its own vectors, priorities are masked, the core is on another stack.
#include <cstdint>

#include "breakaway/bare_metal/mmio.hpp"

extern "C" {
void systick_handler() {}
}

void run_image() {
  using breakaway::bare_metal::reg32;
  constexpr std::uintptr_t systick = 0xE000E010, nvic_enable = 0xE000E100, nvic_pend = 0xE000E200;
  constexpr std::uintptr_t image = 0x0801'0000;
  reg32(systick + 4) = 999;
  reg32(systick) = 0b111;
  asm volatile(
      "cpsid i\n"
      "msr basepri, %0\n"
      "mov r1, sp\n"
      "msr psp, r1\n"
      "movs r1, #2\n"
      "msr control, r1\n"
      "isb" ::"r"(0x10)
      : "r1", "memory");
  for (std::uintptr_t word = 0; word < 3; ++word) {
    reg32(nvic_pend + 4 * word) = 0xFFFF'FFFF;
    reg32(nvic_enable + 4 * word) = 0xFFFF'FFFF;
  }
  const std::uintptr_t entry = reg32(image + 4);
  asm volatile("bx %0" ::"r"(entry));
}
