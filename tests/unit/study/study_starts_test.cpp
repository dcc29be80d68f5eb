// Where the runs of a study begin: an axis whose encoder counts no further than 2^31 counts reads nonsense beyond.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../refusal.hpp"
#include "breakaway/config/new_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/study/friction_study.hpp"

namespace breakaway::study {
namespace {

using breakaway::testing::refusal;

// Without limits of position, and with a count of 1 nm: 2.147 m either way.
scenario::Scenario finely_counted_axis() {
  scenario::Scenario axis = scenario::parse_scenario(config::new_node({1, 2.5, 4.5, 1e-9, 1000, 50, 0.4}).text, "axis");
  axis.node.axes[0].limits.position_min_m = -config::unlimited;
  axis.node.axes[0].limits.position_max_m = config::unlimited;
  return axis;
}

TEST(StudyStarts, AreCountedByTheEncoder) {
  scenario::Scenario axis = finely_counted_axis();
  for (const double target_m : {-1.0, 0.0, 1.0}) {
    axis.node.axes[0].controller.target_m = target_m;
    for (const Start& start : default_starts(axis)) EXPECT_NO_THROW(require_within_limits(axis, start)) << target_m;
  }
}

TEST(StudyStarts, AreRefusedByNameWhereTheEncoderDoesNotCount) {
  const scenario::Scenario axis = finely_counted_axis();
  EXPECT_NO_THROW(require_within_limits(axis, {-2, 0}));
  const std::string reason = refusal([&] { require_within_limits(axis, {-4, 0}); });
  EXPECT_NE(reason.find("more than 32 bits count of encoder_resolution_m = 1e-09; begin nearer"), std::string::npos)
      << reason;
}

}  // namespace
}  // namespace breakaway::study
