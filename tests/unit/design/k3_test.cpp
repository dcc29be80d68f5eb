#include "breakaway/design/k3.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "../refusal.hpp"

namespace {

using breakaway::InputError;
using breakaway::design::K3;
using breakaway::design::KickPlant;
using breakaway::testing::refusal;

struct Row {
  KickPlant<double> plant;
  double distance_m, impulse_Ns, time_to_go_s;
};

// tests/reference/k3.csv, made by tests/reference/k3.py.
std::vector<Row> reference_rows() {
  std::ifstream file(BREAKAWAY_SOURCE_DIR "/tests/reference/k3.csv");
  std::string line;
  std::getline(file, line);
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    std::array<double, 7> v{};
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    for (double& value : v) {
      std::string word;
      words >> word;
      value = std::stod(word);
    }
    rows.push_back({{v[0], v[1], v[2], v[3]}, v[4], v[5], v[6]});
  }
  return rows;
}

double relative_error(double value, double reference) { return std::fabs(value / reference - 1); }

constexpr KickPlant<double> example{1.0, 1.0, 3.0, 2.5};  // section V of [I]

TEST(K3, AgreesWithHighPrecisionReferenceTo1em14) {
  const auto rows = reference_rows();
  ASSERT_GT(rows.size(), 1500U);
  double worst_impulse = 0, worst_time = 0, worst_speed = 0;
  for (const Row& row : rows) {
    const auto law = K3<double>::make(row.plant);
    worst_impulse = std::max(worst_impulse, relative_error(law.impulse_Ns(-row.distance_m), row.impulse_Ns));
    worst_speed =
        std::max(worst_speed, relative_error(law.speed_m_s(row.distance_m) * row.plant.mass_kg, row.impulse_Ns));
    worst_time = std::max(worst_time, relative_error(law.time_to_go_s(row.distance_m), row.time_to_go_s));
    ASSERT_FALSE(std::isnan(worst_impulse + worst_time));
  }
  RecordProperty("worst_impulse", std::to_string(worst_impulse * 1e15) + "e-15");
  RecordProperty("worst_time", std::to_string(worst_time * 1e15) + "e-15");
  std::cout << "worst relative error: impulse " << worst_impulse << ", speed " << worst_speed << ", time to go "
            << worst_time << '\n';
  EXPECT_LE(worst_impulse, 1e-14);
  EXPECT_LE(worst_speed, 1e-14);
  EXPECT_LE(worst_time, 1e-14);
}

// Nothing where the law is refused.
template <class Scalar>
std::optional<K3<Scalar>> made(const KickPlant<Scalar>& plant) {
  try {
    return K3<Scalar>::make(plant);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// The same inputs in both precisions: the float law against the double one. 8e-7 is 13 units of roundoff.
TEST(K3, KeepsFloatAccuracyInFloat) {
  std::mt19937 random(20240602);
  const auto power = [&](float low, float high) {
    return std::pow(10.0F, std::uniform_real_distribution<float>(low, high)(random));
  };
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const float m = power(-3, 3), k1 = power(-3, 3), f = power(-3, 3);
    const float k22 = 2 * std::sqrt(m * k1) * (1 + power(-6.5F, 6));
    const float y = f / k1 * power(i % 2 == 0 ? -28.0F : -3.0F, 6);
    const auto in_float = made<float>({m, k1, k22, f});
    const auto in_double = made<double>({m, k1, k22, f});
    ASSERT_EQ(in_float.has_value(), in_double.has_value());
    if (!in_float) continue;
    worst = std::max({worst, relative_error(in_float->impulse_Ns(y), in_double->impulse_Ns(y)),
                      relative_error(in_float->time_to_go_s(y), in_double->time_to_go_s(y))});
    ASSERT_FALSE(std::isnan(in_float->impulse_Ns(y)));
  }
  std::cout << "worst relative error in float: " << worst << '\n';
  EXPECT_LE(worst, 8e-7);
}

TEST(K3, IsOddAndOpposesTheError) {
  const auto law = K3<double>::make(example);
  EXPECT_EQ(law.impulse_Ns(0.0), 0.0);
  EXPECT_EQ(law.time_to_go_s(0.0), 0.0);
  for (double y = 1e-300; y < 10; y *= 7) {
    EXPECT_LT(law.impulse_Ns(y), 0);
    EXPECT_EQ(law.impulse_Ns(-y), -law.impulse_Ns(y));
    EXPECT_EQ(law.speed_m_s(-y), law.speed_m_s(y));
  }
  EXPECT_TRUE(std::isnan(law.impulse_Ns(std::numeric_limits<double>::quiet_NaN())));
}

TEST(K3, GrowsWithTheError) {
  for (const double zeta : {1 + 1e-14, 1.001, 1.5, 30.0, 1e6}) {
    const auto law = K3<double>::make({1.0, 1.0, 2 * zeta, 2.5});
    double impulse = 0, time = 0;
    for (double y = 1e-12; y < 1e4; y *= 1.01) {
      EXPECT_GT(law.impulse_Ns(-y), impulse) << "zeta " << zeta << " y " << y;
      EXPECT_GT(law.time_to_go_s(-y), time) << "zeta " << zeta << " y " << y;
      impulse = law.impulse_Ns(-y);
      time = law.time_to_go_s(-y);
    }
  }
}

// (y, f) -> c (y, f) scales the impulse by c and leaves the time alone: exact for powers of 4, whose roots are exact.
TEST(K3, ScalesExactlyWithForceAndDistance) {
  const auto law = K3<double>::make(example);
  for (int k = -80; k <= 80; k += 2) {
    const auto scaled = K3<double>::make({1.0, 1.0, 3.0, std::ldexp(2.5, k)});
    for (const double y : {1e-9, 0.1, 2.5, 4.5}) {
      EXPECT_EQ(scaled.impulse_Ns(std::ldexp(-y, k)), std::ldexp(law.impulse_Ns(-y), k));
      EXPECT_EQ(scaled.time_to_go_s(std::ldexp(-y, k)), law.time_to_go_s(-y));
    }
  }
}

// With a vanishing error the PD forces vanish too: the kick against friction alone is sqrt(2 m f |y|).
TEST(K3, TendsToTheFrictionOnlyKickNearTheTarget) {
  const auto law = K3<double>::make({0.3, 7.0, 11.0, 2.5});
  EXPECT_NEAR(law.impulse_Ns(-1e-40) / std::sqrt(2 * 0.3 * 2.5 * 1e-40), 1, 4e-16);
  EXPECT_NEAR(law.reduced(0) / std::sqrt(2 * 0.3 * 2.5), 1, 4e-16);
}

// Motion from the kick under f_lower, integrated by fourth-order Runge-Kutta, ends on the target at rest.
TEST(K3, BringsTheAxisToRestOnTheTarget) {
  const auto law = K3<double>::make(example);
  const double start = -2.0, time = law.time_to_go_s(start);
  double x = start, v = law.impulse_Ns(start) / example.mass_kg;
  const auto acceleration = [](double position, double velocity) { return -position - 3 * velocity - 2.5; };
  const int steps = 20000;
  const double h = time / steps;
  for (int i = 0; i < steps; ++i) {
    const double a1 = acceleration(x, v), v2 = v + h / 2 * a1;
    const double a2 = acceleration(x + h / 2 * v, v2), v3 = v + h / 2 * a2;
    const double a3 = acceleration(x + h / 2 * v2, v3), v4 = v + h * a3;
    const double a4 = acceleration(x + h * v3, v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  EXPECT_NEAR(x, 0, 1e-12);
  EXPECT_NEAR(v, 0, 1e-12);
}

TEST(K3, ReducedSlopeIsTheDerivative) {
  for (const double zeta : {1 + 1e-12, 1.5, 10.0}) {
    const auto law = K3<double>::make({0.7, 3.0, 2 * zeta * std::sqrt(0.7 * 3.0), 2.5});
    for (const double s : {0.0, 1e-9, 1e-4, 0.01, 0.1, 0.5, 2.0}) {
      // A one-sided difference of third order: error about h^3, and rounding / h.
      const double h = 1e-4;
      const double r0 = law.reduced(s), r1 = law.reduced(s + h), r2 = law.reduced(s + 2 * h),
                   r3 = law.reduced(s + 3 * h);
      const double slope = (-11 * r0 + 18 * r1 - 9 * r2 + 2 * r3) / (6 * h);
      EXPECT_NEAR(law.reduced_slope(s) / slope, 1, 1e-8) << "zeta " << zeta << " s " << s;
    }
  }
}

TEST(K3, RefusesWhatIsNotAnOverdampedAxisByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  struct Case {
    KickPlant<double> plant;
    const char* named;
  };
  const std::vector<Case> cases{
      {{0, 1, 3, 1}, "mass_kg is 0"},
      {{nan, 1, 3, 1}, "mass_kg is nan"},
      {{1, -1, 3, 1}, "stiffness k1 is -1"},
      {{1, 1, inf, 1}, "damping k22 is inf"},
      {{1, 1, 3, 0}, "friction_lower_N is 0"},
      {{1, 1, 2, 1}, "zeta = k22 / (2 sqrt(k1 m)) = 1;"},
      {{1, 1, 1.9, 1}, "zeta > 1: raise k22 above 2"},
      {{1e300, 1e300, 3, 1}, "zeta > 1"},
  };
  for (const Case& c : cases) {
    const std::string message = refusal([&] { K3<double>::make(c.plant); });
    EXPECT_NE(message.find(c.named), std::string::npos) << c.named << " in: " << message;
  }
  EXPECT_NO_THROW(K3<double>::make({1, 1, std::nextafter(2.0, 3.0), 1}));
}

// (1 + e)(1 - e) = 1 - e^2 rounds to 1, so only exact products tell that 2^2 > 4 k1 m.
TEST(K3, TellsTheSidesOfCriticalDampingApart) {
  const double e = std::numeric_limits<double>::epsilon();
  EXPECT_NO_THROW(K3<double>::make({1 + e, 1 - e, 2.0, 1.0}));
  EXPECT_THROW(K3<double>::make({1.0, 1.0, 2.0, 1.0}), InputError);
  EXPECT_THROW(K3<double>::make({1 + e, 1 - e / 2, 2.0, 1.0}), InputError);
  const auto barely = K3<double>::make({1 + e, 1 - e, 2.0, 2.5});
  const auto clearly = K3<double>::make({1.0, 1.0, 2 + 4 * e, 2.5});
  EXPECT_NEAR(barely.impulse_Ns(-3) / clearly.impulse_Ns(-3), 1, 1e-14);
}

// The limit of equal poles: W = s e^s and Q = s e^s - e^s + 1 for the time to go s.
TEST(UnitKick, HasTheLawOfCriticalDampingWhereBothPolesAreTheSame) {
  constexpr breakaway::design::UnitKick<double> critical{.rho = 1, .epsilon = 0};
  for (const double s : {0.5, 1.5, 2.0, 4.0}) {
    const double speed = s * std::exp(s), distance = speed - std::expm1(s), root = std::sqrt(2 * distance);
    const auto point = critical.at_root(root);
    EXPECT_NEAR(point.psi, speed / root, 1e-13 * speed / root) << s;
    EXPECT_NEAR(point.sigma, s, 1e-13) << s;
  }
}

}  // namespace
