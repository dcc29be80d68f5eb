// The parts of a measurement, one file each, and the works whose costs they give.
#pragma once

#include <vector>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/tradeoff/frontiers.hpp"

namespace breakaway::tradeoff {

std::vector<IntegratorRow> measure_integrators(const Options& options);
std::vector<BallRow> measure_balls(bool quick);
std::vector<EvaluatorRow> measure_evaluators(const Options& options);
std::vector<PeriodRow> measure_periods(bool quick);
std::vector<ScenarioPartRow> measure_scenario_parts(const Options& options);

std::vector<AskedRow> measure_asked();
std::vector<LeftOutPart> measure_parts_asked();

std::vector<Work> integrator_works();
std::vector<Work> evaluator_works();
std::vector<Work> scenario_part_works();

scenario::Scenario can_axis();
scenario::MachineScenario two_mass_scenario();  // from the start whose cost is told

}  // namespace breakaway::tradeoff
