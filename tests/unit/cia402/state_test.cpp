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

}  // namespace
