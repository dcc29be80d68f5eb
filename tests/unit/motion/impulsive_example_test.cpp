// The worked example of van de Wouw & Leine, section V, against the independent 30-digit solution.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/slide.hpp"
#include "reference_example.hpp"

namespace breakaway::tests {
namespace {

using model::AppliedForce;
using motion::Slide;
using motion::StopReason;

constexpr double lower_N = 2.5, upper_N = 4.5;

Slide example_slide() {
  std::vector<model::ShapePtr> parts;
  parts.push_back(model::shape::stribeck(2));
  parts.push_back(model::shape::sine_in_time(4));
  const auto bounds = model::bounds_from_coefficients(1, 10, 0.25, 0.45);
  return Slide(1, {bounds, model::shape::mean({0.5, 0.5}, std::move(parts))}, {0, -4, -4});
}

// k3(y) / m by running (11) backwards in time from rest at the target.
double velocity_after_kick(double position_m) {
  motion::ConstantFrictionMotion backwards;
  backwards.acceleration_m_s2 = lower_N;
  backwards.decay_per_s = -1.5;
  backwards.stiffness_per_s2 = 1;
  const double distance_m = std::abs(position_m);
  const double time_s = backwards.time_to_distance_s(distance_m, std::sqrt(2 * distance_m / lower_N));
  return std::copysign(backwards.speed_at(time_s), -position_m);
}

struct ExampleRun {
  double t1_s = 0, t_inf_s = 0;
  std::vector<ReferenceKick> kicks;
};

ExampleRun run_example(Slide& slide) {
  model::AppliedForce pd{.stiffness_N_per_m = 1, .damping_Ns_per_m = 0.5};
  constexpr double horizon_s = 100;
  do {
    EXPECT_EQ(slide.advance_to(horizon_s, pd, true), StopReason::came_to_rest);
  } while (std::abs(slide.state().position_m) > upper_N);
  ExampleRun run;
  run.t1_s = slide.state().time_s;
  pd.damping_Ns_per_m = 3;
  while (std::abs(slide.state().position_m) > 1e-33) {
    const auto at_rest = slide.state();
    const double velocity_m_s = velocity_after_kick(at_rest.position_m);
    slide.apply_impulse(slide.mass_kg() * velocity_m_s);
    run.kicks.push_back({at_rest.time_s, at_rest.position_m, velocity_m_s});
    EXPECT_EQ(slide.advance_to(horizon_s, pd, true), StopReason::came_to_rest);
  }
  run.t_inf_s = slide.state().time_s;
  return run;
}

void expect_relative(double value, double reference, double tolerance) {
  EXPECT_LE(std::abs(value - reference), tolerance * std::abs(reference)) << value << " against " << reference;
}

TEST(ImpulsiveExample, AgreesWithIndependentSolution) {
  const auto reference = read_reference_example();
  Slide slide = example_slide();
  const auto start = std::chrono::steady_clock::now();
  const ExampleRun run = run_example(slide);
  const std::chrono::duration<double, std::micro> wall = std::chrono::steady_clock::now() - start;
  RecordProperty("wall_us", std::to_string(wall.count()));
  RecordProperty("steps", std::to_string(slide.counters().steps));

  // Each kick adds a few roundings to the relative error of the position, and the motion does not amplify them.
  expect_relative(run.t1_s, reference.values.at("t1_s"), 1e-13);
  expect_relative(run.t_inf_s, reference.values.at("t_inf_s"), 1e-13);
  ASSERT_GE(run.kicks.size(), reference.kicks.size());
  for (std::size_t i = 0; i < reference.kicks.size(); ++i) {
    SCOPED_TRACE("kick " + std::to_string(i));
    expect_relative(run.kicks[i].time_s, reference.kicks[i].time_s, 1e-13);
    expect_relative(run.kicks[i].position_m, reference.kicks[i].position_m, 1e-12);
    expect_relative(run.kicks[i].velocity_after_m_s, reference.kicks[i].velocity_after_m_s, 1e-12);
  }
}

TEST(ImpulsiveExample, IsTheSameFromACopy) {
  const Slide original = example_slide();
  Slide first = original, second = original;
  EXPECT_EQ(run_example(first).t_inf_s, run_example(second).t_inf_s);
}

}  // namespace
}  // namespace breakaway::tests
