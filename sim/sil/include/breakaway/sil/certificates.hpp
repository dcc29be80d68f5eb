// What is proved about a machine before anything is simulated, and the early end of a simulation by it.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>
#include <vector>

#include "breakaway/hybrid/types.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/escape.hpp"
#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::sil {

struct Certificates {
  stability::Attractivity attractivity;
  std::vector<stability::EscapeLevel> escapes;
  Eigen::VectorXd centre;  // K^-1 f: the certificates are about q - centre, for which there is no constant force
};

// Throws Contradiction where the certificates exclude each other.
Certificates certify(const stability::LinearMachine<>& machine);

// With friction laws: attractive by their lower bounds, for V falls the faster the stronger friction is; escaping by
// their upper ones.
Certificates certify(const scenario::MachineScenario& scenario);

// An EarlyDecision: captured where V < level_J (Theorem 1 and beyond), lost beyond a level of escape. Levels are drawn
// in by 1e-12, more than the rounding of V and z. A level of 0 certifies nothing, below 0 neither, where V falls
// without end if stiffness is not positive definite.
template <int N>
class ProvenFate {
 public:
  ProvenFate(const stability::LinearMachine<>& machine, const Certificates& certificates)
      : mass_{machine.mass / 2}, stiffness_{machine.stiffness / 2}, centre_{certificates.centre} {
    rho_J_ = certificates.attractivity.level_J * (1 - margin);
    const Eigen::Index n = machine.coordinates();
    for (const stability::EscapeLevel& escape : certificates.escapes) {
      modes_.push_back({escape.real.head(n), escape.real.tail(n), escape.imaginary.head(n), escape.imaginary.tail(n),
                        escape.unit.head(n).cwiseInverse(), escape.unit.tail(n).cwiseInverse(), escape.level});
    }
  }

  hybrid::Verdict operator()(const hybrid::MachineState<N>& state) const {
    const Vector q = state.q - centre_;
    const double energy_J = state.v.dot(mass_.lazyProduct(state.v)) + q.dot(stiffness_.lazyProduct(q));
    if (rho_J_ > 0 && energy_J < rho_J_) return hybrid::Verdict::captured;
    for (const Mode& mode : modes_) {
      const double size = std::hypot(mode.real_q.dot(q) + mode.real_v.dot(state.v),
                                     mode.imaginary_q.dot(q) + mode.imaginary_v.dot(state.v));
      const double rounding = margin * std::sqrt(mode.per_unit_q.cwiseProduct(q).squaredNorm() +
                                                 mode.per_unit_v.cwiseProduct(state.v).squaredNorm());
      if (size > mode.level + rounding) return hybrid::Verdict::lost;
    }
    return hybrid::Verdict::undecided;
  }

 private:
  using Vector = Eigen::Matrix<double, N, 1>;
  static constexpr double margin = 1e-12;

  struct Mode {
    Vector real_q, real_v, imaginary_q, imaginary_v, per_unit_q, per_unit_v;
    double level;
  };

  Eigen::Matrix<double, N, N> mass_, stiffness_;  // halves, for V of (5)
  Vector centre_;
  double rho_J_;
  std::vector<Mode> modes_;
};

}  // namespace breakaway::sil
