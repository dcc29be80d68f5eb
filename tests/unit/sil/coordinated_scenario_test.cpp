// Axes on one machine under their coordinator, behind emulated drives on the bus.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "breakaway/config/machine_design.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"

namespace breakaway::sil {
namespace {

scenario::Scenario scene(const char* name) {
  return scenario::read_scenario(std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/" + name);
}

class CoordinatedScene : public ::testing::TestWithParam<const char*> {};

TEST_P(CoordinatedScene, SettlesAsItsCertificateSays) {
  const scenario::Scenario s = scene(GetParam());
  const auto certificate = config::examine_machine(s.node);
  ASSERT_TRUE(certificate.certified) << certificate.reason;
  const Result result = run_loop_scenario(s, {});
  EXPECT_TRUE(result.settled());
  std::size_t kicks = 0;
  for (const AxisResult& axis : result.axes) {
    for (const FaultRecord& fault : axis.faults)
      ADD_FAILURE() << axis.name << ": " << fault.name << " at " << fault.time_s;
    kicks += axis.kicks.size();
    for (const KickRecord& kick : axis.kicks) EXPECT_GT(kick.periods, 0) << axis.name;
  }
  EXPECT_GT(kicks, 0U);
  EXPECT_LE(kicks, certificate.most_kicks);
}

double first_kick_s(const AxisResult& axis) {
  return axis.kicks.empty() ? std::numeric_limits<double>::infinity() : axis.kicks.front().time_s;
}

// The axis that is kicked later stands until then; the other one stands from then on.
TEST_P(CoordinatedScene, NoKickMovesAnotherAxisOrGoesBeyond) {
  const scenario::Scenario s = scene(GetParam());
  const Result result = run_loop_scenario(s, {.trace = true});
  ASSERT_EQ(result.axes.size(), 2U);
  const AxisResult &one = result.axes[0], &two = result.axes[1];
  const bool one_first = first_kick_s(one) < first_kick_s(two);
  const AxisResult &first = one_first ? one : two, &second = one_first ? two : one;
  for (const AxisResult* axis : {&first, &second}) {
    ASSERT_FALSE(axis->kicks.empty());
    const double side = axis->kicks.front().error_m > 0 ? 1 : -1;
    for (const Sample& sample : axis->trace) {
      const bool stands = axis == &first ? sample.time_s > first_kick_s(second)
                                         : sample.time_s > first_kick_s(first) && sample.time_s < first_kick_s(second);
      const double stands_at_m = axis == &first ? axis->final_error_m : axis->kicks.front().error_m;
      const double error_m = sample.position_m - sample.target_m;
      if (stands) {
        EXPECT_NEAR(error_m, stands_at_m, 2e-9) << axis->name << " at " << sample.time_s << " s";
      }
      if (sample.time_s > first_kick_s(first)) {
        EXPECT_GE(error_m * side, 0) << axis->name << " at " << sample.time_s;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, CoordinatedScene, ::testing::Values("coupled_gantry.toml", "two_link_arm.toml"));

}  // namespace
}  // namespace breakaway::sil
