#include "breakaway/law/kick_shaper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "breakaway/design/k3.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "law_fixture.hpp"

namespace breakaway::law {
namespace {

using testing::ballistic_table;
using testing::sampled_axis;

AxisParameters<double> nearly_free_axis() {
  auto p = sampled_axis<double>();
  p.stiffness_N_per_m = 1e-12;
  p.kick_damping_Ns_per_m = 1e-5;
  p.max_force_N = std::numeric_limits<double>::infinity();
  return p;
}

// Without feedback the pulse of one period that lands on the target under f_lo is f = (A + sqrt(A^2 + 8 A y / T^2))
// / 2.
TEST(KickShaper, MatchesTheClosedFormOfABallisticKick) {
  const auto p = nearly_free_axis();
  const KickShaper<double> shaper{p, 1.0};
  const auto table = ballistic_table(p, 1.0);
  const double A = p.friction.lower_N / p.mass_kg, T = p.period_s;
  for (const double y : {1e-9, 1e-7, 2e-6, 1e-5, 1e-3, 0.1}) {
    const auto kick = shaper.plan(table, y, 0.0, 0.0);
    ASSERT_EQ(kick.periods, 1);
    EXPECT_NEAR(kick.force_N, (A + std::sqrt(A * A + 8 * A * y / (T * T))) / 2, 1e-9 * kick.force_N) << y;
  }
}

// And from the speed w the net acceleration is (-(2 w + A T) + sqrt(A^2 T^2 + 8 A y - 4 A w T)) / (2 T).
TEST(KickShaper, CountsInTheSpeedOfAnAxisThatStillMoves) {
  const auto p = nearly_free_axis();
  const KickShaper<double> shaper{p, 1.0};
  const auto table = ballistic_table(p, 1.0);
  const double A = p.friction.lower_N, T = p.period_s;
  for (const double share : {0.05, 0.3, 0.7}) {
    const double y = 1e-3, w = share * std::sqrt(2 * A * y);
    const double net = (-(2 * w + A * T) + std::sqrt(A * A * T * T + 8 * A * y - 4 * A * w * T)) / (2 * T);
    EXPECT_NEAR(shaper.plan(table, y, w, 0.0).force_N, net + A, 1e-9 * (net + A)) << share;
  }
}

struct State {
  double x, v;
};

// The sampled loop on a plant with friction at f_lo, written down a second time: position and speed at the end of the
// pulse.
State run_pulse(const AxisParameters<double>& p, const Kick<double>& kick, double y) {
  double x = -y, v = 0, last_sample = -y, before_last = -y;
  for (int j = 0; j < kick.periods; ++j) {
    const double feedback =
        -p.stiffness_N_per_m * last_sample - p.kick_damping_Ns_per_m * (last_sample - before_last) / p.period_s;
    before_last = last_sample;
    last_sample = x;
    const double a = (kick.force_N + feedback - p.friction.lower_N) / p.mass_kg;
    x += v * p.period_s + a * p.period_s * p.period_s / 2;
    v += a * p.period_s;
  }
  return {x, v};
}

TEST(KickShaper, EndsThePulseOnTheK3Curve) {
  const auto p = sampled_axis<double>();
  const design::KickPlant<double> plant{p.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N};
  const auto k3 = design::K3<double>::make(plant);
  const auto table = design::build_k3_table<double>(plant, p.stick_radius_upper_m()).table;
  const KickShaper<double> shaper{p, 1.0};
  for (const double y : {2e-6, 1e-5, 1e-4, 1e-3, 5e-3, 1.1e-2}) {
    const auto kick = shaper.plan(table, y, 0.0, 0.0);
    const auto [x, v] = run_pulse(p, kick, y);
    EXPECT_LE(kick.force_N + p.stiffness_N_per_m * y, p.max_force_N) << y;
    ASSERT_LT(x, 0) << y;
    EXPECT_NEAR(v, k3.speed_m_s(-x), v * (kick.periods > 4 ? 2e-3 : 1e-5)) << y << " in " << int(kick.periods);
  }
}

TEST(KickShaper, SpreadsALargeImpulseOverAsManyPeriodsAsTheForceLimitDemands) {
  const auto p = sampled_axis<double>();
  const KickShaper<double> shaper{p, 1.0};
  const auto table = ballistic_table(p, p.stick_radius_upper_m());
  EXPECT_EQ(shaper.plan(table, 2e-6, 0.0, 0.0).periods, 1);
  const auto large = shaper.plan(table, p.stick_radius_upper_m(), 0.0, 0.0);
  EXPECT_GT(large.periods, 3);
  EXPECT_GT(large.force_N, 0.5 * p.max_force_N) << "fewer periods would have done";
}

TEST(KickShaper, TakesNoPeriodMoreForAnImpulseThatFillsWholeOnes) {
  auto p = sampled_axis<double>();
  p.kick_shape = KickShape::naive;
  p.period_s = 0x1p-10;
  p.max_force_N = p.friction.lower_N + 32;
  const KickShaper<double> shaper{p, 1.0};
  const auto table = ballistic_table(p, p.stick_radius_upper_m());
  const double of_a_period_Ns = 32 * 0x1p-10;
  EXPECT_EQ(shaper.plan(table, 1e-3, 3 * of_a_period_Ns, 0.0, 0.0).periods, 3);
  EXPECT_EQ(shaper.plan(table, 1e-3, 3.001 * of_a_period_Ns, 0.0, 0.0).periods, 4);
}

TEST(KickShaper, CutsAKickThatNeedsMoreThanItsLongestPulse) {
  auto p = sampled_axis<double>();
  p.max_force_N = 4.6;
  const KickShaper<double> shaper{p, 1.0};
  const auto kick = shaper.plan(ballistic_table(p, 1.0), 1.0, 0.0, 0.0);
  EXPECT_EQ(kick.periods, KickShaper<double>::max_periods);
  EXPECT_LE(kick.force_N + p.stiffness_N_per_m * 1e-3, p.max_force_N);
}

TEST(KickShaper, NaivePulseCarriesTheIdealImpulse) {
  auto p = sampled_axis<double>();
  p.kick_shape = KickShape::naive;
  const KickShaper<double> shaper{p, 1.0};
  const auto table = ballistic_table(p, p.stick_radius_upper_m());
  const auto kick = shaper.plan(table, 1e-3, 0.0, 0.0);
  EXPECT_NEAR(kick.force_N * kick.periods * p.period_s, -table.impulse_Ns(1e-3), 1e-12);
}

TEST(KickShaper, NeverExceedsTheForceLimitForAnyInput) {
  const auto p = sampled_axis<float>();
  const KickShaper<float> shaper{p, 1.0F};
  const auto table = ballistic_table(p, p.stick_radius_upper_m());
  std::mt19937 random{3};
  std::uniform_real_distribution<float> exponent{-40, 38};
  for (int i = 0; i < 100000; ++i) {
    const float y = std::pow(10.0F, exponent(random)), w = std::pow(10.0F, exponent(random));
    const auto kick = shaper.plan(table, y, w, std::pow(10.0F, exponent(random)));
    const float feedback = std::min(p.stiffness_N_per_m * y, p.max_force_N);
    ASSERT_LE(kick.force_N + feedback, p.max_force_N * 1.0001F) << y << ' ' << w;
    ASSERT_GE(kick.periods, 1);
    ASSERT_LE(kick.periods, KickShaper<float>::max_periods);
  }
}

}  // namespace
}  // namespace breakaway::law
