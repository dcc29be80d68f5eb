#include "breakaway/study/basin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>

#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/time_stepping.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/certificates.hpp"
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

// What a picture of starts in one plane can show, and what the certificates drawn into it are about.
void require_autonomous(const scenario::MachineScenario& s) {
  const char* extra = !s.laws.empty()                                   ? "[[machine.friction]] with a law"
                      : !s.impulses.empty()                             ? "[[impulse]]"
                      : !stability::constant_force(s.machine).isZero(0) ? "[machine] force_N"
                                                                        : nullptr;
  if (extra == nullptr) return;
  throw InputError{fmt::format("{}: a region of attraction is for constant friction and no other force; leave out {}",
                               s.file, extra)};
}

template <int N, class Run>
std::size_t decide_row(Basin& basin, int row, Eigen::Index coordinates, const Run& run) {
  const Grid& grid = basin.grid();
  hybrid::MachineState<N> start{0, Eigen::Matrix<double, N, 1>::Zero(coordinates),
                                Eigen::Matrix<double, N, 1>::Zero(coordinates)};
  const auto entry = [&](int place) -> double& {
    return place < coordinates ? start.q[place] : start.v[place - coordinates];
  };
  std::size_t simulated = 0;
  for (int column = 0; column < grid.points; ++column) {
    if (basin.fate(column, row) != Fate::pending) continue;
    entry(grid.plane[0]) = grid.coordinate(column);
    entry(grid.plane[1]) = grid.coordinate(row);
    const Decided point = decided(run(start));
    basin.set(column, row, point.fate, point.time_s);
    ++simulated;
  }
  return simulated;
}

template <int N, int M>
std::size_t decide(Basin& basin, const scenario::MachineScenario& s, int threads, const RowDone& done) {
  const auto machine = stability::sized<N, M>(s.machine);
  const sil::Certificates certificates = sil::certify(s.machine);
  const sil::ProvenFate<N> fate{s.machine, certificates};
  const double end_s = horizon_s(s, certificates);
  std::mutex mutex;
  std::size_t simulated = 0;
  const auto decide_with = [&](const auto& make_integrator) {
    static_cast<void>(make_integrator());  // one that cannot take the machine says so here, before there are threads
    in_parallel(static_cast<std::size_t>(basin.grid().points), threads, 1, [&](int) {
      return [&, integrator = make_integrator()](std::size_t i) {
        const int row = static_cast<int>(i);
        if (!basin.shard().owns(row)) return;
        const std::size_t decided =
            decide_row<N>(basin, row, machine.coordinates(),
                          [&](const hybrid::MachineState<N>& start) { return integrator.run(start, end_s); });
        const std::scoped_lock lock{mutex};
        simulated += decided;
        if (done) done(row, simulated);
      };
    });
  };
  if (s.integrator == scenario::Integrator::event_driven) {
    decide_with([&] { return hybrid::EventDriven<N, M>{machine, fate}; });
  } else {
    decide_with([&] { return hybrid::TimeStepping<N, M>{machine, {.step_s = s.step_s, .theta = s.theta}, fate}; });
  }
  return simulated;
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

std::size_t decide_pending(Basin& basin, const scenario::MachineScenario& s, int threads, const RowDone& done) {
  require_autonomous(s);
  try {
    // Sizes that are known to the compiler are several times faster.
    const auto n = s.machine.coordinates(), m = s.machine.frictions();
    if (n == 2 && m == 2) return decide<2, 2>(basin, s, threads, done);
    return decide<Eigen::Dynamic, Eigen::Dynamic>(basin, s, threads, done);
  } catch (const InputError& error) {
    throw error.in_file(s.file);
  }
}

}  // namespace breakaway::study
