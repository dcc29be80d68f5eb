#include "breakaway/law/axis_controller.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "breakaway/design/pd_kicks.hpp"
#include "law_fixture.hpp"

namespace breakaway::law {
namespace {

using testing::ballistic_table;
using testing::sampled_axis;

class AxisControllerTest : public ::testing::Test {
 protected:
  AxisParameters<float> p = sampled_axis<float>();
  K3Table<float> table = ballistic_table(p, p.stick_radius_upper_m());
  KickTable<float> pulses = design::design_pd_kicks(p).table;
  AxisController<float> controller{p, table, pulses};

  ControlOutput<float> show(float x) {
    const ControlOutput<float> out = controller.update({x});
    testing::expect_nothing_with_a_fault(controller, out);
    return out;
  }
  ControlOutput<float> stand_still(float x, int periods) {
    ControlOutput<float> out;
    for (int i = 0; i < periods; ++i) out = show(x);
    return out;
  }
  // Stands still until the first kick starts.
  ControlOutput<float> first_kick(float x) {
    for (int i = 0; i < 100; ++i) {
      if (const auto out = show(x); out.kicked) return out;
    }
    ADD_FAILURE() << "no kick";
    return {};
  }
};

TEST_F(AxisControllerTest, ApproachesWithTheFirstDamping) {
  controller.update({-0.05F});
  const auto out = controller.update({-0.049F});
  EXPECT_EQ(out.mode, Mode::approach);
  EXPECT_NEAR(out.force_N, 400 * 0.049F - 32 * 1.0F, 1e-3);
}

TEST_F(AxisControllerTest, LimitsTheApproachSpeedFarAway) {
  for (int i = 0; i < 50; ++i) controller.update({-4.0F + 0.005F * static_cast<float>(i)});
  const auto out = controller.update({-4.0F + 0.005F * 50});
  EXPECT_NEAR(out.force_N, 0, 1.0) << "at the limit speed of 5 m/s the spring and the damper balance";
}

TEST_F(AxisControllerTest, KicksAnAxisThatRestsOutsideTheTolerance) {
  const auto kick = first_kick(-1e-4F);
  EXPECT_EQ(kick.mode, Mode::kick);
  EXPECT_GT(kick.force_N, p.friction.upper_N) << "less would not be sure to move it";
  EXPECT_EQ(controller.mode(), Mode::coast) << "a kick of one period is over with the next update";
}

TEST_F(AxisControllerTest, KicksTowardsTheTargetFromBothSidesAlike) {
  const auto from_below = first_kick(-1e-4F);
  controller.reset();
  const auto from_above = first_kick(1e-4F);
  EXPECT_EQ(from_below.force_N, -from_above.force_N);
}

TEST_F(AxisControllerTest, HoldsInsideTheTolerance) {
  stand_still(1e-6F, 30);
  EXPECT_EQ(controller.mode(), Mode::hold);
  EXPECT_EQ(controller.kicks(), 0U);
}

TEST_F(AxisControllerTest, LeavesHoldOnlyWhenMovedByMoreThanACount) {
  stand_still(1e-6F, 30);
  stand_still(3e-6F, 1);
  EXPECT_EQ(controller.mode(), Mode::hold);
  stand_still(1e-4F, 1);
  EXPECT_EQ(controller.mode(), Mode::coast);
  stand_still(1.0F, 1);
  stand_still(1e-6F, 30);
  EXPECT_EQ(controller.mode(), Mode::hold);
}

TEST_F(AxisControllerTest, StartsANewApproachWhenTheTargetMoves) {
  stand_still(0.0F, 30);
  ASSERT_EQ(controller.mode(), Mode::hold);
  controller.shift_target(0.5F);
  const auto out = controller.update({-0.5F});
  EXPECT_EQ(out.mode, Mode::approach);
  EXPECT_NEAR(out.force_N, 50, 1e-3) << "the jump of the error is not velocity";
}

TEST_F(AxisControllerTest, LetsAPulseEndOnTimeWhenASampleIsLost) {
  const auto start = first_kick(-5e-3F);
  ASSERT_EQ(controller.mode(), Mode::kick);
  int periods = 1;
  while (controller.mode() == Mode::kick) {
    const auto out = controller.update({0.0F, 0.0F, false});
    EXPECT_NEAR(out.force_N, start.force_N, 1e-4);
    ++periods;
  }
  EXPECT_LE(periods, 10);
}

TEST_F(AxisControllerTest, ConcludesNothingFromLostSamples) {
  controller.update({-1e-4F});
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(controller.update({0.0F, 0.0F, false}).kicked);
}

TEST_F(AxisControllerTest, KicksHarderWhenKicksDoNotMoveTheAxis) {
  const float first = first_kick(-2e-6F).force_N;
  float later = 0;
  for (int i = 0; i < 20; ++i) later = first_kick(-2e-6F).force_N;
  EXPECT_GT(later, first * 1.2F);
  EXPECT_LE(later, p.max_force_N);
}

TEST_F(AxisControllerTest, GivesUpByNameOnAJammedAxis) {
  stand_still(-2e-6F, 2000);
  EXPECT_EQ(controller.mode(), Mode::fault);
  EXPECT_EQ(controller.fault(), ControlFault::jammed);
  EXPECT_EQ(stand_still(-2e-6F, 1).force_N, 0);
  EXPECT_EQ(controller.update({std::nanf("")}).force_N, 0);
  EXPECT_EQ(controller.fault(), ControlFault::jammed) << "the first fault is the one to know";
  controller.reset();
  EXPECT_EQ(stand_still(-2e-6F, 1).mode, Mode::approach);
}

// It came inside its tolerance by less than a reading can tell, after kicks that all did nothing.
TEST_F(AxisControllerTest, GivesUpByNameOnAJammedAxisThatSeemsToBeInsideItsTolerance) {
  for (int kicks = 0; kicks < 64; ++kicks) first_kick(-2e-6F);
  ASSERT_EQ(controller.fault(), ControlFault::none);
  stand_still(-1.7e-6F, 30);
  EXPECT_EQ(controller.fault(), ControlFault::jammed);
}

TEST_F(AxisControllerTest, GivesUpByNameWhenTheErrorGrowsKickAfterKick) {
  float x = -1e-4F;
  for (int i = 0; i < 1000 && controller.fault() == ControlFault::none; ++i) {
    if (show(x).kicked) x *= -1.3F;
  }
  EXPECT_EQ(controller.fault(), ControlFault::diverging);
}

TEST_F(AxisControllerTest, GivesUpByNameWhenNoKickLeadsNearer) {
  int kicks = 0;
  for (int i = 0; i < 20'000 && controller.fault() == ControlFault::none; ++i) {
    if (show(kicks % 2 == 0 ? -1e-4F : 1e-4F).kicked) ++kicks;
  }
  EXPECT_EQ(controller.fault(), ControlFault::hunting);
  EXPECT_NEAR(kicks, KickJudge<float>::most_kicks, 2);
}

// What is pushed out of its hold now and then is brought back each time, however often that is.
TEST_F(AxisControllerTest, DoesNotTakePushesForHunting) {
  for (int push = 0; push < 300; ++push) {
    stand_still(0, 500);
    ASSERT_EQ(controller.mode(), Mode::hold) << "after " << push << " pushes: " << to_string(controller.fault());
    first_kick(5e-6F);
    first_kick(4e-6F);
  }
}

TEST_F(AxisControllerTest, LatchesAFaultOnAMeasurementThatIsNoNumber) {
  for (const float bad :
       {std::nanf(""), std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
    controller.reset();
    EXPECT_EQ(show(bad).force_N, 0);
    EXPECT_EQ(controller.update({0.01F}).mode, Mode::fault) << "latched";
    EXPECT_EQ(controller.fault(), ControlFault::not_a_number);
  }
}

TEST_F(AxisControllerTest, LatchesAFaultWhenTheVelocityOverflows) {
  controller.update({0.01F});
  EXPECT_EQ(show(3e38F).force_N, 0);
  EXPECT_EQ(controller.fault(), ControlFault::not_a_number);
  controller.reset();
  controller.update({0.01F});
  EXPECT_EQ(controller.update({0.01F}).mode, Mode::approach) << "nothing of the overflow is left";
}

TEST_F(AxisControllerTest, DoesAfterAResetTheSameWhateverItDidBefore) {
  std::mt19937 random{17};
  float x = 0;
  const auto read = [&] {
    return x += p.encoder_resolution_m * static_cast<float>(static_cast<int>(random() % 5) - 2);
  };
  for (int trial = 0; trial < 400; ++trial) {
    x = 1e-6F * static_cast<float>(random() % 20000) - 0.01F;
    for (auto left = random() % 200; left > 0; --left) controller.update({read()});
    controller.update({std::nanf("")});
    controller.reset();
    AxisController<float> fresh{p, table, pulses};
    fresh.reset();
    for (int i = 0; i < 100; ++i) {
      const float reading = read();
      const auto expected = fresh.update({reading}), given = controller.update({reading});
      ASSERT_EQ(given.force_N, expected.force_N) << trial << ", " << i;
      ASSERT_EQ(given.mode, expected.mode) << trial << ", " << i;
    }
  }
}

TEST_F(AxisControllerTest, NeverExceedsTheForceLimitForAnyInputBits) {
  std::mt19937 random{11};
  const auto any_float = [&] { return std::bit_cast<float>(static_cast<std::uint32_t>(random())); };
  for (int i = 0; i < 1'000'000; ++i) {
    if (controller.fault() != ControlFault::none) controller.reset();
    const bool fresh = random() % 8 != 0;
    const auto out = controller.update({any_float(), any_float(), fresh});
    testing::expect_nothing_with_a_fault(controller, out);
    ASSERT_LE(std::abs(out.force_N), p.max_force_N);
  }
}

TEST_F(AxisControllerTest, KeepsToAForceLimitThatTheDriveTellsLater) {
  const auto free = first_kick(-5e-3F);
  controller.reset();
  controller.limit_force(20);
  const auto limited_kick = first_kick(-5e-3F);
  EXPECT_GT(free.force_N, 20);
  EXPECT_LE(limited_kick.force_N, 20);
  EXPECT_GT(limited_kick.force_N, 10) << "spread over more periods, not given up";
  controller.limit_force(100);
  controller.reset();
  EXPECT_LE(first_kick(-5e-3F).force_N, 20) << "a limit is never raised";
}

// The last kick leads it into a hold, from which it is pushed.
TEST_F(AxisControllerTest, IsNotKickedOnceMoreThanAnyAxisIs) {
  for (int kick = 0; kick < KickJudge<float>::most_kicks; ++kick) first_kick(kick % 2 == 0 ? -1e-4F : -9e-5F);
  EXPECT_EQ(stand_still(0, 60).mode, Mode::hold);
  EXPECT_EQ(stand_still(-1e-4F, 100).mode, Mode::fault);
  EXPECT_EQ(controller.fault(), ControlFault::hunting);
  EXPECT_EQ(controller.kicks(), KickJudge<float>::most_kicks);
}

TEST_F(AxisControllerTest, GivesFiniteForceEvenWithADamagedTable) {
  table.nodes.fill({std::nanf(""), std::nanf("")});
  for (auto& e : pulses.entries) e.a0 = e.a1 = std::nanf("");
  for (int i = 0; i < 200; ++i) ASSERT_LE(std::abs(controller.update({-1e-3F}).force_N), p.max_force_N);
}

// Scaling length and force by a power of two is an exact symmetry of the axis, and so of the controller, bit for bit.
TEST(AxisControllerSymmetry, ScalesExactlyWithLengthAndForce) {
  const auto p = sampled_axis<float>();
  const auto table = ballistic_table(p, p.stick_radius_upper_m());
  const auto pulses = design::design_pd_kicks(p).table;
  AxisController<float> reference{p, table, pulses};
  for (int k = -20; k <= 20; k += 4) {
    const auto scaled = [k](float value) { return std::ldexp(value, k); };
    auto ps = p;
    for (float* value : {&ps.friction.lower_N, &ps.friction.upper_N, &ps.max_force_N, &ps.max_approach_speed_m_s,
                         &ps.position_tolerance_m, &ps.encoder_resolution_m}) {
      *value = scaled(*value);
    }
    K3Table<float> table_s = table;  // R scales with the square root of length
    table_s.root_max = std::sqrt(ps.stick_radius_upper_m());
    table_s.nodes_per_root = static_cast<float>(table.nodes.size() - 1) / table_s.root_max;
    table_s.nodes.fill({std::ldexp(table.nodes[0].value, k / 2), 0.0F});
    KickTable<float> pulses_s = pulses;  // over the fourth root of length, an octave of which are 16 intervals
    pulses_s.first = static_cast<std::uint16_t>(pulses.first + 16 * (k / 4));
    for (auto& e : pulses_s.entries) e = {scaled(e.a0), scaled(e.a1), scaled(e.a2), scaled(e.a3)};
    AxisController<float> controller{ps, table_s, pulses_s};
    reference.reset();
    std::mt19937 random{5};
    for (int i = 0; i < 3000; ++i) {
      const float x = 1e-6F * static_cast<float>(static_cast<int>(random() % 41) - 20) * (i % 7 < 4 ? 1.0F : 100.0F);
      const auto expected = reference.update({x});
      const auto out = controller.update({scaled(x)});
      ASSERT_EQ(out.force_N, scaled(expected.force_N)) << "k = " << k << ", step " << i;
      ASSERT_EQ(out.mode, expected.mode);
    }
  }
}

TEST(AxisControllerIdealLaw, IsTheSameClassWithPeriodAndResolutionZero) {
  auto p = sampled_axis<double>();
  p.period_s = 0;
  p.encoder_resolution_m = 0;
  p.position_tolerance_m = 0;
  const auto table = ballistic_table(p, p.stick_radius_upper_m());
  AxisController<double> controller{p, table};
  EXPECT_EQ(controller.update({-1e-3, 0.5}).impulse_Ns, 0) << "moving";
  EXPECT_EQ(controller.damping_Ns_per_m(), p.approach_damping_Ns_per_m);
  EXPECT_EQ(controller.update({-1.0, 0.0}).impulse_Ns, 0) << "a reversal outside the maximal stick set is no rest";
  const auto kick = controller.update({-1e-3, 0.0});
  EXPECT_TRUE(kick.kicked);
  EXPECT_EQ(kick.impulse_Ns, table.impulse_Ns(-1e-3));
  EXPECT_EQ(kick.force_N, p.stiffness_N_per_m * 1e-3) << "its spring goes on";
  EXPECT_EQ(controller.update({1e-3, 0.0}).impulse_Ns, table.impulse_Ns(1e-3));
  EXPECT_EQ(controller.update({1e-3, 0.0}).force_N, -p.stiffness_N_per_m * 1e-3);
  EXPECT_TRUE(controller.update({-p.stick_radius_upper_m(), 0.0}).kicked) << "at the end of the maximal stick set";
  EXPECT_EQ(controller.damping_Ns_per_m(), p.kick_damping_Ns_per_m);
  EXPECT_EQ(controller.update({0.0, 0.0}).mode, Mode::hold) << "k3(0) = 0: the target is an equilibrium";
}

TEST(AxisParameters, NamesTheRuleThatIsBroken) {
  const double nan = std::nan("");
  const auto broken = [](auto change) {
    auto p = sampled_axis<double>();
    change(p);
    return validate(p);
  };
  EXPECT_EQ(broken([](auto&) {}), ParameterError::none);
  EXPECT_EQ(broken([&](auto& p) { p.mass_kg = nan; }), ParameterError::mass_not_positive);
  EXPECT_EQ(broken([](auto& p) { p.stiffness_N_per_m = -1; }), ParameterError::stiffness_not_positive);
  EXPECT_EQ(broken([](auto& p) { p.approach_damping_Ns_per_m = 40; }), ParameterError::approach_not_underdamped);
  EXPECT_EQ(broken([](auto& p) { p.kick_damping_Ns_per_m = 40; }), ParameterError::kick_not_overdamped);
  EXPECT_EQ(broken([](auto& p) { p.friction.lower_N = 0; }), ParameterError::friction_lower_not_positive);
  EXPECT_EQ(broken([](auto& p) { p.friction.upper_N = 2; }), ParameterError::friction_bounds_reversed);
  EXPECT_EQ(broken([](auto& p) { p.max_force_N = 4; }), ParameterError::max_force_below_friction);
  EXPECT_EQ(broken([&](auto& p) { p.max_approach_speed_m_s = nan; }), ParameterError::max_approach_speed_not_positive);
  EXPECT_EQ(broken([](auto& p) { p.position_tolerance_m = -1; }), ParameterError::tolerance_negative);
  EXPECT_EQ(broken([&](auto& p) { p.encoder_resolution_m = nan; }), ParameterError::encoder_resolution_negative);
  EXPECT_EQ(broken([](auto& p) { p.period_s = -1; }), ParameterError::period_negative);
}

}  // namespace
}  // namespace breakaway::law
