#include "breakaway/hybrid/invariant_blocks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "breakaway/hybrid/dense_block.hpp"

namespace invariant_blocks_test {
namespace {

using breakaway::hybrid::DenseBlock;
using breakaway::hybrid::invariant_blocks;
using breakaway::hybrid::InvariantBlocks;
using breakaway::stability::DoubleDouble;
using breakaway::stability::twofold::Matrix;

Matrix companion(const Eigen::MatrixXd& damping, const Eigen::MatrixXd& stiffness) {
  const Eigen::Index k = damping.rows();
  Matrix a = Matrix::Zero(2 * k, 2 * k);
  a.topRightCorner(k, k).setIdentity();
  a.bottomLeftCorner(k, k) = -stiffness.cast<DoubleDouble>();
  a.bottomRightCorner(k, k) = -damping.cast<DoubleDouble>();
  return a;
}

double largest_entry(const Matrix& matrix) { return static_cast<double>(matrix.cwiseAbs().maxCoeff()); }

TEST(DoubleDouble, CarriesThirtyOneDigits) {
  const DoubleDouble third = DoubleDouble(1) / 3, root = sqrt(DoubleDouble(2));
  EXPECT_LT(std::abs(static_cast<double>(third * 3 - 1)), 1e-31);
  EXPECT_LT(std::abs(static_cast<double>(root * root - 2)), 1e-31);
  // 1 + 1e-20 keeps its second term, and a large sum that cancels leaves it.
  const DoubleDouble small = 1e-20;
  EXPECT_EQ(static_cast<double>((1 + small) - 1), 1e-20);
  EXPECT_EQ(static_cast<double>((1e8 + small) - 1e8), 1e-20);
}

TEST(InvariantBlocks, CutEveryTimeScaleOfAStiffMachineApart) {
  const Eigen::Matrix2d damping = Eigen::Vector2d{0.25, 0.5}.asDiagonal();
  const Eigen::Matrix2d stiffness = (Eigen::Matrix2d{} << 1e24, -1e12, -1e12, 4).finished();
  const InvariantBlocks blocks = invariant_blocks(companion(damping, stiffness));
  EXPECT_EQ(blocks.sizes, (std::vector<Eigen::Index>{2, 2}));
  // The slow pair: the stiff coordinate follows the other as 1e-12, which leaves k = 4 - 1e-12 1e12 = 3.
  const Matrix slow = blocks.generator.bottomRightCorner(2, 2);
  EXPECT_NEAR(static_cast<double>(slow(0, 0) * slow(1, 1) - slow(0, 1) * slow(1, 0)), 3, 1e-14);
  EXPECT_NEAR(static_cast<double>(slow(0, 0) + slow(1, 1)), -0.5, 1e-14);
}

// Beside 1 kg a light mass moves slowly in three ways, which in the metric of momentum look like two.
TEST(InvariantBlocks, TellTheSlowMotionsOfALightMassApart) {
  const double light_kg = 1e-12;
  const Eigen::Matrix2d to_unit_mass = Eigen::Vector2d{1 / std::sqrt(light_kg), 1}.asDiagonal();
  const Eigen::Matrix2d damping = (Eigen::Matrix2d{} << 1.875, 0.1875, 0.1875, 0.625).finished();
  const Eigen::Matrix2d stiffness = (Eigen::Matrix2d{} << 10.75, -1.875, -1.875, 1.625).finished();
  const Matrix a = companion(to_unit_mass * damping * to_unit_mass, to_unit_mass * stiffness * to_unit_mass);
  const InvariantBlocks blocks = invariant_blocks(a);
  EXPECT_EQ(blocks.sizes, (std::vector<Eigen::Index>{1, 1, 2}));
  EXPECT_LT(largest_entry(blocks.generator.bottomRightCorner(3, 3)), 20);
}

TEST(InvariantBlocks, RestoreTheMatrix) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Index k = 1 + trial % 6;
    const auto matrix = [&] { return Eigen::MatrixXd::NullaryExpr(k, k, [&] { return uniform(random); }).eval(); };
    const Matrix a = companion(matrix(), matrix());
    const InvariantBlocks blocks = invariant_blocks(a);
    EXPECT_LT(largest_entry(a * blocks.basis - blocks.basis * blocks.generator), 1e-27) << "trial " << trial;
    EXPECT_LT(largest_entry(breakaway::stability::twofold::inverse(blocks.basis)), 1e4) << "trial " << trial;
  }
}

// q1 drives q2, and both have the same frequency: a Jordan block of size four.
TEST(InvariantBlocks, KeepADefectiveClusterTogetherAndNothingElse) {
  Eigen::Matrix3d stiffness = Eigen::Vector3d{1, 1, 9}.asDiagonal();
  stiffness(1, 0) = -1;
  const InvariantBlocks blocks = invariant_blocks(companion(Eigen::Matrix3d::Zero(), stiffness));
  EXPECT_EQ(std::ranges::count(blocks.sizes, 4), 1);
  EXPECT_EQ(std::ranges::count(blocks.sizes, 2), 1);
}

TEST(InvariantBlocks, AnExchangeKeepsTheSpan) {
  Matrix form(3, 3), basis = Matrix::Identity(3, 3);
  form << -1, 2, 3, 0, 0.5, 4, 0, -1, 0.5;
  const Matrix before = form;
  ASSERT_TRUE(breakaway::hybrid::exchange(form, basis, 0, 1, 2));
  EXPECT_LT(largest_entry(before * basis - basis * form), 1e-29);
  EXPECT_NEAR(static_cast<double>(form(2, 2)), -1, 1e-15);
  EXPECT_EQ(largest_entry(form.bottomLeftCorner(1, 2)), 0);
}

// x' = [-1 s; 0 -1] x: e^-t (x1 + s t x2, x2).
TEST(DenseBlock, FollowsAJordanBlockOverAnyTime) {
  for (const double s : {0.5, 1.0, 1e3}) {
    Matrix form(2, 2);
    form << -1, s, 0, -1;
    const DenseBlock block(form);
    EXPECT_TRUE(block.decays());
    for (const double t : {1e-9, 0.1, 1.0, 20.0, 700.0}) {
      double x[] = {0, 1}, sum[] = {0, 0};
      block.propagate(t, x, sum);
      const double decay = std::exp(-t);
      EXPECT_NEAR(x[0], s * t * decay, 1e-13 * s * std::max(t * decay, 1e-300));
      EXPECT_NEAR(x[1], decay, 1e-13 * decay);
      EXPECT_NEAR(sum[1], -std::expm1(-t), 1e-14);
      EXPECT_NEAR(sum[0], s * (t < 1e-3 ? t * t / 2 * (1 - 2 * t / 3) : 1 - (1 + t) * decay), 1e-14 * s);
      // What is promised about the norm holds: now, and for ever.
      const double start[] = {0, 1};
      EXPECT_LE(block.amplitude(x), block.amplitude(start) * std::exp(block.rate() * t) * (1 + 1e-12));
      EXPECT_LE(block.amplitude(x), block.amplitude(start) * block.growth() * (1 + 1e-12));
    }
  }
}

}  // namespace
}  // namespace invariant_blocks_test
