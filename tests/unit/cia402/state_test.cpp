#include "breakaway/cia402/state.hpp"

#include <gtest/gtest.h>

namespace {

using namespace breakaway::cia402;

struct Row {
  State state;
  unsigned mask, value;
};
// CiA 402-2, the table of the statusword's state coding.
constexpr Row rows[] = {{State::not_ready_to_switch_on, 0x4F, 0x00}, {State::switch_on_disabled, 0x4F, 0x40},
                        {State::ready_to_switch_on, 0x6F, 0x21},     {State::switched_on, 0x6F, 0x23},
                        {State::operation_enabled, 0x6F, 0x27},      {State::quick_stop_active, 0x6F, 0x07},
                        {State::fault_reaction_active, 0x4F, 0x0F},  {State::fault, 0x4F, 0x08}};

TEST(State, EveryStatuswordDecodesAsTheTableSays) {
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    std::optional<State> expected;
    for (const Row& row : rows) {
      if ((word & row.mask) != row.value) continue;
      ASSERT_FALSE(expected.has_value()) << "the table is ambiguous for " << word;
      expected = row.state;
    }
    ASSERT_EQ(state_of(static_cast<std::uint16_t>(word)), expected) << word;
  }
}

TEST(State, BitsOfAStateDecodeToIt) {
  for (const Row& row : rows) {
    EXPECT_EQ(state_of(status_bits(row.state)), row.state);
    EXPECT_EQ(state_of(static_cast<std::uint16_t>(status_bits(row.state) | 0x1E90U)), row.state);
  }
}

TEST(State, HasTheNamesOfTheProfile) {
  EXPECT_EQ(to_string(State::not_ready_to_switch_on), "Not ready to switch on");
  EXPECT_EQ(to_string(State::switch_on_disabled), "Switch on disabled");
  EXPECT_EQ(to_string(State::ready_to_switch_on), "Ready to switch on");
  EXPECT_EQ(to_string(State::switched_on), "Switched on");
  EXPECT_EQ(to_string(State::operation_enabled), "Operation enabled");
  EXPECT_EQ(to_string(State::quick_stop_active), "Quick stop active");
  EXPECT_EQ(to_string(State::fault_reaction_active), "Fault reaction active");
  EXPECT_EQ(to_string(State::fault), "Fault");
}

TEST(State, OneThatIsNoneShowsNoBitsAndHasNoName) {
  const auto none = static_cast<State>(200);
  EXPECT_EQ(status_bits(none), 0);
  EXPECT_EQ(to_string(none), "unknown state");
}

TEST(State, SaysWhatMayKeepADriveFromBeingEnabled) {
  EXPECT_EQ(what_keeps_disabled(0x0250), "Switch on disabled: STO, or no supply of the power stage?");
  EXPECT_EQ(what_keeps_disabled(0x0231), "Ready to switch on: no supply of the power stage?");
  for (const Row& row : rows)
    EXPECT_TRUE(what_keeps_disabled(static_cast<std::uint16_t>(row.value)).starts_with(to_string(row.state)));
  EXPECT_EQ(what_keeps_disabled(0x0001), "no state of CiA 402");
}

TEST(State, ShowsForceOrProvesThatThereIsNone) {
  for (const Row& row : rows) {
    const auto word = static_cast<std::uint16_t>(row.value);
    EXPECT_EQ(shows_force(word), is_energised(row.state));
    EXPECT_EQ(shows_no_force(word), is_without_force(row.state));
  }
  EXPECT_FALSE(shows_force(0x0001) || shows_no_force(0x0001)) << "no state, no proof";
  EXPECT_FALSE(shows_force(0x0000) || shows_no_force(0x0000)) << "not ready: no proof";
}

}  // namespace
