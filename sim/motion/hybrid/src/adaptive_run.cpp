#include "adaptive_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "breakaway/hybrid/refused.hpp"
#include "breakaway/motion/roots.hpp"
#include "breakaway/stability/dense.hpp"

namespace breakaway::hybrid {
namespace {

using Eigen::Index;

// As in motion::Slide, an excess for less than 2^-24 of the laws' scale of time is passed over.
constexpr int scan_depth = 24;
// While everything sticks, so many windows of the laws' scale of time are searched for what a step of motion costs.
constexpr int windows_of_a_step = 64;

// The shortest of the machine's own scales of time.
double first_step_s(const AdaptiveWalk& walk) {
  const stability::dense::Cholesky mass(walk.machine.mass);
  const double rate = mass.solve(walk.machine.damping).norm() + std::sqrt(mass.solve(walk.machine.stiffness).norm());
  double step_s = 1 / rate;
  for (const auto& law : walk.laws) step_s = std::min(step_s, law.time_scale_s());
  return step_s;
}

}  // namespace

void AdaptiveRun::begin(const Adaptive::State& start) {
  walk_.q = start.q;
  walk_.v = start.v;
  walk_.time = {start.time_s};
  const Index m = walk_.machine.frictions();
  walk_.signs.assign(static_cast<std::size_t>(m), 0);
  walk_.shift_m = Eigen::VectorXd::Zero(m);
  DirectionSet stopped = 0;
  for (Index i = 0; i < m; ++i) {
    const auto terms = walk_.machine.directions.col(i).cwiseProduct(walk_.v);
    const double speed = terms.sum();
    const bool stands = std::abs(speed) <= 4 * std::numeric_limits<double>::epsilon() * terms.cwiseAbs().sum();
    if (stands) stopped |= only(i);
    walk_.signs[static_cast<std::size_t>(i)] = stands ? 0 : speed > 0 ? 1 : -1;
  }
  for (auto& law : walk_.laws) law.on_time(start.time_s);
  walk_.choose_mode(stopped);
  walk_.step_s = first_step_s(walk_);
}

Adaptive::Result AdaptiveRun::finish(Verdict verdict) {
  outcome_.verdict = verdict;
  outcome_.end = state();
  outcome_.settling_time_s = walk_.time.sum_s;
  return outcome_;
}

// Says whether there is neither speed nor acceleration, to rounding.
bool AdaptiveRun::stands_still() const {
  if (!walk_.all_stick()) return false;
  if (walk_.held->motions() == 0) return true;
  if ((walk_.v.array() != 0).any()) return false;
  const auto& machine = walk_.machine;
  const Eigen::VectorXd terms = machine.force_N.cwiseAbs() + machine.stiffness.cwiseAbs() * walk_.q.cwiseAbs();
  const auto& basis = walk_.held->basis;
  const double rounding = 8 * std::numeric_limits<double>::epsilon();
  return ((basis.transpose() * walk_.force()).array().abs() <=
          rounding * (basis.cwiseAbs().transpose() * terms).array())
      .all();
}

// Waits, while everything sticks, until a limit falls below what the machine needs.
Ending AdaptiveRun::wait(double duration_s) {
  const Eigen::VectorXd force = walk_.force();
  double steepest_N_per_s = 0, window_s = duration_s;
  for (const auto& law : walk_.laws) {
    if (!law.varies_with_time()) continue;
    window_s = std::min(window_s, law.time_scale_s());
    steepest_N_per_s += (law.bounds().upper_N - law.bounds().lower_N) / law.time_scale_s();
  }
  Limit least{};
  const auto excess_N = [&](double tau_s) {
    double margin_N = unlimited;
    for (std::size_t k = 0; k < walk_.held->facets.size(); ++k) {
      for (const int side : {-1, 1}) {
        const double here_N = walk_.margin_N({k, side}, force, walk_.time.after(tau_s));
        if (here_N < margin_N) least = {k, side};
        margin_N = std::min(margin_N, here_N);
      }
    }
    return -margin_N;
  };
  int windows = 0;
  for (double low_s = 0; steepest_N_per_s > 0 && low_s < duration_s;) {
    if (++windows % windows_of_a_step == 0) spend_a_step(walk_.time.after(duration_s));
    const double high_s = std::min(low_s + window_s, duration_s);
    const double excess_s = motion::first_excess(excess_N, {low_s, excess_N(low_s)}, {high_s, excess_N(high_s)},
                                                 steepest_N_per_s, scan_depth);
    if (excess_s < unlimited) {
      excess_N(excess_s);  // leaves the limit of this instant
      walk_.time.pass(excess_s);
      return {Ending::Kind::limit, 0, least, 0, 0};
    }
    low_s = high_s;
  }
  walk_.time.pass(duration_s);
  return {Ending::Kind::time, 0, {}, 0, 0};
}

void AdaptiveRun::spend_a_step(double end_s) {
  if (outcome_.steps++ < options_.most_steps) return;
  throw Refused{"the adaptive method has taken " + std::to_string(options_.most_steps) +
                    " steps by t = " + shown(walk_.time.sum_s) + " s of " + shown(end_s) + " s",
                "end earlier, or use a larger tolerance", "set [run] integrator to \"time_stepping\""};
}

Ending AdaptiveRun::move(double duration_s) {
  if (walk_.held->motions() == 0) return wait(duration_s);
  // What stands still lets steps grow without end, and laws that change with time would go unseen.
  double longest_s = options_.longest_step_s;
  for (const auto& law : walk_.laws) longest_s = std::min(longest_s, law.time_scale_s());
  return AdaptiveStep{walk_, options_.tolerance}.take(duration_s, longest_s);
}

void AdaptiveRun::handle(const Ending& ending, double end_s) {
  const std::vector<int> before = walk_.signs;
  switch (ending.kind) {
    case Ending::Kind::none:
      return;
    case Ending::Kind::time:
      walk_.time = {end_s};
      change_laws();
      break;
    case Ending::Kind::stop:
      walk_.choose_mode(walk_.held->sticking | ending.stopped);
      break;
    case Ending::Kind::limit:
      walk_.give_way(ending.limit);
      break;
    case Ending::Kind::edge:
      walk_.shift_m[ending.direction] += ending.edge_m - walk_.position_m(ending.direction);
      walk_.choose_mode(walk_.held->sticking);
      break;
  }
  record(before);
}

void AdaptiveRun::change_laws() {
  for (auto& law : walk_.laws) {
    if (law.next_time_change_s() <= walk_.time.sum_s) law.on_time(walk_.time.sum_s);
  }
  walk_.choose_mode(walk_.held->sticking);
}

void AdaptiveRun::record(const std::vector<int>& before) {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i] < 0) continue;
    const auto place = static_cast<std::size_t>(places_[i]);
    const int now = walk_.signs[place];
    if (now == before[place]) continue;
    ++outcome_.events;
    if (log_ == nullptr) continue;
    const EventKind kind = now == 0 ? EventKind::stick : before[place] == 0 ? EventKind::slip : EventKind::reversal;
    log_->push_back({walk_.time.sum_s, kind, static_cast<int>(i)});
  }
}

Adaptive::Result AdaptiveRun::go_on(double end_s, const EarlyDecision<Eigen::Dynamic>& decision,
                                    const Observer<Eigen::Dynamic>& observer) {
  for (int at_once = 0; at_once <= 8 * (walk_.machine.frictions() + 1);) {
    const bool rests = stands_still();
    if (rests) walk_.v.setZero();
    if (observer) observer(state());
    if (rests && walk_.holds(true)) return finish(Verdict::at_rest);
    if (decision) {
      if (const Verdict verdict = decision(state()); verdict != Verdict::undecided) return finish(verdict);
    }
    if (!(walk_.time.until(end_s) > 0)) return finish(Verdict::undecided);
    const motion::SummedTime before = walk_.time;
    spend_a_step(end_s);
    const double next_s = std::min(end_s, walk_.next_change_s());
    const Ending ending = move(walk_.time.until(next_s));
    handle(ending, next_s);
    at_once = walk_.time == before ? at_once + 1 : 0;
  }
  throw Refused{"the friction directions switch without end at t = " + shown(walk_.time.sum_s) + " s",
                "the machine is too ill-scaled for double precision; leave out its least friction or its least mass"};
}

}  // namespace breakaway::hybrid
