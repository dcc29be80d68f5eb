// Every pin that a board may use, and every one that it may not.
#include "breakaway/firmware/wiring.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace breakaway::firmware::wiring_pins {
namespace {

std::string name_of(Pin p) { return std::string{static_cast<char>('A' + port_of(p))} + std::to_string(number_of(p)); }

// The names of the pins of ports A to P with which this wiring is possible.
template <class Change>
std::set<std::string> possible_pins(Wiring wiring, const Change& change) {
  std::set<std::string> names;
  for (char port = 'A'; port <= 'P'; ++port) {
    for (unsigned number = 0; number < 16; ++number) {
      const Pin p = pin(port, number);
      if (p == Pin::none) continue;
      change(wiring, p);
      if (is_possible(wiring)) names.insert(name_of(p));
    }
  }
  return names;
}

using Names = std::set<std::string>;

constexpr Wiring second_controller{.can_controller = 2, .can_receive = pin('B', 12), .can_transmit = pin('B', 13)};

TEST(Wiring, NamesPinsByPortAndNumber) {
  EXPECT_EQ(static_cast<int>(pin('A', 0)), 0);
  EXPECT_EQ(static_cast<int>(pin('C', 5)), 0x25);
  EXPECT_EQ(port_of(pin('G', 15)), 6U);
  EXPECT_EQ(number_of(pin('G', 15)), 15U);
}

TEST(Wiring, IsThatOfTheCommonBoardsUnlessToldOtherwise) {
  const Wiring w{};
  EXPECT_EQ(w.can_controller, 1);
  EXPECT_EQ(name_of(w.can_receive) + name_of(w.can_transmit), "B8B9");
  EXPECT_EQ(name_of(w.serial_receive) + name_of(w.serial_transmit), "A10A9");
  EXPECT_EQ(w.can_standby, Pin::none);
  EXPECT_FALSE(w.can_awake);
  EXPECT_EQ(w.serial_baud, 1'000'000U);
  EXPECT_TRUE(is_possible(w));
  EXPECT_TRUE(is_possible(second_controller));
}

TEST(Wiring, HasThePinsOfEachFunction) {
  const auto receive = [](Wiring& w, Pin p) { w.can_receive = p; };
  const auto transmit = [](Wiring& w, Pin p) { w.can_transmit = p; };
  EXPECT_EQ(possible_pins({}, receive), (Names{"A11", "B8", "D0"}));
  EXPECT_EQ(possible_pins({}, transmit), (Names{"A12", "B9", "D1"}));
  EXPECT_EQ(possible_pins(second_controller, receive), (Names{"B5", "B12"}));
  EXPECT_EQ(possible_pins(second_controller, transmit), (Names{"B6", "B13"}));
  EXPECT_EQ(possible_pins({}, [](Wiring& w, Pin p) { w.serial_receive = p; }), (Names{"A10", "B7"}));
  EXPECT_EQ(possible_pins({}, [](Wiring& w, Pin p) { w.serial_transmit = p; }), (Names{"A9", "B6"}));
}

TEST(Wiring, StandbyIsEveryPinThatNeitherTheBusNorTheDebuggerNeeds) {
  Names expected;
  for (char port = 'A'; port <= 'G'; ++port)
    for (unsigned number = 0; number < 16; ++number) expected.insert(name_of(pin(port, number)));
  for (const char* taken : {"A13", "A14", "B8", "B9"}) expected.erase(taken);
  EXPECT_EQ(possible_pins({}, [](Wiring& w, Pin p) { w.can_standby = p; }), expected);
}

TEST(Wiring, HasTwoControllersAndARangeOfBaudRates) {
  for (int controller = 0; controller < 256; ++controller) {
    Wiring first{.can_controller = static_cast<std::uint8_t>(controller)}, second = second_controller;
    second.can_controller = first.can_controller;
    EXPECT_EQ(is_possible(first), controller == 1);
    EXPECT_EQ(is_possible(second), controller == 2);
    EXPECT_EQ(is_possible({.rpu_can_controller = static_cast<std::uint8_t>(controller)}), controller <= 1);
  }
  for (const std::uint32_t baud : {9'600U, 115'200U, 5'250'000U}) EXPECT_TRUE(is_possible({.serial_baud = baud}));
  for (const std::uint32_t baud : {0U, 9'599U, 5'250'001U}) EXPECT_FALSE(is_possible({.serial_baud = baud}));
}

}  // namespace
}  // namespace breakaway::firmware::wiring_pins
