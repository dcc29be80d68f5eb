// FineStage: kicks for errors below the floor, where a pulse that is sure to move the axis may move it too far.
//
// It tries a force that has moved the axis before, or a little more than the one that has not, and takes for friction
// f what the last kick that way has shown: in a pulse of the length t with the force F, G = F + b, an axis of the mass
// m travels D, and then
//
//   f = G^2 t^2 / (2 m D + G t^2) - b,   and for a distance y   G = (g + sqrt(g^2 + 8 m g y / t^2)) / 2,  g = f + b.
//
// Where the least travel that way is more than the distance, the axis is led beyond the target on purpose, by a fifth
// more than the least travel back. No pulse is stronger than the table's for 1.35 floors more than the distance, so
// that a kick goes no further than that beyond the target. It may go wrong as often as friction changes: the tolerance
// grows from the seventh kick on that moves the axis, and after forty of all kicks the floor is the tolerance and the
// table alone decides.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/braked_kicks.hpp"
#include "breakaway/law/friction_bounds.hpp"

namespace breakaway::law {

// So many floors a kick of the fine stage may go beyond the target.
inline constexpr double fine_floors_beyond = 1.35;
// After so many kicks it ends.
inline constexpr std::uint8_t most_fine_kicks = 40;

template <class Scalar>
class FineStage {
 public:
  // Without kicks under the brake: the tolerance stays what it is.
  constexpr explicit FineStage(Scalar asked_m) noexcept : asked_m_{asked_m}, tolerance_m_{asked_m} {}
  // kicks must be those of these parameters and must outlive it.
  constexpr FineStage(const BrakedKicks<Scalar>& kicks, const AxisParameters<Scalar>& p) noexcept
      : kicks_{&kicks},
        friction_{p.friction},
        // t^2 / (2 m) of one period
        way_m_per_N_{p.period_s * p.period_s / (2 * kicks.approach.mass_kg)},
        seen_m_{p.unseen_m() * Scalar(0.6)},
        asked_m_{p.position_tolerance_m},
        is_there_{kicks.fine_floor_m > 0} {
    restart();
  }

  // Forgets what it has learnt.
  constexpr void restart() noexcept {
    count_ = moves_ = 0;
    kicked_ = moved_ = false;
    tolerance_m_ = asked_m_;
    ways_ = {Way{friction_.lower_N, friction_.lower_N}, Way{friction_.lower_N, friction_.lower_N}};
  }

  // The last pulse was not the table's, and nothing was learnt from it yet. So much further away than it was may it
  // lead the axis.
  constexpr bool kicked() const noexcept { return kicked_; }
  constexpr Scalar beyond_m() const noexcept { return Scalar(fine_floors_beyond) * kicks_->fine_floor_m; }

  // To choose a kick by what the last has shown takes more work than a period has that proves rest.
  constexpr bool chooses_a_period_later() const noexcept { return is_there_; }
  // Of the reading that the axis is left alone with.
  constexpr Scalar tolerance_m() const noexcept { return tolerance_m_; }

  // The pulse for an axis that rests at x; the table's own beyond the floor, or where there is no fine stage.
  Pulse<Scalar> pulse(Scalar x) noexcept { return is_there_ ? fine_pulse(x) : kicks_->table.pulse(std::abs(x)); }

  // Where the last pulse led the axis; force_N: what it was given.
  constexpr void learn(Scalar x, Scalar force_N) noexcept {
    if (kicked_) learn_from(x, force_N);
  }

 private:
  static constexpr std::uint8_t patient_moves = 6;

  // What is known of one direction.
  struct Way {
    Scalar tried_N;     // the least force to try
    Scalar friction_N;  // as last seen
  };

  // A kick of the fine stage, or one of the table's on its way back to the floor.
  constexpr void count_kick(Scalar y) noexcept {
    kicked_ = y < kicks_->fine_floor_m && count_ < most_fine_kicks;
    if (!kicked_ && (count_ == 0 || count_ == most_fine_kicks)) return;
    if (++count_ == most_fine_kicks) tolerance_m_ = most_m();
  }

  // Apart from the way that an axis without it takes.
  [[gnu::noinline]] Pulse<Scalar> fine_pulse(Scalar x) noexcept {
    const Scalar y = std::abs(x);
    count_kick(y);
    Pulse<Scalar> most = kicks_->table.pulse(kicked_ ? y + beyond_m() : y);
    if (!kicked_) return most;
    const auto n = static_cast<Scalar>(most.periods);
    from_m_ = x;
    forward_ = x < 0;
    c_ = n * n * way_m_per_N_;
    const Way& way = ways_[forward_ ? 1 : 0];
    const Way& back = ways_[forward_ ? 0 : 1];
    Scalar force_N = std::max(force_for(y, way.friction_N), way.tried_N);
    if (moved_ && travel_m(way) > y) force_N = force_for(y + Scalar(1.2) * travel_m(back), way.friction_N);
    most.force_N = std::min(force_N, most.force_N);
    return most;
  }

  [[gnu::noinline]] constexpr void learn_from(Scalar x, Scalar force_N) noexcept {
    kicked_ = false;
    const Scalar travelled_m = forward_ ? x - from_m_ : from_m_ - x;
    Way& way = ways_[forward_ ? 1 : 0];
    moved_ = travelled_m >= seen_m_;
    if (!moved_) {
      way.tried_N = std::max(way.tried_N, force_N) + Scalar(0.02) * friction_.upper_N;
      return;
    }
    count_move();
    const Scalar G = force_N + kicks_->brake_N;
    way.friction_N =
        std::clamp(G * G * c_ / (travelled_m + G * c_) - kicks_->brake_N, friction_.lower_N, friction_.upper_N);
    way.tried_N = force_N - Scalar(0.03) * friction_.upper_N;
  }

  constexpr Scalar most_m() const noexcept { return kicks_->promised_m(asked_m_); }
  // A kick that does not move the axis goes nowhere wrong.
  constexpr void count_move() noexcept {
    if (++moves_ <= patient_moves || count_ == most_fine_kicks) return;
    tolerance_m_ = std::min(asked_m_ * static_cast<Scalar>(moves_ - patient_moves + 1), most_m());
  }

  Scalar force_for(Scalar y, Scalar friction_N) const noexcept {
    const Scalar g = friction_N + kicks_->brake_N;
    return (g + std::sqrt(g * g + 4 * g * y / c_)) / 2 - kicks_->brake_N;
  }
  constexpr Scalar travel_m(const Way& way) const noexcept {
    const Scalar net_N = std::max(way.tried_N - way.friction_N, Scalar{0});
    return c_ * net_N * (way.tried_N + kicks_->brake_N) / (way.friction_N + kicks_->brake_N);
  }

  const BrakedKicks<Scalar>* kicks_ = nullptr;
  FrictionBounds<Scalar> friction_{};
  Scalar way_m_per_N_{};
  Scalar seen_m_{};  // less is no motion
  Scalar asked_m_{};
  Scalar tolerance_m_{};
  Scalar from_m_{};
  Scalar c_{};  // t^2 / (2 m) of the last pulse
  std::array<Way, 2> ways_{};
  std::uint8_t count_ = 0;
  std::uint8_t moves_ = 0;  // kicks that moved the axis
  bool is_there_ = false;
  bool kicked_ = false;
  bool forward_ = false;
  bool moved_ = false;
};

}  // namespace breakaway::law
