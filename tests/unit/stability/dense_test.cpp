// The linear algebra that the certificates stand on: empty matrices, dependent columns and numbers without end.
#include "breakaway/stability/dense.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../../../controller/stability/src/exact_rank.hpp"
#include "../refusal.hpp"
#include "breakaway/stability/extended.hpp"
#include "breakaway/stability/linear_machine.hpp"
#include "breakaway/stability/mass_units.hpp"
#include "breakaway/stability/twofold.hpp"

namespace dense_test {
namespace {

using namespace breakaway::stability;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double endless = std::numeric_limits<double>::infinity();

TEST(Dense, TakesEmptyMatricesForWhatTheyAre) {
  EXPECT_EQ(dense::spectral_norm(MatrixXd(0, 3)), 0);
  const dense::Cholesky factors(MatrixXd::Identity(2, 2));
  EXPECT_EQ(factors.solve(MatrixXd(2, 0)).cols(), 0);
  EXPECT_EQ(factors.solve(MatrixXd(2, 0)).rows(), 2);
  const dense::Span span = dense::span(MatrixXd(3, 0));
  EXPECT_EQ(span.rank(), 0);
  EXPECT_EQ(span.complement, MatrixXd::Identity(3, 3));
  EXPECT_EQ(dense::solution(MatrixXd(0, 2), MatrixXd(0, 3)), MatrixXd::Zero(2, 3));
}

TEST(Dense, HasNoNormalOfDependentColumns) {
  const MatrixXd independent{{1, 0}, {0, 1}, {0, 0}}, dependent{{1, 2}, {1, 2}, {0, 0}};
  const VectorXd normal = dense::normal(independent);
  ASSERT_EQ(normal.size(), 3);
  EXPECT_NEAR(std::abs(normal[2]), 1, 1e-15);
  EXPECT_EQ(dense::normal(dependent).size(), 0);
}

TEST(Dense, FindsNoEigenvaluesOfWhatIsNoNumber) {
  EXPECT_EQ(dense::general_eigen(MatrixXd::Constant(4, 4, std::nan(""))).values.size(), 0);
  EXPECT_EQ(dense::general_eigen(MatrixXd::Identity(2, 2)).values.size(), 2);
}

TEST(ExtendedAlgebra, InvertsRegularMatricesAndNoOthers) {
  const extended::Matrix regular{{2, 0}, {0, 4}}, singular{{1, 2}, {2, 4}};
  const auto inverse = extended::inverse_if_regular(regular);
  ASSERT_TRUE(inverse.has_value());
  EXPECT_EQ((*inverse)(1, 1), 0.25L);
  EXPECT_FALSE(extended::inverse_if_regular(singular).has_value());
}

TEST(ExtendedAlgebra, TellsWhatColumnsSpan) {
  const extended::Matrix parallel{{1, 2}, {0, 0}, {0, 0}};
  EXPECT_EQ(extended::span(parallel, 1e-15L).rank(), 1);
  EXPECT_EQ(extended::span(parallel, 1e-15L).complement.cols(), 2);
  const extended::Span none = extended::span(extended::Matrix(3, 0), 1e-15L);
  EXPECT_EQ(none.rank(), 0);
  EXPECT_EQ(none.complement, extended::Matrix::Identity(3, 3));
}

TEST(TwofoldAlgebra, HasNoSchurFormOfWhatIsNoNumber) {
  twofold::Matrix a = twofold::Matrix::Identity(2, 2);
  a(0, 1) = 3.0;
  const twofold::RealSchur schur = twofold::real_schur(a);
  ASSERT_TRUE(schur.found);
  EXPECT_EQ(static_cast<double>(schur.form(1, 1)), 1);
  EXPECT_FALSE(twofold::real_schur(twofold::Matrix::Constant(4, 4, std::nan(""))).found);
}

TEST(TwofoldAlgebra, TakesEmptyMatricesForWhatTheyAre) {
  EXPECT_EQ(twofold::inverse(twofold::Matrix(0, 0)).size(), 0);
  ASSERT_TRUE(twofold::inverse_if_regular(twofold::Matrix(0, 0)).has_value());
  const twofold::Span none = twofold::span(twofold::Matrix(3, 0), 1e-15);
  EXPECT_EQ(none.rank(), 0);
  EXPECT_EQ(none.complement.cols(), 3);
}

TEST(TwofoldAlgebra, MakesNoNumberOfAMatrixThatIsNotFinite) {
  twofold::Matrix a = twofold::Matrix::Identity(2, 2);
  EXPECT_EQ(static_cast<double>(twofold::inverse(a)(0, 0)), 1);
  a(0, 1) = endless;
  EXPECT_FALSE(std::isfinite(static_cast<double>(twofold::inverse(a)(0, 1))));
}

TEST(DoubleDouble, IsEqualToItsDoubleOnlyWithoutALowPart) {
  const DoubleDouble one = 1.0, more = one + std::ldexp(1.0, -80);
  EXPECT_EQ(more.high(), 1);
  EXPECT_FALSE(more == one);
  EXPECT_TRUE(more - std::ldexp(1.0, -80) == one);
  EXPECT_TRUE(one < more);
}

TEST(DoubleDouble, KeepsTheRootOfWhatHasNoEnd) {
  EXPECT_TRUE(isinf(sqrt(DoubleDouble{endless})));
  EXPECT_TRUE(isnan(sqrt(DoubleDouble{-1.0})));
  EXPECT_EQ(sqrt(DoubleDouble{0.0}).high(), 0);
  EXPECT_EQ(sqrt(DoubleDouble{9.0}).high(), 3);
}

// The first prime that ranks are counted with is 2^31 - 1: entries that are its multiples vanish there, not elsewhere.
TEST(ExactRank, IsNotDeceivedByMultiplesOfItsFirstPrime) {
  const double prime = 2147483647;
  EXPECT_FALSE(rank_of_symmetric_part_at_most(MatrixXd::Constant(1, 1, -prime), 0));
  EXPECT_FALSE(rank_of_symmetric_part_at_most(MatrixXd::Constant(1, 1, prime), 0));
  EXPECT_TRUE(rank_of_symmetric_part_at_most(MatrixXd{{prime, -prime}, {-prime, prime}}, 1));
  EXPECT_FALSE(rank_of_symmetric_part_at_most(MatrixXd{{prime, -prime}, {-prime, prime + 1}}, 1));
}

LinearMachine<> two_free_masses() {
  return {MatrixXd::Identity(2, 2), MatrixXd::Zero(2, 2), MatrixXd::Identity(2, 2), MatrixXd::Identity(2, 2),
          VectorXd::Ones(2)};
}

TEST(SizedMachine, HasNoForceWhereNoneIsGiven) {
  LinearMachine<> machine = two_free_masses();
  EXPECT_EQ((sized<2, 2>(machine).force_N), Eigen::Vector2d::Zero());
  machine.force_N = Eigen::Vector2d{1, 2};
  EXPECT_EQ((sized<2, 2>(machine).force_N), Eigen::Vector2d(1, 2));
}

TEST(Statics, OfAMachineWithoutCoordinatesAreRefused) {
  EXPECT_EQ(breakaway::testing::refusal([] { require_valid_statics(LinearMachine<>{}); }),
            "stiffness is empty: give a machine at least one coordinate");
}

TEST(MassUnits, CarryAConstantForceAlong) {
  LinearMachine<> machine = two_free_masses();
  EXPECT_EQ(in_units(machine, Eigen::Vector2d{2, 0.5}).force_N.size(), 0);
  machine.force_N = Eigen::Vector2d{3, 8};
  EXPECT_EQ(in_units(machine, Eigen::Vector2d{2, 0.5}).force_N, Eigen::Vector2d(6, 4));  // a force times a way stays
}

TEST(Feedback, KeepsASkewPartThatIsMoreThanRounding) {
  const MatrixXd gain{{0, 1}, {0.25, 0}};
  const LinearMachine<> closed = with_feedback(two_free_masses(), MatrixXd::Identity(2, 2), gain, MatrixXd::Zero(2, 2));
  EXPECT_EQ(closed.stiffness(0, 1), 1);
  EXPECT_EQ(closed.stiffness(1, 0), 0.25);
}

}  // namespace
}  // namespace dense_test
