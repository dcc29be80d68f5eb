// The port under test: a started port on the model of a bxCAN controller, five seconds into its life.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "breakaway/bxcan/port.hpp"
#include "controller_model.hpp"

namespace breakaway::bxcan_test {

using namespace std::chrono_literals;
using hal::BitTiming;
using hal::BusState;
using hal::CanFrame;
using hal::ReceivedFrame;
using hal::SendResult;
using hal::Time;
using Port = bxcan::Port<ControllerModel>;

inline constexpr BitTiming timing{3, 11, 2};
inline constexpr std::uint32_t ewgf = 1, epvf = 2, boff = 4;

inline CanFrame frame_of(int id) {
  return {.id = static_cast<std::uint16_t>(id), .size = 2, .data = {0x12, static_cast<std::uint8_t>(id)}};
}

class BxcanPortTest : public ::testing::Test {
 protected:
  BxcanPortTest() {
    controller.transmit_interrupt = [this] { port.on_transmit_interrupt(); };
    EXPECT_TRUE(port.start(timing, 10));
    port.poll(now);
  }
  bool send(int id) { return send(id, now + 1ms); }
  bool send(int id, Time deadline) { return port.send(frame_of(id), deadline) == SendResult::queued; }
  std::vector<std::uint32_t> all_sent() {
    std::vector<std::uint32_t> ids;
    while (controller.requests() > 0) ids.push_back(controller.send_one().id);
    return ids;
  }
  std::vector<CanFrame> received() {
    port.on_receive_interrupt(now);
    std::vector<CanFrame> frames;
    for (ReceivedFrame r; port.receive(r);) frames.push_back(r.frame);
    return frames;
  }

  ControllerModel controller;
  Port port{controller};
  Time now{5s};
};

}  // namespace breakaway::bxcan_test
