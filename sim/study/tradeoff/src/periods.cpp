#include <chrono>

#include "breakaway/design/assumptions.hpp"
#include "breakaway/study/friction_study.hpp"
#include "parts.hpp"

namespace breakaway::tradeoff {
namespace {

double floor_m(const scenario::Scenario& s) {
  const config::Axis& axis = s.node.axes.front();
  return design::accuracy_floor_m(axis.mass_kg, axis.friction.bounds, s.node.period_s());
}

void set_resolution(scenario::Scenario& s, double resolution_m) {
  s.node.axes.front().drive->encoder_resolution_m = resolution_m;
  s.worlds.front().drive->encoder_resolution_m = resolution_m;
}

PeriodRow run(scenario::Scenario s, double tolerance_per_floor, int random_laws) {
  config::Axis& axis = s.node.axes.front();
  PeriodRow row;
  row.period_s = s.node.period_s();
  row.floor_m = floor_m(s);
  row.resolution_m = axis.drive->encoder_resolution_m;
  row.tolerance_m = tolerance_per_floor * row.floor_m;
  axis.controller.position_tolerance_m = row.tolerance_m;
  // The axis may stop anywhere within a count of a reading within the tolerance.
  s.node.settle_tolerance_m = row.tolerance_m + row.resolution_m;
  s.run->duration_s = 6;
  const auto study =
      study::run_study(s, {.starts = {{-0.1, 0}}, .random_laws = random_laws, .seed = 1, .threads = 0, .progress = {}});
  row.runs = study.front().runs.size();
  row.settled = study::settled_runs(study.front());
  row.worst_error_m = study::worst_error_m(study.front());
  return row;
}

}  // namespace

// An encoder far finer than the floor, so that what shows is the floor; then the scenario's own.
std::vector<PeriodRow> measure_periods(bool quick) {
  const scenario::Scenario given = can_axis();
  const int random_laws = quick ? 4 : 60;
  std::vector<PeriodRow> rows;
  for (const int period_us : {500, 1000, 2000, 4000}) {
    scenario::Scenario s = given;
    s.node.loop->period = std::chrono::microseconds{period_us};
    set_resolution(s, floor_m(s) / 50);
    for (const double share : {1.0, 0.5, 0.25}) rows.push_back(run(s, share, random_laws));
    set_resolution(s, given.node.axes.front().drive->encoder_resolution_m);
    rows.push_back(run(s, 1, random_laws));
  }
  return rows;
}

}  // namespace breakaway::tradeoff
