// The controller node over slcan as it is flashed, but for its time: the tick is held from the end of a step until the
// adapter has answered it. The rest of the world may then take as long as it likes, and every run gives the same bits.
#include "slcan_node.hpp"

extern "C" {
void systick_handler() { breakaway::stm32f405::ticker.on_interrupt(); }
void usart1_handler() { breakaway::stm32f405::usart.on_interrupt(); }

// Marks between which an emulator counts instructions.
[[gnu::noinline]] void count_begin() { asm volatile("" ::: "memory"); }
[[gnu::noinline]] void count_end() { asm volatile("" ::: "memory"); }
}

void run_image() {
  using namespace breakaway::stm32f405;
  static SlcanNode node;
  if (!started(node)) return;
  for (;;) {
    ticker.hold();
    while (node.port().awaits_answer()) node.port().poll(ticker.next());
    ticker.resume();
    const breakaway::hal::Time now = ticker.wait();
    count_begin();
    node.step(now);
    count_end();
    node.send(now);
  }
}
