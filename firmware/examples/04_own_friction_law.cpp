// Example 4: a friction law of your own, in a test.
//
// A shape says where between its two bounds the friction is, as a number from 0 to 1. This one is a guide with a bad spot: friction
// is at its upper bound within 2 mm of a place, and falls off smoothly to both sides. The test holds an axis with it to its promise, which must be kept for every law
// between the bounds, and so for this one.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_scenario.hpp"

using namespace breakaway;

class BadSpot final : public model::Shape {
 public:
  explicit BadSpot(double place_m) : place_m_{place_m} {}

  std::unique_ptr<Shape> clone() const override { return std::make_unique<BadSpot>(*this); }
  double value(double /*time_s*/, double position_m, double /*speed_m_s*/) const override {
    const double distance = (position_m - place_m_) / 2e-3;
    return 1 / (1 + distance * distance);
  }
  // Tells the simulation that friction changes while the axis moves, so that it integrates instead of taking a closed form.
  bool varies_with_motion() const override { return true; }

 private:
  double place_m_;
};

// The place of the spot relative to the target, in metres.
class AxisWithABadSpot : public testing::TestWithParam<double> {};

TEST_P(AxisWithABadSpot, SettlesWithinItsTolerance) {
  scenario::Scenario scenario = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml");
  scenario.worlds[0].friction = {scenario.node.axes[0].friction.bounds, std::make_unique<BadSpot>(GetParam())};

  const sil::Result result = sil::run_scenario(scenario, {});

  EXPECT_TRUE(result.settled());
  EXPECT_LE(std::abs(result.axes[0].final_error_m), scenario.node.settle_tolerance_m);
}

INSTANTIATE_TEST_SUITE_P(BesideBeforeAndBehindTheTarget, AxisWithABadSpot, testing::Values(-0.005, -0.0005, 0.0, 0.0005, 0.2));
