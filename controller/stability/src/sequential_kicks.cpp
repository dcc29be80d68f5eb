#include "breakaway/stability/sequential_kicks.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "breakaway/input/input_error.hpp"
#include "breakaway/stability/definite_proof.hpp"
#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

void require_size(const char* key, Index rows, Index columns, Index n, bool square) {
  if (rows == n && columns == (square ? n : 1)) return;
  throw InputError{std::string{key} + " is of " + std::to_string(rows) + " x " + std::to_string(columns) +
                   ", and the machine has " + std::to_string(n) + " axes: give an entry for each"};
}

void require_all(const char* key, bool holds, const char* what) {
  if (!holds) throw InputError{std::string{key} + " " + what};
}

void require_sizes(const CoupledAxes& a) {
  const Index n = a.axes();
  require_all("mass", n > 0, "is empty; give a row for each axis");
  require_size("mass", a.mass.rows(), a.mass.cols(), n, true);
  require_size("mass_error", a.mass_error.rows(), a.mass_error.cols(), n, true);
  if (a.range_m.size() > 0) require_size("range_m", a.range_m.rows(), 1, n, false);
  require_size("damping", a.damping.rows(), a.damping.cols(), n, true);
  require_size("stiffness", a.stiffness.rows(), a.stiffness.cols(), n, true);
  require_size("load_N", a.load_N.rows(), 1, n, false);
  require_size("friction_lower_N", a.friction_lower_N.rows(), 1, n, false);
  require_size("friction_upper_N", a.friction_upper_N.rows(), 1, n, false);
  require_size("brake_N", a.brake_N.rows(), 1, n, false);
  require_size("force_step_N", a.force_step_N.rows(), 1, n, false);
  require_size("max_force_N", a.max_force_N.rows(), 1, n, false);
}

// A NaN makes each of them false.
bool none_below(const Eigen::MatrixXd& m, double least) { return (m.array() >= least).all() && m.allFinite(); }

// The friction that is to hold axis j alone against springs, loads and the steps of its force.
double standing_load_N(const CoupledAxes& a, const VectorXd& box_m, Index j) {
  return a.load_N[j] + a.stiffness.row(j).cwiseAbs().dot(box_m);
}

// What moves axis j while the axis i goes at most this fast: dampers between the two, and Coriolis forces. Each of
// these, Gamma v^2 with Gamma = dM_ji/dq_i - dM_ii/dq_j / 2, is at most 3/2 of the steepest entry of M.
double moving_load_N(const CoupledAxes& a, Index j, Index i, double peak_m_s) {
  return std::abs(a.damping(j, i)) * peak_m_s + 1.5 * a.mass_slope_kg_per_m * peak_m_s * peak_m_s;
}

// Half of the steepest dM_ii/dq_i, of which the axis makes a force on itself.
double own_coriolis_N(const CoupledAxes& a, double peak_m_s) {
  return 0.5 * a.mass_slope_kg_per_m * peak_m_s * peak_m_s;
}

// All that friction of axis j must hold beside its share of M_ii q_i''.
double beside_N(const CoupledAxes& a, const VectorXd& box_m, const KickedAxis& k, Index i, Index j) {
  const Coupling c = coupling(a, i, j);
  return standing_load_N(a, box_m, j) + (a.actuated(j) ? a.force_step_N[j] / 2 : 0) +
         moving_load_N(a, j, i, k.peak_m_s) + (std::abs(c.hold_off) + c.deviation) * own_coriolis_N(a, k.peak_m_s);
}

// The share of its command that a current loop which lags has reached after one period.
double reached(const CoupledAxes& a) { return -std::expm1(-a.period_s / a.lag_s); }

// In THEORY.md: f - h, the part of M_ii q_i'' that the hold-off force h does not take.
double left_over_N(const CoupledAxes& a, const KickedAxis& k, double force_N, KickPhase phase) {
  const double middle_N = (k.lower_N + k.upper_N) / 2;
  switch (phase) {
    case KickPhase::start:
      return k.upper_N - middle_N * std::min(reached(a), k.lower_N / force_N);
    case KickPhase::pulse:
      return (k.upper_N - k.lower_N) / 2;
    case KickPhase::coast:
      return (k.upper_N + k.brake_N) / 2;
    case KickPhase::hold_off:
      break;
  }
  return 0;
}

// The most of |M_ii q_i''|.
double inertia_N(const KickedAxis& k, double force_N, KickPhase phase) {
  if (phase == KickPhase::coast) return k.upper_N + k.brake_N;
  return phase == KickPhase::pulse ? force_N - k.lower_N : std::max(force_N - k.lower_N, k.upper_N - k.lower_N);
}

PairCondition condition(const CoupledAxes& a, const VectorXd& box_m, double force_N, Index i, Index j,
                        KickPhase phase) {
  const KickedAxis k = kicked_axis(a, box_m, i);
  const Coupling c = coupling(a, i, j);
  const double inertia = inertia_N(k, force_N, phase);
  const double needed_N = a.actuated(j)
                              ? std::abs(c.hold_off) * left_over_N(a, k, force_N, phase) + c.deviation * inertia
                              : (std::abs(c.hold_off) + c.deviation) * inertia;
  return {i, j, phase, needed_N + beside_N(a, box_m, k, i, j), a.friction_lower_N[j], false};
}

PairCondition drive_condition(const CoupledAxes& a, const VectorXd& box_m, double force_N, Index i, Index j) {
  const KickedAxis k = kicked_axis(a, box_m, i);
  const double most_N = std::max(force_N - (k.lower_N + k.upper_N) / 2, (k.upper_N + k.brake_N) / 2);
  return {i, j, KickPhase::hold_off, std::abs(coupling(a, i, j).hold_off) * most_N, a.max_force_N[j], false};
}

// What the hold-off force for the kicks of `other` leaves of its inertia: the middle of all that may come, and rho, the
// most by which M_ll q_l'' is off the middle.
struct Crossed {
  double half_range_N, most_N;
};

Crossed crossed(const KickedAxis& k, double force_N) {
  const double half_N = std::max((k.upper_N - k.lower_N) / 2, (k.upper_N + k.brake_N) / 2);
  return {half_N, std::max(force_N - k.lower_N, k.upper_N + k.brake_N)};
}

}  // namespace

void require_valid(const CoupledAxes& a) {
  require_sizes(a);
  require_all("mass", symmetric(a.mass) && positive_definite(a.mass) == Proof::holds,
              "is not symmetric and positive definite; correct it");
  require_all("mass_error", none_below(a.mass_error, 0), "has an entry below 0, or none that is a number; correct it");
  require_all("mass_error", ((a.mass - a.mass_error).diagonal().array() > 0).all(),
              "takes all of a mass on the diagonal away; lower it");
  require_all("damping", a.damping.allFinite() && none_below(a.damping.diagonal(), 0),
              "is negative for an axis alone, so that it grows faster by itself; correct it");
  require_all("stiffness", a.stiffness.allFinite(), "is not finite; correct it");
  require_all("load_N", none_below(a.load_N, 0), "is a bound and has an entry below 0; correct it");
  require_all("friction_lower_N", none_below(a.friction_lower_N, std::numeric_limits<double>::min()),
              "is not above 0; a kick ends by friction only, so give a lower bound of it");
  require_all("friction_upper_N", none_below(a.friction_upper_N - a.friction_lower_N, 0),
              "is below friction_lower_N; swap or correct them");
  require_all("brake_N", none_below(a.brake_N, 0), "has an entry below 0; correct it");
  require_all("force_step_N", none_below(a.force_step_N, 0), "has an entry below 0; correct it");
  require_all("max_force_N", none_below(a.max_force_N, 0), "has an entry below 0; correct it");
  require_all("period_s", a.period_s > 0 && a.lag_s >= 0 && a.mass_slope_kg_per_m >= 0,
              "must be above 0, and lag_s and mass_slope_kg_per_m not below; correct them");
}

double KickedAxis::most_travel_m(double f, double seconds) const {
  return (f - lower_N) * (f + brake_N) * seconds * seconds / (2 * mass_lower_kg * (lower_N + brake_N));
}

// From any instant of the pulse on, a current loop that lags gives at least what it gives there. Each such instant
// makes a bound; the best of some counts.
double KickedAxis::least_travel_m(double f, double seconds) const {
  constexpr int instants = 16;
  double most_m = 0;
  for (int i = 0; i <= (lag_s > 0 ? instants : 0); ++i) {
    const double late_s = seconds / 2 * i / instants, left_s = seconds - late_s;
    const double given_N = lag_s > 0 ? -f * std::expm1(-late_s / lag_s) : f;
    if (given_N > upper_N) most_m = std::max(most_m, (given_N - upper_N) * (given_N + brake_N) * left_s * left_s);
  }
  return most_m / (2 * mass_upper_kg * (upper_N + brake_N));
}

double KickedAxis::force_N(double distance_m, double seconds) const {
  const double g = lower_N + brake_N;
  return ((lower_N - brake_N) + std::sqrt(g * g + 8 * mass_lower_kg * g * distance_m / (seconds * seconds))) / 2;
}

KickedAxis kicked_axis(const CoupledAxes& axes, const VectorXd& box_m, Index kicked) {
  KickedAxis k;
  const double beside = standing_load_N(axes, box_m, kicked) + axes.force_step_N[kicked] / 2;
  k.brake_N = axes.brake_N[kicked];
  k.mass_lower_kg = axes.mass(kicked, kicked) - axes.mass_error(kicked, kicked);
  k.mass_upper_kg = axes.mass(kicked, kicked) + axes.mass_error(kicked, kicked);
  k.lower_N = axes.friction_lower_N[kicked] - beside;
  const double g = std::max(k.lower_N + k.brake_N, 0.0);
  k.peak_m_s = std::sqrt(2 * g * box_m[kicked] / k.mass_lower_kg);
  k.upper_N = axes.friction_upper_N[kicked] + beside + axes.damping(kicked, kicked) * k.peak_m_s;
  k.lag_s = axes.lag_s;
  k.sure_N = sure_share * k.upper_N / (axes.lag_s > 0 ? -std::expm1(-axes.period_s / (2 * axes.lag_s)) : 1);
  return k;
}

Coupling coupling(const CoupledAxes& axes, Index kicked, Index held) {
  const double least = axes.mass(kicked, kicked) - axes.mass_error(kicked, kicked),
               most = axes.mass(kicked, kicked) + axes.mass_error(kicked, kicked);
  const auto [low, high] = std::minmax({(axes.mass(held, kicked) - axes.mass_error(held, kicked)) / least,
                                        (axes.mass(held, kicked) - axes.mass_error(held, kicked)) / most,
                                        (axes.mass(held, kicked) + axes.mass_error(held, kicked)) / least,
                                        (axes.mass(held, kicked) + axes.mass_error(held, kicked)) / most});
  return {(low + high) / 2, (high - low) / 2};
}

const char* to_string(KickPhase phase) {
  switch (phase) {
    case KickPhase::start:
      return "start of the pulse";
    case KickPhase::pulse:
      return "pulse";
    case KickPhase::coast:
      return "coast";
    case KickPhase::hold_off:
      return "hold-off force of the drive";
  }
  return "unknown phase";
}

double free_friction_N(const CoupledAxes& axes, const VectorXd& box_m, Index held) {
  return axes.friction_lower_N[held] - standing_load_N(axes, box_m, held) -
         (axes.actuated(held) ? axes.force_step_N[held] / 2 : 0);
}

std::vector<PairCondition> pair_conditions(const CoupledAxes& axes, const VectorXd& box_m, double force_N, Index kicked,
                                           Index held) {
  std::vector<PairCondition> all;
  if (axes.lag_s > 0) all.push_back(condition(axes, box_m, force_N, kicked, held, KickPhase::start));
  all.push_back(condition(axes, box_m, force_N, kicked, held, KickPhase::pulse));
  all.push_back(condition(axes, box_m, force_N, kicked, held, KickPhase::coast));
  if (axes.actuated(held)) all.push_back(drive_condition(axes, box_m, force_N, kicked, held));
  return all;
}

PairCondition tightest(const CoupledAxes& axes, const VectorXd& box_m, double force_N, Index kicked) {
  PairCondition worst{kicked, kicked, KickPhase::pulse, 0, std::numeric_limits<double>::infinity(), false};
  for (Index j = 0; j < axes.axes(); ++j) {
    if (j == kicked) continue;
    for (const PairCondition& c : pair_conditions(axes, box_m, force_N, kicked, j)) {
      if (!(c.margin_N() >= worst.margin_N())) worst = c;
    }
  }
  return worst;
}

double largest_kick_N(const CoupledAxes& axes, const VectorXd& box_m, double least_N, double most_N, Index kicked) {
  const auto admits = [&](double force_N) { return tightest(axes, box_m, force_N, kicked).holds(); };
  if (!(least_N <= most_N) || !admits(least_N)) return 0;
  if (admits(most_N)) return most_N;
  double holds_N = least_N, fails_N = most_N;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle_N = (holds_N + fails_N) / 2;
    (admits(middle_N) ? holds_N : fails_N) = middle_N;
  }
  return holds_N;
}

PairCondition simultaneous_condition(const CoupledAxes& axes, const VectorXd& box_m, const VectorXd& force_N,
                                     Index disturbed, Index other) {
  const KickedAxis own = kicked_axis(axes, box_m, disturbed), theirs = kicked_axis(axes, box_m, other);
  const Coupling to_i = coupling(axes, other, disturbed), to_l = coupling(axes, disturbed, other);
  const Crossed mine = crossed(own, force_N[disturbed]), its = crossed(theirs, force_N[other]);
  // What one axis feels of the other makes the other's range wider, and so on: rho = range + share rho of the other.
  const double share_i = std::abs(to_i.hold_off) + to_i.deviation, share_l = std::abs(to_l.hold_off) + to_l.deviation;
  const double loop = 1 - share_i * share_l;
  const double range_l = its.half_range_N + to_l.deviation * mine.most_N;
  const double range_i = mine.half_range_N + to_i.deviation * its.most_N;
  const double rho_l = loop > 0 ? (range_l + share_l * range_i) / loop : std::numeric_limits<double>::infinity();
  const double felt_N = std::abs(to_i.hold_off) * rho_l + to_i.deviation * (its.most_N + rho_l) +
                        moving_load_N(axes, disturbed, other, theirs.peak_m_s);
  return {other, disturbed, KickPhase::coast, felt_N + own.brake_N, own.lower_N, true};
}

}  // namespace breakaway::stability
