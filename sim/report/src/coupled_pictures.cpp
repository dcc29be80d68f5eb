#include "coupled_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "breakaway/config/machine_design.hpp"
#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/plot_style.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "picture_parts.hpp"
#include "plot_data.hpp"
#include "thin.hpp"

namespace breakaway::report {
namespace {

using config::Node;
using sil::AxisResult;
using sil::Result;

// As gnuplot shows it; '_' alone lowers what follows.
std::string label_of(const AxisResult& axis) {
  std::string text;
  for (const char c : axis.name) text += c == '_' ? std::string{"\\_"} : std::string{c};
  return text;
}

double error_m(const sil::Sample& sample) { return sample.position_m - sample.target_m; }

// A logarithmic axis has no zero.
double shown(double error_m) { return error_m == 0 ? std::nan("") : std::fabs(error_m); }

// The error and the kicks of an axis, in blocks of their own.
std::string blocks_of(const AxisResult& axis, std::size_t place, double period_s) {
  std::vector<Point> errors;
  for (const sil::Sample& sample : axis.trace) errors.push_back({sample.time_s, shown(error_m(sample))});
  const auto kick = [&](const sil::KickRecord& k) {
    return std::array{k.time_s, shown(k.error_m), k.time_s + k.periods * period_s};
  };
  return data(fmt::format("error{}", place), thin_series(errors, format::width_px)) +
         data(fmt::format("kicks{}", place), axis.kicks, kick);
}

std::string errors_panel(const Node& node, const Result& result) {
  std::string plots;
  for (std::size_t i = 0; i < result.axes.size(); ++i) {
    const char* const separator = i > 0 ? ", " : "plot ";
    plots += fmt::format("{}$error{} using 1:2 with lines linewidth 1.6 linecolor '{}' title '{}'", separator, i,
                         line_colour(i), label_of(result.axes[i]));
    if (!result.axes[i].kicks.empty())
      plots += fmt::format(", $kicks{} using 1:2 with points pointtype 7 pointsize 0.5 linecolor '{}' notitle", i,
                           line_colour(i));
  }
  for (std::size_t i = 0; i < result.axes.size(); ++i)
    plots += fmt::format(", {} with lines linestyle 4 {}", number(judged_tolerance_m(node, node.axes[i])),
                         i > 0 ? "notitle" : "title 'tolerance'");
  return "set logscale y\nset format y '10^{%T}'\nset format x ''\nset ylabel '|position error| [m]'\n" + plots + "\n";
}

// A row for each axis, the first one on top, with a bar from the beginning of a pulse to its end.
std::string turns_panel(const Result& result) {
  const std::size_t count = result.axes.size();
  std::string names, plots;
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<double>(count - i);
    names += fmt::format("{}'{}' {}", i > 0 ? ", " : "", label_of(result.axes[i]), row);
    if (result.axes[i].kicks.empty()) continue;
    plots += fmt::format(
        "{}$kicks{} using 1:({}):1:3:({}):({}) with boxxyerror fillstyle solid linewidth 1 linecolor '{}' notitle",
        plots.empty() ? "plot " : ", ", i, row, row - 0.3, row + 0.3, line_colour(i));
  }
  return fmt::format(
      "unset logscale y\nset format y '%h'\nset format x '% h'\nset ytics ({})\nset yrange [0.4:{}]\nset xlabel 'time "
      "[s]'\nset ylabel 'kicked'\n{}\n",
      names, static_cast<double>(count) + 0.6, plots.empty() ? "plot NaN notitle" : plots);
}

Picture turns(const Node& node, const Result& result) {
  const int rows_px = 90 + 34 * static_cast<int>(result.axes.size()), height_px = 400 + rows_px;
  const double split = 1.0 * (rows_px + 30) / height_px;
  std::string commands = format::plot_style;
  for (std::size_t i = 0; i < result.axes.size(); ++i) commands += blocks_of(result.axes[i], i, node.period_s());
  commands +=
      fmt::format("set multiplot\nset xrange [0:{}]\nset tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n",
                  number(result.axes.front().trace.back().time_s), 1 - 44.0 / height_px, split) +
      errors_panel(node, result) +
      fmt::format("set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\nunset key\n", split - 12.0 / height_px,
                  82.0 / height_px) +
      turns_panel(result);
  return {
      "Who is kicked when",
      "The distance of every axis from its target. A dot is a kick, and below it a bar as long as its pulse. One axis "
      "is kicked until it is within its tolerance, and no other one moves meanwhile: its curve is level.",
      format::draw_svg("turns", format::width_px, height_px, commands)};
}

struct Plane {
  std::size_t across, up;  // axes
};

std::string rectangle(std::string_view name, double half_width, double half_height) {
  const std::vector<Point> corners{{-half_width, -half_height},
                                   {half_width, -half_height},
                                   {half_width, half_height},
                                   {-half_width, half_height},
                                   {-half_width, -half_height}};
  return data(name, corners);
}

// Where the approach can come to rest: friction holds what springs and gains pull.
stability::Polygon resting_set(const Node& node, Plane plane) {
  const stability::CoupledAxes axes = config::coupled_axes(node);
  stability::LinearMachine<> closed;
  closed.mass = axes.mass;
  closed.damping = axes.damping;
  closed.stiffness = axes.stiffness;
  closed.stiffness.diagonal() += config::sampled_approach(node).position_gain_N_per_m;
  closed.directions = Eigen::MatrixXd::Identity(axes.axes(), axes.axes());
  closed.friction_N = axes.friction_upper_N;
  Eigen::Matrix2Xd onto = Eigen::Matrix2Xd::Zero(2, axes.axes());
  onto(0, static_cast<Eigen::Index>(plane.across)) = onto(1, static_cast<Eigen::Index>(plane.up)) = 1;
  return stability::EquilibriumSet::make(closed).projection(onto);
}

std::string path_of(const Result& result, Plane plane) {
  const auto &across = result.axes[plane.across].trace, &up = result.axes[plane.up].trace;
  std::vector<Point> points;
  double most_m = 0;
  for (std::size_t i = 0; i < std::min(across.size(), up.size()); ++i) {
    points.push_back({error_m(across[i]), error_m(up[i])});
    most_m = std::max({most_m, std::fabs(points.back().x), std::fabs(points.back().y)});
  }
  const double tolerance_m = std::max(1e-9 * most_m, 1e-30);  // the near picture is a thousand times as large
  return data("path", thin_curve(points, tolerance_m, tolerance_m));
}

std::string ranges(const std::array<double, 2>& half_m, double scale) {
  return fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", number(-half_m[0] * scale), number(half_m[0] * scale),
                     number(-half_m[1] * scale), number(half_m[1] * scale));
}

// scale: of the unit of the axes to 1 m.
std::string curves(const char* scale) {
  const auto curve = [&](const char* name, const char* look) {
    return fmt::format("${0} using ({1}*$1):({1}*$2) {2}", name, scale, look);
  };
  return "plot " +
         curve("box", "with lines linewidth 1.6 linecolor '#777777' dashtype 2 title 'box after the release'") + ", " +
         curve("rest", "with filledcurves closed fillcolor '#f2c14e' fillstyle solid 0.5 title 'E'") + ", " +
         curve("promised", "with lines linewidth 1.6 linecolor '#2a7f62' title 'promised'") + ", " +
         curve("path", "with lines linestyle 1 title 'the run'") + "\n";
}

double farthest_m(const AxisResult& axis) {
  double most_m = 0;
  for (const sil::Sample& sample : axis.trace) most_m = std::max(most_m, std::fabs(error_m(sample)));
  return most_m;
}

Picture plane_of_errors(const Node& node, const Result& result, const stability::MachineCertificate& certificate,
                        Plane plane) {
  const std::string across = result.axes[plane.across].name, up = result.axes[plane.up].name;
  const std::array box_m{certificate.axes[plane.across].box_m, certificate.axes[plane.up].box_m};
  const std::array tolerance_m{judged_tolerance_m(node, node.axes[plane.across]),
                               judged_tolerance_m(node, node.axes[plane.up])};
  const std::array whole_m{1.1 * std::max(box_m[0], farthest_m(result.axes[plane.across])),
                           1.1 * std::max(box_m[1], farthest_m(result.axes[plane.up]))};
  const std::array near_m{8 * tolerance_m[0], 8 * tolerance_m[1]};
  const auto labels = [&](const char* unit) {
    return fmt::format("set xlabel 'error of {} [{}]'\nset ylabel 'error of {} [{}]'\n",
                       label_of(result.axes[plane.across]), unit, label_of(result.axes[plane.up]), unit);
  };
  const std::string commands = format::plot_style + path_of(result, plane) + outline("rest", resting_set(node, plane)) +
                               rectangle("box", box_m[0], box_m[1]) +
                               rectangle("promised", tolerance_m[0], tolerance_m[1]) +
                               "set multiplot layout 1,2 margins 0.09, 0.98, 0.16, 0.8 spacing 0.11\n"
                               "set key at screen 0.09, screen 0.99 left top vertical maxrows 2\n" +
                               ranges(whole_m, 1e3) + labels("mm") + curves("1e3") + "unset key\n" +
                               ranges(near_m, 1e6) + labels("µm") + curves("1e6");
  return {
      fmt::format("Errors of {} and {}", across, up),
      "The errors of two axes, one over the other; on the left the whole run, on the right around the targets. The "
      "approach ends in E, a set of both together. The release stays in the box. From there the run goes along one "
      "axis, then along the other: each kick moves one of them, never beyond its target, until both are within what is "
      "promised.",
      format::draw_svg("plane", format::width_px, 530, commands)};
}

}  // namespace

std::vector<Picture> draw_coupled_pictures(const Node& node, const Result& result) {
  std::vector<Picture> pictures{turns(node, result)};
  const stability::MachineCertificate certificate = config::examine_machine(node);
  if (certificate.axes.size() != result.axes.size()) return pictures;
  for (std::size_t i = 0; i + 1 < result.axes.size(); ++i)
    pictures.push_back(plane_of_errors(node, result, certificate, {i, i + 1}));
  return pictures;
}

}  // namespace breakaway::report
