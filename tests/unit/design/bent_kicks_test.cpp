// Kicks on friction that bends, tried by the design, against the plant of the tests that is kicked in the same way.
#include "../../../controller/design/src/bent_kicks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../../controller/design/src/kick_class.hpp"
#include "../../bristled_axis.hpp"
#include "../../kicked_axis.hpp"

namespace breakaway::design {
namespace {

using breakaway::testing::axes_of_the_scenes;
using breakaway::testing::BristledSlider;
using breakaway::testing::Friction;
using breakaway::testing::Moment;
using breakaway::testing::TrueAxis;
using detail::BentKicks;
using detail::KickClass;
using detail::try_bent_kicks;

BrakedClass bending(double stiffness_N_per_m) {
  BrakedClass c = axes_of_the_scenes(0);
  c.presliding_stiffness_N_per_m = stiffness_N_per_m;
  return c;
}

// What moves it on when it is kicked as from a distance, led by a force before and after. Every mass, gain and lag of
// the class is the same.
double kicked_m(const BrakedClass& c, const law::BrakedKicks<float>& kicks, double from_m, double stiffness_N_per_m,
                const Friction& friction, double held_N) {
  BristledSlider axis{TrueAxis{}, {stiffness_N_per_m, 0, 0}, friction, 0, 0};
  const auto settle = [&](double force_N) {
    for (int i = 0; i < 40; ++i) axis.run(force_N, 0.1, 1);
  };
  settle(held_N);
  const double before_m = axis.position_m();
  const law::Pulse<float> pulse = kicks.table.pulse(static_cast<float>(from_m));
  for (int i = 0; i < pulse.periods; ++i)
    axis.run(std::min(static_cast<double>(pulse.force_N), KickClass{c}.limit_N()), c.period_s, 1);
  settle(0);
  settle(held_N);
  return axis.position_m() - before_m;
}

constexpr double ringing_m = 1e-6;  // that is left of either, at most

TEST(BentKicks, GoAsFarAsThePlantOfTheTestsDoes) {
  const BrakedClass c = bending(1e5);
  const auto kicks = design_braked_kicks<float>(c).kicks;
  const BentKicks tried = try_bent_kicks(c, kicks, 60e-6);
  double furthest_m = 0;
  for (const double stiffer : {1.0, 2.5})
    furthest_m =
        std::max(furthest_m, kicked_m(
                                 c, kicks, tried.furthest_from_m, stiffer * 1e5, [](const Moment&) { return 2.5; }, 0));
  EXPECT_NEAR(tried.furthest * tried.furthest_from_m, furthest_m, ringing_m);
  EXPECT_GT(tried.furthest, 1.05);
}

TEST(BentKicks, LeadOnAsFarAsThePlantOfTheTestsDoes) {
  const BrakedClass c = bending(1e5);
  const auto kicks = design_braked_kicks<float>(c).kicks;
  const BentKicks tried = try_bent_kicks(c, kicks, 1e-6);
  const double spring_N = KickClass{c}.spring_N();
  double least_m = 1;
  for (const double stiffness : {1e5, 2.5e5}) {
    const double led_m = 4.5 / stiffness * std::log(4.5 / (4.5 - spring_N));
    const bool is_led = tried.least_on_from_m + led_m < static_cast<double>(kicks.spring.reach_m);
    for (const double back_N : {2.5, 4.5}) {
      const auto friction = [=](const Moment& now) { return now.velocity_m_s > 0 ? 4.5 : back_N; };
      const double on_m = kicked_m(c, kicks, tried.least_on_from_m, stiffness, friction, is_led ? spring_N : 0);
      least_m = std::min(least_m, on_m);
    }
  }
  EXPECT_NEAR(tried.least_on * tried.least_on_from_m, least_m, ringing_m);
}

// A load leads it back as long as it rings, by 3 times what the load bends it, and the logarithm of the rings.
TEST(BentKicks, LeadOnLessTheGreaterTheLoadIs) {
  double before = 1;
  for (const double load_N : {0.0, 0.1, 0.2}) {
    BrakedClass c = bending(1e5);
    c.load_N = load_N;
    const double least_on = try_bent_kicks(c, design_braked_kicks<float>(c).kicks, 1e-6).least_on;
    EXPECT_LT(least_on, before) << load_N;
    before = least_on;
  }
}

// It was certified, and ended as hunting: what leads it back while it rings is the load, on friction that is the least
// that way.
TEST(BentKicks, LeadAnAxisNowhereWhoseFrictionIsTheGreatestAheadAndTheLeastBack) {
  BrakedClass c;
  c.mass_kg = {0.0190219745, 0.0190219745};
  c.friction = {0.252011286, 1.34191053};
  c.load_N = 0.0241579596;
  c.lag_s = {0.267924509e-3, 0.267924509e-3};
  c.max_force_N = 8.9495818;
  c.force_step_N = 0.00562156508;
  c.period_s = 4e-3;
  c.encoder_resolution_m = 1.7140339e-5;
  c.presliding_stiffness_N_per_m = 471.668755;
  const auto design = design_braked_kicks<float>(c);
  ASSERT_TRUE(design.possible());
  EXPECT_LT(try_bent_kicks(c, design.kicks, 0.00461293414).least_on, 0);
}

TEST(BentKicks, GoWhereTheyAimOnFrictionThatHardlyBends) {
  const BrakedClass stiff = bending(1e8);
  const BentKicks tried = try_bent_kicks(stiff, design_braked_kicks<float>(stiff).kicks, 2e-6);
  EXPECT_NEAR(tried.furthest, 1, 2 * std::sqrt(2.5 / 1e8 / 2e-6)) << "less energy by a bend of friction";
  EXPECT_GT(tried.least_on, least_share);
  const BrakedClass stiffest = bending(1e10);
  const BentKicks unseen = try_bent_kicks(stiffest, design_braked_kicks<float>(stiffest).kicks, 2e-6);
  EXPECT_EQ(unseen.furthest, 1);
  EXPECT_EQ(unseen.least_on, 1);
}

}  // namespace
}  // namespace breakaway::design
