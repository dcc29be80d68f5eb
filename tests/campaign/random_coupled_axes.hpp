// Random machines of axes that push each other: what is told of them, a truth inside that, and friction of every kind
// that their bounds allow.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "breakaway/stability/definite_proof.hpp"
#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/sequential_kicks.hpp"
#include "coupled_plant.hpp"

namespace breakaway::campaign {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : bits_{seed} {}
  double share() { return std::uniform_real_distribution<>{0, 1}(bits_); }
  double between(double low, double high) { return low + (high - low) * share(); }
  double decades(double low, double high) { return low * std::pow(high / low, share()); }
  int below(int count) { return static_cast<int>(share() * count); }
  bool chance(double probability) { return share() < probability; }
  double sign() { return chance(0.5) ? 1 : -1; }

 private:
  std::mt19937_64 bits_;
};

// What a machine has beside its masses.
struct Kind {
  const char* name;
  double mass_error;  // relative, of every entry
  bool springs, idle, lag, curved, damped;
};

constexpr std::array kinds{
    Kind{"plain", 0, false, false, false, false, false},
    Kind{"masses off by 30 %", 0.3, false, false, false, false, false},
    Kind{"springs", 0, true, false, false, false, false},
    Kind{"springs, masses off by 5 %", 0.05, true, false, false, false, false},
    Kind{"an axis without a drive", 0.02, false, true, false, false, false},
    Kind{"current loops that lag", 0.02, false, false, true, false, false},
    Kind{"masses that vary with place", 0.01, true, false, false, true, false},
    Kind{"dampers between the axes", 0.02, true, false, true, false, true},
};

struct CoupledDraw {
  stability::CoupledAxes told;
  Eigen::VectorXd box_m;
  CoupledTruth truth;
};

inline Eigen::MatrixXd random_mass(Dice& dice, Eigen::Index n, double coupling) {
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) m(i, i) = dice.decades(0.5, 5);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j)
      m(i, j) = m(j, i) =
          dice.sign() * dice.share() * coupling * std::sqrt(m(i, i) * m(j, j)) / static_cast<double>(n - 1);
  }
  return m;
}

// Symmetric, with entries of at most `most`.
inline Eigen::MatrixXd random_symmetric(Dice& dice, Eigen::Index n, double most) {
  Eigen::MatrixXd s(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) s(i, j) = s(j, i) = dice.between(-most, most);
  }
  return s;
}

// Between neighbours, as dampers and springs are.
inline Eigen::MatrixXd random_links(Dice& dice, Eigen::Index n, double most) {
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const double link = most * dice.share();
    k(i, i) += link, k(i + 1, i + 1) += link, k(i, i + 1) -= link, k(i + 1, i) -= link;
  }
  return k;
}

inline Square square_of(const Eigen::MatrixXd& m) {
  Square s{};
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) s[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = m(i, j);
  }
  return s;
}

// Wherever the machine is in its box, no motion has less than no energy.
inline bool has_energy(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& varies) {
  const Eigen::MatrixXd least = mass - Eigen::MatrixXd{varies.rowwise().sum().asDiagonal()};
  return stability::positive_definite(least) == stability::Proof::holds;
}

// A truth at the ends of what is told as often as inside. Its masses vary as they may on the way from -box to box.
inline CoupledTruth random_truth(Dice& dice, const stability::CoupledAxes& told, const Eigen::MatrixXd& constant_error,
                                 const std::vector<Eigen::MatrixXd>& slopes) {
  CoupledTruth truth;
  const Eigen::Index n = told.axes();
  truth.axes = static_cast<std::size_t>(n);
  Eigen::MatrixXd mass;
  do {
    mass = told.mass;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        const double off = constant_error(i, j) * (dice.chance(0.7) ? dice.sign() : dice.between(-1, 1));
        mass(i, j) = mass(j, i) = told.mass(i, j) + off;
      }
    }
  } while (!has_energy(mass, told.mass_error - constant_error));
  truth.mass = square_of(mass);
  truth.damping = square_of(told.damping);
  truth.stiffness = square_of(told.stiffness);
  truth.curved = !slopes.empty();
  for (std::size_t c = 0; c < slopes.size(); ++c) truth.slope[c] = square_of(slopes[c]);
  for (Eigen::Index i = 0; i < n; ++i)
    truth.load_N[static_cast<std::size_t>(i)] = told.load_N[i] * (dice.chance(0.7) ? dice.sign() : dice.between(-1, 1));
  truth.lag_s = told.lag_s;
  return truth;
}

inline CoupledDraw random_coupled(Dice& dice, const Kind& kind, Eigen::Index n, double box_m) {
  CoupledDraw d;
  stability::CoupledAxes& a = d.told;
  a.mass = random_mass(dice, n, 0.9);
  a.damping = kind.damped ? random_links(dice, n, 2) : Eigen::MatrixXd::Zero(n, n);
  a.stiffness = kind.springs ? random_links(dice, n, 0.2 / box_m) : Eigen::MatrixXd::Zero(n, n);
  a.load_N = Eigen::VectorXd::Zero(n);
  a.friction_lower_N.resize(n), a.friction_upper_N.resize(n), a.brake_N.resize(n);
  a.max_force_N = Eigen::VectorXd::Constant(n, 100);
  a.force_step_N = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    a.friction_lower_N[i] = dice.decades(1, 6);
    a.friction_upper_N[i] = a.friction_lower_N[i] * dice.between(1, 2.5);
    a.brake_N[i] = dice.chance(0.5) ? 0 : 0.5 * a.friction_lower_N[i] * dice.share();
    if (dice.chance(0.3)) a.load_N[i] = 0.1 * a.friction_lower_N[i] * dice.share();
  }
  if (kind.idle) a.max_force_N[n - 1] = 0;
  a.period_s = 1e-3;
  a.lag_s = kind.lag ? dice.decades(5e-5, 5e-4) : 0;
  d.box_m = Eigen::VectorXd::Constant(n, box_m);
  const Eigen::MatrixXd constant_error = kind.mass_error * dice.share() * a.mass.cwiseAbs();
  a.mass_error = constant_error;
  std::vector<Eigen::MatrixXd> slopes;
  if (kind.curved) {
    const double room_kg = stability::dense::symmetric_eigenvalues(a.mass).minCoeff();
    a.mass_slope_kg_per_m = std::min(dice.decades(0.1, 2), 0.3 * room_kg / (box_m * static_cast<double>(n * n)));
    for (Eigen::Index c = 0; c < n; ++c) slopes.push_back(random_symmetric(dice, n, a.mass_slope_kg_per_m));
    for (const Eigen::MatrixXd& slope : slopes) a.mass_error += box_m * slope.cwiseAbs();
  }
  if (kind.curved) a.range_m = d.box_m;
  d.truth = random_truth(dice, a, constant_error, slopes);
  return d;
}

// Friction that is the worst for whoever must hold: of every axis between its bounds, changed at any step.
class AnyFriction {
 public:
  static constexpr int kinds = 6;

  AnyFriction(Dice& dice, const stability::CoupledAxes& told, int kind) : dice_{dice}, told_{told}, kind_{kind} {
    for (Eigen::Index i = 0; i < told.axes(); ++i) constant_[static_cast<std::size_t>(i)] = drawn(i);
  }

  // kicked: the axis under a kick; none where it is no axis of the machine.
  void set(Forces& friction_N, double time_s, Eigen::Index kicked) {
    const bool redraw = time_s >= next_s_;
    if (redraw) next_s_ = time_s + dice_.decades(2e-5, 2e-3);
    if (redraw) hard_ = !hard_;
    for (Eigen::Index i = 0; i < told_.axes(); ++i) {
      double& f = friction_N[static_cast<std::size_t>(i)];
      const double low = told_.friction_lower_N[i], high = told_.friction_upper_N[i];
      if (kind_ == 0) f = constant_[static_cast<std::size_t>(i)];
      if (kind_ == 1 && redraw) f = drawn(i);
      if (kind_ == 2) f = low;
      if (kind_ == 3) f = i == kicked ? high : low;
      if (kind_ == 4) f = i == kicked && hard_ ? high : low;
      if (kind_ == 5) f = hard_ ? high : low;
    }
  }

 private:
  double drawn(Eigen::Index i) { return dice_.between(told_.friction_lower_N[i], told_.friction_upper_N[i]); }

  Dice& dice_;
  const stability::CoupledAxes& told_;
  int kind_;
  Forces constant_{};
  double next_s_ = 0;
  bool hard_ = false;
};

}  // namespace breakaway::campaign
