// PdCycle: how an axis slides, rests and is kicked under the coast "pd" of [I].
//
// Feedback (16) with the damping k21 on the way to the target and k22 from then on, an axis that is certified at rest
// by its counts, or exactly, and kicks (5) and (15) as pulses of whole periods, each followed by a coast. What they are
// for, and when one is due, the controller says. It keeps no parameters: each call gets those of the axis.
//
// Which pulse ends on the target is read from a table of the loop as it runs; k3 itself is for the ideal law, and says
// how fast an axis may still be that is kicked as it creeps. The table is over the root of the distance, so that it
// spans all distances at which an axis may stick, and holds the force in all with which a pulse begins.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/control_types.hpp"
#include "breakaway/law/k3_table.hpp"
#include "breakaway/law/kick_table.hpp"
#include "breakaway/law/rest_detector.hpp"
#include "breakaway/law/velocity_estimator.hpp"

namespace breakaway::law {

template <class Scalar>
class PdCycle {
 public:
  using Parameters = AxisParameters<Scalar>;

  // The parameters must be valid; the tables must be theirs and must outlive this. kicks may be null where no pulse is
  // asked for.
  [[gnu::cold]] PdCycle(const Parameters& p, const K3Table<Scalar>& table, const KickTable<Scalar>* kicks) noexcept
      : table_{&table}, kicks_{kicks} {
    if (p.ideal()) return;
    velocity_ = {p.period_s, p.encoder_resolution_m, p.kick_damping_Ns_per_m, p.friction.lower_N};
    rest_ = {p.mass_kg, p.friction.lower_N, p.encoder_resolution_m, p.period_s};
    const Scalar weight = velocity_.weight(), count_m_s = weight * p.encoder_resolution_m / p.period_s;
    creep_radius_m_ = 20 * p.accuracy_floor_m() + 4 * p.encoder_resolution_m +
                      16 * p.mass_kg * count_m_s * count_m_s / p.friction.lower_N;
    late_s_per_kg_ = (static_cast<Scalar>(p.latency_periods) + 1 / weight) * p.period_s / p.mass_kg;
    blind_ = static_cast<std::int16_t>(std::min(2 / weight, Scalar{90}) + static_cast<Scalar>(p.latency_periods) - 1);
  }

  // Once a period: takes a sample, or that there is none. Returns the velocity.
  Scalar see(const Parameters& p, const Measurement<Scalar>& z) noexcept {
    if (sighted_ < 100) ++sighted_;
    return p.exact() ? z.velocity_m_s : velocity_.update(z.position_error_m);
  }
  void skip() noexcept { velocity_.skip(); }
  Scalar velocity_m_s() const noexcept { return velocity_.velocity_m_s(); }
  // The target moved by shift_m.
  void shift_origin(Scalar shift_m) noexcept { velocity_.shift_origin(shift_m); }

  // u of (16).
  static Scalar feedback_N(const Parameters& p, Scalar x, Scalar v) noexcept {
    return -p.stiffness_N_per_m * x - p.kick_damping_Ns_per_m * v;
  }
  // The same on the way to the target. Far away the spring pulls only as hard as keeps the speed within its limit;
  // within that distance this is (16).
  static Scalar approach_N(const Parameters& p, Scalar x, Scalar v) noexcept {
    const Scalar spring_limit_N = p.approach_damping_Ns_per_m * p.max_approach_speed_m_s;
    return limited(-p.stiffness_N_per_m * x, spring_limit_N) - p.approach_damping_Ns_per_m * v;
  }

  // Once a period outside of a pulse. force_N: the greatest that the newest sample may have been taken under.
  bool at_rest(const Parameters& p, Scalar x, Scalar v, Scalar force_N) noexcept {
    if (p.exact()) return !(v < 0 || v > 0) && std::abs(x) <= p.stick_radius_upper_m();
    return rest_.update(x, force_N);
  }

  // |k3(x)|.
  Scalar impulse_Ns(Scalar x) const noexcept { return std::abs(table_->impulse_Ns(x)); }

  // An axis creeps when it is inside the maximal stick set and closes in far slower than the k3 curve allows, so that
  // it will stop, or creep for ever, well before the target. A kick now is as safe as one from rest, because its speed
  // is counted in. Near the target, where a few counts of speed error matter, and a quarter of the curve's speed,
  // sqrt(2 f_lo r / m) at most, is hardly more than one count makes of the velocity, only certified rest will do; nor
  // is a velocity judged whose filter has not caught up. Once a period. Returns the distance from which a kick from
  // rest is as strong as the one that this axis needs, or zero for one that does not creep.
  //
  // A kick that ends with the speed V, and coasts from there on the curve, is to make up for what the axis is below it:
  // that takes (1 - w/V)^2 of the distance, of which the axis comes on by w while the pulse lasts. One that comes on by
  // a quarter of it meanwhile does not creep. force_N, the last that was given, may have sped it up since it was seen.
  Scalar kicked_from_m(const Parameters& p, Scalar x, Scalar v, Scalar force_N) const noexcept {
    const Scalar distance = std::abs(x);
    if (p.exact() || sighted_ <= blind_ || distance > p.stick_radius_upper_m() || distance < creep_radius_m_) return 0;
    const Scalar seen = x > 0 ? -v : v;
    if (!(seen >= 0)) return 0;
    const Scalar spare_N = (x > 0 ? -force_N : force_N) - p.friction.lower_N;
    const Scalar closing = seen + std::max(spare_N, Scalar{0}) * late_s_per_kg_;
    const Scalar momentum = closing * p.mass_kg, impulse = impulse_Ns(x);
    if (!(momentum < creep_share * impulse)) return 0;
    const Scalar come_on_m = closing * static_cast<Scalar>(pulse_from(distance).periods) * p.period_s;
    if (!(come_on_m < creep_share * distance)) return 0;
    const Scalar slower = (impulse - momentum) / impulse;
    return (distance - come_on_m) * slower * slower;
  }

  // rest_m: from which distance a kick from rest is as strong; futile: kicks in a row that did not move the axis.
  void begin_pulse(const Parameters& p, Scalar x, Scalar rest_m, std::uint32_t futile) noexcept {
    const Pulse<Scalar> pulse = pulse_from(rest_m);
    const Scalar least_N = futile > 0 ? p.friction.upper_N * (1 + escalation * static_cast<Scalar>(futile)) : Scalar{0};
    const Scalar in_all_N = limited(std::max(pulse.force_N, least_N), p.max_force_N);
    pulse_N_ = x > 0 ? p.stiffness_N_per_m * x - in_all_N : p.stiffness_N_per_m * x + in_all_N;
    periods_left_ = std::max(pulse.periods, std::uint8_t{1});
  }
  Scalar pulse_N() const noexcept { return pulse_N_; }  // to add to the feedback
  // Once a period of a pulse, when its force was given. Returns true with the last one; then the coast begins, which is
  // blind for as long as samples show the time before the end of the pulse.
  bool pulse_ends(const Parameters& p) noexcept {
    if (--periods_left_ != 0) return false;
    lose_sight();
    rest_.restart(p.latency_periods);
    return true;
  }

  // What follows in the next samples is another motion.
  void lose_sight() noexcept { sighted_ = 0; }
  void restart(const Parameters& p) noexcept {
    rest_.restart(p.latency_periods);
    lose_sight();
  }
  void reset() noexcept { velocity_.reset(); }

 private:
  Pulse<Scalar> pulse_from(Scalar distance_m) const noexcept {
    return kicks_ != nullptr ? kicks_->pulse(std::sqrt(distance_m)) : Pulse<Scalar>{};
  }

  // Of the k3 curve's speed, and of the distance during a pulse: an axis that stays below both creeps.
  static constexpr Scalar creep_share = Scalar(0.25);

  // A futile kick shows that the force gain or the upper bound is off: the next one starts at f_hi and 2 % more for
  // each before.
  static constexpr Scalar escalation = Scalar(0.02);

  const K3Table<Scalar>* table_;
  const KickTable<Scalar>* kicks_;
  VelocityEstimator<Scalar> velocity_{};
  RestDetector<Scalar> rest_{};
  Scalar pulse_N_{};
  Scalar creep_radius_m_{};
  Scalar late_s_per_kg_{};    // by which what is seen of the velocity is late, per mass
  std::int16_t blind_ = 0;    // samples after a pulse until the velocity has caught up with what it began
  std::int16_t sighted_ = 0;  // samples that show the time after the last pulse, as far as it matters
  std::uint8_t periods_left_ = 0;
};

}  // namespace breakaway::law
