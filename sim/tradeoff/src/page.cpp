#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "breakaway/tradeoff/frontiers.hpp"

namespace breakaway::tradeoff {
namespace {

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
std::string table(const char* head, const Rows& rows, Line line) {
  std::string text = std::string{head} + "\n|";
  for (auto columns = std::count(head, head + std::string_view{head}.size(), '|') - 1; columns > 0; --columns)
    text += "---|";
  for (const auto& row : rows) text += fmt::format("\n| {} |", line(row));
  return text + "\n\n";
}

std::string integrators(const Frontiers& f) {
  return "## Integrators\n\n"
         "Two-mass example of van de Wouw & Leine (stability properties of equilibrium sets), section 4. Error: mean "
         "over 17 "
         "starts of the largest\nerror of a final coordinate, and of the settling time, against the event-driven "
         "method, "
         "which is the closed form of each mode.\nOrder: from the row above. Wrong: share of a grid of starts, |x| <= "
         "5 "
         "m, with the wrong answer to \"does it come to rest?\".\nCost: the trajectory from (2.5, -1) at rest until it "
         "rests; the time is in units of the event-driven one's.\n\n" +
         table(
             "| method | step [s] | error [m] | settling time error [s] | order | wrong [%] | steps | instructions | "
             "time |",
             f.integrators,
             [](const IntegratorRow& r) {
               return fmt::format("{} | {} | {} | {} | {} | {} | {} | {}", r.method,
                                  r.step_s > 0 ? number(r.step_s, "{:g}") : "", number(r.error_m),
                                  number(r.time_error_s), number(r.order), number(100 * r.wrong_share), count(r.steps),
                                  cost(r.trajectory));
             }) +
         "Time stepping of the impulsive example (section V of van de Wouw & Leine, impulsive control) has no end to "
         "report: it kicks for ever\nwithin a ball of radius f_lo h² / (8 m), where the exact solution rests on the "
         "target after 4.8638 s.\n\n" +
         table("| step [s] | ball [m] | f_lo h² / (8 m) [m] | kicks a step |", f.balls, [](const BallRow& r) {
           return fmt::format("{:g} | {:.4g} | {:.4g} | {:.3g}", r.step_s, r.ball_m, r.predicted_m, r.kicks_per_step);
         });
}

std::string evaluators(const Frontiers& f) {
  return "## Evaluators of k3\n\n"
         "Largest relative error over (0, c_upper], from 1e-12 c_upper on, against 64-bit-significand arithmetic. "
         "Mild: the plant of "
         "section V. Hard: zeta = 10,\nf_lo / f_hi = 0.1. All but the naive one tabulate R = |k3| / sqrt|y| over "
         "sqrt|y|. Cost: one call, the loop around it taken off; the time is in\nunits of the flashed table's (cubic "
         "Hermite, float, 267 nodes). `law::K3Table` proves its error when it is built; its nodes are lifted a\nlittle "
         "to halve it.\n\n" +
         table("| evaluator | scalar | nodes | bytes | error, mild | error, hard | instructions | time |", f.evaluators,
               [](const EvaluatorRow& r) {
                 return fmt::format("{} | {} | {} | {} | {} | {} | {}", r.method, r.scalar,
                                    r.nodes > 0 ? fmt::format("{}", r.nodes) : "", r.bytes, number(r.mild_error),
                                    number(r.hard_error), cost(r.call));
               });
}

std::string periods(const Frontiers& f) {
  return "## Control period\n\n"
         "The flashed law on `scenarios/can_axis.toml` from 0.1 m, under friction at both bounds, the scene's own law, "
         "static/kinetic and random laws.\nFloor: f_hi (f_hi - f_lo) / (2 m f_lo) T², the least distance that a kick "
         "which "
         "is sure to move the axis may move it. Tolerance and\nworst error in floors; settled means at rest within the "
         "tolerance and one count.\n\n" +
         table("| period [ms] | floor [um] | encoder [um] | tolerance | settled | worst error | worst error [um] |",
               f.periods, [](const PeriodRow& r) {
                 return fmt::format("{:g} | {:.3g} | {:.2g} | {:g} | {} of {} | {:.2g} | {:.2g}", 1e3 * r.period_s,
                                    1e6 * r.floor_m, 1e6 * r.resolution_m, r.tolerance_m / r.floor_m, r.settled, r.runs,
                                    r.worst_error_m / r.floor_m, 1e6 * r.worst_error_m);
               });
}

std::string scene_parts(const Frontiers& f) {
  return "## Parts of a scene\n\n"
         "Cost of one simulated second with two moves, less what setting up costs; the time is in units of the first "
         "row's. Each row changes the\none part that it names.\n\n" +
         table("| scene | instructions | time |", f.scene_parts,
               [](const ScenePartRow& r) { return fmt::format("{} | {}", r.scene, cost(r.second)); });
}

const IntegratorRow* integrator_at(const Frontiers& f, const char* method, double step_s) {
  const auto found = std::ranges::find_if(f.integrators, [&](const IntegratorRow& r) {
    return r.method == method && std::fabs(r.step_s - step_s) <= 0.01 * step_s;
  });
  return found == f.integrators.end() ? nullptr : &*found;
}

std::string costs_more(const Frontiers& f, const IntegratorRow& row) {
  const Cost &one = f.integrators.front().trajectory, &other = row.trajectory;
  return number(f.counted ? other.instructions / one.instructions : other.time_ratio, "{:.2g}");
}

std::string advice(const Frontiers& f) {
  std::string text = "## Which method to take\n\n";
  const IntegratorRow* midpoint = integrator_at(f, "midpoint", 1e-3);
  const IntegratorRow* implicit = integrator_at(f, "implicit Euler", 1e-2);
  text +=
      "- **A linear machine with Coulomb friction: event-driven.** It has no step to choose, errs by rounding only and "
      "proves that a machine\n  rests.";
  if (midpoint != nullptr) {
    text += fmt::format(" Midpoint steps of 1 ms cost {} times as much for an error of {} m.", costs_more(f, *midpoint),
                        number(midpoint->error_m));
  }
  text +=
      "\n- **Time stepping by the midpoint rule** where events crowd or come by the thousand, where more than 16 "
      "directions rub, or where 1e-2\n  or 1e-3 of accuracy will do. It is of the first order, because velocities stop "
      "at the "
      "ends of steps: ten times the accuracy costs ten\n  times the work.\n"
      "- **Implicit Euler (theta = 1): never for a machine whose damping is not positive semidefinite.** Its numerical "
      "damping brings unstable\n  machines to rest, and nothing in the result shows it";
  if (implicit != nullptr && implicit->wrong_share > 0)
    text += fmt::format(": at h = 0.01 s {} % of the answers below are wrong", number(100 * implicit->wrong_share));
  text +=
      ". `TimeStepping::warning()` says so.\n"
      "- **The impulsive law: never by time stepping.** No step is short enough: it does not settle but keeps kicking "
      "in a ball of f_lo h² / (8 m).\n  `breakaway simulate` is event-driven and ends on the proof of eq. (19).\n"
      "- **k3 on the controller: cubic Hermite in sqrt|y|, 267 nodes of float** (`law::K3Table`): no evaluator is more "
      "accurate in "
      "float, whatever the\n  plant, and its cost does not depend on the accuracy. With 200 bytes left, take fewer "
      "nodes or a "
      "Chebyshev series, and check the error for\n  your zeta: it grows with it. Linear interpolation is a little "
      "cheaper and needs "
      "many more nodes. The exact law costs tens of times as much\n  and is for design. Never tabulate k3 itself over "
      "y: "
      "near the target it is wrong by everything.\n"
      "- **Control period: the accuracy that is guaranteed goes with its square.** Halving the period quarters the "
      "floor. Ask for the floor as the "
      "tolerance:\n  every run below settles within it. Less is often reached, because the law learns from kicks that "
      "did not "
      "move the axis, but it is not\n  guaranteed. Once the floor is below a count of the encoder, a shorter period "
      "buys nothing.\n"
      "- **A scene: name only what the question needs.** Questions about the law alone need no drive and no bus: the "
      "ideal "
      "law and the sampled law\n  without a drive are cheapest. Friction that is constant between events, and a drive "
      "without lag, keep "
      "the plant in closed form; friction\n  that varies with speed or time has to be integrated.\n\n";
  return text;
}

}  // namespace

std::string to_page(const Frontiers& f) {
  return std::string{
             "# Speed against accuracy\n\n"
             "Measured by `breakaway tradeoff --page sim/TRADEOFF.md --picture sim/tradeoff.svg`, which renews this "
             "page.\n"} +
         (f.counted ? "Instructions are counted under valgrind and do not depend on how busy the machine is; times are "
                      "ratios within the run.\n\n"
                    : "valgrind was not there or not wanted, so that costs are ratios of times within the run "
                      "only.\n\n") +
         "![error against cost](tradeoff.svg)\n\n" + advice(f) + integrators(f) + evaluators(f) + periods(f) +
         scene_parts(f);
}

}  // namespace breakaway::tradeoff
