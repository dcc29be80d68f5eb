#include <cmath>

#include "breakaway/design/assumptions.hpp"
#include "breakaway/study/friction_study.hpp"
#include "parts.hpp"

namespace breakaway::tradeoff {
namespace {

PeriodRow run(scenario::Scenario s, double tolerance_per_floor, int random_laws) {
  const auto& f = s.friction;
  PeriodRow row;
  row.period_s = s.loop->period_s;
  row.floor_m = design::accuracy_floor_m(s.plant.mass_kg, {f.lower_N, f.upper_N}, row.period_s);
  row.resolution_m = s.drive->encoder_resolution_m;
  row.tolerance_m = tolerance_per_floor * row.floor_m;
  s.controller.position_tolerance_m = row.tolerance_m;
  // The axis may stop anywhere within a count of a reading within the tolerance.
  s.run->settle_tolerance_m = row.tolerance_m + row.resolution_m;
  s.run->duration_s = 6;
  const auto study =
      study::run_study(s, {.starts = {{-0.1, 0}}, .random_laws = random_laws, .seed = 1, .threads = 0, .progress = {}});
  row.runs = study.front().runs.size();
  row.settled = study::settled_runs(study.front());
  row.worst_error_m = study::worst_error_m(study.front());
  return row;
}

}  // namespace

// An encoder far finer than the floor, so that what shows is the floor; then the scene's own.
std::vector<PeriodRow> measure_periods(bool quick) {
  const scenario::Scenario scene = can_axis();
  const int random_laws = quick ? 4 : 60;
  std::vector<PeriodRow> rows;
  for (const double period_s : {5e-4, 1e-3, 2e-3, 4e-3}) {
    scenario::Scenario s = scene;
    s.loop->period_s = period_s;
    for (const double share : {1.0, 0.5, 0.25}) {
      s.drive->encoder_resolution_m =
          design::accuracy_floor_m(s.plant.mass_kg, {s.friction.lower_N, s.friction.upper_N}, period_s) / 50;
      rows.push_back(run(s, share, random_laws));
    }
    s.drive->encoder_resolution_m = scene.drive->encoder_resolution_m;
    rows.push_back(run(s, 1, random_laws));
  }
  return rows;
}

}  // namespace breakaway::tradeoff
