#include "adaptive_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/hybrid/refused.hpp"
#include "breakaway/motion/gragg_bulirsch_stoer.hpp"

namespace breakaway::hybrid {
namespace {

constexpr double force_rounding = 1e-14;  // of a sum of forces
// After so many refused trials a motion that neither stops nor clearly goes on has stopped, to rounding.
constexpr int most_refusals = 60;
// After so many refused trials a limit that was near from the start is taken for kept.
constexpr int most_looks = 20;

}  // namespace

void AdaptiveStep::Range::include(double value) {
  least = std::min(least, value);
  greatest = std::max(greatest, value);
}

AdaptiveStep::AdaptiveStep(AdaptiveWalk& walk, double tolerance)
    : walk_{walk},
      held_{*walk.held},
      tolerance_{tolerance},
      rates_(walk.laws.size()),
      q0_{walk.q},
      u0_{held_.to_reduced * walk.v} {
  const auto& machine = walk.machine;
  const Index m = machine.frictions(), k = u0_.size();
  Vector friction_N(m);
  for (Index i = 0; i < m; ++i) {
    const auto& law = walk.laws[static_cast<std::size_t>(i)];
    friction_N[i] = law.bounds().upper_N;
    constant_levels_ = constant_levels_ && law.constant_between_events();
    const double edge_m = sign(i) > 0 ? law.range_m().upper_m : law.range_m().lower_m;
    if (sign(i) != 0 && std::isfinite(edge_m)) guards_.push_back({true, i, edge_m, {}, {}, {}});
  }
  for (std::size_t facet = 0; facet < held_.facets.size(); ++facet) {
    for (const int side : {-1, 1}) guards_.push_back({false, -1, 0, {facet, side}, {}, {}});
  }
  const Vector forces = machine.force_N.cwiseAbs() + machine.stiffness.cwiseAbs() * q0_.cwiseAbs() +
                        machine.damping.cwiseAbs() * walk.v.cwiseAbs() + machine.directions.cwiseAbs() * friction_N;
  const Vector accelerations = force_rounding * (held_.basis.cwiseAbs().transpose() * forces);
  rounding_u_ = accelerations.maxCoeff();
  rounding_m_s2_ = held_.sliding.cwiseAbs() * accelerations;
  forget_ranges();
  a0_ = acceleration(0, Vector::Zero(k), u0_, -1, 0);
  speed_m_s_ = rate_m_s2_ = Vector::Zero(m);
  for (Index i = 0; i < m; ++i) {
    speed_m_s_[i] = speed(i, u0_);
    rate_m_s2_[i] = speed(i, a0_);
  }
}

double AdaptiveStep::speed(Index i, const Vector& u) const { return sign(i) * held_.sliding.row(i).dot(u); }

template <class Path, class Speeds>
void AdaptiveStep::move_to(const Path& path, const Speeds& speeds) {
  walk_.q = q0_ + held_.basis * path;
  walk_.v = held_.basis * speeds;
}

void AdaptiveStep::forget_ranges() {
  for (Range& range : rates_) range = {unlimited, -unlimited};
  for (Guard& guard : guards_) guard.range = guard.slope = {unlimited, -unlimited};
}

// u' at a stage; `exchanged` >= 0 slides at exactly this speed. Keeps the ranges of what the step is judged by.
template <class Path, class Speeds>
AdaptiveStep::Vector AdaptiveStep::acceleration(double tau_s, const Path& path, const Speeds& speeds, Index exchanged,
                                                double speed_m_s) {
  move_to(path, speeds);
  const Vector force = walk_.force(tau_s, exchanged, speed_m_s);
  Vector a = held_.basis.transpose() * force;
  for (Index i = 0; i < walk_.machine.frictions(); ++i) {
    if (sign(i) != 0) rates_[static_cast<std::size_t>(i)].include(speed(i, a));
  }
  for (Guard& guard : guards_) {
    if (guard.is_edge) continue;
    guard.range.include(value(guard, tau_s, force));
    guard.slope.include(slope(guard, a));
  }
  return a;
}

AdaptiveStep::Trial AdaptiveStep::step_in_time(double step_s) {
  const Index k = u0_.size();
  const double speed_floor = tolerance_ * (u0_.stableNorm() + step_s * a0_.stableNorm()) + rounding_u_ * step_s;
  Vector z(2 * k), floor(2 * k);
  z << Vector::Zero(k), u0_;
  floor << Vector::Constant(k, speed_floor * step_s), Vector::Constant(k, speed_floor);
  forget_ranges();
  const auto slope = [&](double tau_s, const Vector& at, Vector& derivative) {
    derivative << at.tail(k), acceleration(tau_s, at.head(k), at.tail(k), -1, 0);
  };
  const auto step = motion::extrapolated_step(slope, 0, z, step_s, tolerance_, floor);
  return {step.converged, step_s, step.state.head(k), step.state.tail(k), step.suggested_step};
}

// Steps to zero speed of this direction; the speed takes the place of the time.
AdaptiveStep::Trial AdaptiveStep::step_to_stop(Index direction) {
  const Index k = u0_.size();
  const double from_m_s = speed_m_s_[direction], rate = rate_m_s2_[direction], step_s = from_m_s / -rate;
  const double speed_floor = tolerance_ * (u0_.stableNorm() + step_s * a0_.stableNorm()) + rounding_u_ * step_s;
  Vector z(2 * k + 1), floor(2 * k + 1);
  z << Vector::Zero(k), u0_, 0;
  floor << Vector::Constant(k, speed_floor * step_s), Vector::Constant(k, speed_floor),
      rounding_m_s2_[direction] / -rate * step_s;
  forget_ranges();
  const auto slope = [&](double speed_m_s, const Vector& at, Vector& derivative) {
    const Vector a = acceleration(at[2 * k], at.head(k), at.segment(k, k), direction, speed_m_s);
    const double per_speed = 1 / speed(direction, a);
    derivative << per_speed * at.segment(k, k), per_speed * a, per_speed;
  };
  const auto step = motion::extrapolated_step(slope, from_m_s, z, -from_m_s, tolerance_, floor);
  return {step.converged, step.state[2 * k], step.state.head(k), step.state.segment(k, k),
          std::abs(step.suggested_step / rate)};
}

// No other sliding speed went through zero within the step: by the range of its rate none can have, or it only fell
// and is still there at the end.
bool AdaptiveStep::keeps_signs(const Trial& trial, Index stopping) {
  for (Index i = 0; i < speed_m_s_.size(); ++i) {
    if (sign(i) == 0 || i == stopping) continue;
    const Range& rate = rates_[static_cast<std::size_t>(i)];
    const double noise = rounding_m_s2_[i] * trial.duration_s + 4 * tolerance_ * std::abs(speed_m_s_[i]);
    if (!(speed(i, trial.speeds) >= -noise)) return false;
    const bool cannot = speed_m_s_[i] + trial.duration_s * rate.least >= -noise;
    if (!cannot && rate.greatest > 0) return false;
  }
  return true;
}

DirectionSet AdaptiveStep::stopped_at_start() const {
  DirectionSet stopped = 0;
  for (Index i = 0; i < speed_m_s_.size(); ++i) {
    if (sign(i) != 0 && speed_m_s_[i] <= 0 && rate_m_s2_[i] < -rounding_m_s2_[i]) stopped |= only(i);
  }
  return stopped;
}

// Returns -1 when none slows down.
AdaptiveStep::Index AdaptiveStep::next_to_stop() const {
  Index next = -1;
  double least_s = unlimited;
  for (Index i = 0; i < speed_m_s_.size(); ++i) {
    if (sign(i) == 0 || !(speed_m_s_[i] > 0) || !(rate_m_s2_[i] < 0)) continue;
    const double wait_s = speed_m_s_[i] / -rate_m_s2_[i];
    if (wait_s >= least_s) continue;
    least_s = wait_s;
    next = i;
  }
  return next;
}

// Says whether this direction, or what slows it down, is lost in rounding.
bool AdaptiveStep::stops_in_rounding(Index direction) const {
  const double size_m_s = held_.sliding.row(direction).stableNorm() * u0_.stableNorm();
  return speed_m_s_[direction] <= 1e-9 * size_m_s || std::abs(rate_m_s2_[direction]) <= 1e3 * rounding_m_s2_[direction];
}

// Returns all directions that have stopped together with this one. Nearly parallel directions are slow together
// although a third one, which depends on them, is not: then they do not stop together.
DirectionSet AdaptiveStep::stops_with(const Trial& trial, Index direction) const {
  DirectionSet stopped = only(direction), slow = only(direction);
  for (Index i = 0; i < speed_m_s_.size(); ++i) {
    if (sign(i) == 0) continue;
    const double noise = rounding_m_s2_[i] * trial.duration_s + 4 * tolerance_ * speed_m_s_[i];
    if (!(speed(i, trial.speeds) <= noise)) continue;
    slow |= only(i);
    if (rates_[static_cast<std::size_t>(i)].greatest <= 0) stopped |= only(i);
  }
  const DirectionSet held = walk_.held_set(held_.sticking | stopped).sticking & ~held_.sticking;
  return (held & ~slow) == 0 ? stopped : only(direction);
}

Ending AdaptiveStep::take(double duration_s, double longest_s) {
  if (const DirectionSet stopped = stopped_at_start(); stopped != 0) {
    move_to(Vector::Zero(u0_.size()), u0_);
    return {Ending::Kind::stop, stopped, {}, 0, 0};
  }
  const auto accept = [&](const Trial& trial, Ending ending) {
    move_to(trial.path, trial.speeds);
    walk_.time.pass(trial.duration_s);
    return ending;
  };
  const Index stopping = next_to_stop();
  const double wait_s = stopping < 0 ? unlimited : speed_m_s_[stopping] / -rate_m_s2_[stopping];
  double step_s = walk_.step_s;
  for (bool outlasts = false; refusals_ < most_refusals; ++refusals_) {
    const double step = std::min({step_s, longest_s, duration_s});
    if (!outlasts && wait_s <= std::min(2 * step, longest_s)) {
      const Trial trial = step_to_stop(stopping);
      const bool falls = rates_[static_cast<std::size_t>(stopping)].greatest < 0;
      const bool taken = trial.converged && falls && keeps_signs(trial, stopping) && !looks_again(trial);
      if (taken && trial.duration_s > duration_s) {
        outlasts = true;
        continue;
      }
      if (taken && !passes(trial)) {
        return accept(trial, {Ending::Kind::stop, stops_with(trial, stopping), {}, 0, 0});
      }
      step_s = trial.converged ? 0.25 * wait_s : std::min(0.25 * wait_s, trial.suggested_s);
      continue;
    }
    Trial trial = step_in_time(step);
    if (!trial.converged || !keeps_signs(trial, -1)) {
      step_s = trial.converged ? 0.5 * step : std::min(trial.suggested_s, 0.7 * step);
      continue;
    }
    if (passes(trial)) {
      trial = locate(trial);
      move_to(trial.path, trial.speeds);
      return accept(trial, cause(trial));
    }
    if (refusals_ < most_looks && looks_again(trial)) {
      step_s = 0.5 * step;
      continue;
    }
    walk_.step_s = step < step_s ? std::max(step_s, trial.suggested_s) : trial.suggested_s;
    return accept(trial, {step == duration_s ? Ending::Kind::time : Ending::Kind::none, 0, {}, 0, 0});
  }
  if (stopping < 0 || !stops_in_rounding(stopping)) {
    throw Refused{"the steps of the adaptive method became too short at t = " + shown(walk_.time.sum_s) + " s",
                  "use a larger tolerance", "set [run] integrator to \"event_driven\""};
  }
  move_to(Vector::Zero(u0_.size()), u0_);
  return {Ending::Kind::stop, only(stopping), {}, 0, 0};
}

}  // namespace breakaway::hybrid
