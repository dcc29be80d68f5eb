#include "breakaway/report/tune_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/plot_style.hpp"

namespace breakaway::report {
namespace {

using study::Objective;
using study::TunedPoint;
using study::Tuning;

constexpr int row_px = 34, upper_px = 430;

// Where a set of gains stands on the horizontal axis, and what that axis is.
struct Abscissa {
  std::string_view label;
  double (*of)(const TunedPoint&);
};

double approach_speed_m_s(const TunedPoint& p) {
  const double moved_m_s = p.gains.move ? p.gains.move->speed_m_s : config::unlimited;
  return std::min(p.gains.max_approach_speed_m_s, moved_m_s);
}

// For one axis only the stiffness counts, so that its mass may be left out.
double stiffness_N_per_m(const TunedPoint& p) { return p.gains.stiffness_N_per_m; }
double force_N(const TunedPoint& p) { return p.peak_force_N; }

Abscissa abscissa_of(const Tuning& tuning) {
  if (tuning.objective == Objective::gentle && std::isfinite(tuning.chosen.peak_force_N))
    return {"peak force [N]", force_N};
  if (tuning.chosen.gains.coast == law::Coast::pd || !std::isfinite(approach_speed_m_s(tuning.chosen)))
    return {"k_1 [N/m]", stiffness_N_per_m};
  return {"greatest speed of the approach [m/s]", approach_speed_m_s};
}

// A data block `$name` of the points that are wanted; without any, of one that is not drawn.
template <class Wanted>
std::string points(std::string_view name, const Tuning& tuning, const Abscissa& x, Wanted wanted) {
  std::string text = fmt::format("${} << END\n", name);
  for (const TunedPoint& p : tuning.tried) {
    if (p.good() && std::isfinite(x.of(p)) && wanted(p))
      text += fmt::format("{:g} {:g}\n", x.of(p), p.worst_settling_s);
  }
  return text + "NaN NaN\nEND\n";
}

std::size_t most_laws(const Tuning& tuning) { return tuning.chosen.laws; }

// What is compared below: less is better.
double measure(const Tuning& tuning, const TunedPoint& point, double least_tolerance_m) {
  if (tuning.objective == Objective::accuracy) return least_tolerance_m;
  return tuning.objective == Objective::gentle ? point.peak_force_N : point.worst_settling_s;
}

std::string_view measured(const Tuning& tuning) {
  if (tuning.objective == Objective::accuracy) return "least tolerance that is certified [m]";
  return tuning.objective == Objective::gentle ? "peak force [N]" : "worst settling time [s]";
}

std::string upper(const Tuning& tuning) {
  const Abscissa x = abscissa_of(tuning);
  const auto in_full = [&](const TunedPoint& p) { return p.laws == most_laws(tuning); };
  std::string text = points("full", tuning, x, [&](const TunedPoint& p) { return in_full(p) && !p.gains.move; }) +
                     points("few", tuning, x, [&](const TunedPoint& p) { return !in_full(p) && !p.gains.move; }) +
                     points("fullmove", tuning, x, [&](const TunedPoint& p) { return in_full(p) && p.gains.move; }) +
                     points("fewmove", tuning, x, [&](const TunedPoint& p) { return !in_full(p) && p.gains.move; });
  double slowest_s = tuning.chosen.worst_settling_s;
  for (const TunedPoint& p : tuning.tried)
    if (p.good()) slowest_s = std::max(slowest_s, p.worst_settling_s);
  text += fmt::format(
      "set title 'Tuned for {}: the gains that were tried, {:g} m from the target'\nset xlabel '{}'\n"
      "set ylabel 'worst settling time [s]'\nset yrange [0:{:g}]\nset key outside above left\n",
      study::to_string(tuning.objective), tuning.distance_m, x.label, 1.1 * slowest_s);
  if (x.of == approach_speed_m_s && std::isfinite(tuning.fastest_m_s))
    text += fmt::format(
        "set arrow 1 from {0:g}, graph 0 to {0:g}, graph 1 nohead linestyle 4\n"
        "set label 1 'the force reaches' at {0:g}, graph 0.06 right offset -0.7,0 textcolor '#777777'\n",
        tuning.fastest_m_s);
  return text + fmt::format(
                    "plot $full with points pointtype 7 pointsize 0.9 linecolor '#1c5d99' title 'under {0} laws', "
                    "$few with points pointtype 6 pointsize 0.9 linecolor '#1c5d99' title 'at least, under fewer', "
                    "$fullmove with points pointtype 9 linecolor '#2a7f62' title 'with [move], under {0} laws', "
                    "$fewmove with points pointtype 8 linecolor '#2a7f62' title 'with [move], at least', "
                    "'+' using ({1:g}):({2:g}) every ::0::0 with points pointtype 6 pointsize 2.2 linewidth 2 "
                    "linecolor '#c8553d' title 'chosen: {2:.3g} s'\n",
                    tuning.chosen.laws, x.of(tuning.chosen), tuning.chosen.worst_settling_s);
}

// One bar: its height is its place, from above, and its label what is twice as good.
struct Bar {
  std::string label;
  double value;
};

std::vector<Bar> bars_of(const Tuning& tuning) {
  std::vector<Bar> bars{{"as it is", measure(tuning, tuning.chosen, tuning.least_tolerance_m)}};
  for (const study::DoubledLimit& limit : tuning.limits) {
    const bool possible = limit.why_not.empty();
    const double none = std::numeric_limits<double>::quiet_NaN();
    bars.push_back({limit.name + " twice as good" + (possible ? "" : ": not possible"),
                    possible ? measure(tuning, limit.best, limit.least_tolerance_m) : none});
  }
  return bars;
}

std::string lower(const Tuning& tuning) {
  const std::vector<Bar> bars = bars_of(tuning);
  std::string data = "$bars << END\n", tics;
  double most = 0;
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const auto place = -static_cast<double>(i);
    if (!std::isnan(bars[i].value)) {
      data += fmt::format("{:g} {:g} {:d} \"{:.3g}\"\n", bars[i].value, place, i == 0, bars[i].value);
      most = std::max(most, bars[i].value);
    }
    tics += fmt::format("{}'{}' {:g}", i > 0 ? ", " : "", bars[i].label, place);
  }
  return data +
         fmt::format(
             "END\nunset title\nunset arrow\nunset label\nunset key\nset xlabel '{}'\nunset ylabel\nset lmargin 34\n"
             "set xrange [0:{:g}]\nset yrange [{:g}:0.6]\nset ytics ({})\nset style fill solid 1 noborder\n"
             "set grid noytics\n"
             "plot $bars using 1:2:(0):1:($2-0.3):($2+0.3):($3 > 0 ? 0xc8553d : 0x1c5d99) with boxxyerror "
             "linecolor rgbcolor variable, $bars using 1:2:4 with labels left offset 0.7,0 textcolor '#333333'\n",
             measured(tuning), 1.12 * most, -static_cast<double>(bars.size()) + 0.4, tics);
}

}  // namespace

std::string draw_tuning(const std::string& path, const Tuning& tuning) {
  if (tuning.limits.empty())
    return format::draw_file(path, format::width_px, upper_px, format::plot_style + upper(tuning));
  const int lower_px = 90 + row_px * static_cast<int>(tuning.limits.size() + 1), all_px = upper_px + lower_px;
  const double share = static_cast<double>(lower_px) / all_px;
  return format::draw_file(path, format::width_px, all_px,
                           format::plot_style + "set multiplot\n" +
                               fmt::format("set origin 0,{:g}\nset size 1,{:g}\n", share, 1 - share) + upper(tuning) +
                               fmt::format("set origin 0,0\nset size 1,{:g}\n", share) + lower(tuning) +
                               "unset multiplot\n");
}

}  // namespace breakaway::report
