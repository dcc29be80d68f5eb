// Tries all that the memory protection is to refuse, one after the other, and calls a function of the upper half of TCM
// B.
#include <cstddef>
#include <cstdint>

#include "memory_protection.hpp"
#include "semihosting.hpp"

extern "C" {

extern char image_stack_top[];

// The exit code: 0, or the number of the first attempt that was not refused, counted from 1; 100: the function failed.
[[noreturn]] void try_next();

// In place of what the flashed image does with a fault: the next attempt, on a stack that begins anew.
[[noreturn, gnu::naked]] void halt() { asm volatile("ldr sp, =image_stack_top\n b try_next"); }

// The linker script puts a section of this name there.
[[gnu::section(".upper_code"), gnu::noipa]] std::uint32_t of_upper_half(std::uint32_t value) { return value + 1; }

extern const std::uint32_t constant;
const std::uint32_t constant = 0xE12F'FF1E;  // bx lr
}

namespace {

volatile std::uint32_t data = 0;
volatile std::uint32_t attempts = 0;

void write_to(const volatile void* place) {
  *static_cast<volatile std::uint32_t*>(const_cast<void*>(place)) = constant;
}
void execute(const volatile void* place) { reinterpret_cast<void (*)()>(const_cast<void*>(place))(); }
void read_from(std::uintptr_t address) { static_cast<void>(*reinterpret_cast<volatile std::uint32_t*>(address)); }
const void* code(std::uint32_t (*function)(std::uint32_t)) { return reinterpret_cast<const void*>(function); }

// A fault with another cause, such as an undefined instruction, is none that the protection refused.
bool is_abort() {
  constexpr std::uint32_t mode_bits = 0x1F, abort_mode = 0x17, supervisor_mode = 0x13;
  std::uint32_t status;
  asm volatile("mrs %0, cpsr" : "=r"(status));
  const std::uint32_t mode = status & mode_bits;
  return mode == abort_mode || (mode == supervisor_mode && attempts == 0);
}

void attempt(std::uint32_t number) {
  volatile std::uint32_t on_stack = constant;
  switch (number) {
    case 1:
      return write_to(reinterpret_cast<const void*>(&try_next));
    case 2:
      return write_to(code(&of_upper_half));
    case 3:
      return write_to(&constant);
    case 4:
      return execute(&constant);
    case 5:
      return execute(&on_stack);
    case 6:
      data = constant;
      return execute(&data);
    case 7:
      return read_from(0x0003'0000);  // behind TCM B
    default:
      return read_from(0x0010'0000);  // DDR
  }
}

}  // namespace

void try_next() {
  constexpr std::uint32_t last = 8, failed = 100;
  if (!is_abort()) breakaway::emulated::exit_emulator(attempts);
  if (attempts == last) breakaway::emulated::exit_emulator(of_upper_half(41) == 42 ? 0 : failed);
  attempts = attempts + 1;
  attempt(attempts);
  breakaway::emulated::exit_emulator(attempts);
}

void run_image() {
  breakaway::zynqmp_r5::protect_memory();
  try_next();
}
