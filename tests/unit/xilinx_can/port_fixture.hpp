// The port under test: a started port on the model of an AXI or Zynq CAN controller, five seconds into its life.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "breakaway/xilinx_can/port.hpp"
#include "controller_model.hpp"

namespace breakaway::xilinx_can_test {

using namespace std::chrono_literals;
using hal::BusState;
using hal::CanFrame;
using hal::ReceivedFrame;
using hal::SendResult;
using hal::Time;
using xilinx_can::BusSettings;
using xilinx_can::Filter;
using Port = xilinx_can::Port<ControllerModel>;

inline constexpr BusSettings settings{{10, 7, 2}, 1'000'000, {}};

inline CanFrame frame_of(int id) {
  return {.id = static_cast<std::uint16_t>(id), .size = 2, .data = {0x12, static_cast<std::uint8_t>(id)}};
}

class XilinxCanPortTest : public ::testing::Test {
 protected:
  XilinxCanPortTest() {
    EXPECT_TRUE(port.start(settings, 10));
    port.poll(now);
  }
  bool send(int id) { return port.send(frame_of(id), now + 1ms) == SendResult::queued; }
  std::vector<std::uint32_t> all_sent() {
    std::vector<std::uint32_t> ids;
    while (controller.waiting() > 0) ids.push_back(controller.send_one().id);
    return ids;
  }
  std::vector<CanFrame> received() {
    port.poll(now);
    std::vector<CanFrame> frames;
    for (ReceivedFrame r; port.receive(r);) frames.push_back(r.frame);
    return frames;
  }
  void pass_until_bus_off() {
    while (port.bus_state() != BusState::bus_off) controller.disturb_sending();
  }

  ControllerModel controller;
  Port port{controller};
  Time now{5s};
};

}  // namespace breakaway::xilinx_can_test
