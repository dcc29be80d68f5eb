// An axis under AxisController with the coast "brake", without drive and bus: mass, dry friction and the lag of a
// current loop. Within a slice of a period the friction is constant, so that each slice has a closed form; any friction
// of that kind is inside the class that a design promises for.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <utility>

#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/firmware/motion_under_force.hpp"
#include "breakaway/firmware/motion_without_force.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway::testing {

// Axes like that of the scenes: 1 kg, 2.5 to 4.5 N, 1 kHz, 1 um, behind a current loop with this time constant.
inline design::BrakedClass axes_of_the_scenes(double lag_s) {
  design::BrakedClass c;
  c.lag_s = {lag_s, lag_s};
  c.friction = {2.5, 4.5};
  c.max_force_N = 50;
  c.force_step_N = 0.025;
  c.period_s = 1e-3;
  c.encoder_resolution_m = 1e-6;
  return c;
}

// What is true of the axis.
struct TrueAxis {
  double mass_kg = 1;
  double force_gain = 1;
  double lag_s = 0;
  double load_N = 0;
  int latency_periods = 1;
  double force_step_N = 0;  // in which the drive gives force, to the nearest; 0: none
};

// Which periods are late: at random, or in a pattern, which adds up what drawn periods even out.
enum class Jitter : std::uint8_t { drawn, every_other_period, every_other_force, samples_by_threes };

// What else a loop on a bus brings along.
struct Disturbance {
  double jitter_s = 0;  // new forces begin, and samples are taken, up to this after their whole periods
  Jitter jitter = Jitter::drawn;
  double noise_m = 0;         // of a reading, whole counts either way
  double analog_noise_m = 0;  // of what is counted, either way
  double lost_share = 0;      // of samples
  std::uint64_t seed = 0;
};

// What a friction law may look at.
struct Moment {
  double t_s, position_m, velocity_m_s, force_N;
  bool slips_now;  // it is asked whether the axis breaks away
};
using Friction = std::function<double(const Moment&)>;

class Slider {
 public:
  Slider(const TrueAxis& axis, Friction friction, double position_m, double velocity_m_s)
      : axis_{axis}, friction_{std::move(friction)}, x_{position_m}, v_{velocity_m_s} {}

  double position_m() const { return x_; }
  double velocity_m_s() const { return v_; }
  bool moves(double /*resolution_m*/) const { return v_ != 0; }
  // As the drive tells it.
  double given_N() const { return u_ / axis_.force_gain; }

  // The drive is given a command for a period.
  void run(double command_N, double period_s, int slices) {
    const double step_N = axis_.force_step_N;
    const double U = axis_.force_gain * (step_N > 0 ? std::round(command_N / step_N) * step_N : command_N);
    for (int i = 0; i < slices; ++i) slice(U, period_s / slices);
  }

 private:
  // Force on the axis beside friction at the time s of the slice.
  double push(double U, double s) const {
    return axis_.load_N + (axis_.lag_s > 0 ? U + (u_ - U) * std::exp(-s / axis_.lag_s) : U);
  }
  double speed(double U, double f, double s) const {
    const double owed = axis_.lag_s > 0 ? (u_ - U) * -axis_.lag_s * std::expm1(-s / axis_.lag_s) : 0;
    return v_ + ((U + axis_.load_N - f) * s + owed) / axis_.mass_kg;
  }
  void go(double U, double f, double s) {
    const double tau = axis_.lag_s;
    // Ten digits are enough here: x moves by the mean of the speed, by Simpson's rule in parts.
    const int parts = tau > 0 ? 2 + static_cast<int>(std::min(8.0, 4 * s / tau)) : 1;
    double moved = 0;
    for (int i = 0; i < parts; ++i) {
      const double a = s * i / parts, b = s * (i + 1) / parts;
      moved += (speed(U, f, a) + 4 * speed(U, f, (a + b) / 2) + speed(U, f, b)) * (b - a) / 6;
    }
    const double v = speed(U, f, s), u = push(U, s) - axis_.load_N;
    x_ += moved;
    v_ = v;
    u_ = u;
    t_ += s;
  }
  // The force of an axis that sticks tends to U + load, and passes the level on the way or never.
  double time_to_break_away(double U, double level) const {
    const double end_N = U + axis_.load_N, now_N = push(U, 0);
    if (axis_.lag_s == 0 || std::fabs(end_N) <= level) return INFINITY;
    const double threshold_N = end_N > 0 ? level : -level;
    return axis_.lag_s * std::log((end_N - now_N) / (end_N - threshold_N));
  }
  void slice(double U, double h) {
    double left = h;
    for (int guard = 0; left > 0 && guard < 8; ++guard) {
      if (axis_.lag_s == 0) u_ = U;
      const bool still = v_ == 0;
      const double level = friction_({t_, x_, v_, push(U, 0), still});
      if (still && std::fabs(push(U, 0)) <= level) {
        const double waited_s = std::min(left, time_to_break_away(U, level));
        u_ = push(U, waited_s) - axis_.load_N;
        t_ += waited_s;
        left -= waited_s;
        if (!(left > 0)) return;
        const double over_N = 1e-12 * level;
        u_ += U > u_ ? over_N : -over_N;
        continue;
      }
      const double direction = still ? (push(U, 0) > 0 ? 1 : -1) : (v_ > 0 ? 1 : -1);
      const double f = direction * level;
      if (direction * speed(U, f, left) > 0) return go(U, f, left);
      double before = 0, after = left;
      for (int i = 0; i < 60; ++i) {
        const double middle = (before + after) / 2;
        (direction * speed(U, f, middle) > 0 ? before : after) = middle;
      }
      go(U, f, after);
      v_ = 0;
      left -= after;
    }
  }

  TrueAxis axis_;
  Friction friction_;
  double x_, v_, u_ = 0, t_ = 0;
};

// The disturbances of one run, an extreme as often as not.
class Disturber {
 public:
  Disturber(const Disturbance& d, double count_m)
      : d_{d}, noise_counts_{std::floor(d.noise_m / count_m * (1 + 1e-9))}, bits_{d.seed} {}

  // Of the whole jitter: when the next sample is taken, and when the force begins that answers one.
  struct Delay {
    double sample_s, force_s;
  };
  Delay next_delay() {
    if (!(d_.jitter_s > 0)) return {0, 0};
    if (d_.jitter != Jitter::drawn) return next_of_pattern();
    const double force_s = d_.jitter_s * extreme_share();
    return {force_s * extreme_share(), force_s};
  }
  double noise_counts() { return noise_counts_ > 0 ? std::round((2 * extreme_share() - 1) * noise_counts_) : 0; }
  double analog_noise_m() { return d_.analog_noise_m > 0 ? (2 * extreme_share() - 1) * d_.analog_noise_m : 0; }
  bool loses_sample() { return d_.lost_share > 0 && share() < d_.lost_share; }

 private:
  Delay next_of_pattern() {
    const double late_s = periods_ % 2 == 1 ? d_.jitter_s : 0, by_threes_s = periods_ / 3 % 2 == 1 ? d_.jitter_s : 0;
    ++periods_;
    switch (d_.jitter) {
      case Jitter::every_other_period:
        return {late_s, late_s};
      case Jitter::every_other_force:
        return {0, late_s};
      default:
        return {by_threes_s, d_.jitter_s};
    }
  }
  double share() { return std::ldexp(static_cast<double>(bits_() >> 11), -53); }
  double extreme_share() {
    const double choice = share();
    return choice < 0.25 ? 0 : choice < 0.5 ? 1 : share();
  }

  Disturbance d_;
  double noise_counts_;
  long periods_ = 0;
  std::mt19937_64 bits_;
};

struct RunEnd {
  bool held = false;
  law::ControlFault fault = law::ControlFault::none;
  double time_s = 0;             // to the last hold, or to the end
  double error_m = 0;            // true, at the end,
  double held_error_m = 0;       // the greatest |true error| since the last hold began
  double target_m = 0;           // from this target
  double beyond_m = 0;           // the furthest that a kick went past the target
  double approach_beyond_m = 0;  // the same of the approach
  int kicks = 0;
  int far_kicks = 0;        // from beyond the reach of the table
  double first_kick_m = 0;  // true distance at the first kick
  double first_kick_s = 0;  // when it was decided on
  long lost_samples = 0;    // since then
  bool moving_in_hold = false;
  bool external_motion = false;  // the node would have stopped the axis by this name,
  bool no_motion = false;        // or by "no motion under force"
  bool ends_by_name() const { return fault != law::ControlFault::none || external_motion || no_motion; }
  // The greatest |speed| in the approach, and the greatest |change of speed| in a period of it, by the period. Under
  // the limits of a move whatever the mode, as long as the axis is further away than brake and kicks are for.
  double approach_m_s = 0;
  double approach_m_s2 = 0;
  bool kicked_early = false;  // a move that further approaches may have led nearer
};

// The target moves on by this much, once.
struct Retarget {
  double at_s = INFINITY;
  double shift_m = 0;
};

// What a move with limits does before its kicks. One whose axis is stopped further away than brake and kicks are for is
// approached again before it is kicked from there, as often as the law tries, less once where a brake was under way.
template <class Kicks>
class WatchedMove {
 public:
  explicit WatchedMove(const Kicks& kicks) {
    if constexpr (requires { kicks.hand_over_m(); })
      if (kicks.approach.move.are_asked_for()) far_m_ = 1.05 * static_cast<double>(kicks.hand_over_m());
  }
  void moves_target() { approaches_ = kicked_far_ = 0; }
  void see(law::Mode mode, bool kicked, double error_m) {
    if (mode == law::Mode::approach && before_ != law::Mode::approach) ++approaches_;
    before_ = mode;
    if (!kicked || !(std::fabs(error_m) > far_m_)) return;
    ++kicked_far_;
    if (approaches_ < least_approaches) kicked_early_ = true;
  }
  // Of any mode, for as long as no kick has begun that keeps none.
  bool keeps_limits(double error_m) const { return kicked_far_ == 0 && std::fabs(error_m) > far_m_; }
  bool kicked_early() const { return kicked_early_; }

 private:
  static constexpr int least_approaches = law::KickJudge<float>::most_far_ends - 1;

  double far_m_ = INFINITY;
  int approaches_ = 0, kicked_far_ = 0;
  bool kicked_early_ = false;
  law::Mode before_ = law::Mode::coast;
};

// Runs until the axis was held for `hold_periods`, has a fault, or the time is up. The target is 0. Axis: Slider, or
// what moves as it does.
template <class Real, class Kicks, class Axis>
RunEnd run_axis(const law::AxisParameters<Real>& p, const law::K3Table<Real>& k3, const Kicks& kicks, Axis axis,
                int latency_periods, double longest_s, int slices = 8, int hold_periods = 200,
                double encoder_offset = 0.3, Retarget retarget = {}, const Disturbance& disturbance = {}) {
  law::AxisController<Real, Kicks> controller{p, k3, kicks};
  const double start_m = axis.position_m();
  const double q = static_cast<double>(p.encoder_resolution_m), T = static_cast<double>(p.period_s);
  Disturber disturber{disturbance, q};
  WatchedMove<Kicks> move{kicks};
  std::deque<std::optional<double>> samples;
  firmware::MotionWithoutForce<Real> external{controller.held(), p.encoder_resolution_m};
  firmware::MotionUnderForce<Real> motion{p.mass_kg, controller.breakaway_N(), p.encoder_resolution_m,
                                          controller.lost_motion_m()};
  std::deque<double> given_N;  // with the samples
  double newest = 0;
  Real unseen_s = 0;
  bool holds = false;
  RunEnd end;
  int held = 0;
  double kicked_from = 0, force_began_s = 0;
  Real force_N = 0;
  const auto periods = static_cast<long>(longest_s / T);
  double target_m = 0;
  for (long k = 0; k < periods; ++k) {
    const auto delay = disturber.next_delay();
    const double now_s = static_cast<double>(k) * T;
    const auto pass = [&](double until_s) {
      if (until_s > force_began_s) axis.run(static_cast<double>(force_N), until_s - force_began_s, slices);
      force_began_s = std::max(force_began_s, until_s);
    };
    pass(now_s + delay.sample_s);
    const double counted_m = axis.position_m() + disturber.analog_noise_m();
    const double counts = std::round(counted_m / q + encoder_offset) - encoder_offset;
    samples.emplace_back(counts + disturber.noise_counts());
    given_N.push_back(axis.given_N() - static_cast<double>(p.feedforward_N));
    if (disturber.loses_sample()) samples.back().reset();
    pass(now_s + delay.force_s);
    while (samples.size() > static_cast<std::size_t>(latency_periods) + 1) {
      samples.pop_front();
      given_N.pop_front();
    }
    if (now_s >= retarget.at_s) {
      target_m = std::round(std::exchange(retarget.shift_m, 0) / q) * q;
      controller.shift_target(static_cast<Real>(target_m));
      move.moves_target();
      retarget.at_s = INFINITY;
    }
    const std::optional<double>& seen = samples.front();
    if (!seen && end.kicks > 0) ++end.lost_samples;
    unseen_s += p.period_s;
    if (seen) {
      const auto travel_m = static_cast<Real>((*seen - std::exchange(newest, *seen)) * q);
      external.sample(travel_m, holds);
      motion.sample(travel_m, static_cast<Real>(given_N.front()), std::exchange(unseen_s, Real{0}));
    }
    if (external.seen()) end.external_motion = true;
    if (motion.missing()) end.no_motion = true;
    const std::uint32_t kicks_before = controller.kicks();
    const auto out = controller.update({static_cast<Real>(seen.value_or(0) * q - target_m), 0, seen.has_value()});
    force_N = out.force_N;
    holds = out.mode == law::Mode::hold;
    external.force(force_N - p.feedforward_N);
    if (controller.kicks() > kicks_before && controller.kicks() == 1) end.first_kick_s = now_s;
    if (out.kicked) {
      if (++end.kicks == 1) end.first_kick_m = std::fabs(axis.position_m());
      kicked_from = axis.position_m();
      if (std::fabs(kicked_from) > static_cast<double>(kicks.table.reach_m()) - q) ++end.far_kicks;
    }
    if (out.mode == law::Mode::hold && axis.moves(q)) end.moving_in_hold = true;
    const double before_m_s = axis.velocity_m_s();
    move.see(out.mode, out.kicked, axis.position_m() - target_m);
    pass(now_s + T);
    if (out.mode == law::Mode::approach || move.keeps_limits(axis.position_m() - target_m)) {
      end.approach_m_s = std::max(end.approach_m_s, std::fabs(axis.velocity_m_s()));
      end.approach_m_s2 = std::max(end.approach_m_s2, std::fabs(axis.velocity_m_s() - before_m_s) / T);
    }
    if (end.kicks > 0)
      end.beyond_m = std::max(end.beyond_m, kicked_from > 0 ? -axis.position_m() : axis.position_m());
    else
      end.approach_beyond_m = std::max(end.approach_beyond_m, start_m > 0 ? -axis.position_m() : axis.position_m());
    end.fault = controller.fault();
    if (end.fault != law::ControlFault::none || end.external_motion || end.no_motion) break;
    if (holds) end.held_error_m = std::max(end.held_error_m, std::fabs(axis.position_m() - target_m));
    if (!holds) {
      held = 0;
      end.held_error_m = 0;
      end.time_s = static_cast<double>(k + 1) * T;
    } else if (++held >= hold_periods) {
      break;
    }
  }
  end.kicked_early = move.kicked_early();
  end.held = held >= hold_periods && !end.external_motion && !end.no_motion;
  end.error_m = axis.position_m() - target_m;
  end.target_m = target_m;
  return end;
}

template <class Real>
RunEnd run_kicked_axis(const law::AxisParameters<Real>& p, const law::K3Table<Real>& k3,
                       const law::BrakedKicks<Real>& kicks, const TrueAxis& truth, const Friction& friction,
                       double start_m, double start_m_s, double longest_s, int slices = 8, int hold_periods = 200,
                       double encoder_offset = 0.3, Retarget retarget = {}, const Disturbance& disturbance = {}) {
  return run_axis(p, k3, kicks, Slider{truth, friction, start_m, start_m_s}, truth.latency_periods, longest_s, slices,
                  hold_periods, encoder_offset, retarget, disturbance);
}

}  // namespace breakaway::testing
