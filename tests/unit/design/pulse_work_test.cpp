#include "breakaway/design/pulse_work.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>

#include "../../campaign/environment.hpp"

namespace breakaway::design {
namespace {

struct Bounds {
  double least_N, most_N;
};

struct Joint {
  std::array<double, 2> mass_kg;
  std::array<Bounds, 2> friction;
  double stiffness_N_per_m, gap_m, lag_s;

  double sum_N() const { return friction[0].least_N + friction[1].least_N; }
  double held_N() const { return std::min(friction[0].most_N, friction[1].most_N); }
  double swing_s() const {
    return 2 * std::numbers::pi / std::sqrt(stiffness_N_per_m * (1 / mass_kg[0] + 1 / mass_kg[1]));
  }
  PulseWork work() const {
    return {.motor_kg = mass_kg[0],
            .load_kg = mass_kg[1],
            .stiffness_N_per_m = stiffness_N_per_m,
            .gap_m = gap_m,
            .motor_friction_N = friction[0].least_N,
            .load_friction_N = friction[1].least_N,
            .held_N = held_N(),
            .lag_s = lag_s};
  }
  // What the spring may add to the load's way: the corollary of Theorem E.
  double spring_J() const {
    const double pulled_N = held_N() + friction[0].least_N;
    return pulled_N * pulled_N / (2 * stiffness_N_per_m) + friction[0].least_N * gap_m;
  }
};

// How friction of either side chooses between its bounds.
enum class Adversary : std::uint8_t { least, greatest_back, pumping, holding_the_load, at_random, kinds };

struct Outcome {
  double motor_m, furthest_load_m;  // the motor when the pulse ends, the load at any time
};

class Trial {
 public:
  Trial(const Joint& joint, Adversary adversary, std::mt19937_64& bits)
      : joint_{joint}, adversary_{adversary}, bits_{bits} {}

  Outcome run(double force_N, double pulse_s, double bent_m) {
    x_ = {bent_m, 0};
    const double h = std::min(joint_.swing_s(), pulse_s) / 1500;
    Outcome end{0, 0};
    double u = 0;
    const double follow = joint_.lag_s > 0 ? 1 - std::exp(-h / joint_.lag_s) : 1;
    const long pulse = std::lround(pulse_s / h), most = 40 * pulse + 60000;
    for (long i = 0; i < most; ++i) {
      u += follow * ((i < pulse ? force_N : 0) - u);
      step(u, h, i);
      if (i + 1 == pulse) end.motor_m = x_[0] - bent_m;
      end.furthest_load_m = std::max(end.furthest_load_m, x_[1]);
      if (i > pulse && v_[0] == 0 && v_[1] == 0 && u < 1e-9 * force_N) break;
    }
    return end;
  }

 private:
  double friction_N(std::size_t side, long i) {
    const Bounds& f = joint_.friction[side];
    switch (adversary_) {
      case Adversary::greatest_back:
        return v_[side] < 0 ? f.most_N : f.least_N;
      case Adversary::pumping:
        return (v_[side] > v_[1 - side]) == (side == 0) ? f.least_N : f.most_N;
      case Adversary::holding_the_load:
        return side == 1 && v_[1] == 0 ? f.most_N : f.least_N;
      case Adversary::at_random:
        if (i % 50 == 0) share_[side] = unit_(bits_);
        return f.least_N + share_[side] * (f.most_N - f.least_N);
      case Adversary::least:
      case Adversary::kinds:
        break;
    }
    return f.least_N;
  }

  void step(double push_N, double h, long i) {
    const double apart_m = x_[0] - x_[1], half_m = joint_.gap_m / 2;
    const double spring_N = joint_.stiffness_N_per_m * (apart_m - std::clamp(apart_m, -half_m, half_m));
    const std::array<double, 2> on_N{push_N - spring_N, spring_N};
    const std::array<double, 2> against_N{friction_N(0, i), friction_N(1, i)};
    for (std::size_t side = 0; side < 2; ++side) {
      const double free_m_s = v_[side] + on_N[side] * h / joint_.mass_kg[side];
      const double most_m_s = against_N[side] * h / joint_.mass_kg[side];
      v_[side] = free_m_s - std::clamp(free_m_s, -most_m_s, most_m_s);
      x_[side] += h * v_[side];
    }
  }

  const Joint& joint_;
  Adversary adversary_;
  std::mt19937_64& bits_;
  std::uniform_real_distribution<double> unit_{0, 1};
  std::array<double, 2> x_{}, v_{}, share_{};
};

// Any joint, what is told of it, and a pulse from any rest.
struct Draw {
  explicit Draw(std::mt19937_64& bits) {
    std::uniform_real_distribution<double> unit{0, 1};
    const auto share = [&] { return unit(bits); };
    const auto between = [&](double a, double b) { return a + share() * (b - a); };
    const auto decades = [&](double a, double b) { return a * std::pow(b / a, share()); };
    const double rho = decades(0.05, 20), side = between(0.05, 0.95), A = between(0.3, 0.98);
    told = {.mass_kg = {1 / (1 + rho), rho / (1 + rho)},
            .friction = {{{side * A, side}, {(1 - side) * A, 1 - side}}},
            .stiffness_N_per_m = 1000,
            .gap_m = share() < 0.5 ? 0 : decades(1e-5, 1e-2),
            .lag_s = 0};
    told.lag_s = share() < 0.5 ? 0 : 0.1 * told.swing_s() * share();
    pulse_s = told.swing_s() * decades(0.1, 5);
    force_N = decades(1.002, 30);
    truth = told;
    if (share() < 0.5) truth.stiffness_N_per_m *= decades(1, 30);
    if (share() < 0.5) truth.gap_m *= share();
    if (share() < 0.5) truth.lag_s *= share();
    const double bent = share() < 0.5 ? -1 : between(-1, 1);
    bent_m = bent * (truth.held_N() / truth.stiffness_N_per_m + truth.gap_m / 2);
  }
  Joint told{}, truth{};
  double pulse_s = 0, force_N = 0, bent_m = 0;
};

// Joints that are stiffer than stated, from any rest, under frictions that choose as they like.
TEST(PulseWork, IsNeverExceededByAFrictionOrAStiffness) {
  std::mt19937_64 bits{29};
  double fullest_travel = 0, fullest_way = 0;
  for (long number = 0, pulses = campaign::from_environment("BREAKAWAY_WORK_PULSES", 400); number < pulses; ++number) {
    const Draw draw{bits};
    const auto adversary = static_cast<Adversary>(number % static_cast<long>(Adversary::kinds));
    const Outcome end = Trial{draw.truth, adversary, bits}.run(draw.force_N, draw.pulse_s, draw.bent_m);
    const PulseWork bound = draw.told.work();
    const double travel_m = bound.most_travel_m(draw.force_N, draw.pulse_s);
    const double way_m = (bound.most_J(draw.force_N, draw.pulse_s) + draw.told.spring_J()) / draw.told.sum_N();
    EXPECT_LE(end.motor_m, travel_m) << "pulse " << number;
    EXPECT_LE(end.furthest_load_m, way_m) << "pulse " << number;
    fullest_travel = std::max(fullest_travel, end.motor_m / travel_m);
    fullest_way = std::max(fullest_way, end.furthest_load_m / way_m);
  }
  EXPECT_GT(fullest_travel, 0.9) << "the bound is far from what there is";
  EXPECT_GT(fullest_way, 0.7);
}

// An axis of the class that the bound stands for: it may be heavier in all, stiffer, tighter and quicker.
PulseWork inside(const PulseWork& told, std::mt19937_64& bits) {
  std::uniform_real_distribution<double> unit{0, 1};
  const double heavier = 1 + 0.3 * unit(bits);
  PulseWork axis = told;
  axis.motor_kg *= heavier;
  axis.load_kg *= heavier;
  axis.stiffness_N_per_m *= std::pow(30, unit(bits));
  axis.gap_m *= unit(bits);
  axis.lag_s *= unit(bits);
  return axis;
}

TEST(PulseWork, OfEachAxisOfAClassIsAtMostThatOfTheLightestAndSoftest) {
  std::mt19937_64 bits{31};
  for (int number = 0; number < 20000; ++number) {
    const Draw draw{bits};
    const PulseWork told = draw.told.work(), axis = inside(told, bits);
    const double travel_m = told.most_travel_m(draw.force_N, draw.pulse_s),
                 work_J = told.most_J(draw.force_N, draw.pulse_s);
    ASSERT_LE(axis.most_travel_m(draw.force_N, draw.pulse_s), travel_m * (1 + 1e-12)) << "pulse " << number;
    ASSERT_LE(axis.most_J(draw.force_N, draw.pulse_s), work_J * (1 + 1e-12)) << "pulse " << number;
  }
}

// So a class of axes with loads of several shares has no lightest one.
TEST(PulseWork, MayRiseAsTheLoadAloneGetsHeavier) {
  const PulseWork told{.motor_kg = 1,
                       .load_kg = 0.434,
                       .stiffness_N_per_m = 220033,
                       .gap_m = 0,
                       .motor_friction_N = 7.009,
                       .load_friction_N = 0.7014,
                       .held_N = 1.267,
                       .lag_s = 0.539e-3};
  PulseWork heavier = told;
  heavier.load_kg *= 1.1;
  EXPECT_GT(heavier.most_travel_m(75.37, 5.393e-3), told.most_travel_m(75.37, 5.393e-3));
  heavier.motor_kg *= 1.1;
  EXPECT_LT(heavier.most_travel_m(75.37, 5.393e-3), told.most_travel_m(75.37, 5.393e-3));
}

TEST(PulseWork, OfARigidAxisIsForceTimesItsTravel) {
  const PulseWork stiff{.motor_kg = 0.4,
                        .load_kg = 0.6,
                        .stiffness_N_per_m = 1e18,
                        .gap_m = 0,
                        .motor_friction_N = 1,
                        .load_friction_N = 1.5,
                        .held_N = 2,
                        .lag_s = 0};
  const double travel_m = (10 - 2.5) * 0.02 * 0.02 / 2;
  EXPECT_NEAR(stiff.most_travel_m(10, 0.02), travel_m, 1e-6 * travel_m);
  EXPECT_NEAR(stiff.most_J(10, 0.02), 10 * travel_m, 1e-5 * travel_m);
}

}  // namespace
}  // namespace breakaway::design
