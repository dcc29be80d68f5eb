#include "breakaway/cia402/overheard.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "breakaway/canopen/pdo.hpp"

namespace {

using namespace breakaway;
using namespace breakaway::cia402;

constexpr std::uint8_t node = 5;

hal::CanFrame feedback(std::uint16_t statusword, std::int32_t counts, std::int16_t torque) {
  const std::array<std::uint64_t, 3> values{statusword, static_cast<std::uint32_t>(counts),
                                            static_cast<std::uint16_t>(torque)};
  return canopen::pack_pdo(feedback_pdo(node), values);
}

hal::CanFrame command(std::int16_t torque) {
  const std::array<std::uint64_t, 2> values{0x000F, static_cast<std::uint16_t>(torque)};
  return canopen::pack_pdo(command_pdo(node), values);
}

TEST(Overheard, FeedbackIsInTheDirectionOfTheAxis) {
  const auto straight = overheard_feedback(feedback(0x0027, -70'000, 120), node, false);
  ASSERT_TRUE(straight);
  EXPECT_EQ(straight->state, hal::DriveState::enabled);
  EXPECT_EQ(straight->position_counts, -70'000);
  EXPECT_EQ(straight->torque_per_mille, 120);
  const auto turned = overheard_feedback(feedback(0x0027, -70'000, 120), node, true);
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->position_counts, 70'000);
  EXPECT_EQ(turned->torque_per_mille, -120);
}

TEST(Overheard, TheLeastNumbersHaveNoOtherSign) {
  const auto turned = overheard_feedback(feedback(0x0027, INT32_MIN, INT16_MIN), node, true);
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->position_counts, INT32_MIN);
  EXPECT_EQ(turned->torque_per_mille, INT16_MIN);
}

TEST(Overheard, ACommandIsInTheDirectionOfTheAxis) {
  EXPECT_EQ(overheard_command(command(-300), node, false), -300);
  EXPECT_EQ(overheard_command(command(-300), node, true), 300);
}

TEST(Overheard, OtherFramesAreNobodys) {
  EXPECT_FALSE(overheard_feedback(feedback(0, 0, 0), node + 1, false));
  EXPECT_FALSE(overheard_command(command(0), node + 1, false));
  hal::CanFrame cut = feedback(0, 0, 0);
  cut.size = 7;
  EXPECT_FALSE(overheard_feedback(cut, node, false));
}

TEST(Overheard, EveryStateOfTheDriveShows) {
  using hal::DriveState;
  for (const auto& [state, shown] : {std::pair{State::not_ready_to_switch_on, DriveState::disabled},
                                     {State::switch_on_disabled, DriveState::disabled},
                                     {State::ready_to_switch_on, DriveState::disabled},
                                     {State::switched_on, DriveState::disabled},
                                     {State::operation_enabled, DriveState::enabled},
                                     {State::quick_stop_active, DriveState::stopping},
                                     {State::fault_reaction_active, DriveState::stopping},
                                     {State::fault, DriveState::fault}}) {
    const auto heard = overheard_feedback(feedback(status_bits(state), 0, 0), node, false);
    ASSERT_TRUE(heard);
    EXPECT_EQ(heard->state, shown);
  }
  const auto none = overheard_feedback(feedback(0x0001, 0, 0), node, false);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->state, DriveState::configuring) << "bits that no state has";
}

}  // namespace
