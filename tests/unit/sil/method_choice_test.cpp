#include "breakaway/sil/method_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "../refusal.hpp"
#include "breakaway/report/accuracy_json.hpp"
#include "breakaway/sil/run_machine.hpp"
#include "two_masses.hpp"

namespace {

using namespace breakaway;
using scenario::Integrator;

// Where the motion ends, to 25 digits: tests/reference/linear_machine.csv, rounded here.
const Eigen::Vector2d true_end_m{0.01780996919189576529, 0.02337361620547781400};

scenario::MachineScenario two_masses_to(double accuracy_m) {
  scenario::MachineScenario s = two_masses();
  s.accuracy_m = accuracy_m;
  return s;
}

double true_error_m(const sil::MachineResult& result) {
  return (result.outcome.end.q - true_end_m).cwiseAbs().maxCoeff();
}

TEST(MethodChoice, HoldsWhatIsAskedAndTellsTheErrorThatItMakes) {
  for (const double accuracy_m : {0.5, 0.1, 1e-2, 1e-4, 1e-8, 1e-12}) {
    const sil::MachineResult result = sil::run_machine(two_masses_to(accuracy_m));
    ASSERT_TRUE(result.accuracy);
    EXPECT_LE(result.accuracy->error_estimate_m, accuracy_m);
    EXPECT_LE(true_error_m(result), 2 * result.accuracy->error_estimate_m) << accuracy_m;
  }
}

TEST(MethodChoice, KeepsTheIntegratorThatTheFileNames) {
  for (const Integrator named : {Integrator::time_stepping, Integrator::adaptive, Integrator::event_driven}) {
    scenario::MachineScenario s = two_masses_to(1e-3);
    s.integrator_is_named = true;
    s.integrator = named;
    const sil::MachineResult result = sil::run_machine(s);
    EXPECT_EQ(result.accuracy->method.integrator, named);
    EXPECT_LE(true_error_m(result), 1e-3);
    EXPECT_GE(true_error_m(result), result.accuracy->error_estimate_m / 4 - 1e-12);
  }
}

TEST(MethodChoice, TakesTimeStepsWhereTheyAreCheaperAndEventsWhereTheyAreNot) {
  EXPECT_EQ(sil::choose_method(two_masses_to(0.1)).method.integrator, Integrator::time_stepping);
  EXPECT_EQ(sil::choose_method(two_masses_to(1e-6)).method.integrator, Integrator::event_driven);
}

TEST(MethodChoice, IsNotDearerThanAnyMethodThatHolds) {
  for (const double accuracy_m : {0.1, 1e-2, 1e-6}) {
    const auto s = two_masses_to(accuracy_m);
    const sil::Accuracy choice = sil::choose_method(s);
    for (const sil::MethodTrial& trial : sil::try_methods(s)) {
      EXPECT_TRUE(!trial.holds || choice.cost_s <= 2 * trial.cost_s) << to_string(trial.method);
    }
  }
}

TEST(MethodChoice, TakesTheAdaptiveMethodUnderAFrictionLaw) {
  auto s = scenario::read_machine_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/two_mass_stribeck.toml");
  s.accuracy_m = 1e-5;
  const sil::Accuracy choice = sil::choose_method(s);
  EXPECT_EQ(choice.method.integrator, Integrator::adaptive);
  ASSERT_EQ(choice.refused.size(), 2U);
  EXPECT_EQ(choice.refused.front().reason, "knows constant friction only");
}

TEST(MethodChoice, IsTheSameForTheSameMachineInOtherUnitsOfForce) {
  for (const int exponent : {-40, 0, 40}) {
    scenario::MachineScenario s = two_masses_to(std::ldexp(1e-2, exponent));
    s.machine.friction_N *= std::ldexp(1.0, exponent);
    s.start->q *= std::ldexp(1.0, exponent);
    const sil::Accuracy scaled = sil::choose_method(s), plain = sil::choose_method(two_masses_to(1e-2));
    EXPECT_EQ(scaled.method.integrator, plain.method.integrator);
    EXPECT_EQ(scaled.method.step_s, plain.method.step_s);
    EXPECT_EQ(std::ldexp(scaled.error_estimate_m, -exponent), plain.error_estimate_m);
  }
}

// Neither the event-driven nor the adaptive method takes more than 16 directions. Seventeen parallel ones of 1/17 N act
// as one of 1 N, whose end is known.
TEST(MethodChoice, ExtrapolatesTimeStepsWhereNoOtherMethodCan) {
  scenario::MachineScenario s = two_masses_to(1e-3);
  s.machine.directions.resize(2, 18);
  s.machine.directions.row(0).setConstant(1);
  s.machine.directions.row(1).setZero();
  s.machine.directions.col(17) = Eigen::Vector2d{0, 1};
  s.machine.friction_N = Eigen::VectorXd::Constant(18, 1.0 / 17);
  s.machine.friction_N[17] = 1;
  const sil::MachineResult result = sil::run_machine(s);
  EXPECT_EQ(result.accuracy->method.integrator, Integrator::time_stepping);
  EXPECT_LE(true_error_m(result), 1e-3);
  EXPECT_EQ(result.accuracy->refused.size(), 2U);
}

TEST(MethodChoice, RefusesWhatNothingHoldsWithCauseAndCost) {
  try {
    sil::run_machine(two_masses_to(1e-20));
    FAIL() << "no method is as exact as this";
  } catch (const sil::AccuracyRefused& refusal) {
    const std::string text = refusal.what(), json = report::to_json(refusal);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    for (const char* part : {"two_mass_example.toml", "1e-20", "event_driven errs by", "rounding", "about"}) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
    }
    for (const char* part : {"\"method\": null", "\"refused\": [", "\"estimated_cost_s\": "}) {
      EXPECT_NE(json.find(part), std::string::npos) << part << " in " << json;
    }
  }
}

TEST(MethodChoice, EndsForAMachineThatRestsAtOnce) {
  scenario::MachineScenario s = two_masses_to(1e-3);
  s.start = {0, Eigen::Vector2d{0.01, 0.01}, Eigen::Vector2d::Zero()};
  for (const sil::MethodTrial& trial : sil::try_methods(s)) {
    EXPECT_LE(trial.error_m, 1e-17) << to_string(trial.method);  // one rounding of 0.01 m
  }
  EXPECT_LE(sil::choose_method(s).cost_s, 1e-5);
}

TEST(MethodChoice, RefusesTimeStepsThatWouldTakeTooLongBeforeTakingThem) {
  scenario::MachineScenario s = two_masses_to(1e-11);
  s.integrator_is_named = true;
  s.integrator = Integrator::time_stepping;
  try {
    sil::choose_method(s);
    FAIL() << "1e12 steps are too many";
  } catch (const sil::AccuracyRefused& refusal) {
    ASSERT_EQ(refusal.refused().size(), 1U);
    EXPECT_GT(refusal.refused().front().cost_s, 10);
    EXPECT_LT(refusal.refused().front().method.step_s, 1e-9);
  }
}

// Negative damping lets the motion leave the range of numbers, whichever method follows it.
TEST(MethodChoice, EndsWithAllTheReasonsWhereNoMethodCanFollow) {
  scenario::MachineScenario s = two_masses_to(1e-6);
  s.machine.damping = Eigen::Vector2d{-100, -100}.asDiagonal();
  const std::string said = breakaway::testing::refusal([&] { sil::run_machine(s); });
  for (const char* part : {"no method holds", "event_driven cannot follow", "adaptive cannot follow",
                           "time_stepping cannot follow", "mend the cause that they name"}) {
    EXPECT_NE(said.find(part), std::string::npos) << part << " in " << said;
  }
  EXPECT_EQ(said.find("[run] integrator"), std::string::npos) << said;
}

// Whoever may choose the method is told of another one.
TEST(MethodChoice, IsOfferedWhereARunWithoutItIsRefused) {
  scenario::MachineScenario s = two_masses();
  s.machine.directions = Eigen::MatrixXd::Ones(2, 17);
  s.machine.friction_N = Eigen::VectorXd::Ones(17);
  EXPECT_NE(
      breakaway::testing::refusal([&] { sil::run_machine(s); }).find("or set [run] integrator to \"time_stepping\""),
      std::string::npos);
}

// The impulses of nearly dependent directions are found at once, which is many times as dear as a sweep over them: what
// may be spent on time steps is spent on far fewer.
TEST(MethodChoice, CountsWhatTheStepsOfNearlyDependentDirectionsCost) {
  const auto finest_step_s = [](double second) {
    scenario::MachineScenario s = two_masses_to(1e-3);
    s.machine.directions << 1, 1, 0, second;
    double finest_s = s.duration_s;
    for (const sil::MethodTrial& trial : sil::try_methods(s)) {
      if (trial.method.integrator == Integrator::time_stepping) finest_s = std::min(finest_s, trial.method.step_s);
    }
    return finest_s;
  };
  EXPECT_GE(finest_step_s(1e-2), 8 * finest_step_s(1));
}

TEST(MethodChoice, IsReadFromTheFileAndStandsAlone) {
  const std::string machine =
      "[machine]\nmass = [[1]]\ndamping = [[0]]\nstiffness = [[1]]\ndirections = [[1]]\nfriction_N = [1]\n"
      "[start]\nq = [5]\n[run]\naccuracy_m = 1e-3\n";
  const auto s = scenario::parse_machine_scenario(machine, "a.toml");
  EXPECT_EQ(s.accuracy_m, 1e-3);
  EXPECT_FALSE(s.integrator_is_named);
  EXPECT_TRUE(scenario::parse_machine_scenario(machine + "integrator = \"adaptive\"\n", "a.toml").integrator_is_named);
  for (const char* second : {"step_s = 1e-3\nintegrator = \"time_stepping\"", "accuracy_m = 0"}) {
    EXPECT_THROW(scenario::parse_machine_scenario(machine + second + "\n", "a.toml"), InputError) << second;
  }
}

}  // namespace
