// One machine in two systems of units: what is certified and where it can rest and escape is the same, to the last bit
// where the units are powers of two.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "breakaway/stability/escape.hpp"
#include "random_systems.hpp"
#include "unit_twin.hpp"

namespace units_test {
namespace {

using namespace breakaway::stability;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double reach = 20;  // powers of two: coordinates differ by up to 1e12, masses by 1e24

struct Twins {
  LinearMachine<> given, twin;
  OtherUnits units;
};

template <class Expect>
void for_twins(bool powers, int trials, Expect&& expect) {
  std::mt19937_64 random{77};
  std::uniform_int_distribution<Index> size{1, 5};
  for (int trial = 0; trial < trials; ++trial) {
    const Index n = size(random), m = size(random);
    const LinearMachine<> s = trial % 2 == 0 ? random_theorem_1_system(random, n, m) : random_weak_system(random, n, m);
    const OtherUnits units = random_units(random, n, 0, reach, powers);
    SCOPED_TRACE(trial);
    expect(Twins{s, units.machine(s), units});
  }
}

TEST(Units, OfPowersOfTwoChangeNoBitOfACertificate) {
  for_twins(true, 100, [](const Twins& t) {
    const Attractivity a = certify_attractivity(t.given), b = certify_attractivity(t.twin);
    EXPECT_EQ(a.certified, b.certified);
    EXPECT_EQ(a.rho_star_J * t.units.force, b.rho_star_J);
    EXPECT_EQ(a.level_J * t.units.force, b.level_J);
    EXPECT_EQ(a.greatest_rest_J * t.units.force, b.greatest_rest_J);
    ASSERT_EQ(a.conditions.size(), b.conditions.size());
    for (std::size_t i = 0; i < a.conditions.size(); ++i)
      EXPECT_EQ(a.conditions[i].holds, b.conditions[i].holds) << a.conditions[i].name;
  });
}

TEST(Units, OfPowersOfTwoChangeNoBitOfTheRests) {
  for_twins(true, 100, [](const Twins& t) {
    const auto a = EquilibriumSet::make(t.given), b = EquilibriumSet::make(t.twin);
    EXPECT_EQ(a.extent(), t.units.length.cwiseProduct(b.extent()));
    const auto corners = a.vertices(), other = b.vertices();
    ASSERT_EQ(corners.cols(), other.cols());
    EXPECT_EQ(corners, t.units.length.asDiagonal() * other);
    if (t.given.frictions() < t.given.coordinates()) return;
    const VectorXd q = corners.col(0) / 3;
    EXPECT_EQ(a.gauge(q), b.gauge(q.cwiseQuotient(t.units.length)));
  });
}

TEST(Units, ChangeNoLevelOfEscape) {
  int found = 0;
  for (const bool powers : {true, false}) {
    for_twins(powers, 100, [&](const Twins& t) {
      const auto a = escape_levels(t.given), b = escape_levels(t.twin);
      ASSERT_EQ(a.size(), b.size());
      found += static_cast<int>(a.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_NEAR(b[i].growth_rate / (t.units.time * a[i].growth_rate), 1, powers ? 0 : 1e-9);
        // The level is about z, and z has the unit of w: what does not depend on it is which states are lost.
        const Index n = t.given.coordinates();
        const VectorXd q = VectorXd::LinSpaced(n, 1, 2), v = VectorXd::LinSpaced(n, -1, 3);
        const VectorXd q2 = q.cwiseQuotient(t.units.length), v2 = v.cwiseQuotient(t.units.length) * t.units.time;
        const auto size = [&](const EscapeLevel& mode, const VectorXd& at, const VectorXd& rate) {
          return std::hypot(mode.real.head(n).dot(at) + mode.real.tail(n).dot(rate),
                            mode.imaginary.head(n).dot(at) + mode.imaginary.tail(n).dot(rate)) /
                 mode.level;
        };
        EXPECT_NEAR(size(b[i], q2, v2) / size(a[i], q, v), 1, 1e-7);
      }
    });
  }
  EXPECT_GT(found, 100);
}

// Two equal masses with a spring between them: the free motion of both is a defective eigenvalue 0, which rounding
// splits into +-1e-10. Friction stops it from anywhere.
TEST(Units, LetNoFreeMotionEscape) {
  std::mt19937_64 random{5};
  for (int trial = 0; trial < 50; ++trial) {
    LinearMachine<> s;
    s.mass = Eigen::Matrix2d{{1.1, 0}, {0, 0.7}};
    s.damping = Eigen::Matrix2d::Zero();
    s.stiffness = Eigen::Matrix2d{{3.3, -3.3}, {-3.3, 3.3}};
    s.directions = Eigen::Matrix2d::Identity();
    s.friction_N = Eigen::Vector2d::Ones();
    EXPECT_TRUE(escape_levels(random_units(random, 2, 0, reach, false).machine(s)).empty()) << trial;
  }
}

// The first coordinate is driven by the second one's place and not the other way: a force that turns without end.
TEST(Units, TakeASkewPartOfTheSpringsForWhatItIs) {
  LinearMachine<> s;
  s.mass = s.stiffness = s.directions = Eigen::Matrix2d::Identity();
  s.damping = Eigen::Matrix2d::Zero();
  s.friction_N = Eigen::Vector2d::Ones();
  s.stiffness(0, 1) = s.stiffness(1, 0) = 0.1;
  EXPECT_TRUE(certify_attractivity(s).certified);
  s.stiffness(1, 0) = std::nextafter(0.1, 1.0);  // both may be the same decimal number, computed elsewhere
  EXPECT_TRUE(certify_attractivity(s).certified);
  s.stiffness(1, 0) = 0.1 * (1 + 1e-14);
  const Attractivity a = certify_attractivity(s);
  EXPECT_EQ(a.level_J, 0);
  EXPECT_NE(a.reason.find("stiffness is not symmetric"), std::string::npos) << a.reason;
}

}  // namespace
}  // namespace units_test
