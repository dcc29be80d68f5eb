// What the kernel's socket asks of the kernel, and what it makes of each answer.
#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/net_tstamp.h>
#include <net/if.h>

#include <cerrno>
#include <memory>
#include <set>

#include "breakaway/socketcan/kernel_socket.hpp"
#include "fake_kernel.hpp"

namespace breakaway::socketcan_test {
namespace {

using namespace std::chrono_literals;
using hal::Time;
using socketcan::Filter;
using socketcan::Io;
using socketcan::KernelSocket;
using socketcan::OpenResult;

can_frame frame_of(std::uint32_t id) {
  can_frame frame{};
  frame.can_id = id;
  frame.can_dlc = 1;
  frame.data[0] = 0x5A;
  return frame;
}

class KernelCalls : public testing::Test {
 protected:
  KernelCalls() { kernel() = {}; }
  ~KernelCalls() override {
    socket.reset();
    EXPECT_TRUE(kernel().open.empty()) << "what was opened is closed";
    EXPECT_EQ(kernel().closed_of_others, 0) << "and nothing else";
    kernel() = {};
  }
  OpenResult open(std::span<const Filter> filters = {}) { return socket->open("can0", filters); }
  // The time that a frame with these stamps is given.
  Time time_of(std::optional<timespec> software, std::optional<timespec> hardware) {
    kernel().incoming.push_back({.frame = frame_of(1), .software = software, .hardware = hardware, .lost = {}});
    can_frame frame{};
    Time time{};
    EXPECT_EQ(socket->read(frame, time), Io::done);
    return time;
  }
  void find_nothing() {
    can_frame frame{};
    Time time{};
    EXPECT_EQ(socket->read(frame, time), Io::again);
  }
  static void pass(std::chrono::nanoseconds time) {
    for (timespec* const clock : {&kernel().monotonic, &kernel().wall}) {
      const auto then = std::chrono::seconds{clock->tv_sec} + std::chrono::nanoseconds{clock->tv_nsec} + time;
      *clock = {.tv_sec = then / 1s, .tv_nsec = (then % 1s).count()};
    }
  }

  std::unique_ptr<KernelSocket> socket = std::make_unique<KernelSocket>();
};

TEST_F(KernelCalls, BindToTheInterfaceOfThatNameAndReadItsCarrier) {
  EXPECT_EQ(socket->descriptor(), -1);
  EXPECT_EQ(socket->error_number(), 0);
  EXPECT_EQ(socket->lost_frames(), 0U);
  ASSERT_EQ(open(), OpenResult::done);
  EXPECT_EQ(kernel().names, std::vector<std::string>{"can0"});
  EXPECT_EQ(kernel().family, AF_CAN);
  EXPECT_EQ(kernel().bound_index, 7);
  EXPECT_EQ(kernel().carrier_path, "/sys/class/net/can0/carrier");
  EXPECT_EQ(kernel().errors_wanted, CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED);
  EXPECT_EQ(kernel().drops_counted, 1);
  EXPECT_EQ(kernel().stamps_wanted, SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE |
                                        SOF_TIMESTAMPING_RX_HARDWARE | SOF_TIMESTAMPING_RAW_HARDWARE);
  EXPECT_EQ(kernel().filter_calls, 0) << "every frame is received";
  EXPECT_EQ(socket->descriptor(), 1000);
}

TEST_F(KernelCalls, TakeEveryNameThatAnInterfaceMayHave) {
  const std::string longest(IFNAMSIZ - 1, 'c'), longer(IFNAMSIZ, 'c');
  EXPECT_EQ(socket->open(longest.c_str(), {}), OpenResult::done);
  EXPECT_EQ(kernel().carrier_path, "/sys/class/net/" + longest + "/carrier");
  EXPECT_EQ(socket->open("c", {}), OpenResult::done);
  EXPECT_EQ(kernel().names.back(), "c") << "nothing is left of the longer one";
  EXPECT_EQ(kernel().open.size(), 2U) << "the first socket was closed";
  EXPECT_EQ(socket->open(longer.c_str(), {}), OpenResult::no_such_interface);
  EXPECT_TRUE(kernel().open.empty());
}

TEST_F(KernelCalls, SetUpToSixteenFiltersForDataFramesOfElevenBits) {
  std::vector<Filter> filters;
  for (std::uint16_t id = 0; id < 20; ++id) filters.push_back({id, static_cast<std::uint16_t>(0x700U + id)});
  ASSERT_EQ(open(filters), OpenResult::done);
  ASSERT_EQ(kernel().filters_set.size(), 16U);
  for (std::uint32_t i = 0; i < 16; ++i) {
    EXPECT_EQ(kernel().filters_set[i].can_id, i);
    EXPECT_EQ(kernel().filters_set[i].can_mask, (0x700U + i) | CAN_EFF_FLAG | CAN_RTR_FLAG);
  }
  ASSERT_EQ(open(std::span{filters}.first(1)), OpenResult::done);
  EXPECT_EQ(kernel().filters_set.size(), 1U);
  EXPECT_EQ(Filter{}.id | Filter{}.mask, 0) << "which passes everything";
}

struct Failure {
  int step;
  int error;
  OpenResult result;
};

TEST_F(KernelCalls, EachThatFailsIsNamedAndLeavesNothingOpen) {
  constexpr Filter any{};
  for (const Failure& f :
       {Failure{FakeKernel::socket, EPERM, OpenResult::no_permission},
        Failure{FakeKernel::socket, EACCES, OpenResult::no_permission},
        Failure{FakeKernel::socket, EAFNOSUPPORT, OpenResult::no_can_support},
        Failure{FakeKernel::index, ENODEV, OpenResult::no_such_interface},
        Failure{FakeKernel::type, EIO, OpenResult::failed}, Failure{FakeKernel::flags, EIO, OpenResult::failed},
        Failure{FakeKernel::filters, EINVAL, OpenResult::failed},
        Failure{FakeKernel::errors, ENOPROTOOPT, OpenResult::failed},
        Failure{FakeKernel::bound, ENETDOWN, OpenResult::failed},
        Failure{FakeKernel::carrier, ENOENT, OpenResult::failed}}) {
    kernel() = {};
    kernel().failing = f.step;
    kernel().error = f.error;
    EXPECT_EQ(open(std::span{&any, 1}), f.result) << f.step;
    EXPECT_EQ(socket->error_number(), f.error) << f.step;
    EXPECT_TRUE(kernel().open.empty()) << f.step;
    EXPECT_EQ(socket->descriptor(), -1);
    kernel().failing = FakeKernel::steps;
    EXPECT_TRUE(socket->reopen()) << "by the same name, when the cause is gone";
    EXPECT_EQ(kernel().filters_set.size(), 1U);
    socket = std::make_unique<KernelSocket>();
  }
}

TEST_F(KernelCalls, RefuseAnInterfaceThatIsNotCanOrIsDown) {
  kernel().interface_type = ARPHRD_ETHER;
  EXPECT_EQ(open(), OpenResult::not_can);
  kernel().interface_type = ARPHRD_CAN;
  kernel().interface_flags = IFF_RUNNING;
  EXPECT_EQ(open(), OpenResult::is_down);
  EXPECT_FALSE(socket->reopen());
  kernel().interface_flags = IFF_UP;
  EXPECT_TRUE(socket->reopen());
  EXPECT_TRUE(socket->reopen());
  EXPECT_EQ(kernel().open.size(), 2U) << "the one before was closed";
}

// A program without standard input gets the descriptor 0.
TEST_F(KernelCalls, CloseWhateverDescriptorTheyWereGiven) {
  for (const int first : {-1, 0, 1}) {
    kernel() = {};
    kernel().first_descriptor = first < 0 ? 500 : first;
    kernel().descriptor_step = first == 1 ? -1 : 1;
    ASSERT_EQ(open(), OpenResult::done);
    EXPECT_EQ(kernel().open.size(), 2U);
    socket = std::make_unique<KernelSocket>();
    EXPECT_TRUE(kernel().open.empty());
  }
}

TEST_F(KernelCalls, SendAFrameOrSayWhyNot) {
  ASSERT_EQ(open(), OpenResult::done);
  EXPECT_EQ(socket->write(frame_of(0x201)), Io::done);
  ASSERT_EQ(kernel().sent.size(), 1U);
  EXPECT_EQ(kernel().sent[0].can_id, 0x201U);
  EXPECT_EQ(kernel().sent[0].data[0], 0x5A);
  for (const auto& [error, result] :
       {std::pair{ENETDOWN, Io::down}, std::pair{ENODEV, Io::gone}, std::pair{ENXIO, Io::gone},
        std::pair{EBADF, Io::gone}, std::pair{EAGAIN, Io::again}, std::pair{ENOBUFS, Io::again},
        std::pair{ENOMEM, Io::again}, std::pair{EINTR, Io::again}, std::pair{EINVAL, Io::refused}}) {
    kernel().send_error = kernel().receive_error = error;
    for (const bool cut : {false, true}) {
      kernel().cuts_frames = cut;
      EXPECT_EQ(socket->write(frame_of(1)), result) << error;
    }
    can_frame frame{};
    Time time{};
    EXPECT_EQ(socket->read(frame, time), result) << error;
  }
}

TEST_F(KernelCalls, StampAFrameByTheBestClockThatTheKernelTells) {
  kernel().monotonic = {99, 0};
  ASSERT_EQ(open(), OpenResult::done);
  kernel().monotonic = {100, 0};
  EXPECT_EQ(time_of({}, {}), Time{100s}) << "when it is read";
  EXPECT_EQ(time_of(timespec{4999, 999'000'000}, {}), Time{100s - 1ms}) << "its age on the wall clock";
  EXPECT_EQ(time_of(timespec{4999, 999'000'000}, timespec{17, 0}), Time{100s - 1ms}) << "the counter is not known yet";
  kernel().monotonic = {100, 10'000'000};
  kernel().wall = {5000, 10'000'000};
  EXPECT_EQ(time_of(timespec{5000, 10'000'000}, timespec{17, 10'000'000}), Time{100s + 9ms + 2us})
      << "1 ms late; the drift of 10 ms allows 2 us";
  EXPECT_EQ(time_of({}, timespec{40, 0}), Time{100s + 10ms}) << "a counter that jumps";
}

// A frame waits for a fraction of a period, and the wall clock is set while it does.
TEST_F(KernelCalls, TakeNoFrameForOlderThanTheLastTimeThatNoneWaited) {
  ASSERT_EQ(open(), OpenResult::done);
  find_nothing();
  pass(1ms);
  const timespec stamp = kernel().wall;
  kernel().wall.tv_nsec += 50'000'000;
  EXPECT_EQ(time_of(stamp, {}), Time{100s + 1ms}) << "and not 50 ms before";
}

// It is stamped as it comes, and was not in the socket yet.
TEST_F(KernelCalls, BelieveTheStampOfAFrameThatWasOnItsWayToTheSocket) {
  ASSERT_EQ(open(), OpenResult::done);
  const timespec stamp = kernel().wall;
  pass(100us);
  find_nothing();
  pass(900us);
  EXPECT_EQ(time_of(stamp, {}), Time{100s});
  pass(100us);
  find_nothing();
  EXPECT_EQ(time_of(stamp, {}), Time{100s + 1100us}) << "such a one came long ago, and the clock was set";
}

// Else the counter's offset would stay wrong by the step for as long as the drift takes to make up for it: 50 ms at 200
// ppm are four minutes.
TEST_F(KernelCalls, KeepTheCountersOffsetWhenTheWallClockIsSet) {
  ASSERT_EQ(open(), OpenResult::done);
  find_nothing();
  pass(1ms);
  EXPECT_EQ(time_of(kernel().wall, timespec{17, 0}), Time{100s + 1ms});
  find_nothing();
  pass(1ms);
  const timespec stamp = kernel().wall;
  kernel().wall.tv_nsec += 50'000'000;
  EXPECT_EQ(time_of(stamp, timespec{17, 1'000'000}), Time{100s + 2ms});
}

// A process that was stopped reads what came before that.
TEST_F(KernelCalls, KeepTheAgeOfAFrameThatWaitedForLong) {
  ASSERT_EQ(open(), OpenResult::done);
  find_nothing();
  pass(1ms);
  const timespec stamp = kernel().wall;
  pass(600s);
  EXPECT_EQ(time_of(stamp, {}), Time{100s + 1ms});
}

TEST_F(KernelCalls, PassFramesOnAndCountThoseThatWereLost) {
  ASSERT_EQ(open(), OpenResult::done);
  can_frame frame{};
  Time time{};
  kernel().incoming.push_back({.frame = frame_of(0x181), .software = {}, .hardware = {}, .lost = 3});
  EXPECT_EQ(socket->read(frame, time), Io::done);
  EXPECT_EQ(frame.can_id, 0x181U);
  EXPECT_EQ(frame.data[0], 0x5A);
  EXPECT_EQ(socket->lost_frames(), 3U);
  kernel().incoming.push_back({.frame = frame_of(0x182), .software = timespec{5000, 0}, .hardware = {}, .lost = 5});
  EXPECT_EQ(socket->read(frame, time), Io::done);
  EXPECT_EQ(socket->lost_frames(), 5U) << "the socket counts them all";
  kernel().receive_error = ENETDOWN;  // from before: a call that succeeds leaves it
  for (const std::size_t size : {std::size_t{0}, std::size_t{8}}) {
    kernel().incoming.push_back({.frame = frame_of(1), .size = size, .software = {}, .hardware = {}, .lost = {}});
    EXPECT_EQ(socket->read(frame, time), Io::again) << "no whole frame";
  }
}

TEST_F(KernelCalls, GoOnCountingWhatWasLostInASocketThatIsOpenedAnewAndBeyondWhatTheKernelCounts) {
  can_frame frame{};
  Time time{};
  const auto lost_after = [&](std::uint32_t counted) {
    kernel().incoming.push_back({.frame = frame_of(1), .software = {}, .hardware = {}, .lost = counted});
    EXPECT_EQ(socket->read(frame, time), Io::done);
    return socket->lost_frames();
  };
  ASSERT_EQ(open(), OpenResult::done);
  EXPECT_EQ(lost_after(3), 3U);
  ASSERT_TRUE(socket->reopen());
  EXPECT_EQ(socket->lost_frames(), 3U);
  EXPECT_EQ(lost_after(2), 5U);
  EXPECT_EQ(lost_after(0xFFFF'FFFFU), 0x1'0000'0002U);
  EXPECT_EQ(lost_after(4), 0x1'0000'0007U);
}

TEST_F(KernelCalls, TellWhatTheKernelStillHolds) {
  ASSERT_EQ(open(), OpenResult::done);
  kernel().unsent_bytes = 768;
  EXPECT_EQ(socket->unsent_bytes(), 768U);
  kernel().memory_error = ENOPROTOOPT;
  EXPECT_EQ(socket->unsent_bytes(), 0U) << "an old kernel does not say";
}

TEST_F(KernelCalls, SeeTheBusByTheCarrier) {
  EXPECT_FALSE(socket->on_bus());
  ASSERT_EQ(open(), OpenResult::done);
  EXPECT_TRUE(socket->on_bus());
  kernel().carrier_shown = '0';
  EXPECT_FALSE(socket->on_bus());
  kernel().carrier_shown = std::nullopt;
  EXPECT_FALSE(socket->on_bus()) << "the interface is down";
}

TEST(OpenResults, HaveASentenceEach) {
  std::set<std::string_view> texts;
  for (int r = 0; r <= static_cast<int>(OpenResult::failed); ++r) texts.insert(to_string(static_cast<OpenResult>(r)));
  EXPECT_EQ(texts.size(), 7U);
  EXPECT_FALSE(texts.contains(""));
  EXPECT_EQ(to_string(static_cast<OpenResult>(99)), "unknown result");
}

}  // namespace
}  // namespace breakaway::socketcan_test
