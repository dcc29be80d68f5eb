#include "slcan_node.hpp"

extern "C" {
void systick_handler() { breakaway::stm32f405::ticker.on_interrupt(); }
void usart1_handler() { breakaway::stm32f405::usart.on_interrupt(); }
}

void run_image() {
  using namespace breakaway::stm32f405;
  static SlcanNode node;
  if (!started(node)) return;
  for (;;) {
    const breakaway::hal::Time now = ticker.wait();
    node.step(now);
    node.send(now);
  }
}
