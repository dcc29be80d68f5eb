// MotionWatch: speed, acceleration and rest of an axis from its last readings, before anything is known of it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace breakaway::identify {

template <class Scalar>
class MotionWatch {
 public:
  static constexpr std::size_t span = 8;  // periods between the readings that speed is taken from

  constexpr MotionWatch(Scalar period_s, Scalar resolution_m) noexcept
      : period_s_{period_s}, resolution_m_{resolution_m} {}

  // The first reading; the axis rests there.
  void begin(Scalar position_m) noexcept {
    readings_.fill(position_m);
    anchor_m_ = position_m;
    still_periods_ = 0;
    jumps_ = false;
  }
  void sample(Scalar position_m) noexcept {
    const Scalar step_m = position_m - this->position_m(), before_m = last_step_m(),
                 jump_m = Scalar(1.5) * resolution_m_;
    if ((step_m > jump_m && before_m < -jump_m) || (step_m < -jump_m && before_m > jump_m)) jumps_ = true;
    newest_ = (newest_ + 1) % readings_.size();
    readings_[newest_] = position_m;
    // A reading may jump by one count at rest.
    const bool left = std::abs(position_m - anchor_m_) > Scalar(1.5) * resolution_m_;
    if (left) anchor_m_ = position_m;
    still_periods_ = left ? 0 : still_periods_ + 1;
  }
  // No reading came in this period.
  void skip() noexcept { sample(position_m() + speed_m_s() * period_s_); }
  void shift_origin(Scalar shift_m) noexcept {
    for (Scalar& reading : readings_) reading -= shift_m;
    anchor_m_ -= shift_m;
  }

  Scalar position_m() const noexcept { return reading(0); }
  Scalar last_step_m() const noexcept { return reading(0) - reading(1); }
  // In the middle of two readings, which are apart by a count at worst of what is true.
  Scalar speed_m_s() const noexcept { return (reading(0) - reading(span)) / span_s(); }
  Scalar acceleration_m_s2() const noexcept {
    return (reading(0) - 2 * reading(span) + reading(2 * span)) / (span_s() * span_s());
  }
  // At the newest reading.
  Scalar speed_now_m_s() const noexcept { return speed_m_s() + acceleration_m_s2() * span_s() / 2; }
  // Of the last readings, upwards or downwards.
  Scalar furthest_m(Scalar direction) const noexcept {
    Scalar furthest_m = position_m();
    for (const Scalar reading_m : readings_)
      if (direction * (reading_m - furthest_m) > 0) furthest_m = reading_m;
    return furthest_m;
  }
  // In two periods, since begin() or expect_no_jump(), readings went one way by more than a count and back by as much.
  bool jumps() const noexcept { return jumps_; }
  void expect_no_jump() noexcept { jumps_ = false; }
  // For so long the axis has not left the count that it is on, or the next.
  std::uint32_t still_periods() const noexcept { return still_periods_; }

 private:
  Scalar span_s() const noexcept { return static_cast<Scalar>(span) * period_s_; }
  Scalar reading(std::size_t ago) const noexcept {
    return readings_[(newest_ + readings_.size() - ago) % readings_.size()];
  }

  Scalar period_s_, resolution_m_;
  std::array<Scalar, 2 * span + 1> readings_{};
  std::size_t newest_ = 0;
  Scalar anchor_m_{};
  std::uint32_t still_periods_ = 0;
  bool jumps_ = false;
};

}  // namespace breakaway::identify
