#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "breakaway/tradeoff/frontiers.hpp"

namespace breakaway::tradeoff {
namespace {

constexpr const char* title = R"(# Speed against accuracy

Measured and written by `breakaway tradeoff --page sim/TRADEOFF.md --picture sim/tradeoff.svg`. )";

constexpr const char* about_counts =
    R"(Instructions are counted under valgrind and do
not depend on how busy the machine is; times are ratios within the run, the least of five, and do.)";

constexpr const char* about_ratios =
    R"(Costs are ratios of times within the
run: instructions were not counted, because valgrind is not installed or a quick look was asked for.)";

constexpr const char* picture = R"(

![error against cost](tradeoff.svg)

## I have this axis and want this accuracy

**What do I write?** Say how exact, and not how: `accuracy_m = 1e-6` in the table `[run]` of your scene, or on the command line

    breakaway simulate my_axis.toml --accuracy 1e-6

It is the largest error, in metres, that a position may have: of an axis on its whole way, of a `[machine]` at the end of the run. The
cheapest method and step that hold it on your scene are found by trying them, and taken. The answer names them, and the error that they
make: at most twice `error_estimate_m`, in 99 of 100 cases. What nothing can hold is refused in one line, with the reason and the cost.
An `integrator` that you name yourself is kept, and only its step or tolerance is chosen. A run that would take many times the work of those
below is refused within seconds, with its cause, its cost and what to do.

**What does it cost?** That depends on the scene, so ask for yours: every method with its error and cost, and the choice among them, are
told and drawn by

    breakaway tradeoff my_axis.toml --accuracy 1e-6 --picture my_axis.svg

Three scenes of this project, in processor time of a run on one core of a PC; to find the method takes some ten runs:

)";

constexpr const char* about_left_out =
    R"(**Which parts of my scene do I need?** The same command runs the scene without each of its parts. A part may be left out at X if no position
on the way changes by more than X. "For the end only": the way changes by more, but not where the axis comes to rest. Of
`can_axis.toml` at {:g} m, with the share of the processor time that leaving the part out saves:

)";

constexpr const char* which_method =
    R"(What is known is that an axis whose friction is constant is a closed form: there is no tolerance to choose, and less accuracy saves
nothing. In a rigid axis on the bus most of the work is bus, drive and controller, so that a loose tolerance saves a third at most; in an
axis that is more, most of it is the motion: the end of this page has what each part costs. A machine under constant friction is cheapest
from event to event unless a hundredth of its motion will do.

## Which method to take

)";

constexpr std::string_view advice_on_integrators =
    R"(- **A linear machine with Coulomb friction: event-driven.** There is no step to choose, and it errs by rounding only.
  Midpoint steps of 1 ms cost {} times as much, for an error of {} m.
- **Friction that varies with speed, position or time: adaptive.** Steps of high order from event to event; the tolerance is
  relative. On constant friction, where it can be compared, {} m cost {} times the event-driven method.
- **Time stepping by the midpoint rule** where events crowd, where more than 16 directions rub, or where a part in a
  thousand will do. Its order is one, because a velocity that passes through zero stops at the end of a step: a tenth of
  the error costs ten times the work.
- **Implicit Euler (theta = 1): never for a machine whose damping is not positive semidefinite.** Its numerical damping
  brings unstable machines to rest, and the result does not show it: at h = 0.01 s {} % of the answers below are wrong.
  `TimeStepping::warning()` says so.
)";

constexpr const char* advice =
    R"(- **The impulsive law: never by time stepping.** No step is short enough: it does not settle but kicks for ever in a ball of
  f_lo h² / (8 m). `breakaway simulate` is event-driven and ends on the proof of eq. (19).
- **k3 on the controller: cubic Hermite in sqrt|y|, 267 nodes of float** (`law::K3Table`). In float nothing is much more
  accurate on any plant, and the cost does not grow with the accuracy. With 200 bytes left take fewer nodes or a Chebyshev
  series, and check the error for your zeta: it grows with it. Linear interpolation is cheaper and needs many more nodes.
  The exact law costs tens of times as much and is for design. Never tabulate k3 itself over y: near the target it is wrong
  by everything.
- **Control period: what can be guaranteed goes with its square.** Halving the period quarters the accuracy floor. Ask for the
  floor as the tolerance. Less is often reached, because the law learns from kicks that did not move the axis, but nothing
  guarantees it. Once the floor is below a count of the encoder, a shorter period buys nothing.
- **A scenario: name only what the question needs.** A question about the law alone needs neither drive nor bus. Constant friction
  and a drive without lag keep the plant in closed form; friction that varies with speed or time, and a lag, must be
  integrated.

)";

constexpr const char* about_integrators = R"(## Integrators

The two-mass example of van de Wouw & Leine (stability properties of equilibrium sets), section 4. Error: the largest of a
final coordinate, and that of the settling time; the mean over 17 starts against the event-driven method, of that method
against a computation with 25 digits from (2.5, -1). Order: from the row above. Wrong: share of a grid of starts
at rest, |x| <= 5 m, with the wrong answer to "does it come to rest?". Cost: the trajectory from (2.5, -1) until it rests; time
in units of the event-driven one's.

)";

constexpr const char* about_balls =
    R"(Time stepping of the impulsive example (section V of van de Wouw & Leine, impulsive control) has no end to report: it kicks
for ever within a ball around the target, where the exact solution has been at rest since 4.8638 s.

)";

constexpr const char* about_evaluators = R"(## Evaluators of k3

Largest relative error over (0, c_upper], from 1e-12 c_upper on, against the exact law with 64 bits of significand. Mild: the
plant of section V. Hard: zeta = 10, f_lo / f_hi = 0.1. All but the naive one tabulate R = |k3| / sqrt|y| over sqrt|y|. Cost: one
call without the loop around it; time in units of cubic Hermite, float, 267 nodes. `law::K3Table` as it is built has its nodes
lifted a little, which halves the error of coarse tables, and its error is proved.

)";

constexpr const char* about_periods = R"(## Control period

The flashed law in `scenarios/can_axis.toml` from 0.1 m, under friction at both bounds, the scenario's own law, static and kinetic
friction, and random laws. Floor: f_hi (f_hi - f_lo) / (2 m f_lo) T², the least move of a kick that is sure to move the axis.
Tolerance and worst error in floors. Settled: at rest within the tolerance and one count, after at most 6 s.

)";

constexpr const char* about_scenario_parts = R"(## Parts of a scenario

Cost of one simulated second with two moves, without setting up; time in units of the first row's, none where it drowns in that
of setting up. Each row changes the one part that it names, so that the difference to the first row is what the part costs.
The ideal law ends when it has arrived.

)";

std::string number(double value, const char* format = "{:.2g}") {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "";
}

// 12 345 678
std::string count(double value) {
  if (!std::isfinite(value)) return "";
  const std::string digits = fmt::format("{:.0f}", value);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ' ';
    text += digits[i];
  }
  return text;
}

std::string cost(const Cost& cost) { return count(cost.instructions) + " | " + number(cost.time_ratio, "{:.3g}"); }

template <class Rows, class Line>
std::string table(std::string_view head, const Rows& rows, Line line) {
  std::string text = fmt::format("| {} |\n|", head);
  for (auto columns = std::ranges::count(head, '|') + 1; columns > 0; --columns) text += "---|";
  for (const auto& row : rows) text += fmt::format("\n| {} |", line(row));
  return text + "\n\n";
}

std::string step(const IntegratorRow& r) {
  if (r.step_s > 0) return fmt::format("{:g} s", r.step_s);
  return r.tolerance > 0 ? fmt::format("tolerance {:g}", r.tolerance) : "";
}

std::string integrators(const Frontiers& f) {
  return table("method | step | error [m] | settling time error [s] | order | wrong [%] | steps | instructions | time",
               f.integrators, [](const IntegratorRow& r) {
                 return fmt::format("{} | {} | {} | {} | {} | {} | {} | {}", r.method, step(r), number(r.error_m),
                                    number(r.time_error_s), number(r.order), number(100 * r.wrong_share),
                                    count(r.steps), cost(r.trajectory));
               });
}

std::string balls(const Frontiers& f) {
  return table("step [s] | ball [m] | f_lo h² / (8 m) [m] | kicks a step", f.balls, [](const BallRow& r) {
    return fmt::format("{:g} | {:.4g} | {:.4g} | {:.3g}", r.step_s, r.ball_m, r.predicted_m, r.kicks_per_step);
  });
}

std::string evaluators(const Frontiers& f) {
  return table("evaluator | scalar | nodes | bytes | error, mild | error, hard | instructions | time", f.evaluators,
               [](const EvaluatorRow& r) {
                 return fmt::format("{} | {} | {} | {} | {} | {} | {}", r.method, r.scalar,
                                    r.nodes > 0 ? fmt::format("{}", r.nodes) : "", r.bytes, number(r.mild_error),
                                    number(r.hard_error), cost(r.call));
               });
}

std::string periods(const Frontiers& f) {
  return table("period [ms] | floor [um] | encoder [um] | tolerance | settled | worst error | worst error [um]",
               f.periods, [](const PeriodRow& r) {
                 return fmt::format("{:g} | {:.3g} | {:.2g} | {:g} | {} of {} | {:.2g} | {:.2g}", 1e3 * r.period_s,
                                    1e6 * r.floor_m, 1e6 * r.resolution_m, r.tolerance_m / r.floor_m, r.settled, r.runs,
                                    r.worst_error_m / r.floor_m, 1e6 * r.worst_error_m);
               });
}

std::string scenario_parts(const Frontiers& f) {
  return table("scenario | instructions | time", f.scenario_parts,
               [](const ScenarioPartRow& r) { return fmt::format("{} | {}", r.scenario, cost(r.second)); });
}

IntegratorRow row_of(const Frontiers& f, const char* method, double step_s) {
  const auto found = std::ranges::find_if(f.integrators, [&](const IntegratorRow& r) {
    return r.method == method && std::fabs(r.step_s - step_s) <= 0.01 * step_s;
  });
  return found == f.integrators.end() ? IntegratorRow{} : *found;
}

std::string with_figures(std::string_view text, const Frontiers& f) {
  const IntegratorRow midpoint = row_of(f, "midpoint", 1e-3), implicit = row_of(f, "implicit Euler", 1e-2);
  const auto adaptive = std::ranges::find(f.integrators, 1e-8, &IntegratorRow::tolerance);
  const Cost& one = f.integrators.front().trajectory;
  const auto times = [&](const Cost& other) {
    return number(f.counted ? other.instructions / one.instructions : other.time_ratio / one.time_ratio);
  };
  return fmt::format(fmt::runtime(text), times(midpoint.trajectory), number(midpoint.error_m),
                     number(adaptive->error_m), times(adaptive->trajectory), number(100 * implicit.wrong_share));
}

std::string asked(const Frontiers& f) {
  return table("scene | asked for [m] | taken | error [m] | cost [ms]", f.asked, [](const AskedRow& r) {
    return fmt::format("{} | {:g} | {} | {} | {:.3g}", r.scene, r.asked_m, r.method, number(r.error_m), 1e3 * r.cost_s);
  });
}

std::string left_out(const Frontiers& f) {
  return fmt::format(fmt::runtime(about_left_out), parts_asked_m) +
         table("part | at the end [m] | on the way [m] | saves [%] | may be left out", f.left_out,
               [](const LeftOutPart& r) {
                 const char* verdict = r.may_be_left_out(parts_asked_m) ? "yes"
                                       : r.end_m <= parts_asked_m       ? "for the end only"
                                                                        : "no";
                 return fmt::format("{} | {} | {} | {:.0f} | {}", r.name, number(r.end_m), number(r.way_m),
                                    100 * r.saved_share, verdict);
               });
}

}  // namespace

std::string to_page(const Frontiers& f) {
  return std::string{title} + (f.counted ? about_counts : about_ratios) + picture + asked(f) + left_out(f) +
         which_method + with_figures(advice_on_integrators, f) + advice + about_integrators + integrators(f) +
         about_balls + balls(f) + about_evaluators + evaluators(f) + about_periods + periods(f) + about_scenario_parts +
         scenario_parts(f);
}

}  // namespace breakaway::tradeoff
