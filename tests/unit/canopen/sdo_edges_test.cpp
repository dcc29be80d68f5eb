// What an SDO client takes for an answer and what not, byte by byte, and what it sends when it ends a transfer.
#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <vector>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/sdo_client.hpp"

namespace breakaway::canopen {
namespace {

using namespace std::chrono_literals;
using Bytes = std::array<std::uint8_t, 8>;

constexpr std::uint8_t server_node = 5;

class SdoEdges : public ::testing::Test {
 protected:
  SdoClient client{server_node, 10ms};
  hal::Time now{};

  void answer(const Bytes& bytes) {
    client.on_frame({.id = sdo_response_cob_id(server_node), .size = 8, .remote = false, .data = bytes});
  }
  std::optional<hal::CanFrame> sent() {
    hal::CanFrame frame;
    if (!client.next_frame(frame, now)) return {};
    return frame;
  }
  // Reads the object 2000h:01 and answers once.
  SdoResult read_answered_by(const Bytes& bytes) {
    client.cancel();
    EXPECT_EQ(client.start_read(0x2000, 1), SdoStart::started);
    EXPECT_TRUE(sent().has_value());
    answer(bytes);
    return client.poll(now);
  }
  std::vector<std::uint8_t> data() const { return {client.data().begin(), client.data().end()}; }
};

TEST_F(SdoEdges, IsIdleBeforeTheFirstTransfer) {
  EXPECT_FALSE(sent().has_value());
  now += 1h;
  EXPECT_EQ(client.poll(now), SdoResult::done);
  EXPECT_FALSE(sent().has_value()) << "nobody is told of a timeout";
  EXPECT_TRUE(client.data().empty());
  EXPECT_EQ(client.unexpected_command(), 0);
  EXPECT_EQ(client.abort_code(), SdoAbort::none);
}

TEST_F(SdoEdges, RequestsAndAbortsAreDataFrames) {
  ASSERT_EQ(client.start_read(0x2000, 1), SdoStart::started);
  EXPECT_EQ(sent(), (hal::CanFrame{.id = 0x605, .size = 8, .remote = false, .data = {0x40, 0x00, 0x20, 0x01}}));
  now += 11ms;
  EXPECT_EQ(client.poll(now), SdoResult::timeout);
  EXPECT_EQ(sent(),
            (hal::CanFrame{
                .id = 0x605, .size = 8, .remote = false, .data = {0x80, 0x00, 0x20, 0x01, 0x00, 0x00, 0x04, 0x05}}));
}

TEST_F(SdoEdges, AnAnswerMayTakeTheWholeTimeoutFromItsRequestOn) {
  now += 1h;
  ASSERT_EQ(client.start_read(0x2000, 1), SdoStart::started);
  now += 1s;
  EXPECT_EQ(client.poll(now), SdoResult::busy) << "nothing was sent yet";
  ASSERT_TRUE(sent().has_value());
  now += 10ms;
  EXPECT_EQ(client.poll(now), SdoResult::busy);
  now += 1ns;
  EXPECT_EQ(client.poll(now), SdoResult::timeout);
}

TEST_F(SdoEdges, AValueWithoutASizeHasFourBytes) {
  EXPECT_EQ(read_answered_by({0x42, 0x00, 0x20, 0x01, 1, 2, 3, 4}), SdoResult::done);
  EXPECT_EQ(data(), (std::vector<std::uint8_t>{1, 2, 3, 4}));
  EXPECT_EQ(read_answered_by({0x4E, 0x00, 0x20, 0x01, 1, 2, 3, 4}), SdoResult::done);
  EXPECT_EQ(data(), (std::vector<std::uint8_t>{1, 2, 3, 4})) << "the bits of the size mean nothing there";
  EXPECT_EQ(read_answered_by({0x4B, 0x00, 0x20, 0x01, 1, 2, 3, 4}), SdoResult::done);
  EXPECT_EQ(data(), (std::vector<std::uint8_t>{1, 2}));
}

TEST_F(SdoEdges, AnUnannouncedLengthIsThatOfTheSegments) {
  EXPECT_EQ(read_answered_by({0x40, 0x00, 0x20, 0x01, 99, 99, 99, 99}), SdoResult::busy);
  EXPECT_EQ(sent()->data, (Bytes{0x60}));
  answer({0x0B, 1, 2});
  EXPECT_EQ(client.poll(now), SdoResult::done);
  EXPECT_EQ(data(), (std::vector<std::uint8_t>{1, 2}));
}

TEST_F(SdoEdges, RefusesATooLongValueWhenItIsAnnounced) {
  EXPECT_EQ(read_answered_by({0x41, 0x00, 0x20, 0x01, SdoClient::capacity}), SdoResult::busy);
  EXPECT_EQ(read_answered_by({0x41, 0x00, 0x20, 0x01, SdoClient::capacity + 1}), SdoResult::aborted);
  EXPECT_EQ(client.abort_code(), SdoAbort::out_of_memory);
  EXPECT_EQ(sent()->data, (Bytes{0x80, 0x00, 0x20, 0x01, 0x05, 0x00, 0x04, 0x05})) << "the server is told";
  EXPECT_FALSE(sent().has_value());
}

// Each specifier of the server in each phase that it does not belong to.
TEST_F(SdoEdges, AnswersOfAnotherServiceArePassedOver) {
  constexpr Bytes read_begins{0x43, 0x00, 0x20, 0x01, 9, 9, 9, 9}, write_begins{0x60, 0x00, 0x20, 0x01};
  constexpr Bytes segment_read{0x01, 9, 9, 9}, segment_written{0x20};
  EXPECT_EQ(client.start_read(0x2000, 1), SdoStart::started);
  ASSERT_TRUE(sent().has_value());
  for (const Bytes& foreign : {write_begins, segment_read, segment_written}) answer(foreign);
  EXPECT_EQ(client.poll(now), SdoResult::busy);
  EXPECT_FALSE(sent().has_value());
  answer({0x41, 0x00, 0x20, 0x01, 8});
  EXPECT_EQ(sent()->data, (Bytes{0x60}));
  for (const Bytes& foreign : {read_begins, write_begins, segment_written}) answer(foreign);
  EXPECT_FALSE(sent().has_value());
  answer({0x00, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(sent()->data, (Bytes{0x70}));
  answer({0x1D, 8});
  EXPECT_EQ(client.poll(now), SdoResult::done);
  EXPECT_EQ(data(), (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8}));

  EXPECT_EQ(client.start_write(0x2000, 1, data()), SdoStart::started);
  ASSERT_TRUE(sent().has_value());
  for (const Bytes& foreign : {read_begins, segment_read, segment_written}) answer(foreign);
  EXPECT_EQ(client.poll(now), SdoResult::busy);
  EXPECT_FALSE(sent().has_value());
  answer(write_begins);
  EXPECT_EQ(sent()->data, (Bytes{0x00, 1, 2, 3, 4, 5, 6, 7}));
  for (const Bytes& foreign : {read_begins, write_begins, segment_read}) answer(foreign);
  EXPECT_FALSE(sent().has_value());
  answer({0x21});  // a reserved bit is none of the toggle's
  EXPECT_EQ(sent()->data, (Bytes{0x1D, 8})) << "the last one, and no empty one after it";
  answer({0x30});
  EXPECT_EQ(client.poll(now), SdoResult::done);
}

// As where another client of the same server writes, or an answer of a transfer before comes late.
TEST_F(SdoEdges, AWriteIsDoneByTheAnswerForItsOwnObjectOnly) {
  const std::vector<std::uint8_t> value{1};
  for (const Bytes& foreign :
       {Bytes{0x60, 0x00, 0x20, 0x02}, Bytes{0x60, 0x01, 0x20, 0x01}, Bytes{0x60, 0x00, 0x21, 0x01}}) {
    ASSERT_EQ(client.start_write(0x2000, 1, value), SdoStart::started);
    ASSERT_TRUE(sent().has_value());
    answer(foreign);
    EXPECT_EQ(client.poll(now), SdoResult::busy);
    answer({0x60, 0x00, 0x20, 0x01});
    EXPECT_EQ(client.poll(now), SdoResult::done);
  }
}

TEST_F(SdoEdges, TellsTheCommandThatDoesNotBelongThere) {
  for (const std::uint8_t command : std::array<std::uint8_t, 3>{0xA0, 0xC0, 0xE5}) {
    EXPECT_EQ(read_answered_by({command, 0x00, 0x20, 0x01}), SdoResult::protocol_error);
    EXPECT_EQ(client.unexpected_command(), command);
  }
  client.cancel();
  ASSERT_EQ(client.start_write(0x2000, 1, std::array<std::uint8_t, 8>{}), SdoStart::started);
  ASSERT_TRUE(sent().has_value());
  answer({0x60, 0x00, 0x20, 0x01});
  ASSERT_TRUE(sent().has_value());
  answer({0x30, 0x77});
  EXPECT_EQ(client.poll(now), SdoResult::protocol_error);
  EXPECT_EQ(client.unexpected_command(), 0x30);
}

TEST_F(SdoEdges, ACancelledTransferSaysNothingMore) {
  ASSERT_EQ(client.start_read(0x2000, 1), SdoStart::started);
  client.cancel();
  EXPECT_FALSE(sent().has_value()) << "its request";
  ASSERT_EQ(client.start_read(0x2000, 1), SdoStart::started);
  ASSERT_TRUE(sent().has_value());
  now += 11ms;
  ASSERT_EQ(client.poll(now), SdoResult::timeout);
  client.cancel();
  EXPECT_FALSE(sent().has_value()) << "its abort";
  EXPECT_EQ(client.poll(now), SdoResult::done);
}

}  // namespace
}  // namespace breakaway::canopen
