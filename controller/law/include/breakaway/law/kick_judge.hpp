// KickJudge: what the kicks since the target moved have shown, and the fault that they prove.
//
// Every lawful kick leads nearer, and goes as far as some friction within its stated bounds lets it. An axis whose
// kicks do not is not what was stated; one kick may be disturbed, but not a few, so each fault takes a number of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/control_types.hpp"
#include "breakaway/law/fine_stage.hpp"
#include "breakaway/law/kick_cycle.hpp"

namespace breakaway::law {

template <class Scalar>
class KickJudge {
 public:
  // Since the target moved, or, under the coast "work", without a new least error: after that the axis hunts or is
  // jammed.
  static constexpr std::uint8_t most_kicks = 128;
  // Approaches to one target that end further away than kicks are for, before the axis is kicked from there.
  static constexpr std::uint8_t most_far_ends = 4;
  // Kicks that show friction outside its stated bounds.
  static constexpr std::uint8_t most_contradictions = 4;

  using Parameters = AxisParameters<Scalar>;

  constexpr KickJudge() noexcept = default;
  // unseen_m: AxisParameters::unseen_m().
  constexpr explicit KickJudge(Scalar unseen_m) noexcept : unseen_m_{unseen_m} {}

  void forget() noexcept {
    least_error_m_ = largest;
    kicks_counted_ = 0;
    contradictions_ = far_ends_ = 0;
    moved_since_least_ = false;
    futile_ = growing_ = 0;
  }
  // The axis moves for another reason before it rests again.
  void forget_last() noexcept { awaiting_result_ = expects_ = false; }

  void kicked(Scalar from_m) noexcept {
    ++kicks_;
    kicked_from_m_ = from_m;
    awaiting_result_ = expects_ = true;
  }

  // Where the last kick led the axis is still to be judged.
  bool awaits_result() const noexcept { return awaiting_result_; }
  // Under the brake a kick has begun of which expect() has not been asked yet. That is for the period after it began,
  // which has less to do than its own.
  bool expects() const noexcept { return expects_; }

  // How far the kick that began leads an axis that is as told; where friction bends, the force was not enough or the
  // fine stage chose it, nothing is known of that. Two readings are off by a count together, and may be by another for
  // noise.
  [[gnu::noinline]] void expect(const Parameters& p, const KickCycle<Scalar>& cycle,
                                const FineStage<Scalar>& fine) noexcept {
    const BrakedKicks<Scalar>& told = cycle.kicks();
    expect_nothing();
    if (cycle.pulse_limited() || fine.kicked() || !told.kicks_show_friction()) return;
    const Scalar sure_m = told.sure.from(std::abs(kicked_from_m_));
    if (sure_m > 0) led_to_m_ = at_most_m_ - sure_m;
    const Scalar pulse_s = static_cast<Scalar>(cycle.pulse_periods()) * p.period_s;
    const auto travel_m = [&](Scalar friction_N) {
      return travel_seen_m(told.approach.mass_kg, cycle.pulse_N(), told.brake_N, pulse_s, friction_N);
    };
    least_travel_m_ = travel_m(told.most_seen_N) - 2 * unseen_m_;
    if (told.least_seen_N > -told.brake_N)
      most_travel_m_ = std::max(travel_m(told.least_seen_N), Scalar{0}) + 2 * unseen_m_;
  }

  void expect_nothing() noexcept {
    expects_ = false;
    least_travel_m_ = -largest;
    most_travel_m_ = led_to_m_ = largest;
  }

  // The axis left its hold without a kick, which counts as one. Returns whether that was one too many.
  bool left_hold() noexcept { return ++kicks_counted_ > most_kicks; }

  // Where all count, a kick more would be one too many.
  bool has_no_more() const noexcept { return kicks_counted_ >= most_kicks; }

  // An approach ended further away than kicks are for. Returns whether another may lead nearer.
  bool approach_may_help() noexcept {
    if (far_ends_ < most_far_ends) ++far_ends_;
    return far_ends_ < most_far_ends;
  }

  // Where the last kick led the axis that rests at x now: nowhere, closer, or further away. Returns the first fault
  // that it proves. To be called under the coast "pd".
  ControlFault judge(const Parameters& p, Scalar x) noexcept { return judge<true>(p, x, nullptr, nullptr); }

  // The same under the brake, where the travel of the table's kicks is compared with what was told as well. An axis
  // that is near enough is not to be asked for what is proved.
  ControlFault judge(const Parameters& p, Scalar x, const KickCycle<Scalar>& cycle,
                     const FineStage<Scalar>& fine) noexcept {
    note_distance(x);
    return judge<true>(p, x, &cycle, &fine);
  }

  // The same under the coast "work": kicks that should have moved the axis and did not are few.
  ControlFault judge_work(const Parameters& p, Scalar x) noexcept {
    const ControlFault proved = judge<false>(p, x, nullptr, nullptr);
    return proved == ControlFault::none && futile_ >= most_futile_works ? ControlFault::jammed : proved;
  }

  // Under the brake, as far away as the axis that rests may be: by its reading, and by the kicks before, which each are
  // sure to have led it nearer whether that shows or not.
  Scalar at_most_m() const noexcept { return at_most_m_; }

  std::uint32_t kicks() const noexcept { return kicks_; }
  // In a row, and without a count of motion.
  std::uint32_t futile() const noexcept { return futile_; }
  // About the friction that the last kick showed which contradicts what was told, or the brake, where that drove the
  // axis back; 0: there was none.
  Scalar seen_friction_N() const noexcept { return seen_friction_N_; }

 private:
  static constexpr Scalar largest = std::numeric_limits<Scalar>::max();
  static constexpr std::uint8_t futile_limit = 64;  // kicks without a count of motion before the axis counts as jammed
  static constexpr std::uint8_t most_futile_works = 8;
  static constexpr std::uint8_t growing_limit = 8;  // kicks in a row that made the error larger

  // A reading that is further away than what is known contradicts it, and is all that is known then.
  void note_distance(Scalar x) noexcept {
    const Scalar read_m = std::abs(x) + unseen_m_ / 2;
    const bool is_led = awaiting_result_ && x * kicked_from_m_ > 0;
    at_most_m_ = is_led && led_to_m_ < read_m && led_to_m_ >= read_m - unseen_m_ ? led_to_m_ : read_m;
  }

  template <bool all_count>
  ControlFault judge(const Parameters& p, Scalar x, const KickCycle<Scalar>* cycle,
                     const FineStage<Scalar>* fine) noexcept {
    if (!awaiting_result_) return ControlFault::none;
    awaiting_result_ = false;
    proved_ = ControlFault::none;
    const Scalar error_m = std::abs(x);
    Scalar lawful_m = std::abs(kicked_from_m_) + p.position_tolerance_m + unseen_m_;
    if (fine != nullptr && fine->kicked()) lawful_m += fine->beyond_m();
    const bool moved = std::abs(x - kicked_from_m_) > unseen_m_ / 2;
    if (cycle != nullptr) compare_with_told(p, *cycle, (x - kicked_from_m_) * cycle->direction());
    const bool grew = error_m > lawful_m;
    futile_ = moved ? 0 : futile_ + 1;
    growing_ = grew ? growing_ + 1 : 0;
    note_least_error<all_count>(p, error_m, moved, fine != nullptr);
    if (fine == nullptr && futile_ >= futile_limit) accuse(ControlFault::jammed);
    if (growing_ >= growing_limit) accuse(ControlFault::diverging);
    return proved_;
  }

  // Near the target, where a kick may do less than a count, many may be needed to show that they lead nearer. Where
  // all count, a certified axis needs no more of them than the limit.
  template <bool all_count>
  void note_least_error(const Parameters& p, Scalar error_m, bool moved, bool under_brake) noexcept {
    if (error_m < least_error_m_ - unseen_m_ / 2) {
      least_error_m_ = error_m;
      moved_since_least_ = false;
      if constexpr (!all_count) {
        kicks_counted_ = 0;
        return;
      }
      moved = true;
    } else if (moved) {
      moved_since_least_ = true;
    }
    if (++kicks_counted_ >= most_kicks && (under_brake || error_m > p.position_tolerance_m))
      accuse(moved || moved_since_least_ ? ControlFault::hunting : ControlFault::jammed);
  }

  // A kick that was not seen to lead on says nothing of friction.
  void compare_with_told(const Parameters& p, const KickCycle<Scalar>& cycle, Scalar travel_m) noexcept {
    const BrakedKicks<Scalar>& told = cycle.kicks();
    if (cycle.driven_back()) {
      if (told.kicks_show_friction()) contradict(told.brake_N);
    } else if (travel_m > unseen_m_ / 2 && (travel_m < least_travel_m_ || travel_m > most_travel_m_)) {
      const Scalar pulse_s = static_cast<Scalar>(cycle.pulse_periods()) * p.period_s;
      contradict(friction_seen_N(told.approach.mass_kg, cycle.pulse_N(), told.brake_N, pulse_s, travel_m));
    }
  }
  void contradict(Scalar seen_N) noexcept {
    seen_friction_N_ = seen_N > 0 ? seen_N : Scalar{0};  // less than none: mass or force gain are off as well
    if (++contradictions_ >= most_contradictions) accuse(ControlFault::contradicted);
  }

  // Of one kick the first fault that it shows is the one to know.
  void accuse(ControlFault fault) noexcept {
    if (proved_ == ControlFault::none) proved_ = fault;
  }

  Scalar unseen_m_{};
  Scalar least_error_m_ = largest;  // at which the axis rested since the target moved
  Scalar kicked_from_m_{};
  Scalar at_most_m_{};
  Scalar led_to_m_ = largest;         // at most, by the last kick,
  Scalar least_travel_m_ = -largest;  // and between these two bounds
  Scalar most_travel_m_ = largest;
  Scalar seen_friction_N_{};
  std::uint32_t kicks_ = 0;
  ControlFault proved_ = ControlFault::none;
  std::uint32_t futile_ = 0;
  std::uint32_t growing_ = 0;
  std::uint32_t kicks_counted_ = 0;
  std::uint32_t contradictions_ = 0;
  std::uint8_t far_ends_ = 0;
  bool moved_since_least_ = false;
  bool awaiting_result_ = false;
  bool expects_ = false;
};

}  // namespace breakaway::law
