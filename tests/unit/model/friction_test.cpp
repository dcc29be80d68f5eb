#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include "breakaway/model/friction_law.hpp"
#include "breakaway/model/shapes.hpp"

namespace breakaway::model {
namespace {

using namespace shape;

std::vector<ShapePtr> both(ShapePtr a, ShapePtr b) {
  std::vector<ShapePtr> parts;
  parts.push_back(std::move(a));
  parts.push_back(std::move(b));
  return parts;
}

void expect_refusal(const char* named, const std::function<void()>& make) {
  try {
    make();
    ADD_FAILURE() << "accepted a bad " << named;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
  }
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(FrictionBounds, RefuseWhatAssumption1ExcludesAndNameIt) {
  expect_refusal("lower_N", [] { FrictionLaw({0, 1}, constant(0)); });
  expect_refusal("lower_N", [] { FrictionLaw({-1, 1}, constant(0)); });
  expect_refusal("lower_N", [] { FrictionLaw({2, 1}, constant(0)); });
  expect_refusal("upper_N", [] { FrictionLaw({1, nan}, constant(0)); });
  expect_refusal("mu_lower", [] { bounds_from_coefficients(1, 10, nan, 0.4); });
  expect_refusal("mu_lower", [] { bounds_from_coefficients(1, 10, 0.5, 0.4); });
  expect_refusal("mass_kg", [] { bounds_from_coefficients(0, 10, 0.2, 0.4); });
  expect_refusal("gravity_m_s2", [] { bounds_from_coefficients(1, -10, 0.2, 0.4); });
}

TEST(Shapes, RefuseParametersOutOfRangeAndNameThem) {
  expect_refusal("value", [] { constant(1.1); });
  expect_refusal("kinetic_value", [] { static_kinetic(1, nan); });
  expect_refusal("stribeck_velocity_m_s", [] { stribeck(0); });
  expect_refusal("stribeck_velocity_m_s", [] { stribeck_gaussian(nan); });
  expect_refusal("angular_frequency_rad_s", [] { sine_in_time(-1); });
  expect_refusal("period_m", [] { sine_in_position(0); });
  expect_refusal("edges_m", [] { position_table({1, 1}, {0, 0, 0}); });
  expect_refusal("values", [] { position_table({1, 2}, {0, 0}); });
  expect_refusal("longest_dwell_s", [] { random_dwell({.shortest_dwell_s = 1, .longest_dwell_s = 0.1}); });
  expect_refusal("bound_share", [] { random_dwell({.bound_share = -0.1}); });
  expect_refusal("weights", [] { mean({1}, both(constant(0), constant(1))); });
  expect_refusal("weights", [] { mean({0, 0}, both(constant(0), constant(1))); });
  expect_refusal("parts", [] { product({}); });
  expect_refusal("parts", [] { complement(nullptr); });
  expect_refusal("shape", [] { FrictionLaw({1, 2}, nullptr); });
}

TEST(FrictionLaw, IsThePapersLawAsTheMeanOfStribeckAndSine) {
  FrictionLaw law(bounds_from_coefficients(1, 10, 0.25, 0.45), mean({0.5, 0.5}, both(stribeck(2), sine_in_time(4))));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> time(0, 10), velocity(0, 20);
  law.face(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const double t = time(random), v = velocity(random);
    const double mu = (0.4 - 0.3) / (1 + 0.5 * v) + 0.3 + 0.05 * std::sin(4 * t);
    EXPECT_NEAR(law.level_N(t, 0, v), 10 * mu, 1e-14);
  }
}

// A random tree of shapes, up to three levels deep.
ShapePtr random_shape(std::mt19937_64& random, int depth) {
  std::uniform_real_distribution<double> unit(0, 1);
  switch (std::uniform_int_distribution<int>(0, depth > 0 ? 11 : 6)(random)) {
    case 0:
      return constant(unit(random));
    case 1:
      return static_kinetic(unit(random), unit(random));
    case 2:
      return stribeck(unit(random) + 0.01);
    case 3:
      return stribeck_gaussian(unit(random) + 0.01);
    case 4:
      return sine_in_time(20 * unit(random) + 0.1, 6 * unit(random));
    case 5:
      return sine_in_position(unit(random) + 0.1, 6 * unit(random));
    case 6:
      return random_dwell({.seed = random(), .bound_share = 0.5});
    case 7:
      return mean({unit(random), 1 + unit(random)},
                  both(random_shape(random, depth - 1), random_shape(random, depth - 1)));
    case 8:
      return product(both(random_shape(random, depth - 1), random_shape(random, depth - 1)));
    case 9:
      return maximum(both(random_shape(random, depth - 1), random_shape(random, depth - 1)));
    case 10:
      return minimum(both(random_shape(random, depth - 1), random_shape(random, depth - 1)));
    default:
      return complement(random_shape(random, depth - 1));
  }
}

TEST(FrictionLaw, StaysWithinItsBoundsForRandomCompositions) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> number(0, 3);
  for (int i = 0; i < 2000; ++i) {
    FrictionLaw law({0.3, 0.7}, random_shape(random, 3));
    law.on_time(0);
    for (int j = 0; j < 20; ++j) {
      const double x = number(random);
      law.face(x, j % 3 - 1);
      if (j % 5 == 0) law.on_stick(j);
      if (j % 5 == 2) law.on_slip(j);
      const double level_N = law.level_N(j, x, number(random));  // trial steps may ask for a negative speed
      EXPECT_GE(level_N, 0.3);
      EXPECT_LE(level_N, 0.7);
      const double breakaway_N = law.breakaway_N(j, x, 1);
      EXPECT_GE(breakaway_N, 0.3);
      EXPECT_LE(breakaway_N, 0.7);
    }
  }
}

TEST(FrictionLaw, BreaksAwayAtTheStaticLevelOrTheKineticOneIfThatIsGreater) {
  FrictionLaw falling({1, 2}, static_kinetic(1, 0)), rising({1, 2}, static_kinetic(0, 1));
  EXPECT_EQ(falling.breakaway_N(0, 0, 1), 2);
  EXPECT_EQ(rising.breakaway_N(0, 0, -1), 2);
  falling.face(0, 1);
  EXPECT_EQ(falling.level_N(0, 0, 0), 1);
}

TEST(PositionTable, TakesTheCellThatTheMotionEnters) {
  FrictionLaw law({1, 2}, position_table({0, 1}, {0, 0.5, 1}));
  law.face(0, 1);
  EXPECT_EQ(law.level_N(0, 0, 1), 1.5);
  EXPECT_EQ(law.range_m().lower_m, 0);
  EXPECT_EQ(law.range_m().upper_m, 1);
  law.face(0, -1);
  EXPECT_EQ(law.level_N(0, 0, 1), 1);
  EXPECT_EQ(law.range_m().upper_m, 0);
  law.face(5, -1);
  EXPECT_EQ(law.level_N(0, 5, 1), 2);
  EXPECT_TRUE(law.constant_between_events());
}

TEST(RandomDwell, RedrawsAtItsTimesAndAtEveryStickAndSlipOnly) {
  FrictionLaw law({1, 2}, random_dwell({.seed = 7}));
  law.on_time(3);
  const double first_N = law.level_N(3, 0, 0), change_s = law.next_time_change_s();
  EXPECT_GT(change_s, 3.001);
  EXPECT_LT(change_s, 4);
  law.face(0, 1);
  law.on_time(0.5 * (3 + change_s));
  EXPECT_EQ(law.level_N(change_s, 0, 9), first_N);
  law.on_time(change_s);
  const double second_N = law.level_N(change_s, 0, 0);
  EXPECT_NE(second_N, first_N);
  EXPECT_GT(law.next_time_change_s(), change_s);
  law.on_slip(change_s);
  const double third_N = law.level_N(change_s, 0, 0);
  EXPECT_NE(third_N, second_N);
  law.on_stick(change_s);
  EXPECT_NE(law.level_N(change_s, 0, 0), third_N);
}

TEST(RandomDwell, HasTheStatedDistribution) {
  FrictionLaw law({1, 2}, random_dwell({.seed = 11, .bound_share = 0.25}));
  int at_bounds = 0, short_dwells = 0;
  double interior_sum = 0;
  constexpr int draws = 40000;
  double time_s = 0;
  for (int i = 0; i < draws; ++i) {
    law.on_time(time_s);
    const double level_N = law.level_N(time_s, 0, 0);
    const double dwell_s = law.next_time_change_s() - time_s;
    EXPECT_GE(dwell_s, 0.9999e-3);
    EXPECT_LE(dwell_s, 1.0001);
    short_dwells += dwell_s < std::sqrt(1e-3);  // the median of a log-uniform dwell
    if (level_N == 1 || level_N == 2) {
      ++at_bounds;
    } else {
      interior_sum += level_N;
    }
    time_s = law.next_time_change_s();
  }
  // Five standard deviations of the sample.
  EXPECT_NEAR(at_bounds, 0.25 * draws, 5 * std::sqrt(0.25 * 0.75 * draws));
  EXPECT_NEAR(short_dwells, 0.5 * draws, 5 * std::sqrt(0.25 * draws));
  EXPECT_NEAR(interior_sum / (draws - at_bounds), 1.5, 5 * std::sqrt(1.0 / 12 / (0.75 * draws)));
}

TEST(FrictionLaw, CopyReplaysTheSameRandomness) {
  FrictionLaw law({1, 2}, product(both(random_dwell({.seed = 5}), sine_in_time(3))));
  law.on_time(0);
  FrictionLaw copy = law;
  for (int i = 0; i < 10; ++i) {
    law.on_stick(i);
    copy.on_stick(i);
    EXPECT_EQ(law.level_N(i, 0, 0), copy.level_N(i, 0, 0));
    EXPECT_EQ(law.next_time_change_s(), copy.next_time_change_s());
  }
  law.on_stick(10);
  EXPECT_NE(law.next_time_change_s(), copy.next_time_change_s());
}

TEST(Combinations, ComputeWhatTheirNamesSay) {
  const auto value = [](ShapePtr shape) { return shape->value(0, 0, 0); };
  EXPECT_DOUBLE_EQ(value(mean({1, 3}, both(constant(0.2), constant(0.6)))), 0.5);
  EXPECT_DOUBLE_EQ(value(product(both(constant(0.2), constant(0.6)))), 0.12);
  EXPECT_DOUBLE_EQ(value(maximum(both(constant(0.2), constant(0.6)))), 0.6);
  EXPECT_DOUBLE_EQ(value(minimum(both(constant(0.2), constant(0.6)))), 0.2);
  EXPECT_DOUBLE_EQ(value(complement(constant(0.2))), 0.8);
  const auto sines = product(both(sine_in_time(3), sine_in_time(2)));
  EXPECT_DOUBLE_EQ(sines->time_scale_s(), 1.0 / 5);
}

}  // namespace
}  // namespace breakaway::model
