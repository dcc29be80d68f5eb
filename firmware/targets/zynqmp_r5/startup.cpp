// Vectors and reset of a Cortex-R5F (DDI 0406, B1.8). No interrupt is ever enabled: the loop polls.
#include <cstdint>

#include "breakaway/bare_metal/memory_image.hpp"

void run_image();  // of each image; ISO C++ does not let anyone call main. It returns when it cannot run.

// The addresses in the literal pool let an image lie anywhere, and the handlers out of a branch's reach. At reset the
// core may be in any state a loader left it in: interrupts are masked and the stack is set before the first C++
// instruction.
asm(R"(
  .section .vectors, "ax"
  .arm
  .global image_vectors
image_vectors:
  ldr pc, =reset_entry
  ldr pc, =halt
  ldr pc, =halt
  ldr pc, =halt
  ldr pc, =halt
  nop
  ldr pc, =halt
  ldr pc, =halt
  .ltorg
  .text
  .arm
  .global reset_entry
reset_entry:
  cpsid if, #0x13
  ldr sp, =image_stack_top
  b reset_handler
  .ltorg
)");

extern "C" {

// An exception ends here. The bus falls silent, the drives' command deadline and heartbeat consumer take the torque
// off, and the watchdog, which nobody serves any more, resets the processor.
[[noreturn, gnu::weak]] void halt() {
  asm volatile("cpsid if");
  for (;;) asm volatile("wfi");
}

[[noreturn]] void reset_handler() {
  // Exceptions enter at 0, in Arm state, whatever the loader set.
  constexpr std::uint32_t high_vectors = 1U << 13, thumb_exceptions = 1U << 30;
  std::uint32_t control;
  asm volatile("mrc p15, 0, %0, c1, c0, 0" : "=r"(control));
  asm volatile("mcr p15, 0, %0, c1, c0, 0\n isb" ::"r"(control & ~(high_vectors | thumb_exceptions)) : "memory");
  // Access to the FPU, then the FPU itself, before the first float: full compliance, so that it computes what IEEE 754
  // says also below the normal range.
  std::uint32_t access;
  asm volatile("mrc p15, 0, %0, c1, c0, 2" : "=r"(access));
  asm volatile("mcr p15, 0, %0, c1, c0, 2\n isb" ::"r"(access | 0xFU << 20));
  asm volatile("vmsr fpexc, %0" ::"r"(1U << 30));
  asm volatile("vmsr fpscr, %0" ::"r"(0));
  breakaway::bare_metal::prepare_memory();
  run_image();
  halt();
}

}  // extern "C"
