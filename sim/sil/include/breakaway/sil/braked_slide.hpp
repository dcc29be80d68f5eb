// The plant as a drive's mechanism: held by a brake until it is released, so that setting the drive up over the bus
// does not count as motion. Scenario time starts at the release.
#pragma once

#include <utility>

#include "breakaway/drive_emulator/mechanism.hpp"
#include "breakaway/motion/slide.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::sil {

// The direction of the drive and its encoder, seen from the axis.
enum class Mounting { straight, inverted };

class BrakedSlide final : public drive_emulator::Mechanism {
 public:
  explicit BrakedSlide(motion::Slide slide, Mounting mounting = Mounting::straight)
      : slide_{std::move(slide)}, sign_{mounting == Mounting::inverted ? -1.0 : 1.0} {}

  void release(double time_s) {
    released_ = true;
    release_s_ = time_s;
  }

  bool released() const { return released_; }

  // Mechanism, in the drive's direction

  void advance_to(double time_s, const model::AppliedForce& force) override {
    if (!released_ || time_s < release_s_) return;
    if (force.start_s != segment_start_s_) {
      segment_start_s_ = force.start_s;
      velocity_at_segment_start_m_s_ = slide_.state().velocity_m_s;
    }
    model::AppliedForce on_axis = force;
    on_axis.start_s -= release_s_;
    on_axis.constant_N *= sign_;
    on_axis.transient_N *= sign_;
    slide_.advance_to(time_s - release_s_, on_axis);
  }
  double position_m() const override { return sign_ * slide_.state().position_m; }

  // In the axis' direction

  // A force that the drive says it makes.
  double on_axis_N(double drive_force_N) const { return sign_ * drive_force_N; }
  double velocity_at_segment_start_m_s() const { return velocity_at_segment_start_m_s_; }
  const motion::Slide& slide() const { return slide_; }

 private:
  motion::Slide slide_;
  double sign_;
  double release_s_ = 0;
  double segment_start_s_ = -1;
  double velocity_at_segment_start_m_s_ = 0;
  bool released_ = false;
};

// The axis as its drive moves it. Requires axis.drive.
inline BrakedSlide braked_slide(const config::Axis& axis, const scenario::AxisWorld& world) {
  return BrakedSlide{{axis.mass_kg, world.friction, {0.0, world.position_m, world.velocity_m_s}},
                     axis.drive->invert_direction ? Mounting::inverted : Mounting::straight};
}

}  // namespace breakaway::sil
