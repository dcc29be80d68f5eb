// Plants beyond the rigid axis against independent computations: fine Runge-Kutta steps in long double, closed forms,
// balances of energy and momentum, and the limits in which they become the rigid axis.
#include "breakaway/motion/compliant_axis.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/model/friction_drift.hpp"
#include "breakaway/model/shapes.hpp"
#include "compliant_plants.hpp"

namespace breakaway::motion {
namespace {

using model::AppliedForce;
using model::CompliantPlant;
using model::FrictionLaw;
using testing::refusal;

// What a drive with a lag of 0.1 ms makes of one command a period.
class Drive {
 public:
  explicit Drive(double time_constant_s) : time_constant_s_{time_constant_s} {}

  AppliedForce command(int period, double force_N) {
    const AppliedForce force{.constant_N = force_N,
                             .transient_N = time_constant_s_ > 0 ? present_N_ - force_N : 0,
                             .time_constant_s = time_constant_s_,
                             .start_s = period * period_s};
    present_N_ = force.at_N((period + 1) * period_s, 0, 0);
    return force;
  }

 private:
  double time_constant_s_;
  double present_N_ = 0;
};

double command_N(int period) {
  constexpr std::array commands_N{3.0, 8.0, 0.0, -6.0, 4.4, -10.0, 0.0, 2.0};
  return commands_N[static_cast<std::size_t>(period / 20) % commands_N.size()];
}

CompliantPlant with_bristles(double stiffness_N_per_m, double damping_Ns_per_m) {
  return {.mass_kg = 1.3, .force_N = -0.4, .presliding = model::Presliding{stiffness_N_per_m, damping_Ns_per_m}};
}

// stribeck_law(), as it is written down a second time below.
constexpr long double lower_N = 2.5L, upper_N = 4.5L, stribeck_m_s = 0.02L;

// The classical Runge-Kutta rule with fixed steps, in long double.
struct FineLugre {
  long double mass_kg, constant_N, stiffness, damping;
  std::array<long double, 3> y{};  // position, velocity, bend

  std::array<long double, 3> slope(const std::array<long double, 3>& at, long double push_N) const {
    const long double v = at[1], level_N = lower_N + (upper_N - lower_N) * stribeck_m_s / (stribeck_m_s + fabsl(v));
    const long double rate = v - fabsl(v) * stiffness * at[2] / level_N;
    const long double u = stiffness * at[2] / level_N, following = 1 - (v < 0 ? -u : u);
    const long double friction_N = stiffness * at[2] + damping * v * (following > 0 ? following : 0);
    return {v, (push_N + constant_N - friction_N) / mass_kg, rate};
  }

  void pass_period(const AppliedForce& force, int steps) {
    const long double h = static_cast<long double>(period_s) / steps;
    const auto push_N = [&](long double t) {
      if (force.transient_N == 0) return static_cast<long double>(force.constant_N);
      return force.constant_N + force.transient_N * expl(-t / force.time_constant_s);
    };
    const auto moved = [](std::array<long double, 3> from, const std::array<long double, 3>& by, long double share) {
      for (std::size_t i = 0; i < 3; ++i) from[i] += share * by[i];
      return from;
    };
    for (int step = 0; step < steps; ++step) {
      const long double t = step * h;
      const auto k1 = slope(y, push_N(t)), k2 = slope(moved(y, k1, h / 2), push_N(t + h / 2));
      const auto k3 = slope(moved(y, k2, h / 2), push_N(t + h / 2)), k4 = slope(moved(y, k3, h), push_N(t + h));
      for (std::size_t i = 0; i < 3; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
  }
};

struct Bristles {
  const char* label;
  double stiffness_N_per_m, damping_Ns_per_m, time_constant_s;
  int periods, fine_steps;
};

class BristleMotion : public ::testing::TestWithParam<Bristles> {};

TEST_P(BristleMotion, AgreesWithFineStepsInLongDouble) {
  const Bristles& p = GetParam();
  CompliantAxis axis{with_bristles(p.stiffness_N_per_m, p.damping_Ns_per_m), stribeck_law(), {}};
  FineLugre fine{1.3L, -0.4L, p.stiffness_N_per_m, p.damping_Ns_per_m};
  Drive drive{p.time_constant_s};
  double farthest_m = 0, fastest_m_s = 4.5 / std::sqrt(p.stiffness_N_per_m * 1.3);  // the bristles' own speed
  const double greatest_bend_m = 4.5 / p.stiffness_N_per_m;
  for (int period = 0; period < p.periods; ++period) {
    const AppliedForce force = drive.command(period, command_N(period));
    axis.advance_to((period + 1) * period_s, force);
    fine.pass_period(force, p.fine_steps);
    const CompliantState state = axis.state();
    farthest_m = std::max(farthest_m, std::abs(state.position_m));
    fastest_m_s = std::max(fastest_m_s, std::abs(state.velocity_m_s));
    ASSERT_NEAR(state.position_m, static_cast<double>(fine.y[0]), 1e-8 * farthest_m) << period;
    ASSERT_NEAR(state.velocity_m_s, static_cast<double>(fine.y[1]), 1e-8 * fastest_m_s) << period;
    ASSERT_NEAR(state.bend_m, static_cast<double>(fine.y[2]), 1e-8 * greatest_bend_m) << period;
  }
  EXPECT_GT(farthest_m, 1e-4) << "then nothing slid";
  // A bristle of 1e8 N/m relaxes within 1e-7 s and less: micro-steps would be ten thousand a period.
  EXPECT_LT(axis.counters().steps, 80U * static_cast<unsigned>(p.periods));
  EXPECT_LT(axis.counters().tries, 2 * axis.counters().steps) << "in sliding no step is halved for its stages";
}

// Fine steps are a hundredth of the bristles' period, or a third of their relaxation in the fastest slide.
INSTANTIATE_TEST_SUITE_P(Table, BristleMotion,
                         ::testing::Values(Bristles{"Soft", 1e5, 3e2, 0, 160, 2000},
                                           Bristles{"Usual", 1e6, 2e3, 1e-4, 160, 4000},
                                           Bristles{"Dahl", 1e6, 0, 0, 100, 4000},
                                           Bristles{"Stiff", 1e7, 5e3, 1e-4, 100, 12000},
                                           Bristles{"VeryStiff", 1e8, 2e4, 0, 60, 60000}),
                         [](const auto& kind) { return std::string{kind.param.label}; });

// From step to step an axis may gain what the drive supplies, and the integration's error, which is a share of the
// energy that flows.
class EnergyBalance {
 public:
  EnergyBalance(const CompliantAxis& axis, double error) : axis_{axis}, error_{error} {}

  // After a step under this force.
  void check(double force_N) {
    const double supplied_J = force_N * (axis_.state().position_m - before_m_);
    passed_J_ += std::abs(supplied_J);
    EXPECT_LE(axis_.energy_J() - before_J_, supplied_J + error_ * (before_J_ + std::abs(supplied_J)) + 1e-20)
        << axis_.state().time_s;
    before_J_ = axis_.energy_J();
    before_m_ = axis_.state().position_m;
  }
  double passed_J() const { return passed_J_; }

 private:
  const CompliantAxis& axis_;
  double error_;
  double before_J_ = 0, before_m_ = 0, passed_J_ = 0;
};

TEST(Bristles, NeverMakeEnergy) {
  for (const double damping_Ns_per_m : {0.0, 3e3, 3e5}) {
    // Friction that falls to its lower bound all at once, which plain LuGre answers by pulling the mass along.
    const FrictionLaw jumping{
        {1, 6}, model::shape::random_dwell({.seed = 5, .shortest_dwell_s = 1e-3, .longest_dwell_s = 5e-3})};
    CompliantAxis axis{with_bristles(1e7, damping_Ns_per_m), jumping, {}};
    EnergyBalance balance{axis, 1e-9};
    for (int step = 0; step < 2000; ++step) {
      const AppliedForce force{.constant_N = command_N(step / 5) * 1.3};
      axis.advance_to((step + 1) * 2e-4, force);
      balance.check(force.constant_N - 0.4);
    }
    EXPECT_GT(balance.passed_J(), 1e-3) << damping_Ns_per_m;
  }
}

// The farther of the two, as a share of the way.
double distance_from_rigid(double stiffness_N_per_m) {
  const double critical_Ns_per_m = 2 * std::sqrt(stiffness_N_per_m * 1.3);
  const FrictionLaw law{{2.5, 4.5}, model::shape::stribeck(0.5)};
  CompliantAxis axis{with_bristles(stiffness_N_per_m, critical_Ns_per_m), law, {}};
  Slide rigid{1.3, law, {}};
  double distance_m = 0, way_m = 0;
  for (int period = 0; period < 200; ++period) {
    AppliedForce force{.constant_N = command_N(period)};
    axis.advance_to((period + 1) * period_s, force);
    force.constant_N -= 0.4;
    rigid.advance_to((period + 1) * period_s, force);
    distance_m = std::max(distance_m, std::abs(axis.state().position_m - rigid.state().position_m));
    way_m = std::max(way_m, std::abs(rigid.state().position_m));
  }
  return distance_m / way_m;
}

TEST(Bristles, BecomeTheRigidLawAsTheirStiffnessGrows) {
  double before = distance_from_rigid(1e6);
  for (const double stiffness_N_per_m : {4e6, 1.6e7, 6.4e7}) {
    const double after = distance_from_rigid(stiffness_N_per_m);
    // The bend is level / stiffness, so four times the stiffness leaves a quarter, or with critical damping, which acts
    // on the square root, at most a half.
    EXPECT_LT(after, 0.55 * before) << after << " at " << stiffness_N_per_m;
    before = after;
  }
}

TEST(Bristles, HoldAndLetGo) {
  CompliantAxis axis{with_bristles(1e7, 7e3), {{2.5, 4.5}, model::shape::constant(0)}, {}};
  axis.advance_to(0.1, {.constant_N = 2.0});
  EXPECT_TRUE(axis.sticking());
  EXPECT_NEAR(axis.state().bend_m, (2.0 - 0.4) / 1e7, 1e-12);
  EXPECT_NEAR(axis.friction_force_N(), -1.6, 1e-6);
  EXPECT_EQ(axis.counters().slips, 0U);
  axis.advance_to(0.2, {.constant_N = 4.0});
  EXPECT_FALSE(axis.sticking());
  EXPECT_EQ(axis.counters().slips, 1U);
  EXPECT_NEAR(axis.friction_force_N(), -2.5, 1e-9);
}

// --- a load behind a spring

FrictionLaw constant_law(double level_N) { return {{level_N, level_N}, model::shape::constant(1)}; }

// The load rubs, too.
CompliantPlant on_friction(CompliantPlant plant, double level_N = 1.2) {
  plant.load->friction.emplace(constant_law(level_N));
  return plant;
}

TEST(FlexibleLoad, SwingsAsTwoMassesDo) {
  // The motor slides one way all along: constant forces on both masses, so the centre of mass falls freely and the
  // deflection swings about its equilibrium.
  CompliantAxis axis{with_load(1e5, 0), constant_law(1.5), {0, 0, 0.5}};
  const double push_N = 5 - 1.5, mass_kg = 1.0, reduced_kg = 0.4 * 0.6, omega = std::sqrt(1e5 / reduced_kg);
  for (int period = 1; period <= 100; ++period) {
    const double t = period * period_s;
    axis.advance_to(t, {.constant_N = 5});
    const CompliantState state = axis.state();
    const double centre_m = 0.5 * t + push_N / mass_kg * t * t / 2;
    const double deflection_m = push_N * reduced_kg / 0.4 / 1e5 * (1 - std::cos(omega * t));
    EXPECT_NEAR(state.position_m - state.load_position_m, deflection_m, 1e-9 * 2 * push_N / 1e5);
    EXPECT_NEAR(state.position_m, centre_m + 0.6 * deflection_m, 1e-11);
    EXPECT_NEAR(0.4 * state.velocity_m_s + 0.6 * state.load_velocity_m_s, 0.5 + push_N * t, 1e-11);
  }
}

TEST(FlexibleLoad, KeepsItsBalanceOfEnergy) {
  CompliantAxis axis{on_friction(with_load(1e6, 150)), constant_law(1.5), {}};
  EnergyBalance balance{axis, 1e-11};
  for (int step = 0; step < 4000; ++step) {
    const AppliedForce force{.constant_N = command_N(step / 10)};
    axis.advance_to((step + 1) * 1e-4, force);
    balance.check(force.constant_N);
  }
  axis.advance_to(0.6, {});
  EXPECT_TRUE(axis.sticking());
}

// A whole run of commands; the rigid axis of the summed mass and friction beside it.
double load_distance_from_rigid(double stiffness_N_per_m, double gap_m) {
  const double damping_Ns_per_m = 0.2 * std::sqrt(stiffness_N_per_m);
  CompliantAxis axis{on_friction(with_load(stiffness_N_per_m, damping_Ns_per_m, gap_m)), constant_law(1.5), {}};
  Slide rigid{1.0, constant_law(2.7), {}};
  double distance_m = 0;
  for (int period = 0; period < 200; ++period) {
    const AppliedForce force{.constant_N = command_N(period)};
    axis.advance_to((period + 1) * period_s, force);
    rigid.advance_to((period + 1) * period_s, force);
    const CompliantState state = axis.state();
    EXPECT_LE(std::abs(state.position_m - state.load_position_m), gap_m / 2 + 40 / std::sqrt(stiffness_N_per_m));
    distance_m = std::max(distance_m, std::abs(state.position_m - rigid.state().position_m));
  }
  return distance_m;
}

TEST(FlexibleLoad, BecomesTheRigidAxisOfTheSummedMass) {
  double before_m = load_distance_from_rigid(1.6e5, 0);
  for (const double stiffness_N_per_m : {2.56e6, 4.096e7}) {
    const double after_m = load_distance_from_rigid(stiffness_N_per_m, 0);
    EXPECT_LT(after_m, 0.3 * before_m) << after_m << " at " << stiffness_N_per_m
                                       << " N/m: a sixteenth of the bend, a quarter of the time";
    before_m = after_m;
  }
}

TEST(Backlash, LetsTheMotorGoAloneUntilTheTeethMeet) {
  CompliantAxis axis{on_friction(with_load(1e6, 0, 1e-3)), constant_law(1.5), {}};
  const double acceleration = (3 - 1.5) / 0.4, meet_s = std::sqrt(2 * 0.5e-3 / acceleration);
  axis.advance_to(meet_s * (1 - 1e-12), {.constant_N = 3});
  EXPECT_NEAR(axis.state().position_m, 0.5e-3, 1e-14);
  EXPECT_EQ(axis.state().load_position_m, 0);
  axis.advance_to(meet_s + 1e-3, {.constant_N = 3});
  EXPECT_GT(axis.state().load_position_m, 0);
}

TEST(Backlash, NeverMakesEnergyAndNeverOpensFartherThanItsGapAndSpring) {
  for (const double damping_Ns_per_m : {0.0, 300.0, 3e4}) {
    CompliantAxis axis{on_friction(with_load(2e6, damping_Ns_per_m, 20e-6)), constant_law(1.5), {}};
    EnergyBalance balance{axis, 1e-11};
    for (int step = 0; step < 4000; ++step) {
      const AppliedForce force{.constant_N = command_N(step / 10)};
      axis.advance_to((step + 1) * 1e-4, force);
      balance.check(force.constant_N);
      // The spring holds no more than all of the energy.
      const CompliantState state = axis.state();
      const double squeeze_m = std::abs(state.position_m - state.load_position_m) - 10e-6;
      if (squeeze_m > 0) {
        EXPECT_LE(squeeze_m, std::sqrt(2 * axis.energy_J() / 2e6) * (1 + 1e-9));
      }
    }
  }
}

TEST(Backlash, OfNothingIsASpring) {
  auto spring = with_load(1e5, 20), play = with_load(1e5, 20, 1e-15);
  CompliantAxis without{spring, constant_law(1.5), {}}, with{play, constant_law(1.5), {}};
  // Pushed one way all along, the teeth stay where they met.
  without.advance_to(0.05, {.constant_N = 5});
  with.advance_to(0.05, {.constant_N = 5});
  EXPECT_NEAR(with.state().position_m, without.state().position_m, 1e-12);
}

// --- forces along the travel

TEST(Cogging, TradesEnergyWithTheMotion) {
  CompliantPlant plant{.mass_kg = 0.8, .cogging = {0.9, 2e-3, 0.4}};
  CompliantAxis axis{plant, constant_law(1.5), {0, 0.01, 0.7}};
  const auto potential_J = [&](double position_m) {
    const double wave = 2 * std::numbers::pi / 2e-3;
    return 0.9 / wave * std::cos(wave * position_m + 0.4);
  };
  const double start_J = axis.energy_J() + potential_J(0.01);
  for (int period = 1; period < 100; ++period) {
    axis.advance_to(period * period_s, {.constant_N = 1});
    const double way_m = axis.state().position_m - 0.01;
    EXPECT_NEAR(axis.energy_J() + potential_J(axis.state().position_m), start_J + (1 - 1.5) * way_m, 1e-11);
  }
}

TEST(Ripple, MultipliesTheForceOfTheDrive) {
  // From rest at a place of full ripple, over a way that the ripple does not notice.
  CompliantPlant plant{.mass_kg = 0.8, .ripple = {0.1, 1e3, std::numbers::pi / 2}};
  CompliantAxis axis{plant, constant_law(1.5), {}};
  Slide rigid{0.8, constant_law(1.5), {}};
  axis.advance_to(0.02, {.constant_N = 4});
  rigid.advance_to(0.02, {.constant_N = 4.4});
  EXPECT_NEAR(axis.state().position_m, rigid.state().position_m, 1e-12);
}

TEST(CompliantAxis, OnDryFrictionAloneIsASlide) {
  // Cogging too small to matter makes it the compliant axis: stops, reversals and break-aways are the slide's.
  CompliantPlant plant{.mass_kg = 1.3, .force_N = 0.3, .cogging = {1e-30, 1, 0}};
  std::vector<model::ShapePtr> parts;
  parts.push_back(model::shape::stribeck(0.1));
  parts.push_back(model::shape::sine_in_time(50));
  parts.push_back(model::shape::position_table({0.001, 0.002}, {0, 1, 0.5}));
  const FrictionLaw law{{2.5, 4.5}, model::shape::mean({1, 1, 1}, std::move(parts))};
  CompliantAxis axis{plant, law, {0, 0, 0.1}};
  Slide slide{1.3, law, {0, 0, 0.1}};
  Drive drive{1e-4};
  for (int period = 0; period < 320; ++period) {
    AppliedForce force = drive.command(period, command_N(period));
    axis.advance_to((period + 1) * period_s, force);
    force.constant_N += 0.3;
    slide.advance_to((period + 1) * period_s, force);
    ASSERT_NEAR(axis.state().position_m, slide.state().position_m, 1e-10 * 0.01) << period;
    ASSERT_NEAR(axis.state().velocity_m_s, slide.state().velocity_m_s, 1e-10) << period;
    ASSERT_EQ(axis.sticking(), slide.sticking()) << period;
  }
}

TEST(CompliantAxis, ScalesByPowersOfTwoAndMirrors) {
  const auto run = [](int exponent, double side) {
    const double scale = std::ldexp(1.0, exponent);
    auto plant = on_friction(with_load(1e6, 150, scale * 20e-6), scale * 1.2);
    plant.presliding = model::Presliding{1e7, 3e3};
    CompliantAxis axis{plant, constant_law(scale * 2.0), {}};
    for (int period = 0; period < 60; ++period)
      axis.advance_to((period + 1) * period_s, {.constant_N = side * scale * 1.5 * command_N(period)});
    return std::pair{axis.state(), axis.counters()};
  };
  const auto [state, counters] = run(0, 1);
  for (const int exponent : {-40, -7, 1, 40}) {
    const auto [scaled, scaled_counters] = run(exponent, 1);
    EXPECT_EQ(scaled_counters.pieces, counters.pieces) << exponent;
    EXPECT_EQ(scaled_counters.steps, counters.steps) << exponent;
    EXPECT_EQ(scaled.position_m, std::ldexp(state.position_m, exponent)) << exponent;
    EXPECT_EQ(scaled.load_velocity_m_s, std::ldexp(state.load_velocity_m_s, exponent)) << exponent;
  }
  const auto [mirrored, mirrored_counters] = run(0, -1);
  EXPECT_EQ(mirrored.position_m, -state.position_m);
  EXPECT_EQ(mirrored_counters.pieces, counters.pieces);
}

// Bristles follow a level that changes from place to place at once: steps are as long as the level's change asks for,
// hundreds of times as long as the bristles take to relax.
TEST(Bristles, SlideOverALevelThatChangesFromPlaceToPlaceInLongSteps) {
  for (const double damping_Ns_per_m : {0.0, 3e3}) {
    const CompliantPlant plant = with_bristles(1e7, damping_Ns_per_m);
    CompliantAxis axis{plant, {{2.5, 4.5}, model::shape::sine_in_position(4.4e-3, 0)}, {0, -0.4, 0.9}};
    axis.advance_to(0.1, {.constant_N = 4});
    EXPECT_GT(axis.state().position_m, -0.32);
    EXPECT_LT(axis.counters().tries, 20'000U) << damping_Ns_per_m;
  }
}

TEST(CompliantAxis, RefusesWhatItCannotFollow) {
  CompliantAxis axis{with_load(1e6, 0), constant_law(1), {}};
  EXPECT_NE(refusal([&] { axis.advance_to(-1, {}); }).find("time_s"), std::string::npos);
  EXPECT_NE(refusal([&] { axis.advance_to(1, {.stiffness_N_per_m = 1}); }).find("feedback"), std::string::npos);
  EXPECT_NE(refusal([&] { axis.advance_to(1, {.constant_N = std::nan("")}); }).find("finite"), std::string::npos);
  EXPECT_NE(refusal([] {
              CompliantAxis{CompliantPlant{.mass_kg = 0}, constant_law(1), {}};
            }).find("mass_kg"),
            std::string::npos);
}

}  // namespace
}  // namespace breakaway::motion
