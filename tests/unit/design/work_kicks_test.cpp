// What a motor and a load on a spring need for kicks of the coast "work", and what is said where they have it not.
#include "breakaway/design/work_kicks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../../../controller/design/src/work_checks.hpp"
#include "../../../controller/design/src/work_trial.hpp"
#include "../law/belt_fixture.hpp"
#include "breakaway/law/shaped_move.hpp"

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

// Two masses without friction, which swing so far against each other, the side that is read led by the feedback of an
// approach: how far they swing after these periods.
double swing_m(const BrakedClass& c, const law::ShapedApproach<double>& approach, double stiffer, int periods,
               double first_m) {
  constexpr int steps = 200;
  const SpringLoad& load = *c.spring_load;
  const double K = stiffer * load.stiffness_N_per_m, h = c.period_s / steps, whole_kg = load.motor_kg + load.load_kg;
  law::ShapedApproach<double> led = approach;
  led.friction_N = 0;
  law::ShapedMove<double> move{led, c.period_s, 10, static_cast<std::uint8_t>(c.latency_periods)};
  std::vector<double> on_their_way_N(static_cast<std::size_t>(c.latency_periods));
  double x1 = first_m * load.load_kg / whole_kg, x2 = -first_m * load.motor_kg / whole_kg, v1 = 0, v2 = 0, given_N = 0;
  double last_m = 0;
  for (int k = 0; k < periods; ++k) {
    static_cast<void>(move.see(load.encoder_on_load ? x2 : x1, 0, 0));
    on_their_way_N.push_back(c.force_gain.most * move.force_N());
    const double force_N = on_their_way_N.front();
    on_their_way_N.erase(on_their_way_N.begin());
    for (int i = 0; i < steps; ++i) {
      given_N += c.lag_s.most > 0 ? (force_N - given_N) * (1 - std::exp(-h / c.lag_s.most)) : force_N - given_N;
      const double apart_m = x1 - x2, bent_m = apart_m - std::clamp(apart_m, -load.gap_m / 2, load.gap_m / 2);
      const double spring_N = bent_m == 0 && load.gap_m > 0 ? 0 : K * bent_m + load.damping_Ns_per_m * (v1 - v2);
      v1 += h * (given_N - spring_N) / load.motor_kg;
      v2 += h * spring_N / load.load_kg;
      x1 += h * v1;
      x2 += h * v2;
      if (k >= periods - 10) last_m = std::max(last_m, std::abs(x1 - x2));
    }
  }
  return last_m;
}

// A feedback that is no small force beside the spring's shifts the swing: to the first order this one let none grow,
// and in the loop it drove each to e times as much in four of it.
TEST(WorkDesign, LetsNoSwingGrowInTheLoopAsItRuns) {
  BrakedClass c = belt();
  c.period_s = 2e-3;
  c.latency_periods = 0;
  c.lag_s = {1.5e-4, 1.5e-4};
  c.force_gain = {0.957, 1.043};
  c.mass_kg = {12.9, 12.9};
  c.max_force_N = 258;
  c.friction = {14.4, 19.1};
  c.spring_load = SpringLoad{.motor_kg = 9.29,
                             .load_kg = 3.61,
                             .stiffness_N_per_m = 1.313e6,
                             .motor_friction = {7.2, 9.55},
                             .load_friction = {7.2, 9.55},
                             .encoder_on_load = true};
  const auto design = design_work_kicks<double>(c);
  EXPECT_LE(design.swing_growth, 0);
  for (const double stiffer : {1.0, 1.2, 1.5, 2.0, most_stiffer})
    EXPECT_LT(swing_m(c, design.kicks.approach, stiffer, 100, 1e-4), 1.5e-4) << stiffer;
}

BrakedClass belt_read_across_a_gap() {
  BrakedClass c = belt();
  c.spring_load->encoder_on_load = true;
  c.spring_load->gap_m = 1e-4;
  return c;
}

// Its first harmonic says to some per cent how far such an axis swings, wherever it begins, and more where its steps
// are rounded up.
TEST(WorkDesign, FindsTheSwingThatItsFeedbackKeepsUpAcrossAGap) {
  BrakedClass c = belt_read_across_a_gap();
  for (const int latency : {1, 2}) {
    c.latency_periods = latency;
    const auto design = design_work_kicks<double>(c);
    for (const double share : {0.7, 4.0}) {
      double swings_m = 0;
      for (const int periods : {3000, 3007, 3014})
        swings_m = std::max(swings_m, swing_m(c, design.kicks.approach, 1, periods, share * design.gap_swing.apart_m));
      EXPECT_GE(design.gap_swing.apart_m, 0.97 * swings_m) << latency << ", " << share;
      EXPECT_LE(design.gap_swing.apart_m, 1.1 * swings_m) << latency << ", " << share;
    }
    EXPECT_LT(swing_m(c, design.kicks.approach, most_stiffer, 3000, design.gap_swing.apart_m),
              design.gap_swing.apart_m);
  }
}

TEST(WorkDesign, CountsTheSwingAcrossAGapAndLessOfItTheMoreItsJointDamps) {
  BrakedClass c = belt_read_across_a_gap();
  SpringLoad& load = *c.spring_load;
  const auto loose = design_work_kicks<float>(c);
  EXPECT_GT(approach_beyond_m(c, loose, 10), loose.gap_swing.apart_m);
  load.damping_Ns_per_m = 0.1 * std::sqrt(load.stiffness_N_per_m * 0.24);
  const auto damped = design_work_kicks<float>(c);
  EXPECT_LT(damped.gap_swing.apart_m, 0.7 * loose.gap_swing.apart_m);
  EXPECT_GE(damped.gap_swing.apart_m, load.gap_m / 2);
  EXPECT_LT(approach_beyond_m(c, damped, 10), approach_beyond_m(c, loose, 10));
  load.gap_m = 0;
  EXPECT_EQ(design_work_kicks<float>(c).gap_swing.apart_m, 0);
}

// A slow swing was left before it had come to rest, with the motor far out, and counted as what the kick had gained: an
// axis was certified whose kicks led it nowhere.
TEST(WorkTrial, EndsWhereFrictionHoldsWhatTheSpringPulls) {
  for (const double swing_periods : {5.0, 20.0, 100.0, 250.0})
    for (const double force_N : {30.0, 60.0}) {
      detail::WorkTrial trial{.motor_kg = 4.2,
                              .load_kg = 0.42,
                              .stiffness_N_per_m = 22800,
                              .gap_m = 5e-6,
                              .motor_friction = {1.15, 1.15},
                              .load_friction = {10.4, 10.4},
                              .period_s = 0,
                              .latency_periods = 1,
                              .metered = false,
                              .encoder_on_load = false,
                              .most_travel_m = 0,
                              .late_periods = 2,
                              .bent_m = 4e-5};
      const double swing_s = 2 * std::numbers::pi / std::sqrt(trial.stiffness_N_per_m * (1 / 4.2 + 1 / 0.42));
      trial.period_s = swing_s / swing_periods;
      const auto end = trial.run(force_N, std::max(1, static_cast<int>(0.1 * swing_periods)));
      EXPECT_LE(std::abs(end.bent_m), 1.001 * 1.15 / trial.stiffness_N_per_m + trial.gap_m / 2)
          << swing_periods << " periods, " << force_N << " N";
    }
}

// A count that hides a swing has each kick wait for longer.
TEST(WorkDesign, SaysHowLongAnAxisMayComeNoNearer) {
  BrakedClass c = belt();
  const auto usual = design_work_kicks<float>(c);
  EXPECT_GT(without_progress_s(c, usual), 64 * usual.rest_s);
  EXPECT_LT(without_progress_s(c, usual), 60);
  c.encoder_resolution_m = 2e-3;
  const auto coarse = design_work_kicks<float>(c);
  EXPECT_GT(coarse.rest_s, 4 * usual.rest_s);
  EXPECT_GT(without_progress_s(c, coarse), 64 * coarse.rest_s);
}

// A stiffer joint, or a heavier motor, was named and seldom helped.
TEST(WorkChecks, NameADampingWithWhichSwingsEnd) {
  int refused = 0;
  for (const bool on_load : {false, true})
    for (const double gap_m : {0.0, 1e-4})
      for (const int latency : {0, 3}) {
        BrakedClass c = belt();
        c.latency_periods = latency;
        SpringLoad& load = *c.spring_load;
        load.encoder_on_load = on_load;
        load.gap_m = gap_m;
        load.stiffness_N_per_m *= 2;
        const auto against = [&] {
          const auto design = design_work_kicks<float>(c);
          std::string all;
          for (const Check& check : detail::work_checks({.position_tolerance_m = 1e-3, .work = c}, design))
            if (check.name.starts_with("swing_") && !check.holds) all += check.reason;
          return all;
        };
        const std::string before = against();
        if (before.empty()) continue;
        ++refused;
        const std::string named = "a damping_Ns_per_m of ";
        const auto place = before.find(named);
        ASSERT_NE(place, std::string::npos) << before;
        load.damping_Ns_per_m = std::stod(before.substr(place + named.size()));
        EXPECT_EQ(against(), "") << before;
      }
  EXPECT_GT(refused, 1);
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
