#include "breakaway/law/pid_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace breakaway::law {
namespace {

PidParameters<double> gains() {
  PidParameters<double> p;
  p.proportional_N_per_m = 100;
  p.integral_N_per_ms = 50;
  p.derivative_Ns_per_m = 10;
  p.max_force_N = 20;
  p.encoder_resolution_m = 1e-6;
  p.friction_lower_N = 2.5;
  p.period_s = 1e-3;
  return p;
}

TEST(PidController, IntegratesAConstantError) {
  PidController<double> pid{gains()};
  double force = 0;
  for (int i = 0; i < 1001; ++i) force = pid.update({-0.01}).force_N;
  EXPECT_NEAR(force, 100 * 0.01 + 50 * 0.01 * 1.0, 1e-9);
}

TEST(PidController, DoesNotWindUpWhileTheForceIsLimited) {
  PidController<double> pid{gains()};
  for (int i = 0; i < 5000; ++i) EXPECT_EQ(pid.update({-1.0}).force_N, 20);
  EXPECT_LT(pid.update({0.0}).force_N, 0) << "only the damper acts on the jump back";
}

TEST(PidController, LatchesAFaultOnAMeasurementThatIsNoNumber) {
  PidController<double> pid{gains()};
  EXPECT_EQ(pid.update({std::nan("")}).force_N, 0);
  EXPECT_EQ(pid.update({0.1}).mode, Mode::fault);
  pid.reset();
  EXPECT_EQ(pid.update({0.1}).mode, Mode::approach);
}

}  // namespace
}  // namespace breakaway::law
