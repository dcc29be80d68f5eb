// Speed against accuracy, measured: which integrator, which evaluator of k3, which control period, which parts of a
// scenario. NaN in a figure: not measured.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "breakaway/tradeoff/cost.hpp"
#include "breakaway/tradeoff/scene_tradeoff.hpp"

namespace breakaway::tradeoff {

// The two-mass example of van de Wouw & Leine (stability properties of equilibrium sets), section 4.
struct IntegratorRow {
  std::string method;
  double step_s = 0;            // 0: no fixed step
  double tolerance = 0;         // of adaptive steps, relative; 0: none is asked for
  double error_m = 0;           // mean over starts of the largest error of a final coordinate
  double time_error_s = 0;      // mean error of the settling time
  double order = not_measured;  // log(error ratio) / log(step ratio) to the row above
  double wrong_share = 0;       // of a grid of starts: rests in truth and not here, or the reverse
  double steps = 0;             // of the trajectory whose cost is given
  Cost trajectory{};
};

// Time stepping of the impulsive example, section V of van de Wouw & Leine (impulsive control).
struct BallRow {
  double step_s = 0;
  double ball_m = 0;
  double predicted_m = 0;  // f_lower h^2 / (8 m)
  double kicks_per_step = 0;
};

// Evaluators of k3(y) on (0, c_upper]. The mild plant is that of section V; the hard one has zeta = 10 and f_lower /
// f_upper = 0.1.
struct EvaluatorRow {
  std::string method;
  std::string scalar;
  std::size_t nodes = 0;  // or coefficients
  std::size_t bytes = 0;
  double mild_error = 0;  // largest relative error
  double hard_error = 0;
  Cost call{};  // without what fetching an argument and storing the result cost
};

// The flashed law on the scenario can_axis under a class of friction laws.
struct PeriodRow {
  double period_s = 0;
  double floor_m = 0;        // f_hi (f_hi - f_lo) / (2 m f_lo) T^2
  double resolution_m = 0;   // one encoder count
  double tolerance_m = 0;    // asked for
  double worst_error_m = 0;  // over all runs
  std::size_t runs = 0;
  std::size_t settled = 0;
};

// A scenario with one part changed. Costs are those of one simulated second.
struct ScenarioPartRow {
  std::string scenario;
  Cost second{};
};

// What an accuracy that is asked for leads to on a scene of the project.
struct AskedRow {
  std::string scene;
  double asked_m = 0;
  std::string method;
  double error_m = 0;  // estimated
  double cost_s = 0;   // processor time of a run, estimated
};

// Asked of can_axis where its parts are left out.
inline constexpr double parts_asked_m = 1e-3;

struct Frontiers {
  bool quick = false;
  bool counted = false;  // costs hold instructions
  std::vector<IntegratorRow> integrators;
  std::vector<BallRow> balls;
  std::vector<EvaluatorRow> evaluators;
  std::vector<PeriodRow> periods;
  std::vector<ScenarioPartRow> scenario_parts;
  std::vector<AskedRow> asked;
  std::vector<LeftOutPart> left_out;  // of can_axis
};

struct Options {
  bool quick = false;  // fewer rows, starts and friction laws; seconds in place of minutes
  Counting counting;
};

Frontiers measure(const Options& options);

// Everything whose cost is measured.
std::vector<Work> all_works();

// Prepares the work of this name and does it `repeats` times: for the counting of instructions from outside. Throws
// InputError when there is none.
void do_work(const std::string& name, std::uint64_t repeats);

std::string to_json(const Frontiers& frontiers);
std::string to_svg(const Frontiers& frontiers);   // needs gnuplot, throws InputError without
std::string to_page(const Frontiers& frontiers);  // Markdown, with the picture tradeoff.svg beside it

}  // namespace breakaway::tradeoff
