#include "breakaway/motion/slide.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/work_budget.hpp"

namespace breakaway::motion {
namespace {

using model::FrictionLaw;
using model::ShapePtr;

// Behaves as the shape inside, but denies that it is constant between events, so that the plant integrates numerically.
class Disguised : public model::Shape {
 public:
  explicit Disguised(ShapePtr inner) : inner_(std::move(inner)) {}
  ShapePtr clone() const override { return std::make_unique<Disguised>(inner_->clone()); }
  double value(double t, double x, double v) const override { return inner_->value(t, x, v); }
  void face(double x, int direction) override { inner_->face(x, direction); }
  void on_time(double t) override { inner_->on_time(t); }
  void on_stick(double t) override { inner_->on_stick(t); }
  void on_slip(double t) override { inner_->on_slip(t); }
  double next_time_change_s() const override { return inner_->next_time_change_s(); }
  model::PositionRange range_m() const override { return inner_->range_m(); }
  bool varies_with_motion() const override { return true; }

 private:
  ShapePtr inner_;
};

FrictionLaw coulomb(double level_N) { return {{level_N, level_N}, model::shape::constant(0)}; }

FrictionLaw stribeck_and_sine(double scale = 1) {
  std::vector<ShapePtr> parts;
  parts.push_back(model::shape::stribeck(2 * scale));
  parts.push_back(model::shape::sine_in_time(4));
  return {{2.5 * scale, 4.5 * scale}, model::shape::mean({0.5, 0.5}, std::move(parts))};
}

void expect_close(double a, double b, double scale, double tolerance) {
  EXPECT_LE(std::abs(a - b), tolerance * scale) << a << " and " << b;
}

TEST(Slide, StopsUnderFrictionWhereTheParabolaSays) {
  Slide slide(2, coulomb(3), {1, 10, 4});
  EXPECT_EQ(slide.advance_to(100, {}, true), StopReason::came_to_rest);
  EXPECT_DOUBLE_EQ(slide.state().time_s, 1 + 4 / 1.5);
  EXPECT_DOUBLE_EQ(slide.state().position_m, 10 + 16 / 3.0);
  EXPECT_EQ(slide.state().velocity_m_s, 0);
  EXPECT_DOUBLE_EQ(slide.time_since_event_s(), 4 / 1.5);
  EXPECT_EQ(slide.advance_to(100, {}, true), StopReason::reached_time);
  EXPECT_EQ(slide.state().time_s, 100);
  EXPECT_TRUE(slide.sticking());
}

TEST(Slide, ClosedFormsAgreeWithIntegration) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal(0, 1);
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    const double level_N = std::exp(normal(random)), mass_kg = std::exp(normal(random));
    const SlideState start{unit(random), 3 * normal(random), 3 * normal(random)};
    model::AppliedForce force{.constant_N = 2 * normal(random), .reference_m = normal(random)};
    if (i % 3 == 0) {
      force.transient_N = 5 * normal(random);
      force.time_constant_s = std::exp(normal(random));
      force.start_s = start.time_s - unit(random);
    } else {
      force.stiffness_N_per_m = i % 3 == 1 ? std::exp(normal(random)) : i % 2 * std::exp(-6 * unit(random));
      force.damping_Ns_per_m = 3 * unit(random);
      // Exactly critical, and so near it that the roots all but meet.
      if (i % 9 == 1) force.damping_Ns_per_m = 2 * std::sqrt(force.stiffness_N_per_m * mass_kg) * (1 + 1e-9 * (i % 2));
    }
    Slide exact(mass_kg, coulomb(level_N), start);
    Slide integrated(mass_kg, {{level_N, level_N}, std::make_unique<Disguised>(model::shape::constant(0))}, start);
    double length_m = 1, speed_m_s = 1;
    for (int leg = 1; leg <= 3; ++leg) {
      const double end_s = start.time_s + 2 * leg;
      const StopReason reason = exact.advance_to(end_s, force, true);
      const StopReason other_reason = integrated.advance_to(end_s, force, true);
      // An overdamped axis creeps towards its equilibrium for ever: at rest is a matter of the last bit.
      if (reason != other_reason && std::abs(exact.state().velocity_m_s) < 1e-11 * speed_m_s) break;
      EXPECT_EQ(reason, other_reason);
      speed_m_s = std::max(speed_m_s, std::abs(exact.state().velocity_m_s));
      length_m = std::max(length_m, std::abs(exact.state().position_m));
      expect_close(exact.state().time_s, integrated.state().time_s, 1 + end_s, 1e-11);
      expect_close(exact.state().position_m, integrated.state().position_m, length_m, 1e-12);
      // A step of several of the damper's time constants leaves amplified rounding of the forces in the velocity.
      expect_close(exact.state().velocity_m_s, integrated.state().velocity_m_s, speed_m_s, 5e-11);
      EXPECT_EQ(exact.sticking(), integrated.sticking());
    }
  }
}

// A law and a current loop's transient in every millisecond, as an axis behind a drive sees them. A spring too soft to
// matter has the whole motion integrated instead of what friction takes from it. In 200 periods each may err by 3e-14
// of the speed, and position by what that does within its period.
TEST(Slide, IntegratesALaggedForceFinely) {
  for (const double time_constant_s : {1e-5, 1e-4, 1e-3, 2e-2}) {
    SCOPED_TRACE(time_constant_s);
    Slide parted(1, stribeck_and_sine(), {0, -4, 4}), whole(1, stribeck_and_sine(), {0, -4, 4});
    double force_N = 0;
    for (int tick = 1; tick <= 200; ++tick) {
      const double before_N = force_N, end_s = 1e-3 * tick;
      force_N = 5 * std::sin(0.37 * tick);
      model::AppliedForce force{.constant_N = force_N,
                                .transient_N = before_N - force_N,
                                .time_constant_s = time_constant_s,
                                .start_s = 1e-3 * (tick - 1)};
      parted.advance_to(end_s, force);
      force.stiffness_N_per_m = 1e-200;
      whole.advance_to(end_s, force);
    }
    EXPECT_GT(whole.state().velocity_m_s, 1);
    expect_close(parted.state().velocity_m_s, whole.state().velocity_m_s, 4, 200 * 3e-14);
    expect_close(parted.state().position_m, whole.state().position_m, 4, 200 * 3e-15);
  }
}

TEST(Slide, KeepsRelativeAccuracyOfTinyFlights) {
  // Continuous PD under constant friction: for a flight this short, spring and damper change the parabola by 1e-7.
  for (const double y_m : {1e-12, 1e-20, 1e-30}) {
    Slide slide(1, coulomb(2.5), {4.8, -y_m, 0});
    slide.apply_impulse(std::sqrt(2 * 2.5 * y_m));
    EXPECT_EQ(slide.advance_to(5, {.stiffness_N_per_m = 1, .damping_Ns_per_m = 3}, true), StopReason::came_to_rest);
    const double speed_m_s = std::sqrt(2 * 2.5 * y_m), duration_s = speed_m_s / 2.5;
    // First order in the damper: it takes 3 v / 2.5 of the deceleration, so 2 v / 2.5 of the distance and 1.5 v / 2.5
    // of time.
    expect_close(slide.time_since_event_s(), duration_s * (1 - 1.5 * speed_m_s / 2.5), duration_s, 3 * y_m + 1e-14);
    expect_close(slide.state().position_m, -y_m * (2 * speed_m_s / 2.5), y_m, -10 * y_m + 20 * y_m + 1e-14);
  }
}

TEST(Slide, BreaksAwayWhenTheTransientCrossesTheStaticLevel) {
  const FrictionLaw law({2, 4}, model::shape::static_kinetic(1, 0));
  Slide slide(1, law, {});
  const model::AppliedForce force{.constant_N = 5, .transient_N = -5, .time_constant_s = 0.5, .start_s = 0};
  const double breakaway_s = 0.5 * std::log(5.0);  // 5 - 5 e^(-t / 0.5) = 4
  slide.advance_to(breakaway_s * (1 - 1e-9), force);
  EXPECT_TRUE(slide.sticking());
  EXPECT_EQ(slide.friction_force_N(), -force.at_N(slide.state().time_s, 0, 0));
  slide.advance_to(breakaway_s + 0.1, force);
  EXPECT_FALSE(slide.sticking());
  EXPECT_EQ(slide.friction_force_N(), -2);
  // From rest with 4 - 2 N, then 5 - 2 N less a transient of 1 N.
  expect_close(slide.state().velocity_m_s, 3 * 0.1 + 0.5 * std::expm1(-0.2), 0.2, 5e-11);  // the tie delays it
}

// A clock that is some seconds on rounds the instant of breaking away, and with it a steep push, to either side of
// friction. To stick there again and again cost a thousand times the motion itself.
TEST(Slide, BreaksAwayOnceUnderASteepPushHoweverTheClockRounds) {
  std::mt19937_64 random(20261122);
  std::uniform_real_distribution<double> from_s(0, 100), transient_N(-80, -21);
  for (int i = 0; i < 200; ++i) {
    const SlideState rest{from_s(random), 0, 0};
    const double missing_N = transient_N(random);
    Slide slide(8, {{12, 20}, model::shape::stribeck(0.5)}, rest);
    WorkBudget work({.duration_s = rest.time_s + 1}, "the axis", "", "");
    slide.limit_work(&work);
    const model::AppliedForce steep{
        .constant_N = 20 - missing_N, .transient_N = missing_N - 10, .time_constant_s = 1e-4, .start_s = rest.time_s};
    slide.advance_to(rest.time_s + 7e-4, steep);
    EXPECT_EQ(slide.counters().slips, 1U);
    EXPECT_EQ(slide.counters().sticks, 0U);
    EXPECT_GT(slide.state().velocity_m_s, 0);
    EXPECT_LT(work.spent(), 700);
  }
}

TEST(Slide, SticksOnATieAndSlipsAboveIt) {
  for (const double push_N : {3.0, -3.0}) {
    Slide slide(1, coulomb(3), {});
    slide.advance_to(1, {.constant_N = push_N});
    EXPECT_TRUE(slide.sticking());
    EXPECT_EQ(slide.counters().slips, 0u);
    EXPECT_EQ(slide.state().position_m, 0);
    slide.advance_to(2, {.constant_N = push_N * (1 + 1e-9)});
    EXPECT_FALSE(slide.sticking());
    EXPECT_EQ(slide.counters().slips, 1u);
    EXPECT_GT(slide.state().position_m * push_N, 0);
  }
}

TEST(Slide, TurnsRoundAtOnceWhereTheForceExceedsFriction) {
  Slide slide(1, coulomb(1), {0, 0, 2});
  EXPECT_EQ(slide.advance_to(10, {.constant_N = -3}, true), StopReason::came_to_rest);
  EXPECT_DOUBLE_EQ(slide.state().time_s, 0.5);
  slide.advance_to(1.5, {.constant_N = -3});
  EXPECT_DOUBLE_EQ(slide.state().velocity_m_s, -2);
  EXPECT_EQ(slide.counters().sticks, 1u);
  EXPECT_EQ(slide.counters().slips, 1u);
  EXPECT_EQ(slide.counters().reversals, 1u);
}

TEST(Slide, BreaksAwayWhenASineOfTimeFallsBelowThePush) {
  // 3 + 2 (1 + sin 4t) / 2 against 3.5: sin 4t = -1/2 at 4t = 7 pi / 6.
  Slide slide(1, {{3, 5}, model::shape::sine_in_time(4)}, {});
  std::vector<double> observed;
  slide.observe(100, [&](const SlideState& state, double) { observed.push_back(state.time_s); });
  slide.advance_to(1.2, {.constant_N = 3.5 / (1 + 1e-12)});
  EXPECT_EQ(slide.counters().slips, 1u);
  ASSERT_GE(observed.size(), 2u);
  EXPECT_NEAR(observed[1], 7 * std::acos(-1) / 24, 1e-11);  // the tie's 1e-12 over the level's slope
}

TEST(Slide, JudgesANewForceByTheLevelOfThatTime) {
  Slide slide(1, {{3, 5}, model::shape::sine_in_time(4)}, {});
  slide.advance_to(1.1, {});  // the level was 4 N at the start, and is 3.05 N now
  slide.advance_to(1.1 + 1e-6, {.constant_N = 3.5});
  EXPECT_FALSE(slide.sticking());
  expect_close(slide.state().velocity_m_s, 0.45e-6, 1e-6, 0.01);
}

TEST(Slide, StaysUnderAForceBelowTheLevelOfThatTime) {
  Slide slide(1, {{3, 5}, model::shape::sine_in_time(4)}, {});
  slide.advance_to(0.39, {});  // the level was 4 N at the start, and is 5 N now
  slide.advance_to(0.4, {.constant_N = 4.5});
  EXPECT_EQ(slide.counters().slips, 0u);
  EXPECT_EQ(slide.friction_force_N(), -4.5);
}

TEST(Slide, MissesNoRestBetweenItsSteps) {
  // A push of 4 N against 4 + sin(W t + phase) N: from where the cosine is 1, v = v0 + sin(W t) / W, least at v0 - 1 /
  // W. The speed dips below zero only for a moment in which a step with both ends above zero may hide it.
  constexpr double omega = 4, quarter_s = std::numbers::pi / 2 / omega;
  for (const double depth : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8}) {
    for (int start = 0; start < 40; ++start) {
      SCOPED_TRACE("depth " + std::to_string(depth) + ", start " + std::to_string(start));
      const double start_s = 0.02 * start * quarter_s;
      for (const bool stops : {true, false}) {
        const double speed_m_s = (std::sin(omega * start_s) + (stops ? 1 - depth : 1 + depth)) / omega;
        Slide slide(1, {{3, 5}, model::shape::sine_in_time(omega, -std::numbers::pi / 2)}, {start_s, 0, speed_m_s});
        EXPECT_EQ(slide.advance_to(4.9 * quarter_s, {.constant_N = 4}, true) == StopReason::came_to_rest, stops);
      }
    }
  }
}

TEST(Slide, CountsTimesBelowTheResolutionOfItsClock) {
  Slide slide(1, coulomb(1), {1, 0, 0});
  for (int i = 0; i < 1000; ++i) {
    slide.apply_impulse(1e-17);
    EXPECT_EQ(slide.advance_to(2, {}, true), StopReason::came_to_rest);
    EXPECT_DOUBLE_EQ(slide.time_since_event_s(), 1e-17);
  }
  EXPECT_NEAR(slide.state().time_s, 1 + 1e-14, 3e-16);
}

TEST(Slide, FindsTheShortWindowInWhichASineLawLetsItGo) {
  // The level touches 3 N for an instant; a push 1e-9 above it exceeds it for 2 sqrt(2e-9) / 4 s only.
  Slide above(1, {{3, 5}, model::shape::sine_in_time(4)}, {}), below = above;
  above.advance_to(1.5, {.constant_N = 3 + 1e-9});
  EXPECT_EQ(above.counters().slips, 1u);
  below.advance_to(1.5, {.constant_N = 3 - 1e-9});
  EXPECT_EQ(below.counters().slips, 0u);
}

TEST(Slide, CountsTheWorkOfASearchForAShortWindow) {
  const auto work_under = [](double push_N) {
    Slide slide(1, {{2, 4}, model::shape::sine_in_time(1)}, {});
    WorkBudget work({.duration_s = 10}, "the axis", "", "");
    slide.limit_work(&work);
    slide.advance_to(6, {.constant_N = push_N});
    EXPECT_TRUE(slide.sticking());
    return work.spent();
  };
  // The level falls to 2 N at 3 pi / 2 s.
  EXPECT_GT(work_under(2 - 1e-9), work_under(1.9) + 100);
}

TEST(Slide, SwitchesAPiecewiseConstantLawExactlyAtItsTimes) {
  const FrictionLaw law({1, 2}, model::shape::random_dwell({.seed = 4}));
  FrictionLaw replay = law;
  Slide slide(1, law, {0, 0, 50});
  replay.on_time(0);
  double time_s = 0, position_m = 0, velocity_m_s = 50;
  for (int i = 0; i < 50; ++i) {
    const double level_N = replay.level_N(0, 0, 0), end_s = replay.next_time_change_s(), duration_s = end_s - time_s;
    position_m += duration_s * (velocity_m_s - 0.5 * level_N * duration_s);
    velocity_m_s -= level_N * duration_s;
    if (velocity_m_s < 0) break;
    time_s = end_s;
    replay.on_time(time_s);
  }
  ASSERT_GT(velocity_m_s, 0);
  slide.advance_to(time_s, {});  // in one call over all switches
  EXPECT_NEAR(slide.state().velocity_m_s, velocity_m_s, 1e-12);
  EXPECT_NEAR(slide.state().position_m, position_m, 1e-11);
  EXPECT_EQ(slide.counters().law_switches, 50u);
}

TEST(Slide, SwitchesAPositionTableExactlyAtItsEdges) {
  // 1 N up to 0, then 4 N: from -1 with v^2 = 6, v^2 = 4 at the edge and rest at 0.5. Both ways of computing it.
  for (const bool disguised : {false, true}) {
    ShapePtr table = model::shape::position_table({0}, {0, 1});
    if (disguised) table = std::make_unique<Disguised>(std::move(table));
    Slide slide(1, {{1, 4}, std::move(table)}, {0, -1, std::sqrt(6.0)});
    EXPECT_EQ(slide.advance_to(10, {}, true), StopReason::came_to_rest);
    EXPECT_NEAR(slide.state().position_m, 0.5, 2e-15);
    EXPECT_NEAR(slide.state().time_s, (std::sqrt(6.0) - 2) + 0.5, 2e-15);
    EXPECT_EQ(slide.counters().law_switches, 1u);
  }
}

TEST(Slide, JumpsInVelocityByTheImpulseOverTheMass) {
  Slide slide(4, coulomb(1), {0, 0.25, 0});
  slide.apply_impulse(-2);
  EXPECT_EQ(slide.state().velocity_m_s, -0.5);
  EXPECT_EQ(slide.state().position_m, 0.25);
  EXPECT_FALSE(slide.sticking());
  slide.apply_impulse(2);
  EXPECT_TRUE(slide.sticking());
  EXPECT_EQ(slide.counters().slips, 1u);
  EXPECT_EQ(slide.counters().sticks, 1u);
}

// 5-point Gauss-Legendre on [0, 1].
constexpr std::array<double, 5> nodes = {0.046910077030668004, 0.23076534494715845, 0.5, 0.76923465505284155,
                                         0.95308992296933200};
constexpr std::array<double, 5> weights = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                           0.23931433524968324, 0.11846344252809454};

TEST(Slide, BalancesEnergy) {
  const model::AppliedForce force{
      .constant_N = 1, .transient_N = -6, .time_constant_s = 0.7, .stiffness_N_per_m = 2, .damping_Ns_per_m = 0.3};
  Slide slide(1.5, stribeck_and_sine(), {0, -4, 3});
  const double end_s = 3, kinetic_before_J = 0.5 * 1.5 * 9;
  double work_J = 0, friction_J = 0, dissipated_scale_J = 0, time_s = 0;
  while (time_s < end_s) {
    // Panels end at instants of rest: the power is smooth inside.
    Slide probe = slide;
    probe.advance_to(std::min(time_s + 0.05, end_s), force, true);
    const double panel_s = probe.state().time_s - time_s;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      Slide sample = slide;
      sample.advance_to(time_s + nodes[i] * panel_s, force);
      const auto at = sample.state();
      work_J += weights[i] * panel_s * at.velocity_m_s * force.at_N(at.time_s, at.position_m, at.velocity_m_s);
      friction_J += weights[i] * panel_s * at.velocity_m_s * sample.friction_force_N();
    }
    slide = probe;
    time_s = probe.state().time_s;
  }
  dissipated_scale_J = std::abs(friction_J);
  EXPECT_LT(friction_J, 0);
  EXPECT_GE(slide.counters().sticks, 1u);
  const double kinetic_after_J = 0.5 * 1.5 * std::pow(slide.state().velocity_m_s, 2);
  // The quadrature's error is of order panel^10: below 1e-11 here.
  expect_close(kinetic_after_J - kinetic_before_J, work_J + friction_J, dissipated_scale_J, 1e-10);
}

struct Outcome {
  SlideState state;
  SlideCounters counters;
};

Outcome stop_and_go(FrictionLaw law, double scale) {
  Slide slide(1, std::move(law), {0, -4 * scale, -4 * scale});
  for (int tick = 1; tick <= 3000; ++tick) {
    const double push_N = 6 * scale * std::sin(0.01 * tick);
    slide.advance_to(
        1e-3 * tick,
        {.constant_N = push_N, .transient_N = -scale, .time_constant_s = 2e-4, .start_s = 1e-3 * (tick - 1)});
    if (slide.sticking() && tick % 7 == 0) slide.apply_impulse(0.01 * scale);
  }
  slide.advance_to(6, {.stiffness_N_per_m = 20, .damping_Ns_per_m = 0.5});
  return {slide.state(), slide.counters()};
}

void expect_scaled(const Outcome& a, const Outcome& b, double scale) {
  EXPECT_EQ(a.state.position_m * scale, b.state.position_m);
  EXPECT_EQ(a.state.velocity_m_s * scale, b.state.velocity_m_s);
  EXPECT_EQ(a.counters.sticks, b.counters.sticks);
  EXPECT_EQ(a.counters.slips, b.counters.slips);
  EXPECT_EQ(a.counters.reversals, b.counters.reversals);
  EXPECT_EQ(a.counters.steps, b.counters.steps);
}

TEST(Slide, IsExactlyInvariantUnderScalingByPowersOfTwo) {
  const Outcome constant = stop_and_go(coulomb(3), 1), varying = stop_and_go(stribeck_and_sine(), 1);
  EXPECT_GT(constant.counters.slips, 5u);
  EXPECT_GT(varying.counters.slips, 5u);
  for (int k = -40; k <= 40; k += 8) {
    SCOPED_TRACE(k);
    const double scale = std::ldexp(1.0, k);
    expect_scaled(constant, stop_and_go(coulomb(3 * scale), scale), scale);
    expect_scaled(varying, stop_and_go(stribeck_and_sine(scale), scale), scale);
  }
}

TEST(Slide, IsExactlyMirrorSymmetric) {
  expect_scaled(stop_and_go(coulomb(3), 1), stop_and_go(coulomb(3), -1), -1);
  expect_scaled(stop_and_go(stribeck_and_sine(), 1), stop_and_go(stribeck_and_sine(), -1), -1);
}

TEST(Slide, ReportsStatesAtLeastOnceInAnInterval) {
  Slide slide(1, stribeck_and_sine(), {0, -4, -4});
  double last_s = 0, longest_s = 0, lowest_N = 10, highest_N = 0;
  slide.observe(0.01, [&](const SlideState& state, double level_N) {
    longest_s = std::max(longest_s, state.time_s - last_s);
    last_s = state.time_s;
    lowest_N = std::min(lowest_N, level_N);
    highest_N = std::max(highest_N, level_N);
  });
  slide.advance_to(2, {.stiffness_N_per_m = 1, .damping_Ns_per_m = 0.5});
  EXPECT_LE(longest_s, 0.0101);
  EXPECT_EQ(last_s, 2);
  EXPECT_GE(lowest_N, 2.5);
  EXPECT_LE(highest_N, 4.5);
  EXPECT_GT(highest_N - lowest_N, 0.5);
}

TEST(Slide, RefusesBadArguments) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Slide(0, coulomb(1), {}), InputError);
  EXPECT_THROW(Slide(nan, coulomb(1), {}), InputError);
  EXPECT_THROW(Slide(1, coulomb(1), {0, nan, 0}), InputError);
  Slide slide(1, coulomb(1), {5, 0, 0});
  EXPECT_THROW(slide.apply_impulse(nan), InputError);
  EXPECT_THROW(slide.advance_to(6, {.constant_N = nan}), InputError);
  EXPECT_THROW(slide.advance_to(6, {.transient_N = 1}), InputError);
  EXPECT_THROW(slide.advance_to(4, {}), InputError);
  EXPECT_THROW(slide.advance_to(std::numeric_limits<double>::infinity(), {}), InputError);
}

}  // namespace
}  // namespace breakaway::motion
