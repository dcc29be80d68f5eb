#include "breakaway/design/pulse_travel.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace breakaway::design {
namespace {

constexpr auto reciprocal = [] {
  std::array<double, 18> of{};
  for (std::size_t k = 1; k < of.size(); ++k) of[k] = 1 / static_cast<double>(k);
  return of;
}();

// A time in units of the lag, and what of a transient is gone by then, which all that follows from them shares: most of
// a table's making goes into exponentials.
struct Gone {
  explicit Gone(double lags) : z{lags}, less_one{std::expm1(-lags)} {}

  // (1 - e^-z) / z and (z - 1 + e^-z) / z^2 for z >= 0.
  double phi1() const { return z == 0 ? 1 : -less_one / z; }
  double phi2() const {
    if (z > 0.5) return (z + less_one) / (z * z);
    // 1/2 (1 - z/3 (1 - z/4 (1 - ...))): the first term that is left out is below 1e-18 of it.
    double sum = 1;
    for (int k = 17; k >= 3; --k) sum = 1 - z * reciprocal[static_cast<std::size_t>(k)] * sum;
    return sum / 2;
  }

  double z, less_one;  // e^-z - 1
};

// A unit mass: every travel is in inverse proportion to the mass.
class Motion {
 public:
  Motion(double force_N, double friction_N, double lag_s) : u_{force_N}, friction_N_{friction_N}, lag_s_{lag_s} {}

  bool stopped() const { return stopped_; }
  double travel() const { return x_; }

  void pass(double command_N, double duration_s) {
    if (stopped_) return;
    if (lag_s_ == 0) u_ = command_N;
    const double left_s = moving_ ? duration_s : wait(command_N, duration_s);
    if (left_s > 0) move(command_N, left_s);
  }

  // To the stop.
  void finish(double command_N) {
    if (stopped_ || !moving_) return;
    if (lag_s_ == 0) u_ = command_N;
    const double owed = u_ > command_N ? (u_ - command_N) * lag_s_ : 0;
    const double longest_s = (v_ + owed) / (friction_N_ - command_N);
    stop(command_N, longest_s);
  }

 private:
  Gone gone(double t) const { return Gone{lag_s_ > 0 ? t / lag_s_ : 0}; }
  double transient(double command_N) const { return lag_s_ > 0 ? u_ - command_N : 0; }
  double speed(double command_N, double t, const Gone& gone) const {
    return v_ + (command_N - friction_N_) * t + transient(command_N) * t * gone.phi1();
  }
  struct SpeedAndForce {
    double speed, net_N;
  };
  // speed() and its slope, with one exponential.
  SpeedAndForce both_after(double command_N, double t) const {
    const double steady_N = command_N - friction_N_;
    if (lag_s_ == 0) return {v_ + steady_N * t, steady_N};
    const double gone = std::expm1(-t / lag_s_), transient_N = u_ - command_N;
    return {v_ + steady_N * t - transient_N * lag_s_ * gone, steady_N + transient_N * (1 + gone)};
  }

  // Returns the time that is left once the axis has broken away; 0: it has not.
  double wait(double command_N, double duration_s) {
    if (u_ > friction_N_) {
      moving_ = true;
      return duration_s;
    }
    const bool rises = lag_s_ > 0 && command_N > friction_N_;
    const double after_s = rises ? lag_s_ * std::log1p((friction_N_ - u_) / (command_N - friction_N_)) : duration_s;
    if (after_s >= duration_s) {
      u_ = command_N + transient(command_N) * (1 + gone(duration_s).less_one);
      return 0;
    }
    u_ = friction_N_;
    moving_ = true;
    return duration_s - after_s;
  }

  void move(double command_N, double duration_s) {
    const Gone all = gone(duration_s);
    if (speed(command_N, duration_s, all) > 0) return advance(command_N, duration_s, all);
    stop(command_N, duration_s);
  }

  void stop(double command_N, double latest_s) {
    const double t = stop_time(command_N, latest_s);
    advance(command_N, t, gone(t));
    stopped_ = true;
  }

  void advance(double command_N, double t, const Gone& gone) {
    const double transient_N = transient(command_N);
    x_ += v_ * t + (command_N - friction_N_) * t * t / 2 + transient_N * t * t * gone.phi2();
    v_ = speed(command_N, t, gone);
    if (lag_s_ > 0) u_ = command_N + transient_N * (1 + gone.less_one);
  }

  // The root of the speed in (0, latest], where the speed is not positive at the latest. Newton's steps square what a
  // time is off by, and where the speed is zero the way changes by the square of that once more.
  double stop_time(double command_N, double latest) const {
    double before = 0, after = latest, t = latest;
    for (int i = 0; i < 60; ++i) {
      const auto [v, net_N] = both_after(command_N, t);
      (v > 0 ? before : after) = t;
      double next = t - v / net_N;
      // Before the ends are asked: where the speed is nothing but rounding they are on either side by chance.
      const bool rounding = std::fabs(v) <= 2e-16 * (v_ + (friction_N_ - command_N) * t);
      if (rounding || std::fabs(next - t) <= 1e-8 * t) return next;
      if (!(next > before && next < after)) next = (before + after) / 2;
      t = next;
    }
    return t;
  }

  double u_, friction_N_, lag_s_;
  double v_ = 0, x_ = 0;
  bool moving_ = false, stopped_ = false;
};

}  // namespace

double travel_m(const KickForces& kick, const KickedAxis& axis) noexcept {
  Motion motion{kick.start_N, axis.friction_N, axis.lag_s};
  motion.pass(kick.pulse_N, kick.pulse_s);
  if (kick.cut_s > 0) motion.pass(-kick.cut_N, kick.cut_s);
  motion.finish(-kick.brake_N);
  return motion.travel() / axis.mass_kg;
}

}  // namespace breakaway::design
