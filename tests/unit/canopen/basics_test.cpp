// Identifiers, byte order, NMT, heartbeat, EMCY.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <utility>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/heartbeat.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sync.hpp"

namespace {

using namespace std::chrono_literals;
using namespace breakaway::canopen;
using breakaway::hal::CanFrame;
using breakaway::hal::Time;

TEST(CobId, FollowsThePredefinedConnectionSet) {
  EXPECT_EQ(emcy_cob_id(5), 0x085);
  EXPECT_EQ(tpdo_cob_id(1, 5), 0x185);
  EXPECT_EQ(tpdo_cob_id(4, 127), 0x4FF);
  EXPECT_EQ(rpdo_cob_id(1, 5), 0x205);
  EXPECT_EQ(rpdo_cob_id(4, 1), 0x501);
  EXPECT_EQ(sdo_response_cob_id(5), 0x585);
  EXPECT_EQ(sdo_request_cob_id(5), 0x605);
  EXPECT_EQ(heartbeat_cob_id(127), 0x77F);
  EXPECT_EQ(sync_frame(), (CanFrame{.id = 0x080}));
}

TEST(Sync, IsADataFrame) {
  EXPECT_TRUE(is_sync(sync_frame()));
  EXPECT_FALSE(is_sync({.id = 0x080, .remote = true}));
  EXPECT_FALSE(is_sync({.id = 0x081}));
}

TEST(CobId, FallsApartIntoFunctionCodeAndNode) {
  for (unsigned id = min_node_id; id <= max_node_id; ++id) {
    const auto node_id = static_cast<std::uint8_t>(id);
    ASSERT_TRUE(is_node_id(node_id));
    for (const auto& [cob_id, function] : {std::pair<std::uint16_t, unsigned>{emcy_cob_id(node_id), 0x080},
                                           {tpdo_cob_id(1, node_id), 0x180},
                                           {rpdo_cob_id(1, node_id), 0x200},
                                           {tpdo_cob_id(4, node_id), 0x480},
                                           {rpdo_cob_id(4, node_id), 0x500},
                                           {sdo_response_cob_id(node_id), 0x580},
                                           {sdo_request_cob_id(node_id), 0x600},
                                           {heartbeat_cob_id(node_id), 0x700}}) {
      ASSERT_EQ(function_code_of(cob_id), function) << id;
      ASSERT_EQ(node_id_of(cob_id), id) << function;
    }
  }
  EXPECT_EQ(node_id_of(nmt_cob_id), 0);
  EXPECT_EQ(node_id_of(sync_cob_id), 0);
  EXPECT_FALSE(is_node_id(0) || is_node_id(128) || is_node_id(255));
  EXPECT_EQ(function_code_mask | node_id_mask, CanFrame::max_id);
}

TEST(Bytes, LeastSignificantFirst) {
  std::array<std::uint8_t, 8> bytes{};
  store_little_endian(bytes, std::uint32_t{0x12345678}, 2);
  EXPECT_EQ(bytes, (std::array<std::uint8_t, 8>{0, 0, 0x78, 0x56, 0x34, 0x12, 0, 0}));
  EXPECT_EQ(load_little_endian<std::uint16_t>(bytes, 3), 0x3456);
}

TEST(Bytes, SignedValuesSurvive) {
  std::array<std::uint8_t, 4> bytes{};
  for (const std::int32_t value : {0, 1, -1, std::numeric_limits<std::int32_t>::min(), 0x7FFFFFFF}) {
    store_little_endian(bytes, value);
    EXPECT_EQ(load_little_endian<std::int32_t>(bytes), value);
  }
  store_little_endian(bytes, std::int16_t{-2});
  EXPECT_EQ(load_little_endian<std::int16_t>(bytes), -2);
}

TEST(Bytes, OnlyThoseOfTheValueAreWritten) {
  std::array<std::uint8_t, 8> bytes{};
  bytes.fill(0xEE);
  store_little_endian(bytes, std::uint16_t{0x1234}, 1);
  store_little_endian(bytes, std::int32_t{-2}, 4);
  EXPECT_EQ(bytes, (std::array<std::uint8_t, 8>{0xEE, 0x34, 0x12, 0xEE, 0xFE, 0xFF, 0xFF, 0xFF}));
  store_little_endian(bytes, std::uint8_t{0}, 6);
  EXPECT_EQ(bytes[7], 0xFF);
}

TEST(Bytes, NothingOutsideIsTouchedAndItReadsAsZero) {
  std::array<std::uint8_t, 2> bytes{};
  store_little_endian(bytes, std::uint32_t{0xAABBCCDD}, 1);
  EXPECT_EQ(bytes[1], 0xDD);
  EXPECT_EQ(load_little_endian<std::uint32_t>(bytes, 1), 0xDDU);
}

TEST(Nmt, CommandNamesTheNode) {
  EXPECT_EQ(nmt_frame(NmtCommand::start, 7), (CanFrame{.id = 0, .size = 2, .data = {0x01, 7}}));
  EXPECT_EQ(nmt_frame(NmtCommand::reset_communication, all_nodes).data[0], 0x82);
}

TEST(Nmt, NamesItsStatesAndKnowsNoOthers) {
  EXPECT_EQ(to_string(NmtState::boot_up), "boot-up");
  EXPECT_EQ(to_string(NmtState::stopped), "stopped");
  EXPECT_EQ(to_string(NmtState::operational), "operational");
  EXPECT_EQ(to_string(NmtState::pre_operational), "pre-operational");
  EXPECT_EQ(to_string(NmtState{3}), "unknown NMT state");
  for (unsigned value = 0; value < 256; ++value) {
    const bool known = value == 0x00 || value == 0x04 || value == 0x05 || value == 0x7F;
    EXPECT_EQ(is_nmt_state(static_cast<std::uint8_t>(value)), known) << value;
  }
}

TEST(Heartbeat, SupervisionBeginsAnewWithEveryStartAndEndsWithAStop) {
  HeartbeatConsumer consumer{3, 250ms};
  consumer.start(Time{0ms});
  consumer.update(Time{251ms});
  ASSERT_TRUE(consumer.lost());
  consumer.start(Time{1s});
  EXPECT_FALSE(consumer.lost());
  consumer.update(Time{1250ms});
  EXPECT_FALSE(consumer.lost()) << "heard within the timeout from the start on";
  consumer.update(Time{1250ms + 1ns});
  ASSERT_TRUE(consumer.lost());
  consumer.stop();
  EXPECT_FALSE(consumer.lost());
  consumer.update(Time{10s});
  EXPECT_FALSE(consumer.lost());
}

TEST(Heartbeat, SilenceIsNoLossBeforeSupervisionStarts) {
  HeartbeatConsumer consumer{3, 250ms};
  consumer.update(Time{10s});
  EXPECT_FALSE(consumer.lost());
  EXPECT_FALSE(consumer.state().has_value());
}

TEST(Heartbeat, LostAfterTheTimeoutAndBackWithTheNextOne) {
  HeartbeatConsumer consumer{3, 250ms};
  consumer.start(Time{0ms});
  consumer.on_frame(heartbeat_frame(NmtState::operational, 3), Time{100ms});
  consumer.update(Time{350ms});
  EXPECT_FALSE(consumer.lost());
  consumer.update(Time{350ms + 1ns});
  EXPECT_TRUE(consumer.lost());
  consumer.on_frame(heartbeat_frame(NmtState::operational, 3), Time{400ms});
  EXPECT_FALSE(consumer.lost());
  EXPECT_EQ(consumer.state(), NmtState::operational);
}

TEST(Heartbeat, OtherNodesAndMalformedFramesDoNotCount) {
  HeartbeatConsumer consumer{3, 250ms};
  consumer.start(Time{0ms});
  consumer.on_frame(heartbeat_frame(NmtState::operational, 4), Time{200ms});
  consumer.on_frame({.id = 0x703, .size = 1, .remote = true, .data = {}}, Time{200ms});
  consumer.on_frame({.id = 0x703, .size = 2, .data = {0x05}}, Time{200ms});
  consumer.on_frame({.id = 0x703, .size = 1, .data = {0x33}}, Time{200ms});
  consumer.update(Time{251ms});
  EXPECT_TRUE(consumer.lost());
  EXPECT_FALSE(consumer.state().has_value());
}

TEST(Heartbeat, BootUpIsReportedOnce) {
  HeartbeatConsumer consumer{3, 250ms};
  consumer.on_frame(heartbeat_frame(NmtState::boot_up, 3), Time{1ms});
  consumer.on_frame(heartbeat_frame(NmtState::pre_operational, 3), Time{2ms});
  EXPECT_TRUE(consumer.take_boot_up());
  EXPECT_FALSE(consumer.take_boot_up());
}

TEST(Heartbeat, ProducerSendsOnceAPeriodAndDoesNotCatchUp) {
  HeartbeatProducer producer{127, 100ms};
  CanFrame frame;
  EXPECT_TRUE(producer.next_frame(frame, NmtState::operational, Time{5ms}));
  EXPECT_EQ(frame, (CanFrame{.id = 0x77F, .size = 1, .data = {0x05}}));
  EXPECT_FALSE(producer.next_frame(frame, NmtState::operational, Time{104ms}));
  EXPECT_TRUE(producer.next_frame(frame, NmtState::operational, Time{405ms}));
  EXPECT_FALSE(producer.next_frame(frame, NmtState::operational, Time{406ms}));
  EXPECT_TRUE(producer.next_frame(frame, NmtState::operational, Time{505ms})) << "a period after the last one";
  HeartbeatProducer silent{127, 0ms};
  EXPECT_FALSE(silent.next_frame(frame, NmtState::operational, Time{1s}));
}

TEST(Emcy, RoundTripAndReset) {
  const Emcy overload{.code = 0x2310, .error_register = 0x03, .manufacturer = {1, 2, 3, 4, 5}};
  EmcyConsumer consumer{9};
  EXPECT_FALSE(consumer.on_frame(emcy_frame(overload, 8)));
  EXPECT_TRUE(consumer.on_frame(emcy_frame(overload, 9)));
  EXPECT_EQ(consumer.last(), overload);
  EXPECT_TRUE(consumer.active());
  EXPECT_TRUE(consumer.on_frame(emcy_frame({}, 9)));
  EXPECT_FALSE(consumer.active());
  EXPECT_EQ(consumer.take_error(), overload.code) << "it came, although it is gone";
  EXPECT_EQ(consumer.take_error(), 0);
}

TEST(Emcy, EveryCodeOfTheClassOfNoErrorSaysThatErrorsAreGone) {
  for (const std::uint16_t code : std::array<std::uint16_t, 3>{0x0000, 0x0001, 0x00FF}) {
    EmcyConsumer consumer{9};
    consumer.on_frame(emcy_frame({.code = code}, 9));
    EXPECT_EQ(consumer.take_error(), 0) << code;
    consumer.on_frame(emcy_frame({.code = 0x0100}, 9));
    EXPECT_TRUE(consumer.active());
    consumer.on_frame(emcy_frame({.code = code}, 9));
    EXPECT_FALSE(consumer.active()) << code;
    EXPECT_EQ(consumer.last().code, code) << "what was said is shown as it was";
  }
}

TEST(Emcy, IsADataFrameOfEightBytes) {
  EmcyConsumer consumer{9};
  CanFrame frame = emcy_frame({.code = 0x2310}, 9);
  frame.remote = true;
  EXPECT_FALSE(consumer.on_frame(frame));
  frame.remote = false;
  frame.size = 7;
  EXPECT_FALSE(consumer.on_frame(frame));
  EXPECT_FALSE(consumer.active());
  frame.size = 8;
  EXPECT_TRUE(consumer.on_frame(frame));
}

constexpr EmcyCodes a_code_and_a_class{.first = {0xFF01, 0x4200}, .last = {0xFF01, 0x42FF}};

TEST(EmcyCodes, HoldACodeAloneAndAllOfAClass) {
  for (unsigned code = 0; code <= 0xFFFF; ++code) {
    const bool expected = code == 0xFF01 || (code >= 0x4200 && code <= 0x42FF);
    ASSERT_EQ(a_code_and_a_class.hold(static_cast<std::uint16_t>(code)), expected) << code;
    ASSERT_FALSE(EmcyCodes{}.hold(static_cast<std::uint16_t>(code))) << code;
  }
  EmcyCodes full;
  for (std::size_t i = 0; i < EmcyCodes::most; ++i)
    full.first[i] = full.last[i] = static_cast<std::uint16_t>(0xFF01 + i);
  EXPECT_TRUE(full.hold(0xFF08)) << "the last of as many as there is room for";
}

TEST(EmcyCodes, AreCodesOrClassesAndNoneThatEndsErrors) {
  static_assert(are_possible(EmcyCodes{}) && are_possible(a_code_and_a_class));
  const auto possible = [](unsigned first, unsigned last) {
    EmcyCodes codes;
    codes.first[7] = static_cast<std::uint16_t>(first);
    codes.last[7] = static_cast<std::uint16_t>(last);
    return are_possible(codes);
  };
  EXPECT_TRUE(possible(0x0100, 0x0100) && possible(0x0100, 0x01FF) && possible(0xFF00, 0xFFFF));
  EXPECT_FALSE(possible(0x0000, 0x00FF) || possible(0x00FF, 0x00FF) || possible(0x0001, 0x0001));
  EXPECT_FALSE(possible(0x0000, 0xFFFF) || possible(0x0000, 0x0100)) << "more than a class";
  EXPECT_FALSE(possible(0x4200, 0x43FF) || possible(0x4200, 0x42FE) || possible(0x4201, 0x42FF));
  EXPECT_FALSE(possible(0x4201, 0x4200) || possible(0x4200, 0)) << "none would be held";
}

TEST(Emcy, InformationIsTheNewestMessageAndNoError) {
  const Emcy fan_on{.code = 0xFF01, .error_register = 0x80, .manufacturer = {5, 4, 3, 2, 1}};
  EmcyConsumer consumer{9};
  EXPECT_TRUE(consumer.on_frame(emcy_frame(fan_on, 9), a_code_and_a_class));
  EXPECT_EQ(consumer.last(), fan_on);
  EXPECT_EQ(consumer.error(), Emcy{});
  EXPECT_FALSE(consumer.active());
  EXPECT_EQ(consumer.take_error(), 0);
  EXPECT_TRUE(consumer.on_frame(emcy_frame(fan_on, 9)));
  EXPECT_EQ(consumer.take_error(), fan_on.code) << "where nobody says that it is information";
}

TEST(Emcy, InformationNeitherHidesNorEndsAnError) {
  const Emcy overload{.code = 0x2310, .error_register = 0x03, .manufacturer = {1, 2, 3, 4, 5}};
  const Emcy warm{.code = 0x4210, .error_register = 0x09}, fan_on{.code = 0xFF01};
  EmcyConsumer consumer{9};
  const auto hear = [&](const Emcy& emcy) { return consumer.on_frame(emcy_frame(emcy, 9), a_code_and_a_class); };
  EXPECT_TRUE(hear(warm) && hear(overload) && hear(fan_on));
  EXPECT_EQ(consumer.last(), fan_on);
  EXPECT_EQ(consumer.error(), overload);
  EXPECT_TRUE(consumer.active());
  EXPECT_EQ(consumer.take_error(), overload.code);
  EXPECT_TRUE(hear(warm) && hear({.code = 0x3210}) && hear(warm));
  EXPECT_EQ(consumer.take_error(), 0x3210) << "the next one";
  EXPECT_TRUE(hear({}));
  EXPECT_FALSE(consumer.active()) << "a reset ends it";
  EXPECT_EQ(consumer.error(), Emcy{});
}

TEST(Emcy, ForgetsTheLastErrorWhenTold) {
  EmcyConsumer consumer{9};
  ASSERT_TRUE(consumer.on_frame(emcy_frame({.code = 0x2310}, 9)));
  consumer.forget();
  EXPECT_FALSE(consumer.active());
  EXPECT_EQ(consumer.error(), Emcy{});
  EXPECT_EQ(consumer.last(), Emcy{});
  EXPECT_EQ(Emcy{}.error_register, 0);
}

TEST(Emcy, SaysWhatAnErrorCodeIsAbout) {
  EXPECT_EQ(error_class(0x2310), "current on the output side");
  EXPECT_EQ(error_class(0x3220), "voltage inside the device");
  EXPECT_EQ(error_class(0x7305), "encoder or another sensor");
  EXPECT_EQ(error_class(0x7700), "a module of the device");
  EXPECT_EQ(error_class(0x8130), "communication");
  EXPECT_EQ(error_class(0x8611), "position control");
  EXPECT_EQ(error_class(0x8A00), "monitoring");
  EXPECT_EQ(error_class(0xFF01), "the vendor's own");
  EXPECT_EQ(error_class(0xA000), "not of the standard");
}

}  // namespace
