#include "breakaway/report/sweep_picture.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/report/basin_picture.hpp"
#include "breakaway/sil/certificates.hpp"
#include "picture_parts.hpp"

namespace breakaway::report {
namespace {

constexpr const char* sweep_style = R"(
set encoding utf8
set border 15 linecolor '#888888' front
set tics out nomirror textcolor '#333333' front
set size ratio -1
set key outside right top vertical maxrows 20 samplen 1.2 textcolor '#333333'
set style fill solid 1
)";

// How far B or E reaches along the axes of the plane.
double reach(const stability::Polygon& polygon) {
  double farthest = 0;
  for (const Eigen::Vector2d& corner : polygon) farthest = std::max(farthest, corner.cwiseAbs().maxCoeff());
  return farthest;
}

// An upper bound of the size of { V < rho }, so that no polygon is cut by the window it is measured in.
double window(const stability::LinearMachine<>& machine, double rho_J) {
  const double softest = std::min(1 / machine.stiffness.inverse().norm(), 1 / machine.mass.inverse().norm());
  return 1.1 * std::sqrt(2 * rho_J / softest);
}

// Light to dark blue as the gain grows.
std::string colour(std::size_t index, std::size_t count) {
  const double share = count < 2 ? 1 : static_cast<double>(index) / static_cast<double>(count - 1);
  const auto mixed = [&](int light, int dark) { return static_cast<int>(std::lround(light + share * (dark - light))); };
  return fmt::format("#{:02x}{:02x}{:02x}", mixed(0x9e, 0x12), mixed(0xc4, 0x3f), mixed(0xe6, 0x6b));
}

}  // namespace

std::string draw_sweep(const std::string& path, const std::vector<SweptMachine>& machines) {
  const std::array<int, 2> plane{0, 1};  // q1 and q2, or q and v
  double half_width = 0;
  for (const auto& [gain, machine] : machines) {
    const sil::Certificates certificates = sil::certify(machine);
    const double rho_J = certificates.attractivity.rho_star_J;
    const double level_J = std::isfinite(rho_J) ? rho_J : 4 * certificates.attractivity.greatest_rest_J;
    if (!(level_J > 0)) continue;
    const Regions found = regions(machine, certificates, {2, window(machine, level_J), plane});
    const double wanted = std::isfinite(rho_J) ? reach(found.certified) : 3 * reach(found.equilibria);
    half_width = std::max(half_width, 1.05 * wanted);
  }
  if (half_width == 0) half_width = 1;

  std::string blocks, plot;
  for (std::size_t i = 0; i < machines.size(); ++i) {
    const auto& [gain, machine] = machines[i];
    const sil::Certificates certificates = sil::certify(machine);
    const Regions found = regions(machine, certificates, {2, half_width, plane});
    if (i == 0) {
      blocks += outline("equilibria", found.equilibria);
      // A segment has no area to fill.
      plot =
          "plot $equilibria with lines linewidth 4 linecolor '#c8553d' notitle, "
          "$equilibria with filledcurves closed linecolor '#c8553d' title 'E, at rest'";
    }
    if (found.certified.empty()) continue;
    const bool everywhere = std::isinf(certificates.attractivity.rho_star_J);
    blocks += outline(fmt::format("region{}", i), found.certified);
    plot += fmt::format(", $region{} with lines linewidth 2 linecolor '{}' title '{:.4g} N s/m{}'", i,
                        colour(i, machines.size()), gain, everywhere ? ", everywhere" : "");
  }
  const bool planar = machines.front().closed_loop.coordinates() > 1;
  const std::string axes =
      fmt::format("set xrange [{0}:{1}]\nset yrange [{0}:{1}]\nset xlabel '{2}  [m]'\nset ylabel '{3}'\n", -half_width,
                  half_width, planar ? "q_{1}" : "q", planar ? "q_{2}  [m]" : "v  [m/s]");
  return format::draw_file(path, 900, 720, sweep_style + axes + blocks + plot + "\n");
}

}  // namespace breakaway::report
