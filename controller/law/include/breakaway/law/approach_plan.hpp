// ApproachPlan: the force that brings an axis near its target, where the coast "brake" and its kicks take over.
//
// Let E be the distance to a point a little before the target, or to the target where jerk is limited, and w the speed
// towards it. The axis is to come down the greater of two curves,
//   far    w^2 = 2 a_h (E - E1) + w1^2     with a_h the deceleration of which the drive is capable for certain
//   near   w^2 = 2 a_g E                   with a_g that of brake and least friction, and w1^2 = 2 a_g E1; a weak
//                                          drive, with a_h < a_g, comes down the far one
// and each period takes the acceleration that leads onto the curve within the response time R:
//   a = (-(2 w + a_d R) + sqrt(a_d^2 R^2 + 8 a_d E - 4 a_d w R)) / (2 R).
// E and w are those of the instant at which the new force begins: the speed is estimated from readings and from what
// was commanded meanwhile, and carried over the latency. What a lagging current loop still owes counts as if
// it had acted: a transient D e^(-t/tau) of the force adds D tau / m to the speed, tau later.
//
// A move with limits on acceleration and jerk comes down the same curves, the far one flatter, or follows MovePlan
// where its jerk is limited; and it goes on from where it is when its target moves on.
//
// The plan is for speed, not for safety: kicks mend whatever it leaves. It ends where the brake takes over, and an axis
// that turns back a third time is left alone: on an axis whose friction can turn its motion within a period, or that
// is not what was stated, the plan would drive it to and fro for ever.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "breakaway/law/braked_kicks.hpp"
#include "breakaway/law/control_types.hpp"
#include "breakaway/law/move_plan.hpp"

namespace breakaway::law {

template <class Scalar>
class ApproachPlan {
 public:
  static constexpr std::size_t most_latency_periods = 8;

  ApproachPlan() noexcept = default;
  ApproachPlan(const BrakedApproach<Scalar>& a, Scalar period_s, Scalar max_speed_m_s, std::uint8_t latency) noexcept
      : a_{&a},
        period_s_{period_s},
        per_period_{1 / period_s},
        per_mass_{1 / a.mass_kg},
        speed_limit_m_s_{a.move.are_asked_for() ? std::min(max_speed_m_s, a.move.speed_m_s) : max_speed_m_s},
        max_speed_m_s_{speed_limit_m_s_},
        hard_m_s2_{a.hard_m_s2},
        half_per_gentle_{Scalar(0.5) / a.gentle_m_s2},
        turning_m_s_{a.move.are_asked_for() ? std::max(a.standing_m_s, Scalar(0.3) * a.switch_speed_m_s)
                                            : a.standing_m_s},
        passed_m_{a.move.are_asked_for() ? -2 * a.switch_distance_m : -std::numeric_limits<Scalar>::infinity()},
        least_braked_m_{a.switch_distance_m / 9},
        latency_{std::min<std::uint8_t>(latency, most_latency_periods)} {
    plan_curves();
  }

  // The drive gives this share of the force that the plan was made for: far away it brakes as much less.
  [[gnu::cold]] void limit_force(Scalar share) noexcept {
    hard_m_s2_ *= std::max(share, Scalar(1e-3));
    plan_curves();
    go_at_most(max_speed_m_s_);
  }

  void restart() noexcept {
    primed_ = false;
    waiting_periods_ = 0;
    in_motion_ = false;
    move_.restart();
    go_at_most(speed_limit_m_s_);
  }
  // The approach that has begun comes no faster than brake and friction alone can stop within the distance for that.
  void go_slowly() noexcept { go_at_most(std::min(a_->switch_speed_m_s, speed_limit_m_s_)); }
  // A move from rest over this distance; 0 where moves have no limits.
  [[gnu::cold]] Scalar move_time_s(Scalar distance_m) const noexcept {
    return has_limits() ? a_->move.time_s(distance_m, speed_limit_m_s_) : Scalar{0};
  }
  // The move over this distance, which has begun, is to take this long. One that would become too slow for its speed to
  // be seen sets off later instead, unless it is under way.
  [[gnu::cold]] void take(Scalar time_s, Scalar distance_m) noexcept {
    if (!has_limits()) return;
    const Scalar least_m_s = least_speed * a_->switch_speed_m_s;
    const Scalar wanted_m_s = std::max(a_->move.speed_for_m_s(distance_m, time_s), least_m_s);
    go_at_most(std::min(wanted_m_s, speed_limit_m_s_));
    const Scalar early_s = time_s - a_->move.time_s(distance_m, max_speed_m_s_);
    if (in_motion_ || primed_ || !(early_s > 0)) return;
    waiting_periods_ = static_cast<std::int32_t>(std::min(early_s * per_period_, longest_wait));
    velocity_ = 0;
  }
  // The approach that has begun finds the axis in motion, as its target does that moves on the way.
  void set_off_at_once() noexcept { in_motion_ = true; }
  bool has_limits() const noexcept { return a_ != nullptr && a_->move.are_asked_for(); }
  bool began_in_motion() const noexcept { return in_motion_; }
  bool waits() const noexcept { return waiting_periods_ > 0; }
  // A period of that, in the place of see().
  void wait() noexcept { --waiting_periods_; }
  // The target went on by this much: the approach goes on from where it is, as it moves.
  [[gnu::cold]] void retarget(Scalar shift_m) noexcept {
    in_motion_ = primed_;
    previous_m_ -= shift_m;
    waiting_periods_ = 0;
    turns_ = 0;
    retargeted_ = true;
    go_at_most(speed_limit_m_s_);
  }

  // Takes the newest position error and returns true when the brake is to take over. force_N: where the force is as
  // this period begins; command_N: what was commanded in the last one. Where the reading is lost x is not looked at:
  // the axis is reckoned on under its least friction, and reckons() says whether force_N() is to be asked. Otherwise
  // it is reckoned to have arrived or passed its target, which only a reading shows, and no force is to be given.
  // It and force_N() have one caller, which a compiler cannot know, and a period is spared their calls.
  [[gnu::always_inline]] bool see(Scalar x, Scalar force_N, Scalar command_N,
                                  Reading reading = Reading::there) noexcept {
    const bool is_read = reading == Reading::there;
    if (!primed_) {
      reckons_ = false;
      if (!is_read) return false;
      begin(x, force_N);
    }
    remember(force_N, command_N);
    if (!is_read) x = reckon();
    if (retargeted_ || (passed_ && is_read)) face(x);
    if (is_read) estimate(x);
    predict(x);
    // A force that has yet to come brings no axis near that is not there.
    const Scalar there_m = distance_;
    count_owed(force_N, command_N);
    if (is_read) watch_turns(velocity_ * direction_);
    const Scalar take_over = take_over_m();
    const bool is_near = distance_ <= take_over && there_m <= take_over;
    if (!is_read) {
      reckons_ = !is_near && !passed_;
      return false;
    }
    passed_ = distance_ < passed_m_;
    return is_near && !passed_ && std::abs(speed_) <= a_->switch_speed_m_s * Scalar(most_taken_over);
  }
  bool reckons() const noexcept { return reckons_; }

  // The force of the next period, unlimited. To be called once a period, after see() and unless that ended the plan.
  [[gnu::always_inline]] Scalar force_N() noexcept {
    if (a_->move.are_asked_for()) return force_of_move_N();
    return direction_ * (a_->mass_kg * down_the_curves(-2 * hard_m_s2_) + a_->friction_N);
  }

  bool turned_often() const noexcept { return turns_ >= most_turns; }
  // In which the axis moves as the plan ends; a lag or a latency may have it on its way back by then. One that hardly
  // moves counts as on its way to the target: rounding alone may say otherwise.
  Scalar heading() const noexcept { return speed_ < -a_->switch_speed_m_s / 64 ? -direction_ : direction_; }
  Scalar velocity_m_s() const noexcept { return velocity_; }
  // Periods in which the brake alone is sure to stop the axis at its present speed.
  Scalar braking_periods() const noexcept {
    return (std::abs(speed_) + 2 * a_->switch_speed_m_s) / (a_->gentle_m_s2 * period_s_);
  }

 private:
  // The distance at which the brake takes over. Strong friction slows a move of limited jerk down before that, and the
  // brake would stop it short of the target by most of it: such an axis goes on to where the brake leads it there,
  // unless it has less than a third of the speed that was planned there, because it might stick.
  Scalar take_over_m() const noexcept {
    const Scalar most_m = a_->switch_distance_m;
    if (!move_.brakes_less_than(a_->gentle_m_s2)) return most_m;
    const Scalar braked_m = speed_ * speed_ * half_per_gentle_;
    return braked_m > least_braked_m_ ? std::min(braked_m, most_m) : most_m;
  }

  // In which the axis was last seen to move for certain, as seen from its target.
  enum class Heading : std::uint8_t { unseen, towards, away };

  static constexpr Scalar least_speed = 8;     // of a move, as a multiple of that at which the brake takes over
  static constexpr Scalar longest_wait = 1e9;  // in periods

  // Near the target a weak drive is not sure to have the deceleration of brake and friction everywhere.
  [[gnu::cold]] void plan_curves() noexcept {
    const Scalar near_m_s2 = std::min(a_->gentle_m_s2, hard_m_s2_), w1 = a_->switch_speed_m_s;
    far_ = curve(hard_m_s2_);
    near_ = curve(near_m_s2);
    hard_brake_m_ = w1 * w1 / (2 * hard_m_s2_);
    move_ = {a_->move, {a_->switch_distance_m, w1, near_m_s2}, hard_m_s2_, period_s_};
  }

  void go_at_most(Scalar speed_m_s) noexcept {
    max_speed_m_s_ = speed_m_s;
    move_.limit_speed(speed_m_s);
  }

  Scalar down_the_curves(Scalar least_m_s2) const noexcept {
    const Scalar far = onto_curve(far_, distance_ - a_->switch_distance_m + hard_brake_m_);
    const Scalar near = onto_curve(near_, distance_);
    const Scalar allowed = (max_speed_m_s_ - speed_) / a_->response_s;
    return std::min(std::max({far, near, least_m_s2}), allowed);
  }

  // A move that was sent back is braked by friction as well, until it is seen to have turned.
  [[gnu::always_inline]] Scalar force_of_move_N() noexcept {
    const MoveLimits<Scalar>& limits = a_->move;
    const bool away = heading_ == Heading::away;
    const Scalar acceleration = move_.limits_jerk() ? move_.next(distance_, speed_, away)
                                                    : limits.within(down_the_curves(-limits.deceleration_m_s2), away);
    const Scalar force_N = a_->mass_kg * acceleration;
    return direction_ * (away ? less_friction_N(force_N) : force_N + a_->friction_N);
  }
  // What is left to the drive where friction does its share. An axis that may have turned since it was read is given no
  // more than it may have either way, so that its acceleration is within the limits whichever way it moves.
  Scalar less_friction_N(Scalar force_N) const noexcept {
    if (speed_ < -turning_m_s_) return force_N - a_->friction_N;
    return force_N - limited(force_N, a_->friction_N);
  }

  // A move whose target came too near for it to stop passes it and turns.
  void face(Scalar x) noexcept {
    const Scalar towards = x > 0 ? Scalar{-1} : Scalar{1};
    const bool turns = towards != direction_;
    // It may be reckoned past for several periods before a reading shows it.
    if (turns && passed_ && !retargeted_ && turns_ < most_turns) ++turns_;
    retargeted_ = passed_ = false;
    if (!turns) return;
    move_.turn();
    direction_ = towards;
    heading_ = Heading::away;
  }

  void begin(Scalar x, Scalar force_N) noexcept {
    retargeted_ = passed_ = false;
    last_force_N_ = force_N;
    direction_ = x > 0 ? Scalar{-1} : Scalar{1};
    previous_m_ = x;
    velocity_ = skipped_m_ = 0;
    turns_ = 0;
    heading_ = Heading::unseen;
    missed_ = -1;  // the first reading tells no speed
    primed_ = true;
    // Only those that are looked at, because a first period has work enough.
    for (std::size_t ago = 1; ago <= latency_; ++ago) gains_m_s_[ago] = 0;
  }

  // Keeps the gain in speed of the period that has just passed, friction at its least.
  void remember(Scalar force_N, Scalar command_N) noexcept {
    const Scalar mean_N = command_N + (last_force_N_ - force_N) * a_->lag_s * per_period_;
    last_force_N_ = force_N;
    const Scalar friction_N = friction_against(velocity_, mean_N);
    gains_m_s_[0] = (mean_N - friction_N) * per_mass_ * period_s_;
  }
  // Friction opposes motion, whichever way the force acts; at rest it holds what it can. What noise alone may show says
  // nothing of which way the axis moves: one that has set out is seen late, and moves as the force acts.
  Scalar friction_against(Scalar v, Scalar force_N) const noexcept {
    if (v > a_->standing_m_s) return a_->friction_N;
    if (v < -a_->standing_m_s) return -a_->friction_N;
    return limited(force_N, a_->friction_N);
  }

  void estimate(Scalar x) noexcept {
    const Scalar gain_m_s = gains_m_s_[latency_];
    if (missed_ < 0) {
      missed_ = 0;
      return;
    }
    velocity_ += gain_m_s;
    Scalar surprise_m_s = (x - previous_m_) * per_period_ - (velocity_ - gain_m_s / 2);
    if (missed_ > 0) {
      surprise_m_s = (surprise_m_s - skipped_m_ * per_period_) / static_cast<Scalar>(missed_ + 1);
      missed_ = 0;
      skipped_m_ = 0;
    }
    velocity_ += a_->correction * surprise_m_s;
    previous_m_ = x;
  }

  // Where the axis was a latency ago, and its speed.
  Scalar reckon() noexcept {
    const Scalar gain_m_s = gains_m_s_[latency_];
    skipped_m_ += (velocity_ + gain_m_s / 2) * period_s_;
    velocity_ += gain_m_s;
    if (missed_ < 1000) ++missed_;
    return previous_m_ + skipped_m_;
  }

  // What is read of an axis that hardly moves may point either way; and one that was sent back may have turned since it
  // was read.
  void watch_turns(Scalar towards_m_s) noexcept {
    if (towards_m_s > turning_m_s_) {
      if (speed_ > turning_m_s_) heading_ = Heading::towards;
    } else if (towards_m_s < -turning_m_s_) {
      if (heading_ == Heading::towards && turns_ < most_turns) ++turns_;
      heading_ = Heading::away;
    }
  }

  void count_owed(Scalar force_N, Scalar command_N) noexcept {
    const Scalar owed_m_s = (force_N - command_N) * direction_ * a_->lag_s * per_mass_;
    speed_ += owed_m_s;
    distance_ += owed_m_s * a_->lag_s;
  }

  // Carries the estimate from the reading to now.
  void predict(Scalar x) noexcept {
    Scalar v = velocity_;
    for (std::size_t ago = latency_; ago-- > 0;) {
      const Scalar gain_m_s = gains_m_s_[ago];
      gains_m_s_[ago + 1] = gain_m_s;  // for the next period
      x += (v + gain_m_s / 2) * period_s_;
      v += gain_m_s;
    }
    speed_ = v * direction_;
    distance_ = -x * direction_ - a_->short_of_target_m;
  }

  // What onto_curve() needs of a deceleration d, worked out beforehand: d R, its square, and 4 d.
  struct Curve {
    Scalar step{}, square{}, four{};
  };
  Curve curve(Scalar deceleration) const noexcept {
    const Scalar step = deceleration * a_->response_s;
    return {step, step * step, 4 * deceleration};
  }
  Scalar onto_curve(const Curve& c, Scalar distance_m) const noexcept {
    const Scalar R = a_->response_s;
    const Scalar under_root = c.square + c.four * (2 * distance_m - speed_ * R);
    if (!(under_root >= 0)) return -std::numeric_limits<Scalar>::max();
    return (std::sqrt(under_root) - (2 * speed_ + c.step)) / (2 * R);
  }

  const BrakedApproach<Scalar>* a_ = nullptr;
  Scalar period_s_{};
  Scalar per_period_{};
  Scalar per_mass_{};
  Scalar speed_limit_m_s_{};
  Scalar max_speed_m_s_{};  // of this approach
  Scalar hard_m_s2_{};      // deceleration far away
  Scalar hard_brake_m_{};   // in which it stops the axis from the speed at which the brake takes over
  Curve far_{}, near_{};
  Scalar half_per_gentle_{};
  // An axis that is seen with more speed, either way, is sure to go that way: the speed at which the brake takes over
  // is five times what is not seen of it, or more.
  Scalar turning_m_s_{};
  Scalar passed_m_{};        // and one that is nearer to its target has passed it, where moves have limits
  Scalar least_braked_m_{};  // from where the brake takes over that moves fast enough
  MovePlan<Scalar> move_{};
  Scalar previous_m_{};
  Scalar skipped_m_{};  // the way since then, in periods without a reading
  Scalar velocity_{};   // of the axis a latency ago, when it was read or reckoned last
  Scalar speed_{};      // towards the target now
  Scalar distance_{};   // to the point aimed at now
  Scalar last_force_N_{};
  Scalar direction_ = 1;
  std::array<Scalar, most_latency_periods + 1> gains_m_s_{};  // of speed, in the period so many before the last
  std::int32_t waiting_periods_ = 0;                          // before the move sets off
  std::int16_t missed_ = -1;
  std::uint8_t latency_ = 0;
  static constexpr std::uint8_t most_turns = 3;
  std::uint8_t turns_ = 0;  // from towards the target to away from it
  Heading heading_ = Heading::unseen;
  bool primed_ = false;
  bool in_motion_ = false;   // as the approach began, or its target moved
  bool retargeted_ = false;  // since the last reading
  bool reckons_ = false;     // without a reading
  bool passed_ = false;      // the target, by more than what brake and kicks are for
};

}  // namespace breakaway::law
