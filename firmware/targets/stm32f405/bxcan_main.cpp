#include "bxcan_node.hpp"

namespace {

// For the interrupt handlers, which come once the node has started.
constinit breakaway::stm32f405::BxcanNode* active = nullptr;

}  // namespace

extern "C" {
void systick_handler() { breakaway::stm32f405::ticker.on_interrupt(); }
void can_transmit_handler() { active->port().on_transmit_interrupt(); }
void can_receive_handler() { active->port().on_receive_interrupt(breakaway::stm32f405::ticker.now()); }
}

void run_image() {
  using namespace breakaway::stm32f405;
  static BxcanNode node;
  active = &node;
  if (!started(node)) return;
  for (;;) node.step(ticker.wait());
}
