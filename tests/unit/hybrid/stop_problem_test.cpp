// What sticks and what slides after a stop, of problems by themselves. No other solver is needed to judge an answer:
// what must hold of every direction is put to it in long double, and only one acceleration passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "breakaway/hybrid/stop_problem.hpp"

namespace stop_problem_test {
namespace {

using breakaway::hybrid::DirectionSet;
using breakaway::hybrid::Sliding;
using breakaway::hybrid::sliding_after_stop;
using breakaway::hybrid::StopProblem;
using Eigen::Index;
using Real = long double;
using Reals = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Grid = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

double between(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 8) / 0x1p24;
}
int whole(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

// Directions w, columns, of a machine whose mass is the identity, and a force on it.
StopProblem<Real> problem_of(const Grid& w, const Reals& force_N, const Reals& forward_N, const Reals& backward_N) {
  StopProblem<Real> problem(w.cols());
  problem.coupling = w.transpose() * w;
  problem.acceleration = w.transpose() * force_N;
  problem.rounding.setZero();
  problem.forward_N = forward_N;
  problem.backward_N = backward_N;
  return problem;
}

template <class Scalar>
StopProblem<Scalar> in(const StopProblem<Real>& problem) {
  StopProblem<Scalar> result(problem.acceleration.size());
  result.coupling = problem.coupling.template cast<Scalar>();
  result.acceleration = problem.acceleration.template cast<Scalar>();
  result.rounding = problem.rounding.template cast<Scalar>();
  result.forward_N = problem.forward_N.template cast<Scalar>();
  result.backward_N = problem.backward_N.template cast<Scalar>();
  return result;
}

// The conditions of a stop, put to an answer whose forces and accelerations may be off by `near` of their terms.
template <class Scalar>
void expect_lawful(const StopProblem<Scalar>& problem, const Sliding& sliding, Real near) {
  const Index count = problem.acceleration.size();
  ASSERT_EQ(sliding.signs.size(), count);
  ASSERT_EQ(sliding.force_N.size(), count);
  const Reals force_N = sliding.force_N.cast<Real>(), b = problem.acceleration.template cast<Real>();
  const Reals largest_N = problem.forward_N.cwiseMax(problem.backward_N).template cast<Real>();
  const Grid coupling = problem.coupling.template cast<Real>();
  const Reals gamma = coupling * force_N + b, terms = coupling.cwiseAbs() * largest_N + b.cwiseAbs();
  for (Index i = 0; i < count; ++i) {
    const auto forward_N = static_cast<double>(problem.forward_N[i]),
               backward_N = static_cast<double>(problem.backward_N[i]);
    if (sliding.signs[i] == 0) {
      EXPECT_LE(std::abs(gamma[i]), near * terms[i]);
      EXPECT_LE(sliding.force_N[i], backward_N + static_cast<double>(near) * backward_N);
      EXPECT_GE(sliding.force_N[i], -forward_N - static_cast<double>(near) * forward_N);
    } else {
      EXPECT_EQ(std::abs(sliding.signs[i]), 1);
      EXPECT_GT(sliding.signs[i] * gamma[i], 0);
      EXPECT_EQ(sliding.force_N[i], sliding.signs[i] > 0 ? -forward_N : backward_N);
    }
  }
}

Reals drawn(std::mt19937& random, Index size, double low, double high) {
  Reals result(size);
  for (Real& x : result) x = between(random, low, high);
  return result;
}
Grid drawn_directions(std::mt19937& random, Index coordinates, Index count) {
  Grid result(coordinates, count);
  for (Real& x : result.reshaped()) x = between(random, -1, 1);
  return result;
}

// How many stick, slide forwards and slide backwards: so that a test which draws can say that it met them.
struct Met {
  int stick = 0, forward = 0, backward = 0;
  void add(const Sliding& sliding) {
    for (const double sign : sliding.signs) ++(sign == 0 ? stick : sign > 0 ? forward : backward);
  }
  int least() const { return std::min({stick, forward, backward}); }
};

TEST(StopProblem, EachDirectionSticksOrSlidesAsItsForcesSay) {
  std::mt19937 random(1);
  Met met;
  for (int trial = 0; trial < 2000; ++trial) {
    const Index count = whole(random, 1, 6), coordinates = count + whole(random, 0, 2);
    const StopProblem<Real> problem =
        problem_of(drawn_directions(random, coordinates, count), drawn(random, coordinates, -3, 3),
                   drawn(random, count, 0.1, 2), drawn(random, count, 0.1, 2));
    const auto rough = sliding_after_stop(in<double>(problem)), fine = sliding_after_stop(problem);
    ASSERT_TRUE(rough && fine);
    expect_lawful(in<double>(problem), *rough, 1e-13L);
    expect_lawful(problem, *fine, 1e-15L);
    EXPECT_EQ(rough->signs, fine->signs);
    EXPECT_EQ(rough->ties, 0U);
    EXPECT_EQ(fine->ties, 0U);
    met.add(*fine);
  }
  EXPECT_GT(met.least(), 1000);
}

// More directions than coordinates: some of their forces are free, and what they do is not.
TEST(StopProblem, DependentDirectionsAreDecidedTogether) {
  std::mt19937 random(2);
  Met met;
  for (int trial = 0; trial < 1000; ++trial) {
    const Index coordinates = whole(random, 1, 3), count = coordinates + whole(random, 1, 3);
    const StopProblem<Real> problem =
        problem_of(drawn_directions(random, coordinates, count), drawn(random, coordinates, -4, 4),
                   drawn(random, count, 0.1, 2), drawn(random, count, 0.1, 2));
    const auto rough = sliding_after_stop(in<double>(problem)), fine = sliding_after_stop(problem);
    ASSERT_TRUE(rough && fine);
    expect_lawful(in<double>(problem), *rough, 1e-12L);
    expect_lawful(problem, *fine, 1e-15L);
    met.add(*fine);
  }
  EXPECT_GT(met.least(), 300);
}

TEST(StopProblem, SixteenDirectionsAreDecided) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const StopProblem<Real> problem = problem_of(drawn_directions(random, 16, 16), drawn(random, 16, -4, 4),
                                                 drawn(random, 16, 0.1, 2), drawn(random, 16, 0.1, 2));
    const auto sliding = sliding_after_stop(in<double>(problem));
    ASSERT_TRUE(sliding);
    expect_lawful(in<double>(problem), *sliding, 1e-11L);
  }
}

// Whole numbers tie everywhere: forces at their very limits, directions without acceleration that slide.
TEST(StopProblem, ForcesAtTheirVeryLimitsStick) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 3000; ++trial) {
    const Index count = whole(random, 1, 4), coordinates = count;
    Grid w(coordinates, count);
    Reals force_N(coordinates), friction_N(count);
    for (Real& x : w.reshaped()) x = whole(random, -1, 1);
    for (Real& x : force_N) x = whole(random, -2, 2);
    for (Real& x : friction_N) x = whole(random, 1, 2);
    if (!(w.colwise().squaredNorm().minCoeff() > 0)) continue;
    const StopProblem<Real> problem = problem_of(w, force_N, friction_N, friction_N);
    const auto rough = sliding_after_stop(in<double>(problem)), fine = sliding_after_stop(problem);
    ASSERT_TRUE(rough && fine);
    expect_lawful(in<double>(problem), *rough, 1e-15L);
    expect_lawful(problem, *fine, 1e-15L);
    EXPECT_EQ(rough->signs, fine->signs);
  }
}

// Mirrored forces mirror the answer, where friction is mirrored with them.
TEST(StopProblem, MirroringMirrorsTheAnswer) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 300; ++trial) {
    const Grid w = drawn_directions(random, 4, 4);
    const Reals force_N = drawn(random, 4, -3, 3), forward_N = drawn(random, 4, 0.1, 2),
                backward_N = drawn(random, 4, 0.1, 2);
    const auto sliding = sliding_after_stop(problem_of(w, force_N, forward_N, backward_N));
    const auto mirrored = sliding_after_stop(problem_of(w, -force_N, backward_N, forward_N));
    ASSERT_TRUE(sliding && mirrored);
    EXPECT_EQ(sliding->signs, -mirrored->signs);
    EXPECT_LE((sliding->force_N + mirrored->force_N).cwiseAbs().maxCoeff(), 1e-14);
  }
}

// Each direction in a unit of its own, and all forces in another one.
TEST(StopProblem, UnitsDecideNothing) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 300; ++trial) {
    Grid w = drawn_directions(random, 4, 4);
    Reals force_N = drawn(random, 4, -3, 3), friction_N = drawn(random, 4, 0.1, 2);
    const auto sliding = sliding_after_stop(in<double>(problem_of(w, force_N, friction_N, friction_N)));
    for (Index i = 0; i < 4; ++i) {
      const Real unit = std::ldexp(1.0L, whole(random, -40, 40));
      w.col(i) *= unit;
      friction_N[i] /= unit;
    }
    const Real newton = 0x1p30L;
    const auto scaled =
        sliding_after_stop(in<double>(problem_of(w, newton * force_N, newton * friction_N, newton * friction_N)));
    ASSERT_TRUE(sliding && scaled);
    EXPECT_EQ(sliding->signs, scaled->signs);
  }
}

// Frictions, masses and angles far apart: an answer is right, or there is none.
TEST(StopProblem, WhatRoundingLeavesInDoubtIsNotAnswered) {
  std::mt19937 random(7);
  int answered = 0, in_doubt = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Index count = whole(random, 2, 4);
    Grid w = drawn_directions(random, count, count);
    const Real angle = std::ldexp(1.0L, -whole(random, 0, 45));
    w.col(1) = w.col(0) + angle * w.col(1);
    Reals friction_N = drawn(random, count, 0.1, 2);
    for (Real& x : friction_N) x = std::ldexp(x, -whole(random, 0, 60));
    const StopProblem<Real> problem = problem_of(w, drawn(random, count, -3, 3), friction_N, friction_N);
    const StopProblem<double> rounded = in<double>(problem);
    const auto sliding = sliding_after_stop(rounded);
    ++(sliding ? answered : in_doubt);
    if (sliding) expect_lawful(rounded, *sliding, 1e-5L);
  }
  EXPECT_GT(answered, 1000);
  EXPECT_GT(in_doubt, 100);
}

// One direction, a coupling of 1 and a friction of 1: it slides with what the force is more than that.
StopProblem<double> single(double acceleration, double rounding = 0) {
  StopProblem<double> problem(1);
  problem.coupling(0, 0) = 1;
  problem.acceleration[0] = acceleration;
  problem.rounding[0] = rounding;
  problem.forward_N[0] = problem.backward_N[0] = 1;
  return problem;
}

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// The sum of a force and of one direction's friction, each of 1: five roundings of 2 are 10 of them.
TEST(StopProblem, AnAccelerationIsOneFromTheRoundingOfItsTermsOn) {
  EXPECT_EQ(sliding_after_stop(single(1 - 11 * epsilon))->signs[0], 0);
  EXPECT_EQ(sliding_after_stop(single(1))->signs[0], 0);
  EXPECT_EQ(sliding_after_stop(single(1 + 9 * epsilon))->signs[0], 0);
  EXPECT_EQ(sliding_after_stop(single(1 + 10 * epsilon))->signs[0], 0);
  EXPECT_EQ(sliding_after_stop(single(1 + 11 * epsilon))->signs[0], 1);
}

// A sum of 1 - 5 roundings and of 1 + 5 of them is 2, whose rounding is just their difference.
TEST(StopProblem, AnAccelerationThatEqualsItsRoundingIsNone) {
  StopProblem<double> problem = single(1 + 5 * epsilon);
  problem.forward_N[0] = problem.backward_N[0] = 1 - 5 * epsilon;
  const auto sliding = sliding_after_stop(problem);
  ASSERT_TRUE(sliding);
  EXPECT_EQ(sliding->signs[0], 0);
  EXPECT_EQ(sliding->ties, 1U);
}

TEST(StopProblem, AnAccelerationThatItsRoundingMayHaveMadeOfZeroIsATie) {
  constexpr double of_the_sum = 5 * 2.5 * epsilon;
  for (const double side : {1.0, -1.0}) {
    for (const double rounding : {0.0, 0.25, 0.5 - of_the_sum - epsilon}) {
      const auto sliding = sliding_after_stop(single(side * 1.5, rounding));
      ASSERT_TRUE(sliding);
      EXPECT_EQ(sliding->signs[0], side);
      EXPECT_EQ(sliding->ties, 0U) << rounding;
    }
    for (const double rounding : {0.5 - of_the_sum, 0.5, 2.0}) {
      const auto sliding = sliding_after_stop(single(side * 1.5, rounding));
      ASSERT_TRUE(sliding);
      EXPECT_EQ(sliding->signs[0], side);
      EXPECT_EQ(sliding->ties, 1U) << rounding;
    }
  }
}

// What sticks is no tie, whatever was rounded.
TEST(StopProblem, ATieIsNamedByItsDirection) {
  StopProblem<double> problem(3);
  problem.coupling.setIdentity();
  problem.acceleration << 0.5, 1.5, -3;
  problem.rounding << 1, 1, 1;
  problem.forward_N.setOnes();
  problem.backward_N.setOnes();
  const auto sliding = sliding_after_stop(problem);
  ASSERT_TRUE(sliding);
  EXPECT_EQ(sliding->signs, (Eigen::Vector3d{0, 1, -1}));
  EXPECT_EQ(sliding->force_N, (Eigen::Vector3d{-0.5, -1, 1}));
  EXPECT_EQ(sliding->ties, 0b010U);
}

// A hair beyond its limit, by less than the width of a tie, a force sticks: in any unit of force.
TEST(StopProblem, AForceAtItsLimitToRoundingSticks) {
  for (const double newton : {1.0, 0x1p40, 0x1p-40}) {
    StopProblem<double> problem = single(-newton * (1 + 11 * epsilon));
    problem.forward_N *= newton;
    problem.backward_N *= newton;
    const auto sliding = sliding_after_stop(problem);
    ASSERT_TRUE(sliding) << newton;
    EXPECT_EQ(sliding->signs[0], 0) << newton;
  }
}

TEST(StopProblem, SixteenDirectionsMayAllStick) {
  std::mt19937 random(8);
  const StopProblem<Real> problem =
      problem_of(drawn_directions(random, 20, 16), drawn(random, 20, -0.1, 0.1), Reals::Ones(16), Reals::Ones(16));
  const auto sliding = sliding_after_stop(in<double>(problem));
  ASSERT_TRUE(sliding);
  EXPECT_EQ(sliding->signs, (Eigen::VectorXd::Zero(16)));
  expect_lawful(in<double>(problem), *sliding, 1e-11L);
}

// Two directions with a coupling of 1 - `apart`, pushed alike: each bears half of it, and their difference, which
// nothing pushes, is known to the rounding of 2 push over `apart`.
StopProblem<double> nearly_one(double apart, double push, double first_N, double second_N) {
  StopProblem<double> problem(2);
  problem.coupling << 1, 1 - apart, 1 - apart, 1;
  problem.acceleration.setConstant(push);
  problem.rounding.setZero();
  problem.forward_N << first_N, second_N;
  problem.backward_N = problem.forward_N;
  return problem;
}

constexpr double doubt = 0x1p-20;  // the greatest error of a force, as a share of its range

TEST(StopProblem, AForceThatIsKnownToAMillionthOfItsRangeIsBelieved) {
  for (const double push : {0.5, -0.5}) {
    // Six roundings of each of two sums of 2 push, and the range is 2.
    const double least = 2 * 6 * epsilon * std::abs(push) / (2 * doubt);
    for (const double other_N : {1.0, 8.0}) {
      for (const bool swapped : {false, true}) {
        const auto of = [&](double apart) {
          return sliding_after_stop(nearly_one(apart, push, swapped ? other_N : 1, swapped ? 1 : other_N));
        };
        EXPECT_FALSE(of(0.93 * least)) << push << other_N << swapped;
        const auto sliding = of(1.07 * least);
        ASSERT_TRUE(sliding) << push << other_N << swapped;
        EXPECT_EQ(sliding->signs, Eigen::Vector2d::Zero());
        EXPECT_NEAR(sliding->force_N.sum(), -2 * push / (2 - 1.07 * least), 1e-15);
      }
    }
  }
}

// A third one, which both of them push by half of their forces, slides; what pushes it may have been rounded.
TEST(StopProblem, AnAccelerationThatIsKnownToAMillionthOfItsTermsIsATieAndElseADoubt) {
  // Seven roundings of each of two sums of 2 push.
  constexpr double least = 2 * 7 * epsilon / doubt;
  for (const double side : {1.0, -1.0}) {
    for (const Index slider : {0, 1, 2}) {
      const auto of = [&](double apart) {
        StopProblem<double> problem(3);
        problem.coupling.setConstant(1 - apart);
        problem.coupling.row(slider).setConstant(0.5);
        problem.coupling.col(slider).setConstant(0.5);
        problem.coupling.diagonal().setOnes();
        problem.acceleration.setConstant(-0.25 * side);
        problem.acceleration[slider] = 0.125 * side;
        problem.rounding.setZero();
        problem.rounding[slider] = 1;
        problem.forward_N.setOnes();
        problem.forward_N[slider] = 0x1p-9;
        problem.backward_N = problem.forward_N;
        return sliding_after_stop(problem);
      };
      EXPECT_FALSE(of(0.95 * least)) << side << slider;
      const auto sliding = of(1.1 * least);
      ASSERT_TRUE(sliding) << side << slider;
      EXPECT_EQ(sliding->signs, (side * Eigen::Vector3d::Unit(slider)).eval());
      EXPECT_EQ(sliding->ties, DirectionSet{1} << slider);
    }
  }
}

}  // namespace
}  // namespace stop_problem_test
