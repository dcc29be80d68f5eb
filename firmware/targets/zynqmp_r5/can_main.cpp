#include "can_node.hpp"

void run_image() {
  using namespace breakaway::zynqmp_r5;
  static CanNode node;
  start_result = node.start();
  if (start_result != StartResult::running) return;
  for (;;) node.step(node.wait());
}
