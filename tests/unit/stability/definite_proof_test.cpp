// Proofs of definiteness, against matrices whose definiteness is known by construction.
#include "breakaway/stability/definite_proof.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "random_systems.hpp"

namespace definite_proof_test {
namespace {

using namespace breakaway::stability;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd diagonal(std::initializer_list<double> entries) {
  VectorXd values(static_cast<Index>(entries.size()));
  std::ranges::copy(entries, values.begin());
  return values.asDiagonal();
}

TEST(DefiniteProof, TellsTheSignOfEveryDiagonalWhateverItsUnits) {
  EXPECT_EQ(positive_definite(diagonal({1e300, 1e-300})), Proof::holds);
  EXPECT_EQ(positive_definite(diagonal({1e4, -1e-12})), Proof::fails);
  EXPECT_EQ(positive_semidefinite(diagonal({1e4, -1e-12})), Proof::fails);
  EXPECT_EQ(positive_definite(diagonal({1e4, 0})), Proof::fails);
  EXPECT_EQ(positive_semidefinite(diagonal({1e4, 0})), Proof::holds);
  EXPECT_EQ(positive_semidefinite(MatrixXd::Zero(3, 3)), Proof::holds);
  EXPECT_EQ(positive_definite(MatrixXd{}), Proof::holds);
}

// B^T B of small integers with r rows is exact and of rank r; less one in the last place of one entry it is not
// semidefinite any more, or cannot be told.
TEST(DefiniteProof, ProvesExactlySingularMatricesByTheirRank) {
  std::mt19937_64 random{3};
  std::uniform_int_distribution<int> entry{-9, 9}, exponent{-40, 40};
  for (int trial = 0; trial < 300; ++trial) {
    const Index n = 2 + trial % 7, r = 1 + trial % (n - 1);
    const MatrixXd root = MatrixXd::NullaryExpr(r, n, [&] { return static_cast<double>(entry(random)); });
    MatrixXd a = root.transpose() * root;
    const VectorXd unit = VectorXd::NullaryExpr(n, [&] { return std::ldexp(1.0, exponent(random)); });
    const MatrixXd scaled = unit.asDiagonal() * a * unit.asDiagonal();
    EXPECT_EQ(positive_semidefinite(scaled), Proof::holds) << scaled;
    EXPECT_NE(positive_definite(scaled), Proof::holds) << scaled;
    if ((a.array() == 0).any()) continue;
    a(0, 0) -= 1e-14 * a(0, 0);  // as r < n and the rest is in general position, the least eigenvalue falls below 0
    const MatrixXd spoilt = unit.asDiagonal() * a * unit.asDiagonal();
    EXPECT_EQ(positive_definite(spoilt), positive_definite(a));
    if (r == 1) {
      EXPECT_EQ(positive_semidefinite(spoilt), Proof::fails) << spoilt;
    }
  }
}

// Q^T diag(values) Q, computed with rounding: a least value of +-1e-13 of the largest is told, one of 1e-30 never
// wrong.
TEST(DefiniteProof, NeverSaysTheOppositeOfWhatIsTrue) {
  std::mt19937_64 random{7};
  int told = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Index n = 2 + trial % 9;
    const double least = std::pow(10.0, -1 - trial % 13) * (trial % 2 == 0 ? 1 : -1);
    VectorXd values = random_matrix(random, n, 1).cwiseAbs() + VectorXd::Ones(n);
    values[0] = least;
    const MatrixXd a = with_eigenvalues(basis_along(random_matrix(random, n, n)), values);
    const Proof expected = least > 0 ? Proof::holds : Proof::fails;
    EXPECT_EQ(positive_definite(a), expected) << least;
    EXPECT_EQ(positive_semidefinite(a), expected) << least;
    told += positive_definite(a) != Proof::unknown;
  }
  EXPECT_EQ(told, 2000);
}

// [1, x; x, 1] is definite just when |x| < 1, and the numbers next to one are told.
TEST(DefiniteProof, TellsThePairNextToSingular) {
  for (const double beyond : {1.0, -1.0}) {
    for (const double x : {1.0, std::nextafter(1.0, 0.0), std::nextafter(1.0, 2.0)}) {
      const MatrixXd a{{1, beyond * x}, {beyond * x, 1}};
      EXPECT_EQ(positive_definite(a), x < 1 ? Proof::holds : Proof::fails) << x;
      EXPECT_EQ(positive_semidefinite(a), x <= 1 ? Proof::holds : Proof::fails) << x;
    }
  }
}

TEST(DefiniteProof, TakesTheSymmetricPartWithoutRoundingIt) {
  // Entries whose mean is no double: 1 + 2^-53 beside 1 - 2^-53 less a hair.
  const MatrixXd a{{1, 1 + std::ldexp(1.0, -52)}, {1 - std::ldexp(1.0, -52), 1}};
  EXPECT_EQ(positive_semidefinite(a), Proof::holds) << "the skew part does not count";
  const MatrixXd beyond{{1, 1 + std::ldexp(1.0, -52)}, {1 - std::ldexp(1.0, -53), 1}};
  EXPECT_NE(positive_semidefinite(beyond), Proof::holds);
}

TEST(DefiniteProof, AllowsForTheErrorOfTheEntries) {
  const extended::Matrix a = extended::Matrix::Identity(2, 2);
  EXPECT_EQ(positive_definite(a, extended::Matrix::Constant(2, 2, 0.4L)), Proof::holds);
  EXPECT_EQ(positive_definite(a, extended::Matrix::Constant(2, 2, 0.6L)), Proof::unknown);
  EXPECT_EQ(positive_definite(-a, extended::Matrix::Constant(2, 2, 0.4L)), Proof::fails);
}

TEST(DefiniteProof, LeavesWhatIsNotFiniteUnknown) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    MatrixXd a = MatrixXd::Identity(2, 2);
    a(0, 1) = a(1, 0) = bad;
    EXPECT_EQ(positive_definite(a), Proof::unknown);
    EXPECT_EQ(positive_semidefinite(a), Proof::unknown);
  }
}

}  // namespace
}  // namespace definite_proof_test
