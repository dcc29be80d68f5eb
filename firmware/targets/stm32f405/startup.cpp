// Vector table and reset of the STM32F405 (RM0090, 12.2).
#include <array>
#include <cstdint>

#include "breakaway/bare_metal/memory_image.hpp"
#include "breakaway/bare_metal/mmio.hpp"
#include "reset_state.hpp"

void run_image();  // of each image; ISO C++ does not let anyone call main. It returns when it cannot run.

// A bootloader may enter here in any state of the core: with its own stack, priorities masked, and interrupts on.
asm(R"(
  .syntax unified
  .text
  .thumb
  .global reset_entry
  .thumb_func
  .type reset_entry, %function
reset_entry:
  cpsid i
  movs r0, #0
  msr control, r0
  msr basepri, r0
  msr faultmask, r0
  isb
  ldr r0, =image_stack_top
  mov sp, r0
  b reset_handler
  .ltorg
)");

extern "C" {

extern std::uint32_t image_stack_top[];
extern const std::uint32_t image_vectors[];
void reset_entry();

// A fault or an interrupt that nobody serves ends here: the bus falls silent, the drives' command deadline and
// heartbeat consumer take the torque off, and the watchdog, which nobody serves any more, resets the chip.
[[noreturn]] void halt() {
  asm volatile("cpsid i");
  for (;;) asm volatile("wfi");
}

[[gnu::weak]] void systick_handler() { halt(); }
[[gnu::weak]] void can_transmit_handler() { halt(); }
[[gnu::weak]] void can_receive_handler() { halt(); }
[[gnu::weak]] void usart1_handler() { halt(); }

[[noreturn]] void reset_handler() {
  breakaway::bare_metal::Memory chip;
  breakaway::stm32f405::take_interrupts(chip, reinterpret_cast<std::uintptr_t>(image_vectors));
  breakaway::stm32f405::reset_clocks(chip);
  breakaway::stm32f405::reset_peripherals(chip);
  constexpr std::uintptr_t coprocessor_access = 0xE000ED88;
  breakaway::bare_metal::set_bits(coprocessor_access, 0xFU << 20);  // the FPU, before the first float
  asm volatile("dsb\n isb" ::: "memory");
  breakaway::bare_metal::prepare_memory();
  asm volatile("cpsie i" ::: "memory");
  run_image();
  halt();
}

}  // extern "C"

namespace {

using Handler = void (*)();

struct VectorTable {
  std::uint32_t* stack_top;
  std::array<Handler, 15> exceptions;  // exception number n at n - 1
  std::array<Handler, 82> interrupts;
};

constexpr VectorTable make_vectors() {
  VectorTable table{image_stack_top, {}, {}};
  table.exceptions.fill(halt);
  table.interrupts.fill(halt);
  table.exceptions[0] = reset_entry;
  table.exceptions[14] = systick_handler;
  table.interrupts[19] = table.interrupts[63] = can_transmit_handler;  // of CAN1 and CAN2, of which a node uses one
  table.interrupts[20] = table.interrupts[64] = can_receive_handler;
  table.interrupts[37] = usart1_handler;
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable vectors = make_vectors();

}  // namespace
