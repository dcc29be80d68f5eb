#include "breakaway/report/basin_picture.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "breakaway/input/input_error.hpp"
#include "picture_parts.hpp"

namespace breakaway::report {
namespace {

using stability::Polygon;

constexpr int corners_of_ellipse = 4096;

// { y^T form y / 2 < level } inside the window, as a polygon whose area is that of the ellipse.
Polygon ellipse(const Eigen::Matrix2d& form, double level, double half_width) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(form);
  const double step = 2 * std::numbers::pi / corners_of_ellipse, same_area = std::sqrt(step / std::sin(step));
  const Eigen::Matrix2d to_rim =
      axes.eigenvectors() * (2 * level * axes.eigenvalues().cwiseInverse()).cwiseSqrt().asDiagonal() * same_area;
  Polygon rim;
  for (int i = 0; i < corners_of_ellipse; ++i)
    rim.push_back(to_rim * Eigen::Vector2d{std::cos(i * step), std::sin(i * step)});
  if (stability::area(rim) < 0) std::reverse(rim.begin(), rim.end());
  for (const double side : {-1.0, 1.0}) {
    for (const int axis : {0, 1}) rim = stability::clipped(rim, side * Eigen::Vector2d::Unit(axis), half_width);
  }
  return rim;
}

Polygon certified_region(const stability::LinearMachine<>& machine, double rho_J, const study::Grid& grid) {
  if (rho_J == 0) return {};
  if (std::isinf(rho_J)) return stability::square(grid.half_width);
  const int n = static_cast<int>(machine.coordinates());
  const auto entry = [&](int i, int j) {
    if ((i < n) != (j < n)) return 0.0;
    return i < n ? machine.stiffness(i, j) : machine.mass(i - n, j - n);
  };
  const auto [i, j] = grid.plane;
  return ellipse(Eigen::Matrix2d{{entry(i, i), entry(i, j)}, {entry(j, i), entry(j, j)}}, rho_J, grid.half_width);
}

// E has no velocity: along such an axis its section is cut down to 0.
Polygon equilibria(const stability::LinearMachine<>& machine, const study::Grid& grid) {
  const auto set = stability::EquilibriumSet::make(machine);
  const Eigen::Index n = machine.coordinates();
  Eigen::MatrixX2d plane = Eigen::MatrixX2d::Zero(n, 2);
  for (const int axis : {0, 1}) {
    if (const int place = grid.plane[static_cast<std::size_t>(axis)]; place < n) plane(place, axis) = 1;
  }
  Polygon polygon = set.cross_section(plane, grid.half_width);
  for (const int axis : {0, 1}) {
    if (grid.plane[static_cast<std::size_t>(axis)] < n) continue;
    polygon = stability::clipped(stability::clipped(polygon, Eigen::Vector2d::Unit(axis), 0),
                                 -Eigen::Vector2d::Unit(axis), 0);
  }
  return polygon;
}

// At most about a thousand points along each axis: a picture shows no more.
std::string image(const study::Basin& basin, int stride) {
  std::string text = "$fates << END\n";
  for (int row = 0; row < basin.grid().points; row += stride) {
    for (int column = 0; column < basin.grid().points; column += stride) {
      const bool known = basin.shard().owns(row) && basin.fate(column, row) != study::Fate::pending;
      text += known ? fmt::format("{} ", static_cast<int>(basin.fate(column, row))) : "NaN ";
    }
    text += '\n';
  }
  return text + "END\n";
}

constexpr const char* basin_style = R"(
set palette defined (-1 '#d9a441', 0 '#4d5966', 1 '#e3ebf1')
set palette maxcolors 3
set cbrange [-1.5:1.5]
set key above center horizontal maxrows 1 samplen 1.2 width -2 textcolor '#333333'
)";

}  // namespace

Regions regions(const stability::LinearMachine<>& machine, const sil::Certificates& certificates,
                const study::Grid& grid) {
  return {equilibria(machine, grid), certified_region(machine, certificates.attractivity.rho_star_J, grid)};
}

std::string draw_basin(const std::string& path, const scenario::MachineScenario& s, const study::Basin& basin,
                       const Regions& regions) {
  const study::Grid& grid = basin.grid();
  const int stride = (grid.points - 1) / 1000 + 1;
  const double step = 2 * grid.half_width / (grid.points - 1) * stride, rim = grid.half_width + step / 2;
  std::string commands =
      plane_style(s.machine, grid.plane, rim) + basin_style + image(basin, stride) + region_outlines(regions);
  commands += fmt::format(
      "plot $fates matrix using ({0}+{1}*$1):({0}+{1}*$2):3 with image notitle, "
      "NaN with boxes linecolor '#e3ebf1' title 'attracted', NaN with boxes linecolor '#4d5966' title 'lost'",
      -grid.half_width, step);
  if (basin.count(study::Fate::undecided) > 0) commands += ", NaN with boxes linecolor '#d9a441' title 'undecided'";
  return draw_plane(path, commands + plot_regions(regions) + "\n");
}

}  // namespace breakaway::report
