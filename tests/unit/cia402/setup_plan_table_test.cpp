// The whole plan, step by step.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "breakaway/cia402/setup_plan.hpp"

namespace breakaway::cia402::setup_plan_table {
namespace {

using namespace std::chrono_literals;

// "w? 6071:00 2 0": what is done (r read, w write, n note, R recall, c check, C confirm), whether the drive may refuse
// it, where, and of a write the bytes and the value.
std::string line_of(const SetupStep& step) {
  constexpr std::array<char, 6> kinds{'r', 'w', 'n', 'R', 'c', 'C'};  // as the enumerators stand
  const char kind = kinds[static_cast<std::size_t>(step.kind)];
  char text[48];
  std::snprintf(text, sizeof text, "%c%c %04X:%02X %u %X", kind, step.optional ? '?' : '!',
                static_cast<unsigned>(step.index), static_cast<unsigned>(step.subindex),
                static_cast<unsigned>(step.size), static_cast<unsigned>(step.value));
  return text;
}

std::string lines_of(const DriveConfig<float>& drive, const hal::NetworkConfig& network) {
  const SetupPlan plan{drive, network};
  std::string text;
  for (const SetupStep& step : plan.steps()) text += line_of(step) + "\n";
  return text;
}

constexpr char force_off_and_rating[] =
    "w? 6040:00 2 0\nw? 6071:00 2 0\nr? 6041:00 0 0\nR? 1016:01 0 7F00FA\n"
    "r! 1000:00 0 0\nr! 6502:00 0 0\nr? 6075:00 0 0\nr! 6076:00 0 0\nr? 6072:00 0 0\nr? 607E:00 0 0\n"
    "r? 607B:01 0 0\nr? 607B:02 0 0\nr? 608F:01 0 0\nr? 608F:02 0 0\nr? 6091:01 0 0\nr? 6091:02 0 0\n"
    "r? 6092:01 0 0\nr? 6092:02 0 0\nr? 6041:00 0 0\n";
constexpr char bounds_of_force[] =
    "w? 60B2:00 2 0\nc? 60B2:00 2 0\nw? 6072:00 2 0\nr? 6072:00 0 0\n"
    "w? 605A:00 2 0\nC? 605A:00 2 0\nw? 605B:00 2 0\nC? 605B:00 2 0\n"
    "w? 605C:00 2 0\nC? 605C:00 2 0\nw? 605E:00 2 0\nC? 605E:00 2 0\nr? 6041:00 0 0\n";
constexpr char clock_of_1_ms[] =
    "w? 1016:01 4 7F00FA\nn? 1016:01 0 7F00FA\nw! 1017:00 2 64\n"
    "w? 1005:00 4 80\nc? 1005:00 4 80\nw? 1006:00 4 3E8\nw? 1007:00 4 0\nw? 60C2:01 1 1\nw? 60C2:02 1 FD\n";
constexpr char pdos_of_node_3[] =
    "w! 1400:01 4 80000203\nw! 1600:00 1 0\nw! 1600:01 4 60400010\nw! 1600:02 4 60710010\nw! 1600:00 1 2\n"
    "w! 1400:02 1 1\nw! 1400:01 4 203\nr? 6041:00 0 0\n"
    "w! 1800:01 4 C0000183\nw! 1A00:00 1 0\nw! 1A00:01 4 60410010\nw! 1A00:02 4 60640020\nw! 1A00:03 4 60770010\n"
    "w! 1A00:00 1 3\nw! 1800:02 1 1\nw! 1800:01 4 40000183\nr? 6041:00 0 0\n"
    "w? 1400:05 2 4\nw? 6007:00 2 1\n";
constexpr char torque_mode[] = "w! 6060:00 1 A\n";

TEST(SetupPlanTable, OfADriveThatNeedsNoHoming) {
  EXPECT_EQ(lines_of({.node_id = 3}, {.period = 1ms}),
            std::string{force_off_and_rating} + bounds_of_force + clock_of_1_ms + pdos_of_node_3 + torque_mode);
}

TEST(SetupPlanTable, OfADriveThatFindsItsHome) {
  const auto homing_lines = [](const HomingConfig& homing, bool inverted) {
    const std::string all = lines_of({.node_id = 3, .invert_direction = inverted, .homing = homing}, {.period = 1ms});
    const std::size_t before = all.find("w! 6098");
    return before == std::string::npos ? "" : all.substr(before, all.size() - before);
  };
  EXPECT_EQ(homing_lines({.home = Home::by_drive,
                          .position_counts = 500,
                          .method = -3,
                          .search_counts_s = 1,
                          .zero_counts_s = 1,
                          .acceleration_counts_s2 = 1},
                         false),
            std::string{"w! 6098:00 1 FD\nw! 6099:01 4 1\nw! 6099:02 4 1\nw! 609A:00 4 1\n"
                        "w! 607C:00 4 1F4\nC! 607C:00 4 1F4\nr? 6041:00 0 0\n"} +
                torque_mode);
  EXPECT_EQ(
      homing_lines({.home = Home::by_drive, .position_counts = 1, .method = 17}, true),
      std::string{"w! 6098:00 1 11\nw! 607C:00 4 FFFFFFFF\nC! 607C:00 4 FFFFFFFF\nr? 6041:00 0 0\n"} + torque_mode);
  EXPECT_EQ(homing_lines({.home = Home::by_drive, .method = 17}, false),
            std::string{"w! 6098:00 1 11\nw? 607C:00 4 0\nC? 607C:00 4 0\nr? 6041:00 0 0\n"} + torque_mode);
  EXPECT_EQ(homing_lines({.home = Home::none}, false), "");
}

}  // namespace
}  // namespace breakaway::cia402::setup_plan_table
