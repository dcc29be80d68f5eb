// F2 by linear matrix inequalities, and by Theorem 1 itself where it is no such inequality.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "actuation.hpp"
#include "breakaway/stability/dense.hpp"
#include "damping_family.hpp"
#include "gain_search.hpp"
#include "scaled_system.hpp"
#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// These are all of span W, and what of it the damping does not hold already.
std::vector<Split> candidates(const LinearMachine<>& machine) {
  const SpannedSpace space = spanned_space(machine.directions * machine.friction_N.asDiagonal());
  std::vector<Split> splits{{space.basis, space.complement}};
  const dense::SymmetricEigen eigen = dense::symmetric_eigen(dense::symmetric_part(machine.damping));
  const Index unstable = (eigen.values.array() <= 0).count();
  const MatrixXd &columns = eigen.vectors, unheld = columns.leftCols(unstable);
  if (unstable > 0 && unstable < space.basis.cols() && (space.complement.transpose() * unheld).norm() <= 1e-9) {
    splits.push_back({unheld, columns.rightCols(columns.cols() - unstable)});
  }
  return splits;
}

// In mass units; only Theorem 1 is asked of the given system.
class Search {
 public:
  Search(const ScaledSystem& scaled, const Assess& assess)
      : scaled_{scaled},
        actuation_{scaled.system.actuators},
        unit_per_s_{damping_unit_per_s(scaled.system.machine)},
        assess_{assess} {}

  void everywhere() {
    if (unheld_by_actuators()) return;
    const Index n = scaled_.system.machine.coordinates();
    const DampingFamily choice = family({MatrixXd(n, 0), MatrixXd::Identity(n, n)});
    const auto gain = solved([&] { return choice.least_gain(0); });
    if (gain && accepted(*gain)) found_.push_back(*gain);
  }

  // The weakest damping that is accepted. One just above the least limit is the strongest: it is tried first.
  void within(const Split& split, const SearchProgress& progress) {
    const DampingFamily choice = family(split);
    if (!choice.exists()) return;
    const auto least = solved([&] { return choice.least_limit(); });
    if (!least) return;
    constexpr int steps = 24;
    double strong = std::max(*least + 1e-3 * std::abs(*least), 1e-6), weak = std::max(1.0, 2 * strong);
    std::optional<MatrixXd> best;
    for (int step = 0; step <= steps; ++step) {
      progress.at(static_cast<double>(step + 1) / (steps + 2));
      const double limit = step == 0 ? strong : std::sqrt(strong * weak);
      const auto gain = solved([&] { return choice.least_gain(limit); });
      const bool good = gain && accepted(*gain);
      if (good) best = *gain;
      if (!best) return;
      (good ? strong : weak) = limit;
    }
    found_.push_back(*best);
  }

  bool found() const { return !found_.empty(); }

  MatrixXd result() const {
    if (found()) return scaled_.gain(*std::ranges::min_element(found_, {}, dense::spectral_norm));
    if (best_J_ == 0) throw unheld_ ? *unheld_ : failure_;
    throw InputError{"the region is out of reach: with these actuators the best found is " + to_text(best_J_) +
                     " J; ask for less, or add actuators or frictions"};
  }

 private:
  // Returns what the solver finds. Where it finds nothing, its reason is kept in case nothing else is found either.
  template <class Solve>
  auto solved(const Solve& solve) -> std::optional<decltype(solve())> {
    try {
      return solve();
    } catch (const InputError& failure) {
      failure_ = failure;
      return std::nullopt;
    }
  }

  // A direction that no actuator acts on keeps its damping.
  bool unheld_by_actuators() {
    const MatrixXd& z = actuation_.unreached;
    if (z.cols() == 0) return false;
    const dense::SymmetricEigen eigen =
        dense::symmetric_eigen(dense::symmetric_part(dense::congruence(z, scaled_.system.machine.damping)));
    if (eigen.values[0] >= 2 * damping_reserve * unit_per_s_) return false;
    unheld_ = InputError{"the region is out of reach: the direction " +
                         direction_text(scaled_.direction(z * eigen.vectors.col(0))) + " has the damping " +
                         to_text(eigen.values[0]) +
                         " N s/m per kg and no actuator acts on it; friction could hold it in a finite region at most"};
    return true;
  }

  DampingFamily family(const Split& split) const { return {scaled_.system, actuation_, split, unit_per_s_}; }

  bool accepted(const MatrixXd& gain) {
    const Assessment assessment = assess_(scaled_.gain(gain));
    best_J_ = std::max(best_J_, assessment.rho_star_J);
    return assessment.accepted;
  }

  const ScaledSystem& scaled_;
  Actuation actuation_;
  double unit_per_s_;
  const Assess& assess_;
  std::vector<MatrixXd> found_;
  double best_J_ = 0;
  std::optional<InputError> unheld_;  // why the damping cannot be positive definite
  InputError failure_{"no gain of velocity was found; ask for less, or add actuators, dampers or frictions"};
};

}  // namespace

double damping_unit_per_s(const LinearMachine<>& in_mass_units) {
  const double springs_per_s = std::sqrt(in_mass_units.mass.norm() * in_mass_units.stiffness.norm());
  return std::max(in_mass_units.damping.norm(), 1e-3 * springs_per_s);
}

MatrixXd full_velocity_gain(const ActuatedSystem& system, bool everywhere, const Assess& assess,
                            const SearchProgress& progress) {
  const ScaledSystem scaled = in_mass_units(system);
  Search search{scaled, assess};
  if (!everywhere) {
    const std::vector<Split> splits = candidates(scaled.system.machine);
    const double part = (progress.to - progress.from) / static_cast<double>(splits.size());
    for (std::size_t i = 0; i < splits.size(); ++i) {
      const double from = progress.from + part * static_cast<double>(i);
      search.within(splits[i], {progress.tell, from, from + part});
    }
  }
  if (!search.found()) search.everywhere();
  return search.result();
}

}  // namespace breakaway::stability
