// The page for users whose axis does not settle has every name that they may meet.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/identify/experiment_parameters.hpp"
#include "breakaway/law/control_types.hpp"

namespace breakaway {
namespace {

std::string page() {
  std::ifstream file{BREAKAWAY_SOURCE_DIR "/firmware/NOT_SETTLED.md"};
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// Calls use(name) for every enumerator from 1 on; returns how many there are.
template <class Enum, class Use>
int for_each_name(Use use) {
  int count = 0;
  for (; !to_string(static_cast<Enum>(count + 1)).starts_with("unknown"); ++count)
    use(std::string{to_string(static_cast<Enum>(count + 1))});
  return count;
}

// A name between the marks of a table or a list within a cell.
bool lists(std::string_view text, const std::string& name) {
  for (const char* before : {"| ", ", "})
    for (const char* after : {" |", ", "})
      if (text.find(before + name + after) != text.npos) return true;
  return false;
}

TEST(OutcomesPage, ListsEveryFaultOfAnAxis) {
  const std::string all = page();
  const std::size_t begin = all.find("## The names of faults"), end = all.find("Without a supervisor");
  ASSERT_LT(begin, end);
  const std::string faults = all.substr(begin, end - begin);
  const int count =
      for_each_name<firmware::AxisFault>([&](const std::string& name) { EXPECT_TRUE(lists(faults, name)) << name; });
  EXPECT_EQ(count, static_cast<int>(firmware::AxisFault::external_motion));
}

TEST(OutcomesPage, ListsEveryFaultOfTheLawAlone) {
  const std::string all = page();
  const int count = for_each_name<law::ControlFault>(
      [&](const std::string& name) { EXPECT_NE(all.find("\n| " + name + " | "), all.npos) << name; });
  EXPECT_EQ(count, static_cast<int>(law::ControlFault::below_floor));
}

TEST(OutcomesPage, ListsEveryEndingOfAnExperiment) {
  const std::string all = page();
  const int count = for_each_name<identify::Ending>([&](const std::string& name) {
    EXPECT_NE(all.find("\n| " + name.substr(0, name.find(':')) + " | "), all.npos) << name;
  });
  EXPECT_EQ(count, static_cast<int>(identify::Ending::not_a_number));
}

}  // namespace
}  // namespace breakaway
