#include "breakaway/socketcan/frames.hpp"

#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <random>

namespace {

using namespace std::chrono_literals;
using namespace breakaway::socketcan;
using breakaway::hal::BusState;
using breakaway::hal::CanFrame;
using breakaway::hal::Time;

can_frame error(canid_t classes, std::uint8_t controller = 0) {
  can_frame frame{};
  frame.can_id = CAN_ERR_FLAG | classes;
  frame.can_dlc = CAN_ERR_DLC;
  frame.data[1] = controller;
  return frame;
}

TEST(SocketcanFrames, EveryFrameComesBackAsItWas) {
  std::mt19937 random{1};
  for (int n = 0; n < 10'000; ++n) {
    CanFrame frame{.id = static_cast<std::uint16_t>(random() & 0x7FFU),
                   .size = static_cast<std::uint8_t>(random() % 9),
                   .remote = random() % 8 == 0};
    for (std::size_t i = 0; i < frame.size && !frame.remote; ++i) frame.data[i] = static_cast<std::uint8_t>(random());
    EXPECT_EQ(from_kernel(to_kernel(frame)), frame);
  }
}

TEST(SocketcanFrames, ARemoteRequestCarriesItsFlagAndNoData) {
  const can_frame out = to_kernel({.id = 0x701, .size = 1, .remote = true, .data = {0xAA}});
  EXPECT_EQ(out.can_id, 0x701U | CAN_RTR_FLAG);
  EXPECT_EQ(out.can_dlc, 1);
  EXPECT_EQ(out.data[0], 0);
}

TEST(SocketcanFrames, ErrorFramesAndLongIdentifiersAreNoFrames) {
  EXPECT_FALSE(from_kernel(error(CAN_ERR_BUSOFF)));
  can_frame extended{};
  extended.can_id = 0x181U | CAN_EFF_FLAG;
  EXPECT_FALSE(from_kernel(extended));
}

TEST(SocketcanFrames, ALengthAboveEightIsCut) {
  can_frame frame{};
  frame.can_dlc = 15;
  EXPECT_EQ(from_kernel(frame)->size, 8);
}

struct Row {
  const char* label;
  can_frame frame;
  std::optional<BusState> state;
  bool overflow;
};

TEST(SocketcanFrames, ErrorFramesSayWhatBecameOfTheController) {
  const Row rows[] = {
      {"bus-off", error(CAN_ERR_BUSOFF), BusState::bus_off, false},
      {"bus-off beats what else is said", error(CAN_ERR_BUSOFF | CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE), BusState::bus_off,
       false},
      {"restarted", error(CAN_ERR_RESTARTED), BusState::error_active, false},
      {"active again", error(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE), BusState::error_active, false},
      {"warning, receiving", error(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING), BusState::error_warning, false},
      {"warning, sending", error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING), BusState::error_warning, false},
      {"passive beats warning", error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE | CAN_ERR_CRTL_RX_WARNING),
       BusState::error_passive, false},
      {"overflow, receiving", error(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW), std::nullopt, true},
      {"overflow, sending", error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_OVERFLOW), std::nullopt, true},
      {"controller without details", error(CAN_ERR_CRTL), std::nullopt, false},
      {"details of another class", error(CAN_ERR_PROT, CAN_ERR_CRTL_TX_PASSIVE), std::nullopt, false},
  };
  for (const Row& row : rows) {
    const ErrorReport report = error_report(row.frame);
    EXPECT_EQ(report.state, row.state) << row.label;
    EXPECT_EQ(report.overflow, row.overflow) << row.label;
  }
  can_frame data = error(CAN_ERR_BUSOFF);
  data.can_id &= ~CAN_ERR_FLAG;
  EXPECT_FALSE(error_report(data).state) << "a data frame whose identifier has that bit";
}

TEST(SocketcanFrames, AStampKeepsItsAgeOnTheOtherClock) {
  EXPECT_EQ(on_monotonic_clock(Time{1'000'000s}, Time{1'000'000s + 30us}, Time{50s}, Time{49s}), Time{50s - 30us});
}

TEST(SocketcanFrames, AStampMayBeAsOldAsTheEarliestTime) {
  EXPECT_EQ(on_monotonic_clock(Time{1'000'000s}, Time{1'000'600s}, Time{650s}, Time{50s}), Time{50s});
  EXPECT_EQ(on_monotonic_clock(Time{1'000'000s}, Time{1'000'600s + 1ns}, Time{650s}, Time{50s}), Time{650s});
}

TEST(SocketcanFrames, AStampThatTheWallClockLeftBehindBecomesNow) {
  EXPECT_EQ(on_monotonic_clock(Time{1'000'001s}, Time{1'000'000s}, Time{50s}, Time{49s}), Time{50s});
  EXPECT_EQ(on_monotonic_clock(Time{1'000'000s}, Time{1'003'600s}, Time{50s}, Time{49s}), Time{50s});
}

}  // namespace
