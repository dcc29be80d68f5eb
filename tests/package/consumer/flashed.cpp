// A user of what is flashed alone: a controller node on a bus in memory, and a client that talks to a drive.
#include <breakaway/canopen/cob_id.hpp>
#include <breakaway/canopen/sdo_client.hpp>
#include <breakaway/firmware/control_node.hpp>
#include <breakaway/virtual_bus/virtual_bus.hpp>
#include <chrono>
#include <iostream>

int main() {
  using namespace breakaway;
  virtual_bus::VirtualBus bus{{}};
  auto& port = bus.add_port();
  const firmware::FlashedNode<float, 1> blank{};
  firmware::ControlNode node{port, blank};
  std::cout << to_string(node.verdict().error) << '\n';

  constexpr std::uint8_t drive_id = 5;
  canopen::SdoClient client{drive_id, std::chrono::milliseconds{10}};
  hal::CanFrame request;
  const bool asked = client.start_read(0x1000, 0) == canopen::SdoStart::started && client.next_frame(request, {});
  return !node.verdict().ok() && asked && request.id == canopen::sdo_request_cob_id(drive_id) ? 0 : 1;
}
