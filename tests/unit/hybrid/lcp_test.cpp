// Lemke's method against a search that tries every choice of what is zero, with elimination in long double.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "breakaway/hybrid/lcp.hpp"

namespace lcp_test {
namespace {

using breakaway::hybrid::LcpMatrix;
using breakaway::hybrid::LcpSolution;
using breakaway::hybrid::LcpVector;
using breakaway::hybrid::solve_lcp;
using Eigen::Index;
using Reals = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
using Square = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

double between(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 8) / 0x1p24;
}
int whole(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

struct Problem {
  LcpMatrix<long double> a;
  LcpVector<long double> b;
};

template <class Scalar>
std::optional<LcpSolution<Scalar>> solved(const Problem& problem) {
  return solve_lcp<Scalar>(problem.a.cast<Scalar>(), problem.b.cast<Scalar>());
}

// The z of this choice of basic variables, if neither it nor w is negative.
std::optional<Reals> z_of(const Problem& problem, unsigned basic) {
  std::vector<Index> chosen;
  for (Index i = 0; i < problem.b.size(); ++i) {
    if ((basic >> i & 1U) != 0) chosen.push_back(i);
  }
  Reals z = Reals::Zero(problem.b.size());
  if (!chosen.empty()) {
    const Eigen::FullPivLU<Square> lu(problem.a(chosen, chosen));
    if (!lu.isInvertible()) return std::nullopt;
    z(chosen) = lu.solve(Reals{-problem.b(chosen)});
  }
  const Reals w = problem.a * z + problem.b;
  if (z.minCoeff() < -1e-12L || w.minCoeff() < -1e-12L) return std::nullopt;
  return z;
}

// Says what is not as a solution must be: z_i is zero where it is not basic, and w_i where it is.
template <class Scalar>
void expect_solution(const Problem& problem, const std::optional<LcpSolution<Scalar>>& solution) {
  ASSERT_TRUE(solution);
  const Reals z = solution->z.template cast<long double>();
  ASSERT_EQ(z.size(), problem.b.size());
  const Reals w = problem.a * z + problem.b, terms = problem.a.cwiseAbs() * z.cwiseAbs() + problem.b.cwiseAbs();
  const long double near = 1e4L * std::numeric_limits<Scalar>::epsilon() * terms.maxCoeff();
  for (Index i = 0; i < z.size(); ++i) {
    EXPECT_GE(z[i], -near);
    EXPECT_GE(w[i], -near);
    if ((solution->basic >> i & 1U) != 0) {
      EXPECT_LE(w[i], near);
    } else {
      EXPECT_EQ(z[i], 0);
    }
  }
  EXPECT_EQ(std::uint64_t{solution->basic} >> z.size(), 0U);
}

// With a positive definite matrix there is one solution, and with numbers that are drawn one choice of it.
Problem definite(std::mt19937& random, Index size) {
  Problem problem{LcpMatrix<long double>(size, size), LcpVector<long double>(size)};
  Square factor(size, size);
  for (long double& x : factor.reshaped()) x = between(random, -1, 1);
  problem.a = factor * factor.transpose() + 0.1L * Square::Identity(size, size);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < i; ++j) {
      const long double skew = between(random, -1, 1);
      problem.a(i, j) += skew;
      problem.a(j, i) -= skew;
    }
  }
  for (long double& x : problem.b) x = between(random, -2, 1);
  return problem;
}

template <class Scalar>
void expect_the_only_solution(const Problem& problem, double near) {
  const auto found = solved<Scalar>(problem);
  ASSERT_TRUE(found);
  int choices = 0;
  for (unsigned basic = 0; basic < 1U << problem.b.size(); ++basic) {
    const auto truth = z_of(problem, basic);
    if (!truth) continue;
    ++choices;
    EXPECT_EQ(found->basic, basic);
    EXPECT_LE((found->z.template cast<long double>() - *truth).cwiseAbs().maxCoeff(), near);
  }
  EXPECT_EQ(choices, 1);
}

TEST(Lcp, FindsTheOnlySolutionOfADefiniteProblem) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 400; ++trial) {
    const Problem problem = definite(random, 1 + trial % 7);
    expect_the_only_solution<double>(problem, 1e-11);
    expect_the_only_solution<long double>(problem, 1e-14);
  }
}

// Small whole numbers tie in every step.
TEST(Lcp, SolvesProblemsThatAreFullOfTies) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 3000; ++trial) {
    const Index size = whole(random, 1, 6), rank = whole(random, 1, static_cast<int>(size));
    Problem problem{LcpMatrix<long double>(size, size), LcpVector<long double>(size)};
    Square factor(size, rank);
    for (long double& x : factor.reshaped()) x = whole(random, -1, 1);
    problem.a = factor * factor.transpose();
    // In the range of the matrix and above it: then a solution exists, whatever its rank is.
    Reals inside(rank);
    for (long double& x : inside) x = whole(random, -2, 2);
    problem.b = factor * inside;
    for (long double& x : problem.b) x += whole(random, 0, 1);
    expect_solution(problem, solved<double>(problem));
    expect_solution(problem, solved<long double>(problem));
  }
}

TEST(Lcp, NothingIsBasicWhereNothingIsNegative) {
  for (const double least : {0.0, 1.0}) {
    Problem problem{LcpMatrix<long double>::Identity(3, 3), LcpVector<long double>::Constant(3, 2)};
    problem.b[1] = least;
    const auto solution = solved<double>(problem);
    ASSERT_TRUE(solution);
    EXPECT_EQ(solution->basic, 0U);
    EXPECT_EQ(solution->z, LcpVector<double>::Zero(3));
  }
  const auto empty = solve_lcp<double>(LcpMatrix<double>(0, 0), LcpVector<double>(0));
  ASSERT_TRUE(empty);
  EXPECT_EQ(empty->z.size(), 0);
  EXPECT_EQ(empty->basic, 0U);
}

TEST(Lcp, FindsNothingWhereThereIsNothing) {
  Problem problem{LcpMatrix<long double>::Zero(2, 2), LcpVector<long double>::Constant(2, -1)};
  EXPECT_FALSE(solved<double>(problem));
  problem.a = -LcpMatrix<long double>::Identity(2, 2);
  EXPECT_FALSE(solved<double>(problem));
  problem.a = LcpMatrix<long double>::Identity(2, 2);
  EXPECT_TRUE(solved<double>(problem));
}

TEST(Lcp, HasRoomForTwoUnknownsForEachOfSixteenDirections) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Problem problem = definite(random, 32);
    expect_solution(problem, solved<double>(problem));
    expect_solution(problem, solved<long double>(problem));
  }
}

TEST(Lcp, TheUnitOfTheMatrixDecidesNothing) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Problem problem = definite(random, 4);
    const auto solution = solved<double>(problem);
    ASSERT_TRUE(solution);
    for (const long double size : {0x1p-30L, 0x1p30L}) {
      const auto scaled = solved<double>({size * problem.a, size * problem.b});
      ASSERT_TRUE(scaled);
      EXPECT_EQ(scaled->basic, solution->basic);
      EXPECT_LE((scaled->z - solution->z).cwiseAbs().maxCoeff(), 1e-11);
    }
  }
}

TEST(Lcp, OneUnknownMayBeOfAnySize) {
  for (const long double size : {0x1p-900L, 0x1p-40L, 0x1p40L, 0x1p900L}) {
    const Problem problem{LcpMatrix<long double>::Constant(1, 1, size), LcpVector<long double>::Constant(1, -3 * size)};
    const auto solution = solved<double>(problem);
    ASSERT_TRUE(solution);
    EXPECT_EQ(solution->basic, 1U);
    EXPECT_EQ(solution->z[0], 3);
  }
}

// Nearly dependent columns, in problems in which rows tie. A pivot that is smaller than it must be, or what is rounding
// taken for one, spoils more of them: the numbers are those of today's choice, and may only become better.
TEST(Lcp, TheChoiceOfThePivotKeepsRoundingSmall) {
  int right = 0, wrong = 0;
  for (unsigned trial = 1; trial <= 3000; ++trial) {
    std::mt19937 random(trial);
    const Index size = whole(random, 2, 6);
    const double apart = std::ldexp(1.0, -whole(random, 5, 40));
    Eigen::MatrixXd factor(size, size);
    for (double& x : factor.reshaped()) {
      const double side = whole(random, -1, 1);
      x = side + apart * between(random, -1, 1);
    }
    LcpMatrix<double> a = factor * factor.transpose();
    LcpVector<double> b(size);
    for (double& x : b) x = -whole(random, 0, 1);
    b[whole(random, 0, static_cast<int>(size) - 1)] = -1;
    const auto solution = solve_lcp<double>(a, b);
    if (!solution) continue;
    const Reals z = solution->z.cast<long double>(), w = a.cast<long double>() * z + b.cast<long double>();
    const Reals terms = a.cast<long double>().cwiseAbs() * z.cwiseAbs() + b.cast<long double>().cwiseAbs();
    bool good = true;
    for (Index i = 0; i < size; ++i) {
      const bool basic = (solution->basic >> i & 1U) != 0;
      good = good && (basic ? std::abs(w[i]) : -w[i]) <= 1e-9L * terms[i];
    }
    ++(good ? right : wrong);
  }
  EXPECT_GE(right, 2669);
  EXPECT_LE(wrong, 105);
}

}  // namespace
}  // namespace lcp_test
