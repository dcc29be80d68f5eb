#include <fmt/format.h>

#include <cmath>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/tradeoff/frontiers.hpp"

namespace breakaway::tradeoff {
namespace {

constexpr int width_px = 1200, height_px = 900;

constexpr const char* style = R"(
set encoding utf8
set border 3 linecolor '#888888'
set tics nomirror out textcolor '#333333'
set grid linecolor '#dcdfe2' linetype 1 linewidth 0.6
set key inside Left reverse samplen 2 textcolor '#333333' opaque
set style line 1 linecolor '#1c5d99' linewidth 1.8 pointtype 7 pointsize 0.6
set style line 2 linecolor '#c8553d' linewidth 1.8 pointtype 5 pointsize 0.6
set style line 3 linecolor '#2a7f62' linewidth 1.8 pointtype 9 pointsize 0.8
set style line 4 linecolor '#777777' linewidth 1.2 dashtype 2
set style line 5 linecolor '#8f6bb3' linewidth 1.8 pointtype 13 pointsize 0.9
)";

double cost_of(const Frontiers& f, const Cost& cost) { return f.counted ? cost.instructions : cost.time_ratio; }

const char* unit(const Frontiers& f) { return f.counted ? "instructions" : "ratio of times"; }

// A gnuplot data block `$name` of the rows for which `wanted` holds; empty ones get a row that is not drawn.
template <class Rows, class Wanted, class Line>
std::string block(const std::string& name, const Rows& rows, Wanted wanted, Line line) {
  std::string text = fmt::format("${} << END\n", name);
  for (const auto& row : rows) {
    if (wanted(row)) text += line(row) + "\n";
  }
  return text + "NaN NaN NaN\nEND\n";
}

std::string plot_integrators(const Frontiers& f) {
  std::string text;
  for (const auto& [name, method] : {std::pair{"driven", "event-driven"}, std::pair{"adaptive", "adaptive"},
                                     std::pair{"midpoint", "midpoint"}, std::pair{"implicit", "implicit Euler"}}) {
    text += block(
        name, f.integrators, [&, wanted = std::string{method}](const IntegratorRow& r) { return r.method == wanted; },
        [&](const IntegratorRow& r) {
          // The reference itself is right to rounding.
          return fmt::format("{:g} {:g} {:g}", cost_of(f, r.trajectory), std::fmax(r.error_m, 1e-15), r.step_s);
        });
  }
  return text + fmt::format(R"(
set title 'Integrators: error and cost of a trajectory'
set logscale xy
set format xy '10^{{%T}}'
set xlabel '{}'
set ylabel 'error of the final position [m]'
set key center left
plot $midpoint using 1:2 with linespoints linestyle 1 title 'midpoint', \
     $implicit using 1:2 with linespoints linestyle 2 title 'implicit Euler', \
     $adaptive using 1:2 with linespoints linestyle 5 title 'adaptive', \
     $driven using 1:2 with points linestyle 3 pointsize 1.4 title 'event-driven'
)",
                            unit(f));
}

std::string order(const Frontiers& f) {
  return block(
             "ball", f.balls, [](const BallRow&) { return true; },
             [](const BallRow& r) { return fmt::format("{:g} {:g} {:g}", r.step_s, r.ball_m, r.predicted_m); }) +
         R"(
set title 'Time stepping: error against the step'
set xlabel 'step h [s]'
set ylabel 'error, or size of the ball [m]'
set key bottom right
plot $midpoint using 3:2 with linespoints linestyle 1 title 'midpoint', \
     $implicit using 3:2 with linespoints linestyle 2 title 'implicit Euler', \
     $ball using 1:2 with points linestyle 5 title 'ball, impulsive example', \
     $ball using 1:3 with lines linestyle 4 title 'f_{lo} h^2 / (8 m)'
)";
}

std::string plot_evaluators(const Frontiers& f) {
  std::string text;
  for (const auto& [name, method] :
       {std::pair{"nearest", "nearest node"}, std::pair{"linear", "linear"}, std::pair{"cubic", "cubic Hermite"},
        std::pair{"series", "Chebyshev"}, std::pair{"exact", "exact"}}) {
    text += block(
        name, f.evaluators,
        [wanted = std::string{method}](const EvaluatorRow& r) { return r.method == wanted && r.scalar == "float"; },
        [&](const EvaluatorRow& r) { return fmt::format("{:g} {:g} {}", cost_of(f, r.call), r.hard_error, r.bytes); });
  }
  return text + fmt::format(R"(
set title 'k3 in float, hard plant: error, cost, bytes'
set xlabel '{} of a call'
set ylabel 'largest relative error'
set offsets graph 0.05, graph 0.12, graph 0.05, graph 0.02
set key top right
plot $nearest using 1:2 with points linestyle 4 pointtype 4 title 'nearest', \
     $linear using 1:2 with linespoints linestyle 2 title 'linear', \
     $cubic using 1:2 with linespoints linestyle 1 title 'cubic Hermite', \
     $series using 1:2 with linespoints linestyle 5 title 'Chebyshev', \
     $exact using 1:2 with points linestyle 3 title 'exact', \
     $nearest using 1:2:(sprintf('%d B ', $3)) with labels right offset -0.8,0 font ',11' notitle, \
     $linear using 1:2:(sprintf('%d B ', $3)) with labels right offset -0.8,0 font ',11' notitle, \
     $cubic using 1:2:(sprintf(' %d B', $3)) with labels left offset 0.8,0 font ',11' notitle, \
     $series using 1:2:(sprintf(' %d B', $3)) with labels left offset 0.8,0 font ',11' notitle
unset offsets
)",
                            unit(f));
}

std::string plot_periods(const Frontiers& f) {
  const auto at_floor = [](const PeriodRow& r) { return std::fabs(r.tolerance_m / r.floor_m - 1) < 1e-9; };
  const auto fine = [](const PeriodRow& r) { return r.resolution_m < r.floor_m / 40; };
  const auto line = [](const PeriodRow& r) {
    return fmt::format("{:g} {:g} {:g}", 1e3 * r.period_s, 1e6 * r.worst_error_m, 1e6 * r.floor_m);
  };
  return block(
             "fine", f.periods, [&](const PeriodRow& r) { return at_floor(r) && fine(r); }, line) +
         block(
             "scenario", f.periods, [&](const PeriodRow& r) { return at_floor(r) && !fine(r); }, line) +
         R"(
set title 'Control period: worst error reached'
set xlabel 'control period [ms]'
set ylabel 'worst error at rest [um]'
set key top left
set format xy '%g'
set xtics (0.5, 1, 2, 4)
set xrange [0.4:5]
plot $fine using 1:2 with linespoints linestyle 1 title 'fine encoder', \
     $scenario using 1:2 with linespoints linestyle 2 title 'encoder of 1 um', \
     $fine using 1:3 with lines linestyle 4 title 'accuracy floor'
)";
}

}  // namespace

std::string to_svg(const Frontiers& f) {
  return format::draw_svg(
             "tradeoff", width_px, height_px,
             std::string{style} + "set multiplot layout 2,2 margins 0.08,0.98,0.09,0.95 spacing 0.1,0.17\n" +
                 plot_integrators(f) + order(f) + plot_evaluators(f) + plot_periods(f) + "unset multiplot\n") +
         "\n";
}

}  // namespace breakaway::tradeoff
