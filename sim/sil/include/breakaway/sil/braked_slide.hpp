// A rigid axis on dry friction, under the drive's force and a constant one, behind a brake.
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "breakaway/motion/slide.hpp"
#include "breakaway/sil/braked_mechanism.hpp"

namespace breakaway::sil {

class BrakedSlide final : public BrakedMechanism {
 public:
  // constant_force_N acts beside the drive's force, in the axis' direction.
  explicit BrakedSlide(motion::Slide slide, Mounting mounting = Mounting::straight, double constant_force_N = 0)
      : BrakedMechanism{mounting}, slide_{std::move(slide)}, constant_force_N_{constant_force_N} {}

  // Mechanism, in the drive's direction

  void advance_to(double time_s, const model::AppliedForce& force) override {
    if (!moves_at(time_s)) return;
    note_segment(force, slide_.state().velocity_m_s);
    model::AppliedForce applied = on_axis(force);
    if (constant_force_N_ != 0) applied.constant_N += constant_force_N_;
    slide_.advance_to(since_release_s(time_s), applied);
  }
  double position_m() const override { return sign() * slide_.state().position_m; }

  // In the axis' direction

  AxisState state() const override {
    const motion::SlideState& state = slide_.state();
    return {state.position_m, state.velocity_m_s, slide_.sticking(), slide_.counters().slips};
  }
  double friction_level_N() const override {
    return slide_.sticking() ? std::numeric_limits<double>::quiet_NaN() : std::fabs(slide_.friction_force_N());
  }
  const motion::Slide& slide() const { return slide_; }

 private:
  motion::Slide slide_;
  double constant_force_N_;
};

}  // namespace breakaway::sil
