// CoordinatedAxis: one axis of a KickCoordinator behind the calls of a law, so that a control loop need not know of the
// others.
#pragma once

#include <cstddef>

#include "breakaway/law/control_types.hpp"
#include "breakaway/law/kick_coordinator.hpp"

namespace breakaway::law {

// One axis of a coordinator, as the law that a control loop asks. The coordinator must outlive it.
template <class Scalar, std::size_t Axes>
class CoordinatedAxis {
 public:
  using Coordinator = KickCoordinator<Scalar, Axes>;

  CoordinatedAxis(Coordinator& coordinator, std::size_t axis) noexcept
      : coordinator_{&coordinator}, axis_{axis < Axes ? axis : 0} {}

  ControlOutput<Scalar> update(const Measurement<Scalar>& z) noexcept { return coordinator_->update(axis_, z); }
  void shift_target(Scalar shift_m) noexcept { coordinator_->shift_target(axis_, shift_m); }
  void reset() noexcept { coordinator_->reset(axis_); }
  void limit_force(Scalar force_N) noexcept { coordinator_->limit_force(axis_, force_N); }

  Scalar period_s() const noexcept { return coordinator_->parameters().period_s; }
  Scalar encoder_resolution_m() const noexcept { return mine().resolution_m; }
  Scalar max_force_N() const noexcept { return mine().max_force_N; }
  ControlFault fault() const noexcept { return coordinator_->shown_fault(); }
  Mode mode() const noexcept {
    if (fault() != ControlFault::none) return Mode::fault;
    const CoordinatorPhase phase = coordinator_->phase();
    if (phase == CoordinatorPhase::hold) return Mode::hold;
    const bool comes = phase == CoordinatorPhase::gather || phase == CoordinatorPhase::approach;
    return comes ? Mode::approach : Mode::coast;
  }
  const Coordinator& coordinator() const noexcept { return *coordinator_; }

 private:
  const CoordinatedAxisParameters<Scalar, Axes>& mine() const noexcept {
    return coordinator_->parameters().axes[axis_];
  }

  Coordinator* coordinator_;
  std::size_t axis_;
};

}  // namespace breakaway::law
