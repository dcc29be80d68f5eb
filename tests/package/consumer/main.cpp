#include <breakaway/canopen/sdo_client.hpp>
#include <breakaway/law/k3_table.hpp>
#include <chrono>
#include <iostream>

int main() {
  // R = 2 N s / sqrt(m) everywhere: 0.25 m from the target, the impulse is 2 sqrt(0.25) = 1 N s towards it.
  const breakaway::law::K3Table<float, 2> table{.root_max = 1, .nodes_per_root = 1, .nodes = {{{2, 0}, {2, 0}}}};
  const float impulse_Ns = table.impulse_Ns(0.25F);

  breakaway::canopen::SdoClient client(5, std::chrono::milliseconds{10});
  breakaway::hal::CanFrame request;
  const bool sent = client.start_read(0x1000, 0).ok() && client.next_frame(request, {});

  std::cout << "impulse " << impulse_Ns << " N s, request to " << std::hex << request.id << "h\n";
  return impulse_Ns == -1 && sent && request.id == 0x605 ? 0 : 1;
}
