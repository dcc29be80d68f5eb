#include "breakaway/design/k3_table_builder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <random>
#include <string>

#include "../refusal.hpp"

namespace {

using breakaway::design::build_k3_table;
using breakaway::design::fourth_derivative_ranges;
using breakaway::design::K3;
using breakaway::design::KickPlant;
using breakaway::design::measured_error;
using breakaway::testing::refusal;

constexpr KickPlant<double> example{1.0, 1.0, 3.0, 2.5};  // section V of [I]: c_lower = 2.5, c_upper = 4.5
constexpr double example_range_m = 4.5;

TEST(K3TableBuilder, KeepsThePromisedAccuracyInFloat) {
  double worst_proved = 0, worst_measured = 0;
  for (const double zeta : {1 + 1e-12, 1.1, 1.5, 3.0, 6.0, 10.0}) {
    for (const double ratio : {1.0, 0.5556, 0.3, 0.1}) {
      const KickPlant<double> plant{1.0, 1.0, 2 * zeta, 2.5};
      const auto built = build_k3_table<float>(plant, 2.5 / ratio);
      const double measured = measured_error(built.table, plant);
      EXPECT_LE(built.size_bytes, 2150U);
      EXPECT_LE(built.proved_error, 4e-7) << "zeta " << zeta << " ratio " << ratio;
      EXPECT_LE(measured, built.proved_error) << "zeta " << zeta << " ratio " << ratio;
      worst_proved = std::max(worst_proved, built.proved_error);
      worst_measured = std::max(worst_measured, measured);
    }
  }
  std::cout << "float: proved " << worst_proved << ", measured " << worst_measured << '\n';
}

// The worst corner again with other masses, stiffnesses and forces, which move every rounding.
TEST(K3TableBuilder, KeepsThePromisedAccuracyInEveryUnit) {
  std::mt19937 random(20240603);
  std::uniform_real_distribution<double> exponent(-3, 3);
  for (int i = 0; i < 200; ++i) {
    const double m = std::pow(10, exponent(random)), k1 = std::pow(10, exponent(random)),
                 f = std::pow(10, exponent(random));
    const KickPlant<double> plant{m, k1, 20 * std::sqrt(m * k1), f};
    const auto built = build_k3_table<float>(plant, f / k1 / 0.1);
    EXPECT_LE(built.proved_error, 4e-7) << "m " << m << " k1 " << k1 << " f " << f;
    EXPECT_LE(measured_error(built.table, plant), built.proved_error);
  }
}

TEST(K3TableBuilder, ReachesTheTheoreticalErrorInDouble) {
  const auto built = build_k3_table<double>(example, example_range_m);
  EXPECT_LE(built.proved_error, 2e-12);
  const double measured = measured_error(built.table, example);
  EXPECT_LE(measured, built.proved_error);
  // The proof is not idle: it is within a quarter of what is found.
  EXPECT_GE(measured, 0.8 * built.proved_error);
  std::cout << "double, example: proved " << built.proved_error << ", measured " << measured << '\n';
}

// Random points, also very close to the target, that are no sample points of the builder.
TEST(K3TableBuilder, HoldsItsProofAtRandomErrors) {
  const auto built = build_k3_table<float>(example, example_range_m);
  const auto law = K3<double>::make(example);
  std::mt19937 random(20240604);
  std::uniform_real_distribution<double> root(0, std::sqrt(example_range_m)), exponent(-30, 0);
  for (int i = 0; i < 1000000; ++i) {
    const double s = root(random);
    const auto y = static_cast<float>(i % 4 == 0 ? example_range_m * std::pow(10, exponent(random)) : s * s);
    const double error = static_cast<double>(built.table.impulse_Ns(y)) / law.impulse_Ns(y) - 1;
    ASSERT_LE(std::fabs(error), built.proved_error) << "y " << y;
  }
}

TEST(K3TableBuilder, CoversTheWholeRange) {
  const auto built = build_k3_table<float>(example, example_range_m);
  const auto law = K3<double>::make(example);
  EXPECT_GE(built.table.root_max, std::sqrt(4.5F));
  EXPECT_LE(built.table.root_max * built.table.nodes_per_root, static_cast<float>(built.table.nodes.size() - 1));
  EXPECT_NEAR(static_cast<double>(built.table.impulse_Ns(-4.5F)) / law.impulse_Ns(-4.5), 1, built.proved_error);
}

TEST(K3Smoothness, BoundsTheFourthDerivative) {
  for (const double zeta : {1 + 1e-9, 1.5, 10.0, 1e4}) {
    const auto law = K3<double>::make({1.0, 1.0, 2 * zeta, 1.0});
    const double spacing = 0.25;
    const auto ranges = fourth_derivative_ranges(law.unit(), spacing, 40);
    const auto psi = [&](double r) { return law.unit().at_root(r).psi; };
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double r = (static_cast<double>(i) + 0.5) * spacing, h = spacing / 4;
      const double difference =
          (psi(r - 2 * h) - 4 * psi(r - h) + 6 * psi(r) - 4 * psi(r + h) + psi(r + 2 * h)) / std::pow(h, 4);
      // A fourth difference is the fourth derivative somewhere in the interval; rounding adds 16 eps psi / h^4.
      const double rounding = 16 * std::numeric_limits<double>::epsilon() * psi(r) / std::pow(h, 4);
      EXPECT_GE(difference, ranges[i].least - rounding) << "zeta " << zeta << " r " << r;
      EXPECT_LE(difference, ranges[i].greatest + rounding) << "zeta " << zeta << " r " << r;
      // And no idle bound: the derivative itself changes by up to 0.014 over one interval.
      EXPECT_LE(ranges[i].greatest - ranges[i].least, 0.02) << "zeta " << zeta << " r " << r;
    }
  }
}

TEST(K3TableBuilder, RefusesBadInputByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [](const KickPlant<double>& plant, double range_m) {
    return refusal([&] { build_k3_table<float>(plant, range_m); });
  };
  EXPECT_NE(message({1, 1, 2, 1}, 1).find("zeta > 1"), std::string::npos);
  EXPECT_NE(message(example, 0).find("range_m is 0"), std::string::npos);
  EXPECT_NE(message(example, nan).find("range_m is nan"), std::string::npos);
  EXPECT_NE(message({1, 1, 3, 1e60}, 1e60).find("use double or check the units"), std::string::npos);
  EXPECT_NE(message({1e-60, 1, 3, 1e-60}, 1e-60).find("use double"), std::string::npos);
  EXPECT_NO_THROW(build_k3_table<double>({1, 1, 3, 1e60}, 1e60));
}

// Each of these has one number of the table, and no other, that no float can hold with all its digits.
TEST(K3TableBuilder, RefusesARangeWhoseGridOrFirstSlopeIsBeyondAFloat) {
  const std::string so_near = refusal([] { build_k3_table<float>(example, 1e-74); });
  EXPECT_NE(so_near.find("the k3 table up to 1e-74 m"), std::string::npos) << "the slope at rest: " << so_near;
  EXPECT_NO_THROW(build_k3_table<double>(example, 1e-74));
  const std::string so_far = refusal([] { build_k3_table<float, 2>(example, 9e76); });
  EXPECT_NE(so_far.find("the k3 table up to 9e+76 m"), std::string::npos) << "one interval a root: " << so_far;
}

}  // namespace
