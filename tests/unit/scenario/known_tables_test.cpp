// The schema for editors is made of what the readers say while they read; here is held that they say all of it.
#include "breakaway/scenario/known_tables.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "breakaway/config/certificate_keys.hpp"
#include "breakaway/scenario/machine_scenario.hpp"

namespace {

using breakaway::config::KnownKey;
using breakaway::config::KnownRows;
using breakaway::config::KnownTables;
using breakaway::scenario::known_tables;
using breakaway::scenario::parse_any_scenario;

// The rows of a key, in every set of rows of a table.
std::vector<KnownKey> rows_of(const KnownTables& known, const std::string& table, const std::string& key) {
  std::vector<KnownKey> found;
  if (!known.tables().contains(table)) return found;
  for (const KnownRows& rows : known.tables().at(table))
    std::ranges::copy_if(rows, std::back_inserter(found), [&](const KnownKey& row) { return row.name == key; });
  return found;
}

TEST(KnownTables, NoTableAndNoKindOfOneIsForgotten) { EXPECT_EQ(known_tables().unread(), std::vector<std::string>{}); }

TEST(KnownTables, ATableThatNoFileHadIsNamed) {
  KnownTables known;
  parse_any_scenario(
      "[plant]\nmass_kg = 1\n[friction]\nlower_N = 2\nupper_N = 4\n[controller]\nk1_N_per_m = 1\nk21_Ns_per_m = 0.5\n"
      "k22_Ns_per_m = 3\n",
      "axis.toml", &known);
  const std::vector<std::string> unread = known.unread();
  for (const char* name : {"[drive]", "[plant.load]", "[law]", "[controller] kind = \"pid\""})
    EXPECT_EQ(std::ranges::count(unread, name), 1) << name;
  EXPECT_EQ(std::ranges::count(unread, "[plant]"), 0);
}

TEST(KnownTables, HaveEveryKeyThatACertificateKnows) {
  const KnownTables known = known_tables();
  for (const auto& [table, key, standing, remedy] : breakaway::config::certificate_keys()) {
    std::string name{table};
    if (table == "targets") name = "controller.targets";
    if (table == "quirks") name = "drive.quirks";
    if (table == "stm32f405" || table == "zynqmp_r5") name = "target." + name;
    EXPECT_FALSE(rows_of(known, name, std::string{key}).empty()) << "[" << name << "] " << key;
  }
}

TEST(KnownTables, SayWhatAKeyMayHoldAndWhatHoldsWithoutIt) {
  const KnownTables known = known_tables();
  const KnownKey mass = rows_of(known, "plant", "mass_kg").at(0);
  EXPECT_TRUE(mass.required);
  EXPECT_EQ(mass.expects, "a number in (0, 1e+12] kg");
  EXPECT_TRUE(mass.form.range.excludes_least);
  const KnownKey stops = rows_of(known, "loop", "fault_stops").at(0);
  EXPECT_FALSE(stops.required);
  EXPECT_EQ(stops.form.words, (std::vector<std::string>{"axis", "all"}));
  EXPECT_EQ(std::get<std::string>(*stops.usual), "axis");
  EXPECT_EQ(std::get<double>(*rows_of(known, "loop", "heartbeat_period_s").at(0).usual), 0.05);
  EXPECT_EQ(rows_of(known, "limits", "speed_m_s").at(0).usual, std::nullopt) << "no limit cannot be written";
  EXPECT_EQ(rows_of(known, "controller", "coast").at(0).usual, std::nullopt) << "without a loop it is another";
}

}  // namespace
