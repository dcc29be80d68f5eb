// PidController: the baseline that everyone has, with the same inputs, outputs and limits as AxisController.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "breakaway/law/control_types.hpp"
#include "breakaway/law/velocity_estimator.hpp"

namespace breakaway::law {

template <class Scalar>
struct PidParameters {
  Scalar proportional_N_per_m{};
  Scalar integral_N_per_ms{};
  Scalar derivative_Ns_per_m{};
  Scalar max_force_N = std::numeric_limits<Scalar>::infinity();
  Scalar max_approach_speed_m_s = std::numeric_limits<Scalar>::infinity();
  Scalar encoder_resolution_m{};
  Scalar friction_lower_N{};  // scales the velocity filter as in AxisController
  Scalar period_s{};
};

// u = -kp x - ki integral(x) - kd v with a speed limit on the approach and conditional integration against wind-up: the
// integral is held while the output is limited or the approach is limited in speed.
template <class Scalar>
class PidController {
 public:
  using Parameters = PidParameters<Scalar>;

  explicit PidController(const Parameters& parameters) noexcept
      : p_{parameters}, velocity_{p_.period_s, p_.encoder_resolution_m, p_.derivative_Ns_per_m, p_.friction_lower_N} {}

  ControlOutput<Scalar> update(const Measurement<Scalar>& z) noexcept {
    const Scalar x = z.position_error_m;
    if (!z.fresh) return without_sample();
    if (!(std::abs(x) <= std::numeric_limits<Scalar>::max())) fault_ = ControlFault::not_a_number;
    if (fault_ != ControlFault::none) return {Scalar{0}, Scalar{0}, Mode::fault, false};
    const Scalar v = velocity_.update(x);
    const Scalar wanted_N = -p_.proportional_N_per_m * x;
    const Scalar spring_N = limited(wanted_N, p_.derivative_Ns_per_m * p_.max_approach_speed_m_s);
    const Scalar unlimited_N = spring_N - integral_N_ - p_.derivative_Ns_per_m * v;
    const Scalar force_N = limited(unlimited_N, p_.max_force_N);
    if (!(spring_N < wanted_N || spring_N > wanted_N || force_N < unlimited_N || force_N > unlimited_N)) {
      integral_N_ = limited(integral_N_ + p_.integral_N_per_ms * x * p_.period_s, p_.max_force_N);
    }
    last_force_N_ = force_N;
    return {force_N, Scalar{0}, Mode::approach, false};
  }

  void shift_target(Scalar shift_m) noexcept { velocity_.shift_origin(shift_m); }

  void limit_force(Scalar force_N) noexcept { p_.max_force_N = std::min(p_.max_force_N, force_N); }

  void reset() noexcept {
    velocity_.reset();
    integral_N_ = last_force_N_ = 0;
    fault_ = ControlFault::none;
  }

  ControlFault fault() const noexcept { return fault_; }
  Mode mode() const noexcept { return fault_ == ControlFault::none ? Mode::approach : Mode::fault; }
  Scalar velocity_m_s() const noexcept { return velocity_.velocity_m_s(); }
  std::uint32_t kicks() const noexcept { return 0; }
  Scalar period_s() const noexcept { return p_.period_s; }
  Scalar encoder_resolution_m() const noexcept { return p_.encoder_resolution_m; }
  Scalar max_force_N() const noexcept { return p_.max_force_N; }

 private:
  ControlOutput<Scalar> without_sample() noexcept {
    velocity_.skip();
    return {fault_ == ControlFault::none ? last_force_N_ : Scalar{0}, Scalar{0}, mode(), false};
  }

  Parameters p_{};
  VelocityEstimator<Scalar> velocity_{};
  Scalar integral_N_{};
  Scalar last_force_N_{};
  ControlFault fault_ = ControlFault::none;
};

}  // namespace breakaway::law
