// Judge: whether an axis has settled, by the true position and not by what the drive says of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/braked_mechanism.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

class Judge {
 public:
  // `run` and `axis` must outlive it.
  Judge(const scenario::Run& run, double tolerance_m, const BrakedMechanism& axis)
      : run_{run},
        tolerance_m_{tolerance_m},
        axis_{axis},
        reached_{{1e-3, 0}, {1e-4, 0}, {1e-5, 0}, {tolerance_m, 0}} {}

  // law_is_done: it kicks no more from where the axis is. An axis that rests within a wide tolerance between two kicks
  // has not settled.
  void look(double time_s, double target_m, bool law_is_done) {
    const AxisState axis = axis_.state();
    slips_ = axis.slips;
    error_m_ = axis.position_m - target_m;
    for (Reached& level : reached_) {
      if (!within(level.tolerance_m)) level.time_s = nan;
      if (within(level.tolerance_m) && std::isnan(level.time_s)) level.time_s = time_s;
    }
    const bool there = within(tolerance_m_) && axis.sticking;
    if (!there) since_s_ = nan;
    if (there && std::isnan(since_s_)) since_s_ = time_s;
    settled_ = there && law_is_done && time_s - since_s_ >= run_.settle_time_s;
    note_rest(time_s, axis.sticking);
  }
  // The target moved: times are counted from here.
  void start_again(double time_s) {
    since_s_ = nan;
    nearest_before_m_ = nearest_in_last_second_m_ = far;
    target_since_s_ = time_s;
  }

  bool settled() const { return settled_; }
  double settling_time_s() const { return settled_ ? since_s_ - target_since_s_ : nan; }
  // Set in motion again and again in the last second. A law that kicks means to, and gets nearer to the target each
  // time.
  bool limit_cycle(bool kicks) const {
    const bool gets_nearer = nearest_in_last_second_m_ < nearest_before_m_;
    return !settled_ && slips_ - slips_before_last_second_ >= 2 && !(kicks && gets_nearer);
  }
  std::vector<Reached> reached() const {
    std::vector<Reached> since_target = reached_;
    for (Reached& level : since_target) level.time_s = looked() ? since_target_s(level.time_s) : nan;
    return since_target;
  }

 private:
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  static constexpr double far = std::numeric_limits<double>::infinity();

  void note_rest(double time_s, bool rests) {
    const bool last_second = time_s >= run_.duration_s - 1;
    if (!last_second) slips_before_last_second_ = slips_;
    double& nearest_m = last_second ? nearest_in_last_second_m_ : nearest_before_m_;
    if (rests) nearest_m = std::min(nearest_m, std::abs(error_m_));
  }
  bool looked() const { return !std::isnan(error_m_); }
  double since_target_s(double time_s) const { return time_s < target_since_s_ ? 0 : time_s - target_since_s_; }
  bool within(double tolerance_m) const { return std::abs(error_m_) <= tolerance_m; }

  const scenario::Run& run_;
  double tolerance_m_;
  const BrakedMechanism& axis_;
  std::vector<Reached> reached_;
  double since_s_ = nan;
  double target_since_s_ = 0;
  double error_m_ = nan;
  std::uint64_t slips_ = 0;
  std::uint64_t slips_before_last_second_ = 0;
  double nearest_before_m_ = far, nearest_in_last_second_m_ = far;  // of the present target, at rest
  bool settled_ = false;
};

}  // namespace breakaway::sil
