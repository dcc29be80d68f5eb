// The pages that say what is assumed name the checks that hold it as `breakaway design` prints them.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "breakaway/design/report.hpp"
#include "example_axes.hpp"

namespace breakaway::design {
namespace {

using Names = std::set<std::string>;

// Behind a current loop and steps of force, and with a limit of its speed, which have checks of their own.
AxisDesign with_springs_law() {
  AxisDesign axis = testing::sprung_example();
  axis.current_loop_lag_s = 1e-4;
  axis.force_step_N = 0.025;
  axis.position_tolerance_m = 3e-6;
  axis.max_approach_speed_m_s = 1;
  return axis;
}

AxisDesign with_brake() {
  AxisDesign axis = with_springs_law();
  axis.braked = testing::braked_example().braked;
  return axis;
}

// Axes of which each check that there is looks at one.
std::vector<AxisDesign> axes_of_all_checks() {
  std::vector<AxisDesign> axes{with_springs_law(), with_brake(), with_brake(), with_brake(), with_springs_law()};
  axes[1].braked->move = MoveRequest{.distance_m = 0.5, .speed_m_s = 0.5, .acceleration_m_s2 = 20, .jerk_m_s3 = 2000};
  axes[2].braked->presliding_stiffness_N_per_m = 1e6;
  axes[3].braked->spring_load = SpringLoad{0.4, 0.6, 1e7, {1.3, 2.4}, {1.2, 2.1}};
  axes[4].position_tolerance_m = 1e-3;
  axes[4].work = axes[1].braked;
  axes[4].work->move.reset();
  axes[4].work->spring_load = SpringLoad{0.4, 0.6, 2.4e4, {1.25, 2.25}, {1.25, 2.25}};
  return axes;
}

Names printed() {
  Names names;
  for (const AxisDesign& axis : axes_of_all_checks())
    for (const Check& check : design_axis(axis).checks) names.insert(check.name);
  return names;
}

std::string last_cell(const std::string& row) {
  const auto end = row.find_last_of('|'), begin = row.find_last_of('|', end - 1);
  return row.substr(begin + 1, end - begin - 1);
}

// Of the tables whose last column says by what something is held: its words of code that look like a check.
void take_named(const std::string& page, Names& names) {
  std::ifstream file{BREAKAWAY_SOURCE_DIR "/controller/" + page};
  ASSERT_TRUE(file) << page;
  const std::regex check{"`([a-z0-9]+(_[a-z0-9]+)+)`"};
  bool in_table = false;
  for (std::string line; std::getline(file, line);) {
    in_table = line.starts_with('|') && (in_table || last_cell(line) == " held by ");
    if (!in_table) continue;
    const std::string cell = last_cell(line);
    for (std::sregex_iterator at{cell.begin(), cell.end(), check}, end; at != end; ++at) names.insert((*at)[1]);
  }
}

TEST(TheoryTables, NameEachCheckThatIsPrintedAndNoOther) {
  Names named;
  take_named("law/THEORY.md", named);
  take_named("design/THEORY.md", named);
  const Names checks = printed();
  EXPECT_GT(checks.size(), 55U);
  for (const std::string& check : checks) EXPECT_TRUE(named.contains(check)) << check << " is in no table";
  for (const std::string& name : named) EXPECT_TRUE(checks.contains(name)) << name << " is no check";
}

}  // namespace
}  // namespace breakaway::design
