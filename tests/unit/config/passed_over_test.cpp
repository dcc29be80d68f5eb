// One file is read by the node and by the simulation. What the node passes over must be what the simulation reads, or a
// misspelt key would be found by one of them only.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "two_axes.hpp"

namespace breakaway::config {
namespace {

using testing::two_axes;
using testing::with;

// Table header and key of everything that the node passes over.
std::vector<std::pair<std::string, std::string>> passed_over_keys() {
  const FileRows rows = passed_over();
  const AxisRows axis = rows.axis(0);
  std::vector<std::pair<std::string, std::string>> keys;
  const auto add = [&](const std::string& table, const std::vector<Key>& more) {
    for (const Key& key : more) keys.emplace_back(table, key.name);
  };
  add("[bus]", rows.bus), add("[run]", rows.run), add("[loop]", rows.loop);
  add("[axis.plant]", axis.plant), add("[axis.friction]", axis.friction);
  add("[axis.controller]", axis.controller), add("[axis.drive]", axis.drive);
  add("", rows.root);
  return keys;
}

TEST(PassedOver, EveryKeyIsReadByTheSimulationInThatVeryTable) {
  ASSERT_GE(passed_over_keys().size(), 10U);
  const std::string text = with(two_axes, "duration_s = 1\n", "");
  for (const auto& [table, key] : passed_over_keys()) {
    const std::string other = key == "duration_s" ? "" : "duration_s = 1\n";
    const std::string complete = with(text, "[run]\n", "[run]\n" + other);
    const std::string row = key + " = [[]]\n";
    const std::string spoilt = table.empty() ? row + complete : with(complete, table + "\n", table + "\n" + row);
    // What the coast "work" is made for, and the bristles that a certificate must know.
    const bool read_by_both = key == "load" || key == "backlash" || key == "presliding";
    const std::string of_node = breakaway::testing::refusal([&] { parse_node(spoilt, "node.toml"); });
    EXPECT_EQ(of_node.empty(), !read_by_both) << table << key << ": " << of_node;
    const std::string message = breakaway::testing::refusal([&] { scenario::parse_scenario(spoilt, "node.toml"); });
    EXPECT_NE(message.find((table.empty() ? "" : table + " ") + key + " is an array"), std::string::npos)
        << table << key << ": " << message;
  }
}

TEST(PassedOver, NoKeyOfTheSimulationIsForgotten) {
  std::ostringstream source;
  source << std::ifstream{BREAKAWAY_SOURCE_DIR "/sim/scenario/src/read_scenario.cpp"}.rdbuf();
  const std::string text = source.str();
  const std::regex row{R"re((?:optional|required)\(\s*"(\w+)")re"};
  std::set<std::string> read, passed;
  for (std::sregex_iterator match{text.begin(), text.end(), row}, end; match != end; ++match) read.insert((*match)[1]);
  for (const auto& [table, key] : passed_over_keys()) passed.insert(key);
  EXPECT_EQ(read, passed);
}

TEST(PassedOver, EveryScenarioOfTheProjectThatIsANodeIsOneForBothReaders) {
  int nodes = 0;
  for (const auto& entry : std::filesystem::directory_iterator{BREAKAWAY_SOURCE_DIR "/sim/scenarios"}) {
    const auto any = scenario::read_any_scenario(entry.path());
    if (!std::holds_alternative<scenario::Scenario>(any)) continue;
    const Node node = read_node(entry.path());
    EXPECT_EQ(node.axes.size(), std::get<scenario::Scenario>(any).axes()) << entry.path();
    ++nodes;
  }
  EXPECT_GE(nodes, 3);
}

}  // namespace
}  // namespace breakaway::config
