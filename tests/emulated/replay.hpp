// Runs a controller alone on a recorded tape, the same code on every machine: equal results, bit for bit, show that a
// target computes what simulation computes.
#pragma once

#include <cstdint>

#include "breakaway/law/axis_controller.hpp"
#include "breakaway/law/pid_controller.hpp"

namespace breakaway::emulated {

// As they lie in the files, little-endian.
struct TapeStep {
  float shift_m;  // of the target, before the sample is taken
  float position_error_m;
  std::uint32_t flags;
};
inline constexpr std::uint32_t fresh_flag = 1;  // not set: the sample was lost
inline constexpr std::uint32_t reset_flag = 2;  // the controller is reset before the sample is taken
static_assert(sizeof(TapeStep) == 12);

// The kinds of step that differ in their work.
enum class StepKind : std::uint8_t {
  approach,
  coast,
  hold,
  kick_of_one_period,
  kick_of_many_periods_starts,
  kick_goes_on,
  lost_sample,
  fault,
};

struct StepResult {
  float force_N;
  float velocity_m_s;  // the estimate: state that later forces depend on
  std::uint32_t kicks;
  std::uint8_t mode;
  std::uint8_t kicked;
  std::uint8_t fault;
  StepKind kind;
};
static_assert(sizeof(StepResult) == 16);

// chosen: the controller counted one more kick. Under the coast "brake" its pulse may start later.
constexpr StepKind kind_of(law::Mode before, law::Mode after, const law::ControlOutput<float>& output, bool fresh,
                           bool chosen) {
  if (output.mode == law::Mode::fault) return StepKind::fault;
  if (!fresh) return StepKind::lost_sample;
  if (chosen) {
    const bool over = output.kicked && after != law::Mode::kick;
    return over ? StepKind::kick_of_one_period : StepKind::kick_of_many_periods_starts;
  }
  if (before == law::Mode::kick || output.kicked) return StepKind::kick_goes_on;
  if (output.mode == law::Mode::approach) return StepKind::approach;
  return output.mode == law::Mode::coast ? StepKind::coast : StepKind::hold;
}

// update(controller, measurement) is to call controller.update(measurement), and may count what that costs.
template <class Controller, class Update>
StepResult replay_step(Controller& controller, const TapeStep& step, const Update& update) {
  if ((step.flags & reset_flag) != 0) controller.reset();
  if (step.shift_m < 0 || step.shift_m > 0) controller.shift_target(step.shift_m);
  const law::Mode before = controller.mode();
  const std::uint32_t kicks_before = controller.kicks();
  const law::Measurement<float> measurement{step.position_error_m, 0.0F, (step.flags & fresh_flag) != 0};
  const law::ControlOutput<float> output = update(controller, measurement);
  const bool chosen = controller.kicks() != kicks_before;
  const StepKind kind = kind_of(before, controller.mode(), output, measurement.fresh, chosen);
  return {output.force_N,
          controller.velocity_m_s(),
          controller.kicks(),
          static_cast<std::uint8_t>(output.mode),
          static_cast<std::uint8_t>(output.kicked),
          static_cast<std::uint8_t>(controller.fault()),
          kind};
}

// The baseline on the same axis: the gains of the switching law's approach, and an integrator beside them. What is
// compared is the work, not the result.
constexpr law::PidParameters<float> pid_parameters(const law::AxisParameters<float>& p) {
  law::PidParameters<float> pid;
  pid.proportional_N_per_m = p.stiffness_N_per_m;
  pid.integral_N_per_ms = 5 * p.stiffness_N_per_m;
  pid.derivative_Ns_per_m = p.approach_damping_Ns_per_m;
  pid.max_force_N = p.max_force_N;
  pid.max_approach_speed_m_s = p.max_approach_speed_m_s;
  pid.encoder_resolution_m = p.encoder_resolution_m;
  pid.friction_lower_N = p.friction.lower_N;
  pid.period_s = p.period_s;
  return pid;
}

}  // namespace breakaway::emulated
