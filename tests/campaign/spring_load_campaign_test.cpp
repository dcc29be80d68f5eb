// Axes whose load hangs on a spring, stiff enough that the law for one rigid mass is certified: motor and load on
// friction of every kind, each on its own, seen by an encoder on either side.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "../two_mass_axis.hpp"
#include "certified_axis.hpp"
#include "random_braked_axis.hpp"

namespace breakaway::campaign {
namespace {

using design::SpringLoad;
using testing::RunEnd;

// The part of the friction of the whole that is one side's.
BrakedClass side_of(const BrakedClass& c, const law::FrictionBounds<double>& friction) {
  BrakedClass side = c;
  side.friction = friction;
  return side;
}

// A random axis whose mass and friction are shared by motor and load; its spring is still to be chosen.
BrakedClass random_sprung_axes(Random& r) {
  BrakedClass c = random_axes(r);
  SpringLoad load;
  const double m = (c.mass_kg.least + c.mass_kg.most) / 2, rho = r.decades(0.1, 10);
  load.motor_kg = m / (1 + rho);
  load.load_kg = m - load.motor_kg;
  const double share = r.between(0.1, 0.9);
  c.load_N = std::min(c.load_N, 0.9 * share * c.friction.lower_N);  // it acts on the motor
  load.motor_friction = {share * c.friction.lower_N, share * c.friction.upper_N};
  load.load_friction = {(1 - share) * c.friction.lower_N, (1 - share) * c.friction.upper_N};
  load.encoder_on_load = r.share() < 0.5;
  load.stiffness_N_per_m = 1;
  c.spring_load = load;
  return c;
}

// The spring with which the load resonates at this frequency.
void tune(SpringLoad& load, double resonance_Hz) {
  load.stiffness_N_per_m *= std::pow(resonance_Hz / load.resonance_Hz(), 2);
}

struct Tally {
  long runs = 0, most_kicks = 0;
  double beyond = 0;
};

void run(long number, const BrakedClass& c, double tolerance_m, Random& r, Tally& tally) {
  const auto design = design::design_braked_kicks<float>(c);
  const design::BrakedPromise promise = *report_of(c, tolerance_m).braked;
  const law::K3Table<float> unused;
  for (int kind = 0; kind < kinds; ++kind) {
    const testing::TrueAxis truth{r.inside(c.mass_kg), r.inside(c.force_gain), r.inside(c.lag_s),
                                  r.inside({-c.load_N, c.load_N}), c.latency_periods};
    SpringLoad load = *c.spring_load;
    const double heavier = truth.mass_kg / (load.motor_kg + load.load_kg);
    load.motor_kg *= heavier;
    load.load_kg *= heavier;
    load.stiffness_N_per_m *= r.share() < 0.6 ? 1 : r.decades(1, 4);
    const double start_m = std::min(design.floor_m * std::pow(10, 3 * r.share()), 1.0) * (r.share() < 0.5 ? 1 : -1);
    const double length_m = std::max(3 * design.floor_m, c.encoder_resolution_m);
    const auto seed = static_cast<std::uint64_t>(number * kinds + kind);
    const int other_kind = r.share() < 0.5 ? kind : static_cast<int>(kinds * r.share());
    const std::array<Friction, 2> friction{
        friction_of_kind(kind, side_of(c, load.motor_friction), seed, length_m, tolerance_m),
        friction_of_kind(other_kind, side_of(c, load.load_friction), seed + 1, length_m, tolerance_m)};
    const double damping = r.share() < 0.4 ? 0.002 : r.decades(0.005, 0.5);
    const double longest_s = promise.kicks_s + 3000 * c.period_s +
                             20 * std::sqrt(std::fabs(start_m) * c.mass_kg.most / c.friction.lower_N) + 1;
    double out_of_sight_m = 0;
    const RunEnd end =
        testing::run_axis<float>(parameters(c, tolerance_m), unused, design.kicks,
                                 testing::TwoMassAxis{load, damping, truth, friction, start_m, &out_of_sight_m},
                                 c.latency_periods, longest_s, 1, 100, r.between(-0.5, 0.5), {}, disturbance(c, r));
    ++tally.runs;
    tally.most_kicks = std::max<long>(tally.most_kicks, end.kicks);
    tally.beyond = std::max(tally.beyond, end.beyond_m / promise.beyond_m);
    const std::string where =
        "axis " + std::to_string(number) + ", friction " + std::to_string(kind) + " and " + std::to_string(other_kind);
    EXPECT_TRUE(end.held) << where << ": " << to_string(end.fault) << ", error " << end.error_m << ", " << end.kicks
                          << " kicks";
    EXPECT_LE(std::fabs(end.error_m), promise.error_m * (1 + 1e-6)) << where;
    EXPECT_LE(end.beyond_m, promise.beyond_m * (1 + 1e-6)) << where;
    EXPECT_LE(std::fabs(out_of_sight_m - end.error_m), load.unseen_m(c.load_N) * (1 + 1e-6)) << where;
  }
}

TEST(SpringLoadCampaign, EveryCertifiedAxisKeepsItsPromise) {
  const long first = asked_for("BREAKAWAY_FIRST", 0), axes = asked_for("BREAKAWAY_SPRUNG_AXES", 20);
  Tally tally;
  long certified = 0;
  for (long number = first; number < first + axes; ++number) {
    Random r{static_cast<std::uint64_t>(number)};
    BrakedClass c = random_sprung_axes(r);
    BrakedClass whole = c;
    whole.spring_load.reset();
    const auto rigid = design::design_braked_kicks<float>(whole);
    if (!rigid.possible()) continue;
    const double tolerance_m = rigid.least_tolerance_m * (r.share() < 0.3 ? 1.001 : r.decades(1.001, 30));
    const double safe_Hz = design::spring_demand(c, rigid).safe_from_Hz(c, tolerance_m);
    if (safe_Hz * c.period_s > 50) continue;  // of which a run takes minutes
    tune(*c.spring_load, safe_Hz * (r.share() < 0.5 ? 1.0001 : r.decades(1.0001, 5)));
    if (!report_of(c, tolerance_m).certified) continue;
    ++certified;
    run(number, c, tolerance_m, r, tally);
  }
  std::printf("%ld of %ld axes certified, %ld runs, at most %ld kicks, at most %.3f of what may be beyond\n", certified,
              axes, tally.runs, tally.most_kicks, tally.beyond);
  EXPECT_GE(certified, axes / 20);
}

}  // namespace
}  // namespace breakaway::campaign
