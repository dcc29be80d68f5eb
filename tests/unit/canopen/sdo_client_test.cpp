#include "breakaway/canopen/sdo_client.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <vector>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"

namespace {

using namespace std::chrono_literals;
using breakaway::canopen::load_little_endian;
using breakaway::canopen::sdo_request_cob_id;
using breakaway::canopen::sdo_response_cob_id;
using breakaway::canopen::SdoAbort;
using breakaway::canopen::SdoClient;
using breakaway::canopen::SdoResult;
using breakaway::canopen::SdoStart;
using breakaway::canopen::store_little_endian;
using breakaway::hal::CanFrame;
using breakaway::hal::Time;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t node_id = 5;
constexpr auto timeout = 10ms;

CanFrame response(std::array<std::uint8_t, 8> data, std::uint16_t id = sdo_response_cob_id(node_id)) {
  return {.id = id, .size = 8, .remote = false, .data = data};
}

CanFrame abort_response(std::uint16_t index, std::uint8_t subindex, SdoAbort code) {
  CanFrame frame = response({0x80});
  store_little_endian(frame.data, index, 1);
  frame.data[3] = subindex;
  store_little_endian(frame.data, static_cast<std::uint32_t>(code), 4);
  return frame;
}

// A server of the standard's figures, in memory.
class Server {
 public:
  std::map<std::uint32_t, Bytes> objects;
  bool announces_size = true;
  int aborts_received = 0;

  std::optional<CanFrame> answer(const CanFrame& request) {
    EXPECT_EQ(request.id, sdo_request_cob_id(node_id));
    EXPECT_EQ(request.size, 8);
    const std::uint8_t command = request.data[0];
    switch (command >> 5) {
      case 0:
        return take_segment(request);
      case 1:
        return begin_download(request);
      case 2:
        return begin_upload(request);
      case 3:
        return give_segment(command);
      default:
        ++aborts_received;
        return std::nullopt;
    }
  }

 private:
  static std::uint32_t key(const CanFrame& request) {
    return load_little_endian<std::uint32_t>(request.data, 1) & 0xFFFFFF;
  }

  CanFrame begin_upload(const CanFrame& request) {
    key_ = key(request);
    const auto found = objects.find(key_);
    if (found == objects.end())
      return abort_response(static_cast<std::uint16_t>(key_), static_cast<std::uint8_t>(key_ >> 16),
                            SdoAbort::no_such_object);
    data_ = found->second;
    position_ = 0;
    toggle_ = 0;
    CanFrame frame = response({0x41});
    std::copy_n(request.data.begin() + 1, 3, frame.data.begin() + 1);
    if (data_.size() >= 1 && data_.size() <= 4) {
      frame.data[0] = static_cast<std::uint8_t>(0x43 | (4 - data_.size()) << 2);
      std::copy(data_.begin(), data_.end(), frame.data.begin() + 4);
    } else if (announces_size) {
      store_little_endian(frame.data, static_cast<std::uint32_t>(data_.size()), 4);
    } else {
      frame.data[0] = 0x40;
    }
    return frame;
  }
  CanFrame give_segment(std::uint8_t command) {
    EXPECT_EQ(command & 0x10U, toggle_);
    const std::size_t count = std::min<std::size_t>(7, data_.size() - position_);
    const bool last = position_ + count == data_.size();
    CanFrame frame = response({static_cast<std::uint8_t>(toggle_ | (7 - count) << 1 | (last ? 1U : 0U))});
    std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(position_), count, frame.data.begin() + 1);
    position_ += count;
    toggle_ ^= 0x10;
    return frame;
  }
  CanFrame begin_download(const CanFrame& request) {
    key_ = key(request);
    data_.clear();
    toggle_ = 0;
    if ((request.data[0] & 2) != 0)
      objects[key_] = Bytes(request.data.begin() + 4, request.data.end() - ((request.data[0] >> 2) & 3));
    else
      announced_ = load_little_endian<std::uint32_t>(request.data, 4);
    CanFrame frame = response({0x60});
    std::copy_n(request.data.begin() + 1, 3, frame.data.begin() + 1);
    return frame;
  }
  CanFrame take_segment(const CanFrame& request) {
    EXPECT_EQ(request.data[0] & 0x10U, toggle_);
    data_.insert(data_.end(), request.data.begin() + 1, request.data.end() - ((request.data[0] >> 1) & 7));
    if ((request.data[0] & 1) != 0) {
      EXPECT_EQ(data_.size(), announced_);
      objects[key_] = data_;
    }
    CanFrame frame = response({static_cast<std::uint8_t>(0x20 | toggle_)});
    toggle_ ^= 0x10;
    return frame;
  }

  std::uint32_t key_ = 0;
  Bytes data_;
  std::size_t position_ = 0;
  std::size_t announced_ = 0;
  unsigned toggle_ = 0;
};

class SdoClientTest : public testing::Test {
 protected:
  SdoClient client{node_id, timeout};
  Server server;
  Time now{};
  int frames = 0;

  // One period: the client sends at most one frame, the answer comes before the next period.
  template <class Disturb>
  SdoResult run(Disturb disturb) {
    for (int period = 0; period < 1000; ++period, now += 1ms) {
      const SdoResult result = client.poll(now);
      if (result != SdoResult::busy) return result;
      CanFrame request;
      if (!client.next_frame(request, now)) continue;
      ++frames;
      const auto answer = server.answer(request);
      if (answer) disturb(*answer);
    }
    ADD_FAILURE() << "the transfer does not end";
    return SdoResult::busy;
  }
  SdoResult run() {
    return run([this](const CanFrame& answer) { client.on_frame(answer); });
  }
  SdoResult read(std::uint16_t index, std::uint8_t subindex = 0) {
    EXPECT_EQ(client.start_read(index, subindex), SdoStart::started);
    return run();
  }
  Bytes data() const { return {client.data().begin(), client.data().end()}; }
  void send_pending_request() {
    CanFrame request;
    ASSERT_TRUE(client.next_frame(request, now));
  }
};

Bytes pattern(std::size_t size) {
  Bytes bytes;
  for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(0xA0 + i));
  return bytes;
}

TEST_F(SdoClientTest, ReadsObjectsOfEverySize) {
  for (const bool announces : {true, false})
    for (std::size_t size = 0; size <= SdoClient::capacity; ++size) {
      server.announces_size = announces;
      server.objects[0x2000] = pattern(size);
      frames = 0;
      ASSERT_EQ(read(0x2000), SdoResult::done) << size;
      EXPECT_EQ(data(), pattern(size));
      const std::size_t segments = size == 0 ? 1 : size <= 4 ? 0 : (size + 6) / 7;
      EXPECT_EQ(frames, 1 + static_cast<int>(segments)) << size;
    }
}

TEST_F(SdoClientTest, WritesObjectsOfEverySize) {
  for (std::size_t size = 1; size <= SdoClient::capacity; ++size) {
    ASSERT_EQ(client.start_write(0x2001, 3, pattern(size)), SdoStart::started);
    ASSERT_EQ(run(), SdoResult::done) << size;
    EXPECT_EQ(server.objects[0x032001], pattern(size));
  }
}

TEST_F(SdoClientTest, ExpeditedCommandBytesAreTheStandards) {
  const std::array<std::uint8_t, 4> commands{0x2F, 0x2B, 0x27, 0x23};
  for (std::size_t size = 1; size <= 4; ++size) {
    ASSERT_EQ(client.start_write(0x6040, 1, pattern(size)), SdoStart::started);
    CanFrame request;
    ASSERT_TRUE(client.next_frame(request, now));
    EXPECT_EQ(request.data[0], commands[size - 1]);
    EXPECT_EQ(request.data[1], 0x40);
    EXPECT_EQ(request.data[2], 0x60);
    EXPECT_EQ(request.data[3], 1);
    client.cancel();
  }
}

TEST_F(SdoClientTest, RefusesToStartWhatCannotBe) {
  EXPECT_EQ(client.start_write(0x2000, 0, {}), SdoStart::bad_length);
  EXPECT_EQ(client.start_write(0x2000, 0, pattern(SdoClient::capacity + 1)), SdoStart::bad_length);
  ASSERT_EQ(client.start_read(0x2000, 0), SdoStart::started);
  EXPECT_EQ(client.start_read(0x2000, 0), SdoStart::busy);
  EXPECT_EQ(client.start_write(0x2000, 0, pattern(1)), SdoStart::busy);
}

TEST_F(SdoClientTest, SaysWhyTheServerAborted) {
  EXPECT_EQ(client.abort_code(), SdoAbort::none);
  EXPECT_EQ(read(0x5FFF), SdoResult::aborted);
  EXPECT_EQ(client.abort_code(), SdoAbort::no_such_object);
  server.objects[0x2000] = {1};
  EXPECT_EQ(read(0x2000), SdoResult::done);
  EXPECT_EQ(client.abort_code(), SdoAbort::no_such_object) << "of the last aborted transfer";
}

TEST_F(SdoClientTest, TimesOutWhenTheAnswerIsLostAndTellsTheServer) {
  server.objects[0x2000] = pattern(20);
  for (int lost = 1; lost <= 4; ++lost) {  // the initial response, then each of the three segments
    int count = 0;
    ASSERT_EQ(client.start_read(0x2000, 0), SdoStart::started);
    const Time start = now;
    const SdoResult result = run([&](const CanFrame& answer) {
      if (++count != lost) client.on_frame(answer);
    });
    EXPECT_EQ(result, SdoResult::timeout) << lost;
    EXPECT_LE(now - start, timeout + 1ms * (lost + 2));
    CanFrame abort;
    ASSERT_TRUE(client.next_frame(abort, now));
    EXPECT_EQ(abort.data[0], 0x80);
    EXPECT_EQ(load_little_endian<std::uint32_t>(abort.data, 4), 0x05040000U);
    EXPECT_FALSE(client.next_frame(abort, now));
    ASSERT_EQ(read(0x2000), SdoResult::done) << "the next transfer is not disturbed";
  }
}

TEST_F(SdoClientTest, DuplicatedAnswersDoNoHarm) {
  server.objects[0x2000] = pattern(40);
  ASSERT_EQ(client.start_read(0x2000, 0), SdoStart::started);
  const auto twice = [this](const CanFrame& answer) {
    client.on_frame(answer);
    client.on_frame(answer);
  };
  ASSERT_EQ(run(twice), SdoResult::done);
  EXPECT_EQ(data(), pattern(40));
  ASSERT_EQ(client.start_write(0x2001, 0, pattern(40)), SdoStart::started);
  ASSERT_EQ(run(twice), SdoResult::done);
  EXPECT_EQ(server.objects[0x2001], pattern(40));
}

TEST_F(SdoClientTest, LateAnswerOfATimedOutRequestIsNotTheNextOnes) {
  server.objects[0x2000] = {1, 2, 3, 4};
  server.objects[0x2001] = {5, 6, 7, 8};
  CanFrame late;
  ASSERT_EQ(client.start_read(0x2000, 0), SdoStart::started);
  ASSERT_EQ(run([&](const CanFrame& answer) { late = answer; }), SdoResult::timeout);
  ASSERT_EQ(client.start_read(0x2001, 0), SdoStart::started);
  const SdoResult result = run([&](const CanFrame& answer) {
    client.on_frame(late);
    client.on_frame(answer);
  });
  ASSERT_EQ(result, SdoResult::done);
  EXPECT_EQ(data(), (Bytes{5, 6, 7, 8}));
}

TEST_F(SdoClientTest, LateSegmentIsNotTheNextTransfersAnswer) {
  server.objects[0x2000] = pattern(20);
  server.objects[0x2001] = {5, 6};
  std::vector<CanFrame> answers;
  ASSERT_EQ(client.start_read(0x2000, 0), SdoStart::started);
  ASSERT_EQ(run([&](const CanFrame& answer) {
              answers.push_back(answer);
              if (answers.size() == 1) client.on_frame(answer);
            }),
            SdoResult::timeout);
  ASSERT_EQ(answers.size(), 2U);
  ASSERT_EQ(client.start_read(0x2001, 0), SdoStart::started);
  ASSERT_EQ(run([&](const CanFrame& answer) {
              client.on_frame(answers[1]);
              client.on_frame(answer);
            }),
            SdoResult::done);
  EXPECT_EQ(data(), (Bytes{5, 6}));
}

TEST_F(SdoClientTest, ForeignFramesAreIgnored) {
  server.objects[0x2000] = {1};
  ASSERT_EQ(client.start_read(0x2000, 0), SdoStart::started);
  const SdoResult result = run([this](const CanFrame& answer) {
    CanFrame foreign = answer;
    foreign.id = sdo_response_cob_id(node_id + 1);
    foreign.data[4] = 99;
    client.on_frame(foreign);
    foreign = answer;
    foreign.remote = true;
    client.on_frame(foreign);
    foreign = answer;
    foreign.size = 7;
    client.on_frame(foreign);
    client.on_frame(abort_response(0x2000, 1, SdoAbort::general_error));
    client.on_frame(answer);
  });
  ASSERT_EQ(result, SdoResult::done);
  EXPECT_EQ(data(), (Bytes{1}));
}

TEST_F(SdoClientTest, WrongToggleBitAbortsTheTransfer) {
  for (const bool writing : {false, true}) {
    server.objects[0x2000] = pattern(30);
    int count = 0;
    ASSERT_EQ(writing ? client.start_write(0x2000, 0, pattern(30)) : client.start_read(0x2000, 0), SdoStart::started);
    const SdoResult result = run([&](CanFrame answer) {
      if (++count == 3) answer.data[0] ^= 0x10;
      client.on_frame(answer);
    });
    EXPECT_EQ(result, SdoResult::protocol_error);
    CanFrame abort;
    ASSERT_TRUE(client.next_frame(abort, now));
    EXPECT_EQ(load_little_endian<std::uint32_t>(abort.data, 4), 0x05030000U);
  }
}

TEST_F(SdoClientTest, UnknownCommandAbortsTheTransfer) {
  ASSERT_EQ(client.start_read(0x2000, 0), SdoStart::started);
  send_pending_request();
  client.on_frame(response({0xC0, 0x00, 0x20, 0x00}));
  EXPECT_EQ(client.poll(now), SdoResult::protocol_error);
  EXPECT_EQ(client.unexpected_command(), 0xC0);
}

TEST_F(SdoClientTest, RefusesObjectsThatDoNotFit) {
  for (const bool announces : {true, false}) {
    server.announces_size = announces;
    server.objects[0x2000] = pattern(SdoClient::capacity + 1);
    EXPECT_EQ(read(0x2000), SdoResult::aborted);
    EXPECT_EQ(client.abort_code(), SdoAbort::out_of_memory);
  }
}

TEST_F(SdoClientTest, RefusesAnObjectThatIsNotAsLongAsAnnounced) {
  server.objects[0x2000] = pattern(20);
  ASSERT_EQ(client.start_read(0x2000, 0), SdoStart::started);
  int count = 0;
  const SdoResult result = run([&](CanFrame answer) {
    if (++count == 1) answer.data[4] = 21;
    client.on_frame(answer);
  });
  EXPECT_EQ(result, SdoResult::protocol_error);
}

TEST_F(SdoClientTest, EmptySegmentsDoNotKeepItForEver) {
  ASSERT_EQ(client.start_read(0x2000, 0), SdoStart::started);
  send_pending_request();
  client.on_frame(response({0x40, 0x00, 0x20, 0x00}));
  send_pending_request();
  client.on_frame(response({0x0E}));
  EXPECT_EQ(client.poll(now), SdoResult::protocol_error);
  EXPECT_EQ(client.unexpected_command(), 0x0E);
}

TEST_F(SdoClientTest, RandomFramesNeverBreakIt) {
  std::mt19937 random{3};
  for (int i = 0; i < 200'000; ++i, now += 1ms) {
    if (random() % 8 == 0) {
      const bool was_busy = client.busy();
      const SdoStart started = random() % 2 == 0
                                   ? client.start_read(0x2000, 0)
                                   : client.start_write(0x2000, 0, pattern(1 + random() % SdoClient::capacity));
      EXPECT_EQ(started, was_busy ? SdoStart::busy : SdoStart::started);
    }
    CanFrame request;
    client.next_frame(request, now);
    CanFrame frame = response({static_cast<std::uint8_t>(random()), 0x00, 0x20, 0x00});
    if (random() % 4 == 0) store_little_endian(frame.data, static_cast<std::uint32_t>(random()), 4);
    client.on_frame(frame);
    EXPECT_LE(client.data().size(), SdoClient::capacity);
    client.poll(now);
  }
  now += timeout + 1ms;
  CanFrame request;
  while (client.next_frame(request, now)) {
  }
  now += timeout + 1ms;
  EXPECT_NE(client.poll(now), SdoResult::busy);
}

}  // namespace
