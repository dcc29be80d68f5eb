// A rigid axis on dry friction whose brake, encoder and force may fail, and that may be dragged.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "breakaway/drive_emulator/mechanism.hpp"
#include "breakaway/motion/slide.hpp"

namespace breakaway::campaign {

class TamperedAxis final : public drive_emulator::Mechanism {
 public:
  explicit TamperedAxis(motion::Slide slide) : slide_{std::move(slide)} {}

  // Of the force that acts to the one that the drive makes.
  double force_gain = 1;
  // Of somebody who drags the axis.
  double foreign_N = 0;
  // What the encoder shows of a position.
  std::function<double(double)> encoder = [](double position_m) { return position_m; };

  // The brake closes and opens at the time of the last advance.
  void lock() {
    if (locked_) return;
    locked_ = true;
    slide_.apply_impulse(-slide_.mass_kg() * slide_.state().velocity_m_s);
  }
  void unlock() { locked_ = false; }

  void advance_to(double time_s, const model::AppliedForce& force) override {
    if (locked_) {
      held_s_ = time_s - slide_.state().time_s;
      return;
    }
    model::AppliedForce acting = force;
    acting.constant_N *= force_gain;
    acting.constant_N += foreign_N;
    acting.transient_N *= force_gain;
    acting.start_s -= held_s_;
    slide_.advance_to(std::max(time_s - held_s_, slide_.state().time_s), acting);
  }
  double position_m() const override { return encoder(slide_.state().position_m); }

  double true_position_m() const { return slide_.state().position_m; }
  bool at_rest() const { return locked_ || slide_.sticking(); }

 private:
  motion::Slide slide_;
  bool locked_ = false;
  double held_s_ = 0;  // all the time in which the brake was closed
};

}  // namespace breakaway::campaign
