// The parts of plants beyond the rigid axis, each against its own equation.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/model/compliant_plant.hpp"
#include "breakaway/model/encoder_error.hpp"
#include "breakaway/model/friction_drift.hpp"
#include "breakaway/model/shapes.hpp"

namespace breakaway::model {
namespace {

using testing::refusal;

TEST(FrictionDrift, MultipliesTheLevelAndWidensTheBounds) {
  std::vector<ShapePtr> parts;
  parts.push_back(shape::stribeck(2));
  parts.push_back(shape::sine_in_position(0.1));
  const FrictionLaw law{{2.5, 4.5}, shape::mean({0.5, 0.5}, std::move(parts))};
  const FrictionLaw slow = drifting(law, {0.2, 10});
  EXPECT_DOUBLE_EQ(slow.bounds().lower_N, 2.0);
  EXPECT_DOUBLE_EQ(slow.bounds().upper_N, 5.4);
  for (double time_s = 0; time_s < 20; time_s += 0.7) {
    const double factor = 1 + 0.2 * std::sin(2 * std::numbers::pi * time_s / 10);
    const double expected_N = law.level_N(time_s, 0.3 * time_s, 0.1 * time_s) * factor;
    // The level goes through a share of the bounds and back: a few roundings of the widest bound.
    EXPECT_NEAR(slow.level_N(time_s, 0.3 * time_s, 0.1 * time_s), expected_N, 1e-14);
  }
}

TEST(FrictionDrift, KeepsTheEventsOfItsLaw) {
  FrictionLaw slow = drifting({{2.5, 4.5}, shape::static_kinetic(1, 0)}, {0.1, 1e9});
  EXPECT_NEAR(slow.breakaway_N(0, 0, 1), 4.5, 1e-6);
  slow.face(0, 1);
  EXPECT_NEAR(slow.level_N(0, 0, 1), 2.5, 1e-6);
  const FrictionLaw dwell{{2.5, 4.5}, shape::random_dwell({.seed = 3})};
  FrictionLaw copy = dwell, slow_dwell = drifting(dwell, {0.1, 100});
  copy.on_time(0), slow_dwell.on_time(0);
  EXPECT_EQ(slow_dwell.next_time_change_s(), copy.next_time_change_s());
}

TEST(FrictionDrift, TellsHowFastItVaries) {
  const FrictionLaw constant{{2, 4}, shape::constant(1)};
  EXPECT_TRUE(constant.constant_between_events());
  const FrictionLaw slow = drifting(constant, {0.1, 2 * std::numbers::pi});
  EXPECT_TRUE(slow.varies_with_time());
  EXPECT_DOUBLE_EQ(slow.time_scale_s(), 1);
}

TEST(EncoderError, IsTheSineOfTheLinesWithoutNoise) {
  EncoderError error{{.interpolation = {2e-7, 2e-5, 0.3}}};
  for (const double position_m : {0.0, 1e-6, 1.234, -7.0})
    EXPECT_DOUBLE_EQ(error.read_m(position_m),
                     position_m + 2e-7 * std::sin(2 * std::numbers::pi * position_m / 2e-5 + 0.3));
}

TEST(EncoderError, HasNormalNoiseThatItsSeedRepeats) {
  EncoderError first{{.noise_m = 1e-6, .seed = 7}}, second{{.noise_m = 1e-6, .seed = 7}}, other{{.noise_m = 1e-6}};
  constexpr int readings = 100000;
  double sum = 0, squares = 0, fourths = 0;
  int differing = 0;
  for (int i = 0; i < readings; ++i) {
    const double noise = first.read_m(0) / 1e-6;
    EXPECT_EQ(second.read_m(0) / 1e-6, noise);
    differing += other.read_m(0) / 1e-6 != noise ? 1 : 0;
    sum += noise, squares += noise * noise, fourths += std::pow(noise, 4);
  }
  // Five standard errors of the mean, the variance and the fourth moment of a normal distribution.
  EXPECT_NEAR(sum / readings, 0, 5 / std::sqrt(readings));
  EXPECT_NEAR(squares / readings, 1, 5 * std::sqrt(2.0 / readings));
  EXPECT_NEAR(fourths / readings, 3, 5 * std::sqrt(96.0 / readings));
  EXPECT_GT(differing, readings - 10);
}

TEST(Presliding, IsPassiveForEveryLevelBendAndSpeed) {
  const Presliding lugre{1e6, 3e3};
  for (const double level_N : {0.5, 2.5, 4.5}) {
    for (double bend_m = -9e-6; bend_m < 9e-6; bend_m += 1e-7) {
      for (const double velocity_m_s : {-3.0, -1e-3, -1e-9, 1e-9, 1e-3, 3.0}) {
        const int direction = velocity_m_s > 0 ? 1 : -1;
        const double in_W = lugre.force_N(bend_m, velocity_m_s, direction, level_N) * velocity_m_s;
        const double stored_W =
            lugre.stiffness_N_per_m * bend_m * lugre.bend_rate_m_s(bend_m, velocity_m_s, direction, level_N);
        EXPECT_GE(in_W - stored_W, -1e-14 * std::abs(in_W)) << bend_m << ' ' << velocity_m_s;
      }
    }
  }
}

TEST(Presliding, HoldsItsLevelInSteadySliding) {
  const Presliding lugre{1e6, 3e3};
  for (const int direction : {-1, 1}) {
    const double bend_m = direction * 2.5 / 1e6;
    EXPECT_NEAR(lugre.bend_rate_m_s(bend_m, direction * 0.7, direction, 2.5), 0, 1e-16);
    EXPECT_NEAR(lugre.force_N(bend_m, direction * 0.7, direction, 2.5), direction * 2.5, 1e-12);
  }
}

TEST(Parts, NameTheMemberThatIsOutOfRange) {
  EXPECT_NE(refusal([] { require_valid(Presliding{0, 1}); }).find("stiffness_N_per_m"), std::string::npos);
  EXPECT_NE(refusal([] { require_valid(ElasticCoupling{1, -1, 0}); }).find("damping_Ns_per_m"), std::string::npos);
  EXPECT_NE(refusal([] { require_valid(PositionSine{1, 0, 0}); }).find("period_m"), std::string::npos);
  EXPECT_NE(refusal([] { require_valid(CompliantPlant{.ripple = {1, 1, 0}}); }).find("ripple"), std::string::npos);
  EXPECT_NE(refusal([] { EncoderError{{.noise_m = -1}}; }).find("noise_m"), std::string::npos);
  const FrictionLaw law{{2, 4}, shape::constant(1)};
  EXPECT_NE(refusal([&] { drifting(law, {1, 1}); }).find("share"), std::string::npos);
  EXPECT_NE(refusal([&] { drifting(law, {0.1, 0}); }).find("period_s"), std::string::npos);
}

}  // namespace
}  // namespace breakaway::model
