#include "breakaway/study/basin.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "../refusal.hpp"
#include "../scratch_folder.hpp"
#include "../sil/two_masses.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/report/basin_picture.hpp"
#include "breakaway/study/basin_table.hpp"

namespace {

using namespace breakaway;
using study::Basin;
using study::Fate;
using study::Grid;
using study::Shard;

namespace fs = std::filesystem;

constexpr Grid small{21, 6, {0, 1}};

Basin decided(const Grid& grid, const Shard& shard = {}, int threads = 1) {
  Basin basin{grid, shard};
  study::decide_pending(basin, two_masses(), threads, {});
  return basin;
}

std::string table(const Basin& basin) {
  std::string text;
  const auto next = study::table_parts(basin, two_masses());
  for (std::string part = next(); !part.empty(); part = next()) text += part;
  return text;
}

class BasinFiles : public breakaway::testing::ScratchFolder {
 protected:
  std::string written(const std::string& name, const std::string& text) const {
    format::write_output(path(name), text);
    return path(name);
  }
};

// 106.372 is the area by a fine grid of an independent simulation. Along the two straight borders of 8.5 each the
// trapezoidal rule errs by a fraction of a step of 0.12 times the projection; by symmetry most of it cancels.
TEST(Basin, OfTheExampleHasItsKnownArea) {
  const Basin basin = decided({101, 6, {0, 1}}, {}, 2);
  EXPECT_NEAR(basin.area(Fate::attracted), 106.372, 0.1);
  EXPECT_EQ(basin.count(Fate::undecided), 0u);
  EXPECT_EQ(basin.count(Fate::attracted) + basin.count(Fate::lost), 10201u);
}

TEST(Basin, IsSymmetricAboutTheOrigin) {
  const Basin basin = decided(small);
  for (int row = 0; row < 21; ++row) {
    for (int column = 0; column < 21; ++column) {
      ASSERT_EQ(basin.fate(column, row), basin.fate(20 - column, 20 - row));
      ASSERT_EQ(basin.time_s(column, row), basin.time_s(20 - column, 20 - row));
    }
  }
}

// The early decisions against plain simulation to rest, or to a time at which nothing near rest is left.
TEST(Basin, AgreesWithSimulationWithoutCertificates) {
  const auto s = two_masses();
  const hybrid::EventDriven<> integrator{s.machine};
  for (const auto& plane : {std::array{0, 1}, std::array{0, 3}, std::array{2, 3}}) {
    const Grid grid{13, 7, plane};
    const Basin basin = decided(grid);
    for (int row = 0; row < 13; ++row) {
      for (int column = 0; column < 13; ++column) {
        Eigen::Vector4d x = Eigen::Vector4d::Zero();
        x[plane[0]] = grid.coordinate(column);
        x[plane[1]] = grid.coordinate(row);
        const auto outcome = integrator.run({0, x.head(2), x.tail(2)}, 300);
        const Fate fate = outcome.verdict == hybrid::Verdict::at_rest ? Fate::attracted : Fate::lost;
        EXPECT_EQ(basin.fate(column, row), fate) << x.transpose();
      }
    }
  }
}

// f = K c moves every rest by c, and the grid with it.
TEST(Basin, CountsFromTheRestThatAConstantForceMoves) {
  auto shifted = two_masses();
  shifted.machine.force_N = shifted.machine.stiffness * Eigen::Vector2d{64, -32};
  Basin basin{small, {}};
  study::decide_pending(basin, shifted, 1, {});
  const Basin without = decided(small);
  for (int row = 0; row < 21; ++row) {
    for (int column = 0; column < 21; ++column) EXPECT_EQ(basin.fate(column, row), without.fate(column, row));
  }
  EXPECT_NE(study::table_label(small, shifted), study::table_label(small, two_masses()));
}

// Constant laws are constant friction, followed by another method.
TEST(Basin, TakesFrictionLaws) {
  auto laws = two_masses();
  laws.integrator = scenario::Integrator::adaptive;
  laws.laws.assign(2, {model::FrictionBounds{1, 1.25}, model::shape::constant(0)});
  constexpr Grid grid{9, 6, {0, 1}};
  Basin constant{grid, {}};
  study::decide_pending(constant, laws, 2, {});
  const Basin without = decided(grid);
  laws.laws.assign(2, {model::FrictionBounds{1, 1.25}, model::shape::stribeck(0.5)});
  Basin stronger{grid, {}};
  study::decide_pending(stronger, laws, 2, {});
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 9; ++column) {
      EXPECT_EQ(constant.fate(column, row), without.fate(column, row)) << column << ' ' << row;
      EXPECT_TRUE(stronger.fate(column, row) != Fate::lost || without.fate(column, row) == Fate::lost);
    }
  }
  EXPECT_GT(constant.count(Fate::lost), 10u);
  laws.laws.assign(2, {model::FrictionBounds{1, 1.25}, model::shape::constant(1)});
  const std::string label = study::table_label(grid, laws);
  laws.laws.assign(2, {model::FrictionBounds{1, 1.25}, model::shape::stribeck(0.5)});
  EXPECT_NE(study::table_label(grid, laws), label);
}

TEST(Basin, RefusesImpulsesByName) {
  auto s = two_masses();
  s.impulses = {{1, Eigen::Vector2d{1, 0}}};
  Basin basin{small, {}};
  const std::string said = breakaway::testing::refusal([&] { study::decide_pending(basin, s, 1, {}); });
  EXPECT_NE(said.find("[[impulse]]"), std::string::npos) << said;
}

TEST(Basin, LeavesUndecidedWhatCostsTooMuch) {
  for (const auto integrator : {scenario::Integrator::event_driven, scenario::Integrator::adaptive}) {
    auto s = two_masses();
    s.integrator = integrator;
    Basin basin{small, {}};
    EXPECT_EQ(study::decide_pending(basin, s, 2, {}, {2}), small.points * small.points);
    EXPECT_EQ(basin.count(Fate::pending), 0u);
    EXPECT_GT(basin.given_up(), 20u);
    EXPECT_EQ(basin.given_up(), basin.count(Fate::undecided));
    // What the certificates decide at once is decided as ever.
    EXPECT_EQ(basin.fate(10, 10), Fate::attracted);
    EXPECT_EQ(basin.fate(0, 20), Fate::lost);
  }
}

// A third direction of 0 N that depends on the others changes nothing, and takes no longer.
TEST(Basin, EndsWithADirectionThatIsSwitchedOff) {
  auto s = two_masses();
  s.machine.directions.conservativeResize(2, 3);
  s.machine.directions.col(2) << 1, -1;
  s.machine.friction_N.conservativeResize(3);
  s.machine.friction_N[2] = 0;
  constexpr Grid grid{7, 6, {0, 1}};  // (4, 2) is a point of it
  Basin basin{grid, {}};
  study::decide_pending(basin, s, 1, {});
  const Basin without = decided(grid);
  for (int row = 0; row < 7; ++row) {
    for (int column = 0; column < 7; ++column) EXPECT_EQ(basin.fate(column, row), without.fate(column, row));
  }
}

TEST(Basin, WritesRowsWithTheFirstCoordinateFastest) {
  std::istringstream lines{table(decided({3, 6, {0, 1}}))};
  std::string line;
  std::getline(lines, line);
  EXPECT_TRUE(line.starts_with("# breakaway basin, 3 points, window 6, plane 1,2, system ")) << line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x1,x2,attracted,time_s");
  for (const char* start : {"-6,-6,1,", "0,-6,", "6,-6,0,", "-6,0,", "0,0,1,0", "6,0,", "-6,6,0,", "0,6,", "6,6,1,"}) {
    std::getline(lines, line);
    EXPECT_TRUE(line.starts_with(start)) << line << " for " << start;
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST_F(BasinFiles, AreTheSameBitsForAnySplit) {
  const std::string whole = table(decided(small));
  EXPECT_EQ(table(decided(small, {}, 5)), whole);
  for (const int shards : {2, 3, 30}) {  // 30: more than rows
    Basin merged{small, {}};
    for (int i = 1; i <= shards; ++i) {
      const std::string name = std::to_string(shards) + "-" + std::to_string(i);
      study::read_table(written(name, table(decided(small, {i, shards}, 2))), two_masses(), merged);
    }
    EXPECT_EQ(merged.count(Fate::pending), 0u);
    EXPECT_EQ(table(merged), whole);
  }
}

TEST_F(BasinFiles, GoOnWhereAnInterruptedRunStopped) {
  const auto s = two_masses();
  const std::string file = path("journal");
  {
    Basin basin{small, {}};
    study::Journal journal{file, s, basin};
    study::decide_pending(basin, s, 1, [&](int row, std::size_t) { journal.append(basin, row); });
  }
  fs::resize_file(file, fs::file_size(file) / 2);  // in the middle of a line
  Basin basin{small, {}};
  study::Journal journal{file, s, basin};
  const std::size_t pending = basin.count(Fate::pending);
  EXPECT_GT(pending, 150u);
  EXPECT_LT(pending, 300u);
  const auto append = [&](int row, std::size_t) { journal.append(basin, row); };
  EXPECT_EQ(study::decide_pending(basin, s, 2, append), pending);
  EXPECT_EQ(table(basin), table(decided(small)));

  Basin again{small, {}};
  study::read_table(file, s, again);
  EXPECT_EQ(table(again), table(basin));
}

TEST_F(BasinFiles, AreNotBegunInAFileOfSomebodyElse) {
  const auto s = two_masses();
  for (const char* const text : {"mass = 1\nspring = 2", "notes without a line break", "\n# of Monday"}) {
    const std::string file = written("notes", text);
    Basin basin{small, {}};
    const std::string why = breakaway::testing::refusal([&] { study::Journal{file, s, basin}; });
    EXPECT_NE(why.find(file + ":1: does not say which system it is of"), std::string::npos) << why;
    std::ostringstream left;
    left << std::ifstream{file, std::ios::binary}.rdbuf();
    EXPECT_EQ(left.str(), text);
  }
  Basin basin{small, {}};
  study::Journal{written("torn", study::table_label(small, s).substr(0, 20)), s, basin};
  EXPECT_NE(breakaway::testing::refusal([&] {
              study::Journal{"/dev/zero", s, basin};
            }).find("choose another"),
            std::string::npos);
}

// What is wrong with a table of the system that is `known`; empty if nothing is.
class BasinTables : public BasinFiles {
 protected:
  std::string refusal(const std::string& text, Basin known) const {
    const std::string file = written("table", text);
    return breakaway::testing::refusal([&] { study::read_table(file, two_masses(), known); });
  }
  std::string refusal_of_line(const std::string& line, const Basin& known) const {
    return refusal(study::table_label(small, two_masses()) + '\n' + line + '\n', known);
  }
};

TEST_F(BasinTables, OfOtherSystemsOrGridsAreRefused) {
  const Basin known = decided(small);
  const std::string whole = table(known), points = whole.substr(whole.find('\n') + 1);
  EXPECT_EQ(refusal(whole, known), "");
  auto other = two_masses();
  other.machine.friction_N[1] = 1.5;
  EXPECT_NE(refusal(study::table_label(small, other) + "\n" + points, known).find("another system"), std::string::npos);
  EXPECT_NE(refusal_of_line("0.1,0,1,2", known).find("table:2: is no point of this grid"), std::string::npos);
  EXPECT_NE(refusal_of_line("0,0,1,1", known).find("contradicts"), std::string::npos);
  EXPECT_NE(refusal_of_line("0,0,1", known).find("is not of the form"), std::string::npos);
  EXPECT_NE(refusal_of_line("0,0,7,1", known).find("attracted"), std::string::npos);
}

// Its points would be taken for those of any machine.
TEST_F(BasinTables, ThatDoNotSayOfWhichSystemTheyAreAreRefused) {
  const std::string whole = table(decided(small)), points = whole.substr(whole.find('\n') + 1);
  for (const std::string& text : {points, points.substr(points.find('\n') + 1)}) {
    const std::string said = refusal(text, {small, {}});
    EXPECT_NE(said.find("table:1: does not say which system it is of"), std::string::npos) << said;
    EXPECT_NE(said.find(study::table_label(small, two_masses())), std::string::npos) << said;
  }
  EXPECT_NE(refusal("", {small, {}}).find("no whole line"), std::string::npos);
}

TEST_F(BasinTables, WithPointsThatACertificateExcludesAreRefused) {
  const Basin unknown{small, {}};
  EXPECT_NE(refusal_of_line("0,0,0,0", unknown).find("certified to come to rest"), std::string::npos);
  EXPECT_NE(refusal_of_line("-6,6,1,0", unknown).find("certified never to come to rest"), std::string::npos);
  EXPECT_EQ(refusal_of_line("0,0,1,0", unknown), "");
  EXPECT_EQ(refusal_of_line("-6,6,0,0", unknown), "");
  EXPECT_EQ(refusal_of_line("-6,6,-1,0", unknown), "");  // given up
}

TEST_F(BasinTables, WithTimesThatAreNoneAreRefused) {
  for (const char* time : {"nan", "inf", "-inf", "-1"}) {
    const std::string said = refusal_of_line(std::string{"0,0,1,"} + time, {small, {}});
    EXPECT_NE(said.find("table:2: has a time_s that is no time"), std::string::npos) << time << said;
  }
}

TEST(BasinRegions, AreTheEllipseOfTheoremOneAndThePolytope) {
  const auto s = two_masses();
  const auto certificates = sil::certify(s.machine);
  const auto in = [&](const Grid& grid) { return report::regions(s.machine, certificates, grid); };
  const auto positions = in({11, 6, {0, 1}});
  EXPECT_NEAR(stability::area(positions.certified), 2 * std::numbers::pi * 16 / std::sqrt(3.0), 1e-10);  // det K = 3
  EXPECT_NEAR(stability::area(positions.equilibria), 4.0 / 3, 1e-14);
  EXPECT_NEAR(stability::area(in({11, 1, {0, 1}}).certified), 4, 1e-14);  // the whole window
  const auto mixed = in({11, 6, {0, 2}});
  EXPECT_NEAR(stability::area(mixed.certified), 2 * std::numbers::pi * 16 / std::sqrt(2.0), 1e-10);  // K_11 M_11 = 2
  EXPECT_NEAR(stability::area(mixed.equilibria), 0, 1e-14);
  double widest = 0;
  for (const auto& corner : mixed.equilibria) widest = std::max(widest, corner.x());
  EXPECT_NEAR(widest, 0.5, 1e-14);  // |2 q1| <= 1 and |q1| <= 1 where q2 = 0
}

TEST(BasinPicture, IsDrawnInBothFormats) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const auto s = two_masses();
  const auto regions = report::regions(s.machine, sil::certify(s.machine), small);
  const Basin basin = decided(small);
  EXPECT_NE(report::draw_basin("a.svg", s, basin, regions).find("image-rendering:pixelated"), std::string::npos);
  EXPECT_TRUE(report::draw_basin("a.png", s, basin, regions).starts_with("\x89PNG"));
  EXPECT_THROW(report::draw_basin("a.pdf", s, basin, regions), InputError);
}

}  // namespace
