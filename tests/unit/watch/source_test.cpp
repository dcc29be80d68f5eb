#include "breakaway/watch/source.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>

#include "../refusal.hpp"
#include "../scratch_folder.hpp"

namespace {

using namespace std::chrono_literals;
using namespace breakaway::watch;
using breakaway::testing::refusal;

// Waits for another thread, for 10 s at most.
template <class Condition>
bool comes_true(Condition condition) {
  for (int n = 0; n < 1000 && !condition(); ++n) std::this_thread::sleep_for(10ms);
  return condition();
}

class WatchFile : public breakaway::testing::ScratchFolder {
 protected:
  History history_;
};

TEST_F(WatchFile, ReadsARunAndThenWhatIsWrittenToIt) {
  std::ofstream file{path("run.csv")};
  file << "time_s,position_m\n1,0.5\n2,0.6\n3," << std::flush;
  const auto source = follow_file(path("run.csv"), history_);
  EXPECT_EQ(source->description(), path("run.csv"));
  EXPECT_TRUE(comes_true([&] { return history_.read(0, 9).next == 2; }));
  file << "0.7\n" << std::flush;
  EXPECT_TRUE(comes_true([&] { return history_.read(0, 9).next == 3; }));
  EXPECT_EQ(history_.read(2, 9).samples[0].position_m, 0.7);
  EXPECT_EQ(history_.losses().malformed, 0U) << "a line that is not whole yet is not malformed";
}

TEST_F(WatchFile, ReadsAnotherRunThatIsWrittenIntoTheFile) {
  std::ofstream{path("run.csv")} << "time_s,position_m\n1,0.5\n2,0.6\n3,0.7\n4,";
  const auto source = follow_file(path("run.csv"), history_);
  EXPECT_TRUE(comes_true([&] { return history_.read(0, 9).next == 3; }));
  std::ofstream{path("run.csv")} << "time_s,target_m,position_m\n0,0,0.1\n";
  EXPECT_TRUE(comes_true([&] { return history_.read(0, 9).next == 4; }));
  EXPECT_EQ(history_.read(3, 9).samples[0].position_m, 0.1);
  EXPECT_EQ(history_.losses().malformed, 0U) << history_.losses().complaint;
}

TEST_F(WatchFile, ALineThatCannotBeReadIsLeftOutAndNamed) {
  std::ofstream{path("run.csv")} << "time_s,position_m\n1,0.5\n2,0.6,7\n" << std::string(100'000, '9') << "\n4,0.8\n";
  const auto source = follow_file(path("run.csv"), history_);
  EXPECT_TRUE(comes_true([&] { return history_.read(0, 9).next == 2; }));
  EXPECT_EQ(history_.losses().malformed, 2U);
  EXPECT_NE(history_.losses().complaint.find("run.csv:4: "), std::string::npos) << history_.losses().complaint;
}

// A pipe in the place of standard input.
class PipedInput {
 public:
  PipedInput() : before_{dup(STDIN_FILENO)} {
    EXPECT_EQ(pipe(ends_.data()), 0);
    dup2(ends_[0], STDIN_FILENO);
  }
  PipedInput(const PipedInput&) = delete;
  PipedInput& operator=(const PipedInput&) = delete;
  ~PipedInput() {
    dup2(before_, STDIN_FILENO);
    for (const int end : {before_, ends_[0], ends_[1]}) close(end);
  }
  void write(std::string_view text) const {
    EXPECT_EQ(::write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

 private:
  int before_;
  std::array<int, 2> ends_{};
};

TEST_F(WatchFile, ReadsStandardInputWhoseFirstLineComesLater) {
  const PipedInput input;
  const auto source = follow_file("-", history_);
  EXPECT_EQ(source->description(), "standard input");
  input.write("time_s,posi");
  input.write("tion_m\n1,0.5\n2,");
  EXPECT_TRUE(comes_true([&] { return history_.read(0, 9).next == 1; }));
  input.write("0.6\n3,0.7,8\n");
  EXPECT_TRUE(comes_true([&] { return history_.losses().malformed == 1; }));
  EXPECT_EQ(history_.read(1, 9).samples[0].position_m, 0.6);
  EXPECT_NE(history_.losses().complaint.find("standard input:4: "), std::string::npos) << history_.losses().complaint;
}

TEST_F(WatchFile, SaysThatStandardInputIsNoRun) {
  const PipedInput input;
  const auto source = follow_file("-", history_);
  input.write("a,b\n1,2\n");
  EXPECT_TRUE(comes_true([&] { return !history_.losses().complaint.empty(); }));
  EXPECT_NE(history_.losses().complaint.find("standard input: the first line has no column time_s"), std::string::npos)
      << history_.losses().complaint;
}

TEST_F(WatchFile, WhatIsNoRunIsRefusedByName) {
  const auto refused = [&](const std::string& file) { return refusal([&] { follow_file(file, history_); }); };
  EXPECT_NE(refused(path("none.csv")).find("none.csv: cannot be read: No such file"), std::string::npos);
  EXPECT_NE(refused(folder_.string()).find("is a folder"), std::string::npos);
  std::ofstream{path("empty.csv")};
  EXPECT_NE(refused(path("empty.csv")).find("empty.csv: has no whole first line"), std::string::npos);
  std::ofstream{path("other.csv")} << "a,b\n1,2\n";
  EXPECT_NE(refused(path("other.csv")).find("other.csv: the first line has no column time_s"), std::string::npos);
  std::ofstream{path("long.csv")} << std::string(1'000'000, 'x');
  EXPECT_NE(refused(path("long.csv")).find("long.csv: has no whole first line"), std::string::npos);
}

// A node's end of a stream.
class Sender {
 public:
  explicit Sender(const Source& source) {
    const std::string text = source.description();
    address_.sin_family = AF_INET;
    address_.sin_port = htons(static_cast<std::uint16_t>(std::stoi(text.substr(text.rfind(' ') + 1))));
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;
  ~Sender() { close(socket_); }
  void send(const std::string& text) const {
    EXPECT_EQ(
        sendto(socket_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&address_), sizeof address_),
        static_cast<ssize_t>(text.size()));
  }
  void sample(int number) const {
    send(fmt::format(R"({{"timestamp":{0},"position_m":1,"sample":{0},"dropped":2}})", number));
  }

 private:
  int socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address_{};
};

TEST(WatchStream, TakesSamplesAndCountsWhatIsMissingOrMalformed) {
  History history;
  const auto source = receive_stream("0", history);
  const Sender sender{*source};
  for (const int number : {0, 1, 4, 5}) sender.sample(number);
  sender.send("no sample");
  sender.send("");
  sender.sample(6);
  EXPECT_TRUE(comes_true([&] { return history.read(0, 9).next == 5; }));
  const Losses losses = history.losses();
  EXPECT_EQ(losses.on_the_way, 2U);
  EXPECT_EQ(losses.at_sender, 2U);
  EXPECT_EQ(losses.malformed, 2U);
}

TEST(WatchStream, ANodeThatBeginsAnewHasLostNothing) {
  History history;
  const auto source = receive_stream("0", history);
  const Sender sender{*source};
  for (const int number : {100, 101, 0, 1}) sender.sample(number);
  EXPECT_TRUE(comes_true([&] { return history.read(0, 9).next == 4; }));
  EXPECT_EQ(history.losses().on_the_way, 0U) << "whoever comes later has not lost what was before him";
}

TEST(WatchStream, PlacesThatAreNoneOrTakenAreRefusedByName) {
  History history;
  const auto refused = [&](const std::string& place) { return refusal([&] { receive_stream(place, history); }); };
  for (const char* place :
       {"", "port", "65536", "-1", "1.5", "localhost:9870", "::1:9870", "[127.0.0.1]:9870", "127.0.0.1:", ":"})
    EXPECT_NE(refused(place).find("is neither PORT nor ADDRESS:PORT"), std::string::npos) << place;
  EXPECT_NE(refused("203.0.113.7:9870").find("cannot be received at: "), std::string::npos);
  const auto source = receive_stream("127.0.0.1:0", history);
  const std::string text = source->description();
  EXPECT_NE(refused(text.substr(text.rfind(' ') + 1)).find("Address already in use; choose another port"),
            std::string::npos);
}

}  // namespace
