// [target]: from the file into what is flashed, or refused by name.
#include "breakaway/firmware/wiring.hpp"

#include <gtest/gtest.h>

#include <string>

#include "../refusal.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "two_axes.hpp"

namespace breakaway::config {
namespace {

using firmware::pin;
using firmware::Pin;
using firmware::Wiring;

Node node_with(const std::string& board) {
  return parse_node("[target.stm32f405]\n" + board + "\n" + testing::two_axes, "node.toml");
}

std::string refused(const std::string& board) {
  return breakaway::testing::refusal([&] { node_with(board); });
}

TEST(Wiring, IsThatOfTheFirstImagesWhereTheFileSaysNothing) {
  const Wiring w = parse_node(testing::two_axes, "node.toml").wiring;
  EXPECT_EQ(w.can_controller, 1);
  EXPECT_EQ(w.can_receive, pin('B', 8));
  EXPECT_EQ(w.can_transmit, pin('B', 9));
  EXPECT_EQ(w.can_standby, Pin::none);
  EXPECT_EQ(w.serial_baud, 1'000'000U);
  EXPECT_EQ(w.serial_transmit, pin('A', 9));
  EXPECT_EQ(w.serial_receive, pin('A', 10));
}

TEST(Wiring, OfTheFileIsFlashed) {
  const Node node = node_with(R"(
    can = 2
    can_receive = "PB12"
    can_transmit = "PB13"
    can_standby = "PC15"
    can_awake = "high"
    serial_baud = 500000
    serial_receive = "PB7"
    serial_transmit = "PB6")");
  const Wiring w = flashed<float>(node).wiring;
  EXPECT_EQ(w.can_controller, 2);
  EXPECT_EQ(w.can_receive, pin('B', 12));
  EXPECT_EQ(w.can_transmit, pin('B', 13));
  EXPECT_EQ(w.can_standby, pin('C', 15));
  EXPECT_TRUE(w.can_awake);
  EXPECT_EQ(w.serial_baud, 500'000U);
  EXPECT_EQ(w.serial_receive, pin('B', 7));
  EXPECT_EQ(w.serial_transmit, pin('B', 6));
  const std::string header = node_header(certified(node, examine(node)), node, examine(node));
  for (const char* line : {".can_controller = 2,", ".can_receive = pin('B', 12),", ".can_standby = pin('C', 15),",
                           ".can_awake = true,", ".serial_baud = 500000,"})
    EXPECT_NE(header.find(line), std::string::npos) << line;
}

TEST(Wiring, OfTheSecondControllerHasPinsOfItsOwnWhereTheFileNamesNone) {
  const Wiring w = node_with("can = 2").wiring;
  EXPECT_EQ(w.can_receive, pin('B', 5));
  EXPECT_EQ(w.can_transmit, pin('B', 6));
}

// DS8626, table 9.
TEST(Wiring, TakesEveryPinThatHasTheFunctionAndNoOther) {
  const auto takes = [](const char* key, const char* can) {
    std::string pins;
    for (char port = 'A'; port <= 'G'; ++port) {
      for (unsigned number = 0; number < 16; ++number) {
        const std::string name = std::string{'P', port} + std::to_string(number);
        if (refused(std::string{can} + "\n" + key + " = \"" + name + "\"").empty()) pins += name + " ";
      }
    }
    return pins;
  };
  EXPECT_EQ(takes("can_receive", "can = 1"), "PA11 PB8 PD0 ");
  EXPECT_EQ(takes("can_transmit", "can = 1"), "PA12 PB9 PD1 ");
  EXPECT_EQ(takes("can_receive", "can = 2"), "PB5 PB12 ");
  EXPECT_EQ(takes("can_transmit", "can = 2"), "PB6 PB13 ");
  EXPECT_EQ(takes("serial_receive", ""), "PA10 PB7 ");
  EXPECT_EQ(takes("serial_transmit", ""), "PA9 PB6 ");
}

TEST(Wiring, IsRefusedWithThePinsThatCan) {
  const std::string message = refused("can = 2\ncan_receive = \"PB8\"");
  for (const char* part : {"node.toml", "can_receive", "PB8", "CAN2", "PB5, PB12"})
    EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
}

TEST(Wiring, GivesNoPinTwoFunctions) {
  for (const char* taken : {"PB8", "PB9", "PA13", "PA14"})
    EXPECT_NE(refused("can_standby = \"" + std::string{taken} + "\"").find("needs"), std::string::npos) << taken;
  EXPECT_EQ(refused("can_standby = \"PB5\""), "");
  EXPECT_NE(refused("can_awake = \"high\"").find("add can_standby"), std::string::npos);
}

TEST(Wiring, HasTheControllerOfTheZynqUltraScaleToo) {
  const auto node = [](const std::string& can) {
    return parse_node("[target.zynqmp_r5]\ncan = " + can + "\n" + testing::two_axes, "node.toml");
  };
  EXPECT_EQ(parse_node(testing::two_axes, "node.toml").wiring.rpu_can_controller, 0);
  EXPECT_EQ(flashed<float>(node("1")).wiring.rpu_can_controller, 1);
  EXPECT_NE(breakaway::testing::refusal([&] { node("2"); }), "");
}

TEST(Wiring, RefusesWhatIsNoPinOrNoSpeed) {
  for (const char* name : {"", "B8", "PB", "PB16", "PB+8", "PH0", "pb8", "PB8 ", "PB008"})
    EXPECT_NE(refused("can_receive = \"" + std::string{name} + "\"").find("must be a pin"), std::string::npos) << name;
  EXPECT_NE(refused("can_receive = 8").find("must be a pin"), std::string::npos);
  EXPECT_NE(refused("can = 3"), "");
  EXPECT_NE(refused("serial_baud = 1200"), "");
  EXPECT_NE(refused("serial = 1000000"), "");
  EXPECT_NE(breakaway::testing::refusal([] { parse_node("[target.stm32]\n" + std::string{testing::two_axes}, "n"); }),
            "");
}

}  // namespace
}  // namespace breakaway::config
