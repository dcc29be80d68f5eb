#include "motion_picture.hpp"

#include <fmt/format.h>

#include <cstddef>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/plot_style.hpp"
#include "picture_parts.hpp"

namespace breakaway::report {
namespace {

constexpr int motion_width_px = 900, motion_height_px = 700;
constexpr std::size_t most_states = 6000;

// A line for each coordinate, from the columns of $motion behind `first`.
std::string lines(const char* symbol, Eigen::Index first, Eigen::Index count) {
  std::string plot = "plot ";
  for (Eigen::Index i = 0; i < count; ++i) {
    plot += fmt::format("{}$motion using 1:{} with lines linewidth 1.6 linecolor '{}' title '{}_{{{}}}'",
                        i > 0 ? ", " : "", first + i + 1, line_colour(static_cast<std::size_t>(i)), symbol, i + 1);
  }
  return plot + "\n";
}

}  // namespace

std::string draw_motion(const std::vector<stability::MachineState<Eigen::Dynamic>>& trace) {
  std::string commands = format::plot_style + "$motion << END\n";
  const std::size_t stride = trace.size() / most_states + 1;
  for (std::size_t i = 0; i < trace.size(); i += stride) {
    commands += fmt::format("{:.9g}", trace[i].time_s);
    for (const double q : trace[i].q) commands += fmt::format(" {:.9g}", q);
    for (const double v : trace[i].v) commands += fmt::format(" {:.9g}", v);
    commands += '\n';
  }
  const Eigen::Index n = trace.front().q.size();
  commands += fmt::format("END\nset multiplot layout 2,1\nset xrange [0:{}]\nset ylabel 'coordinates [m]'\n{}",
                          trace.back().time_s, lines("q", 1, n));
  commands += fmt::format("set xlabel 'time [s]'\nset ylabel 'velocities [m/s]'\n{}", lines("v", 1 + n, n));
  return format::draw_svg("motion", motion_width_px, motion_height_px, commands);
}

}  // namespace breakaway::report
