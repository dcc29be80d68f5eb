#include "breakaway/design/coordinator.hpp"

#include <gtest/gtest.h>

namespace breakaway::design {
namespace {

// Two axes that share mass; the second is held by friction alone where no drive acts on it.
law::CoordinatorParameters<double, 2> parameters(double second_force_N) {
  stability::CoupledAxes axes;
  axes.mass = Eigen::Matrix2d{{2, 0.5}, {0.5, 1}};
  axes.mass_error = Eigen::Matrix2d::Zero();
  axes.max_force_N = Eigen::Vector2d{50, second_force_N};
  axes.period_s = 1e-3;
  const Eigen::Vector2d ones = Eigen::Vector2d::Ones();
  const stability::SampledApproach approach{.position_gain_N_per_m = 100 * ones,
                                            .velocity_gain_Ns_per_m = 20 * ones,
                                            .start_m = ones,
                                            .resolution_m = 1e-6 * ones};
  stability::MachineCertificate certificate;
  certificate.axes.resize(2);
  certificate.release_s = 0.0042;
  return coordinator_parameters<double, 2>(axes, approach, 1e-5 * ones, certificate);
}

TEST(CoordinatorParameters, HoldOffTheAxesThatADriveActsOnAndNoOther) {
  const auto both = parameters(20), one = parameters(0);
  EXPECT_DOUBLE_EQ(both.axes[0].hold_off[1], 0.25) << "of the kicked mass of 2 kg the other axis feels 0.5 kg";
  EXPECT_DOUBLE_EQ(both.axes[1].hold_off[0], 0.5);
  EXPECT_EQ(one.axes[0].hold_off[1], 0) << "no drive is there to hold it off";
  EXPECT_DOUBLE_EQ(one.axes[1].hold_off[0], 0.5);
  EXPECT_EQ(one.axes[0].hold_off[0], 0);
  EXPECT_EQ(one.release_periods, 5) << "whole periods, rounded up";
}

}  // namespace
}  // namespace breakaway::design
