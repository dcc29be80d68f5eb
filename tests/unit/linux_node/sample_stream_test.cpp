#include "sample_stream.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "../refusal.hpp"

namespace {

using namespace std::chrono_literals;
using namespace breakaway::linux_node;
using breakaway::firmware::AxisFault;
using breakaway::hal::DriveState;
using breakaway::law::Mode;
using breakaway::testing::refusal;
using nlohmann::json;

constexpr breakaway::hal::Duration since_epoch = 1'763'870'000s + 123'456'789ns;

StepRecord moving() {
  return {.latency = 4'200ns,
          .target_counts = 250'000,
          .position_counts = 249'990,
          .command_N = 12.5F,
          .reported_N = -3,
          .mode = Mode::kick,
          .drive = DriveState::enabled,
          .fault = AxisFault::emergency,
          .fault_code = 0x2310};
}

// A receiver on a port that the system chooses.
class Receiver {
 public:
  explicit Receiver(int family) : socket_{socket(family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)} {
    sockaddr_in6 any6{
        .sin6_family = AF_INET6, .sin6_port = 0, .sin6_flowinfo = 0, .sin6_addr = in6addr_loopback, .sin6_scope_id = 0};
    sockaddr_in any4{.sin_family = AF_INET, .sin_port = 0, .sin_addr = {htonl(INADDR_LOOPBACK)}, .sin_zero = {}};
    void* const any = family == AF_INET6 ? static_cast<void*>(&any6) : &any4;
    socklen_t size = family == AF_INET6 ? sizeof any6 : sizeof any4;
    good_ = socket_ >= 0 && bind(socket_, static_cast<sockaddr*>(any), size) == 0 &&
            getsockname(socket_, static_cast<sockaddr*>(any), &size) == 0;
    port_ = ntohs(family == AF_INET6 ? any6.sin6_port : any4.sin_port);
  }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;
  ~Receiver() { end(); }

  bool good() const { return good_; }
  int port() const { return port_; }
  void end() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }
  std::vector<json> told() const {
    std::vector<json> all;
    std::array<char, 4096> text;
    for (ssize_t size; (size = recv(socket_, text.data(), text.size(), 0)) >= 0;)
      all.push_back(json::parse(text.data(), text.data() + size));
    return all;
  }

 private:
  int socket_;
  int port_ = 0;
  bool good_ = false;
};

std::vector<AxisPlan> plans(std::initializer_list<const char*> names) {
  std::vector<AxisPlan> all;
  for (const char* name : names) all.push_back({.name = name, .visits = {}, .resolution_m = 1e-6});
  return all;
}

TEST(SampleStream, ASampleIsAFlatObjectOfNumbersInSiUnits) {
  const json sample = json::parse(
      encode_sample(moving(), 1e-6, "", {.since_epoch = since_epoch, .number = 17, .dropped = 2, .bus_load = 0.31}));
  EXPECT_NEAR(sample.at("timestamp").get<double>(), 1763870000.123456, 1e-6);
  EXPECT_EQ(sample.at("sample"), 17);
  EXPECT_EQ(sample.at("dropped"), 2);
  EXPECT_DOUBLE_EQ(sample.at("latency_us"), 4.2);
  EXPECT_DOUBLE_EQ(sample.at("bus_load"), 0.31);
  EXPECT_DOUBLE_EQ(sample.at("target_m"), 0.25);
  EXPECT_DOUBLE_EQ(sample.at("position_m"), 0.24999);
  EXPECT_DOUBLE_EQ(sample.at("error_m"), -1e-5);
  EXPECT_DOUBLE_EQ(sample.at("command_N"), 12.5);
  EXPECT_DOUBLE_EQ(sample.at("reported_N"), -3);
  EXPECT_EQ(sample.at("mode"), static_cast<int>(Mode::kick));
  EXPECT_EQ(sample.at("drive"), static_cast<int>(DriveState::enabled));
  EXPECT_EQ(sample.at("fault"), static_cast<int>(AxisFault::emergency));
  EXPECT_EQ(sample.at("fault_code"), 0x2310);
  EXPECT_EQ(sample.size(), 16U);
  for (const auto& [name, value] : sample.items()) EXPECT_TRUE(value.is_number()) << name;
}

TEST(SampleStream, NumbersOfOneOfSeveralAxesBearItsName) {
  const json sample = json::parse(encode_sample(moving(), 1e-6, "gantry-x.1", {}));
  EXPECT_DOUBLE_EQ(sample.at("gantry-x.1/position_m"), 0.24999);
  EXPECT_EQ(sample.at("gantry-x.1/mode"), static_cast<int>(Mode::kick));
  EXPECT_TRUE(sample.contains("timestamp"));
  EXPECT_FALSE(sample.contains("position_m"));
}

TEST(SampleStream, LeavesOutWhatIsNotKnownOrNoNumber) {
  StepRecord step = moving();
  step.command_N = std::numeric_limits<float>::quiet_NaN();
  step.reported_N = std::numeric_limits<float>::infinity();
  const json broken = json::parse(encode_sample(step, 1e-6, "", {}));
  EXPECT_FALSE(broken.contains("command_N"));
  EXPECT_FALSE(broken.contains("reported_N"));
  EXPECT_TRUE(broken.contains("position_m"));
  step.controlled = false;
  const json heard = json::parse(encode_sample(step, 1e-6, "", {}));
  for (const char* name : {"mode", "command_N", "target_m", "error_m", "latency_us"})
    EXPECT_FALSE(heard.contains(name));
}

TEST(SampleStream, ErrorsNearTheEndsOfTheCounterAreExact) {
  StepRecord step = moving();
  step.position_counts = std::numeric_limits<std::int32_t>::max();
  step.target_counts = std::numeric_limits<std::int32_t>::min();
  EXPECT_NEAR(json::parse(encode_sample(step, 1e-6, "", {})).at("error_m").get<double>(), 4294.967295, 1e-5);
}

// A page subtracts the one from the other.
TEST(SampleStream, PlacesFarFromZeroAreExactToTheCount) {
  constexpr double count_m = 7e-7;
  StepRecord step = moving();
  step.target_counts = std::numeric_limits<std::int32_t>::max();
  step.position_counts = step.target_counts - 1;
  const json sample = json::parse(encode_sample(step, count_m, "", {}));
  EXPECT_NEAR(sample.at("target_m").get<double>() - sample.at("position_m").get<double>(), count_m, 0.01 * count_m);
}

TEST(SampleStream, ReachesAReceiverByNameAndByAddressOfEitherFamily) {
  const auto axes = plans({"axis"});
  for (const auto& [family, host] : {std::pair{AF_INET, "127.0.0.1"}, {AF_INET6, "[::1]"}, {AF_INET, "localhost"}}) {
    const Receiver receiver{family};
    if (!receiver.good() && family == AF_INET6) continue;  // a machine without IPv6
    ASSERT_TRUE(receiver.good());
    SampleStream stream{fmt::format("udp:{}:{}", host, receiver.port()), axes};
    stream.send(moving(), since_epoch, 0, 0);
    stream.send(moving(), since_epoch + 1ms, 0, 5);
    const auto told = receiver.told();
    if (told.empty() && host[0] == 'l') continue;  // the name may stand for ::1 first
    ASSERT_EQ(told.size(), 2U) << host;
    EXPECT_EQ(told[0].at("sample"), 0);
    EXPECT_EQ(told[1].at("sample"), 1);
    EXPECT_EQ(told[1].at("dropped"), 5);
  }
}

TEST(SampleStream, AReceiverThatDoesNotReadHoldsNobodyUp) {
  const auto axes = plans({"axis"});
  const Receiver receiver{AF_INET};
  SampleStream stream{fmt::format("udp:127.0.0.1:{}", receiver.port()), axes};
  constexpr int samples = 20'000;  // far more than a socket holds
  for (int n = 0; n < samples; ++n) stream.send(moving(), since_epoch + n * 1ms, 0, 0);
  const auto told = receiver.told();
  ASSERT_FALSE(told.empty());
  EXPECT_LT(told.size(), 20'000U);
  for (std::size_t n = 0; n < told.size(); ++n)
    ASSERT_EQ(told[n].at("sample"), n) << "the first ones are kept in order";
  stream.send(moving(), since_epoch, 0, 0);
  const auto next = receiver.told();
  ASSERT_EQ(next.size(), 1U);
  EXPECT_EQ(next[0].at("sample").get<int>() + next[0].at("dropped").get<int>(), samples)
      << "the gap tells what was lost on the way";
}

TEST(SampleStream, SamplesThatNobodyTakesAreCountedAndSaid) {
  const auto axes = plans({"axis"});
  Receiver receiver{AF_INET};
  SampleStream stream{fmt::format("udp:127.0.0.1:{}", receiver.port()), axes};
  receiver.end();
  for (int n = 0; n < 10; ++n) stream.send(moving(), since_epoch, 0, 0);
  // The system tells of a datagram that was refused when the next one is sent.
  EXPECT_NE(stream.report(3).find("not sent: 5 that nobody took, 3 that the ring had no room for"), std::string::npos)
      << stream.report(3);
}

TEST(SampleStream, DestinationsThatAreNoneAreRefusedByName) {
  const auto axes = plans({"axis"});
  const auto refused = [&](const std::string& text) { return refusal([&] { SampleStream{text, axes}; }); };
  for (const char* text :
       {"", "udp", "udp:", "udp::9870", "udp:host", "udp:host:", "udp:host:0", "udp:host:65536", "udp:host:99999999999",
        "udp:host:-1", "udp:host:http", "udp:::1:9870", "udp:[]:9870", "tcp:host:9870", "host:9870"})
    EXPECT_NE(refused(text).find("is not udp:HOST:PORT"), std::string::npos) << text;
  EXPECT_NE(refused("udp:no-such-host.invalid:9870").find("the host is not found"), std::string::npos);
}

// The control thread's end of the ring, under a reader that is too slow.
TEST(NodeTelemetry, AReaderThatIsSlowCostsRecordsAndNeverTheLoop) {
  const auto telemetry = std::make_unique<Telemetry>();
  constexpr int records = 50'000;
  std::vector<std::int32_t> read;
  std::thread slow{[&] {
    for (bool last = false; !last;) {
      std::this_thread::sleep_for(2ms);
      last = telemetry->finished;
      for (Record record; telemetry->records.pop(record);) {
        read.push_back(std::get<StepRecord>(record).position_counts);
        if (!last && read.size() % 1000 == 0) std::this_thread::sleep_for(1ms);
      }
    }
  }};
  for (int n = 0; n < records; ++n) telemetry->add(StepRecord{.position_counts = n});
  telemetry->finished = true;
  slow.join();
  EXPECT_EQ(read.size() + telemetry->lost, std::size_t{records});
  for (std::size_t n = 1; n < read.size(); ++n) ASSERT_LT(read[n - 1], read[n]);
}

TEST(NodeTelemetry, AFullRingKeepsTheOldestAndCountsTheOthers) {
  const auto telemetry = std::make_unique<Telemetry>();
  for (int n = 0; n < 20'000; ++n) telemetry->add(StepRecord{.position_counts = n});
  EXPECT_EQ(telemetry->lost, 20'000U - 16'384U);
  Record record;
  ASSERT_TRUE(telemetry->records.pop(record));
  EXPECT_EQ(std::get<StepRecord>(record).position_counts, 0);
}

}  // namespace
