// From the certificate of a machine to the numbers that its coordinator is flashed with.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "breakaway/law/coordinator_parameters.hpp"
#include "breakaway/stability/machine_certificate.hpp"

namespace breakaway::design {

// These are whole periods, rounded up.
inline std::uint32_t periods_of(double seconds, double period_s) {
  return static_cast<std::uint32_t>(std::min(std::ceil(seconds / period_s), 65535.0));
}

// What certify_machine() was asked, and a certificate that it gave. There must be room for all axes.
template <class Real, std::size_t Axes>
law::CoordinatorParameters<Real, Axes> coordinator_parameters(const stability::CoupledAxes& axes,
                                                              const stability::SampledApproach& approach,
                                                              const Eigen::VectorXd& tolerance_m,
                                                              const stability::MachineCertificate& certificate) {
  law::CoordinatorParameters<Real, Axes> p;
  const auto real = [](double value) { return static_cast<Real>(value); };
  p.period_s = real(axes.period_s);
  p.count = static_cast<std::uint8_t>(std::min<Eigen::Index>(axes.axes(), Axes));
  p.settling_periods =
      static_cast<std::uint8_t>(std::min(static_cast<std::uint32_t>(approach.latency_periods) + 1 +
                                             periods_of(stability::lags_to_nothing * axes.lag_s, axes.period_s),
                                         std::uint32_t{255}));
  p.still_periods = stability::still_periods;
  p.release_periods = static_cast<std::uint16_t>(periods_of(certificate.release_s, axes.period_s));
  p.most_kicks = certificate.most_kicks;
  for (std::size_t place = 0; place < p.count; ++place) {
    const auto i = static_cast<Eigen::Index>(place);
    const stability::AxisPromise& promise = certificate.axes[place];
    p.axes[place] = {.position_gain_N_per_m = real(approach.position_gain_N_per_m[i]),
                     .velocity_gain_Ns_per_m = real(approach.velocity_gain_Ns_per_m[i]),
                     .mass_kg = real(promise.kicked.mass_lower_kg),
                     .lower_N = real(promise.kicked.lower_N),
                     .upper_N = real(promise.kicked.upper_N),
                     .sure_N = real(promise.kicked.sure_N),
                     .brake_N = real(promise.kicked.brake_N),
                     .kick_N = real(promise.kick_N),
                     .max_force_N = real(axes.max_force_N[i]),
                     .gate_m = real(promise.gate_m),
                     .tolerance_m = real(tolerance_m[i]),
                     .resolution_m = real(approach.resolution_m[i]),
                     .hold_off = {}};
    for (std::size_t other = 0; other < p.count; ++other) {
      const auto j = static_cast<Eigen::Index>(other);
      if (j != i && axes.actuated(j)) p.axes[place].hold_off[other] = real(stability::coupling(axes, i, j).hold_off);
    }
  }
  return p;
}

}  // namespace breakaway::design
