// The port that takes commands out of what another one receives, the bytes on the bus, and what is so unless told.
#include <gtest/gtest.h>

#include <set>
#include <string_view>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/firmware/flashed_node.hpp"
#include "breakaway/firmware/remote_control.hpp"
#include "breakaway/firmware/served_port.hpp"
#include "fake_axis.hpp"
#include "listed_port.hpp"

namespace breakaway::firmware::remote_port {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t node = 0x7F;

TEST(RemoteBytes, HoldEveryWishForItself) {
  for (unsigned wishes = 0; wishes < 8; ++wishes) {
    const MotionCommand command{.axis = 1,
                                .enable = (wishes & 1U) != 0,
                                .reset_fault = (wishes & 2U) != 0,
                                .reference = (wishes & 4U) != 0,
                                .target_counts = -2};
    const hal::CanFrame frame = encode_command(command, node);
    EXPECT_EQ(frame.data,
              (std::array<std::uint8_t, 8>{1, static_cast<std::uint8_t>(wishes), 0, 0, 0xFE, 0xFF, 0xFF, 0xFF}));
    const auto decoded = decode_command(frame, node);
    ASSERT_TRUE(decoded.has_value());
    EXPECT_EQ(decoded->enable, command.enable);
    EXPECT_EQ(decoded->reset_fault, command.reset_fault);
    EXPECT_EQ(decoded->reference, command.reference);
  }
}

TEST(CommandedPort, IsThePortBehindItInEverythingElse) {
  testing::FakePort behind;
  CommandedPort<testing::FakePort, 2> port{behind, node};
  EXPECT_EQ(port.send({.id = 1}, hal::Time{7s}), hal::SendResult::queued);
  EXPECT_EQ(behind.deadlines, std::vector<hal::Time>{hal::Time{7s}});
  behind.full = true;
  EXPECT_EQ(port.send({.id = 1}, hal::Time{7s}), hal::SendResult::queue_full);
  for (const hal::BusState state :
       {hal::BusState::error_active, hal::BusState::error_warning, hal::BusState::bus_off}) {
    behind.state = state;
    EXPECT_EQ(port.bus_state(), state);
  }
  port.purge_transmit_queue();
  EXPECT_EQ(behind.purges, 1);
}

struct LoopOfOne {
  struct AxisId {
    std::size_t index() const noexcept { return 1; }
  };
  struct ShownDrive {
    std::int32_t position_counts() const noexcept { return -70'000; }
  };
  AxisStatus<float> shown{};
  ShownDrive shown_drive{};
  const AxisStatus<float>& status(AxisId) const noexcept { return shown; }
  const ShownDrive& drive(AxisId) const noexcept { return shown_drive; }
};

TEST(RemoteBytes, TellTheStateAndThePositionOfAnAxis) {
  LoopOfOne loop;
  loop.shown.fault = AxisFault::emergency;
  loop.shown.output.mode = law::Mode::hold;
  loop.shown.feedback.state = hal::DriveState::fault;
  const hal::CanFrame frame = status_frame(loop, LoopOfOne::AxisId{}, node);
  EXPECT_EQ(frame.id, canopen::tpdo_cob_id(1, node));
  EXPECT_EQ(frame.data[0], 1);
  EXPECT_EQ(frame.data[1], static_cast<std::uint8_t>(AxisFault::emergency));
  EXPECT_EQ(frame.data[2], static_cast<std::uint8_t>(law::Mode::hold));
  EXPECT_EQ(frame.data[3], static_cast<std::uint8_t>(hal::DriveState::fault));
  ASSERT_NE(frame.data[2], frame.data[3]) << "or the two could be mixed up";
  EXPECT_EQ(canopen::load_little_endian<std::int32_t>(frame.data, 4), -70'000);
  const auto told = decode_status(frame, node);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->axis, 1);
  EXPECT_EQ(told->fault, frame.data[1]);
  EXPECT_EQ(told->mode, frame.data[2]);
  EXPECT_EQ(told->drive_state, frame.data[3]);
  EXPECT_EQ(told->position_counts, -70'000);
}

TEST(RemoteBytes, OtherFramesTellOfNoAxis) {
  hal::CanFrame frame{.id = canopen::tpdo_cob_id(1, node), .size = 8};
  EXPECT_TRUE(decode_status(frame, node));
  EXPECT_FALSE(decode_status(frame, node - 1));
  frame.size = 7;
  EXPECT_FALSE(decode_status(frame, node));
  frame.size = 8;
  frame.remote = true;
  EXPECT_FALSE(decode_status(frame, node));
}

TEST(NodeErrors, HaveASentenceEach) {
  std::set<std::string_view> texts;
  int count = 0;
  for (; to_string(static_cast<NodeError>(count)) != "unknown node error"; ++count) {
    texts.insert(to_string(static_cast<NodeError>(count)));
    ASSERT_LT(count, 100);
  }
  EXPECT_EQ(count, static_cast<int>(NodeError::axes_stop_apart) + 1);
  EXPECT_EQ(static_cast<int>(texts.size()), count) << "none is said twice";
  EXPECT_FALSE(texts.contains(""));
}

// Notes what is asked of it.
struct AskedPort : ListedPort {
  int purges = 0;
  hal::BusState state = hal::BusState::bus_off;
  void purge_transmit_queue() noexcept { ++purges; }
  hal::BusState bus_state() const noexcept { return state; }
};

TEST(ServedPort, PassesOnWhatItIsAskedOfTheBus) {
  AskedPort port;
  ServedPort<AskedPort> served{port, node};
  served.purge_transmit_queue();
  EXPECT_EQ(port.purges, 1);
  for (const hal::BusState state :
       {hal::BusState::bus_off, hal::BusState::error_active, hal::BusState::error_passive}) {
    port.state = state;
    EXPECT_EQ(served.bus_state(), state);
  }
}

TEST(FlashedDefaults, CertifyNothingAndGiveACommanderHalfASecond) {
  EXPECT_FALSE(FlashedAxis<float>{}.certified);
  EXPECT_EQ(LoopConfig{}.command_timeout, 500ms);
}

}  // namespace
}  // namespace breakaway::firmware::remote_port
