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
// grows from the seventh kick on, and after the fortieth the floor is the tolerance and the table alone decides.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

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
  constexpr FineStage() noexcept = default;
  // kicks must outlive it.
  constexpr FineStage(const BrakedKicks<Scalar>& kicks, const FrictionBounds<Scalar>& friction, Scalar period_s,
                      Scalar resolution_m) noexcept
      : kicks_{&kicks},
        friction_{friction},
        // t^2 / (2 m) of one period
        way_m_per_N_{period_s * period_s / (2 * kicks.approach.mass_kg)},
        seen_m_{resolution_m * Scalar(0.6)} {
    restart();
  }

  // Forgets what it has learnt.
  constexpr void restart() noexcept {
    count_ = 0;
    fine_ = moved_ = false;
    ways_ = {Way{friction_.lower_N, friction_.lower_N}, Way{friction_.lower_N, friction_.lower_N}};
  }

  // Of the reading that the axis is left alone with.
  constexpr Scalar tolerance_m(Scalar asked_m) const noexcept {
    if (count_ <= patient_kicks) return asked_m;
    if (count_ >= most_fine_kicks) return std::max(asked_m, kicks_->fine_floor_m);
    return std::clamp(asked_m * static_cast<Scalar>(count_ - patient_kicks + 1), asked_m,
                      std::max(asked_m, kicks_->fine_floor_m));
  }

  // The pulse for an axis that rests at x; the table's own beyond the floor, or where there is no fine stage.
  Pulse<Scalar> pulse(Scalar x) noexcept {
    const Scalar y = std::abs(x), floor_m = kicks_->fine_floor_m;
    fine_ = y < floor_m && count_ < most_fine_kicks;
    if ((fine_ || count_ > 0) && count_ < most_fine_kicks) ++count_;
    if (!fine_) return kicks_->table.pulse(y);
    forward_ = x < 0;
    Pulse<Scalar> most = kicks_->table.pulse(y + Scalar(fine_floors_beyond) * floor_m);
    const auto n = static_cast<Scalar>(most.periods);
    c_ = n * n * way_m_per_N_;
    const Way& way = ways_[forward_ ? 1 : 0];
    const Way& back = ways_[forward_ ? 0 : 1];
    Scalar force_N = std::max(force_for(y, way.friction_N), way.tried_N);
    if (moved_ && travel_m(way) > y) force_N = force_for(y + Scalar(1.2) * travel_m(back), way.friction_N);
    most.force_N = std::min(force_N, most.force_N);
    return most;
  }

  // How far the last pulse led the axis along its direction; force_N: what it was given.
  constexpr void learn(Scalar travelled_m, Scalar force_N) noexcept {
    if (!fine_) return;
    Way& way = ways_[forward_ ? 1 : 0];
    moved_ = travelled_m >= seen_m_;
    if (!moved_) {
      way.tried_N = std::max(way.tried_N, force_N) + Scalar(0.02) * friction_.upper_N;
      return;
    }
    const Scalar G = force_N + kicks_->brake_N;
    way.friction_N =
        std::clamp(G * G * c_ / (travelled_m + G * c_) - kicks_->brake_N, friction_.lower_N, friction_.upper_N);
    way.tried_N = force_N - Scalar(0.03) * friction_.upper_N;
  }

 private:
  static constexpr std::uint8_t patient_kicks = 6;

  // What is known of one direction.
  struct Way {
    Scalar tried_N;     // the least force to try
    Scalar friction_N;  // as last seen
  };

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
  Scalar seen_m_{};
  Scalar c_{};
  std::array<Way, 2> ways_{};
  std::uint8_t count_ = 0;
  bool fine_ = false;
  bool forward_ = false;
  bool moved_ = false;
};

}  // namespace breakaway::law
