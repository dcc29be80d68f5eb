// A study: one axis behind its drive, from several starts, under every friction law of a class.
//
// The class holds the bounds of the axis and everything between them: constant friction at either bound, the scenario's
// own law, static friction at the upper and kinetic friction at the lower bound, and seeded random laws that are
// piecewise constant in time and change at every stick and slip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/margins.hpp"
#include "breakaway/sil/result.hpp"
#include "breakaway/study/shard.hpp"

namespace breakaway::study {

struct Start {
  double position_m = 0;
  double velocity_m_s = 0;
};

// Constant at either bound, the scenario's own, static and kinetic: the first of every row. Random laws follow.
inline constexpr std::size_t fixed_laws = 4;

struct StudyOptions {
  std::vector<Start> starts;
  int random_laws = 100;
  std::uint64_t seed = 1;  // of the first random law; the others count up
  unsigned threads = 0;    // 0: one for each processor. The result does not depend on it.
  // Called with the number of runs done and in all, from one thread at a time.
  std::function<void(int done, int all)> progress;
  // Of all runs, numbered row by row; no more parts than laws, so that each has a run of every row.
  Shard shard{};
};

struct StudyRun {
  std::size_t place = 0;  // of its law among all laws of a row
  std::string law;
  bool settled = false;
  bool limit_cycle = false;
  double settling_time_s = 0;  // NaN: never
  double final_error_m = 0;
  sil::Excursions excursions;
  double max_force_N = 0;
  std::size_t kicks = 0;
  std::vector<sil::Reached> reached;
  std::vector<sil::FaultRecord> faults;
  double sync_off_s = 0;  // by how much SYNC was off whole periods, at most
};

struct StudyRow {
  Start start;
  std::vector<StudyRun> runs;  // by their places: under all laws, or under those of a shard
};

std::size_t laws_of_a_row(const StudyOptions& options);
// The name of the law at a place of a row.
std::string law_name(const StudyOptions& options, std::size_t place);

// The scenario, if a study can run it: of an axis that moves alone, with all that a simulation needs. Throws
// InputError.
scenario::Scenario studied_axis(scenario::Scenario scenario);
// From far, near and very near, as far as the limits of the axis allow.
std::vector<Start> default_starts(const scenario::Scenario& scenario);
// Throws InputError where the axis cannot begin there.
void require_within_limits(const scenario::Scenario& scenario, const Start& start);

// Times of runs that never settled count as infinite. Empty rows give NaN.
double median_settling_time_s(const StudyRow& row);
double worst_settling_time_s(const StudyRow& row);
// From when on every run stayed within the tolerance that is judged, at rest or kicked on within it. Infinite where one
// did not; NaN of an empty row, and under the ideal law.
double worst_time_inside_s(const StudyRow& row);
double worst_error_m(const StudyRow& row);
// The run that settled last or not at all, the first of several. Requires a run.
const StudyRun& slowest_run(const StudyRow& row);
sil::Excursions worst_excursions(const StudyRow& row);
// The least margins of the row to the limits of the node's only axis.
std::vector<sil::Margin> margins(const config::Node& node, const StudyRow& row);
double largest_force_N(const StudyRow& row);
double sync_off_s(const StudyRow& row);
std::size_t settled_runs(const StudyRow& row);
std::size_t limit_cycles(const StudyRow& row);
std::size_t faulted_runs(const StudyRow& row);

// One run of run_study once more, with its trace: under the law at this place of a row. Requires the same.
sil::Result run_again(const scenario::Scenario& scenario, const StudyOptions& options, const Start& start,
                      std::size_t place);

// Requires what run_loop_scenario or, without a [loop], run_ideal_scenario requires, and a single axis. The scenario's
// own start is not used. Under the ideal law no excursions are seen, and a force is NaN. Throws InputError for a shard
// of more parts than there are laws.
std::vector<StudyRow> run_study(const scenario::Scenario& scenario, const StudyOptions& options);

}  // namespace breakaway::study
