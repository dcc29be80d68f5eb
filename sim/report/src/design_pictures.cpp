#include "design_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/design/k3.hpp"
#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/plot_style.hpp"

namespace breakaway::report {
namespace {

using design::AxisDesign;
using design::DesignReport;

constexpr int samples = 200;

// A gnuplot data block of `row(0)` to `row(count - 1)`.
template <class Row>
std::string data_block(std::string_view name, int count, Row row) {
  std::string text = fmt::format("${} << END\n", name);
  for (int i = 0; i < count; ++i) {
    std::string separator;
    for (const double value : row(i)) text += std::exchange(separator, " ") + fmt::format("{:.10g}", value);
    text += '\n';
  }
  return text + "END\n";
}

design::K3<double> law_of(const AxisDesign& axis, double damping_Ns_per_m) {
  return design::K3<double>::make({axis.mass_kg, axis.stiffness_N_per_m, damping_Ns_per_m, axis.friction.lower_N});
}

Picture friction_uncertainty(const AxisDesign& axis, const DesignReport& report) {
  const double critical = axis.kick_damping_Ns_per_m / report.zeta_kick;
  const double widest = std::max(10.0, 2 * report.zeta_kick);
  const auto thresholds = [&](int i) {
    const double zeta = 1 + std::exp(std::log(1e-3) + (std::log(widest - 1) - std::log(1e-3)) * i / (samples - 1));
    const auto law = law_of(axis, zeta * critical);
    return std::array{zeta, exact_ratio_threshold(law.unit()), std::min(ratio_threshold_18(law.unit()), 0.5)};
  };
  const std::string commands =
      format::plot_style + data_block("limits", samples, thresholds) +
      fmt::format(
          "set xlabel 'damping ratio of the kick phase, ζ'\nset ylabel 'f_{{lower}} / f_{{upper}}'\n"
          "set logscale x\nset xtics (1, 1.5, 2, 3, 5, 10, 20, 50, 100)\nset xrange [1:{}]\nset yrange [0:1.05]\n"
          "set label 1 'this axis' at {},{} offset 1,0.6 textcolor '#333333'\n"
          "plot $limits using 1:2:(1.05) with filledcurves fillcolor '#d9efe3' notitle, "
          "$limits using 1:3 with lines linestyle 4 title 'sufficient: (17) or (18)', "
          "$limits using 1:2 with lines linestyle 3 title 'exact limit of Assumption 3', "
          "'+' using ({}):({}) every ::0::0 with points pointtype 7 pointsize 1.3 linecolor '#c8553d' notitle\n",
          widest, report.zeta_kick, report.ratio, report.zeta_kick, report.ratio);
  return {"How uncertain friction may be",
          fmt::format("Above the line every kick ends nearer to the target than it began, whatever the friction does "
                      "within its bounds. This axis: ratio {:.4g} at ζ = {:.4g}, limit {:.4g}.",
                      report.ratio, report.zeta_kick, report.exact_ratio_threshold),
          format::draw_svg("uncertainty", format::width_px, 380, commands)};
}

Picture guaranteed_errors(const AxisDesign& axis, const DesignReport& report) {
  const double rate = std::max(report.contraction_per_kick, 1e-3);
  const double wanted = std::log(axis.position_tolerance_m / report.c_upper_m) / std::log(rate);
  const int kicks = static_cast<int>(std::clamp(std::ceil(wanted), 3.0, 60.0)) + 2;
  const auto bound = [&](int n) {
    return std::array{static_cast<double>(n), report.c_upper_m * std::pow(report.contraction_per_kick, n)};
  };
  const std::string floor =
      report.accuracy_floor_m > 0
          ? fmt::format(", {} with lines linestyle 2 title 'accuracy floor'", report.accuracy_floor_m)
          : std::string{};
  const std::string commands =
      format::plot_style + data_block("bound", kicks, bound) +
      fmt::format(
          "set xlabel 'kicks'\nset ylabel '|position error| [m]'\nset logscale y\nset format y '10^{{%T}}'\n"
          "set xrange [-0.5:*]\n"
          "plot $bound using 1:2 with linespoints linestyle 1 pointtype 7 pointsize 0.5 title 'no worse than', "
          "{} with lines linestyle 4 title 'tolerance asked for'{}\n",
          axis.position_tolerance_m, floor);
  return {"Error after each kick",
          fmt::format("From the edge of the maximal stick set: a kick leaves at most {:.4g} of the error before it, by "
                      "the bounds of friction. Below the accuracy floor a pulse of one period is too coarse.",
                      report.contraction_per_kick),
          format::draw_svg("errors", format::width_px, 360, commands)};
}

Picture impulse_curve(const AxisDesign& axis, const DesignReport& report) {
  const auto law = law_of(axis, axis.kick_damping_Ns_per_m);
  const auto point = [&](int i) {
    const double y = -report.c_upper_m * std::pow(10.0, -6.0 * (samples - 1 - i) / (samples - 1));
    return std::array{-y, law.impulse_Ns(y), law.time_to_go_s(y)};
  };
  const std::string commands =
      format::plot_style + data_block("k3", samples, point) +
      "set multiplot layout 1,2\nset logscale xy\nset format xy '10^{%T}'\nset xlabel '|position error| [m]'\n"
      "set ylabel 'impulse k_3 [N s]'\nplot $k3 using 1:2 with lines linestyle 1 notitle\n"
      "set ylabel 'time to the target [s]'\nplot $k3 using 1:3 with lines linestyle 3 notitle\n";
  return {"The kick law",
          fmt::format("The impulse that takes a resting axis to rest on the target under the least friction, and how "
                      "long it takes; (12) to (15). Tabulated in {} bytes with a proved relative error of {:.3g}.",
                      report.table_bytes, report.table_proved_error),
          format::draw_svg("k3", format::width_px, 340, commands)};
}

Picture period_trade(const AxisDesign& axis, const DesignReport& report) {
  const auto floor = [&](int i) {
    const double period_s = axis.period_s * std::pow(10.0, -1 + 2.0 * i / (samples - 1));
    return std::array{1e3 * period_s, 1e6 * design::accuracy_floor_m(axis.mass_kg, axis.friction, period_s)};
  };
  const std::string commands =
      format::plot_style + data_block("floor", samples, floor) +
      fmt::format(
          "set logscale xy\nset format y '%h'\nset xlabel 'control period [ms]'\nset ylabel 'accuracy [µm]'\n"
          "plot $floor using 1:2 with lines linestyle 1 title 'accuracy floor', "
          "{} with lines linestyle 4 title 'tolerance asked for', "
          "'+' using ({}):({}) every ::0::0 with points pointtype 7 pointsize 1.3 linecolor '#c8553d' title 'this "
          "axis'\n",
          1e6 * axis.position_tolerance_m, 1e3 * axis.period_s, 1e6 * report.accuracy_floor_m);
  return {"Accuracy against control period",
          "What a pulse of one period is sure to do at least, f_upper (f_upper − f_lower) T² / (2 m f_lower): half the "
          "period is a quarter of the floor.",
          format::draw_svg("period", format::width_px, 340, commands)};
}

// The coast "brake"

using design::BrakedClass;
using Braked = design::BrakedDesign<float>;

// What a kick from this reading gives the axis, and how far that leads at most and at least, as shares of the way.
struct DrawnKick {
  double distance_m, impulse_Ns, most_share, least_share;
};

DrawnKick drawn_kick(const BrakedClass& axes, const Braked& braked, double distance_m) {
  const law::Pulse<float> pulse = braked.kicks.table.pulse(static_cast<float>(distance_m));
  const double step_N = axes.force_step_N;
  const double asked_N = std::min(static_cast<double>(pulse.force_N), axes.max_force_N);
  const double force_N = std::floor(asked_N / step_N * (1 + 1e-9)) * step_N;
  return {distance_m, force_N * pulse.periods * axes.period_s,
          most_travel_m(axes, force_N, pulse.periods, pulse.cut_periods) / distance_m,
          least_travel_m(axes, force_N, pulse.periods, pulse.cut_periods) / distance_m};
}

Picture braked_kicks(const BrakedClass& axes, const Braked& braked) {
  const auto point = [&](int i) {
    const double share = static_cast<double>(i) / (samples - 1);
    const DrawnKick kick = drawn_kick(axes, braked, braked.floor_m * std::pow(braked.reach_m / braked.floor_m, share));
    return std::array{kick.distance_m, kick.impulse_Ns, 100 * kick.most_share, 100 * kick.least_share,
                      100 * std::max(1 - kick.most_share, 1e-7)};
  };
  const std::string commands =
      format::plot_style + data_block("kicks", samples, point) +
      "set bmargin 5\nset multiplot layout 1,3\nset logscale x\nset format x '10^{%T}'\nset xlabel 'distance [m]'\n"
      "set xtics rotate\n"
      "set logscale y\nset format y '10^{%T}'\nset ylabel 'force times time [N s]'\n"
      "plot $kicks using 1:2 with lines linestyle 1 notitle\n"
      "unset logscale y\nset format y '%h'\nset yrange [0:105]\nset ylabel 'of the distance [%]'\nset key bottom "
      "right\n"
      "plot $kicks using 1:3 with lines linestyle 1 title 'at most', "
      "$kicks using 1:4 with lines linestyle 3 title 'at least'\n"
      "set logscale y\nset format y '10^{%T}'\nset yrange [*:*]\nset ylabel 'not aimed for [%]'\n"
      "plot $kicks using 1:5 with lines linestyle 4 notitle\n";
  return {"The kicks",
          fmt::format(
              "From the floor of {:.4g} m to the reach of {:.4g} m: what a kick gives the axis, how far it moves any "
              "axis of the class, and what it leaves of the distance even under the least friction, by steps of force "
              "and the table's {} bytes.",
              braked.floor_m, braked.reach_m, braked.table_bytes),
          format::draw_svg("braked_kicks", format::width_px, 340, commands)};
}

double floor_um(BrakedClass axes, double period_s, double lag_s) {
  axes.period_s = period_s;
  axes.lag_s = {lag_s, lag_s};
  axes.move.reset();
  const auto braked = design::design_braked_kicks<float>(axes);
  return braked.possible() ? 1e6 * braked.floor_m : std::numeric_limits<double>::quiet_NaN();
}

Picture braked_floor(const BrakedClass& axes, const Braked& braked, double tolerance_m) {
  constexpr int periods = 13;
  const auto floors = [&](int i) {
    const double period_s = axes.period_s * std::pow(2.0, -3 + 0.5 * i),
                 own_s = (axes.lag_s.least + axes.lag_s.most) / 2;
    return std::array{1e3 * period_s, floor_um(axes, period_s, 0), floor_um(axes, period_s, own_s),
                      floor_um(axes, period_s, period_s), floor_um(axes, period_s, 5 * period_s)};
  };
  const std::string commands =
      format::plot_style + data_block("floors", periods, floors) +
      fmt::format(
          "set logscale xy\nset format y '%h'\nset xlabel 'control period [ms]'\nset ylabel 'accuracy floor [µm]'\n"
          "set key top left\n"
          "plot $floors using 1:2 with lines linestyle 3 title 'no lag', "
          "$floors using 1:3 with lines linestyle 1 title 'lag of this axis', "
          "$floors using 1:4 with lines linestyle 2 title 'lag of a period', "
          "$floors using 1:5 with lines linestyle 2 dashtype 2 title 'lag of five periods', "
          "{} with lines linestyle 4 title 'tolerance asked for', "
          "'+' using ({}):({}) every ::0::0 with points pointtype 7 pointsize 1.3 linecolor '#c8553d' title 'this "
          "axis'\n",
          1e6 * tolerance_m, 1e3 * axes.period_s, 1e6 * braked.floor_m);
  return {"Accuracy against control period and lag",
          "From this error on each kick takes 3 % at least away, for every axis of the class. Lags of the lines are "
          "exact; that of this axis is as "
          "uncertain as the file says.",
          format::draw_svg("braked_floor", format::width_px, 360, commands)};
}

std::vector<Picture> draw_braked_pictures(const AxisDesign& axis) {
  const auto braked = design::design_braked_kicks<float>(*axis.braked);
  if (!braked.possible()) return {};
  return {braked_kicks(*axis.braked, braked), braked_floor(*axis.braked, braked, axis.position_tolerance_m)};
}

}  // namespace

std::vector<Picture> draw_design_pictures(const AxisDesign& axis, const DesignReport& report) {
  if (axis.braked) return draw_braked_pictures(axis);
  std::vector<Picture> pictures{friction_uncertainty(axis, report), guaranteed_errors(axis, report),
                                impulse_curve(axis, report)};
  if (report.accuracy_floor_m > 0) pictures.push_back(period_trade(axis, report));
  return pictures;
}

}  // namespace breakaway::report
