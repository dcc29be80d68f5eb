#include "breakaway/canopen/sdo_server.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/sdo_client.hpp"

namespace breakaway::canopen {
namespace {

using namespace std::chrono_literals;
using Data = std::array<std::uint8_t, 8>;

constexpr std::uint8_t node_id = 127;

// 2000h:01 u16, may be written; 2000h:02 i32; 2001h:00 to :05 texts of various lengths.
struct Objects {
  std::uint32_t number = 0x1234;
  int writes = 0;
  static constexpr std::array<std::string_view, 6> texts{"",         "pump",           "seven b",
                                                         "eight by", "fourteen bytes", "more than two segments"};

  ObjectValue read(ObjectAddress address) const noexcept {
    if (address == ObjectAddress{0x2000, 1}) return {.type = ObjectType::u16, .number = number};
    if (address == ObjectAddress{0x2000, 2}) return {.type = ObjectType::i32, .number = 0xFFFF'FFFE};
    if (address.index == 0x2001 && address.subindex < texts.size()) return {.text = texts[address.subindex]};
    return {.abort = address.index == 0x2000 ? SdoAbort::no_such_subindex : SdoAbort::no_such_object};
  }
  SdoAbort write(ObjectAddress address, std::span<const std::uint8_t> bytes) noexcept {
    if (address != ObjectAddress{0x2000, 1}) return SdoAbort::read_only;
    if (bytes.size() != 2) return SdoAbort::length_mismatch;
    number = load_little_endian<std::uint16_t>(bytes);
    ++writes;
    return SdoAbort::none;
  }
};

class SdoServerTest : public testing::Test {
 protected:
  static hal::CanFrame request(const Data& data) {
    return {.id = sdo_request_cob_id(node_id), .size = 8, .remote = false, .data = data};
  }
  std::optional<hal::CanFrame> ask(const Data& data) {
    EXPECT_TRUE(server.on_frame(request(data)));
    hal::CanFrame answer;
    if (!server.next_frame(answer, objects)) return {};
    EXPECT_EQ(answer.id, sdo_response_cob_id(node_id));
    EXPECT_EQ(answer.size, 8);
    return answer;
  }
  SdoAbort abort_of(const Data& data) {
    const auto answer = ask(data);
    if (!answer || answer->data[0] != 0x80) return SdoAbort::none;
    return static_cast<SdoAbort>(load_little_endian<std::uint32_t>(answer->data, 4));
  }
  // To the end of what a client started.
  SdoResult transfer() {
    hal::Time now{};
    for (int period = 0; client.busy() && period < 100; ++period) {
      hal::CanFrame frame;
      if (client.next_frame(frame, now)) {
        EXPECT_TRUE(server.on_frame(frame));
      }
      if (server.next_frame(frame, objects)) client.on_frame(frame);
    }
    return client.poll(now);
  }

  Objects objects;
  SdoServer server{node_id};
  SdoClient client{node_id, 10ms};
};

TEST_F(SdoServerTest, ReadsNumbersExpeditedInTheirSize) {
  EXPECT_EQ(ask({0x40, 0x00, 0x20, 1})->data, (Data{0x4B, 0x00, 0x20, 1, 0x34, 0x12, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x00, 0x20, 2})->data, (Data{0x43, 0x00, 0x20, 2, 0xFE, 0xFF, 0xFF, 0xFF}));
}

TEST_F(SdoServerTest, ReadsTextsInSegmentsByTheFiguresOfTheStandard) {
  EXPECT_EQ(ask({0x40, 0x01, 0x20, 3})->data, (Data{0x41, 0x01, 0x20, 3, 8, 0, 0, 0}));
  EXPECT_EQ(ask({0x60})->data, (Data{0x00, 'e', 'i', 'g', 'h', 't', ' ', 'b'}));
  EXPECT_EQ(ask({0x70})->data, (Data{0x10 | 6 << 1 | 1, 'y'}));
  EXPECT_EQ(abort_of({0x60}), SdoAbort::command_specifier) << "there is no more";
}

TEST_F(SdoServerTest, ASegmentIsGivenToWhoReadsATextOnly) {
  EXPECT_EQ(abort_of({0x60}), SdoAbort::command_specifier) << "before anything was read";
  ask({0x40, 0x01, 0x20, 5});
  EXPECT_EQ(ask({0x6F})->data[0], 0x00) << "the other bits of its first byte say nothing";
  EXPECT_EQ(ask({0x2B, 0x00, 0x20, 1, 0x78, 0x56, 0, 0})->data[0], 0x60);
  EXPECT_EQ(abort_of({0x70}), SdoAbort::command_specifier) << "what is written ends what was read";
}

TEST_F(SdoServerTest, GivesTheProjectsClientEveryText) {
  for (std::uint8_t i = 0; i < Objects::texts.size(); ++i) {
    ASSERT_EQ(client.start_read(0x2001, i), SdoStart::started);
    EXPECT_EQ(transfer(), SdoResult::done) << int{i};
    EXPECT_EQ((std::string{client.data().begin(), client.data().end()}), Objects::texts[i]);
  }
}

TEST_F(SdoServerTest, TakesWhatIsWrittenExpedited) {
  EXPECT_EQ(ask({0x2B, 0x00, 0x20, 1, 0x78, 0x56, 0, 0})->data, (Data{0x60, 0x00, 0x20, 1}));
  EXPECT_EQ(objects.number, 0x5678U);
  EXPECT_EQ(ask({0x22, 0x00, 0x20, 1, 0x01, 0x02, 9, 9})->data[0], 0x60) << "without a size the object's own counts";
  EXPECT_EQ(objects.number, 0x0201U);
  EXPECT_EQ(abort_of({0x23, 0x00, 0x20, 1, 1, 0, 0, 0}), SdoAbort::length_mismatch);
  EXPECT_EQ(abort_of({0x23, 0x00, 0x20, 2, 1, 0, 0, 0}), SdoAbort::read_only);
  EXPECT_EQ(objects.writes, 2);
}

TEST_F(SdoServerTest, RefusesByTheCodesOfTheStandardWithTheObject) {
  EXPECT_EQ(ask({0x40, 0x34, 0x12, 7})->data, (Data{0x80, 0x34, 0x12, 7, 0x00, 0x00, 0x02, 0x06}));
  EXPECT_EQ(abort_of({0x40, 0x00, 0x20, 9}), SdoAbort::no_such_subindex);
  EXPECT_EQ(abort_of({0x21, 0x00, 0x20, 1, 8}), SdoAbort::unsupported_access) << "a download in segments";
  EXPECT_EQ(abort_of({0x21, 0x34, 0x12, 7, 8}), SdoAbort::no_such_object) << "and of nothing";
  EXPECT_EQ(abort_of({0x00}), SdoAbort::command_specifier) << "a segment of a download";
  EXPECT_EQ(abort_of({0xA0, 0x00, 0x20, 1}), SdoAbort::command_specifier) << "a block upload";
  EXPECT_EQ(abort_of({0xC0, 0x00, 0x20, 1}), SdoAbort::command_specifier) << "a block download";
  EXPECT_EQ(abort_of({0xE0, 0x00, 0x20, 1}), SdoAbort::command_specifier);
  EXPECT_EQ(abort_of({0x60}), SdoAbort::command_specifier) << "a segment of nothing";
}

TEST_F(SdoServerTest, AWrongToggleEndsTheTransferAndNamesTheObject) {
  ask({0x40, 0x01, 0x20, 5});
  ask({0x60});
  EXPECT_EQ(ask({0x60})->data, (Data{0x80, 0x01, 0x20, 5, 0x00, 0x00, 0x03, 0x05}));
  EXPECT_EQ(abort_of({0x70}), SdoAbort::command_specifier);
}

TEST_F(SdoServerTest, AnAbortEndsTheTransferWithoutAnAnswer) {
  ask({0x40, 0x01, 0x20, 5});
  EXPECT_FALSE(ask({0x80, 0x01, 0x20, 5}));
  EXPECT_EQ(abort_of({0x60}), SdoAbort::command_specifier);
}

TEST_F(SdoServerTest, AnswersOneRequestACallAndTheNewestOfSeveral) {
  server.on_frame(request({0x40, 0x00, 0x20, 1}));
  server.on_frame(request({0x40, 0x00, 0x20, 2}));
  hal::CanFrame answer;
  ASSERT_TRUE(server.next_frame(answer, objects));
  EXPECT_EQ(answer.data[3], 2);
  EXPECT_FALSE(server.next_frame(answer, objects));
}

TEST_F(SdoServerTest, PassesOverWhatIsNotItsOwnAndDoesNotAnswerWhatIsMalformed) {
  hal::CanFrame frame = request({0x40, 0x00, 0x20, 1});
  frame.id = sdo_request_cob_id(node_id - 1);
  EXPECT_FALSE(server.on_frame(frame));
  frame.id = sdo_response_cob_id(node_id);
  EXPECT_FALSE(server.on_frame(frame));
  frame = request({0x40, 0x00, 0x20, 1});
  frame.remote = true;
  EXPECT_FALSE(server.on_frame(frame));
  frame.remote = false;
  frame.size = 7;
  EXPECT_TRUE(server.on_frame(frame));
  EXPECT_FALSE(server.next_frame(frame, objects));
}

TEST_F(SdoServerTest, AnyRequestsGetOneAnswerAtMostAndWriteNothingButWhatMayBeWritten) {
  std::mt19937_64 random{23};
  for (int i = 0; i < 200'000; ++i) {
    Data data{};
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
    if (i % 2 == 0)
      data = {data[0], static_cast<std::uint8_t>(data[1] & 1U), 0x20, static_cast<std::uint8_t>(data[3] & 7U)};
    const int before = objects.writes;
    const auto answer = ask(data);
    EXPECT_EQ(answer.has_value(), data[0] >> 5U != 4);
    if (objects.writes != before) {
      EXPECT_EQ(data[0] >> 5U, 1);
    }
  }
  EXPECT_GT(objects.writes, 0);
}

}  // namespace
}  // namespace breakaway::canopen
