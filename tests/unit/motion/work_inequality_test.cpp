// Theorem E of controller/design/THEORY.md: after a pulse from rest friction has not taken more than the work of the
// pulse and what the spring gave back. Friction of at least A a side takes A for each length.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <string>

#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/compliant_axis.hpp"

namespace breakaway::motion {
namespace {

constexpr double pulse_period_s = 1e-3;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : bits_{seed} {}
  double between(double low, double high) { return std::uniform_real_distribution<>{low, high}(bits_); }
  double decades(double low, double high) { return low * std::pow(high / low, between(0, 1)); }

 private:
  std::mt19937_64 bits_;
};

model::ShapePtr shape(Draw& draw) {
  switch (static_cast<int>(draw.between(0, 5))) {
    case 0:
      return model::shape::constant(draw.between(0, 1));
    case 1:
      return model::shape::stribeck(draw.decades(1e-3, 0.1));
    case 2:
      return model::shape::static_kinetic(1, 0);
    case 3:
      return model::shape::sine_in_position(draw.decades(1e-5, 1e-2), draw.between(0, 6));
    default:
      return model::shape::sine_in_time(draw.decades(1, 1000), draw.between(0, 6));
  }
}

struct Kind {
  const char* name;
  bool load, gap;
};

class WorkInequality : public ::testing::TestWithParam<Kind> {
 protected:
  // An axis at rest, its bounds of friction, and what holds it together.
  struct Plant {
    model::CompliantPlant equations;
    double A1, A2;
    model::FrictionLaw friction;
  };

  static Plant plant(Draw& draw, const Kind& kind) {
    const double A1 = draw.decades(0.5, 5), A2 = draw.decades(0.5, 5);
    const auto law = [&](double least_N) {
      return model::FrictionLaw{{least_N, least_N * draw.between(1, 2.5)}, shape(draw)};
    };
    Plant p{.equations = {.mass_kg = draw.decades(0.1, 10)}, .A1 = A1, .A2 = kind.load ? A2 : 0, .friction = law(A1)};
    if (!kind.load) return p;
    model::FlexibleLoad load{.mass_kg = draw.decades(0.1, 10), .coupling = {}, .friction = law(A2)};
    const double w = 2 * 3.14159265358979 * draw.decades(10, 300);
    load.coupling.stiffness_N_per_m = w * w / (1 / p.equations.mass_kg + 1 / load.mass_kg);
    load.coupling.damping_Ns_per_m = draw.between(0, 0.1) * load.coupling.stiffness_N_per_m / w;
    load.coupling.gap_m = kind.gap ? draw.decades(1e-6, 1e-3) : 0;
    p.equations.load = load;
    return p;
  }
};

// The two sides of the theorem, less each other, by the energies that flow.
double residual(const CompliantState& from, const CompliantState& now, const model::CompliantPlant& plant, double A1,
                double A2, double work_J) {
  const auto& load = plant.load;
  const double kinetic_J = plant.mass_kg * now.velocity_m_s * now.velocity_m_s / 2 +
                           (load ? load->mass_kg * now.load_velocity_m_s * now.load_velocity_m_s / 2 : 0);
  const auto spring_J = [&](const CompliantState& at) {
    return load ? load->coupling.energy_J(at.position_m - at.load_position_m) : 0;
  };
  const double d1 = std::abs(now.position_m - from.position_m),
               d2 = load ? std::abs(now.load_position_m - from.load_position_m) : 0;
  const double left_J = work_J + spring_J(from) - spring_J(now) - kinetic_J - A1 * d1 - A2 * d2;
  return left_J / (std::abs(work_J) + spring_J(from) + 1e-30);
}

TEST_P(WorkInequality, HoldsAtEveryInstantAfterAPulse) {
  double least = INFINITY, closest = INFINITY;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Draw draw{seed};
    const Plant p = plant(draw, GetParam());
    CompliantAxis axis{p.equations, p.friction, {}};
    double t = 0;
    const auto advance = [&](double force_N) {
      t += pulse_period_s;
      axis.advance_to(t, {.constant_N = force_N, .start_s = t - pulse_period_s});
    };
    for (int kick = 0; kick < 4; ++kick) {
      for (int rest = 0; rest < 3000 && !axis.sticking(); ++rest) advance(0);
      if (!axis.sticking()) break;
      const CompliantState from = axis.state();
      const double force_N = draw.decades(1, 20) * (p.A1 + p.A2) * (draw.between(0, 1) < 0.3 ? -1 : 1);
      const int periods = static_cast<int>(draw.decades(1, 60));
      for (int k = 0; k < periods; ++k) advance(force_N);
      const double work_J = force_N * (axis.state().position_m - from.position_m);
      for (int k = 0; k < 200; ++k) {
        if (work_J > 0) {
          const double now = residual(from, axis.state(), p.equations, p.A1, p.A2, work_J);
          least = std::min(least, now);
          closest = std::min(closest, std::abs(now));
          ASSERT_GE(now, -1e-9) << "seed " << seed << ", kick " << kick << ", " << k << " periods after its pulse";
        }
        advance(0);
      }
    }
  }
  EXPECT_LT(closest, GetParam().load ? 0.3 : 1e-9) << "a bound that nothing comes near shows little";
}

INSTANTIATE_TEST_SUITE_P(Plants, WorkInequality,
                         ::testing::Values(Kind{"Rigid", false, false}, Kind{"Flexible", true, false},
                                           Kind{"Loose", true, true}),
                         [](const auto& kind) { return std::string{kind.param.name}; });

}  // namespace
}  // namespace breakaway::motion
