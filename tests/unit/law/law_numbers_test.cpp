// What the law's numbers must be, what they are unless told otherwise, and what a user reads of them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "../../two_mass_axis.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "law_fixture.hpp"

namespace breakaway::law {
namespace {

using breakaway::testing::axes_of_the_scenes;
using testing::sampled_axis;

template <class E>
void expect_sentences(std::initializer_list<std::string_view> sentences) {
  int value = 0;
  for (const std::string_view sentence : sentences) EXPECT_EQ(to_string(static_cast<E>(value++)), sentence);
  EXPECT_TRUE(to_string(static_cast<E>(value)).starts_with("unknown")) << "a value has no row here";
  EXPECT_EQ(to_string(static_cast<E>(200)), to_string(static_cast<E>(value)));
}

TEST(LawSentences, NameWhatIsWrong) {
  expect_sentences<ParameterError>(
      {"parameters are valid", "mass must be positive and finite", "stiffness k1 must be positive and finite",
       "approach damping k21 must satisfy 0 < k21 < 2 sqrt(k1 m)", "kick damping k22 must exceed 2 sqrt(k1 m)",
       "lower friction bound must be positive and finite",
       "upper friction bound must be finite and not below the lower one",
       "force limit must exceed the upper friction bound, or no kick is sure to move the axis",
       "feedforward must be a number", "approach speed limit must be positive",
       "position tolerance must not be negative", "encoder resolution must not be negative",
       "flicker of the encoder must not be negative", "control period must not be negative",
       "coasts \"brake\" and \"work\" need a control period and an encoder resolution above 0"});
  expect_sentences<Mode>({"approach", "kick", "coast", "hold", "fault"});
  expect_sentences<ControlFault>({"none", "measurement is not a number", "axis does not move under kicks",
                                  "position error grows under kicks", "kicks do not bring the axis to its target",
                                  "axis does not stop without force", "kicks show friction outside its stated bounds",
                                  "axis rests nearer than its spring lets a kick aim",
                                  "axis rests nearer than a kick is sure to move its load by"});
}

constexpr double inf = std::numeric_limits<double>::infinity(), tiny = std::numeric_limits<double>::min();

template <class Change>
ParameterError error_after(const Change& change) {
  auto p = sampled_axis<double>();
  change(p);
  return validate(p);
}

TEST(AxisParameterEdges, AreOnTheSideThatTheirSentencesSay) {
  using E = ParameterError;
  using P = AxisParameters<double>;
  const auto expect = [](E error, double P::*member, std::initializer_list<double> wrong,
                         std::initializer_list<double> right) {
    for (const double value : wrong) EXPECT_EQ(error_after([&](P& p) { p.*member = value; }), error) << value;
    for (const double value : right) EXPECT_EQ(error_after([&](P& p) { p.*member = value; }), E::none) << value;
  };
  expect(E::mass_not_positive, &P::mass_kg, {0, -1, inf, std::nan("")}, {1.2});
  expect(E::stiffness_not_positive, &P::stiffness_N_per_m, {0, inf}, {300});
  expect(E::approach_not_underdamped, &P::approach_damping_Ns_per_m, {0, -1, 40, std::nan("")}, {tiny, 39.9});
  expect(E::kick_not_overdamped, &P::kick_damping_Ns_per_m, {40, -60, inf, std::nan("")}, {40.1, 1e9});
  expect(E::max_force_below_friction, &P::max_force_N, {4.5, std::nan("")}, {4.6, inf});
  expect(E::feedforward_not_finite, &P::feedforward_N, {inf, -inf, std::nan("")}, {0, -3, 3, -100});
  expect(E::max_approach_speed_not_positive, &P::max_approach_speed_m_s, {0, -1}, {tiny, inf});
  expect(E::tolerance_negative, &P::position_tolerance_m, {-tiny, inf}, {0, 1});
  expect(E::encoder_resolution_negative, &P::encoder_resolution_m, {-tiny, inf}, {0, 1});
  expect(E::flicker_negative, &P::flicker_m, {-tiny, inf, std::nan("")}, {0, 1});
  expect(E::period_negative, &P::period_s, {-tiny, inf}, {0, 1});
  const auto friction = [](double lower_N, double upper_N) {
    return error_after([=](P& p) { p.friction = {lower_N, upper_N}; });
  };
  EXPECT_EQ(friction(0, 4.5), E::friction_lower_not_positive);
  EXPECT_EQ(friction(inf, inf), E::friction_lower_not_positive);
  EXPECT_EQ(friction(4.5, 4.4), E::friction_bounds_reversed);
  EXPECT_EQ(friction(4.5, inf), E::friction_bounds_reversed);
  EXPECT_EQ(friction(4.5, 4.5), E::none);
}

// k^2 < 4 k1 m, whatever the mass and the stiffness.
TEST(AxisParameterEdges, DampingIsHeldAgainstMassAndStiffness) {
  for (const double mass_kg : {0.25, 4.0}) {
    for (const double stiffness : {100.0, 900.0}) {
      const double critical = 2 * std::sqrt(stiffness * mass_kg);
      const auto error = [&](double approach, double kick) {
        return error_after([&](auto& p) {
          p.mass_kg = mass_kg;
          p.stiffness_N_per_m = stiffness;
          p.approach_damping_Ns_per_m = approach * critical;
          p.kick_damping_Ns_per_m = kick * critical;
        });
      };
      EXPECT_EQ(error(0.99, 1.01), ParameterError::none);
      EXPECT_EQ(error(1.01, 1.01), ParameterError::approach_not_underdamped);
      EXPECT_EQ(error(0.99, 0.99), ParameterError::kick_not_overdamped);
    }
  }
}

TEST(AxisParameterEdges, BrakeAndWorkNeedAPeriodAndCounts) {
  using E = ParameterError;
  for (const Coast coast : {Coast::brake, Coast::work}) {
    const auto error = [&](double period_s, double resolution_m) {
      return error_after([=](auto& p) {
        p.coast = coast;
        p.period_s = period_s;
        p.encoder_resolution_m = resolution_m;
      });
    };
    EXPECT_EQ(error(0, 1e-6), E::brake_without_period);
    EXPECT_EQ(error(1e-3, 0), E::brake_without_period);
    EXPECT_EQ(error(tiny, tiny), E::none);
  }
}

TEST(AxisParameters, TellWhatTheyAmountTo) {
  auto p = sampled_axis<double>();
  p.flicker_m = 4e-6;
  for (const double feedforward_N : {-3.0, 3.0}) {
    p.feedforward_N = feedforward_N;
    EXPECT_EQ(p.total_force_N(), 53);
  }
  EXPECT_DOUBLE_EQ(p.unseen_m(), 9e-6);
  EXPECT_DOUBLE_EQ(p.stick_radius_upper_m(), p.friction.upper_N / 400);
  EXPECT_NEAR(p.accuracy_floor_m(), 1.8e-6, 1e-12);
  p.mass_kg = 2;
  EXPECT_NEAR(p.accuracy_floor_m(), 0.9e-6, 1e-12);
}

TEST(LawDefaults, AreThoseOfTheDocumentation) {
  const AxisParameters<float> p;
  EXPECT_EQ(p.max_force_N, std::numeric_limits<float>::infinity());
  EXPECT_EQ(p.max_approach_speed_m_s, std::numeric_limits<float>::infinity());
  EXPECT_EQ(p.latency_periods, 1);
  EXPECT_EQ(p.coast, Coast::pd);
  EXPECT_EQ(p.flicker_m + p.feedforward_N + p.position_tolerance_m + p.period_s + p.encoder_resolution_m, 0);
  const BrakedKicks<float> kicks;
  EXPECT_EQ(kicks.still_periods + kicks.either_way_periods + kicks.patient_periods + kicks.settling_periods, 0);
  EXPECT_EQ(kicks.spring.longest_periods + kicks.spring.ringing_periods, 0);
  EXPECT_FALSE(kicks.spring.is_there() || kicks.approach.move.are_asked_for());
  EXPECT_EQ(kicks.table.first + kicks.table.count, 0);
  EXPECT_FALSE(kicks.table.list);
  const WorkKicks<float> works;
  EXPECT_EQ(works.still_periods + works.patient_periods + works.longest_coast_periods, 0);
  EXPECT_FALSE(works.metered);
  EXPECT_EQ(works.approach.swing_periods, 1);
  EXPECT_EQ(works.approach.speed_periods, 1);
  EXPECT_EQ(works.approach.mean_periods, 0);
  EXPECT_EQ(Pulse<float>{}.periods + Pulse<float>{}.cut_periods, 0);
  EXPECT_TRUE(Measurement<float>{}.fresh);
  EXPECT_EQ(ControlOutput<float>{}.mode, Mode::approach);
  EXPECT_FALSE(ControlOutput<float>{}.kicked);
}

// Numbers of some size, so that the least above nothing can be told from one.
template <class Kicks, class Number>
void expect_lowest(const Kicks& sound, Number& number_of, bool zero_will_do) {
  Kicks changed = sound;
  number_of(changed) = 0;
  EXPECT_EQ(are_usable(changed), zero_will_do);
  number_of(changed) = std::numeric_limits<double>::min();
  EXPECT_TRUE(are_usable(changed));
  number_of(changed) = -std::numeric_limits<double>::min();
  EXPECT_FALSE(are_usable(changed));
}
constexpr bool may_be_zero = true, must_be_above_zero = false;

TEST(BrakedKicks, AreNotUsableWithANumberThatIsNone) {
  using Kicks = BrakedKicks<float>;
  using Approach = BrakedApproach<float>;
  const Kicks sound = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  EXPECT_TRUE(are_usable(sound));
  for (float Kicks::*const number :
       {&Kicks::brake_N, &Kicks::force_step_N, &Kicks::preload_N, &Kicks::resting_force_N, &Kicks::holding_force_N,
        &Kicks::fast_lag, &Kicks::slow_lag, &Kicks::short_lag, &Kicks::coast_per_N, &Kicks::breakaway_N,
        &Kicks::lost_motion_m, &Kicks::least_seen_N, &Kicks::most_seen_N}) {
    Kicks spoiled = sound;
    spoiled.*number = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(are_usable(spoiled));
  }
  for (float Approach::*const number :
       {&Approach::mass_kg, &Approach::friction_N, &Approach::hard_m_s2, &Approach::gentle_m_s2,
        &Approach::switch_speed_m_s, &Approach::switch_distance_m, &Approach::short_of_target_m, &Approach::response_s,
        &Approach::lag_s, &Approach::correction, &Approach::standing_m_s}) {
    Kicks spoiled = sound;
    spoiled.approach.*number = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(are_usable(spoiled));
  }
}

TEST(BrakedKicks, AreNotUsableWithATravelThatIsNotSure) {
  using Sure = SureTravel<float>;
  const BrakedKicks<float> sound = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  for (float Sure::*const number : {&Sure::share, &Sure::from_m, &Sure::most_m}) {
    BrakedKicks<float> spoiled = sound;
    spoiled.sure.*number = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(are_usable(spoiled));
  }
  BrakedKicks<float> spoiled = sound;
  spoiled.sure.share = 1.01F;
  EXPECT_FALSE(are_usable(spoiled)) << "no kick is sure to go further than it aims";
}

TEST(KickTable, WithoutACurveHasNoLeastDistance) {
  KickTable<float> table;
  EXPECT_EQ(table.least_m(), 0);
  EXPECT_EQ(table.reach_m(), 0);
  table = design::design_braked_kicks<float>(axes_of_the_scenes(0)).kicks.table;
  EXPECT_GT(table.least_m(), 0);
  table.count = 1;
  EXPECT_GT(table.least_m(), 0);
  table.list = true;
  EXPECT_EQ(table.least_m(), 0);
}

TEST(UsableKicks, HaveNoNumberAtOrBelowZeroThatMustBeAboveIt) {
  using K = BrakedKicks<double>;
  auto c = axes_of_the_scenes(1e-3);
  c.presliding_stiffness_N_per_m = 1e5;
  const K sound = design::design_braked_kicks<double>(c).kicks;
  ASSERT_TRUE(are_usable(sound));
  const auto expect = [&](bool zero_will_do, auto... number_of) {
    (expect_lowest(sound, number_of, zero_will_do), ...);
  };
  expect(
      must_be_above_zero, [](K& k) -> double& { return k.force_step_N; }, [](K& k) -> double& { return k.coast_per_N; },
      [](K& k) -> double& { return k.approach.mass_kg; }, [](K& k) -> double& { return k.approach.hard_m_s2; },
      [](K& k) -> double& { return k.approach.gentle_m_s2; },
      [](K& k) -> double& { return k.approach.switch_speed_m_s; },
      [](K& k) -> double& { return k.approach.switch_distance_m; },
      [](K& k) -> double& { return k.approach.response_s; }, [](K& k) -> double& { return k.approach.correction; },
      [](K& k) -> double& { return k.spring.gain_N_per_m; }, [](K& k) -> double& { return k.spring.most_N; });
  expect(
      may_be_zero, [](K& k) -> double& { return k.fast_lag; }, [](K& k) -> double& { return k.lost_motion_m; },
      [](K& k) -> double& { return k.approach.short_of_target_m; }, [](K& k) -> double& { return k.approach.lag_s; },
      [](K& k) -> double& { return k.approach.standing_m_s; }, [](K& k) -> double& { return k.fine_floor_m; },
      [](K& k) -> double& { return k.spring.share; });
}

TEST(UsableKicks, KeepTheOrderOfTheirNumbers) {
  using K = BrakedKicks<double>;
  const K sound = design::design_braked_kicks<double>(axes_of_the_scenes(1e-3)).kicks;
  const auto usable = [&](auto change) {
    K k = sound;
    change(k);
    return are_usable(k);
  };
  EXPECT_TRUE(usable([](K& k) { k.fast_lag = k.short_lag = k.slow_lag; }));
  EXPECT_FALSE(usable([](K& k) { k.fast_lag = std::nextafter(k.short_lag, 1.0); }));
  EXPECT_FALSE(usable([](K& k) { k.short_lag = std::nextafter(k.slow_lag, 1.0); }));
  EXPECT_FALSE(usable([](K& k) { k.slow_lag = 1; }));
  EXPECT_TRUE(usable([](K& k) { k.preload_N = k.brake_N; }));
  EXPECT_FALSE(usable([](K& k) { k.preload_N = std::nextafter(k.brake_N, 100.0); }));
  EXPECT_FALSE(usable([](K& k) { k.breakaway_N = k.holding_force_N; }));
  EXPECT_TRUE(usable([](K& k) { k.breakaway_N = std::nextafter(k.holding_force_N, 100.0); }));
  EXPECT_TRUE(usable([](K& k) { k.resting_force_N = -k.brake_N; }));
  EXPECT_FALSE(usable([](K& k) { k.resting_force_N = std::nextafter(-k.brake_N, -100.0); }));
  EXPECT_TRUE(usable([](K& k) { k.holding_force_N = k.brake_N; }));
  EXPECT_FALSE(usable([](K& k) { k.holding_force_N = std::nextafter(k.brake_N, 0.0); }));
  EXPECT_FALSE(usable([](K& k) { k.least_seen_N = k.most_seen_N; }));
  EXPECT_TRUE(usable([](K& k) { k.brake_N = k.preload_N = k.resting_force_N = 0; }));
  EXPECT_FALSE(usable([](K& k) { k.brake_N = k.preload_N = -0.1, k.resting_force_N = 0.2; }));
  EXPECT_TRUE(usable([](K& k) { k.approach.correction = 1; }));
  EXPECT_FALSE(usable([](K& k) { k.approach.correction = 1.01; }));
  EXPECT_TRUE(usable([](K& k) { k.approach.friction_N = 0.5; }));
  EXPECT_FALSE(usable([](K& k) { k.approach.friction_N = 0; }));
  for (std::uint16_t K::*const periods : {&K::still_periods, &K::either_way_periods, &K::patient_periods}) {
    EXPECT_TRUE(usable([=](K& k) { k.*periods = 1; }));
    EXPECT_FALSE(usable([=](K& k) { k.*periods = 0; }));
  }
  EXPECT_TRUE(usable([](K& k) { k.table.count = 1; }));
  EXPECT_FALSE(usable([](K& k) { k.table.count = 0; }));
  EXPECT_TRUE(usable([](K& k) { k.table.count = KickTable<double>::most_entries; }));
  EXPECT_FALSE(usable([](K& k) { k.table.count = KickTable<double>::most_entries + 1; }));
  EXPECT_FALSE(usable([](K& k) { k.spring.share = 1.01; }));
  EXPECT_TRUE(usable([](K& k) { k.spring.share = 1; }));
  EXPECT_FALSE(usable([](K& k) { k.spring.reach_m = -1e-9; }));
  EXPECT_FALSE(usable([](K& k) { k.spring = {1e-6, 0, 1.01 * k.approach.friction_N, 1, 1, 1, 1}; }));
  EXPECT_TRUE(usable([](K& k) { k.spring = {1e-6, 0, k.approach.friction_N, 1, 1, 1, 1}; }));
  EXPECT_FALSE(usable([](K& k) { k.spring = {1e-6, -1e-9, k.approach.friction_N, 1, 1, 1, 1}; }));
}

TEST(UsableKicks, OfTheCoastWorkHaveNoNumberAtOrBelowZeroThatMustBeAboveIt) {
  using K = WorkKicks<double>;
  K sound;
  sound.force_step_N = sound.breakaway_N = sound.friction_per_gain_N = sound.speeding_s_per_kg = sound.late_periods = 3;
  sound.still_periods = sound.patient_periods = sound.longest_coast_periods = 3;
  sound.approach = {3, 3, 3, 3, 3, 3, 3, 3, 3, 3};
  sound.table.count = 3;
  ASSERT_TRUE(are_usable(sound));
  const auto expect = [&](bool zero_will_do, auto... number_of) {
    (expect_lowest(sound, number_of, zero_will_do), ...);
  };
  expect(
      must_be_above_zero, [](K& k) -> double& { return k.force_step_N; },
      [](K& k) -> double& { return k.friction_per_gain_N; }, [](K& k) -> double& { return k.speeding_s_per_kg; },
      [](K& k) -> double& { return k.breakaway_N; }, [](K& k) -> double& { return k.late_periods; },
      [](K& k) -> double& { return k.approach.mass_kg; }, [](K& k) -> double& { return k.approach.acceleration_m_s2; },
      [](K& k) -> double& { return k.approach.begin_m; });
  expect(
      may_be_zero, [](K& k) -> double& { return k.slow_lag; }, [](K& k) -> double& { return k.lost_motion_m; },
      [](K& k) -> double& { return k.spring_m; }, [](K& k) -> double& { return k.creep_m; },
      [](K& k) -> double& { return k.approach.friction_N; },
      [](K& k) -> double& { return k.approach.stiffness_N_per_m; },
      [](K& k) -> double& { return k.approach.damping_Ns_per_m; },
      [](K& k) -> double& { return k.approach.short_of_target_m; });
  const auto usable = [&](auto change) {
    K k = sound;
    change(k);
    return are_usable(k);
  };
  for (std::uint16_t K::*const periods : {&K::still_periods, &K::patient_periods, &K::longest_coast_periods}) {
    EXPECT_TRUE(usable([=](K& k) { k.*periods = 1; }));
    EXPECT_FALSE(usable([=](K& k) { k.*periods = 0; }));
  }
  EXPECT_FALSE(usable([](K& k) { k.approach.swing_periods = 0; }));
  EXPECT_TRUE(usable([](K& k) { k.approach.swing_periods = 1; }));
  EXPECT_FALSE(usable([](K& k) { k.approach.speed_periods = 0; }));
  EXPECT_TRUE(usable([](K& k) { k.approach.speed_periods = 1; }));
  EXPECT_FALSE(usable([](K& k) { k.slow_lag = 1; }));
  EXPECT_FALSE(usable([](K& k) { k.table.count = 0; }));
  EXPECT_TRUE(usable([](K& k) { k.table.count = 1; }));
  EXPECT_TRUE(usable([](K& k) { k.table.count = KickTable<double>::most_entries; }));
  EXPECT_FALSE(usable([](K& k) { k.table.count = KickTable<double>::most_entries + 1; }));
  EXPECT_FALSE(usable([](K& k) { k.table.list = true; }));
}

TEST(AxisController, TellsWhatItSharesWithItsLoop) {
  auto p = sampled_axis<float>();
  p.feedforward_N = -2;
  const auto table = testing::ballistic_table(p, p.stick_radius_upper_m());
  const AxisController<float> pd{p, table};
  EXPECT_EQ(pd.period_s(), 1e-3F);
  EXPECT_EQ(pd.encoder_resolution_m(), 1e-6F);
  EXPECT_EQ(pd.max_force_N(), 52);
  EXPECT_EQ(pd.breakaway_N(), 4.5F);
  EXPECT_EQ(pd.lost_motion_m(), 0);
  EXPECT_EQ(pd.slow_lag(), 0);
  EXPECT_EQ(pd.parameters().mass_kg, 1);
  EXPECT_EQ(pd.move_time_s(1), 0);
  EXPECT_EQ(pd.seen_friction_N(), 0);
  EXPECT_EQ(pd.kicks(), 0U);
  auto c = axes_of_the_scenes(1e-3);
  c.load_N = 0.3;
  c.move = design::MoveRequest{0.4, 1, 20, {}};
  const auto kicks = design::design_braked_kicks<float>(c).kicks;
  p.coast = Coast::brake;
  const AxisController<float> braked{p, table, kicks};
  EXPECT_EQ(braked.breakaway_N(), kicks.breakaway_N);
  EXPECT_GT(kicks.breakaway_N, 4.5F);
  EXPECT_EQ(braked.slow_lag(), kicks.slow_lag);
  EXPECT_GT(kicks.slow_lag, 0);
  EXPECT_GT(braked.move_time_s(0.4F), 0.4F);
}

}  // namespace
}  // namespace breakaway::law
