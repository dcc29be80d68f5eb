// The region of attraction in a plane, proved cell by cell: what lies inside and what outside, up to a border as thin
// as is asked for. Each cell is proved by one simulated motion and a bound on how fast two motions part; the theorem
// stands in controller/stability/THEORY.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/study/basin.hpp"

namespace breakaway::study {

// Squares of [-half_width, half_width]^2 in the plane of two entries of (q, v); the others are 0. With a constant force
// f, q is counted from K^-1 f. A cell that cannot be proved is quartered, at most `depth` times.
struct Window {
  double half_width;         // > 0, up to widest_half_width
  std::array<int, 2> plane;  // places in (q, v), 0..2n-1
  int depth;                 // 0..14
};

struct Cell {
  int level;        // side = 2 half_width / 2^level
  int column, row;  // 0..2^level - 1 from the lower left
  Fate proved;      // of all starts in it: attracted, lost, or undecided
  Fate simulated;   // of its centre, as a point of a Basin, by simulation alone; in cells that are quartered no longer
};

class CertifiedRegion {
 public:
  CertifiedRegion(const Window& window, std::vector<Cell> cells, std::size_t motions)
      : window_{window}, cells_{std::move(cells)}, motions_{motions} {}

  const Window& window() const { return window_; }
  const std::vector<Cell>& cells() const { return cells_; }
  std::size_t motions() const { return motions_; }  // how many were simulated

  // Of the cells that are proved to be so.
  double area(Fate proved) const;

  // Of the cells that are proved to be so, and of those undecided whose centre is: attracted is the true region, as
  // well as simulation knows it; undecided is what neither proof nor simulation could tell within their work.
  double area_simulated(Fate fate) const;
  // Of all that is, or may be, attracted, what is proved: 0 to 1.
  double proved_share() const;

 private:
  double area(const Cell& cell) const;

  Window window_;
  std::vector<Cell> cells_;  // without overlap, and all of the window
  std::size_t motions_;
};

// A half-width that shows all of B with some room, to two digits: where attraction is certified from everywhere, or
// from nowhere, of twice E.
double fitting_half_width(const stability::LinearMachine<>& machine, const stability::Attractivity& attractivity,
                          const std::array<int, 2>& plane);

enum class RegionStage : std::uint8_t {
  proving,    // cells are halved
  following,  // motions that were given up on the way are followed further, where there are any
};

// Called by any thread with the share of a stage that is done, 0 to 1, as far as it can be foreseen: each halving of
// the cells takes about twice the work of the one before. A stage begins with 0, before any other thread tells of it.
using RegionProgress = std::function<void(RegionStage stage, double share)>;

// Cells depend on nothing but their place: threads >= 1 do not change the result. Throws InputError where
// nothing is certified to grow from (level_J is 0), for friction laws that vary, and when the integrator cannot take
// the machine.
CertifiedRegion certify_region(const scenario::MachineScenario& scenario, const sil::Certificates& certificates,
                               const Window& window, int threads, const RegionProgress& progress = {});

}  // namespace breakaway::study
