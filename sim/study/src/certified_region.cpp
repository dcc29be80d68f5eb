#include "breakaway/study/certified_region.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "ball_prover.hpp"
#include "breakaway/hybrid/refused.hpp"
#include "breakaway/input/input_error.hpp"
#include "parallel.hpp"

namespace breakaway::study {
namespace {

using hybrid::Verdict;

// Of the distance of the start and of the certified set: far more than all rounding on the way of one motion, 1e-13, as
// if it had happened at the start, where it grows most.
constexpr double rounding = 1e-10;

// Multiplications, a second or less on a PC: shared by the motions of one halving of the cells, so that a machine with
// ever so many events ends, too. Most motions need a tenth of what each has at least.
constexpr double work_of_a_level = 2e8, least_work_of_a_motion = 1e5;
// A cell whose motion was given up is quartered no further than this: its quarters' motions are no shorter.
constexpr int deepest_given_up = 7;
// Multiplications, a few seconds on a PC: shared by the centres of such cells, which are then followed for their own
// fate; and the most of one of them, of which a hopeless motion takes an eighth, as many events as a point of a basin.
constexpr double work_of_the_given_up = 8e9, most_work_of_a_centre = 8e8;
// Where so many halvings proved nothing at all, smaller cells would not either: the rest of E is certified by a set too
// small to be seen in this window.
constexpr int deepest_unproved = 7;

Fate fate(Verdict verdict) {
  switch (verdict) {
    case Verdict::at_rest:
    case Verdict::captured:
      return Fate::attracted;
    case Verdict::lost:
      return Fate::lost;
    case Verdict::undecided:
      break;
  }
  return Fate::undecided;
}

template <int N, int M>
class CellProver {
 public:
  CellProver(const stability::LinearMachine<>& machine, const RegionBounds& bounds, const Window& window)
      : balls_{machine, bounds}, window_{window}, depth_{bounds.depth}, start_{at(machine.coordinates(), 0, 0)} {
    unit_radius_ =
        std::max(balls_.distance(at(machine.coordinates(), 1, 1)), balls_.distance(at(machine.coordinates(), 1, -1)));
  }

  void prove(Cell& cell, bool to_the_end, const hybrid::Budget& budget) {
    const double half = window_.half_width / (1 << cell.level);
    start_ = at(start_.q.size(), (2 * cell.column + 1) * half - window_.half_width,
                (2 * cell.row + 1) * half - window_.half_width);
    const double radius = half * unit_radius_ + rounding * (balls_.distance(start_) + depth_);
    const auto result = balls_.prove(start_, radius, to_the_end, budget);
    cell.proved = result.proved;
    cell.simulated = result.given_up ? Fate::pending : fate(result.simulated);
  }

 private:
  hybrid::MachineState<N> at(Eigen::Index coordinates, double first, double second) const {
    using Vector = Eigen::Matrix<double, N, 1>;
    hybrid::MachineState<N> state{0, Vector::Zero(coordinates), Vector::Zero(coordinates)};
    const auto entry = [&](int place) -> double& {
      return place < coordinates ? state.q[place] : state.v[place - coordinates];
    };
    entry(window_.plane[0]) = first;
    entry(window_.plane[1]) = second;
    return state;
  }

  BallProver<N, M> balls_;
  Window window_;
  double depth_;
  double unit_radius_;  // of a square with half-width 1
  hybrid::MachineState<N> start_;
};

std::vector<Cell> quartered(const std::vector<Cell>& cells) {
  std::vector<Cell> quarters;
  quarters.reserve(4 * cells.size());
  for (const Cell& cell : cells) {
    for (const int up : {0, 1}) {
      for (const int right : {0, 1}) {
        quarters.push_back({cell.level + 1, 2 * cell.column + right, 2 * cell.row + up, Fate::pending, Fate::pending});
      }
    }
  }
  return quarters;
}

template <int N, int M>
using Provers = std::vector<std::unique_ptr<CellProver<N, M>>>;  // one for each thread

// Tells the share of the work of the centres that are followed: a round takes about as much as any other, and one in
// which a motion may take four times as much as before stands for two.
class RoundProgress {
 public:
  RoundProgress(const RegionProgress& progress, double before, double work, std::size_t cells)
      : progress_{progress},
        before_{share(before)},
        of_round_{share(work) - before_},
        cells_{static_cast<double>(cells)} {}

  void cell_done() {
    if (progress_) progress_(RegionStage::following, before_ + of_round_ * static_cast<double>(++done_) / cells_);
  }

 private:
  static double share(double work) {
    return std::log2(work / least_work_of_a_motion) / std::log2(most_work_of_a_centre / least_work_of_a_motion);
  }

  const RegionProgress& progress_;
  double before_, of_round_, cells_;
  std::atomic<std::size_t> done_ = 0;
};

template <int N, int M>
void follow(const std::vector<Cell*>& cells, const Provers<N, M>& provers, const hybrid::Budget& budget,
            RoundProgress& done) {
  in_parallel(cells.size(), static_cast<int>(provers.size()), 1, [&](int thread) {
    return [&cells, &budget, &done, &prover = *provers[static_cast<std::size_t>(thread)]](std::size_t i) {
      prover.prove(*cells[i], true, budget);
      done.cell_done();
    };
  });
}

// A cell whose motion was given up counts by its centre as all others do, as far as the work reaches: motions that end
// early leave theirs to the others. Returns how many were simulated.
template <int N, int M>
std::size_t decide_given_up(std::vector<Cell>& cells, const Provers<N, M>& provers, const RegionProgress& progress) {
  std::vector<Cell*> left;
  for (Cell& cell : cells)
    if (cell.simulated == Fate::pending) left.push_back(&cell);
  if (progress && !left.empty()) progress(RegionStage::following, 0);
  std::size_t motions = 0;
  for (double before = least_work_of_a_motion; !left.empty();) {
    const double work = std::min(work_of_the_given_up / static_cast<double>(left.size()), most_work_of_a_centre);
    if (work < 2 * before) break;
    RoundProgress done{progress, before, work, left.size()};
    before = work;
    follow<N, M>(left, provers, hybrid::Budget{work}, done);
    motions += left.size();
    std::erase_if(left, [](const Cell* cell) { return cell->simulated != Fate::pending; });
  }
  for (Cell* cell : left) cell->simulated = Fate::undecided;
  return motions;
}

// Tells the share of the work: a level of halving counts for twice the one before.
class LevelProgress {
 public:
  LevelProgress(const RegionProgress& progress, int depth, int level, std::size_t cells)
      : progress_{progress},
        before_{std::ldexp(1.0, level) - 1},
        of_level_{std::ldexp(1.0, level)},
        all_{std::ldexp(1.0, depth + 1) - 1},
        cells_{static_cast<double>(cells)} {}

  void cell_done() {
    if (progress_)
      progress_(RegionStage::proving, (before_ + of_level_ * static_cast<double>(++done_) / cells_) / all_);
  }

 private:
  const RegionProgress& progress_;
  double before_, of_level_, all_, cells_;
  std::atomic<std::size_t> done_ = 0;
};

template <int N, int M>
CertifiedRegion grow(const stability::LinearMachine<>& machine, const RegionBounds& bounds, const Window& window,
                     int threads, const RegionProgress& progress) {
  Provers<N, M> provers;
  provers.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i) provers.push_back(std::make_unique<CellProver<N, M>>(machine, bounds, window));
  std::vector<Cell> proved, open{{0, 0, 0, Fate::pending, Fate::pending}};
  std::size_t motions = 0;
  bool anything = false;  // is proved
  for (int level = 0; !open.empty(); ++level) {
    constexpr std::size_t cells_at_a_time = 64;
    LevelProgress done{progress, window.depth, level, open.size()};
    const hybrid::Budget budget{std::max(work_of_a_level / static_cast<double>(open.size()), least_work_of_a_motion)};
    const bool last = level == (anything ? window.depth : std::min(window.depth, deepest_unproved));
    in_parallel(open.size(), threads, cells_at_a_time, [&](int thread) {
      return [&open, &done, &budget, last, &prover = *provers[static_cast<std::size_t>(thread)]](std::size_t i) {
        prover.prove(open[i], last, budget);
        done.cell_done();
      };
    });
    motions += open.size();
    std::vector<Cell> unproved;
    for (Cell& cell : open) {
      const bool given_up = cell.simulated == Fate::pending;
      const int deepest = given_up ? std::min(window.depth, deepest_given_up) : window.depth;
      anything |= cell.proved != Fate::undecided;
      (cell.proved == Fate::undecided && level < deepest ? unproved : proved).push_back(cell);
    }
    if (!anything && level >= deepest_unproved) {
      proved.insert(proved.end(), unproved.begin(), unproved.end());
      unproved.clear();
    }
    open = quartered(unproved);
  }
  motions += decide_given_up<N, M>(proved, provers, progress);
  return {window, std::move(proved), motions};
}

// A cell by what is proved of it, or else by its centre.
Fate best_known(const Cell& cell) { return cell.proved == Fate::undecided ? cell.simulated : cell.proved; }

}  // namespace

double CertifiedRegion::area(const Cell& cell) const {
  const double side = 2 * window_.half_width / (1 << cell.level);
  return side * side;
}

double CertifiedRegion::area(Fate proved) const {
  double sum = 0;
  for (const Cell& cell : cells_) sum += cell.proved == proved ? area(cell) : 0;
  return sum;
}

double CertifiedRegion::area_simulated(Fate fate) const {
  double sum = 0;
  for (const Cell& cell : cells_) sum += best_known(cell) == fate ? area(cell) : 0;
  return sum;
}

double CertifiedRegion::proved_share() const {
  const double whole = area_simulated(Fate::attracted) + area_simulated(Fate::undecided);
  return whole > 0 ? area(Fate::attracted) / whole : 0;
}

double fitting_half_width(const stability::LinearMachine<>& machine, const stability::Attractivity& attractivity,
                          const std::array<int, 2>& plane) {
  const Eigen::Index n = machine.coordinates();
  const bool bounded = attractivity.level_J > 0 && std::isfinite(attractivity.level_J);
  const double level_J = bounded ? attractivity.level_J : 4 * attractivity.greatest_rest_J;
  double widest = 0;
  for (const int place : plane) {
    const Eigen::MatrixXd& form = place < n ? machine.stiffness : machine.mass;
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n, place % n);
    widest = std::max(widest, std::sqrt(2 * level_J * unit.dot(form.llt().solve(unit))));
  }
  if (!(widest > 0)) return 1;
  const double digit = std::pow(10, std::floor(std::log10(1.3 * widest)) - 1);
  return std::round(1.3 * widest / digit) * digit;
}

CertifiedRegion certify_region(const scenario::MachineScenario& s, const sil::Certificates& certificates,
                               const Window& window, int threads, const RegionProgress& progress) {
  if (!s.laws.empty()) {
    throw InputError{
        fmt::format("{}: [[machine.friction]] has a law: how far two motions part is known for constant friction only; "
                    "give friction_N",
                    s.file)};
  }
  if (std::isinf(certificates.attractivity.level_J)) return {window, {{0, 0, 0, Fate::attracted, Fate::attracted}}, 0};
  if (certificates.attractivity.level_J == 0)
    throw InputError{fmt::format("{}: {}", s.file, certificates.attractivity.reason)};
  try {
    const RegionBounds bounds = region_bounds(s.machine, certificates, horizon_s(s, certificates));
    stability::LinearMachine<> about_centre = s.machine;
    about_centre.force_N.resize(0);
    const bool small = s.machine.coordinates() == 2 && s.machine.frictions() == 2;
    return small ? grow<2, 2>(about_centre, bounds, window, threads, progress)
                 : grow<Eigen::Dynamic, Eigen::Dynamic>(about_centre, bounds, window, threads, progress);
  } catch (const hybrid::Refused& refusal) {  // these motions have no method to choose
    throw refusal.without_another_method().in_file(s.file);
  } catch (const InputError& error) {
    throw error.in_file(s.file);
  }
}

}  // namespace breakaway::study
