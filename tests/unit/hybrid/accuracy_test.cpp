// The adaptive method to an accuracy of the result, against the event-driven method, whose error is rounding.
#include "breakaway/hybrid/accuracy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "breakaway/hybrid/event_driven.hpp"

namespace accuracy_test {
namespace {

using breakaway::hybrid::EventDriven;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::MachineState;
using breakaway::hybrid::Refused;
using breakaway::hybrid::run_to_accuracy;
using State = MachineState<Eigen::Dynamic>;

struct Trial {
  LinearMachine<> machine;
  State start;
};

Trial random_trial(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); }).eval();
  };
  const Eigen::Index n = 1 + seed % 3, m = 1 + seed % 4;
  const Eigen::MatrixXd root = matrix(n, n), other = matrix(n, n);
  return {{root * root.transpose() + 0.25 * Eigen::MatrixXd::Identity(n, n),
           0.1 * matrix(n, n),
           other * other.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n),
           matrix(n, m),
           0.3 * matrix(m, 1).cwiseAbs(),
           {}},
          {0, 3 * matrix(n, 1), matrix(n, 1)}};
}

double distance(const Eigen::VectorXd& one, const Eigen::VectorXd& other) {
  return (one - other).cwiseAbs().maxCoeff();
}

TEST(Accuracy, IsHeldAndEstimatedWithinAFactor) {
  int runs = 0, broken = 0, optimistic = 0, pessimistic = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Trial trial = random_trial(seed);
    const State truth = EventDriven<>(trial.machine).run(trial.start, 10).end;
    for (const double accuracy_m : {1e-3, 1e-6, 1e-9}) {
      const auto result = run_to_accuracy(trial.machine, {}, trial.start, 10, accuracy_m);
      const double error_m = distance(result.outcome.end.q, truth.q);
      ++runs;
      if (error_m > accuracy_m) ++broken;
      if (error_m > 2 * result.error_estimate_m) ++optimistic;
      if (result.error_estimate_m > 4 * error_m && result.error_estimate_m > 1e-13) ++pessimistic;
    }
  }
  EXPECT_LE(broken, runs / 100);
  EXPECT_LE(optimistic, runs / 100);
  EXPECT_LE(pessimistic, runs / 10);
}

TEST(Accuracy, BeyondRoundingIsRefusedByName) {
  const Trial trial = random_trial(2);
  try {
    run_to_accuracy(trial.machine, {}, trial.start, 10, 1e-18);
    FAIL();
  } catch (const Refused& refused) {
    EXPECT_NE(std::string{refused.what()}.find("accuracy"), std::string::npos);
  }
}

TEST(Accuracy, TooManyStepsAreRefusedByName) {
  const Trial trial = random_trial(2);
  EXPECT_THROW(run_to_accuracy(trial.machine, {}, trial.start, 10, 1e-6, 3), Refused);
}

TEST(Accuracy, AsksForALength) {
  const Trial trial = random_trial(1);
  for (const double accuracy_m : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW(run_to_accuracy(trial.machine, {}, trial.start, 10, accuracy_m), breakaway::InputError);
  }
}

}  // namespace
}  // namespace accuracy_test
