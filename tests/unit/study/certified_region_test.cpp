// Certified cells against plain simulation: no start in a cell may end otherwise than the cell was proved to.
#include "breakaway/study/certified_region.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "../sil/two_masses.hpp"
#include "../stability/random_systems.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/report/region_picture.hpp"

namespace {

using namespace breakaway;
using study::Cell;
using study::CertifiedRegion;
using study::Fate;
using study::Window;

CertifiedRegion region_of(const scenario::MachineScenario& s, const Window& window, int threads = 2) {
  return study::certify_region(s, sil::certify(s.machine), window, threads);
}

scenario::MachineScenario scenario_of(const stability::LinearMachine<>& machine) {
  scenario::MachineScenario s;
  s.file = "random";
  s.machine = machine;
  return s;
}

// The state at random in a cell; corners are the hardest.
hybrid::MachineState<Eigen::Dynamic> somewhere(const Cell& cell, const Window& window, Eigen::Index n,
                                               std::mt19937_64& random) {
  std::uniform_int_distribution<int> corner{0, 1};
  const double side = 2 * window.half_width / (1 << cell.level);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * n);
  x[window.plane[0]] = (cell.column + corner(random)) * side - window.half_width;
  x[window.plane[1]] = (cell.row + corner(random)) * side - window.half_width;
  return {0, x.head(n), x.tail(n)};
}

void expect_no_contradiction(const scenario::MachineScenario& s, const CertifiedRegion& region, int samples) {
  std::mt19937_64 random{31};
  const hybrid::EventDriven<> integrator{s.machine};
  const sil::Certificates certificates = sil::certify(s.machine);
  const double end_s = certificates.escapes.empty() ? 1e4 : study::horizon_s(s, certificates);  // before it overflows
  std::uniform_int_distribution<std::size_t> any{0, region.cells().size() - 1};
  for (int i = 0; i < samples; ++i) {
    const Cell& cell = region.cells()[any(random)];
    if (cell.proved == Fate::undecided) continue;
    const auto start = somewhere(cell, region.window(), s.machine.coordinates(), random);
    const auto verdict = integrator.run(start, end_s).verdict;
    const bool rests = verdict == hybrid::Verdict::at_rest || verdict == hybrid::Verdict::captured;
    EXPECT_EQ(rests, cell.proved == Fate::attracted) << start.q.transpose() << "  " << start.v.transpose();
  }
}

// 106.372 is the area by an independent simulation; 58.04 that of Theorem 1.
TEST(CertifiedRegion, OfTheExampleIsNineTenthsOfTheTrueOne) {
  const CertifiedRegion region = region_of(two_masses(), {6, {0, 1}, 8});
  EXPECT_GT(region.area(Fate::attracted), 0.93 * 106.372);
  EXPECT_LT(region.area(Fate::attracted), 106.372);
  EXPECT_LT(region.area(Fate::lost), 144 - 106.372);
  EXPECT_GT(region.area(Fate::lost), 28);
  EXPECT_NEAR(region.area_simulated(Fate::attracted), 106.372, 0.2);
  EXPECT_NEAR(region.area(Fate::attracted) + region.area(Fate::lost) + region.area(Fate::undecided), 144, 1e-9);
}

TEST(CertifiedRegion, GrowsWithDepthAndNeverShrinks) {
  double before = 0;
  for (const int depth : {3, 5, 7}) {
    const double area = region_of(two_masses(), {6, {0, 1}, depth}).area(Fate::attracted);
    EXPECT_GT(area, before);
    before = area;
  }
}

TEST(CertifiedRegion, HoldsInEveryPlaneOfTheExample) {
  for (const auto& plane : {std::array{0, 1}, std::array{0, 3}, std::array{2, 3}}) {
    expect_no_contradiction(two_masses(), region_of(two_masses(), {7, plane, 6}), 600);
  }
}

TEST(CertifiedRegion, DoesNotDependOnThreads) {
  const auto one = region_of(two_masses(), {6, {0, 1}, 5}, 1), many = region_of(two_masses(), {6, {0, 1}, 5}, 7);
  ASSERT_EQ(one.cells().size(), many.cells().size());
  for (std::size_t i = 0; i < one.cells().size(); ++i) {
    ASSERT_EQ(one.cells()[i].proved, many.cells()[i].proved);
    ASSERT_EQ(one.cells()[i].simulated, many.cells()[i].simulated);
  }
}

TEST(CertifiedRegion, HoldsForRandomMachines) {
  std::mt19937_64 random{37};
  for (int trial = 0; trial < 30; ++trial) {
    const Eigen::Index n = 1 + trial % 3;
    const auto s = scenario_of(stability::random_theorem_1_system(random, n, n));
    const auto certificates = sil::certify(s.machine);
    const std::array<int, 2> plane{0, static_cast<int>(n)};
    const double width = study::fitting_half_width(s.machine, certificates.attractivity, plane);
    const auto region = study::certify_region(s, certificates, {width, plane, 4}, 2);
    if (std::isinf(certificates.attractivity.level_J)) {
      EXPECT_DOUBLE_EQ(region.area(Fate::attracted), 4 * width * width);
    } else {
      EXPECT_GT(region.area(Fate::attracted), 0);
    }
    expect_no_contradiction(s, region, 60);
  }
}

// Springs so soft that E reaches far out of {V < rho*}: what lies between is certified around its own rest.
TEST(CertifiedRegion, CoversEquilibriaOutsideOfTheEnergyLevel) {
  auto s = two_masses();
  s.machine.stiffness /= 100;
  const auto certificates = sil::certify(s.machine);
  ASSERT_FALSE(certificates.attractivity.all_of_E);
  const auto equilibria = stability::EquilibriumSet::make(s.machine);
  const auto region = study::certify_region(s, certificates, {60, {0, 1}, 6}, 2);
  const Eigen::Vector2d far{48, 48};  // V = 23 > 16
  ASSERT_TRUE(equilibria.contains(far));
  bool covered = false;
  for (const Cell& cell : region.cells()) {
    const double side = 120.0 / (1 << cell.level), left = cell.column * side - 60, low = cell.row * side - 60;
    if (left <= far.x() && far.x() < left + side && low <= far.y() && far.y() < low + side)
      covered = cell.proved == Fate::attracted;
  }
  EXPECT_TRUE(covered);
}

TEST(CertifiedRegion, FitsItsWindowToTheLevel) {
  const auto s = two_masses();
  EXPECT_DOUBLE_EQ(study::fitting_half_width(s.machine, sil::certify(s.machine).attractivity, {0, 1}), 6);
}

TEST(CertifiedRegion, RefusesWhatHasNothingToGrowFrom) {
  auto s = two_masses();
  s.machine.stiffness << 1, -2, -2, 1;
  EXPECT_THROW(region_of(s, {6, {0, 1}, 3}), InputError);
  s = two_masses();
  s.machine.friction_N.setZero();
  EXPECT_THROW(region_of(s, {6, {0, 1}, 3}), InputError);
}

// Weak friction that feeds on itself: near the border a motion takes many times the work that its proof is given.
scenario::MachineScenario weakly_rubbed(double friction_N) {
  auto s = two_masses();
  s.machine.damping << 0.01, 0.03, 0.03, 0.01;
  s.machine.friction_N.setConstant(friction_N);
  return s;
}

// Cells, of which those that were given up are quartered seven times at most, and points of the grid tell the border to
// their own widths; along its length most of that cancels.
TEST(CertifiedRegion, HasTheAreaOfTheBasinAtEveryDepth) {
  constexpr study::Grid grid{101, 10, {0, 1}};
  for (const double friction_N : {0.05, 0.2}) {
    const auto s = weakly_rubbed(friction_N);
    study::Basin basin{grid, {}};
    study::decide_pending(basin, s, 2, {});
    for (const int depth : {5, 8}) {
      const CertifiedRegion region = region_of(s, {grid.half_width, grid.plane, depth});
      const double cell = 2 * grid.half_width / std::exp2(std::min(depth, 7)), step = grid.coordinate(51);
      EXPECT_NEAR(region.area_simulated(Fate::attracted), basin.area(Fate::attracted), 4 * (cell + step))
          << friction_N << " N, depth " << depth;
      EXPECT_LT(region.area_simulated(Fate::undecided), 0.1);
    }
  }
}

TEST(CertifiedRegion, CountsWhatIsUndecidedAmongWhatMayBeAttracted) {
  const CertifiedRegion region{{1, {0, 1}, 1},
                               {{1, 0, 0, Fate::attracted, Fate::attracted},
                                {1, 1, 0, Fate::undecided, Fate::attracted},
                                {1, 0, 1, Fate::undecided, Fate::undecided},
                                {1, 1, 1, Fate::undecided, Fate::lost}},
                               4};
  EXPECT_EQ(region.area_simulated(Fate::attracted), 2);
  EXPECT_EQ(region.area_simulated(Fate::undecided), 1);
  EXPECT_EQ(region.area_simulated(Fate::lost), 1);
  EXPECT_DOUBLE_EQ(region.proved_share(), 1.0 / 3);
}

// A mass that gains energy beside one that loses it, fifteen orders of magnitude apart: what is certified is too small
// for any cell, and each motion has thousands of events.
scenario::MachineScenario endless() {
  stability::LinearMachine<> machine;
  machine.mass = Eigen::Vector2d{1e3, 1e-12}.asDiagonal();
  machine.damping = Eigen::Vector2d{1e4, -1e-12}.asDiagonal();
  machine.stiffness = Eigen::Vector2d{1e6, 1e-6}.asDiagonal();
  machine.directions = Eigen::Matrix2d::Identity();
  machine.friction_N = Eigen::Vector2d{1, 1e-15};
  machine.force_N = Eigen::Vector2d::Zero();
  return scenario_of(machine);
}

TEST(CertifiedRegion, EndsWhereNothingCanBeProved) {
  const CertifiedRegion region = region_of(endless(), {1e-5, {0, 1}, 14});
  EXPECT_EQ(region.area(Fate::attracted), 0);
  EXPECT_EQ(region.proved_share(), 0);
  for (const Cell& cell : region.cells()) ASSERT_LE(cell.level, 7);
  EXPECT_LE(region.motions(), 3 * 21'845U);  // seven halvings, and what follows cells that were given up
}

// Following the motions that were given up takes longer than all that is before.
TEST(CertifiedRegion, TellsAsWellOfTheMotionsThatItFollowsFurther) {
  const scenario::MachineScenario s = endless();
  std::vector<double> proving, following;
  const auto note = [&](study::RegionStage stage, double share) {
    (stage == study::RegionStage::proving ? proving : following).push_back(share);
    EXPECT_TRUE(stage == study::RegionStage::following || following.empty()) << "the stages follow one another";
  };
  const auto region = study::certify_region(s, sil::certify(s.machine), Window{1e-5, {0, 1}, 5}, 1, note);
  ASSERT_GT(region.motions(), 1365U);
  EXPECT_EQ(proving.size(), 1365U);
  EXPECT_EQ(following.size(), region.motions() - 1365 + 1);
  EXPECT_EQ(following.front(), 0);
  for (const auto& stage : {proving, following}) {
    EXPECT_TRUE(std::ranges::is_sorted(stage));
    EXPECT_LE(stage.back(), 1);
  }
}

TEST(CertifiedRegion, IsDrawn) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const auto s = two_masses();
  const auto regions = report::regions(s.machine, sil::certify(s.machine), {2, 6, {0, 1}});
  const std::string svg = report::draw_region("a.svg", s, region_of(s, {6, {0, 1}, 4}), regions);
  EXPECT_NE(svg.find("proved: attracted"), std::string::npos);
  EXPECT_NE(svg.find("B, certified"), std::string::npos);
}

}  // namespace
