#include "pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/design/k3.hpp"
#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/plot_style.hpp"
#include "phase_pictures.hpp"
#include "plot_data.hpp"
#include "thin.hpp"

namespace breakaway::report {
namespace {

using config::Axis;
using sil::AxisResult;

// value(sample) over time.
template <class Value>
std::string series(std::string_view name, const AxisResult& result, Value value) {
  std::vector<Point> points;
  for (const sil::Sample& s : result.trace) points.push_back({s.time_s, std::invoke(value, s)});
  return data(name, thin_series(points, format::width_px));
}

// Dashed verticals at the instants that the theory names.
std::string instants(const AxisResult& result, bool labelled) {
  if (!result.ideal) return "";
  std::string text;
  const std::array marks{std::pair{"t_1", result.ideal->t1_s}, std::pair{"t_2", result.ideal->t2_s},
                         std::pair{"t_∞", result.ideal->t_inf_s}};
  for (const auto& [name, time_s] : marks) {
    if (!std::isfinite(time_s)) continue;
    text += fmt::format("set arrow from first {0}, graph 0 to first {0}, graph 1 nohead linestyle 4\n", time_s);
    if (labelled)
      text += fmt::format("set label '{}' at first {}, graph 1.05 center textcolor '#555555'\n", name, time_s);
  }
  return text;
}

std::string response_caption(const config::Node& node, const Axis& axis, const AxisResult& result) {
  if (node.coupling)
    return "Position, velocity and actuator force. The axes are approached together and let go; then one after another "
           "is kicked. While another one is kicked, the drive gives the force that takes the kick's push off this "
           "axis' "
           "friction, and the axis stands.";
  if (result.ideal) {
    return "The axis slides to the maximal stick set, which it reaches at t₁. From there every instant of rest is "
           "answered "
           "by an impulse, seen as a jump of the velocity; from t₂ on it is within the minimal stick set. It rests on "
           "the target at t∞, a finite time. Compare Figure 5 of van de Wouw & Leine.";
  }
  if (axis.controller.pid) return "Position, velocity and actuator force under the PID controller.";
  return fmt::format(
      "Position, velocity and actuator force. The approach is limited in speed and force; once the axis is "
      "at rest short of the target, force pulses of at most {:g} N kick it on.",
      axis.controller.max_force_N);
}

// One of the panels that share a time axis.
std::string panel(const AxisResult& result, bool first, bool last, std::string_view plot) {
  return fmt::format("unset label\nunset arrow\n{}set format x '{}'\nset xlabel '{}'\n{}\n", instants(result, first),
                     last ? "% h" : "", last ? "time [s]" : "", plot);
}

Picture response(const config::Node& node, const Axis& axis, const AxisResult& result) {
  const bool loop = axis.drive.has_value();
  const int panels = loop ? 3 : 2;
  const int height_px = 230 * panels + 132;
  std::string commands = format::plot_style + series("target", result, &sil::Sample::target_m) +
                         series("position", result, &sil::Sample::position_m) +
                         series("velocity", result, &sil::Sample::velocity_m_s) +
                         series("force", result, &sil::Sample::force_N) +
                         fmt::format(
                             "set multiplot layout {},1 margins 0.12, 0.97, {:.3f}, {:.3f} spacing 0.05\n"
                             "set xrange [0:{}]\nset offsets 0, 0, graph 0.06, graph 0.06\nset key at "
                             "screen 0.12, screen 1 left top horizontal\n",
                             panels, 72.0 / height_px, 1 - 60.0 / height_px, number(result.trace.back().time_s));
  commands += panel(
      result, true, false,
      "set ylabel 'position [m]'\nplot $target using 1:2 with steps linestyle 4 title 'target', $position using 1:2 "
      "with lines linestyle 1 title 'position'");
  commands += panel(result, false, !loop,
                    "set ylabel 'velocity [m/s]'\nplot $velocity using 1:2 with lines linestyle 2 notitle");
  if (loop) {
    commands += panel(result, false, true,
                      fmt::format("set ylabel 'force [N]'\nplot $force using 1:2 with {} linestyle 3 notitle",
                                  result.trace.size() > most_of_series(format::width_px) ? "lines" : "steps"));
  }
  return {"Response", response_caption(node, axis, result),
          format::draw_svg("response", format::width_px, height_px, commands)};
}

bool ever_off_target(const AxisResult& result) {
  return std::ranges::any_of(result.trace, [](const sil::Sample& x) { return x.position_m != x.target_m; });
}

// |error| on a logarithmic axis shows the last micrometres.
Picture error_over_time(const Axis& axis, double tolerance_m, const AxisResult& result) {
  const auto shown = [](double error_m) { return error_m == 0 ? std::nan("") : std::fabs(error_m); };
  std::string commands =
      format::plot_style +
      series("error", result, [&](const sil::Sample& x) { return shown(x.position_m - x.target_m); }) +
      data("kicks", result.kicks,
           [&](const sil::KickRecord& k) {
             return std::array{k.time_s, shown(k.error_m)};
           }) +
      instants(result, true) +
      "set tmargin 4\nset logscale y\nset format y '10^{%T}'\nset ylabel '|position error| "
      "[m]'\nset xlabel 'time [s]'\n" +
      fmt::format("set xrange [0:{}]\n", number(result.trace.back().time_s));
  std::string plots = "plot $error using 1:2 with lines linestyle 1 title 'error'";
  if (!result.kicks.empty()) plots += ", $kicks using 1:2 with points linestyle 8 title 'kicks'";
  if (tolerance_m > 0) plots += fmt::format(", {} with lines linestyle 4 title 'tolerance'", number(tolerance_m));
  if (axis.drive) {
    commands += fmt::format("set yrange [{}:*]\n", number(axis.drive->encoder_resolution_m / 10));
    plots += fmt::format(", {} with lines linecolor '#bbbbbb' title 'one encoder count'",
                         number(axis.drive->encoder_resolution_m));
  }
  return {"Position error",
          fmt::format("The distance from the target on a logarithmic axis. {}here the curve is level, the axis stands.",
                      result.kicks.empty() ? "W" : "Each dot is a kick; w"),
          format::draw_svg("error", format::width_px, 420, commands + plots + "\n")};
}

Picture kick_law(const Axis& axis, const AxisResult& result) {
  const auto& gains = *axis.controller.impulsive;
  const auto law = design::K3<double>::make(
      {axis.mass_kg, gains.stiffness_N_per_m, gains.kick_damping_Ns_per_m, axis.friction.bounds.lower_N});
  const double upper_m = axis.friction.bounds.upper_N / gains.stiffness_N_per_m;
  std::vector<double> places;
  for (int i = -200; i <= 200; ++i) places.push_back(upper_m * i * std::abs(i) / 40000.0);
  std::string commands = format::plot_style +
                         data("law", places,
                              [&](double y) {
                                return std::array{y, law.impulse_Ns(y)};
                              }) +
                         data("kicks", result.kicks,
                              [&](const sil::KickRecord& k) {
                                return std::array{k.error_m, result.ideal ? k.impulse_Ns : law.impulse_Ns(k.error_m)};
                              }) +
                         fmt::format("set xrange [{}:{}]\n", number(-1.05 * upper_m), number(1.05 * upper_m)) +
                         "set xlabel 'position error [m]'\nset ylabel 'impulse k_3 [N s]'\n"
                         "plot $law using 1:2 with lines linestyle 1 title 'k_3'";
  if (!result.kicks.empty()) {
    commands += fmt::format(", $kicks using 1:2 with points linestyle 8 title '{}'",
                            result.ideal ? "kicks of this run" : "errors that this run kicked at");
  }
  return {
      "Impulse law k₃",
      "The impulse that sends the axis from rest at a position error to its target under the least friction, over the "
      "maximal stick set. Compare Figure 4 of van de Wouw & Leine.",
      format::draw_svg("law", format::width_px, 400, commands + "\n")};
}

// The distances that kicks are for, and those that this run kicked from.
std::array<double, 2> kicked_distances(const design::BrakedDesign<float>& braked, const AxisResult& result) {
  double least_m = braked.floor_m, most_m = braked.reach_m;
  for (const sil::KickRecord& k : result.kicks) {
    const double distance_m = std::fabs(k.error_m);
    if (distance_m > 0) least_m = std::min(least_m, distance_m);
    most_m = std::max(most_m, distance_m);
  }
  return {least_m, most_m};
}

std::string table_data(const design::BrakedDesign<float>& braked, const AxisResult& result) {
  constexpr int intervals = 600;
  const auto [least_m, most_m] = kicked_distances(braked, result);
  std::vector<double> places;
  for (int i = 0; i <= intervals; ++i)
    places.push_back(least_m * std::pow(most_m / least_m, static_cast<double>(i) / intervals));
  return data("table", places, [&](double y) {
    const law::Pulse<float> pulse = braked.kicks.table.pulse(static_cast<float>(y));
    return std::array{y, static_cast<double>(pulse.force_N), static_cast<double>(pulse.periods)};
  });
}

// The pulses of the coast "brake", which k3 has no part in.
Picture kick_table(const design::BrakedDesign<float>& braked, const AxisResult& result) {
  const auto panel_of = [&](std::string_view name, int column, std::string_view style) {
    std::string plot = fmt::format("set ylabel '{0}'\nplot $table using 1:{1} with {2} linestyle 1 title 'table'", name,
                                   column, style);
    if (!result.kicks.empty())
      plot += fmt::format(", $kicks using 1:{} with points linestyle 8 title 'kicks of this run'", column);
    return plot + "\n";
  };
  const std::string commands =
      format::plot_style + table_data(braked, result) +
      data("kicks", result.kicks,
           [](const sil::KickRecord& k) {
             return std::array{std::fabs(k.error_m), std::fabs(k.force_N), static_cast<double>(k.periods)};
           }) +
      "set multiplot layout 1,2\nset logscale x\nset format x '10^{%T}'\nset xlabel '|position error| [m]'\n"
      "set yrange [0:*]\n" +
      panel_of("force of the pulse [N]", 2, "lines") + panel_of("its length [periods]", 3, "steps");
  return {
      "Kick table",
      fmt::format("The pulse that answers a position error at rest. Of all axes that the file admits it is made to "
                  "lead the one that goes furthest to its target, and any other less far. From the floor of {:.3g} m "
                  "on each kick is sure to take some of the error away.{}",
                  braked.floor_m, braked.has_fine_stage() ? " Below it the fine stage finds its own forces." : ""),
      format::draw_svg("kick_table", format::width_px, 360, commands)};
}

// What answers a position error at rest; nothing where it is no curve over the error.
std::optional<Picture> kick_answer(const config::Node& node, const Axis& axis, const AxisResult& result) {
  const auto& gains = axis.controller.impulsive;
  if (!gains || gains->coast == law::Coast::work || node.coupling) return std::nullopt;
  if (gains->coast == law::Coast::pd) return kick_law(axis, result);
  const auto braked = design::design_braked_kicks<float>(config::braked_class(node, axis));
  return braked.possible() ? std::optional{kick_table(braked, result)} : std::nullopt;
}

// Of an axis with a load apart only the motor's friction is seen, between the bounds of the motor.
Picture friction_along(const Axis& axis, const AxisResult& result) {
  const bool apart = result.load_position_m.has_value();
  const double unit = axis.friction.normal_force_N.value_or(1.0);
  const law::FrictionBounds<double> bounds = apart ? config::truth_of(axis).bounds : axis.friction.bounds;
  const double lower = bounds.lower_N / unit, upper = bounds.upper_N / unit;
  const double margin = upper > lower ? 0.25 * (upper - lower) : 0.25 * upper;
  const char* const of = apart ? " of the motor" : "";
  const std::string commands =
      format::plot_style + fmt::format("set xrange [0:{}]\n", number(result.trace.back().time_s)) +
      series("friction", result, [&](const sil::Sample& x) { return x.friction_level_N / unit; }) +
      instants(result, true) +
      fmt::format("set tmargin 4\nset yrange [{}:{}]\n", apart ? 0 : lower - margin, upper + margin) +
      fmt::format("set xlabel 'time [s]'\nset ylabel '{}{}{}'\n",
                  axis.friction.normal_force_N ? "friction coefficient μ" : "friction level", of,
                  axis.friction.normal_force_N ? "" : " [N]") +
      fmt::format(
          "plot $friction using 1:2 with lines linestyle 1 title 'along the solution', {} with lines linestyle 4 "
          "title 'bounds{}', {} with lines linestyle 4 notitle, {} with lines linecolor '#bbbbbb' dashtype 3 title "
          "'mean of the bounds'\n",
          lower, of, upper, (lower + upper) / 2);
  return {"Friction",
          apart
              ? "The friction that the motor meets, between the bounds of the motor; the load has another of its own, "
                "and the controller is told of both in one. Below the bounds the motor stands while the load swings, "
                "and friction holds the rest of the force on it."
              : "The friction that the moving axis meets, within the bounds that the controller is designed for. The "
                "controller knows the bounds only. Compare Figure 3 of van de Wouw & Leine.",
          format::draw_svg("friction", format::width_px, 380, commands)};
}

// Of an axis with a load apart.
Picture motor_and_load(const AxisResult& result) {
  const auto off_mm = [](double position_m, double target_m) {
    const double off_m = std::fabs(position_m - target_m);
    return off_m > 0 ? 1e3 * off_m : std::nan("");  // a logarithmic axis has no zero
  };
  const std::string commands =
      format::plot_style + fmt::format("set xrange [0:{}]\n", number(result.trace.back().time_s)) +
      series("motor", result, [&](const sil::Sample& x) { return off_mm(x.position_m, x.target_m); }) +
      series("load", result, [&](const sil::Sample& x) { return off_mm(*x.load_position_m, x.target_m); }) +
      series("bend", result, [](const sil::Sample& x) { return 1e6 * (*x.load_position_m - x.position_m); }) +
      "set multiplot layout 2,1\nset logscale y\nset format y '10^{%T}'\nset ylabel '|error| [mm]'\n"
      "plot $motor using 1:2 with lines linestyle 1 title 'motor', $load using 1:2 with lines linestyle 2 title "
      "'load'\n"
      "unset logscale y\nset format y '%h'\nset xlabel 'time [s]'\nset ylabel 'load less motor [um]'\n"
      "plot $bend using 1:2 with lines linestyle 5 notitle\n";
  return {"Motor and load",
          "The distance of either from the target, and what the spring and its gap leave between them: it swings after "
          "each pulse and rests where friction holds it.",
          format::draw_svg("load", format::width_px, 560, commands)};
}

Picture kicks(const AxisResult& result) {
  int index = 0;
  const bool ideal = result.ideal.has_value();
  const std::string commands =
      format::plot_style +
      data("kicks", result.kicks,
           [&](const sil::KickRecord& k) {
             const double strength = std::fabs(ideal ? k.impulse_Ns : k.force_N);
             return std::array{static_cast<double>(++index), std::fabs(k.error_m), strength};
           }) +
      "set multiplot layout 1,2\nset logscale y\nset format y '10^{%T}'\nset xlabel 'kick'\nset offsets 0.5, 0.5, 0, "
      "0\n"
      "set ylabel '|position error| before [m]'\n"
      "plot $kicks using 1:2 with linespoints linestyle 1 pointtype 7 pointsize 0.4 notitle\n" +
      (ideal ? "set ylabel '|impulse| [N s]'\n"
             : "unset logscale y\nset format y '%h'\nset yrange [0:*]\nset ylabel '|force| [N]'\n") +
      "plot $kicks using 1:3 with linespoints linestyle 2 pointtype 7 pointsize 0.4 notitle\n";
  return {
      "Kicks",
      ideal ? "Each kick leaves a smaller error, by at least the factor that the friction bounds imply, so infinitely "
              "many kicks end in a finite time."
            : "The error from which each kick starts, and the force commanded in its first period.",
      format::draw_svg("kicks", format::width_px, 360, commands)};
}

Picture bus_load(const AxisResult& result, const sil::LoopFigures& loop) {
  // The first sample has no period before it.
  const auto share = [](const sil::Sample& x) { return x.time_s > 0 ? 100 * x.bus_load : std::nan(""); };
  const std::string commands = format::plot_style + series("load", result, share) +
                               "set xlabel 'time [s]'\nset ylabel 'bus load [%]'\nset yrange [0:100]\n"
                               "plot $load using 1:2 with lines linestyle 5 notitle\n";
  return {"Bus load",
          fmt::format("The share of each control period in which a frame is on the wire; {:.1f} % on average.",
                      100 * loop.bus_load),
          format::draw_svg("bus", format::width_px, 300, commands)};
}

}  // namespace

std::vector<Picture> draw_pictures(const config::Node& node, const Axis& axis, const AxisResult& result) {
  if (result.trace.empty()) return {};
  std::vector<Picture> pictures{response(node, axis, result)};
  const double tolerance_m = judged_tolerance_m(node, axis);
  if (ever_off_target(result)) pictures.push_back(error_over_time(axis, tolerance_m, result));
  // Where an axis of several that push each other can stick is no matter of its own numbers.
  if (!node.coupling) std::ranges::move(draw_phase_planes(axis, tolerance_m, result), std::back_inserter(pictures));
  if (result.load_position_m) pictures.push_back(motor_and_load(result));
  if (auto answer = kick_answer(node, axis, result)) pictures.push_back(*std::move(answer));
  pictures.push_back(friction_along(axis, result));
  if (!result.kicks.empty()) pictures.push_back(kicks(result));
  return pictures;
}

Picture draw_bus_load(const sil::Result& result) { return bus_load(result.axes.front(), *result.loop); }

}  // namespace breakaway::report
