#include "breakaway/drive_emulator/motor.hpp"

#include <cmath>
#include <limits>

#include "drive_bench.hpp"

namespace breakaway::drive_emulator {
namespace {

TEST(Motor, FollowsAStepAsAFirstOrderLag) {
  Motor motor{100, 2e-3};
  motor.command(10, 1.0);
  EXPECT_EQ(motor.force_at_N(1.0), 0);
  EXPECT_NEAR(motor.force_at_N(1.002), 10 * (1 - std::exp(-1.0)), 1e-12);  // 1.002 - 1.0 is rounded to 1e-16 / 2e-3
  motor.command(-4, 1.002);
  EXPECT_NEAR(motor.force_at_N(1.002), 10 * (1 - std::exp(-1.0)), 1e-12) << "no jump at a new command";
  EXPECT_NEAR(motor.force_at_N(1.1), -4, 1e-12);
}

TEST(Motor, RemembersTheLargestForce) {
  Motor motor{8, 1e-3};
  motor.command(20, 0);
  motor.command(0, 1e-3);
  EXPECT_NEAR(motor.largest_force_N(1.0), 8 * (1 - std::exp(-1.0)), 1e-12);
  motor.command(-20, 1.0);
  EXPECT_NEAR(motor.largest_force_N(2.0), 8, 1e-12);
  Motor ideal{8, 0};
  ideal.command(5, 0);
  ideal.command(0, 1);
  EXPECT_EQ(ideal.largest_force_N(1), 5);
}

TEST(Encoder, RoundsToTheNearestCount) {
  EXPECT_EQ(encoder_counts(0.0, 1e-6), 0);
  EXPECT_EQ(encoder_counts(0.49e-6, 1e-6), 0);
  EXPECT_EQ(encoder_counts(0.51e-6, 1e-6), 1);
  EXPECT_EQ(encoder_counts(-0.49e-6, 1e-6), 0);
  EXPECT_EQ(encoder_counts(-0.51e-6, 1e-6), -1);
  EXPECT_EQ(encoder_counts(-3.0, 0.25), -12);
}

TEST(Encoder, WrapsAroundInBothDirections) {
  constexpr double last_count = 2147483647.0;
  EXPECT_EQ(encoder_counts(last_count, 1.0), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(encoder_counts(last_count + 1, 1.0), std::numeric_limits<std::int32_t>::min());
  EXPECT_EQ(encoder_counts(-last_count - 2, 1.0), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(encoder_counts(3 * 4294967296.0 + 7, 1.0), 7);
}

class TorqueTest : public DriveBench {
 protected:
  void pulse(int per_mille, int periods) {
    for (int i = 0; i < periods; ++i) cycle(0x0F, per_mille);
    cycle(0x0F, 0);
    sync();
  }
};

TEST_F(TorqueTest, LagKeepsTheImpulseOfAPulse) {
  EmulatorConfig config = bench_config();
  config.current_loop_time_constant_s = 0.7e-3;
  start(config);
  enable_cyclic();
  sync();
  mechanism.impulse_Ns = 0;
  pulse(1000, 3);
  run(milliseconds{60});  // exp(-60 / 0.7) is far below the rounding of a double
  drive->advance_mechanism_to(now);
  EXPECT_NEAR(mechanism.impulse_Ns, 10.0 * 3e-3, 1e-14);  // closed form; rounding of sums of 0.03
}

TEST_F(TorqueTest, LagIsContinuousAcrossCommands) {
  EmulatorConfig config = bench_config();
  config.current_loop_time_constant_s = 0.7e-3;
  start(config);
  std::vector<model::AppliedForce> segments;
  drive->on_force_segment([&](const model::AppliedForce& segment) { segments.push_back(segment); });
  enable_cyclic();
  pulse(1000, 1);
  pulse(-500, 2);
  ASSERT_EQ(segments.size(), 4U);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    const double t = segments[i].start_s;
    EXPECT_NEAR(segments[i].at_N(t, 0, 0), segments[i - 1].at_N(t, 0, 0), 1e-14);
  }
}

TEST_F(TorqueTest, EveryPerMilleIsItsShareOfTheRatedTorque) {
  EmulatorConfig config = bench_config();
  config.rated_torque_mNm = 1234;
  config.force_per_torque_N_per_Nm = 7.5;
  config.max_torque_per_mille = 4000;
  start(config);
  enable();
  for (const int per_mille : {1, -1, 333, -2999, 4000}) {
    target_torque(per_mille);
    EXPECT_NEAR(force_N(), per_mille * 1e-3 * 1.234 * 7.5, 1e-13);
    sdo({0x40, 0x77, 0x60, 0, 0, 0, 0, 0});
    EXPECT_EQ(drive->objects().get({0x6077, 0}), per_mille);
    EXPECT_EQ(drive->objects().get({0x6074, 0}), per_mille);
  }
}

TEST_F(TorqueTest, LimitsToMaxTorqueAndShowsIt) {
  start();
  enable();
  target_torque(3000);
  EXPECT_DOUBLE_EQ(force_N(), 30.0);
  EXPECT_EQ(statusword(), 0x1237U);
  target_torque(-3001);
  EXPECT_DOUBLE_EQ(force_N(), -30.0);
  EXPECT_EQ(statusword(), 0x1A37U);
  expect_written({0x2B, 0x72, 0x60, 0, 100, 0, 0, 0});
  EXPECT_DOUBLE_EQ(force_N(), -1.0);
  EXPECT_EQ(drive->objects().get({0x6074, 0}), -100);
}

TEST_F(TorqueTest, NeverExceedsThePeakForceOfTheMotor) {
  EmulatorConfig config = bench_config();
  config.peak_force_N = 12.345;
  start(config);
  enable();
  target_torque(3000);
  EXPECT_EQ(force_N(), 12.345);
  EXPECT_EQ(statusword() & 0x0800U, 0x0800U);
  expect_written({0x2B, 0x72, 0x60, 0, 0xFF, 0xFF, 0, 0});
  target_torque(-32768);
  EXPECT_EQ(force_N(), -12.345);
  EXPECT_EQ(drive->largest_force_N(now), 12.345);
}

TEST_F(TorqueTest, AddsTheTorqueOffset) {
  start();
  enable();
  target_torque(100);
  expect_written({0x2B, 0xB2, 0x60, 0, 0xCE, 0xFF, 0, 0});  // -50
  EXPECT_DOUBLE_EQ(force_N(), 0.5);
}

TEST_F(TorqueTest, ReportsTheLaggingTorqueNotTheDemand) {
  EmulatorConfig config = bench_config();
  config.current_loop_time_constant_s = 1e-3;
  start(config);
  enable_cyclic();
  cycle(0x0F, 1000);
  cycle(0x0F, 1000);
  sync();  // one time constant after the step
  EXPECT_EQ(drive->objects().get({0x6077, 0}), 632);
  EXPECT_EQ(drive->objects().get({0x6074, 0}), 1000);
}

}  // namespace
}  // namespace breakaway::drive_emulator
