#include "breakaway/stability/machine_certificate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "breakaway/stability/definite_proof.hpp"
#include "breakaway/stability/dense.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double widened = 1 + 1e-9;                        // by which bounds that are computed in double are widened
constexpr std::uint32_t endless = 100000;                   // kicks
constexpr double rounded_in_float = 1 - 16 * 1.1920929e-7;  // at most, of the forces that the coordinator computes
constexpr double spared = 0.99;  // of the largest force that is admitted, so that float holds the conditions

template <class... Values>
std::string text(const char* format, Values... values) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

std::string axis_name(Index i) { return "axis " + std::to_string(i + 1); }

MatrixXd diagonal(const VectorXd& d) { return MatrixXd{d.asDiagonal()}; }

// By Gershgorin's circles, mass_error moves M by no more than the sums of its rows on the diagonal, either way.
struct MassRange {
  MatrixXd lower;         // M - lower is positive semidefinite
  MatrixXd inverse;       // of the middle
  MatrixXd inverse_off;   // |M^-1 - inverse|, entry by entry, at most
  MatrixXd inverse_most;  // |M^-1|, entry by entry, at most
  bool bounded = false;
};

MassRange mass_range(const CoupledAxes& a) {
  MassRange range;
  const Index n = a.axes();
  range.lower = a.mass - diagonal(a.mass_error.rowwise().sum());
  if (positive_definite(range.lower) != Proof::holds) return range;
  range.inverse = dense::Cholesky(a.mass).inverse();
  const MatrixXd most = range.inverse.cwiseAbs() * widened;
  const MatrixXd share = most * a.mass_error;
  if (!(share.rowwise().sum().maxCoeff() < 1)) return range;
  range.inverse_most = dense::inverse(MatrixXd::Identity(n, n) - share) * most * widened;
  range.inverse_off = share * range.inverse_most;
  range.bounded = range.inverse_most.allFinite();
  return range;
}

class Certifier {
 public:
  Certifier(const CoupledAxes& axes, const SampledApproach& approach, const VectorXd& tolerance_m)
      : a_{axes}, p_{approach}, tolerance_m_{tolerance_m}, n_{axes.axes()}, masses_{mass_range(axes)} {}

  MachineCertificate certify() {
    if (closes_loop() && survives_sampling() && falls() && lets_go()) kick();
    result_.certified = result_.reason.empty();
    return std::move(result_);
  }

 private:
  // Notes a condition; the first that fails is the reason.
  bool require(std::string name, bool holds, double margin, std::string found, const std::string& remedy) {
    if (!holds && result_.reason.empty())
      result_.reason = name + ": " + found + text(" (margin %.4g); ", margin) + remedy;
    result_.conditions.push_back({std::move(name), holds, margin, std::move(found)});
    return holds;
  }

  bool closes_loop() {
    closed_K_ = a_.stiffness + diagonal(p_.position_gain_N_per_m);
    const bool positive = symmetric(a_.stiffness) && positive_definite(closed_K_) == Proof::holds;
    const double least = definiteness(dense::symmetric_part(closed_K_));
    if (!require("closed loop stiffness", positive, least,
                 text("K + P is %ssymmetric and positive definite", positive ? "" : "not proved to be "),
                 "give every axis a position gain, and a symmetric stiffness"))
      return false;
    closed_C_ = a_.damping + diagonal(p_.velocity_gain_Ns_per_m);
    softness_ = dense::Cholesky(closed_K_).inverse() * widened;
    const double share = (dense::Cholesky(a_.mass).inverse().cwiseAbs() * a_.mass_error).rowwise().sum().maxCoeff();
    return require("masses", masses_.bounded, 1 - share,
                   text("the errors of the masses are %.3g of what would make them singular, at most", share),
                   "state the masses more exactly") &&
           stays_in_range();
  }

  // V <= start_J holds q in an ellipsoid; what leaves it after the release is small, and looked at there.
  bool stays_in_range() {
    result_.sampled.start_J = start_J();
    return within_range("range of the masses", (2 * start_J() * softness_.diagonal()).cwiseSqrt(), "approach",
                        "start nearer to the target");
  }

  // Nothing takes an axis out of the range in which the masses are stated.
  bool within_range(const char* name, const VectorXd& reach_m, const char* what, const char* remedy) {
    if (a_.range_m.size() == 0) return true;
    Index worst = 0;
    const double least_m = (a_.range_m - reach_m).minCoeff(&worst);
    return require(name, least_m >= 0, least_m,
                   axis_name(worst) + text(": the %s may take it %.4g m from its target, and the masses are stated "
                                           "within %.4g m",
                                           what, reach_m[worst], a_.range_m[worst]),
                   std::string{"state the masses in a wider range, or "} + remedy);
  }

  // V at the start: a quadratic form is greatest at a corner of the box.
  double start_J() const { return 0.5 * p_.start_m.dot(closed_K_.cwiseAbs() * p_.start_m) * widened; }

  double age_s() const { return (p_.latency_periods + 1) * a_.period_s + a_.lag_s; }

  // What a reading and the steps of force are off at rest.
  VectorXd static_error_N() const {
    const VectorXd& q = p_.resolution_m;
    return a_.load_N + a_.force_step_N / 2 + p_.position_gain_N_per_m.cwiseProduct(q) / 2 +
           p_.velocity_gain_Ns_per_m.cwiseProduct(q) / a_.period_s;
  }

  VectorXd speeds_m_s(double energy_J) const {
    const MatrixXd inverse = dense::Cholesky(masses_.lower).inverse();
    return (2 * energy_J * inverse.diagonal() * widened).cwiseSqrt();
  }

  // Without the error of sampling: M a = -K_cl q - C_cl v + lambda + error + Coriolis, in { V <= energy_J }.
  VectorXd accelerations_m_s2(double energy_J, const VectorXd& error_N) const {
    const MatrixXd form = closed_K_ + closed_C_ * dense::Cholesky(masses_.lower).inverse() * closed_C_.transpose();
    const double root = std::sqrt(2 * energy_J) * widened;
    const VectorXd forces_N = root * form.diagonal().cwiseSqrt();
    const double speed = speeds_m_s(energy_J).sum();
    const VectorXd bounded_N =
        a_.friction_upper_N + error_N + VectorXd::Constant(n_, 1.5 * a_.mass_slope_kg_per_m * speed * speed);
    VectorXd a = masses_.inverse_off * forces_N + masses_.inverse_most * bounded_N;
    for (Index i = 0; i < n_; ++i) {
      const VectorXd row = masses_.inverse.row(i);
      a[i] += root * std::sqrt(row.dot(form * row));
    }
    return a;
  }

  // The hold of samples costs P age of damping, and of friction what the acceleration makes of the rest. The two
  // bounds need each other: the least pair that satisfies both is approached from below.
  bool survives_sampling() {
    SampledMargin& s = result_.sampled;
    s.lost_Ns_per_m = p_.position_gain_N_per_m * age_s();
    const double square_s2 = (age_s() * age_s() + a_.lag_s * a_.lag_s) / 2;
    const VectorXd per_acceleration =
        p_.position_gain_N_per_m * square_s2 + p_.velocity_gain_Ns_per_m * (age_s() + a_.period_s / 2);
    const VectorXd speed = speeds_m_s(s.start_J);
    s.lost_N = static_error_N();
    bool settled = false;
    for (int round = 0; round < 200 && !settled && s.lost_N.allFinite(); ++round) {
      const VectorXd before = s.lost_N;
      s.acceleration_m_s2 = accelerations_m_s2(s.start_J, s.lost_N + s.lost_Ns_per_m.cwiseProduct(speed));
      s.lost_N = static_error_N() + per_acceleration.cwiseProduct(s.acceleration_m_s2);
      settled = ((s.lost_N - before).array() <= 1e-9 * before.array()).all();
    }
    s.lost_N *= 1 + 1e-6;
    Index worst = 0;
    const VectorXd margin = a_.friction_lower_N - s.lost_N;
    const double least_N = margin.minCoeff(&worst);
    const double standing_N = static_error_N()[worst], held_N = s.lost_N[worst] - standing_N;
    return require("sampling", settled && least_N > 0, least_N,
                   axis_name(worst) + text(": of %.4g N of friction, samples held for %.4g s cost %.4g N, and loads, "
                                           "counts and steps of force %.4g N",
                                           a_.friction_lower_N[worst], age_s(), held_N, standing_N),
                   std::string{standing_N > held_N ? "lower the load, or " : ""} +
                       "take a shorter period, smaller gains, or start nearer to the target") &&
           stays_below_force_limit();
  }

  // Of all (q, v) with V <= start_J, P q + D v is greatest along its own ellipsoid.
  bool stays_below_force_limit() {
    const MatrixXd inverse = dense::Cholesky(masses_.lower).inverse();
    Index worst = 0;
    VectorXd margin(n_), asked_N(n_);
    for (Index i = 0; i < n_; ++i) {
      const double p = p_.position_gain_N_per_m[i], d = p_.velocity_gain_Ns_per_m[i];
      asked_N[i] = std::sqrt(2 * result_.sampled.start_J * (p * p * softness_(i, i) + d * d * inverse(i, i))) +
                   result_.sampled.lost_N[i] +
                   result_.sampled.lost_Ns_per_m[i] * speeds_m_s(result_.sampled.start_J)[i];
      // An axis without a drive is asked for nothing.
      if (p == 0 && d == 0) asked_N[i] = 0;
      margin[i] = a_.max_force_N[i] - asked_N[i];
    }
    const double least_N = margin.minCoeff(&worst);
    return require(
        "force of the approach", least_N >= 0, least_N,
        axis_name(worst) + text(": the approach may ask for %.4g N of %.4g N", asked_N[worst], a_.max_force_N[worst]),
        "lower the gains, or start nearer to the target");
  }

  // Theorem 1 of [A] and what goes beyond it, for the friction and the damping that sampling leaves.
  bool falls() {
    SampledMargin& s = result_.sampled;
    const LinearMachine<> left{masses_.lower, closed_C_ - diagonal(s.lost_Ns_per_m), closed_K_,
                               MatrixXd::Identity(n_, n_), a_.friction_lower_N - s.lost_N};
    const Attractivity attractivity = certify_attractivity(left);
    s.level_J = attractivity.level_J;
    const bool below = s.start_J < s.level_J;
    return require("region of attraction", below, std::isinf(s.level_J) ? 1 : 1 - s.start_J / s.level_J,
                   text("V is %.4g J at the start at most, and falls below %.4g J", s.start_J, s.level_J),
                   "raise the velocity gains, or start nearer to the target");
  }

  // Where the approach can rest, how fast the machine still may be when it is let go, and how far it then gets.
  bool lets_go() {
    const VectorXd rest_m = softness_ * (a_.friction_upper_N + static_error_N());
    const VectorXd reach_m = softness_.cwiseAbs() * (a_.friction_upper_N + static_error_N());
    gate_m_ = (softness_.isApprox(softness_.cwiseAbs()) ? rest_m : reach_m) * 1.001 + 2 * p_.resolution_m;
    const double wait_s = (p_.latency_periods + 2.5) * a_.period_s + (a_.lag_s > 0 ? lags_to_nothing * a_.lag_s : 0);
    const VectorXd speed = 2 * p_.resolution_m / a_.period_s + result_.sampled.acceleration_m_s2 * wait_s;
    const MatrixXd masses = a_.mass.cwiseAbs() + a_.mass_error;
    const double left_J = 0.5 * speed.dot(masses * speed);
    VectorXd free_N(n_);
    box_m_ = gate_m_ + p_.resolution_m;
    for (int round = 0; round < 50; ++round) {
      free_N = released_friction_N(speed);
      if (!(free_N.minCoeff() > 0)) break;
      box_m_ = gate_m_ + p_.resolution_m + (left_J * free_N.cwiseInverse()) * widened;
    }
    free_N = released_friction_N(speed);
    Index worst = 0;
    const double least_N = free_N.minCoeff(&worst);
    const double mass = masses.rowwise().sum().maxCoeff();
    result_.release_s = least_N > 0 ? wait_s + std::sqrt(2 * left_J * mass) / least_N : 0;
    return require("release", least_N > 0, least_N,
                   axis_name(worst) + text(": springs, loads and dampers leave %.4g N of %.4g N of friction in its box "
                                           "of %.4g m",
                                           least_N, a_.friction_lower_N[worst], box_m_[worst]),
                   "make the springs between the axes softer, or the approach stiffer") &&
           within_range("range of the masses after the release", box_m_, "release", "make the approach stiffer");
  }

  VectorXd released_friction_N(const VectorXd& speed) const {
    const bool passive = positive_semidefinite(a_.damping) == Proof::holds;
    const double tail = a_.lag_s > 0 ? std::exp(-lags_to_nothing) : 0;
    VectorXd free_N(n_);
    for (Index j = 0; j < n_; ++j) {
      free_N[j] = free_friction_N(a_, box_m_, j) - tail * a_.max_force_N[j] -
                  (passive ? 0 : a_.damping.row(j).cwiseAbs().dot(speed));
    }
    return free_N;
  }

  // Every axis has a drive here. One without is asked for no force, so it has no gains; all that pulls it back are its
  // own springs, which pull harder than its friction holds where it may rest: the release has refused it.
  void kick() {
    bool all = true;
    for (Index i = 0; i < n_; ++i) all = promise(i) && all;
    if (!all) return;
    VectorXd force_N(n_);
    for (Index i = 0; i < n_; ++i) force_N[i] = result_.axes[static_cast<std::size_t>(i)].kick_N;
    for (Index i = 0; i < n_; ++i) {
      for (Index l = 0; l < n_; ++l) {
        if (i != l) result_.simultaneous.push_back(simultaneous_condition(a_, box_m_, force_N, i, l));
      }
    }
  }

  bool promise(Index i) {
    AxisPromise& axis = result_.axes.emplace_back();
    axis.box_m = box_m_[i];
    axis.gate_m = gate_m_[i];
    axis.kicked = kicked_axis(a_, box_m_, i);
    return stops(i, axis) && moves_alone(i, axis) && reaches(i, axis);
  }

  bool stops(Index i, const AxisPromise& axis) {
    const double margin_N = axis.kicked.lower_N - axis.kicked.brake_N;
    return require(
        "stop of " + axis_name(i), margin_N > 0, margin_N,
        text("at least %.4g N of friction against a brake of %.4g N", axis.kicked.lower_N, axis.kicked.brake_N),
        "lower the brake, or the loads and springs on the axis");
  }

  bool moves_alone(Index i, AxisPromise& axis) {
    const double least_N = axis.kicked.sure_N, most_N = a_.max_force_N[i];
    if (!require("force of kicks of " + axis_name(i), most_N >= least_N, most_N - least_N,
                 text("the drive gives %.4g N, and %.4g N are sure to move the axis", most_N, least_N),
                 "take a stronger drive"))
      return false;
    const double admitted_N = largest_kick_N(a_, box_m_, least_N, most_N, i);
    axis.kick_N = admitted_N > 0 ? std::max(least_N, spared * admitted_N) : 0;
    axis.tightest = tightest(a_, box_m_, std::max(axis.kick_N, least_N), i);
    const PairCondition& worst = axis.tightest;
    return require("kicks of " + axis_name(i) + " alone", axis.kick_N > 0, worst.margin_N(),
                   n_ == 1 ? "there is no other axis" : asked_of(worst, std::max(axis.kick_N, least_N)),
                   worst.phase == KickPhase::hold_off
                       ? "take a stronger drive for " + axis_name(worst.held)
                       : "the coupling is too strong for it: state the masses and the friction of " + axis_name(i) +
                             " more narrowly, or have more friction on " + axis_name(worst.held));
  }

  static std::string asked_of(const PairCondition& pair, double force_N) {
    if (pair.phase == KickPhase::hold_off)
      return "the drive of " + axis_name(pair.held) +
             text(" must give %.4g N of %.4g N, at a kick of %.4g N", pair.needed_N, pair.held_N, force_N);
    return "friction on " + axis_name(pair.held) +
           text(" must hold %.4g N of %.4g N in the %s, at a kick of %.4g N", pair.needed_N, pair.held_N,
                to_string(pair.phase), force_N);
  }

  bool reaches(Index i, AxisPromise& axis) {
    const double count_m = p_.resolution_m[i], tolerance_m = tolerance_m_[i];
    axis.floor_m = axis.kicked.most_travel_m(axis.kicked.sure_N, a_.period_s);
    axis.least_tolerance_m = 1.01 * axis.floor_m + count_m / 2;
    if (!require("accuracy of " + axis_name(i), tolerance_m >= axis.least_tolerance_m,
                 tolerance_m - axis.least_tolerance_m,
                 text("%.4g m are asked for, and %.4g m can be promised", tolerance_m, axis.least_tolerance_m),
                 "ask for what can be promised, or take a shorter period"))
      return false;
    axis.most_kicks = most_kicks(axis, count_m, tolerance_m);
    result_.most_kicks += axis.most_kicks;
    return require("kicks of " + axis_name(i) + " at most", axis.most_kicks < endless, endless - 1.0 * axis.most_kicks,
                   text("%u kicks from %.4g m", axis.most_kicks, axis.box_m), "ask for less accuracy");
  }

  // The most that is left of an error of x_m or less, after a kick that aims at no more than it and at no less than a
  // count below. Between edges a kick's sure travel grows with its aim, by less than that: so the worst aim is a count
  // below the error, or at an edge.
  double left_m(const AxisPromise& axis, double x_m, double count_m, double least_aim_m) const {
    const KickedAxis& k = axis.kicked;
    const auto left = [&](double aim_m) {
      return std::min(x_m, aim_m + count_m) - sure_travel_m(k, axis.kick_N, aim_m, a_.period_s);
    };
    double most_m = std::max(left(std::max(x_m - count_m, least_aim_m)), left(least_aim_m));
    for (int n = 1; n <= most_kick_periods; ++n) {
      for (const double force_N : {k.sure_N, axis.kick_N}) {
        const double edge_m = k.most_travel_m(force_N, n * a_.period_s);
        if (edge_m <= least_aim_m || edge_m >= x_m) continue;
        most_m = std::max({most_m, left(edge_m * (1 - 1e-9)), left(edge_m * (1 + 1e-9))});
      }
    }
    return most_m;
  }

  std::uint32_t most_kicks(const AxisPromise& axis, double count_m, double tolerance_m) const {
    const double least_aim_m = tolerance_m - count_m / 2;
    std::uint32_t kicks = 0;
    for (double x_m = axis.box_m; x_m > least_aim_m && kicks < endless; ++kicks) {
      const double left = left_m(axis, x_m, count_m, least_aim_m);
      if (!(left < x_m * (1 - 1e-12))) return endless;
      x_m = left;
    }
    return kicks;
  }

  const CoupledAxes& a_;
  const SampledApproach& p_;
  const VectorXd& tolerance_m_;
  Index n_;
  MassRange masses_;
  MatrixXd closed_K_, closed_C_, softness_;
  VectorXd gate_m_, box_m_;
  MachineCertificate result_;
};

void require_sizes(const CoupledAxes& axes, const SampledApproach& p, const VectorXd& tolerance_m) {
  const Index n = axes.axes();
  for (const auto& [name, vector] : {std::pair<const char*, const VectorXd&>{"position_gain", p.position_gain_N_per_m},
                                     {"velocity_gain", p.velocity_gain_Ns_per_m},
                                     {"start_m", p.start_m},
                                     {"resolution_m", p.resolution_m},
                                     {"tolerance_m", tolerance_m}}) {
    if (vector.size() == n && vector.allFinite() && (vector.array() >= 0).all()) continue;
    throw InputError{std::string{name} + " must have a number of at least 0 for each of the " + std::to_string(n) +
                     " axes"};
  }
}

}  // namespace

KickPulse kick_pulse(const KickedAxis& axis, double kick_N, double aim_m, double period_s) {
  const double one_m = axis.most_travel_m(kick_N, period_s);
  const double exact = std::ceil(std::sqrt(aim_m / one_m) * (1 - 1e-12));
  const double periods = std::clamp(exact, 1.0, double{most_kick_periods});
  const double force_N = std::min(kick_N, axis.force_N(aim_m, periods * period_s));
  if (force_N < axis.sure_N && periods > 1) return {kick_N, static_cast<std::uint8_t>(periods - 1)};
  return {force_N, static_cast<std::uint8_t>(periods)};
}

double sure_travel_m(const KickedAxis& axis, double kick_N, double aim_m, double period_s) {
  const KickPulse pulse = kick_pulse(axis, kick_N, aim_m, period_s);
  return axis.least_travel_m(pulse.force_N * rounded_in_float, pulse.periods * period_s);
}

MachineCertificate certify_machine(const CoupledAxes& axes, const SampledApproach& approach,
                                   const VectorXd& tolerance_m) {
  require_valid(axes);
  require_sizes(axes, approach, tolerance_m);
  return Certifier{axes, approach, tolerance_m}.certify();
}

}  // namespace breakaway::stability
