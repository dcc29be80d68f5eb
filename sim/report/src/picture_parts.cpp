#include "picture_parts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "breakaway/format/gnuplot.hpp"

namespace breakaway::report {
namespace {

constexpr const char* style = R"(
set encoding utf8
set border 15 linecolor '#888888' front
set tics out nomirror textcolor '#333333' front
set size ratio -1
unset colorbox
set style fill solid 1
)";

std::string axis_label(const stability::LinearMachine<>& machine, int place) {
  const int n = static_cast<int>(machine.coordinates());
  return place < n ? fmt::format("q_{{{}}}  [m]", place + 1) : fmt::format("v_{{{}}}  [m/s]", place - n + 1);
}

constexpr const char* line_colours[] = {"#1c5d99", "#c8553d", "#2a7f62", "#8f6bb3",
                                        "#e08e45", "#777777", "#b8860b", "#444444"};

}  // namespace

const char* line_colour(std::size_t place) { return line_colours[place % std::size(line_colours)]; }

std::string plane_style(const stability::LinearMachine<>& machine, const std::array<int, 2>& plane, double rim) {
  return style + fmt::format("set xrange [{0}:{1}]\nset yrange [{0}:{1}]\nset xlabel '{2}'\nset ylabel '{3}'\n", -rim,
                             rim, axis_label(machine, plane[0]), axis_label(machine, plane[1]));
}

std::string outline(std::string_view name, const stability::Polygon& polygon) {
  std::string text = fmt::format("${} << END\n", name);
  const auto append = [&](const Eigen::Vector2d& corner) {
    text += fmt::format("{:.8g} {:.8g}\n", corner.x(), corner.y());
  };
  const std::size_t stride = polygon.size() / 500 + 1;
  for (std::size_t i = 0; i < polygon.size(); i += stride) append(polygon[i]);
  if (!polygon.empty()) append(polygon.front());
  return text + "END\n";
}

std::string region_outlines(const Regions& regions) {
  return outline("certified", regions.certified) + outline("equilibria", regions.equilibria);
}

std::string plot_regions(const Regions& regions) {
  std::string plots;
  if (!regions.certified.empty())
    plots += ", $certified with lines linewidth 2 linecolor '#1c5d99' title 'B, certified'";
  if (!regions.equilibria.empty()) {
    plots += regions.equilibria.size() < 3 || std::abs(stability::area(regions.equilibria)) == 0
                 ? ", $equilibria with lines linewidth 4 linecolor '#c8553d' title 'E, at rest'"
                 : ", $equilibria with filledcurves closed linecolor '#c8553d' title 'E, at rest'";
  }
  return plots;
}

std::string draw_plane(const std::string& path, const std::string& commands) {
  std::string drawn = format::draw_file(path, 760, 820, commands);
  if (const auto at = drawn.find("<image "); path.ends_with(".svg") && at != drawn.npos)
    drawn.insert(at + 7, "style='image-rendering:pixelated' ");
  return drawn;
}

}  // namespace breakaway::report
