// The certificates as their own adversaries: one machine in two systems of units or seen in a mirror, gains that are
// designed and then certified and followed anew, and motions from just beyond a level of escape.
//   BREAKAWAY_FIRST_SYSTEM=0 BREAKAWAY_SYSTEMS=100000 tests/campaign/wild_twins_test
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "../unit/refusal.hpp"
#include "../unit/stability/unit_twin.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/stability/synthesis.hpp"
#include "environment.hpp"
#include "followed_motion.hpp"
#include "wild_machines.hpp"

namespace {

using namespace breakaway;
using campaign::End;
using campaign::from_environment;
using campaign::WildMachines;
using Eigen::Index;
using Eigen::VectorXd;
using stability::LinearMachine;
using stability::OtherUnits;
using State = hybrid::MachineState<Eigen::Dynamic>;

constexpr double reach = 20;  // powers of two, so that coordinates differ by up to 1e12

double spread_of_motions() { return campaign::number_from_environment("BREAKAWAY_SPREAD", 0.25); }

long first_system() { return from_environment("BREAKAWAY_FIRST_SYSTEM", 0); }

// With every second coordinate turned round, and every third actuator.
OtherUnits mirrored(OtherUnits units) {
  for (Index i = 0; i < units.length.size(); i += 2) units.length[i] *= -1;
  for (Index i = 0; i < units.actuator.size(); i += 3) units.actuator[i] *= -1;
  return units;
}

std::string told(const stability::Attractivity& a) {
  return (a.certified ? "certified" : a.reason) + ", level " + std::to_string(a.level_J) + ", rho* " +
         std::to_string(a.rho_star_J);
}

std::vector<double> growth_rates(const LinearMachine<>& machine) {
  std::vector<double> rates;
  for (const stability::EscapeLevel& mode : stability::escape_levels(machine)) rates.push_back(mode.growth_rate);
  std::ranges::sort(rates);
  return rates;
}

// Powers of two change no bit. What is left and right may, of a level by rounding: the decompositions look at signs.
void expect_same(const LinearMachine<>& machine, const OtherUnits& units, double tolerance, const std::string& label) {
  const LinearMachine<> twin = units.machine(machine);
  const auto a = stability::certify_attractivity(machine), b = stability::certify_attractivity(twin);
  const std::string both = label + ": " + told(a) + " : " + told(b);
  const auto same = [&](double x, double y) { return x == y || std::abs(x - y) <= tolerance * x; };
  EXPECT_EQ(a.certified, b.certified) << both;
  EXPECT_TRUE(same(a.greatest_rest_J * units.force, b.greatest_rest_J)) << both;
  // A damping that is negative by its rounding alone, in one of the two, has levels that are finite by rounding alone.
  const bool by_rounding =
      tolerance > 0 && a.certified && std::abs(a.eigenvalues[0]) <= 1e-12 * a.eigenvalues.cwiseAbs().maxCoeff();
  EXPECT_TRUE(by_rounding || same(a.level_J * units.force, b.level_J)) << both;
  EXPECT_TRUE(by_rounding || same(a.rho_star_J * units.force, b.rho_star_J)) << both;
  const std::vector<double> rates = growth_rates(machine), others = growth_rates(twin);
  ASSERT_EQ(rates.size(), others.size()) << label;
  for (std::size_t i = 0; i < rates.size(); ++i) EXPECT_NEAR(rates[i] * units.time / others[i], 1, tolerance) << label;
}

TEST(WildTwins, HaveTheSameCertificates) {
  const long first = first_system(), count = from_environment("BREAKAWAY_SYSTEMS", 300);
  for (long number = first; number < first + count; ++number) {
    WildMachines wild{static_cast<std::uint64_t>(number)};
    std::mt19937_64 random{static_cast<std::uint64_t>(number)};
    const LinearMachine<> machine = wild.machine();
    const OtherUnits units = stability::random_units(random, machine.coordinates(), 0, reach, true);
    expect_same(machine, units, 0, std::to_string(number));
    expect_same(machine, mirrored(units), 1e-6, std::to_string(number) + " in the mirror");
  }
}

struct Designed {
  stability::PdDesign design;
  std::string refused;
};

Designed designed(const stability::ActuatedSystem& system, double region_J) {
  Designed result;
  result.refused = breakaway::testing::refusal([&] {
    result.design = stability::synthesize(system, {.region_J = region_J}, stability::GainStructure::identical);
  });
  return result;
}

// Full gains call a program for every step of their search; the unit tests hold them to the same.
TEST(WildTwins, HaveTheSameGainsWhichHoldWhatTheyPromise) {
  const long first = first_system(), count = from_environment("BREAKAWAY_DESIGNS", 150);
  long met = 0, needed = 0, followed[4] = {};
  for (long number = first; number < first + count; ++number) {
    WildMachines wild{static_cast<std::uint64_t>(number), spread_of_motions()};
    std::mt19937_64 random{static_cast<std::uint64_t>(number)};
    const LinearMachine<> machine = wild.machine();
    const Index n = machine.coordinates(), k = 1 + number % n;
    const stability::ActuatedSystem system{machine, Eigen::MatrixXd::Identity(n, n).leftCols(k)};
    OtherUnits units = stability::random_units(random, n, k, reach, true);
    units.actuator.setOnes();
    const auto open = stability::certify_attractivity(machine);
    const double region_J = number % 2 == 0 ? std::numeric_limits<double>::infinity() : 2 * open.greatest_rest_J + 1e-3;
    const Designed one = designed(system, region_J), other = designed(units.system(system), region_J * units.force);
    SCOPED_TRACE(number);
    ASSERT_EQ(one.refused.empty(), other.refused.empty()) << one.refused << " : " << other.refused;
    if (!one.refused.empty()) continue;
    ++met;
    EXPECT_EQ(units.velocity_gain(one.design.gains.velocity_Ns_per_m), other.design.gains.velocity_Ns_per_m);
    if (one.design.gains.velocity_Ns_per_m.isZero(0)) continue;
    ++needed;
    std::string said;
    const End end = campaign::followed(one.design.closed_loop, one.design.attractivity, wild, said, 300);
    ++followed[static_cast<int>(end)];
    EXPECT_NE(end, End::grew) << said;
  }
  std::printf("%ld machines, %ld designed, %ld with gains: %ld at rest, %ld on their way, %ld refused, %ld grew\n",
              count, met, needed, followed[0], followed[1], followed[2], followed[3]);
  EXPECT_GT(needed, count / 20);
}

class Enough {};

double size_of(const stability::EscapeLevel& mode, const State& state) {
  const Index n = state.q.size();
  return std::hypot(mode.real.head(n).dot(state.q) + mode.real.tail(n).dot(state.v),
                    mode.imaginary.head(n).dot(state.q) + mode.imaginary.tail(n).dot(state.v));
}

// Other modes may have grown so far that z is a small difference of their numbers.
double rounding(const stability::EscapeLevel& mode, const State& state) {
  const Index n = state.q.size();
  return 1e-9 *
         std::hypot(state.q.cwiseQuotient(mode.unit.head(n)).norm(), state.v.cwiseQuotient(mode.unit.tail(n)).norm());
}

// Just beyond a level, at the place in its mode that is nearest in units of one size.
State beyond(const stability::EscapeLevel& mode) {
  const VectorXd along = mode.unit.cwiseAbs2().cwiseProduct(mode.real);
  const Index n = along.size() / 2;
  State start{0, along.head(n), along.tail(n)};
  const double wanted = mode.level > 0 ? 1.000001 * mode.level : 1, factor = wanted / size_of(mode, start);
  start.q *= factor;
  start.v *= factor;
  return start;
}

// Where a motion that must escape comes to rest, or back; empty if it does not.
std::string failure(const LinearMachine<>& machine, const stability::EscapeLevel& mode, int most_events) {
  std::string wrong;
  int events = 0;
  const hybrid::EventDriven<> integrator{
      machine, [&](const State& state) {
        if (!(size_of(mode, state) > mode.level * (1 - 1e-6) - rounding(mode, state))) {
          wrong = "it came back at event " + std::to_string(events);
        }
        if (++events > most_events) throw Enough{};
        return hybrid::Verdict::undecided;
      }};
  try {
    const auto outcome = integrator.run(beyond(mode), 10 / mode.growth_rate, nullptr, {}, hybrid::Budget{1e7});
    return outcome.verdict == hybrid::Verdict::at_rest ? "it came to rest" : wrong;
  } catch (const Enough&) {
    return wrong;
  }
}

TEST(WildTwins, BeyondALevelOfEscapeNothingComesToRest) {
  const long first = first_system(), count = from_environment("BREAKAWAY_SYSTEMS", 300);
  long levels = 0, refused = 0;
  for (long number = first; number < first + count; ++number) {
    WildMachines wild{static_cast<std::uint64_t>(number), spread_of_motions()};
    const LinearMachine<> machine = wild.machine();
    for (const stability::EscapeLevel& mode : stability::escape_levels(machine)) {
      ++levels;
      try {
        EXPECT_EQ(failure(machine, mode, 300), "") << number << ", " << mode.growth_rate << " 1/s";
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  std::printf("%ld machines, %ld levels of escape, %ld motions refused\n", count, levels, refused);
  EXPECT_GT(levels, count / 20);
}

}  // namespace
