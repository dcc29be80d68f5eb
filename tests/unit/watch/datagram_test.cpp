#include "breakaway/watch/datagram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "../refusal.hpp"

namespace {

using namespace breakaway;
using breakaway::testing::refusal;
using watch::read_datagram;

const std::string node_sample =
    R"({"timestamp":1763870000.123456,"sample":17,"dropped":2,"bus_load":0.31,"latency_us":4.200,"target_m":0.25,)"
    R"("error_m":-1e-05,"command_N":12.5,"mode":1,"position_m":0.24999,"reported_N":-3,"drive":3,"fault":3,)"
    R"("fault_code":8976,"stop_not_obeyed":1,"link_lost":0})";

TEST(WatchDatagram, ReadsASampleOfTheNode) {
  const auto read = read_datagram(node_sample);
  EXPECT_EQ(read.number, 17U);
  EXPECT_EQ(read.dropped, 2U);
  EXPECT_EQ(read.sample.axis, "");
  EXPECT_DOUBLE_EQ(read.sample.time_s, 1763870000.123456);
  EXPECT_DOUBLE_EQ(read.sample.target_m, 0.25);
  EXPECT_DOUBLE_EQ(read.sample.position_m, 0.24999);
  EXPECT_DOUBLE_EQ(read.sample.command_N, 12.5);
  EXPECT_DOUBLE_EQ(read.sample.reported_N, -3);
  EXPECT_DOUBLE_EQ(read.sample.latency_us, 4.2);
  EXPECT_DOUBLE_EQ(read.sample.bus_load, 0.31);
  EXPECT_EQ(read.sample.mode, law::Mode::kick);
  EXPECT_EQ(read.sample.drive, hal::DriveState::enabled);
  EXPECT_EQ(read.sample.fault, firmware::AxisFault::emergency);
  EXPECT_EQ(read.sample.fault_code, 0x2310);
  EXPECT_TRUE(read.sample.stop_not_obeyed);
  EXPECT_FALSE(read.sample.link_lost);
}

TEST(WatchDatagram, FieldsOfOneOfSeveralAxesBearItsName) {
  const auto read = read_datagram(R"({"timestamp":1,"latency_us":3,"x.1/position_m":0.5,"x.1/mode":3,"y/mode":1})");
  EXPECT_EQ(read.sample.axis, "x.1");
  EXPECT_DOUBLE_EQ(read.sample.position_m, 0.5);
  EXPECT_DOUBLE_EQ(read.sample.latency_us, 3);
  EXPECT_EQ(read.sample.mode, law::Mode::hold);
}

TEST(WatchDatagram, WhatIsLeftOutIsNotKnown) {
  const auto read = read_datagram(R"({"timestamp":1,"position_m":0.5})");
  EXPECT_TRUE(std::isnan(read.sample.target_m));
  EXPECT_FALSE(read.sample.mode);
  EXPECT_FALSE(read.sample.fault);
  EXPECT_EQ(read.sample.fault_code, 0);
}

TEST(WatchDatagram, NumbersThatNoEnumeratorHasAreNotKnown) {
  for (const char* number : {"-1", "250", "99999999999", "1.5"}) {
    const auto read = read_datagram(R"({"timestamp":1,"position_m":0,"mode":)" + std::string{number} + "}");
    EXPECT_FALSE(read.sample.mode) << number;
  }
}

TEST(WatchDatagram, BytesThatAreNoSampleAreRefused) {
  for (const char* text : {"", "{", "null", "[]", "[1,2]", "7", "\"timestamp\"", "{\"timestamp\":1}",
                           "{\"position_m\":1}", "{\"timestamp\":\"1\",\"position_m\":1}",
                           "{\"timestamp\":1,\"position_m\":null}", "{\"timestamp\":1,\"position_m\":[1]}",
                           "{\"timestamp\":1,\"position_m\":1e999}", "{\"timestamp\":1,\"position_m\":NaN}"})
    EXPECT_NE(refusal([&] { read_datagram(text); }).find("breakaway-node --stream"), std::string::npos) << text;
  const std::string long_name(1000, 'x');
  EXPECT_NE(refusal([&] { read_datagram(R"({"timestamp":1,")" + long_name + R"(/position_m":1})"); }), "");
}

TEST(WatchDatagram, NoBytesBringItDown) {
  std::mt19937 random{20261123};
  int refused = 0;
  constexpr int tries = 20'000;
  for (int n = 0; n < tries; ++n) {
    std::string text = node_sample;
    for (int changes = 1 + n % 4; changes > 0; --changes) text[random() % text.size()] = static_cast<char>(random());
    if (n % 3 == 0) text.resize(random() % text.size());
    if (!refusal([&] { read_datagram(text); }).empty()) ++refused;
  }
  EXPECT_GT(refused, tries / 3);
  const std::string deep(60'000, '[');
  EXPECT_NE(refusal([&] { read_datagram(deep); }), "");
  EXPECT_NE(refusal([&] { read_datagram("{\"a\":" + deep + std::string(60'000, ']') + "}"); }), "");
}

}  // namespace
