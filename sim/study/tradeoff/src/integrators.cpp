#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <variant>

#include "breakaway/design/k3.hpp"
#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/impulsive_stepping.hpp"
#include "breakaway/hybrid/time_stepping.hpp"
#include "parts.hpp"

namespace breakaway::tradeoff {
namespace {

using Machine = hybrid::LinearMachine<2, 2>;
using State = hybrid::MachineState<2>;
using Outcome = hybrid::Outcome<2>;
using hybrid::Verdict;

constexpr double end_s = 60;  // all that comes to rest in the starts below has done so by then

// (24) with m = k = 1, c1 = 0.5, c2 = -0.375, mu m g = 1.
Machine two_masses() {
  Machine m;
  m.mass.setIdentity();
  m.damping << 0.125, 0.375, 0.375, 0.125;
  m.stiffness << 2, -1, -1, 2;
  m.directions.setIdentity();
  m.friction_N << 1, 1;
  return m;
}

State at_rest(double q1_m, double q2_m) { return {0, {q1_m, q2_m}, {0, 0}}; }
const State shown = at_rest(2.5, -1);  // the trajectory whose cost is given
// Where and when it ends, to 25 digits: tests/reference/linear_machine.csv, rounded here.
const Eigen::Vector2d shown_end_m{0.01780996919189576529, 0.02337361620547781400};
constexpr double shown_settling_s = 7.297349020148677522;

struct FromEventToEvent {};

struct Method {
  std::string name;
  std::variant<FromEventToEvent, hybrid::TimeSteppingOptions, hybrid::AdaptiveOptions> options{};

  double step_s() const {
    const auto* stepping = std::get_if<hybrid::TimeSteppingOptions>(&options);
    return stepping == nullptr ? 0 : stepping->step_s;
  }
  double tolerance() const {
    const auto* adaptive = std::get_if<hybrid::AdaptiveOptions>(&options);
    return adaptive == nullptr ? 0 : adaptive->tolerance;
  }
  bool exact() const { return std::holds_alternative<FromEventToEvent>(options); }
};

std::vector<Method> methods(bool quick) {
  std::vector<Method> all{{"event-driven"}};
  for (const double tolerance : {1e-4, 1e-8, 1e-12})
    all.push_back({"adaptive", hybrid::AdaptiveOptions{.tolerance = tolerance}});
  const double finest_s = quick ? 1e-3 : 1e-5;
  for (const auto& [name, theta] : {std::pair{"midpoint", 0.5}, std::pair{"implicit Euler", 1.0}}) {
    for (int decade = 1; std::pow(10, -decade) > 0.9 * finest_s; ++decade)
      all.push_back({name, hybrid::TimeSteppingOptions{.step_s = std::pow(10, -decade), .theta = theta}});
  }
  return all;
}

using Run = std::function<Outcome(const State&)>;

Run integrator() {
  return [driven = hybrid::EventDriven<2, 2>{two_masses()}](const State& start) { return driven.run(start, end_s); };
}

Run integrator(const hybrid::TimeSteppingOptions& options) {
  return [stepping = hybrid::TimeStepping<2, 2>{two_masses(), options}](const State& start) {
    return stepping.run(start, end_s);
  };
}

Run integrator(const hybrid::AdaptiveOptions& options) {
  const Machine m = two_masses();
  const hybrid::LinearMachine<> machine{m.mass, m.damping, m.stiffness, m.directions, m.friction_N, {}};
  return [adaptive = std::make_shared<hybrid::Adaptive>(machine, options)](const State& start) {
    const auto found = adaptive->run({start.time_s, start.q, start.v}, end_s);
    return Outcome{found.verdict,         {found.end.time_s, found.end.q, found.end.v},
                   found.settling_time_s, found.steps,
                   found.events,          found.work};
  };
}

Run integrator(const Method& method) {
  if (const auto* stepping = std::get_if<hybrid::TimeSteppingOptions>(&method.options)) return integrator(*stepping);
  if (const auto* adaptive = std::get_if<hybrid::AdaptiveOptions>(&method.options)) return integrator(*adaptive);
  return integrator();
}

bool rests(const Outcome& outcome) {
  return outcome.verdict == Verdict::at_rest || outcome.verdict == Verdict::captured;
}

// Starts at rest that come to rest, on two circles.
std::vector<State> attracted_starts() {
  std::vector<State> starts{shown};
  for (int i = 0; i < 16; ++i) {
    const double angle = 0.1 + 0.39 * i, radius_m = i % 2 == 0 ? 2 : 2.7;
    starts.push_back(at_rest(radius_m * std::cos(angle), radius_m * std::sin(angle)));
  }
  return starts;
}

// A grid of starts at rest that the boundary of the region of attraction runs through.
std::vector<State> grid(bool quick) {
  const int points = quick ? 9 : 41;
  constexpr double window_m = 5;
  std::vector<State> starts;
  for (int i = 0; i < points * points; ++i) {
    const auto place = [&](int k) { return window_m * (2 * k - (points - 1)) / (points - 1); };
    starts.push_back(at_rest(place(i % points), place(i / points)));
  }
  return starts;
}

std::vector<Outcome> outcomes(const std::vector<State>& starts, const Run& run) {
  std::vector<Outcome> all;
  all.reserve(starts.size());
  for (const State& start : starts) all.push_back(run(start));
  return all;
}

void judge(IntegratorRow& row, const std::vector<Outcome>& found, const std::vector<Outcome>& truth) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    row.error_m += (found[i].end.q - truth[i].end.q).cwiseAbs().maxCoeff() / static_cast<double>(found.size());
    row.time_error_s +=
        std::fabs(found[i].settling_time_s - truth[i].settling_time_s) / static_cast<double>(found.size());
  }
}

double wrong_share(const std::vector<Outcome>& found, const std::vector<Outcome>& truth) {
  double wrong = 0;
  for (std::size_t i = 0; i < found.size(); ++i) wrong += rests(found[i]) != rests(truth[i]) ? 1 : 0;
  return wrong / static_cast<double>(found.size());
}

// Shorter steps make a grid of thousands of starts take too long for what they would tell.
bool grid_is_worthwhile(const Method& method) { return method.step_s() == 0 || method.step_s() >= 0.9e-3; }

std::string work_name(const Method& method) {
  if (method.exact()) return "integrate-events";
  if (method.tolerance() > 0) return fmt::format("integrate-adaptive-tolerance{:g}", method.tolerance());
  const double theta = std::get<hybrid::TimeSteppingOptions>(method.options).theta;
  return fmt::format("integrate-theta{:g}-step{:g}", theta, method.step_s());
}

}  // namespace

scenario::MachineScenario two_mass_scenario() {
  scenario::MachineScenario s;
  s.file = "two_mass_example.toml";
  s.machine = stability::unsized(two_masses());
  s.start = {shown.time_s, shown.q, shown.v};
  s.duration_s = end_s;
  return s;
}

std::vector<Work> integrator_works() {
  std::vector<Work> works;
  for (const Method& method : methods(false)) {
    works.push_back({work_name(method), [method]() -> std::function<void()> {
                       return [run = integrator(method)] { keep(run(shown).end.q[0]); };
                     }});
  }
  return works;
}

std::vector<IntegratorRow> measure_integrators(const Options& options) {
  const auto starts = attracted_starts(), everywhere = grid(options.quick);
  const auto truth = outcomes(starts, integrator({"event-driven"}));
  const auto true_verdicts = outcomes(everywhere, integrator({"event-driven"}));
  std::vector<IntegratorRow> rows;
  std::vector<Work> works;
  const auto all_works = integrator_works();
  const auto all = methods(false), wanted = methods(options.quick);
  for (const Method& method : wanted) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (work_name(all[i]) == work_name(method)) works.push_back(all_works[i]);
    }
    const auto run = integrator(method);
    IntegratorRow row{.method = method.name, .step_s = method.step_s(), .tolerance = method.tolerance()};
    if (!method.exact()) {
      judge(row, outcomes(starts, run), truth);
    } else {
      const Outcome end = run(shown);
      row.error_m = (end.end.q - shown_end_m).cwiseAbs().maxCoeff();
      row.time_error_s = std::fabs(end.settling_time_s - shown_settling_s);
    }
    row.wrong_share = grid_is_worthwhile(method) ? wrong_share(outcomes(everywhere, run), true_verdicts) : not_measured;
    row.steps = static_cast<double>(run(shown).steps);
    if (!rows.empty() && rows.back().method == row.method && row.step_s > 0)
      row.order = std::log(rows.back().error_m / row.error_m) / std::log(rows.back().step_s / row.step_s);
    rows.push_back(row);
  }
  const auto costs = measure_costs(works, options.counting);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].trajectory = costs[i];
  return rows;
}

// The scenario of section V: mu = 0.1 / (1 + |v| / 2) + 0.3 + 0.05 sin 4 t, k1 = 1, k21 = 0.5, k22 = 3, m = 1, g = 10.
std::vector<BallRow> measure_balls(bool quick) {
  const auto law = design::K3<double>::make({1, 1, 3, 2.5});
  const auto level_N = [](double t, double, double speed) {
    return 10 * (0.1 / (1 + speed / 2) + 0.3 + 0.05 * std::sin(4 * t));
  };
  std::vector<BallRow> rows;
  for (int decade = 1; decade <= (quick ? 3 : 5); ++decade) {
    const double step_s = std::pow(10, -decade);
    const auto outcome = hybrid::run_impulsive({1, 1, 0.5, 3, 2.5, 4.5}, -4, -4, step_s, 8, 12, level_N,
                                               [&](double x) { return law.impulse_Ns(x); });
    rows.push_back({step_s, outcome.ball_m, outcome.predicted_ball_m,
                    static_cast<double>(outcome.late_kicks) / static_cast<double>(outcome.late_steps)});
  }
  return rows;
}

}  // namespace breakaway::tradeoff
