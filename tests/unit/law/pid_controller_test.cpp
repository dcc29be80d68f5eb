#include "breakaway/law/pid_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

TEST(PidController, HoldsItsForceWhileASampleIsLostAndSeesNoJumpAfterIt) {
  PidController<double> pid{gains()};
  double x = -0.05;
  for (int i = 0; i < 200; ++i) {
    if (i == 150) {
      const double before_N = pid.update({x, 0, false}).force_N;
      EXPECT_EQ(pid.update({0, 0, false}).force_N, before_N);
      x += 1e-4, ++i;
    } else {
      EXPECT_EQ(pid.update({x}).mode, Mode::approach);
      if (i > 100) {
        EXPECT_NEAR(pid.velocity_m_s(), 0.1, 1e-3) << i;
      }
    }
    x += 1e-4;
  }
  EXPECT_NEAR(pid.velocity_m_s(), 0.1, 1e-3);
  EXPECT_EQ(pid.update({std::nan("")}).force_N, 0);
  EXPECT_EQ(pid.update({0, 0, false}).force_N, 0) << "a fault has no force to hold";
  pid.reset();
  EXPECT_EQ(pid.velocity_m_s(), 0);
  EXPECT_EQ(pid.update({0, 0, false}).force_N, 0) << "nothing is left of the force";
  EXPECT_EQ(pid.update({-0.01}).force_N, PidController<double>{gains()}.update({-0.01}).force_N);
  EXPECT_EQ(pid.velocity_m_s(), 0) << "the first reading tells no speed";
}

void expect_nothing_kicked(const ControlOutput<double>& out, Mode mode) {
  EXPECT_EQ(out.mode, mode);
  EXPECT_EQ(out.impulse_Ns, 0);
  EXPECT_FALSE(out.kicked);
}

TEST(PidController, GivesTheForceOfItsLastSampleWithoutOneAndNoneFromAFaultOn) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {infinity, -infinity, std::nan("")}) {
    PidController<double> pid{gains()};
    EXPECT_EQ(pid.mode(), Mode::approach);
    const auto out = pid.update({-0.05});
    expect_nothing_kicked(out, Mode::approach);
    EXPECT_DOUBLE_EQ(out.force_N, 5);
    const auto held = pid.update({0, 0, false});
    expect_nothing_kicked(held, Mode::approach);
    EXPECT_EQ(held.force_N, out.force_N);
    EXPECT_EQ(pid.fault(), ControlFault::none);
    for (const Measurement<double>& z : {Measurement<double>{wrong}, {-0.05}, {0, 0, false}}) {
      const auto nothing = pid.update(z);
      expect_nothing_kicked(nothing, Mode::fault);
      EXPECT_EQ(nothing.force_N, 0);
    }
    EXPECT_EQ(pid.mode(), Mode::fault);
    EXPECT_EQ(pid.fault(), ControlFault::not_a_number);
  }
}

TEST(PidController, DoesNotWindUpWhileItsSpeedIsLimited) {
  auto p = gains();
  p.max_approach_speed_m_s = 0.5;
  for (const double side : {1.0, -1.0}) {
    PidController<double> pid{p};
    for (int i = 0; i < 1000; ++i) ASSERT_DOUBLE_EQ(pid.update({-side * 0.1}).force_N, side * 5) << i;
  }
}

TEST(PidController, TakesAMovedTargetForNoMotion) {
  PidController<double> pid{gains()};
  for (int i = 0; i < 10; ++i) pid.update({-0.01});
  pid.shift_target(0.02);
  pid.update({-0.03});
  EXPECT_EQ(pid.velocity_m_s(), 0);
}

TEST(PidController, LimitsTheSpeedOfItsApproachEitherWayAndKeepsToALowerForce) {
  auto p = gains();
  p.max_approach_speed_m_s = 0.5;
  for (const double side : {1.0, -1.0}) {
    PidController<double> pid{p};
    EXPECT_DOUBLE_EQ(pid.update({-side * 0.1}).force_N, side * 5) << "10 Ns/m times 0.5 m/s";
    pid.limit_force(3);
    EXPECT_DOUBLE_EQ(pid.update({-side * 0.1}).force_N, side * 3);
    pid.limit_force(100);
    EXPECT_EQ(pid.max_force_N(), 3) << "a limit is never raised";
  }
  const PidController<double> pid{p};
  EXPECT_EQ(pid.period_s(), 1e-3);
  EXPECT_EQ(pid.encoder_resolution_m(), 1e-6);
  EXPECT_EQ(pid.kicks(), 0U);
}

}  // namespace
}  // namespace breakaway::law
