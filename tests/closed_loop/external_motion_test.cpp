// An axis that is held and dragged away: a small push is answered by kicks, and what goes further than kicks lead back
// stops the axis by name. The node that is shipped runs it, under either coast of a rigid axis.
#include <gtest/gtest.h>

#include <cmath>

#include "../campaign/campaign_node.hpp"
#include "../kicked_axis.hpp"

namespace breakaway::campaign {
namespace {

using firmware::AxisFault;

CampaignNode braked_node() {
  CampaignNode node = make_node(true);
  auto& axis = node.axes[0];
  axis.law.coast = law::Coast::brake;
  axis.law.position_tolerance_m = 2.2e-6F;
  axis.kicks = design::design_braked_kicks<float>(testing::axes_of_the_scenes(FaultWorld::lag_s)).kicks;
  node.checksum = checksum_of(node);
  return node;
}

class ExternalMotion : public ::testing::TestWithParam<law::Coast> {
 protected:
  CampaignNode node = GetParam() == law::Coast::brake ? braked_node() : make_node(true);
  FaultWorld world{node, -0.05, 1};
  float led_back_m =
      law::AxisController<float>{node.axes[0].law, node.axes[0].k3_table, node.axes[0].kicks}.held().allowed_m;

  void SetUp() override {
    ASSERT_TRUE(verify(node).ok()) << to_string(verify(node).error);
    world.run(15ms);  // so that the wish is a new one
    world.wish.enable = true;
    for (int i = 0; i < 10000 && !world.on_target(); ++i) world.step();
    ASSERT_TRUE(world.on_target());
    world.run(100ms);
  }
  // How far it is moved until the force ends.
  double drag(double force_N, hal::Duration duration) {
    world.axis.foreign_N = force_N;
    for (const hal::Time end = world.now() + duration; world.now() < end && world.fault() == AxisFault::none;)
      world.step();
    world.axis.foreign_N = 0;
    return std::abs(world.axis.true_position_m());
  }
};

TEST_P(ExternalMotion, StopsAHeldAxisThatIsDraggedFurtherThanItsKicksLeadItBack) {
  for (const double sign : {1.0, -1.0}) {
    const double dragged_m = drag(sign * 12, 2s);
    EXPECT_EQ(world.fault(), AxisFault::external_motion) << to_string(world.fault());
    EXPECT_GT(dragged_m, static_cast<double>(led_back_m));
    EXPECT_LT(dragged_m, static_cast<double>(led_back_m) + 0.002) << "named in the period that shows it";
    world.run(3ms);
    EXPECT_LT(std::abs(world.force_N()), 0.1);
    for (int i = 0; i < 1000; ++i) {
      world.step();
      ASSERT_LT(std::abs(world.force_N()), 0.1) << "it does not drive back against what moved it";
    }
    world.wish = {.reset_fault = true};
    world.run(500ms);
    world.wish = {.enable = true};
    for (int i = 0; i < 10000 && !world.on_target(); ++i) world.step();
    EXPECT_TRUE(world.on_target()) << "it comes back after a reset: " << to_string(world.fault());
    world.run(100ms);
  }
}

TEST_P(ExternalMotion, LetsKicksAnswerAPush) {
  for (const double sign : {1.0, -1.0}) {
    const double pushed_m = drag(sign * 12, 12ms);
    EXPECT_GT(pushed_m, 10 * FaultWorld::tolerance_m);
    EXPECT_LT(pushed_m, static_cast<double>(led_back_m));
    for (int i = 0; i < 5000; ++i) {
      world.step();
      ASSERT_EQ(world.fault(), AxisFault::none) << to_string(world.fault());
    }
    EXPECT_TRUE(world.on_target());
  }
}

// However long it was held before.
TEST_P(ExternalMotion, LetsKicksAnswerAPushAfterALongHold) {
  world.run(70s);
  ASSERT_TRUE(world.on_target());
  drag(12, 12ms);
  for (int i = 0; i < 5000; ++i) {
    world.step();
    ASSERT_EQ(world.fault(), AxisFault::none) << to_string(world.fault());
  }
  EXPECT_TRUE(world.on_target());
}

TEST_P(ExternalMotion, IsNoneWhereTheAxisIsSentToAnotherTarget) {
  for (const std::int32_t target : {200'000, -200'000, 0, 30, -5'000, 5'000}) {
    world.wish.target_counts = target;
    for (int i = 0; i < 6000; ++i) {
      world.step();
      ASSERT_EQ(world.fault(), AxisFault::none) << to_string(world.fault());
    }
    EXPECT_TRUE(world.on_target()) << target;
  }
}

INSTANTIATE_TEST_SUITE_P(Coasts, ExternalMotion, ::testing::Values(law::Coast::pd, law::Coast::brake),
                         [](const auto& param_info) { return param_info.param == law::Coast::pd ? "Pd" : "Brake"; });

}  // namespace
}  // namespace breakaway::campaign
