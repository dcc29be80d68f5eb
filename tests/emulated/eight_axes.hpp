// Eight axes of one machine, made up to count what their coordinator costs; and one step of it on a recorded tape, the
// same code on every machine.
#pragma once

#include <cstddef>
#include <cstdint>

#include "breakaway/law/coordinator_parameters.hpp"
#include "breakaway/law/kick_coordinator.hpp"
#include "replay.hpp"

namespace breakaway::emulated {

inline constexpr std::size_t coordinated_axes = 8;
using EightAxes = law::CoordinatorParameters<float, coordinated_axes>;
using EightAxesCoordinator = law::KickCoordinator<float, coordinated_axes>;

// 1 to 1.7 kg with friction 2.5 to 4.5 N; a tenth of each axis' force is asked of its neighbours.
constexpr EightAxes eight_axes() {
  EightAxes p;
  p.period_s = 1e-3F;
  p.release_periods = 20;
  p.most_kicks = 500;
  for (std::size_t i = 0; i < coordinated_axes; ++i) {
    p.axes[i] = {.position_gain_N_per_m = 400,
                 .velocity_gain_Ns_per_m = 32,
                 .mass_kg = 1 + 0.1F * static_cast<float>(i),
                 .lower_N = 2.5F,
                 .upper_N = 4.5F,
                 .sure_N = 4.51F,
                 .brake_N = i % 2 == 0 ? 0.0F : 0.5F,
                 .kick_N = 12,
                 .max_force_N = 20,
                 .gate_m = 0.02F,
                 .tolerance_m = i == 3 ? 2e-6F : 1e-5F,  // one of them ends below its floor
                 .resolution_m = 1e-6F,
                 .hold_off = {}};
    if (i > 0) p.axes[i].hold_off[i - 1] = p.axes[i - 1].hold_off[i] = 0.1F;
  }
  return p;
}

inline constexpr std::uint32_t left_out_flag = 4;  // of a TapeStep: the axis is not asked in this period

// Of one axis in one period; a tape has them in the order of the axes.
struct CoordinatedResult {
  float force_N;
  std::uint32_t kicks;
  std::uint32_t moved;
  std::uint8_t mode;
  std::uint8_t kicked;
  std::uint8_t fault;
  law::CoordinatorPhase phase;  // in which the axis was asked
};
static_assert(sizeof(CoordinatedResult) == 16);

// update(coordinator, axis, measurement) is to ask the coordinator, and may count what that costs; leave_out() stands
// for it where the axis is not asked.
template <class Update, class LeaveOut>
CoordinatedResult replay_coordinated(EightAxesCoordinator& coordinator, std::size_t axis, const TapeStep& step,
                                     const Update& update, const LeaveOut& leave_out) {
  if ((step.flags & reset_flag) != 0) coordinator.reset(axis);
  if (step.shift_m < 0 || step.shift_m > 0) coordinator.shift_target(axis, step.shift_m);
  const law::CoordinatorPhase phase = coordinator.phase();
  law::ControlOutput<float> output;
  if ((step.flags & left_out_flag) != 0)
    leave_out();
  else
    output =
        update(coordinator, axis, law::Measurement<float>{step.position_error_m, 0.0F, (step.flags & fresh_flag) != 0});
  return {output.force_N,
          coordinator.kicks(),
          static_cast<std::uint32_t>(coordinator.moved()),
          static_cast<std::uint8_t>(output.mode),
          static_cast<std::uint8_t>(output.kicked),
          static_cast<std::uint8_t>(coordinator.fault()),
          phase};
}

}  // namespace breakaway::emulated
