// The plant as a drive's mechanism: held by a brake until it is released, so that setting the drive up over the bus
// does not count as motion. Scene time starts at the release.
#pragma once

#include <utility>

#include "breakaway/drive_emulator/mechanism.hpp"
#include "breakaway/motion/slide.hpp"

namespace breakaway::sil {

class BrakedSlide final : public drive_emulator::Mechanism {
 public:
  explicit BrakedSlide(motion::Slide slide) : slide_{std::move(slide)} {}

  void release(double time_s) {
    released_ = true;
    release_s_ = time_s;
  }

  bool released() const { return released_; }

  void advance_to(double time_s, const model::AppliedForce& force) override {
    if (!released_ || time_s < release_s_) return;
    if (force.start_s != segment_start_s_) {
      segment_start_s_ = force.start_s;
      velocity_at_segment_start_m_s_ = slide_.state().velocity_m_s;
    }
    model::AppliedForce in_scene_time = force;
    in_scene_time.start_s -= release_s_;
    slide_.advance_to(time_s - release_s_, in_scene_time);
  }

  double position_m() const override { return slide_.state().position_m; }
  double velocity_at_segment_start_m_s() const { return velocity_at_segment_start_m_s_; }
  const motion::Slide& slide() const { return slide_; }

 private:
  motion::Slide slide_;
  double release_s_ = 0;
  double segment_start_s_ = -1;
  double velocity_at_segment_start_m_s_ = 0;
  bool released_ = false;
};

}  // namespace breakaway::sil
