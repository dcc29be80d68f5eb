// An axis that is more than rigid, behind a brake.
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "breakaway/motion/compliant_axis.hpp"
#include "breakaway/sil/braked_mechanism.hpp"

namespace breakaway::sil {

// What the drive's encoder sits on: the motor of an axis without a load, the motor before a load, or the load.
enum class EncoderPlace { axis, motor, load };

class CompliantMechanism final : public BrakedMechanism {
 public:
  CompliantMechanism(motion::CompliantAxis axis, Mounting mounting, EncoderPlace encoder)
      : BrakedMechanism{mounting}, axis_{std::move(axis)}, encoder_{encoder} {}

  // Mechanism, in the drive's direction

  void advance_to(double time_s, const model::AppliedForce& force) override {
    if (!moves_at(time_s)) return;
    note_segment(force, state().velocity_m_s);
    axis_.advance_to(since_release_s(time_s), on_axis(force));
  }
  double position_m() const override { return sign() * state().position_m; }

  // In the axis' direction

  AxisState state() const override {
    const motion::CompliantState state = axis_.state();
    const bool load = encoder_ == EncoderPlace::load;
    return {load ? state.load_position_m : state.position_m, load ? state.load_velocity_m_s : state.velocity_m_s,
            axis_.sticking(), axis_.counters().slips};
  }
  double friction_level_N() const override {
    const bool motor_rests = axis_.sticking() || axis_.state().velocity_m_s == 0;
    return motor_rests ? std::numeric_limits<double>::quiet_NaN() : std::fabs(axis_.friction_force_N());
  }
  std::optional<double> load_position_m() const override {
    if (encoder_ == EncoderPlace::axis) return {};
    return axis_.state().load_position_m;
  }

 private:
  motion::CompliantAxis axis_;
  EncoderPlace encoder_;
};

}  // namespace breakaway::sil
