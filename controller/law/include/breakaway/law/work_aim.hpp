// WorkAim: which pulse an axis at rest is given under the coast "work", and when no pulse would be right.
#pragma once

#include <cmath>
#include <cstdint>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/control_types.hpp"
#include "breakaway/law/work_kicks.hpp"

namespace breakaway::law {

template <class Scalar>
class WorkAim {
 public:
  // Since the target moved or a long hold: after so many the axis hunts.
  static constexpr std::uint8_t most_kicks = 64;

  constexpr explicit WorkAim(Scalar asked_m) noexcept : tolerance_m_{asked_m} {}
  constexpr WorkAim(const WorkKicks<Scalar>& kicks, const AxisParameters<Scalar>& p) noexcept
      : kicks_{&kicks}, tolerance_m_{p.position_tolerance_m - kicks.creep_m}, least_m_{kicks.table.least_m()} {}

  constexpr void restart() noexcept { count_ = 0; }
  constexpr Scalar tolerance_m() const noexcept { return tolerance_m_; }
  constexpr void learn(Scalar /*x*/, Scalar /*force_N*/) noexcept {}
  constexpr bool chooses_a_period_later() const noexcept { return false; }

  // Why an axis that rests at x, outside its tolerance, is not kicked.
  ControlFault refusal(Scalar x) const noexcept {
    const Scalar y = std::abs(x);
    if (!(y > kicks_->spring_m)) return ControlFault::spring_limit;
    if (!(y >= least_m_)) return ControlFault::below_floor;
    return count_ >= most_kicks ? ControlFault::hunting : ControlFault::none;
  }

  Pulse<Scalar> pulse(Scalar x) noexcept {
    ++count_;
    return kicks_->table.pulse(std::abs(x));
  }

 private:
  const WorkKicks<Scalar>* kicks_ = nullptr;
  Scalar tolerance_m_{};
  Scalar least_m_{};
  std::uint8_t count_ = 0;
};

}  // namespace breakaway::law
