// Proofs of definiteness where rounding hides the answer, or no number is left to prove it with.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "breakaway/stability/definite_proof.hpp"
#include "breakaway/stability/lmi.hpp"

namespace definite_limits_test {
namespace {

using namespace breakaway::stability;
using Eigen::Index;
using Eigen::MatrixXd;

// Kahan's matrix: its factors have pivots that tell nothing of how nearly singular it is. The columns differ by so much
// that the pivots are taken in their order.
MatrixXd squared_kahan(Index n) {
  const double cosine = 0.285, sine = std::sqrt(1 - cosine * cosine);
  MatrixXd root = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    root(i, i) = 1;
    root.row(i).tail(n - i - 1).setConstant(-cosine);
    root.row(i) *= std::pow(sine, static_cast<double>(i));
  }
  for (Index j = 0; j < n; ++j) root.col(j) *= 1 + 1e-9 * static_cast<double>(n - j);
  return root.transpose() * root;
}

// Beside masses of their own, which only make the proof take off more for rounding: the least eigenvalue of Kahan's
// matrix is below that, and its least pivot far above.
TEST(DefiniteProofLimits, GoodPivotsProveNothingOfAMatrixThatIsNearlySingular) {
  EXPECT_EQ(positive_semidefinite(squared_kahan(10)), Proof::holds);
  MatrixXd a = MatrixXd::Identity(256, 256);
  a.topLeftCorner(10, 10) = squared_kahan(10);
  EXPECT_EQ(positive_semidefinite(a), Proof::holds);
  a.topLeftCorner(60, 60) = squared_kahan(60);
  EXPECT_EQ(positive_semidefinite(a), Proof::unknown);
}

TEST(DefiniteProofLimits, EntriesThatMayBeAnythingLeaveItUnknown) {
  const extended::Matrix a = extended::Matrix::Identity(2, 2);
  extended::Matrix error = extended::Matrix::Zero(2, 2);
  EXPECT_EQ(positive_definite(a, error), Proof::holds);
  error(0, 1) = std::numeric_limits<long double>::infinity();
  EXPECT_EQ(positive_definite(a, error), Proof::unknown);
}

// Scaled to a diagonal of one, the error is beyond all numbers, and it is not forgotten.
TEST(DefiniteProofLimits, AnErrorThatOverflowsInScalingLeavesItUnknown) {
  const extended::Matrix a = std::ldexp(1.0L, -8000) * extended::Matrix::Identity(2, 2);
  extended::Matrix error = extended::Matrix::Zero(2, 2);
  EXPECT_EQ(positive_definite(a, error), Proof::holds);
  error(0, 1) = error(1, 0) = std::ldexp(1.0L, 9000);
  EXPECT_EQ(positive_definite(a, error), Proof::unknown);
}

}  // namespace
}  // namespace definite_limits_test
