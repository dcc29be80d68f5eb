// Certificates against the whole range of machines that they accept: by the power that dampers and friction take at the
// worst velocity that can be found, and by motions from just inside their levels.
//   BREAKAWAY_FIRST_SYSTEM=0 BREAKAWAY_SYSTEMS=100000 tests/campaign/wild_attraction_test
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "breakaway/sil/certificates.hpp"
#include "breakaway/sil/contradiction.hpp"
#include "environment.hpp"
#include "followed_motion.hpp"
#include "wild_machines.hpp"

namespace {

using namespace breakaway;
using campaign::End;
using campaign::followed;
using campaign::from_environment;
using campaign::WildMachines;
using Eigen::Index;
using Eigen::VectorXd;
using stability::LinearMachine;
using Extended = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using ExtendedVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

// The least kinetic energy along a velocity at which the damping gives what friction takes, in extended precision.
class BreakEven {
 public:
  explicit BreakEven(const LinearMachine<>& machine)
      : mass_{machine.mass.cast<long double>()},
        damping_{(machine.damping.cast<long double>() + machine.damping.transpose().cast<long double>()) / 2},
        directions_{machine.directions.cast<long double>()},
        friction_{machine.friction_N.cast<long double>()} {}

  double along_J(const VectorXd& v) const {
    const ExtendedVector x = v.cast<long double>(), size = x.cwiseAbs();
    const ExtendedVector damped = damping_ * x, terms = damping_.cwiseAbs() * size, driven = mass_ * x;
    const long double given = -x.dot(damped);
    if (!(given > 1e-17L * size.dot(terms))) return std::numeric_limits<double>::infinity();
    const ExtendedVector speeds = directions_.transpose() * x;
    const long double held = friction_.dot(speeds.cwiseAbs());
    return static_cast<double>(x.dot(driven) * (held / given) * (held / given) / 2);
  }

 private:
  Extended mass_, damping_, directions_;
  ExtendedVector friction_;
};

// A random search in mass units that closes in on the least, from random velocities, from the eigencolumns of the
// damping and from velocities along which all but a few frictions do nothing.
double least_break_even_J(const LinearMachine<>& machine, WildMachines& random) {
  const VectorXd unit = stability::mass_units(machine.mass);
  const LinearMachine<> scaled = stability::in_units(machine, unit);
  const BreakEven even{machine};
  const Index n = machine.coordinates();
  const auto at_J = [&](const VectorXd& y) { return even.along_J(unit.cwiseProduct(y)); };
  const auto eigen = stability::dense::symmetric_eigen(stability::dense::symmetric_part(scaled.damping));
  double least_J = std::numeric_limits<double>::infinity();
  for (int begin = 0; begin < 12; ++begin) {
    VectorXd best = begin < n ? VectorXd{eigen.vectors.col(begin)} : random.anywhere(n);
    if (begin >= 8 && machine.frictions() > 0) {
      Eigen::MatrixXd few = scaled.directions;
      for (Index i = 0; i < few.cols(); ++i) {
        if (random.uniform() < 0.5) few.col(i).setZero();
        few.col(i).stableNormalize();
      }
      const auto span = stability::dense::span(few, 1e-12);
      if (span.complement.cols() > 0) best = span.complement * (span.complement.transpose() * best);
    }
    for (int i = 0; i < 300; ++i) {
      const double reach = std::pow(10.0, -12 * random.uniform()) * best.norm();
      const VectorXd next = best + reach * random.anywhere(n);
      if (at_J(next) < at_J(best) || std::isinf(at_J(best))) best = next;
    }
    least_J = std::min(least_J, at_J(best));
  }
  return least_J;
}

TEST(WildAttraction, NoLevelIsAboveWhereTheDampingGivesWhatFrictionTakes) {
  const long first = from_environment("BREAKAWAY_FIRST_SYSTEM", 0), count = from_environment("BREAKAWAY_SYSTEMS", 1500);
  long certified = 0, bounded = 0, near = 0;
  for (long number = first; number < first + count; ++number) {
    WildMachines random{static_cast<std::uint64_t>(number)};
    const LinearMachine<> machine = random.machine();
    const stability::Attractivity a = stability::certify_attractivity(machine);
    EXPECT_EQ(a.level_J > 0 || !a.reason.empty(), true) << "machine " << number;
    ASSERT_FALSE(std::isnan(a.level_J) || std::isnan(a.rho_star_J) || std::isnan(a.greatest_rest_J)) << number;
    if (a.level_J == 0) continue;
    ++certified;
    const double least_J = least_break_even_J(machine, random);
    EXPECT_GE(least_J, a.level_J * (1 - 1e-6)) << "machine " << number << " level " << a.level_J;
    if (std::isinf(a.level_J)) continue;
    ++bounded;
    near += least_J < 2 * a.level_J;
  }
  std::printf("%ld machines, %ld certified, %ld of them to a level, %ld within 2 of where V can grow\n", count,
              certified, bounded, near);
  EXPECT_GT(certified, count / 4);
  EXPECT_GT(bounded, count / 20);
}

// Masses, springs, dampers and frictions of ratios up to 1e3; with BREAKAWAY_SPREAD=1 up to 1e12, where the method may
// need a time limit of its own.
TEST(WildAttraction, NoCertifiedMotionGainsEnergy) {
  const long first = from_environment("BREAKAWAY_FIRST_SYSTEM", 0), count = from_environment("BREAKAWAY_SYSTEMS", 600);
  const bool told = campaign::set_in_environment("BREAKAWAY_TELL");
  const double spread = campaign::number_from_environment("BREAKAWAY_SPREAD", 0.25);
  long ends[4] = {}, contradictions = 0;
  for (long number = first; number < first + count; ++number) {
    WildMachines random{static_cast<std::uint64_t>(number), spread};
    const LinearMachine<> machine = random.machine();
    try {
      const sil::Certificates certificates = sil::certify(machine);
      if (certificates.attractivity.level_J == 0) continue;
      std::string said;
      if (told) std::fprintf(stderr, "%ld ", number);
      const End end = followed(machine, certificates.attractivity, random, said);
      ++ends[static_cast<int>(end)];
      EXPECT_NE(end, End::grew) << "machine " << number << ": " << said;
    } catch (const sil::Contradiction& contradiction) {
      ++contradictions;
      ADD_FAILURE() << "machine " << number << ": " << contradiction.what();
    }
  }
  std::printf(
      "%ld machines: %ld at rest, %ld on their way without growing, %ld refused, %ld grew, %ld contradictions\n", count,
      ends[0], ends[1], ends[2], ends[3], contradictions);
}

}  // namespace
