#include "slcan_node.hpp"

extern "C" {
void systick_handler() { breakaway::stm32f405::ticker.on_interrupt(); }
void usart1_handler() { breakaway::stm32f405::usart.on_interrupt(); }
}

void run_image() {
  static breakaway::stm32f405::SlcanNode node;
  if (!node.start()) return;
  for (;;) {
    const breakaway::hal::Time now = breakaway::stm32f405::ticker.wait();
    node.step(now);
    node.send(now);
  }
}
