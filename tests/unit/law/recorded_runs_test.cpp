// The flashed law behaves as it did when campaigns tested it: the runs of recorded_run.hpp, over axes, frictions,
// samples and targets of every kind, and the same runs the other way round.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "../../bristled_axis.hpp"
#include "../../campaign/random_braked_axis.hpp"
#include "../../two_mass_axis.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/design/pd_kicks.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "law_fixture.hpp"
#include "recorded_run.hpp"

namespace breakaway::law {
namespace {

using breakaway::testing::axes_of_the_scenes;
using breakaway::testing::BristledSlider;
using breakaway::testing::Bristles;
using breakaway::testing::Friction;
using breakaway::testing::Moment;
using breakaway::testing::Slider;
using breakaway::testing::TrueAxis;
using breakaway::testing::TwoMassAxis;
using campaign::Random;
using design::BrakedClass;
using testing::Circumstances;
using testing::expect_recorded;
using testing::Figures;
using testing::recorded_run;

constexpr int longest_periods = 1500;

// Each test is about one axis, which its number draws, and runs it under each kind of friction.
class RecordedRun : public ::testing::TestWithParam<int> {
 protected:
  template <class Axis>
  static void for_each_friction(const char* name) {
    Random r{static_cast<std::uint64_t>(GetParam())};
    const Axis axis{r};
    for (int kind = 0; kind < campaign::kinds; ++kind) {
      const int number = campaign::kinds * GetParam() + kind;
      expect_recorded(name + std::string{" "} + std::to_string(number),
                      axis.run(r, kind, static_cast<std::uint64_t>(number)));
    }
  }
};

const K3Table<float> no_k3{};

struct BrakedAxis {
  BrakedClass axes;
  design::BrakedDesign<float> design;
  AxisParameters<float> p;
};

BrakedAxis braked_axis_of(const BrakedClass& c, double tolerances = 1) {
  const auto design = design::design_braked_kicks<float>(c);
  return {c, design, campaign::parameters(c, tolerances * design.least_tolerance_m)};
}

BrakedAxis random_axis(Random& r) {
  for (;;) {
    // One statement each: which argument of a call is drawn first is the compiler's choice.
    const double tolerances = r.share() < 0.5 ? 1 : r.between(1, 4);
    const auto axis = braked_axis_of(campaign::random_axes(r), tolerances);
    if (axis.design.possible()) return axis;
  }
}

// Where the axis starts, and what happens on the way: now and then its target moves, it is pushed, its drive weakens or
// its law is reset.
double random_start_m(Random& r, const BrakedAxis& axis) {
  const double side = r.share() < 0.5 ? 1 : -1;
  if (r.share() < 0.5) return side * std::min(axis.design.floor_m * std::pow(10, 4 * r.share()), 1.0);
  return side * design::kicks_begin_m(axis.design) * std::pow(100, r.share());
}

Circumstances random_circumstances(Random& r, const BrakedAxis& axis) {
  const BrakedClass& c = axis.axes;
  Circumstances now;
  now.latency_periods = c.latency_periods;
  now.longest_s = longest_periods * c.period_s;
  now.encoder_offset = r.between(-0.5, 0.5);
  now.lost_each = r.share() < 0.3 ? 20 : 0;
  now.noise_counts = c.encoder_noise_m > 0 ? 1 : 0;
  const double event = r.share(), way_m = design::kicks_begin_m(axis.design) * r.decades(0.01, 3);
  const double signed_way_m = r.share() < 0.5 ? way_m : -way_m;
  if (event < 0.7) now.at_period = static_cast<int>(r.decades(1, 700));
  if (event < 0.3)
    now.told_m = signed_way_m;
  else if (event < 0.5)
    now.pushed_m = signed_way_m;
  else if (event < 0.65)
    now.limited_N = c.friction.upper_N + (c.max_force_N - c.friction.upper_N) * r.share();
  else if (event < 0.7)
    now.reset = true;
  return now;
}

struct LawfulAxis {
  explicit LawfulAxis(Random& r) : axis{random_axis(r)} {}
  Figures run(Random& r, int kind, std::uint64_t seed) const {
    const BrakedClass& c = axis.axes;
    const TrueAxis truth{r.inside(c.mass_kg), r.inside(c.force_gain), r.inside(c.lag_s),
                         r.inside({-c.load_N, c.load_N}), c.latency_periods};
    const double length_m = std::max(3 * axis.design.floor_m, c.encoder_resolution_m);
    const auto friction = campaign::friction_of_kind(kind, c, seed, length_m, axis.design.least_tolerance_m);
    const double start_m = random_start_m(r, axis);
    const auto circumstances = random_circumstances(r, axis);
    return recorded_run(axis.p, no_k3, axis.design.kicks, Slider{truth, friction, start_m, 0}, circumstances);
  }
  BrakedAxis axis;
};
class LawfulRun : public RecordedRun {};
TEST_P(LawfulRun, OfARandomAxisIsAsItWasCertified) { for_each_friction<LawfulAxis>("lawful"); }
INSTANTIATE_TEST_SUITE_P(Axis, LawfulRun, ::testing::Range(0, 14));

// It is not what was told, so that the run may end in a fault.
struct WrongAxis {
  explicit WrongAxis(Random& r) : axis{random_axis(r)} {}
  Figures run(Random& r, int kind, std::uint64_t seed) const {
    const campaign::Wrong wrong{axis.axes, r};
    BrakedClass truly = axis.axes;
    truly.friction = wrong.friction;
    const double length_m = std::max(3 * axis.design.floor_m, truly.encoder_resolution_m);
    const auto friction = campaign::friction_of_kind(kind, truly, seed, length_m, axis.design.least_tolerance_m);
    const double start_m = random_start_m(r, axis);
    auto circumstances = random_circumstances(r, axis);
    circumstances.latency_periods = wrong.axis.latency_periods;
    return recorded_run(axis.p, no_k3, axis.design.kicks, Slider{wrong.axis, friction, start_m, 0}, circumstances);
  }
  BrakedAxis axis;
};
class WrongRun : public RecordedRun {};
TEST_P(WrongRun, OfARandomAxisIsAsItWas) { for_each_friction<WrongAxis>("wrong"); }
INSTANTIATE_TEST_SUITE_P(Axis, WrongRun, ::testing::Range(20, 34));

struct MovedAxis {
  explicit MovedAxis(Random& r) {
    BrakedClass c = axes_of_the_scenes(r.share() < 0.5 ? 0 : 1e-3 * r.share());
    const double acceleration = r.decades(2, 30);
    c.move = design::MoveRequest{r.decades(1e-3, 0.5), r.decades(0.1, 2), acceleration, {}};
    if (r.share() < 0.6) c.move->jerk_m_s3 = acceleration * r.decades(20, 400);
    c.latency_periods = static_cast<int>(r.between(0, 3.99));
    axis = braked_axis_of(c);
    axis.p.max_approach_speed_m_s = r.share() < 0.5 ? 1e6F : static_cast<float>(c.move->speed_m_s / 2);
  }
  Figures run(Random& r, int kind, std::uint64_t seed) const {
    const BrakedClass& c = axis.axes;
    const TrueAxis truth{1, 1, c.lag_s.most, 0, c.latency_periods};
    const auto friction = campaign::friction_of_kind(kind, c, seed, 1e-5, 2.5e-6);
    const double start_m = r.share() < 0.5 ? c.move->distance_m : -c.move->distance_m;
    return recorded_run(axis.p, no_k3, axis.design.kicks, Slider{truth, friction, start_m, 0}, circumstances(r));
  }
  Circumstances circumstances(Random& r) const {
    const double move_s = design::least_move_s(*axis.axes.move);
    Circumstances now;
    now.latency_periods = axis.axes.latency_periods;
    now.longest_s = 1.5;
    now.lost_each = r.share() < 0.3 ? 20 : 0;
    now.at_period = static_cast<int>(1000 * move_s * r.between(0.05, 1.3));
    const double event = r.share();
    if (event < 0.7)
      now.told_m = axis.axes.move->distance_m * r.between(-1, 0.7);
    else if (event < 0.85)
      now.limited_N = r.between(10, 50);
    if (r.share() < 0.3) now.take_s = move_s * r.decades(0.9, 40);
    return now;
  }
  BrakedAxis axis;
};
class MoveRun : public RecordedRun {};
TEST_P(MoveRun, IsAsItWasCertified) { for_each_friction<MovedAxis>("move"); }
INSTANTIATE_TEST_SUITE_P(Axis, MoveRun, ::testing::Range(0, 12));

// At 4 ms the floor is 24 um, below which the fine stage goes on.
struct FineAxis {
  explicit FineAxis(Random& r) {
    BrakedClass c = axes_of_the_scenes(r.share() < 0.6 ? 0 : r.decades(1e-4, 4e-3));
    c.period_s = 4e-3;
    c.fine_tolerance_m = r.share() < 0.5 ? 0.6e-6 : 3e-6;
    axis = braked_axis_of(c);
    axis.p.position_tolerance_m = static_cast<float>(c.fine_tolerance_m);
  }
  Figures run(Random& r, int kind, std::uint64_t seed) const {
    const TrueAxis truth{1, 1, axis.axes.lag_s.most, 0, 1};
    const auto friction = campaign::friction_of_kind(kind, axis.axes, seed, 3e-5, 0.6e-6);
    const double start_m = random_start_m(r, axis);
    return recorded_run(axis.p, no_k3, axis.design.kicks, Slider{truth, friction, start_m, 0},
                        random_circumstances(r, axis));
  }
  BrakedAxis axis;
};
class FineRun : public RecordedRun {};
TEST_P(FineRun, IsAsItWas) { for_each_friction<FineAxis>("fine"); }
INSTANTIATE_TEST_SUITE_P(Axis, FineRun, ::testing::Range(0, 6));

// Friction that is a spring before it slides.
struct BentAxis {
  explicit BentAxis(Random& r) : bristles{r.decades(1e5, 1e7), r.share() < 0.5 ? 0.0 : 600.0, 1e-5} {
    BrakedClass c = axes_of_the_scenes(0);
    c.presliding_stiffness_N_per_m = bristles.stiffness_N_per_m * (r.share() < 0.5 ? 1 : r.decades(0.2, 2));
    axis = braked_axis_of(c);
    axis.p.position_tolerance_m = r.share() < 0.5 ? 0.7e-6F : 2.5e-6F;
  }
  Figures run(Random& r, int kind, std::uint64_t seed) const {
    const auto friction = campaign::friction_of_kind(kind % 4, axis.axes, seed, 3e-5, 0.6e-6);
    auto circumstances = random_circumstances(r, axis);
    circumstances.longest_s = 2;
    const double side = r.share() < 0.5 ? 1 : -1, start_m = side * r.decades(2e-6, 5e-3);
    return recorded_run(axis.p, no_k3, axis.design.kicks, BristledSlider{{}, bristles, friction, start_m, 0},
                        circumstances);
  }
  Bristles bristles;
  BrakedAxis axis;
};
class SpringRun : public RecordedRun {};
TEST_P(SpringRun, IsAsItWas) { for_each_friction<BentAxis>("spring"); }
INSTANTIATE_TEST_SUITE_P(Axis, SpringRun, ::testing::Range(0, 8));

// A motor and a load that swing 15 to 100 times a second.
BrakedClass random_belt(Random& r) {
  BrakedClass c = axes_of_the_scenes(r.share() < 0.5 ? 0 : 2e-4 * r.share());
  const double motor_kg = r.between(0.1, 0.9), share = r.between(0.2, 0.8);
  design::SpringLoad load{.motor_kg = motor_kg,
                          .load_kg = 1 - motor_kg,
                          .stiffness_N_per_m = 1,
                          .motor_friction = {share * 2.5, share * 4.5},
                          .load_friction = {(1 - share) * 2.5, (1 - share) * 4.5}};
  load.stiffness_N_per_m = std::pow(r.decades(15, 100) / load.resonance_Hz(), 2);
  load.gap_m = r.share() < 0.5 ? 0 : 1e-4 * r.share();
  load.encoder_on_load = r.share() < 0.3;
  c.spring_load = load;
  c.latency_periods = static_cast<int>(r.between(0, 2.99));
  return c;
}

struct Belt {
  explicit Belt(Random& r) {
    do {
      c = random_belt(r);
      design = design::design_work_kicks<float>(c);
    } while (!design.possible());
  }
  Figures run(Random& r, int /*kind*/, std::uint64_t /*seed*/) const {
    auto p = campaign::parameters(c, design.least_tolerance_m * (r.share() < 0.7 ? 1 : 0.3));
    p.coast = Coast::work;
    p.max_approach_speed_m_s = r.share() < 0.5 ? 10 : 0.2F;
    const double worst = r.share() < 0.3 ? 3 : 1;
    const double motor_N = r.inside({c.spring_load->motor_friction.lower_N, c.spring_load->motor_friction.upper_N});
    const double load_N = r.inside({c.spring_load->load_friction.lower_N, c.spring_load->load_friction.upper_N});
    const double motor_level_N = motor_N * r.decades(1 / worst, worst), load_level_N = load_N * r.decades(1, worst);
    const std::array<Friction, 2> friction{[=](const Moment&) { return motor_level_N; },
                                           [=](const Moment&) { return load_level_N; }};
    const double side = r.share() < 0.5 ? 1 : -1, start_m = side * r.decades(1e-4, 0.1);
    return recorded_run(p, no_k3, design.kicks,
                        TwoMassAxis{*c.spring_load, 0.02, {1, 1, c.lag_s.most}, friction, start_m}, circumstances(r));
  }
  Circumstances circumstances(Random& r) const {
    Circumstances now;
    now.latency_periods = c.latency_periods;
    now.lost_each = r.share() < 0.3 ? 20 : 0;
    now.longest_s = 1;
    if (r.share() < 0.6) now.at_period = static_cast<int>(r.decades(1, 700));
    const double way_m = r.between(-1, 1) * r.decades(1e-4, 0.1), event = r.share();
    if (event < 0.4)
      now.told_m = way_m;
    else if (event < 0.7)
      now.pushed_m = way_m;
    else
      now.limited_N = r.between(5, 60);
    return now;
  }
  BrakedClass c;
  design::WorkDesign<float> design;
};
class WorkRun : public RecordedRun {};
TEST_P(WorkRun, IsAsItWas) { for_each_friction<Belt>("work"); }
INSTANTIATE_TEST_SUITE_P(Axis, WorkRun, ::testing::Range(0, 12));

// The coast "pd".
K3Table<float> k3_of(const AxisParameters<float>& p) {
  return design::build_k3_table<float>({static_cast<double>(p.mass_kg), 400, 60, 2.5},
                                       static_cast<double>(p.stick_radius_upper_m()))
      .table;
}

struct PdAxis {
  explicit PdAxis(Random& r) : p{testing::sampled_axis<float>()} {
    p.mass_kg = static_cast<float>(r.between(0.7, 2));
    p.latency_periods = static_cast<std::uint8_t>(r.between(0, 3.99));
    const auto aim = r.share() < 0.2 ? design::PulseAim::k3 : design::PulseAim::target;
    if (r.share() < 0.3) p.feedforward_N = static_cast<float>(r.between(-1, 1));
    k3 = k3_of(p);
    kicks.table = design::design_pd_kicks(p, 0, aim).table;
  }
  Figures run(Random& r, int kind, std::uint64_t seed) const {
    BrakedClass c = axes_of_the_scenes(0);
    const bool wrong = r.share() < 0.4;
    if (wrong) c.friction = {2.5 * r.decades(0.3, 1), 4.5 * r.decades(1, 3)};
    const double mass_kg = static_cast<double>(p.mass_kg) * (wrong ? r.decades(0.5, 2) : 1);
    const TrueAxis truth{mass_kg, 1, 0, -static_cast<double>(p.feedforward_N), p.latency_periods};
    const auto friction = campaign::friction_of_kind(kind, c, seed, 1e-5, 1.8e-6);
    const double side = r.share() < 0.5 ? 1 : -1, start_m = side * r.decades(2e-6, 0.5);
    return recorded_run(p, k3, kicks, Slider{truth, friction, start_m, 0}, circumstances(r));
  }
  Circumstances circumstances(Random& r) const {
    Circumstances now;
    now.latency_periods = p.latency_periods;
    now.lost_each = r.share() < 0.3 ? 20 : 0;
    now.longest_s = 1.5;
    now.encoder_offset = r.between(-0.5, 0.5);
    const double event = r.share(), way_m = r.between(-1, 1) * r.decades(1e-5, 0.1);
    if (event < 0.6) now.at_period = static_cast<int>(r.decades(1, 1000));
    if (event < 0.2)
      now.told_m = way_m;
    else if (event < 0.4)
      now.pushed_m = way_m;
    else if (event < 0.55)
      now.limited_N = r.between(3, 60);
    else if (event < 0.6)
      now.reset = true;
    return now;
  }
  AxisParameters<float> p;
  K3Table<float> k3;
  BrakedKicks<float> kicks;
};
class PdRun : public RecordedRun {};
TEST_P(PdRun, IsAsItWas) { for_each_friction<PdAxis>("pd"); }
INSTANTIATE_TEST_SUITE_P(Axis, PdRun, ::testing::Range(0, 14));

// The law knows no side: what an axis does from one side of its target it does from the other, to the last bit.
void expect_mirrored(const Figures& one, const Figures& other) { EXPECT_EQ(one.all(), other.mirrored().all()); }

// Those whose friction does not tell one side from the other.
constexpr int frictions_without_a_side = 5;

void run_either_way(const BrakedAxis& axis, double start_m, double told_m) {
  for (int kind = 0; kind < frictions_without_a_side; ++kind) {
    const auto run = [&](double side) {
      const auto friction = campaign::friction_of_kind(kind, axis.axes, 1, 1e-5, 1e-6);
      Circumstances c{.latency_periods = axis.axes.latency_periods, .longest_s = 2};
      if (told_m != 0) c.at_period = 150, c.told_m = side * told_m;
      const TrueAxis truth{1, 1, axis.axes.lag_s.most, 0, 1};
      return recorded_run(axis.p, no_k3, axis.design.kicks, Slider{truth, friction, side * start_m, 0}, c);
    };
    expect_mirrored(run(1), run(-1));
  }
}

TEST(MirroredRun, UnderTheBrakeIsTheSame) {
  for (const double lag_s : {0.0, 1e-3, 5e-3}) {
    for (const double fine_m : {0.0, 0.6e-6}) {
      BrakedClass c = axes_of_the_scenes(lag_s);
      if (fine_m > 0) c.period_s = 4e-3;
      c.fine_tolerance_m = fine_m;
      const BrakedAxis axis = braked_axis_of(c);
      for (const double start_m : {1.0, 0.1, 3e-3, 1e-4}) {
        run_either_way(axis, start_m, 0);
        run_either_way(axis, start_m, 2e-3);
      }
    }
  }
}

// But half a step of the drive's force counts as one upwards on either side: none of these accelerations takes one.
TEST(MirroredRun, OfAMoveIsTheSame) {
  for (const double jerk_m_s3 : {0.0, 2000.0}) {
    BrakedClass c = axes_of_the_scenes(1e-4);
    c.move = design::MoveRequest{0.2, 1, 20.004, {}};
    if (jerk_m_s3 > 0) c.move->jerk_m_s3 = jerk_m_s3;
    for (const double told_m : {0.0, 0.1, -0.1, -0.3}) run_either_way(braked_axis_of(c), 0.2, told_m);
  }
}

TEST(MirroredRun, UnderPdIsTheSame) {
  const auto p = testing::sampled_axis<float>();
  const auto k3 = k3_of(p);
  BrakedKicks<float> kicks;
  kicks.table = design::design_pd_kicks(p).table;
  for (const double start_m : {0.4, 0.05, 3e-3, 1e-4, 1e-5}) {
    for (int kind = 0; kind < frictions_without_a_side; ++kind) {
      const auto run = [&](double side) {
        const auto friction = campaign::friction_of_kind(kind, axes_of_the_scenes(0), 1, 1e-5, 1e-6);
        return recorded_run(p, k3, kicks, Slider{{}, friction, side * start_m, 0}, {});
      };
      expect_mirrored(run(1), run(-1));
    }
  }
}

TEST(MirroredRun, OnASpringIsTheSame) {
  Random r{3};
  const Belt belt{r};
  auto p = campaign::parameters(belt.c, belt.design.least_tolerance_m);
  p.coast = Coast::work;
  const auto& load = *belt.c.spring_load;
  for (const double start_m : {0.1, 0.01, 1e-3}) {
    for (const double share : {0.0, 0.5, 1.0}) {
      const auto level = [share](const FrictionBounds<double>& f) -> Friction {
        return [=](const Moment&) { return f.lower_N + share * (f.upper_N - f.lower_N); };
      };
      const auto run = [&](double side) {
        return recorded_run(p, no_k3, belt.design.kicks,
                            TwoMassAxis{load,
                                        0.02,
                                        {1, 1, belt.c.lag_s.most},
                                        {level(load.motor_friction), level(load.load_friction)},
                                        side * start_m},
                            {.latency_periods = belt.c.latency_periods});
      };
      expect_mirrored(run(1), run(-1));
    }
  }
}

}  // namespace
}  // namespace breakaway::law
