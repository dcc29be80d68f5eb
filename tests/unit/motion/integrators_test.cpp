#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "breakaway/motion/gragg_bulirsch_stoer.hpp"
#include "breakaway/motion/henon.hpp"
#include "breakaway/motion/roots.hpp"

namespace breakaway::motion {
namespace {

constexpr double tolerance = 1e-14;

TEST(GraggBulirschStoer, FollowsAnOscillatorForTenPeriods) {
  const auto oscillator = [](double, const Vector<2>& y, Vector<2>& slope) { slope = {y[1], -y[0]}; };
  const auto end = integrate(oscillator, 0, Vector<2>{1, 0}, 20 * std::numbers::pi, 0.1, tolerance);
  // About 1e-15 a step, and the phase at the rounded end time.
  EXPECT_NEAR(end.state[0], 1, 1e-13);
  EXPECT_NEAR(end.state[1], 0, 1e-13);
  EXPECT_LT(end.steps, 150);
}

TEST(GraggBulirschStoer, KeepsRelativeAccuracyOfTinySolutions) {
  // x'' = 1 from rest for 1e-20 s: x = 5e-41.
  const auto fall = [](double, const Vector<2>& y, Vector<2>& slope) { slope = {y[1], 1}; };
  const auto end = integrate(fall, 0, Vector<2>{0, 0}, 1e-20, 1e-20, tolerance);
  EXPECT_NEAR(end.state[0] / 0.5e-40, 1, 1e-14);
}

TEST(GraggBulirschStoer, FollowsAnEccentricOrbitWithAdaptiveSteps) {
  const auto gravity = [](double, const Vector<4>& y, Vector<4>& slope) {
    const double r2 = y[0] * y[0] + y[1] * y[1];
    const double r3 = r2 * std::sqrt(r2);
    slope = {y[2], y[3], -y[0] / r3, -y[1] / r3};
  };
  constexpr double e = 0.9;
  const Vector<4> start{1 - e, 0, 0, std::sqrt((1 + e) / (1 - e))};
  const auto end = integrate(gravity, 0, start, 2 * std::numbers::pi, 0.01, tolerance);
  // An error of 1e-14 of the kinetic energy (9.5) at the start is 2e-13 of the orbit's energy (0.5), so 2e-12 of the
  // period's 6.3 s, in which the start's speed of 4.4 makes 1e-11; some ten steps near the start add up.
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(end.state[i], start[i], 2e-10);
}

TEST(GraggBulirschStoer, RefusesAStepThatDoesNotConverge) {
  const auto stiff = [](double, const Vector<1>& y, Vector<1>& slope) { slope = {-1e4 * y[0]}; };
  const auto trial = extrapolated_step(stiff, 0, Vector<1>{1}, 1.0, tolerance);
  EXPECT_FALSE(trial.converged);
  EXPECT_GT(trial.suggested_step, 0);
  EXPECT_LT(trial.suggested_step, 1);
}

TEST(GraggBulirschStoer, SaysWhenItCannotPassASingularity) {
  const auto blow_up = [](double, const Vector<1>& y, Vector<1>& slope) { slope = {y[0] * y[0]}; };
  EXPECT_THROW(integrate(blow_up, 0, Vector<1>{1}, 2, 0.1, tolerance), InputError);
}

TEST(Henon, LandsExactlyOnTheEvent) {
  // y = (sin t, cos t): the velocity cos t is zero at pi / 2.
  auto oscillator = [](double, const Vector<2>& y, Vector<2>& slope) { slope = {y[1], -y[0]}; };
  const double t0 = 1;
  const Exchanged<2, 1, decltype(oscillator)> by_velocity(oscillator);
  const Vector<2> z{std::sin(t0), t0};
  const auto end = integrate(by_velocity, std::cos(t0), z, 0, 1, tolerance);
  EXPECT_NEAR(end.state[1], std::numbers::pi / 2, tolerance);
  EXPECT_NEAR(end.state[0], 1, tolerance);
}

TEST(Roots, NewtonStaysInItsBracketAndReachesTheLastBits) {
  // Newton's method alone leaves for infinity from the middle of this bracket.
  const auto f = [](double x) { return ValueAndSlope{std::atan(x - 1), 1 / (1 + (x - 1) * (x - 1))}; };
  EXPECT_NEAR(bracketed_newton(f, -20, 100, true), 1, 4e-16);
  const auto g = [](double x) { return ValueAndSlope{1e-30 - x * x, -2 * x}; };
  EXPECT_NEAR(bracketed_newton(g, 0, 1, false) / 1e-15, 1, 1e-15);
}

TEST(Roots, FirstTrueIsTheFirstDouble) {
  const double edge = first_true([](double x) { return x >= 0.3; }, 0, 1);
  EXPECT_EQ(edge, 0.3);
}

}  // namespace
}  // namespace breakaway::motion
