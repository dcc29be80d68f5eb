// KickShaper: from the ideal impulse of [I] to a force that a drive can give.
//
// A kick is a constant force on top of the PD feedback for n whole periods, then a coast. Let the axis start at rest at
// the distance y, and let a be the net force at the start (commanded force minus friction at its lower bound f_lo).
// Everything is linear from there: after n periods the axis has moved a g[n] and has the speed a h[n], where g and h
// are the response of the sampled loop, with its latency, to a unit net force. The coast reaches the target exactly if
// the pulse ends on the k3 curve:
//
//     a h[n] = s R(s) / m   with the remaining distance   s^2 = y - a g[n],   R(s) = k3/sqrt|y| from the table.
//
// With c = g[n]/h[n] that is the scalar equation s^2 + c s R(s)/m = y. R hardly changes with s: solving the
// quadratic equation with R held, twice, and extrapolating meets the curve's speed to 1e-5 for pulses of a few periods
// and to 2e-3 for the longest. An axis that already moves towards the
// target with the speed w takes y - w n T + c w for y and needs only s R(s)/m - w.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/control_types.hpp"
#include "breakaway/law/k3_table.hpp"

namespace breakaway::law {

template <class Scalar>
struct Kick {
  Scalar force_N{};  // to add to the feedback, towards the target
  std::uint8_t periods = 0;
};

template <class Scalar>
class KickShaper {
 public:
  static constexpr std::uint8_t max_periods = 32;  // longer kicks are cut to this; the next kick does the rest

  KickShaper() noexcept = default;

  // velocity_weight: the weight of the VelocityEstimator that closes the loop.
  KickShaper(const AxisParameters<Scalar>& p, Scalar velocity_weight) noexcept : p_{p}, per_mass_{1 / p.mass_kg} {
    respond(velocity_weight);
  }

  // distance_m > 0: from the axis to the target; speed_m_s >= 0: towards the target; least_force_N: total force at the
  // start that the kick must have at least. The total force never exceeds max_force_N.
  Kick<Scalar> plan(const K3Table<Scalar>& table, Scalar distance_m, Scalar speed_m_s,
                    Scalar least_force_N) const noexcept {
    return plan(table, distance_m, -table.impulse_Ns(distance_m), speed_m_s, least_force_N);
  }

  // Does the same for a caller who has looked up impulse_Ns = |k3(distance_m)| before.
  Kick<Scalar> plan(const K3Table<Scalar>& table, Scalar distance_m, Scalar impulse_Ns, Scalar speed_m_s,
                    Scalar least_force_N) const noexcept {
    const Scalar feedback_N = std::min(p_.stiffness_N_per_m * distance_m, p_.max_force_N);
    const Scalar room_N = std::max(p_.max_force_N - p_.friction.lower_N, Scalar{0});
    const std::uint8_t n = periods_for(impulse_Ns / (room_N * p_.period_s));
    const Scalar net_N = p_.kick_shape == KickShape::naive
                             ? impulse_Ns / (n * p_.period_s) + feedback_N - p_.friction.lower_N
                             : net_force(table, distance_m, speed_m_s, n);
    const Scalar total_N = std::max(p_.friction.lower_N + net_N, least_force_N);
    return {std::min(total_N, p_.max_force_N) - feedback_N, n};
  }

  void limit_force(Scalar force_N) noexcept { p_.max_force_N = force_N; }

 private:
  // The divisions are done once, at construction.
  struct Response {
    Scalar c_s{};              // g[n] / h[n]
    Scalar force_per_speed{};  // 1 / h[n] in N s/m
  };

  // Unit net force on the free axis under the sampled feedback u_j = -k1 x_(j-L) - k22 v_(j-L), v the estimated
  // velocity.
  [[gnu::cold]] void respond(Scalar velocity_weight) noexcept {
    const Scalar T = p_.period_s;
    std::array<Scalar, max_periods + 1> feedback{};  // computed from the sample of period j
    Scalar x = 0, v = 0, estimate = 0;
    for (std::size_t j = 0; j < max_periods; ++j) {
      const Scalar net = j >= p_.latency_periods ? 1 - feedback[j - p_.latency_periods] : Scalar{1};
      const Scalar previous = x;
      x += v * T + net * T * T / (2 * p_.mass_kg);
      v += net * T / p_.mass_kg;
      estimate += velocity_weight * ((x - previous) / T - estimate);
      feedback[j + 1] = p_.stiffness_N_per_m * x + p_.kick_damping_Ns_per_m * estimate;
      response_[j] = {x / v, 1 / v};
    }
  }

  static std::uint8_t periods_for(Scalar exact) noexcept {
    if (!(exact > 1)) return 1;
    if (exact >= Scalar(max_periods)) return max_periods;
    const auto whole = static_cast<std::uint8_t>(exact);  // std::ceil is a call into the library on many machines
    return exact > static_cast<Scalar>(whole) ? static_cast<std::uint8_t>(whole + 1) : whole;
  }

  Scalar net_force(const K3Table<Scalar>& table, Scalar distance_m, Scalar speed_m_s, std::uint8_t n) const noexcept {
    const Scalar c = response_[n - 1u].c_s;  // not a binding: clang 14 cannot capture those
    const Scalar y = std::max(distance_m - speed_m_s * (n * p_.period_s - c), Scalar{0});
    const auto speed_per_root = [&](Scalar s) { return table.reduced(s) * per_mass_; };
    const auto root_on_curve = [&](Scalar s) {
      const Scalar b = c * speed_per_root(s) * Scalar(0.5);
      const Scalar sum = b + std::sqrt(b * b + y);
      return sum > 0 ? y / sum : Scalar{0};
    };
    const Scalar s0 = std::sqrt(y), s1 = root_on_curve(s0), s2 = root_on_curve(s1);
    const Scalar s = extrapolated(s0, s1, s2);
    return (s * speed_per_root(s) - speed_m_s) * response_[n - 1u].force_per_speed;
  }

  // The limit of a sequence whose steps alternate and shrink by a constant factor (Aitken): s0 > s2 > s1.
  static Scalar extrapolated(Scalar s0, Scalar s1, Scalar s2) noexcept {
    const Scalar bend = (s0 - s1) + (s2 - s1);
    return bend > 0 ? std::clamp(s2 - (s2 - s1) * (s2 - s1) / bend, s1, std::max(s1, s2)) : s2;
  }

  AxisParameters<Scalar> p_{};
  Scalar per_mass_{};
  std::array<Response, max_periods> response_{};
};

}  // namespace breakaway::law
