// MotionWithoutForce: tells when an axis that was held goes where no force of its drive can have taken it, because
// somebody drags it, something runs into it, a weight came onto it, or its encoder loses its place.
//
// A rigid axis that rests goes up only under a force above what friction is sure to hold, and down only under one below
// the same, with its sign turned. So from the proof of rest that lets the law hold it, and until such a force was
// commanded or reported, it may not be above, or below, where it rested by more than what a reading may be off and what
// friction bends before it slides. An axis with a spring of its own may be thrown either way by a force either way:
// then any such force ends the watch.
//
// An axis that is moved by little is the law's, which kicks it back. So `allowed_m` holds besides what the bounds allow
// how far away kicks still are for.
//
// Travels are summed as whole counts, which a float holds exactly: the rounded metres of an axis that vibrates to and
// fro for months would lead away from where it is.
#pragma once

#include <limits>

#include "breakaway/law/held_axis.hpp"

namespace breakaway::firmware {

template <class Scalar>
class MotionWithoutForce {
 public:
  // resolution_m: a count, above 0.
  constexpr MotionWithoutForce(const law::HeldAxis<Scalar>& axis, Scalar resolution_m) noexcept
      : axis_{axis}, counts_per_m_{1 / resolution_m}, allowed_counts_{axis.allowed_m / resolution_m} {}

  // Nothing is known of where the axis rests.
  void restart() noexcept { held_ = up_ = down_ = false; }

  // Takes a force that the drive is told, or reports, less the share that a constant force on the axis takes up.
  void force(Scalar force_N) noexcept {
    const bool pushes_up = !(force_N <= axis_.force_N), pushes_down = !(force_N >= -axis_.force_N);
    const bool both = !axis_.is_rigid && (pushes_up || pushes_down);
    up_ = up_ && !pushes_up && !both;
    down_ = down_ && !pushes_down && !both;
  }

  // Takes the travel of a fresh sample. `holds`: the law has proved that the axis rests, and holds it.
  void sample(Scalar travel_m, bool holds) noexcept {
    if (holds && !held_) {
      up_ = down_ = true;
      moved_counts_ = 0;
    }
    held_ = holds;
    moved_counts_ += whole(travel_m * counts_per_m_);
  }

  bool seen() const noexcept {
    return (up_ && moved_counts_ > allowed_counts_) || (down_ && moved_counts_ < -allowed_counts_);
  }

 private:
  // The nearest whole number, because the digits of one so `large` end there. What is larger stays what it is, or
  // nearly.
  static constexpr Scalar whole(Scalar counts) noexcept {
    constexpr Scalar large = Scalar(1.5) / std::numeric_limits<Scalar>::epsilon();
    return (counts + large) - large;
  }

  law::HeldAxis<Scalar> axis_;
  Scalar counts_per_m_, allowed_counts_;
  Scalar moved_counts_{};  // since the law began to hold
  bool held_ = false;
  bool up_ = false, down_ = false;  // no force was there that could take it this way
};

}  // namespace breakaway::firmware
