// The region of attraction of a machine's equilibrium set, on a grid in a plane of its state space: Figure 2 of
// van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/study/shard.hpp"

namespace breakaway::study {

// Of a grid [m, or m/s], as of a coordinate of an axis: the energies out there are far from the end of floating point.
inline constexpr double widest_half_width = 1e9;

// points x points states: two entries of (q, v) from -half_width to half_width, the others 0. With a constant force f,
// q is counted from K^-1 f, about which the machine rests.
struct Grid {
  int points;                // along each axis, >= 2
  double half_width;         // > 0, up to widest_half_width
  std::array<int, 2> plane;  // places in (q, v), 0..2n-1

  // Exactly symmetric, and exactly half_width at the ends.
  double coordinate(int index) const { return half_width * ((2.0 * index - (points - 1)) / (points - 1)); }
};

enum class Fate : std::int8_t { pending = -2, undecided = -1, lost = 0, attracted = 1 };

// Of the shard's rows, which are values of the second entry. Nine bytes a point.
class Basin {
 public:
  Basin(const Grid& grid, const Shard& shard);

  const Grid& grid() const { return grid_; }
  const Shard& shard() const { return shard_; }
  std::size_t size() const { return fates_.size(); }

  // Only for rows that the shard owns.
  Fate fate(int column, int row) const { return fates_[place(column, row)]; }
  double time_s(int column, int row) const { return times_s_[place(column, row)]; }
  void set(int column, int row, Fate fate, double time_s) {
    fates_[place(column, row)] = fate;
    times_s_[place(column, row)] = time_s;
  }

  // Of all points of the shard, row by row.
  std::span<const Fate> fates() const { return fates_; }
  std::span<const double> times_s() const { return times_s_; }

  std::size_t count(Fate fate) const;

  // How many points were given up since the basin was made, because they cost too much or were refused; undecided, too.
  std::size_t given_up() const { return given_up_; }
  void give_up(std::size_t points) { given_up_ += points; }

  // By the trapezoidal rule: points on the border count half, in the corners a quarter.
  double area(Fate fate) const;

 private:
  std::size_t place(int column, int row) const {
    return static_cast<std::size_t>(row / shard_.count) * static_cast<std::size_t>(grid_.points) +
           static_cast<std::size_t>(column);
  }

  Grid grid_;
  Shard shard_;
  std::vector<Fate> fates_;
  std::vector<double> times_s_;  // when it was decided
  std::size_t given_up_ = 0;
};

// What the motion from one point may cost: so many events of the event-driven method, or steps of the adaptive one. A
// point that takes more is undecided; it is counted and never timed, so that every computer decides the same.
struct PointBudget {
  std::uint64_t events = 200'000;
};

// Called after each row, by one thread at a time.
using RowDone = std::function<void(int row, std::size_t simulated)>;

// Followed for duration_s, and at least until an unstable machine has blown up a difference of one rounding to its own
// size: e^40 > 2^53, at the slowest of the unstable modes. What is undecided then lies on the border itself, or moves
// for ever without growing beyond all bounds.
double horizon_s(const scenario::MachineScenario& scenario, const sil::Certificates& certificates);

// Decides all pending points on `threads` >= 1 threads; returns how many. Every point depends on nothing but its place,
// so neither threads nor shards change a bit of the result. Friction laws start anew at every point. Throws InputError
// for [[impulse]], and when the integrator cannot take the machine; a point that the integrator refuses is undecided.
std::size_t decide_pending(Basin& basin, const scenario::MachineScenario& scenario, int threads, const RowDone& done,
                           const PointBudget& budget = {});

}  // namespace breakaway::study
