#include "breakaway/study/basin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/refused.hpp"
#include "breakaway/hybrid/time_stepping.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/certificates.hpp"
#include "grid_starts.hpp"
#include "parallel.hpp"

namespace breakaway::study {
namespace {

using hybrid::Verdict;
using scenario::MachineScenario;

int rows_of(const Grid& grid, const Shard& shard) {
  const int first = shard.index % shard.count;
  return first < grid.points ? (grid.points - 1 - first) / shard.count + 1 : 0;
}

struct Decided {
  Fate fate;
  double time_s;
};

template <int N>
Decided decided(const hybrid::Outcome<N>& outcome) {
  const auto fate = [&] {
    switch (outcome.verdict) {
      case Verdict::at_rest:
      case Verdict::captured:
        return Fate::attracted;
      case Verdict::lost:
        return Fate::lost;
      case Verdict::undecided:
        break;
    }
    return Fate::undecided;
  };
  return {fate(), outcome.settling_time_s};
}

// A picture of starts has no place for the time of an impulse.
void require_no_impulses(const scenario::MachineScenario& s) {
  if (s.impulses.empty()) return;
  throw InputError{fmt::format(
      "{}: an [[impulse]] comes at its own time, and a region of attraction is about starts; leave it out", s.file)};
}

// Thrown by the early decision of a point, which is asked at every event.
class BudgetSpent {};

// Asks the certificates, and ends a motion that takes too many events.
template <int N>
class BudgetedFate {
 public:
  BudgetedFate(sil::ProvenFate<N> fate, std::shared_ptr<std::uint64_t> events_left)
      : fate_{std::move(fate)}, events_left_{std::move(events_left)} {}

  Verdict operator()(const hybrid::MachineState<N>& state) const {
    if (*events_left_ == 0) throw BudgetSpent{};
    --*events_left_;
    return fate_(state);
  }

 private:
  sil::ProvenFate<N> fate_;
  std::shared_ptr<std::uint64_t> events_left_;
};

struct RowCount {
  std::size_t simulated = 0, given_up = 0;
};

template <class Run>
RowCount decide_row(Basin& basin, int row, const Run& run) {
  RowCount count;
  for (int column = 0; column < basin.grid().points; ++column) {
    if (basin.fate(column, row) != Fate::pending) continue;
    const std::optional<Decided> point = run(column);
    if (!point) ++count.given_up;
    basin.set(column, row, point ? point->fate : Fate::undecided, point ? point->time_s : 0);
    ++count.simulated;
  }
  return count;
}

// Nothing where the motion costs too much or is refused.
template <int N, class Integrator>
std::optional<Decided> decided_within(const Integrator& integrator, const hybrid::MachineState<N>& start,
                                      double end_s) try {
  return decided(integrator.run(start, end_s));
} catch (const BudgetSpent&) {
  return std::nullopt;
} catch (const hybrid::Refused&) {
  return std::nullopt;
}

hybrid::Adaptive adaptive(const MachineScenario& s, const BudgetedFate<Eigen::Dynamic>& fate, std::uint64_t steps) {
  const hybrid::AdaptiveOptions options{.tolerance = s.tolerance, .most_steps = steps};
  return s.laws.empty() ? hybrid::Adaptive{s.machine, options, fate}
                        : hybrid::Adaptive{s.machine, s.laws, options, fate};
}

// `make_integrator(fate)` is called once for each thread.
template <int N, class MakeIntegrator>
std::size_t decide(Basin& basin, const scenario::MachineScenario& s, int threads, const RowDone& done,
                   const PointBudget& budget, const MakeIntegrator& make_integrator) {
  const sil::Certificates certificates = sil::certify(s);
  const sil::ProvenFate<N> fate{s.machine, certificates};
  const double end_s = horizon_s(s, certificates);
  const GridStarts<N> starts{basin.grid(), certificates.centre};
  std::mutex mutex;
  std::size_t simulated = 0;
  const auto events_left = [] { return std::make_shared<std::uint64_t>(); };
  // An integrator that cannot take the machine says so here, before there are threads.
  static_cast<void>(make_integrator(BudgetedFate<N>{fate, events_left()}));
  in_parallel(static_cast<std::size_t>(basin.grid().points), threads, 1, [&](int) {
    const auto left = events_left();
    return [&, left, integrator = make_integrator(BudgetedFate<N>{fate, left})](std::size_t i) {
      const int row = static_cast<int>(i);
      if (!basin.shard().owns(row)) return;
      const RowCount count = decide_row(basin, row, [&](int column) {
        *left = budget.events;
        return decided_within<N>(integrator, starts.at(column, row), end_s);
      });
      const std::scoped_lock lock{mutex};
      simulated += count.simulated;
      basin.give_up(count.given_up);
      if (done) done(row, simulated);
    };
  });
  return simulated;
}

template <int N, int M>
std::size_t decide_event_driven(Basin& basin, const scenario::MachineScenario& s, int threads, const RowDone& done,
                                const PointBudget& budget) {
  const auto machine = stability::sized<N, M>(s.machine);
  return decide<N>(basin, s, threads, done, budget, [&](const BudgetedFate<N>& fate) {
    return hybrid::EventDriven<N, M>{machine, fate};
  });
}

// The steps of time stepping are counted by the scenario itself.
template <int N, int M>
std::size_t decide_time_stepping(Basin& basin, const scenario::MachineScenario& s, int threads, const RowDone& done) {
  const auto machine = stability::sized<N, M>(s.machine);
  return decide<N>(basin, s, threads, done, {std::numeric_limits<std::uint64_t>::max()},
                   [&](const BudgetedFate<N>& fate) {
                     return hybrid::TimeStepping<N, M>{machine, {.step_s = s.step_s, .theta = s.theta}, fate};
                   });
}

// Sizes that are known to the compiler are several times faster.
std::size_t decide_by_method(Basin& basin, const scenario::MachineScenario& s, int threads, const RowDone& done,
                             const PointBudget& budget) {
  constexpr int any = Eigen::Dynamic;
  const bool small = s.machine.coordinates() == 2 && s.machine.frictions() == 2;
  switch (s.integrator) {
    case scenario::Integrator::event_driven:
      return small ? decide_event_driven<2, 2>(basin, s, threads, done, budget)
                   : decide_event_driven<any, any>(basin, s, threads, done, budget);
    case scenario::Integrator::time_stepping:
      return small ? decide_time_stepping<2, 2>(basin, s, threads, done)
                   : decide_time_stepping<any, any>(basin, s, threads, done);
    case scenario::Integrator::adaptive:
      break;
  }
  return decide<any>(basin, s, threads, done, budget,
                     [&](const BudgetedFate<any>& fate) { return adaptive(s, fate, budget.events); });
}

}  // namespace

Basin::Basin(const Grid& grid, const Shard& shard) : grid_{grid}, shard_{shard} {
  const std::size_t points = static_cast<std::size_t>(rows_of(grid, shard)) * static_cast<std::size_t>(grid.points);
  fates_.assign(points, Fate::pending);
  times_s_.assign(points, 0.0);
}

std::size_t Basin::count(Fate fate) const { return static_cast<std::size_t>(std::ranges::count(fates_, fate)); }

double Basin::area(Fate fate) const {
  const auto weight = [&](int index) { return index == 0 || index == grid_.points - 1 ? 0.5 : 1.0; };
  double cells = 0;
  for (int row = 0; row < grid_.points; ++row) {
    if (!shard_.owns(row)) continue;
    for (int column = 0; column < grid_.points; ++column) {
      if (this->fate(column, row) == fate) cells += weight(row) * weight(column);
    }
  }
  const double step = 2 * grid_.half_width / (grid_.points - 1);
  return cells * step * step;
}

double horizon_s(const scenario::MachineScenario& s, const sil::Certificates& certificates) {
  double end_s = s.duration_s;
  for (const stability::EscapeLevel& escape : certificates.escapes) end_s = std::max(end_s, 40 / escape.growth_rate);
  return end_s;
}

std::size_t decide_pending(Basin& basin, const scenario::MachineScenario& s, int threads, const RowDone& done,
                           const PointBudget& budget) {
  require_no_impulses(s);
  try {
    return decide_by_method(basin, s, threads, done, budget);
  } catch (const InputError& error) {
    throw error.in_file(s.file);
  }
}

}  // namespace breakaway::study
