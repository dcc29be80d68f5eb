#include "can_node.hpp"

void run_image() {
  using namespace breakaway::zynqmp_r5;
  static CanNode node;
  if (!started(node)) return;
  for (;;) {
    node.command(node.wait());
    node.sync(node.wait_for_sync());
  }
}
