// Outgrows its stack, and tells whether that faulted where the TCM ends.
#include "memory_protection.hpp"
#include "semihosting.hpp"

extern "C" {

extern char image_stack_top[], image_stack_bottom[];

enum ExitCode : std::uint32_t { faulted_below_the_stack = 0, no_fault = 1, faulted_elsewhere = 2 };

// In place of what the flashed image does with a fault. The stack is of no more use, so it begins anew.
[[noreturn]] void report_fault() {
  std::uint32_t address;
  asm volatile("mrc p15, 0, %0, c6, c0, 0" : "=r"(address));
  const std::uint32_t bottom = reinterpret_cast<std::uint32_t>(image_stack_bottom);
  breakaway::emulated::exit_emulator(address < bottom && bottom - address <= 64 ? faulted_below_the_stack
                                                                                : faulted_elsewhere);
}
[[noreturn, gnu::naked]] void halt() { asm volatile("ldr sp, =image_stack_top\n b report_fault"); }
}

namespace {

[[gnu::noinline]] int descend(volatile int* above) {
  volatile int here[4] = {*above + 1};
  return here[0] > 10'000 ? here[0] : descend(here) + here[1];
}

}  // namespace

void run_image() {
  breakaway::zynqmp_r5::protect_memory();
  volatile int depth = 0;
  breakaway::emulated::exit_emulator(descend(&depth) > 0 ? no_fault : faulted_elsewhere);
}
