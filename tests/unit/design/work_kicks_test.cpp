// What a motor and a load on a spring need for kicks of the coast "work", and what is said where they have it not.
#include "breakaway/design/work_kicks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../../../controller/design/src/work_checks.hpp"
#include "../law/belt_fixture.hpp"

namespace breakaway::design {
namespace {

using law::work_test::belt;

TEST(WorkDesign, IsPossibleOnlyWhereAllOfItIs) {
  WorkDesign<float> whole;
  whole.holds = whole.moves_load = whole.swing_is_counted = true;
  whole.floor_m = 1e-4, whole.reach_m = 1e-2;
  whole.kicks.approach.begin_m = 5e-3F;
  ASSERT_TRUE(whole.possible());
  void (*const spoilt[])(WorkDesign<float>&){[](auto& d) { d.holds = false; }, [](auto& d) { d.moves_load = false; },
                                             [](auto& d) { d.swing_is_counted = false; },
                                             [](auto& d) { d.floor_m = d.reach_m; },
                                             [](auto& d) { d.kicks.approach.begin_m = 2e-2F; }};
  for (const auto& spoil : spoilt) {
    WorkDesign<float> one = whole;
    spoil(one);
    EXPECT_FALSE(one.possible()) << &spoil - spoilt;
  }
}

struct Refused {
  const char* what;
  void (*spoil)(BrakedClass&);
  std::vector<std::string> checks;  // those that fail, in their order
  const char* said;                 // of the last
};

TEST(WorkChecks, EndAtWhatNothingCanBeSaidBeyond) {
  const Refused rows[] = {{"all of the motor's friction is used up",
                           [](BrakedClass& c) { c.load_N = 1.25; },
                           {"motor_holds_the_load_force"},
                           "feed a known force forward"},
                          {"a swing of 400 periods",
                           [](BrakedClass& c) { c.spring_load->stiffness_N_per_m /= 400; },
                           {"swing_is_counted"},
                           "the periods of a swing against those of the longest pulse: 400 is not at most 255"},
                          {"less force than friction",
                           [](BrakedClass& c) { c.max_force_N = 4.5; },
                           {"pulse_moves_the_load"},
                           "the least sure pulse of a swing against max_force_N: 4.534 is not at most 4.5"},
                          {"hardly more force than friction",
                           [](BrakedClass& c) { c.max_force_N = 4.6; },
                           {"kicks_get_on", "kicks_go_on_from_the_approach", "kicks_reach_the_tolerance"},
                           "use a finer encoder, or a stronger drive"}};
  for (const Refused& row : rows) {
    AxisDesign axis{.position_tolerance_m = 1e-3, .work = belt()};
    row.spoil(*axis.work);
    const auto design = design_work_kicks<float>(*axis.work);
    EXPECT_FALSE(design.possible()) << row.what;
    std::vector<std::string> failed;
    std::string last;
    for (const Check& check : detail::work_checks(axis, design))
      if (!check.holds) failed.push_back(check.name), last = check.reason;
    EXPECT_EQ(failed, row.checks) << row.what;
    EXPECT_NE(last.find(row.said), std::string::npos) << row.what << ": " << last;
  }
}

// Where the mass is known to a hair, the force gain alone decides how far a metered pulse goes at least.
TEST(WorkDesign, AsksForMoreRoomTheLessIsKnownOfTheForceGain) {
  BrakedClass unknown = belt();
  unknown.force_gain = {0.9, 1.1};
  const auto known = design_work_kicks<float>(belt()), design = design_work_kicks<float>(unknown);
  EXPECT_TRUE(design.possible());
  EXPECT_GE(design.floor_m, known.floor_m);
  EXPECT_GT(design.pulse_needed_N, known.pulse_needed_N);
}

}  // namespace
}  // namespace breakaway::design
