// What a forced stop sends, and when, to a server that the test plays.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/forced_stop.hpp"

namespace breakaway::cia402 {
namespace {

using namespace std::chrono_literals;
using canopen::NmtCommand;
using Bytes = std::array<std::uint8_t, 8>;

constexpr std::uint8_t node_id = 4;
constexpr Bytes write_controlword{0x2B, 0x40, 0x60};  // two bytes of zero
constexpr Bytes read_statusword{0x40, 0x41, 0x60};
constexpr Bytes written{0x60, 0x40, 0x60};
constexpr Bytes enabled{0x4B, 0x41, 0x60, 0, 0x37, 0x06};  // Operation enabled, in two bytes
constexpr Bytes disabled{0x4B, 0x41, 0x60, 0, 0x40, 0x02};
constexpr Bytes read_torque{0x40, 0x77, 0x60};
constexpr Bytes no_torque{0x4B, 0x77, 0x60, 0, 50, 0};
constexpr Bytes no_such_object{0x80, 0x77, 0x60, 0, 0, 0, 0x02, 0x06};

class ForcedStopSequence : public ::testing::Test {
 protected:
  canopen::SdoClient sdo{node_id, 10s};
  ForcedStop stop;
  hal::Time now{};
  std::vector<Bytes> requests;
  std::vector<std::pair<hal::Duration, NmtCommand>> commands;
  bool proven = false;

  void answer(const Bytes& bytes) {
    sdo.on_frame({.id = canopen::sdo_response_cob_id(node_id), .size = 8, .data = bytes});
  }
  hal::Duration period = 1ms;
  // One period; returns the request that was sent in it.
  std::optional<Bytes> step() {
    now += period;
    proven = stop.update(sdo, now);
    if (const auto command = stop.take_command()) commands.emplace_back(now - hal::Time{}, *command);
    hal::CanFrame frame;
    if (!sdo.next_frame(frame, now)) return {};
    requests.push_back(frame.data);
    return frame.data;
  }
  static Bytes answer_to(const Bytes& request, const Bytes& statusword) {
    if (request[1] == 0x77) return no_torque;
    return request[1] == 0x40 ? written : statusword;
  }
  // A server that answers at once.
  void serve_for(hal::Duration duration, const Bytes& statusword) {
    for (const hal::Time end = now + duration; now < end;) {
      if (const auto request = step()) answer(answer_to(*request, statusword));
      if (proven) return;
    }
  }
};

TEST_F(ForcedStopSequence, WritesTheControlwordAndReadsTheStatuswordInTurn) {
  stop.begin(sdo, 50ms, now);
  serve_for(50ms, enabled);
  EXPECT_FALSE(proven);
  ASSERT_GE(requests.size(), 20U);
  for (std::size_t i = 0; i < requests.size(); ++i)
    EXPECT_EQ(requests[i], i % 2 == 0 ? write_controlword : read_statusword) << i;
}

TEST_F(ForcedStopSequence, AnAnswerThatDoesNotComeIsAwaitedForAsLongAsItWasTold) {
  stop.begin(sdo, 50ms, now);
  for (int i = 0; i < 99; ++i) step();
  constexpr Bytes gives_up{0x80, 0x40, 0x60, 0, 0, 0, 0x04, 0x05};
  EXPECT_EQ(requests, (std::vector<Bytes>{write_controlword, gives_up, read_statusword}));
}

TEST_F(ForcedStopSequence, EachMeansHasItsTimeAndTheRoundBeginsAnew) {
  stop.begin(sdo, 50ms, now);
  serve_for(47700ms, enabled);
  using Told = std::pair<hal::Duration, NmtCommand>;
  const std::vector<Told> expected{
      {101ms, NmtCommand::enter_pre_operational},           {302ms, NmtCommand::reset_node},
      {2303ms + 101ms, NmtCommand::enter_pre_operational},  {2303ms + 302ms, NmtCommand::reset_node},
      {6606ms + 101ms, NmtCommand::enter_pre_operational},  {6606ms + 302ms, NmtCommand::reset_node},
      {14909ms + 101ms, NmtCommand::enter_pre_operational}, {14909ms + 302ms, NmtCommand::reset_node},
      {31212ms + 101ms, NmtCommand::enter_pre_operational}, {31212ms + 302ms, NmtCommand::reset_node},
      {47515ms + 101ms, NmtCommand::enter_pre_operational}};
  EXPECT_EQ(commands, expected);
}

// What answers within a period or two is not reset because the periods are long.
TEST_F(ForcedStopSequence, ADriveThatObeysASlowLoopProvesItByTheFirstMeans) {
  for (const auto slow : {50ms, 100ms, 250ms}) {
    for (const int late : {1, 2}) {
      period = slow;
      proven = false;
      sdo.cancel();
      stop.begin(sdo, 10 * slow, now);
      std::optional<Bytes> request;
      for (int i = 0; i < 20 && !proven; ++i) {
        if (i % late == 0 && request) answer(answer_to(*std::exchange(request, {}), disabled));
        if (const auto sent = step()) request = sent;
      }
      EXPECT_TRUE(proven);
      EXPECT_TRUE(commands.empty()) << slow / 1ms << " ms, answers after " << late;
    }
  }
}

TEST_F(ForcedStopSequence, InASlowLoopEachMeansHasTheUpdatesOfAProof) {
  period = 250ms;
  stop.begin(sdo, 1s, now);
  serve_for(20 * period, enabled);
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0], (std::pair<hal::Duration, NmtCommand>{5 * period, NmtCommand::enter_pre_operational}));
  EXPECT_EQ(commands[1], (std::pair<hal::Duration, NmtCommand>{10 * period, NmtCommand::reset_node}));
}

TEST_F(ForcedStopSequence, AStatuswordWithoutForceBesideNoTorqueIsTheProof) {
  stop.begin(sdo, 50ms, now);
  serve_for(50ms, disabled);
  EXPECT_TRUE(proven);
  EXPECT_EQ(requests, (std::vector<Bytes>{write_controlword, read_statusword, read_torque}));
}

TEST_F(ForcedStopSequence, ADriveThatHasNoTorqueToBeReadIsAskedForItOnceAndBelievedForItsState) {
  stop.begin(sdo, 50ms, now);
  step();
  answer(written);
  step();
  answer(disabled);
  EXPECT_EQ(step(), read_torque);
  EXPECT_TRUE(stop.reads_torque());
  answer(no_such_object);
  step();
  EXPECT_TRUE(proven);
  EXPECT_FALSE(stop.reads_torque());
  requests.clear();
  stop.resume(sdo, now);
  serve_for(50ms, disabled);
  EXPECT_TRUE(proven);
  EXPECT_EQ(requests, (std::vector<Bytes>{write_controlword, read_statusword}));
  stop.begin(sdo, 50ms, now);
  EXPECT_TRUE(stop.reads_torque()) << "it may be another drive";
}

TEST_F(ForcedStopSequence, AStatuswordOfOneByteIsNoProof) {
  stop.begin(sdo, 50ms, now);
  serve_for(50ms, {0x4F, 0x41, 0x60, 0, 0x40});
  EXPECT_FALSE(proven);
}

// The first segment of a longer value would read as a state without force.
TEST_F(ForcedStopSequence, AReadThatWasAbortedIsNoProof) {
  stop.begin(sdo, 50ms, now);
  step();
  answer(written);
  step();
  answer({0x41, 0x41, 0x60, 0, 10});
  step();
  answer({0x00, 0x40, 0x02, 0x40, 0x02, 0x40, 0x02, 0x40});
  step();
  answer({0x80, 0x41, 0x60});
  for (int i = 0; i < 3; ++i) {
    step();
    EXPECT_FALSE(proven);
  }
}

TEST_F(ForcedStopSequence, ADriveThatRefusesTheControlwordIsAskedForItsStateAllTheSame) {
  stop.begin(sdo, 50ms, now);
  step();
  answer({0x80, 0x40, 0x60});
  EXPECT_EQ(step(), read_statusword);
  answer(disabled);
  EXPECT_EQ(step(), read_torque);
  answer(no_torque);
  step();
  EXPECT_TRUE(proven);
}

TEST_F(ForcedStopSequence, TorqueProvesTheStopWhereItIsSmall) {
  struct Answer {
    Bytes torque;
    bool proves;
  };
  const std::array<Answer, 6> answers{{{{0x4B, 0x77, 0x60, 0, 50, 0}, true},
                                       {{0x4B, 0x77, 0x60, 0, 0xCE, 0xFF}, true},
                                       {{0x4B, 0x77, 0x60, 0, 51, 0}, false},
                                       {{0x4B, 0x77, 0x60, 0, 0xCD, 0xFF}, false},
                                       {{0x4B, 0x77, 0x60, 0, 0x00, 0x80}, false},
                                       {{0x4F, 0x77, 0x60, 0, 0}, false}}};
  for (const Answer& given : answers) {
    sdo.cancel();
    stop.begin(sdo, 50ms, now);
    EXPECT_EQ(step(), write_controlword);
    answer(written);
    EXPECT_EQ(step(), read_statusword);
    answer(disabled);
    EXPECT_EQ(step(), read_torque);
    answer(given.torque);
    step();
    EXPECT_EQ(proven, given.proves) << int{given.torque[4]} << ' ' << int{given.torque[5]};
  }
}

// Eight axes at 100 Hz: one frame a period is for all of them.
TEST_F(ForcedStopSequence, AMeansIsNotOverWhileItsRequestsWaitForOthers) {
  stop.begin(sdo, 50ms, now);
  hal::CanFrame frame;
  for (int turn = 1; turn < 100 && !proven; ++turn) {
    now += 10ms;
    proven = stop.update(sdo, now);
    ASSERT_FALSE(stop.take_command()) << "it obeys";
    if (turn % 8 == 0 && sdo.next_frame(frame, now)) answer(answer_to(frame.data, disabled));
  }
  EXPECT_TRUE(proven);
}

TEST_F(ForcedStopSequence, EachMeansWritesTheControlwordAtOnceToAServerThatIsSilent) {
  stop.begin(sdo, 10s, now);
  EXPECT_EQ(step(), write_controlword);
  while (commands.empty()) step();
  EXPECT_EQ(requests.size(), 1U) << "its answer is awaited";
  EXPECT_EQ(step(), write_controlword);
  while (commands.size() == 1) step();
  EXPECT_EQ(step(), write_controlword);
}

// It boots without a word, and nothing before showed that it answers slowly.
TEST_F(ForcedStopSequence, AServerThatTakesLongForAnAnswerIsGivenTheTimeInALaterRound) {
  const std::vector<std::pair<hal::Duration, hal::Duration>> answered_within{
      {45ms, 200ms}, {290ms, 2303ms + 1500ms}, {1700ms, 6606ms + 6s}, {1900ms, 14909ms + 7s}};
  for (const auto& [delay, limit] : answered_within) {
    sdo.cancel();
    stop.begin(sdo, 50ms, now);
    const hal::Time begin = now;
    std::optional<Bytes> late;
    hal::Time due{};
    while (!proven && now - begin < 60s) {
      if (late && now >= due) answer(*std::exchange(late, {}));
      if (const auto request = step()) {
        late = answer_to(*request, disabled);
        due = now + delay;
      }
    }
    EXPECT_TRUE(proven) << delay / 1ms << " ms";
    EXPECT_LE(now - begin, limit) << delay / 1ms << " ms";
    proven = false;
  }
}

TEST_F(ForcedStopSequence, BeginsWithTheFirstMeansEveryTime) {
  stop.begin(sdo, 50ms, now);
  serve_for(305ms, enabled);
  ASSERT_EQ(stop.means(), ForcedStop::Means::reset);
  sdo.cancel();
  stop.begin(sdo, 50ms, now);
  EXPECT_EQ(stop.means(), ForcedStop::Means::controlword);
  const hal::Time again = now;
  commands.clear();
  requests.clear();
  serve_for(150ms, enabled);
  EXPECT_EQ(requests.front(), write_controlword);
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(hal::Time{} + commands[0].first, again + 101ms);
  EXPECT_EQ(commands[0].second, NmtCommand::enter_pre_operational);
}

// What proved it was a statusword that chatters: the time between does not count, and no means begins anew.
TEST_F(ForcedStopSequence, AStopThatIsResumedGoesOnWithItsMeansAndAfterAResetWithTheNextRound) {
  stop.begin(sdo, 50ms, now);
  const auto force_for = [&](hal::Duration duration) {
    serve_for(duration - 10ms, enabled);
    serve_for(10ms, disabled);
    EXPECT_TRUE(proven);
    proven = false;
    now += 1s;
    sdo.cancel();
    stop.resume(sdo, now);
    if (const auto command = stop.take_command()) ADD_FAILURE() << "nothing but the controlword";
  };
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(stop.means(), ForcedStop::Means::controlword);
    force_for(30ms);
  }
  serve_for(50ms, enabled);
  EXPECT_EQ(stop.means(), ForcedStop::Means::pre_operational);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(stop.means(), ForcedStop::Means::pre_operational);
    force_for(30ms);
  }
  serve_for(100ms, enabled);
  EXPECT_EQ(stop.means(), ForcedStop::Means::reset);
  ASSERT_EQ(commands.size(), 2U);
  force_for(30ms);
  EXPECT_EQ(stop.means(), ForcedStop::Means::controlword);
  commands.clear();
  const hal::Time second_round = now;
  serve_for(ForcedStop::controlword_time + ForcedStop::pre_operational_time + 2 * ForcedStop::reset_time + 200ms,
            enabled);
  ASSERT_EQ(commands.size(), 3U);
  EXPECT_EQ(hal::Time{} + commands[1].first, second_round + 302ms);
  EXPECT_EQ(hal::Time{} + commands[2].first, second_round + 302ms + 4s + 102ms);
}

// A boot-up may come between a force that is seen and the next update, and force may be seen again.
TEST_F(ForcedStopSequence, AStopThatIsResumedTwiceHasTheTimeThatWasLeft) {
  stop.begin(sdo, 50ms, now);
  serve_for(30ms, enabled);
  for (int again = 0; again < 2; ++again) {
    now += 1s;
    sdo.cancel();
    stop.resume(sdo, now);
  }
  const hal::Time begin = now;
  serve_for(100ms, enabled);
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(hal::Time{} + commands[0].first, begin + 71ms);
}

TEST_F(ForcedStopSequence, WhatWasAskedBeforeAStopWasBegunOrResumedIsNoPartOfIt) {
  ASSERT_EQ(sdo.start_read(0x6041, 0), canopen::SdoStart::started);
  hal::CanFrame frame;
  ASSERT_TRUE(sdo.next_frame(frame, now));
  answer(disabled);
  ASSERT_EQ(sdo.poll(now), canopen::SdoResult::done);
  stop.begin(sdo, 50ms, now);
  EXPECT_EQ(step(), write_controlword) << "that it showed no force does not count";
  for (const Bytes& asked : {write_controlword, read_statusword, read_torque}) {
    SCOPED_TRACE(asked[1]);
    while (requests.back() != asked) {
      answer(answer_to(requests.back(), disabled));
      step();
    }
    sdo.cancel();
    stop.resume(sdo, now);
    EXPECT_EQ(step(), write_controlword);
  }
}

TEST_F(ForcedStopSequence, AStopThatIsResumedWaitsForAnAnswerAsLongAsItDidBefore) {
  stop.begin(sdo, 50ms, now);
  serve_for(10ms, disabled);
  ASSERT_TRUE(proven);
  sdo.set_timeout(10s);
  stop.resume(sdo, now);
  requests.clear();
  for (int i = 0; i < 60; ++i) step();
  ASSERT_GE(requests.size(), 2U);
  EXPECT_EQ(requests[1][0], 0x80) << "the answer is given up";
}

TEST_F(ForcedStopSequence, ARefusalThatMayPassIsOneForGoodWhenItLastedLongerThanItsTime) {
  stop.begin(sdo, 50ms, now);
  step();
  answer({0x80, 0x40, 0x60, 0, 0x22, 0, 0, 0x08});  // by the state of the device
  ASSERT_EQ(sdo.poll(now), canopen::SdoResult::aborted);
  EXPECT_FALSE(stop.is_refused(sdo, canopen::SdoResult::aborted, now));
  EXPECT_FALSE(stop.is_refused(sdo, canopen::SdoResult::aborted, now + ForcedStop::refusal_time));
  EXPECT_TRUE(stop.is_refused(sdo, canopen::SdoResult::aborted, now + ForcedStop::refusal_time + 1ns));
}

}  // namespace
}  // namespace breakaway::cia402
