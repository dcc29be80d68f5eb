#include "breakaway/study/friction_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_ideal_scenario.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "parallel.hpp"

namespace breakaway::study {
namespace {

struct NamedLaw {
  std::string name;
  model::FrictionLaw law;
};

std::uint64_t seed_of(const StudyOptions& options, std::size_t place) { return options.seed + (place - fixed_laws); }

NamedLaw law_at(const scenario::Scenario& scenario, const StudyOptions& options, std::size_t place) {
  const model::FrictionLaw& own = scenario.worlds.front().friction;
  const auto named = [&](model::ShapePtr shape) {
    return NamedLaw{law_name(options, place), {own.bounds(), std::move(shape)}};
  };
  switch (place) {
    case 0:
      return named(model::shape::constant(0));
    case 1:
      return named(model::shape::constant(1));
    case 2:
      return {law_name(options, place), own};
    case 3:
      return named(model::shape::static_kinetic(1, 0));
    default:
      break;
  }
  model::shape::RandomDwell random;
  random.seed = seed_of(options, place);
  random.bound_share = 0.3;
  return named(model::shape::random_dwell(random));
}

// The scenario as it begins there, and its node. An axis that stands at home when it begins has its home there.
struct Begun {
  scenario::Scenario scenario;
  sil::SharedNode node;
};

bool begins_at_home(const scenario::Scenario& scenario) {
  const auto& drive = scenario.node.axes.front().drive;
  return drive && config::begins_at_home(drive->homing);
}

scenario::Scenario begun_at(scenario::Scenario scenario, const Start& start) {
  scenario.worlds.front().position_m = start.position_m;
  scenario.worlds.front().velocity_m_s = start.velocity_m_s;
  if (begins_at_home(scenario)) scenario.node.axes.front().drive->homing.position_m = start.position_m;
  return scenario;
}

std::vector<Begun> all_begun_at(const scenario::Scenario& scenario, const std::vector<Start>& starts) {
  sil::SharedNode node;
  std::vector<Begun> all;
  for (const Start& start : starts) {
    all.push_back({begun_at(scenario, start), {}});
    const bool is_new = all.size() == 1 || begins_at_home(scenario);
    if (!scenario.ideal() && is_new) node = sil::flashed_node(all.back().scenario);
    all.back().node = node;
  }
  return all;
}

sil::Result result_of(const Begun& begun, const NamedLaw& law, const sil::RecordingOptions& recording) {
  const auto& [begun_scenario, node] = begun;
  scenario::Scenario scenario = begun_scenario;
  scenario.worlds.front().friction = law.law;
  return scenario.ideal() ? sil::run_ideal_scenario(scenario, recording)
                          : sil::run_loop_scenario(scenario, recording, node);
}

StudyRun run_one(const Begun& begun, const NamedLaw& law, std::size_t place) {
  sil::Result result = result_of(begun, law, {});
  sil::AxisResult r = std::move(result.axes.front());
  return {place,
          law.name,
          r.settled,
          r.limit_cycle,
          r.settling_time_s,
          r.final_error_m,
          r.excursions.value_or(sil::Excursions{}),
          r.max_force_N,
          r.kicks.size(),
          std::move(r.reached),
          std::move(r.faults),
          result.loop ? result.loop->sync_off_s : 0};
}

double time_or_infinity(const StudyRun& run) {
  return run.settled ? run.settling_time_s : std::numeric_limits<double>::infinity();
}

std::vector<double> sorted_times(const StudyRow& row) {
  std::vector<double> times;
  for (const StudyRun& run : row.runs) times.push_back(time_or_infinity(run));
  std::sort(times.begin(), times.end());
  return times;
}

template <class Value>
double largest(const StudyRow& row, Value value) {
  double most = row.runs.empty() ? std::numeric_limits<double>::quiet_NaN() : 0;
  for (const StudyRun& run : row.runs) most = std::max(most, std::abs(value(run)));
  return most;
}

template <class Predicate>
std::size_t count(const StudyRow& row, Predicate predicate) {
  return static_cast<std::size_t>(std::count_if(row.runs.begin(), row.runs.end(), predicate));
}

// Where a run stands: its row, and which of the row's runs it is.
struct RunPlace {
  std::size_t row, run;
};

void require_a_run_of_every_row(const StudyOptions& options) {
  if (static_cast<std::size_t>(options.shard.count) <= laws_of_a_row(options)) return;
  throw InputError{fmt::format("--shard {}/{}: there are {} laws, which make no more parts than that",
                               options.shard.index, options.shard.count, laws_of_a_row(options))};
}

// Within the limits of the axis, and where 32 bits count its position and the way to each of its targets.
double lowest_start_m(const config::Axis& axis) {
  double highest_m = std::max(0.0, axis.controller.target_m);
  for (const config::TargetChange& change : axis.controller.targets) highest_m = std::max(highest_m, change.position_m);
  return std::max(axis.limits.position_min_m, highest_m - config::counted_m(axis));
}

}  // namespace

std::size_t laws_of_a_row(const StudyOptions& options) {
  return fixed_laws + static_cast<std::size_t>(options.random_laws);
}

std::string law_name(const StudyOptions& options, std::size_t place) {
  static constexpr std::array<const char*, fixed_laws> fixed{
      "constant at the lower bound", "constant at the upper bound", "of the scenario", "static upper, kinetic lower"};
  return place < fixed_laws ? fixed[place] : fmt::format("random, seed {}", seed_of(options, place));
}

scenario::Scenario studied_axis(scenario::Scenario s) {
  if (s.machine)
    throw InputError{"a study varies the friction of an axis, and a [machine] has its own: simulate it"}.in_file(
        s.node.file);
  if (s.ideal())
    throw InputError{"[loop] is missing: a study runs scenarios with a [loop] and a [drive]"}.in_file(s.node.file);
  sil::require_complete(s);
  return s;
}

std::vector<Start> default_starts(const scenario::Scenario& s) {
  const config::Axis& axis = s.node.axes.front();
  const double room_m = axis.controller.target_m - lowest_start_m(axis);
  const double far_m = std::min(4.0, 0.8 * room_m), speed_m_s = std::min(4.0, 0.5 * axis.limits.speed_m_s);
  const bool moving = far_m == 4.0 && speed_m_s == 4.0;  // else it might run out of its limits on the way
  std::vector<Start> starts{{axis.controller.target_m - far_m, moving ? -speed_m_s : 0}};
  for (const double distance_m : {0.1, 0.01}) {
    if (distance_m < far_m) starts.push_back({axis.controller.target_m - distance_m, 0});
  }
  return starts;
}

void require_within_limits(const scenario::Scenario& s, const Start& start) {
  const scenario::Scenario begun = begun_at(s, start);
  const std::string problem = scenario::start_problem(begun.node.axes.front(), begun.worlds.front(), start.position_m);
  if (!problem.empty())
    throw InputError{
        fmt::format("{:g} {:g}: for {} the position {}", start.position_m, start.velocity_m_s, s.node.file, problem)};
}

double median_settling_time_s(const StudyRow& row) {
  const auto times = sorted_times(row);
  if (times.empty()) return std::numeric_limits<double>::quiet_NaN();
  const std::size_t middle = times.size() / 2;
  return times.size() % 2 == 1 ? times[middle] : (times[middle - 1] + times[middle]) / 2;
}

double worst_settling_time_s(const StudyRow& row) {
  return row.runs.empty() ? std::numeric_limits<double>::quiet_NaN() : sorted_times(row).back();
}

double worst_time_inside_s(const StudyRow& row) {
  const auto is_watched = [](const StudyRun& run) { return !run.reached.empty(); };
  if (row.runs.empty() || !std::ranges::all_of(row.runs, is_watched)) return std::numeric_limits<double>::quiet_NaN();
  const auto inside_s = [](const StudyRun& run) {
    const double time_s = run.reached.back().time_s;
    return std::isnan(time_s) ? std::numeric_limits<double>::infinity() : time_s;
  };
  return inside_s(*std::ranges::max_element(row.runs, {}, inside_s));
}

const StudyRun& slowest_run(const StudyRow& row) { return *std::ranges::max_element(row.runs, {}, time_or_infinity); }

double worst_error_m(const StudyRow& row) {
  return largest(row, [](const StudyRun& run) { return run.final_error_m; });
}
double sync_off_s(const StudyRow& row) {
  return largest(row, [](const StudyRun& run) { return run.sync_off_s; });
}
sil::Excursions worst_excursions(const StudyRow& row) {
  sil::Excursions worst{
      .overshoot_m = largest(row, [](const StudyRun& run) { return run.excursions.overshoot_m; }),
      .beyond_m = largest(row, [](const StudyRun& run) { return run.excursions.beyond_m; }),
      .peak_speed_m_s = largest(row, [](const StudyRun& run) { return run.excursions.peak_speed_m_s; })};
  for (const StudyRun& run : row.runs) {
    worst.lowest_m = std::min(worst.lowest_m, run.excursions.lowest_m);
    worst.highest_m = std::max(worst.highest_m, run.excursions.highest_m);
  }
  return worst;
}
std::vector<sil::Margin> margins(const config::Node& node, const StudyRow& row) {
  return sil::margins(node.axes.front(), worst_excursions(row), largest_force_N(row));
}
double largest_force_N(const StudyRow& row) {
  return largest(row, [](const StudyRun& run) { return run.max_force_N; });
}
std::size_t settled_runs(const StudyRow& row) {
  return count(row, [](const StudyRun& run) { return run.settled; });
}
std::size_t limit_cycles(const StudyRow& row) {
  return count(row, [](const StudyRun& run) { return run.limit_cycle; });
}
std::size_t faulted_runs(const StudyRow& row) {
  return count(row, [](const StudyRun& run) { return !run.faults.empty(); });
}

sil::Result run_again(const scenario::Scenario& scenario, const StudyOptions& options, const Start& start,
                      std::size_t place) {
  return result_of(all_begun_at(scenario, {start}).front(), law_at(scenario, options, place), {.trace = true});
}

std::vector<StudyRow> run_study(const scenario::Scenario& scenario, const StudyOptions& options) {
  require_a_run_of_every_row(options);
  const std::vector<Begun> begun = all_begun_at(scenario, options.starts);
  const std::size_t laws = laws_of_a_row(options);
  std::vector<StudyRow> rows;
  for (const Start& start : options.starts) rows.push_back({start, {}});
  std::vector<RunPlace> places;
  for (std::size_t number = 0; number < rows.size() * laws; ++number) {
    if (!options.shard.owns(static_cast<std::int64_t>(number))) continue;
    StudyRow& row = rows[number / laws];
    places.push_back({number / laws, row.runs.size()});
    row.runs.emplace_back().place = number % laws;
  }
  const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
  const int threads = static_cast<int>(options.threads > 0 ? options.threads : processors);
  std::mutex progress_mutex;
  int done = 0;
  const auto run_place = [&](std::size_t i) {
    StudyRow& row = rows[places[i].row];
    StudyRun& run = row.runs[places[i].run];
    run = run_one(begun[places[i].row], law_at(scenario, options, run.place), run.place);
    const std::scoped_lock lock{progress_mutex};
    if (options.progress) options.progress(++done, static_cast<int>(places.size()));
  };
  in_parallel(places.size(), threads, 1, [&](int) { return run_place; });
  return rows;
}

}  // namespace breakaway::study
