// Judge: whether an axis has settled, by the true position and not by what the drive says of it.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "breakaway/motion/slide.hpp"
#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

class Judge {
 public:
  // `run` and `slide` must outlive it.
  Judge(const scenario::Run& run, double tolerance_m, const motion::Slide& slide)
      : run_{run},
        tolerance_m_{tolerance_m},
        slide_{slide},
        reached_{{1e-3, 0}, {1e-4, 0}, {1e-5, 0}, {tolerance_m, 0}} {}

  void look(double time_s, double target_m) {
    error_m_ = slide_.state().position_m - target_m;
    for (Reached& level : reached_) {
      if (!within(level.tolerance_m)) level.time_s = nan;
      if (within(level.tolerance_m) && std::isnan(level.time_s)) level.time_s = time_s;
    }
    const bool there = within(tolerance_m_) && slide_.sticking();
    if (!there) since_s_ = nan;
    if (there && std::isnan(since_s_)) since_s_ = time_s;
    settled_ = there && time_s - since_s_ >= run_.settle_time_s;
    if (time_s < run_.duration_s - 1) slips_before_last_second_ = slide_.counters().slips;
  }
  // The target moved: times are counted from here.
  void start_again(double time_s) {
    since_s_ = nan;
    target_since_s_ = time_s;
  }

  bool settled() const { return settled_; }
  double settling_time_s() const { return settled_ ? since_s_ - target_since_s_ : nan; }
  bool limit_cycle() const { return !settled_ && slide_.counters().slips - slips_before_last_second_ >= 2; }
  const std::vector<Reached>& reached() const { return reached_; }

 private:
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  bool within(double tolerance_m) const { return std::abs(error_m_) <= tolerance_m; }

  const scenario::Run& run_;
  double tolerance_m_;
  const motion::Slide& slide_;
  std::vector<Reached> reached_;
  double since_s_ = nan;
  double target_since_s_ = 0;
  double error_m_ = nan;
  std::uint64_t slips_before_last_second_ = 0;
  bool settled_ = false;
};

}  // namespace breakaway::sil
