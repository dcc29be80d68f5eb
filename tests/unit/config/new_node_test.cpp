#include "breakaway/config/new_node.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "../number_after.hpp"
#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

using breakaway::testing::number_after;
using breakaway::testing::refusal;

constexpr KnownAxis table{12, 15, 28, 5e-7, 1000, 200, 0.4};

TEST(NewNode, IsAFileThatIsCertifiedWithTheLeastToleranceOfTwoDigits) {
  const NewNode made = new_node(table);
  const double least_m = made.report.braked->least_tolerance_m;
  const double tolerance_m = made.node.axes.front().controller.position_tolerance_m;
  EXPECT_TRUE(made.report.certified);
  EXPECT_GE(tolerance_m, least_m);
  EXPECT_LE(tolerance_m, 1.1 * least_m);
  EXPECT_NE(made.text.find("position_tolerance_m = 1.2e-06"), std::string::npos) << made.text;
  EXPECT_FALSE(made.report.braked->fine_stage);
}

TEST(NewNode, DescribesTheAxisThatIsKnown) {
  const Node node = new_node(table).node;
  const Axis& axis = node.axes.front();
  EXPECT_EQ(axis.mass_kg, 12);
  EXPECT_EQ(axis.friction.bounds.lower_N, 15);
  EXPECT_EQ(axis.friction.bounds.upper_N, 28);
  EXPECT_EQ(axis.drive->encoder_resolution_m, 5e-7);
  EXPECT_EQ(axis.controller.max_force_N, 200);
  EXPECT_EQ(node.loop->period, std::chrono::milliseconds{1});
}

TEST(NewNode, HasALineThatTakesFramesOfOthersInAtThePriceOfAccuracy) {
  const NewNode made = new_node(table);
  std::string text = made.text;
  const std::string comment = "# jitter_s = ";
  ASSERT_NE(text.find(comment), std::string::npos);
  text.erase(text.find(comment), 2);
  const Axis axis = parse_node(text, "axis.toml").axes.front();
  EXPECT_EQ(axis.uncertainty.jitter_s, 135e-6) << "the longest frame at 1 Mbit/s";
  const double least_m = examine(parse_node(text, "axis.toml")).front().braked->least_tolerance_m;
  EXPECT_GT(least_m, made.report.braked->least_tolerance_m);
}

TEST(NewNode, NamesTheNumberThatIsImpossible) {
  const auto why = [](auto change) {
    KnownAxis known = table;
    change(known);
    return refusal([&] { new_node(known); });
  };
  EXPECT_NE(why([](KnownAxis& k) { k.mass_kg = 0; }).find("the mass is 0"), std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) { k.rate_Hz = std::nan(""); }).find("the rate is nan"), std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) { k.longest_move_m = -1; }).find("the longest move is -1"), std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) {
              k.encoder_resolution_m = std::numeric_limits<double>::infinity();
            }).find("the count of the encoder is inf"),
            std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) { k.friction_lower_N = 28; }).find("must be below the upper"), std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) { k.max_force_N = 28; }).find("stronger drive"), std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) { k.max_force_N = 28.1; }).find("pulse_breaks_away"), std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) { k.encoder_resolution_m = 2; }).find("the count of the encoder is 2 m, outside"),
            std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) { k.mass_kg = 1e12; }).find("the mass is 1e+12 kg, outside"), std::string::npos);
  const std::string coarse = why([](KnownAxis& k) { k.encoder_resolution_m = 1; });
  EXPECT_NE(coarse.find("give a longer move, a finer encoder or a higher rate"), std::string::npos) << coarse;
  EXPECT_EQ(coarse.find("the new file"), std::string::npos) << coarse << ": there is none";
  const std::string counts = why([](KnownAxis& k) {
    k.encoder_resolution_m = 1e-9;
    k.longest_move_m = 2.5;
  });
  // The approach passes its target by more than 32 bits count.
  const std::string beyond = why([](KnownAxis& k) { k = {1, 2.5, 25, 1e-9, 100, 50, 0.5}; });
  EXPECT_NE(beyond.find("32 bits count less than 2.147 m"), std::string::npos) << beyond;
  for (const char* part : {"the longest move, 2.5 m", "6.4 m", "2.147 m", "1e-09 m a count", "3.1e-09 m at least"})
    EXPECT_NE(counts.find(part), std::string::npos) << part << " in " << counts;
  EXPECT_EQ(why([](KnownAxis& k) {
              k.encoder_resolution_m = 3.1e-9;
              k.longest_move_m = 2.5;
            }).find("32 bits"),
            std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) { k.rate_Hz = 4000; }).find("does not fit a [bus]"), std::string::npos);
  EXPECT_NE(why([](KnownAxis& k) {
              k.mass_kg = 1e-9;
              k.max_force_N = 1e9;
            }).find("the force, 1e+09 N, would give the mass, 1e-09 kg"),
            std::string::npos);
}

// 240 kg with 1.7 N to spare: far away a float hides that it sets off, and the travel is more than twice the move.
TEST(NewNode, IsForbiddenOverWaysOnWhichAFloatHidesThatASlowAxisSetsOff) {
  KnownAxis slow{240.13, 2.3405, 2.34284, 1.34e-7, 1000, 4.0482, 91.21};
  const std::string said = refusal([&] { new_node(slow); });
  EXPECT_NE(said.find("a float does not tell so slow an axis from one that sticks"), std::string::npos) << said;
  slow.longest_move_m = 0.3 * number_after(said, "over more than ");
  EXPECT_TRUE(new_node(slow).report.certified) << said;
}

// So that whoever types them in one by one hears of it at the number that is wrong.
TEST(NewNode, IsForbiddenByTheNumbersThatAreSaidSoFar) {
  const auto why = [](const KnownAxis& known) { return refusal([&] { require_possible_so_far(known); }); };
  EXPECT_EQ(why({}), "");
  EXPECT_EQ(why({.friction_lower_N = 28}), "");
  EXPECT_NE(why({.friction_lower_N = 28, .friction_upper_N = 15}).find("must be below the upper"), std::string::npos);
  EXPECT_NE(why({.friction_upper_N = 15, .max_force_N = 15}).find("stronger drive"), std::string::npos);
  EXPECT_EQ(why({.encoder_resolution_m = 1e-9}), "");
  EXPECT_NE(why({.encoder_resolution_m = 1e-9, .longest_move_m = 2.5}).find("32 bits"), std::string::npos);
  EXPECT_NE(why({.rate_Hz = 300}).find("take 250 or 312.5 Hz"), std::string::npos);
  EXPECT_NE(why({.mass_kg = 1e12}).find("check its unit"), std::string::npos);
}

TEST(NewNode, NamesRatesThatWork) {
  const auto with_rate = [](double rate_Hz) {
    KnownAxis known = table;
    known.rate_Hz = rate_Hz;
    return known;
  };
  const auto why = [&](double rate_Hz) { return refusal([&] { new_node(with_rate(rate_Hz)); }); };
  EXPECT_NE(why(300).find("the rate, 300 Hz"), std::string::npos) << why(300);
  EXPECT_NE(why(300).find("take 250 or 312.5 Hz"), std::string::npos) << why(300);
  EXPECT_NE(why(11).find("take 10 or 12.5 Hz"), std::string::npos) << why(11);
  EXPECT_NE(why(4000).find("take 2000 Hz or less"), std::string::npos) << why(4000);
  EXPECT_NE(why(9).find("10 Hz at least"), std::string::npos) << why(9);
  for (const double rate_Hz : {10.0, 12.5, 250.0, 312.5, 2000.0}) EXPECT_EQ(why(rate_Hz), "") << rate_Hz;
}

TEST(NewNode, WritesAnyForceSoThatItsDriveGivesIt) {
  for (const double force_N : {0.118123, 0.0567, 0.00123456, 1.23456, 9999.6, 123456.7}) {
    const double scale = force_N / table.max_force_N;
    KnownAxis known = table;
    known.mass_kg *= scale;
    known.friction_lower_N *= scale;
    known.friction_upper_N *= scale;
    known.max_force_N = force_N;
    NewNode made;
    EXPECT_EQ(refusal([&] { made = new_node(known); }), "") << force_N;
    ASSERT_FALSE(made.node.axes.empty());
    const Axis& axis = made.node.axes.front();
    EXPECT_LE(axis.controller.max_force_N, force_N);
    EXPECT_GE(axis.controller.max_force_N, 0.999 * force_N);
    EXPECT_NEAR(axis.drive->max_force_N(), axis.controller.max_force_N, 1e-9 * force_N);
  }
}

// Over a short move, or with a coarse encoder, an axis does not reach the speed that an approach must be allowed.
TEST(NewNode, AllowsTheSpeedThatIsCertifiedWhateverTheMoveLetsTheAxisReach) {
  const KnownAxis short_move{12, 15, 28, 2e-6, 2000, 60, 1e-5};
  const KnownAxis coarse{12, 15, 28, 0.5, 1000, 200, 0.4};
  const KnownAxis fast{1e-8, 15, 28, 1e-2, 1000, 200, 1e6};
  for (const KnownAxis& known : {short_move, coarse, fast}) {
    NewNode made;
    EXPECT_EQ(refusal([&] { made = new_node(known); }), "") << known.longest_move_m << " m";
    EXPECT_TRUE(made.report.certified) << known.longest_move_m << " m";
  }
}

// With friction of up to twenty times its least the kicks to the least tolerance are more than the law has.
TEST(NewNode, WidensTheToleranceToWhereTheKicksAreFew) {
  const KnownAxis wide_bounds{12, 15, 280, 5e-7, 1000, 2000, 0.4};
  NewNode made;
  EXPECT_EQ(refusal([&] { made = new_node(wide_bounds); }), "");
  ASSERT_TRUE(made.report.certified);
  const double tolerance_m = made.node.axes.front().controller.position_tolerance_m;
  EXPECT_GT(tolerance_m, 1.5 * made.report.braked->least_tolerance_m);
  EXPECT_LE(tolerance_m, 1.2e-3);
  EXPECT_GT(made.report.braked->most_kicks, 115) << "no wider than that takes";
}

// Masses of 50 g to 200 kg, bounds a quarter to 0.95 apart, drives of twice to twenty times the friction.
TEST(NewNode, CertifiesARandomAxisOrSaysInOneSentenceWhatForbidsIt) {
  std::mt19937_64 bits{14};
  const auto decades = [&](double low, double high) {
    return low * std::pow(high / low, std::uniform_real_distribution<>{0, 1}(bits));
  };
  int certified = 0;
  constexpr int axes = 30;
  for (int i = 0; i < axes; ++i) {
    KnownAxis known;
    known.mass_kg = decades(0.05, 200);
    known.friction_upper_N = known.mass_kg * decades(0.3, 10);
    known.friction_lower_N = known.friction_upper_N * decades(0.25, 0.95);
    known.encoder_resolution_m = decades(1e-8, 1e-4);
    known.rate_Hz = i % 3 == 0 ? 250 : i % 3 == 1 ? 1000 : 2000;
    known.max_force_N = known.friction_upper_N * decades(2, 20);
    known.longest_move_m = decades(0.01, 2);
    std::string why;
    try {
      const NewNode made = new_node(known);
      EXPECT_TRUE(made.report.certified) << made.text;
      EXPECT_EQ(parse_node(made.text, "again").axes.front().mass_kg, known.mass_kg);
      ++certified;
    } catch (const InputError& error) {
      why = error.what();
      EXPECT_GT(why.size(), 40U) << why;
    }
  }
  EXPECT_GE(certified, axes * 9 / 10);
}

}  // namespace
}  // namespace breakaway::config
