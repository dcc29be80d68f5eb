// The instants at which an axis leaves its rest, which rounding of time, of place and of forces must not decide.
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>

#include "../refusal.hpp"
#include "breakaway/model/shape.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/compliant_axis.hpp"
#include "compliant_plants.hpp"

namespace breakaway::motion {
namespace {

using model::AppliedForce;
using model::CompliantPlant;
using model::FrictionLaw;
using testing::refusal;

// Friction gives way where its level has fallen to the push: from there the force grows from nothing, and all that is
// known of it is known to the rounding of time, of place and of the forces. A step may err by as much.
TEST(CompliantAxis, LeavesRestInFewStepsWhereItsFrictionChangesFast) {
  for (const double angular_frequency_rad_s : {2e3, 5e3, 2e4}) {
    CompliantPlant plant{.mass_kg = 1, .force_N = -3.87};
    plant.cogging = {.amplitude = 0.15, .period_m = 1e-3};
    const FrictionLaw law{{2.5, 4.5}, model::shape::sine_in_time(angular_frequency_rad_s, 0)};
    const double start_s = 0.55;
    CompliantAxis axis{plant, law, {start_s, 0.0121, 0}};
    for (int period = 1; period <= 100; ++period) axis.advance_to(start_s + period * 1e-3, {.constant_N = 0.3});
    EXPECT_GT(axis.counters().slips, 10U);
    EXPECT_LT(axis.counters().tries, 400 * (axis.counters().pieces + 100)) << angular_frequency_rad_s;
  }
}

// A current loop changes the force by far more than friction can tell apart while time passes from one number to the
// next, and the more so the later it is.
constexpr double lag_s = 2e-4;
CompliantPlant with_cogging() { return {.mass_kg = 1.3, .cogging = {0.05, 2e-3, 0.4}}; }
AppliedForce settling(double from_N, double to_N, double start_s) {
  return {.constant_N = to_N, .transient_N = from_N - to_N, .time_constant_s = lag_s, .start_s = start_s};
}

TEST(CompliantAxis, LeavesRestLateAsItDoesEarly) {
  for (const double late_s : {200.0, 5e3, 1e6}) {
    for (int i = 0; i < 1000; ++i) {
      const double to_N = 8 + i * 1e-3, start_s = late_s + i * period_s, duration_s = (start_s + period_s) - start_s;
      CompliantAxis late{with_cogging(), stribeck_law(), {start_s, 0, 0}}, early{with_cogging(), stribeck_law(), {}};
      late.advance_to(start_s + duration_s, settling(2, to_N, start_s));
      early.advance_to(duration_s, settling(2, to_N, 0));
      const double velocity_m_s = early.state().velocity_m_s;
      ASSERT_NEAR(late.state().velocity_m_s, velocity_m_s, 1e-12 * (1 + late_s) * velocity_m_s) << start_s;
      ASSERT_EQ(late.counters().slips, 1U) << start_s;
    }
  }
}

TEST(CompliantAxis, HoldsWhereThePushPassesItsFrictionForLessThanTimeCanTell) {
  const double start_s = 5e3, cogging_N = with_cogging().cogging.at(0);
  for (const double beyond : {3e-12, 1e-11, 3e-11, 1e-10, 1e-9}) {
    CompliantAxis axis{with_cogging(), stribeck_law(), {start_s, 0, 0}};
    axis.advance_to(start_s + period_s, settling(4.5 * (1 + beyond) - cogging_N, -1, start_s));
    EXPECT_NEAR(axis.state().position_m, 0, 1e-20) << beyond;
    EXPECT_EQ(axis.state().velocity_m_s, 0) << beyond;
    EXPECT_TRUE(axis.sticking()) << beyond;
  }
}

// Lets go what rests and grips it as soon as time passes, so that no motion answers to it.
class Restless final : public model::Shape {
 public:
  std::unique_ptr<Shape> clone() const override { return std::make_unique<Restless>(*this); }
  double value(double time_s, double /*position_m*/, double /*speed_m_s*/) const override {
    return time_s > slip_s_ ? 1 : 0;
  }
  bool varies_with_motion() const override { return true; }
  void on_stick(double /*time_s*/) override { slip_s_ = std::numeric_limits<double>::infinity(); }
  void on_slip(double time_s) override { slip_s_ = time_s; }

 private:
  double slip_s_ = std::numeric_limits<double>::infinity();
};

std::string refusal_of_restless(const CompliantPlant& plant) {
  CompliantAxis axis{plant, {{1, 9}, std::make_unique<Restless>()}, {}};
  return refusal([&] { axis.advance_to(1, {.constant_N = 4}); });
}

TEST(CompliantAxis, NamesWhatItHasWhereItTurnsRoundWithoutEnd) {
  const std::string bare = refusal_of_restless(with_cogging()), loaded = refusal_of_restless(with_load(1e6, 150));
  EXPECT_NE(bare.find("presliding"), std::string::npos) << bare;
  EXPECT_EQ(bare.find("load"), std::string::npos) << bare;
  EXPECT_NE(loaded.find("give its load more damping"), std::string::npos) << loaded;
}

}  // namespace
}  // namespace breakaway::motion
