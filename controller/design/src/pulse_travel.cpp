#include "breakaway/design/pulse_travel.hpp"

#include <cmath>

namespace breakaway::design {
namespace {

// (1 - e^-z) / z and (z - 1 + e^-z) / z^2 for z >= 0.
double phi1(double z) { return z == 0 ? 1 : -std::expm1(-z) / z; }
double phi2(double z) {
  if (z > 0.5) return (z + std::expm1(-z)) / (z * z);
  double term = 0.5, sum = 0;
  for (int k = 3; k < 20; ++k) {
    sum += term;
    term *= -z / k;
  }
  return sum + term;
}

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
    advance(command_N, stop_time(command_N, longest_s));
    stopped_ = true;
  }

 private:
  double z(double t) const { return lag_s_ > 0 ? t / lag_s_ : 0; }
  double transient(double command_N) const { return lag_s_ > 0 ? u_ - command_N : 0; }
  double speed(double command_N, double t) const {
    return v_ + (command_N - friction_N_) * t + transient(command_N) * t * phi1(z(t));
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
      u_ = command_N + transient(command_N) * std::exp(-z(duration_s));
      return 0;
    }
    u_ = friction_N_;
    moving_ = true;
    return duration_s - after_s;
  }

  void move(double command_N, double duration_s) {
    if (speed(command_N, duration_s) > 0) return advance(command_N, duration_s);
    advance(command_N, stop_time(command_N, duration_s));
    stopped_ = true;
  }

  void advance(double command_N, double t) {
    const double transient_N = transient(command_N);
    x_ += v_ * t + (command_N - friction_N_) * t * t / 2 + transient_N * t * t * phi2(z(t));
    v_ = speed(command_N, t);
    if (lag_s_ > 0) u_ = command_N + transient_N * std::exp(-z(t));
  }

  // The root of the speed in (0, latest], where the speed is not positive at the latest.
  double stop_time(double command_N, double latest) const {
    double before = 0, after = latest, t = latest;
    for (int i = 0; i < 60; ++i) {
      const auto [v, net_N] = both_after(command_N, t);
      (v > 0 ? before : after) = t;
      double next = t - v / net_N;
      if (!(next > before && next < after)) next = (before + after) / 2;
      if (std::fabs(next - t) <= 4e-16 * t) return next;
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
