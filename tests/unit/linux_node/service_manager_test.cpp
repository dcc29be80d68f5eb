#include "service_manager.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "../scratch_folder.hpp"

namespace {

using namespace std::chrono_literals;
using breakaway::hal::Duration;
using breakaway::hal::Time;
using breakaway::linux_node::ServiceManager;
using breakaway::linux_node::Telemetry;
using breakaway::testing::refusal;

// The manager's end: a socket of datagrams. name: a path, or @ and an abstract name.
class FakeManager {
 public:
  explicit FakeManager(const std::string& name) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path, sizeof address.sun_path - 1);
    if (name.front() == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), size), 0);
  }
  FakeManager(const FakeManager&) = delete;
  FakeManager& operator=(const FakeManager&) = delete;
  ~FakeManager() { close(socket_); }

  // What came since the last call.
  std::vector<std::string> told() const {
    std::vector<std::string> messages;
    std::array<char, 4096> text;
    for (ssize_t size; (size = recv(socket_, text.data(), text.size(), 0)) >= 0;)
      messages.emplace_back(text.data(), static_cast<std::size_t>(size));
    return messages;
  }

 private:
  int socket_ = -1;
};

class ServiceManagerTest : public breakaway::testing::ScratchFolder {
 protected:
  static constexpr Duration period = 1ms, between_calls = 20ms;

  std::string socket_name() const { return path("notify"); }

  // Calls poll() as the reporter does, for so long, while the control thread steps or stands still. Returns when signs
  // of life came.
  std::vector<Duration> signs_of_life(ServiceManager& manager, const FakeManager& fake, Duration time, bool steps) {
    std::vector<Duration> at;
    for (const Time begin = now_; now_ - begin < time;) {
      now_ += between_calls;
      if (steps) telemetry_->periods += static_cast<std::uint64_t>(between_calls / period);
      manager.poll(now_, *telemetry_, "enabled");
      for (const std::string& message : fake.told())
        if (message.find("WATCHDOG=1\n") != std::string::npos) at.push_back(now_ - begin);
    }
    return at;
  }

  std::unique_ptr<Telemetry> telemetry_ = std::make_unique<Telemetry>();
  Time now_{};
};

TEST_F(ServiceManagerTest, TellsOnceThatTheNodeIsReadyAndStopsAndWhatChanges) {
  const FakeManager fake{socket_name()};
  ServiceManager manager{{.notify_socket = socket_name().c_str()}, period};
  manager.poll(now_, *telemetry_, "configuring");
  EXPECT_EQ(fake.told(), std::vector<std::string>{"STATUS=configuring\n"});
  manager.poll(now_, *telemetry_, "configuring");
  EXPECT_TRUE(fake.told().empty());
  telemetry_->ready = true;
  manager.poll(now_, *telemetry_, "enabled");
  EXPECT_EQ(fake.told(), std::vector<std::string>{"READY=1\nSTATUS=enabled\n"});
  manager.poll(now_, *telemetry_, "enabled  FAULT: bus off");
  EXPECT_EQ(fake.told(), std::vector<std::string>{"STATUS=enabled  FAULT: bus off\n"});
  telemetry_->stopping = true;
  manager.poll(now_, *telemetry_, "enabled  FAULT: bus off");
  EXPECT_EQ(fake.told(), std::vector<std::string>{"STOPPING=1\n"});
}

TEST_F(ServiceManagerTest, ReachesAnAbstractSocket) {
  const std::string name = fmt::format("@breakaway-test-{}", getpid());
  const FakeManager fake{name};
  ServiceManager manager{{.notify_socket = name.c_str()}, period};
  manager.poll(now_, *telemetry_, "disabled");
  EXPECT_EQ(fake.told(), std::vector<std::string>{"STATUS=disabled\n"});
}

TEST_F(ServiceManagerTest, ShowsTwiceInTheTimeOfTheWatchdogThatTheLoopSteps) {
  const FakeManager fake{socket_name()};
  ServiceManager manager{{.notify_socket = socket_name().c_str(), .watchdog_us = "400000"}, period};
  const auto at = signs_of_life(manager, fake, 2s, true);
  EXPECT_EQ(at.size(), 10U);
  for (std::size_t i = 1; i < at.size(); ++i) EXPECT_EQ(at[i] - at[i - 1], 200ms);
}

TEST_F(ServiceManagerTest, GivesNoSignOfLifeOfALoopThatStandsStill) {
  const FakeManager fake{socket_name()};
  ServiceManager manager{{.notify_socket = socket_name().c_str(), .watchdog_us = "400000"}, period};
  EXPECT_TRUE(signs_of_life(manager, fake, 1s, false).empty());
  EXPECT_FALSE(signs_of_life(manager, fake, 490ms, true).empty());
  // Whenever it stops, there is none of it from the next call on.
  EXPECT_TRUE(signs_of_life(manager, fake, 1s, false).empty());
  EXPECT_FALSE(signs_of_life(manager, fake, 100ms, true).empty());
}

TEST_F(ServiceManagerTest, GivesSignsOfLifeOfALoopWhosePeriodIsLongerThanItsOwn) {
  const FakeManager fake{socket_name()};
  ServiceManager manager{{.notify_socket = socket_name().c_str(), .watchdog_us = "2200000"}, 1s};
  int signs = 0;
  for (int second = 0; second < 10; ++second) {
    ++telemetry_->periods;
    for (int call = 0; call < 50; ++call, now_ += between_calls) {
      manager.poll(now_, *telemetry_, "enabled");
      signs += static_cast<int>(fake.told().size());
    }
  }
  EXPECT_GE(signs, 5);
}

TEST_F(ServiceManagerTest, GivesNoneWhereNoneIsExpectedOfThisProcess) {
  const FakeManager fake{socket_name()};
  ServiceManager without{{.notify_socket = socket_name().c_str()}, period};
  EXPECT_TRUE(signs_of_life(without, fake, 1s, true).empty());
  ServiceManager another{{.notify_socket = socket_name().c_str(), .watchdog_us = "400000", .watchdog_pid = "1"},
                         period};
  EXPECT_TRUE(signs_of_life(another, fake, 1s, true).empty());
  const std::string own = std::to_string(getpid());
  ServiceManager ours{{.notify_socket = socket_name().c_str(), .watchdog_us = "400000", .watchdog_pid = own.c_str()},
                      period};
  EXPECT_FALSE(signs_of_life(ours, fake, 1s, true).empty());
}

TEST_F(ServiceManagerTest, TellsAgainWhatTheManagerDidNotTake) {
  auto fake = std::make_unique<FakeManager>(socket_name());
  ServiceManager manager{{.notify_socket = socket_name().c_str()}, period};
  // A full queue: nobody takes anything out of it.
  for (int i = 0; i < 10'000; ++i) manager.poll(now_, *telemetry_, std::to_string(i));
  telemetry_->ready = true;
  manager.poll(now_, *telemetry_, "enabled");
  for (const std::string& message : fake->told()) ASSERT_EQ(message.find("READY"), std::string::npos);
  manager.poll(now_, *telemetry_, "enabled");
  EXPECT_EQ(fake->told(), std::vector<std::string>{"READY=1\nSTATUS=enabled\n"});
}

TEST_F(ServiceManagerTest, IsAbsentWithoutASocket) {
  ServiceManager manager{{}, period};
  EXPECT_FALSE(manager.present());
  manager.poll(now_, *telemetry_, "enabled");
}

TEST_F(ServiceManagerTest, RefusesByNameWhatItCannotUse) {
  const auto refused = [&](const std::string& socket, const char* watchdog_us, Duration step = period) {
    return refusal([&] { ServiceManager{{.notify_socket = socket.c_str(), .watchdog_us = watchdog_us}, step}; });
  };
  EXPECT_NE(refused(path("nobody"), nullptr).find("No such file"), std::string::npos);
  EXPECT_NE(refused("vsock:2:1", nullptr).find("neither a path nor @"), std::string::npos);
  EXPECT_NE(refused("/" + std::string(200, 'x'), nullptr).find("is longer"), std::string::npos);
  const FakeManager fake{socket_name()};
  for (const char* time : {"", "soon", "0", "-1", "101999", "1e6", "86400000001"})
    EXPECT_NE(refused(socket_name(), time).find("WATCHDOG_USEC="), std::string::npos) << time;
  EXPECT_EQ(refused(socket_name(), "102000"), "");
  EXPECT_NE(refused(socket_name(), "2000000", 1s).find("2100000"), std::string::npos);
}

}  // namespace
