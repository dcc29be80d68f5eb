// The kicks of the coast "pd" against the law that gives them, on an axis that is followed by another program.
#include "breakaway/design/pd_kicks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <random>

#include "../../kicked_axis.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway::design {
namespace {

template <class Real>
law::AxisParameters<Real> example(double period_s = 1e-3, int latency_periods = 1) {
  law::AxisParameters<Real> p;
  p.mass_kg = 1;
  p.stiffness_N_per_m = 400;
  p.approach_damping_Ns_per_m = 32;
  p.kick_damping_Ns_per_m = 60;
  p.friction = {Real(2.5), Real(4.5)};
  p.max_force_N = 50;
  p.encoder_resolution_m = Real(1e-6);
  p.period_s = static_cast<Real>(period_s);
  p.latency_periods = static_cast<std::uint8_t>(latency_periods);
  p.position_tolerance_m = std::max(p.accuracy_floor_m(), Real(1e-6));
  return p;
}

struct Landing {
  double error_m = 0;   // the furthest that the first kick leads beyond the target; negative: so much short of it
  double kicked_m = 0;  // from where
};

constexpr int parts = 100;  // of a period, after each of which is looked where the axis is

// From rest at distance_m, or moved on at a constant speed by whatever until the law kicks. It reads positions as they
// are, and what is stated of counts only smooths its velocity.
template <class Real>
Landing first_kick(const law::AxisParameters<Real>& p, const law::KickTable<Real>& pulses, double friction_N,
                   double distance_m, double creeping_m_s = 0, double lag_s = 0) {
  const auto k3 =
      build_k3_table<Real>({static_cast<double>(p.mass_kg), static_cast<double>(p.stiffness_N_per_m),
                            static_cast<double>(p.kick_damping_Ns_per_m), static_cast<double>(p.friction.lower_N)},
                           static_cast<double>(p.stick_radius_upper_m()));
  law::AxisController<Real> controller{p, k3.table, pulses};
  const auto friction = [friction_N](const testing::Moment&) { return friction_N; };
  testing::Slider axis{
      {static_cast<double>(p.mass_kg), 1, lag_s, 0, p.latency_periods}, friction, -distance_m, creeping_m_s};
  const double T = static_cast<double>(p.period_s);
  std::deque<double> samples;
  for (int ago = p.latency_periods; ago > 0; --ago) samples.push_back(-distance_m - ago * creeping_m_s * T);
  double crept_m = -distance_m;
  Landing landing;
  bool kicked = false;
  for (int k = 0; k < 2'000'000; ++k) {
    samples.push_back(kicked ? axis.position_m() : crept_m);
    if (samples.size() > p.latency_periods + 1U) samples.pop_front();
    const auto out = controller.update({static_cast<Real>(samples.front()), 0, true});
    if (out.kicked && kicked) break;
    if (out.kicked) {
      kicked = true;
      landing.kicked_m = crept_m;
      axis = testing::Slider{
          {static_cast<double>(p.mass_kg), 1, lag_s, 0, p.latency_periods}, friction, crept_m, creeping_m_s};
      landing.error_m = crept_m;
    }
    if (!kicked) {
      crept_m += creeping_m_s * T;
      if (crept_m > 0) break;
      continue;
    }
    for (int part = 0; part < parts; ++part) {
      axis.run(static_cast<double>(out.force_N), T / parts, 1);
      landing.error_m = std::max(landing.error_m, axis.position_m());
    }
    if (out.mode == law::Mode::hold || controller.fault() != law::ControlFault::none) break;
  }
  EXPECT_TRUE(kicked);
  return landing;
}

template <class Real>
void expect_kicks_that_end_on_the_target(const law::AxisParameters<Real>& p, double aim_lost, double rounding) {
  const PdKicks<Real> kicks = design_pd_kicks(p);
  EXPECT_LE(kicks.aim_lost, aim_lost);
  std::mt19937_64 bits{3};
  // The axis turns between two looks, with less than 20 m/s2 on either side.
  const double unseen_m = 10 * std::pow(static_cast<double>(p.period_s) / parts, 2);
  const double least_m = 1.01 * static_cast<double>(p.position_tolerance_m);
  const double most_m = 0.999 * static_cast<double>(p.friction.lower_N / p.stiffness_N_per_m);
  for (int i = 0; i < 40; ++i) {
    const double share = static_cast<double>(bits() >> 11U) * 0x1p-53;
    const double y = least_m * std::pow(most_m / least_m, share);
    const double error_m = first_kick(p, kicks.table, static_cast<double>(p.friction.lower_N), y).error_m;
    EXPECT_LE(error_m, 0) << "from " << y;
    EXPECT_GE(error_m, -(1.1 * kicks.aim_lost + rounding) * y - unseen_m) << "from " << y;
  }
}

// The law computes in its type, and reads its own positions: in double there is hardly any rounding.
TEST(PdKicks, EndOnTheTargetUnderTheLeastFrictionAndNeverBeyond) {
  for (const double period_s : {4e-3, 1e-3, 2.5e-4, 1e-4}) {
    for (const int latency : {0, 1, 2, 3}) {
      SCOPED_TRACE(::testing::Message() << period_s << " s, latency " << latency);
      expect_kicks_that_end_on_the_target(example<double>(period_s, latency), 3e-5, 1e-9);
      expect_kicks_that_end_on_the_target(example<float>(period_s, latency), 3e-5, 2e-6);
    }
  }
}

// The force follows by a first-order lag, where the table counts one that comes as much later. Near the floor, where
// the force exceeds friction by little, the axis stops the shorter for it.
TEST(PdKicks, NeverLeadBeyondBehindACurrentLoopThatLags) {
  for (const int latency : {0, 1, 2}) {
    for (const double lag_s : {5e-5, 1e-4, 2e-4}) {
      const auto p = example<double>(1e-3, latency);
      const auto kicks = design_pd_kicks(p, lag_s);
      for (const double y : {5e-6, 3e-5, 1e-3, 5e-3}) {
        const double error_m = first_kick(p, kicks.table, 2.5, y, 0, lag_s).error_m;
        EXPECT_LE(error_m, 0) << "latency " << latency << ", " << lag_s << " s, from " << y;
        EXPECT_GE(error_m, -0.01 * y - y * lag_s / 1e-3) << "latency " << latency << ", " << lag_s << " s, from " << y;
      }
    }
  }
}

// Without feedback the pulse of one period that lands on the target is F = (A + sqrt(A^2 + 8 m A y / T^2)) / 2.
TEST(PdKicks, MatchTheClosedFormOfABallisticKick) {
  auto p = example<double>();
  p.stiffness_N_per_m = 1e-9;
  p.kick_damping_Ns_per_m = 1e-4;
  p.max_force_N = std::numeric_limits<double>::infinity();
  const double A = p.friction.lower_N, T = p.period_s;
  for (const double y : {2e-6, 1e-5, 1e-3, 0.1}) {
    const double force_N = (A + std::sqrt(A * A + 8 * A * y / (T * T))) / 2;
    EXPECT_NEAR(pd_travel_m(p, 0, y, force_N, 1) / y, 1, 1e-4 * std::sqrt(y) + 1e-9) << y;
  }
}

TEST(PdKicks, TendToK3OfTheFirstOrder) {
  const double y = 1e-3;
  const double k3_Ns = K3<double>::make({1, 400, 60, 2.5}).impulse_Ns(-y);
  const auto off = [&](double period_s) {
    auto p = example<double>(period_s);
    p.max_force_N = std::numeric_limits<double>::infinity();
    p.encoder_resolution_m = 0;  // a velocity that is measured, and not smoothed
    p.position_tolerance_m = 5e-4;
    const law::Pulse<double> pulse = design_pd_kicks(p).table.pulse(std::sqrt(y));
    return (pulse.force_N - p.stiffness_N_per_m * y) * pulse.periods * period_s / k3_Ns - 1;
  };
  EXPECT_LE(std::fabs(off(1e-6)), 4e-5);
  EXPECT_NEAR(off(1e-4) / off(1e-5), 10, 1);
}

// The fewest periods with which a force within the limit reaches the target may leave too little of it: then one less
// takes a share, where that did nothing.
TEST(PdKicks, AreSureToLeadOnFromAnywhereBehindAWeakDrive) {
  for (const double force_N : {6.75, 8.0, 20.0}) {
    auto p = example<double>();
    p.max_force_N = force_N;
    const auto table = design_pd_kicks(p).table;
    auto under_most = p;
    under_most.friction.lower_N = p.friction.upper_N;
    for (double y = p.stick_radius_upper_m(); y > 1.3 * p.position_tolerance_m; y *= 0.97) {
      const law::Pulse<double> pulse = table.pulse(std::sqrt(y));
      const double taken_m = pd_travel_m(under_most, 0, y, std::min(pulse.force_N, force_N), pulse.periods);
      ASSERT_GE(taken_m, 0.03 * y) << "from " << y << " with " << force_N;
    }
  }
}

TEST(PdKicks, OfK3SpreadItOverWholePeriodsAndGoTooFar) {
  const auto p = example<double>(4e-3, 1);
  const auto naive = design_pd_kicks(p, 0, PulseAim::k3).table;
  const double y = 1e-3;
  const law::Pulse<double> pulse = naive.pulse(std::sqrt(y));
  const double k3_Ns = K3<double>::make({1, 400, 60, 2.5}).impulse_Ns(-y);
  EXPECT_NEAR((pulse.force_N - 400 * y) * pulse.periods * 4e-3, k3_Ns, 1e-6 * k3_Ns);
  EXPECT_NEAR(first_kick(p, naive, 2.5, y).error_m, 3.0e-4, 1e-5);
  EXPECT_NEAR(first_kick(p, design_pd_kicks(p).table, 2.5, y).error_m, 0, 2e-8);
}

// It is kicked in motion, under friction that has let it creep until then.
TEST(PdKicks, CountTheSpeedOfACreepingAxisInAndDoNotLeadItBeyond) {
  for (const int latency : {0, 1, 2}) {
    const auto p = example<double>(1e-3, latency);
    const auto kicks = design_pd_kicks(p);
    for (const double y : {9.5e-3, 5e-3, 2e-3, 5e-4}) {
      for (const double share : {0.02, 0.05, 0.1, 0.15, 0.2, 0.24}) {
        const double curve_m_s = K3<double>::make({1, 400, 60, 2.5}).impulse_Ns(-y);
        const Landing kick = first_kick(p, kicks.table, 2.5, y, share * curve_m_s);
        EXPECT_LT(kick.kicked_m, 0);
        EXPECT_LE(kick.error_m, 0) << "from " << kick.kicked_m << ", " << share << ", latency " << latency;
        EXPECT_GE(kick.error_m, 0.5 * kick.kicked_m) << "from " << kick.kicked_m << ", " << share;
      }
    }
  }
}

// The spring moves it off under the least friction, and its speed grows between the reading and the kick.
TEST(PdKicks, DoNotLeadAnAxisBeyondThatHasJustSetOut) {
  for (const int latency : {0, 1, 2}) {
    const auto p = example<double>(1e-3, latency);
    const auto k3 = build_k3_table<double>({1, 400, 60, 2.5}, p.stick_radius_upper_m());
    const auto pulses = design_pd_kicks(p);
    for (const double y : {7e-3, 8e-3, 9e-3, 1e-2, 1.1e-2}) {
      law::AxisController<double> controller{p, k3.table, pulses.table};
      testing::Slider axis{{1, 1, 0, 0, latency}, [](const testing::Moment&) { return 2.5; }, -y, 0};
      std::deque<double> samples;
      double furthest_m = -y;
      for (int k = 0; k < 1000 && controller.mode() != law::Mode::hold; ++k) {
        samples.push_back(axis.position_m());
        if (samples.size() > p.latency_periods + 1U) samples.pop_front();
        const double force_N = controller.update({samples.front(), 0, true}).force_N;
        for (int part = 0; part < parts; ++part) {
          axis.run(force_N, p.period_s / parts, 1);
          furthest_m = std::max(furthest_m, axis.position_m());
        }
      }
      EXPECT_EQ(controller.mode(), law::Mode::hold) << "from " << y;
      EXPECT_LE(furthest_m, 0) << "from " << y << ", latency " << latency;
    }
  }
}

// Damped by a velocity that is smoothed over thousands of periods the spring alone leads such an axis beyond its
// target.
TEST(PdKicks, SayHowFarBeyondAnAxisGoesForWhichNoPulseIsRight) {
  law::AxisParameters<double> p;
  p.mass_kg = 1.71619;
  p.stiffness_N_per_m = 66702.9;
  p.approach_damping_Ns_per_m = 300;
  p.kick_damping_Ns_per_m = 677.543;
  p.friction = {1786.09, 7698.65};
  p.position_tolerance_m = 0.0547276;
  p.encoder_resolution_m = 0.00222108;
  p.period_s = 0.000149961;
  EXPECT_GT(design_pd_kicks(p).beyond, 0.5);
  EXPECT_EQ(design_pd_kicks(example<double>()).beyond, 0);
}

TEST(PdKicks, CoverAllDistancesAtWhichAnAxisMayStick) {
  auto p = example<float>(1e-4);
  p.encoder_resolution_m = 1e-9F;
  p.position_tolerance_m = 2e-8F;
  const auto table = design_pd_kicks(p).table;
  EXPECT_LE(table.least_m(), std::sqrt(2e-8F));
  EXPECT_GE(table.reach_m(), std::sqrt(p.stick_radius_upper_m()));
  EXPECT_LE(sizeof(table), 2150U);
  p = example<float>();
  for (const float tolerance_m : {2e-4F, 5e-3F, 0.02F}) {
    p.position_tolerance_m = tolerance_m;
    const auto wide = design_pd_kicks(p).table;
    EXPECT_TRUE(wide.is_usable());
    EXPECT_LE(wide.least_m(), std::sqrt(8 * p.accuracy_floor_m() + 1e-6F))
        << "a creeping axis is kicked inside it, too";
  }
}

TEST(PdKicks, AreRefusedForParametersThatAreNotValidOrHaveNoPeriod) {
  EXPECT_THROW(design_pd_kicks(example<double>(0)), InputError);
  auto p = example<double>();
  p.max_force_N = p.friction.upper_N;
  EXPECT_THROW(design_pd_kicks(p), InputError);
}

}  // namespace
}  // namespace breakaway::design
