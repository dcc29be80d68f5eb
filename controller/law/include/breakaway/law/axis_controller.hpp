// AxisController: the switching impulsive law of [I], as it is flashed.
//
// [I]: van de Wouw and Leine, Impulsive Control of Mechanical Motion Systems with Uncertain Friction. Feedback (16),
// kicks (5) and (15) from a precomputed table. With a period and an encoder, a kick is a shaped force pulse and rest is
// certified from counts; with period 0 and resolution 0 the same class is the ideal law: an impulse at each instant of
// exact rest.
//
// Under Coast::pd it slides, rests and is kicked as PdCycle says. With Coast::brake the kicks come from another table
// and end under a brake, as KickCycle says, and ApproachPlan brings the axis near its target; modes, holding and faults
// are the same. With Coast::work, for a load on a spring, WorkCycle and ShapedMove stand in their places; which of the
// two an axis has is the compiler's choice.
//
// Two departures from (5), for axes whose friction or force gain is not what was stated: an axis certified at rest is
// kicked wherever it stands, not only inside the maximal stick set; and a coast that outlasts its longest lawful time
// ends in a kick.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "breakaway/law/approach_progress.hpp"
#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/axis_parts.hpp"
#include "breakaway/law/braked_kicks.hpp"
#include "breakaway/law/control_types.hpp"
#include "breakaway/law/held_axis.hpp"
#include "breakaway/law/k3_table.hpp"
#include "breakaway/law/kick_judge.hpp"
#include "breakaway/law/pd_cycle.hpp"
#include "breakaway/law/spring_stage.hpp"

namespace breakaway::law {

// Kicks: BrakedKicks, or WorkKicks for the coast "work".
template <class Scalar, class Kicks = BrakedKicks<Scalar>>
class AxisController {
 public:
  using Parameters = AxisParameters<Scalar>;

  // The ideal law, without a period. Requires validate(parameters) == ParameterError::none; the table must have been
  // built for these parameters and must outlive the controller.
  [[gnu::cold]] AxisController(const Parameters& parameters, const K3Table<Scalar>& table) noexcept
      : p_{parameters}, pd_{parameters, table, nullptr}, judge_{parameters.unseen_m()} {}

  // The coast "pd" with a period: pulses are those of these parameters, and must outlive the controller as well.
  [[gnu::cold]] AxisController(const Parameters& parameters, const K3Table<Scalar>& table,
                               const KickTable<Scalar>& pulses) noexcept
      : p_{parameters}, pd_{parameters, table, &pulses}, judge_{parameters.unseen_m()} {}

  // Any coast. kicks must be those of these parameters, of which the coast "pd" has a table only, and must outlive the
  // controller as well.
  [[gnu::cold]] AxisController(const Parameters& parameters, const K3Table<Scalar>& table, const Kicks& kicks) noexcept
      : p_{parameters}, pd_{parameters, table, &kicks.table}, judge_{parameters.unseen_m()} {
    if (p_.coast != Parts::coast) return;
    braked_ = &kicks;
    cycle_ = {kicks, p_.unseen_m(), p_.max_force_N, p_.latency_periods};
    if constexpr (!Parts::by_work) {
      spring_ = {kicks.spring, p_.encoder_resolution_m, p_.position_tolerance_m};
      progress_ = {kicks, p_.max_approach_speed_m_s, p_.period_s};
    }
    if constexpr (Parts::by_work) cycle_.set_period(p_.period_s);
    fine_ = {kicks, p_};
    plan_ = {kicks.approach, p_.period_s, p_.max_approach_speed_m_s, p_.latency_periods};
    kicks_begin_m_ = kicks.begin_m();
  }

  // To be called once a period. Its work is bounded, and it keeps no state outside this object.
  ControlOutput<Scalar> update(const Measurement<Scalar>& z) noexcept {
    if (!z.fresh) return without_sample();
    if (!(std::abs(z.position_error_m) <= largest)) return fail(ControlFault::not_a_number);
    if (mode_ == Mode::fault) return nothing();
    const Scalar x = z.position_error_m;
    if (braked_ != nullptr) return braked_output(flow_braked(x));
    const Scalar v = pd_.see(p_, z);
    if (!(std::abs(v) <= largest)) return fail(ControlFault::not_a_number);
    return mode_ == Mode::kick ? pulse(pd_.feedback_N(p_, x, v)) : flow(x, v);
  }

  // The target moved by shift_m: the next position error will be smaller by it. An approach of the coast "brake" that
  // is under way goes on from where it is, because it knows how fast it moves, and so does a brake whose axis would
  // have to be turned; otherwise the axis starts a new one.
  [[gnu::cold, gnu::noinline]] void shift_target(Scalar shift_m) noexcept {
    pd_.shift_origin(shift_m);
    newest_m_ -= shift_m;
    before_m_ -= shift_m;
    judge_.forget();
    fine_.restart();
    if constexpr (!Parts::by_work) {
      if (braked_ != nullptr && mode_ == Mode::approach) {
        cycle_.restart();
        progress_.shift_origin(shift_m);
        return plan_.retarget(shift_m);
      }
      if (is_braked_away()) {
        cycle_.shift_origin(shift_m);
        judge_.forget_last();
        return plan_.set_off_at_once();
      }
    }
    const bool rests = mode_ == Mode::hold;
    start_approach();
    if (!rests) plan_.set_off_at_once();
  }

  // How long a move from rest over this distance takes under its limits, up to where brake and kicks take over; 0 where
  // the axis has none.
  Scalar move_time_s(Scalar distance_m) const noexcept { return plan_.move_time_s(distance_m); }
  // The approach that has just begun, over this distance, is to take so long: until the target moves again its speed is
  // limited further, and where that does not do it sets off later. One that is where it is to be has no way to go.
  void take_time(Scalar time_s, Scalar distance_m) noexcept {
    if (distance_m > p_.position_tolerance_m) plan_.take(time_s, distance_m);
  }

  // The actuator gives no more than this; the configured limit counts besides. A limit at or below the upper friction
  // bound cannot break the axis away: then it ends up jammed, by name.
  [[gnu::cold]] void limit_force(Scalar force_N) noexcept {
    const Scalar left_N = std::max(force_N - (p_.total_force_N() - p_.max_force_N), Scalar{0});
    if (!(left_N < p_.max_force_N)) return;
    if (braked_ != nullptr) plan_.limit_force(left_N / p_.max_force_N);
    p_.max_force_N = left_N;
    if (braked_ == nullptr) return;
    cycle_.limit_force(left_N);
    judge_.expect_nothing();  // of a kick that is made weaker on its way
  }

  // Leaves the fault mode and forgets all history; the next update starts a new approach.
  [[gnu::cold, gnu::noinline]] void reset() noexcept {
    pd_.reset();
    cycle_.forget_force();
    last_force_N_ = 0;
    fault_ = ControlFault::none;
    restart();
  }

  // The gains in force between this update and the next, for a plant with continuous feedback (the ideal law).
  Scalar damping_Ns_per_m() const noexcept {
    return mode_ == Mode::approach ? p_.approach_damping_Ns_per_m : p_.kick_damping_Ns_per_m;
  }

  Mode mode() const noexcept { return mode_; }
  // It is to set off later, so that its move ends with others.
  bool waits() const noexcept { return plan_.waits(); }
  ControlFault fault() const noexcept { return fault_; }
  // Under the brake, when the approach is over, the mean between the last two readings.
  Scalar velocity_m_s() const noexcept {
    if (braked_ == nullptr) return pd_.velocity_m_s();
    return mode_ == Mode::approach ? plan_.velocity_m_s() : (newest_m_ - before_m_) / p_.period_s;
  }
  // So far, modulo 2^32.
  std::uint32_t kicks() const noexcept { return judge_.kicks(); }
  Scalar seen_friction_N() const noexcept { return judge_.seen_friction_N(); }
  const Parameters& parameters() const noexcept { return p_; }
  Scalar period_s() const noexcept { return p_.period_s; }
  Scalar encoder_resolution_m() const noexcept { return p_.encoder_resolution_m; }
  // Of every output.
  Scalar max_force_N() const noexcept { return p_.total_force_N(); }
  // A greater force, as commanded and beside the feedforward, moves the axis for certain; but the encoder need not show
  // the first lost_motion_m() of it.
  Scalar breakaway_N() const noexcept { return braked_ != nullptr ? braked_->breakaway_N : p_.friction.upper_N; }
  Scalar lost_motion_m() const noexcept { return braked_ != nullptr ? braked_->lost_motion_m : Scalar{0}; }
  // Share of a change of force that is left after a period behind the slowest current loop that the kicks are made for.
  // The coast "pd" is for loops that have followed by then.
  Scalar slow_lag() const noexcept { return braked_ != nullptr ? braked_->slow_lag : Scalar{0}; }
  // What is sure of the axis while it is held.
  HeldAxis<Scalar> held() const noexcept { return held_axis(p_, braked_); }

 private:
  using Parts = AxisParts<Kicks>;

  static constexpr Scalar largest = std::numeric_limits<Scalar>::max();
  // Under the coast "pd"; under the brake it is longer, because a proof of rest may take longer there.
  static constexpr std::int32_t long_hold_periods = 400;

  // The first fault is the one to know. Returns the force from then on.
  [[gnu::cold, gnu::noinline]] Scalar latch(ControlFault fault) noexcept {
    if (mode_ != Mode::fault) fault_ = fault;
    mode_ = Mode::fault;
    return 0;
  }
  [[gnu::cold, gnu::noinline]] ControlOutput<Scalar> fail(ControlFault fault) noexcept {
    latch(fault);
    return nothing();
  }
  ControlOutput<Scalar> nothing() const noexcept { return {Scalar{0}, Scalar{0}, Mode::fault, false}; }

  // A period whose sample was lost: a pulse goes on and ends on time, an approach by its plan; everything else holds
  // its force and concludes nothing.
  ControlOutput<Scalar> without_sample() noexcept {
    if (mode_ == Mode::fault) return nothing();
    if (braked_ != nullptr) return braked_output(braked_without_sample());
    pd_.skip();
    return mode_ == Mode::kick ? pulse(last_force_N_ - pd_.pulse_N()) : output(last_force_N_);
  }

  // One period of the coast "pd" outside of a pulse. Within update() it would cost each step under the brake, too.
  [[gnu::noinline]] ControlOutput<Scalar> flow(Scalar x, Scalar v) noexcept {
    if (mode_ == Mode::hold) {
      if (!beyond_tolerance(x)) {
        note_holding(long_hold_periods);
        return output(pd_.feedback_N(p_, x, v));
      }
      mode_ = std::abs(x) > p_.stick_radius_upper_m() ? Mode::approach : Mode::coast;
      pd_.lose_sight();
    }
    if (pd_.at_rest(p_, x, v, std::max(std::abs(last_force_N_), std::abs(force_before_N_)))) {
      if (!(std::abs(x) > p_.position_tolerance_m)) return enter_hold(x, v);
      return start_kick(x, std::abs(x));
    }
    const Scalar rest_m = pd_.kicked_from_m(p_, x, v, last_force_N_);
    if (rest_m > 0) return start_kick(x, rest_m);
    return output(mode_ == Mode::approach ? pd_.approach_N(p_, x, v) : pd_.feedback_N(p_, x, v));
  }

  // One period of the coast "brake". What makes it up returns the force, and braked_output() what is told with it:
  // a result of several numbers would be carried through memory by every call in between.
  Scalar flow_braked(Scalar x) noexcept {
    expect_kick();
    cycle_.see(x);
    before_m_ = newest_m_;
    newest_m_ = x;
    if (mode_ == Mode::approach) return approach_to_brake(x);
    if (mode_ == Mode::hold) {
      if (!beyond_tolerance(x)) return keep_holding(x);
      if (held_ >= long_braked_hold()) forget_hold();  // it has been pushed
      if (judge_.left_hold()) return latch(ControlFault::hunting);
      if (std::abs(x) > far_m()) return approach_again(false);
      mode_ = Mode::coast;
      if (!spring_.active()) cycle_.release(0);
    }
    if constexpr (!Parts::by_work) {
      if (spring_.active()) return finish_on_spring(x);
    }
    if (cycle_.at_rest()) return conclude(x);
    if (!cycle_.overdue()) return give(0);
    return finishes_on_spring(x) ? conclude(x) : latch(ControlFault::drifting);
  }

  // A kick or a brake is under way in which an axis whose moves have limits can only move away from its target.
  bool is_braked_away() const noexcept {
    const bool is_under_way = mode_ == Mode::coast || mode_ == Mode::kick;
    return is_under_way && plan_.has_limits() && !spring_.active() && newest_m_ * cycle_.direction() > 0;
  }

  // An axis that left its hold by more is approached again.
  Scalar far_m() const noexcept {
    if constexpr (Parts::by_work)
      return braked_->begin_m();
    else
      return 4 * (braked_->approach.switch_distance_m + braked_->approach.short_of_target_m);
  }

  void forget_hold() noexcept {
    fine_.restart();
    spring_.begin_anew();
  }

  Scalar keep_holding(Scalar x) noexcept {
    note_holding(long_braked_hold());
    if (!spring_.active()) return give_freely(0);
    spring_.watch(x);
    return give_on_spring();
  }

  bool finishes_on_spring(Scalar x) const noexcept {
    if constexpr (Parts::by_work)
      return false;
    else
      return spring_.reaches(x);
  }

  [[gnu::cold, gnu::noinline]] Scalar begin_on_spring(Scalar x) noexcept {
    spring_.start(x);
    cycle_.set_free();
    return finish_on_spring(x);
  }

  // Ends in a hold, or in a kick from where the spring has led the axis.
  [[gnu::cold, gnu::noinline]] Scalar finish_on_spring(Scalar x) noexcept {
    if (spring_.see(x)) cycle_.forget_patience();
    const bool overdue = spring_.overdue();
    if ((spring_.waits() && cycle_.stays()) || overdue) {
      if (std::abs(x) > fine_.tolerance_m() && !spring_.is_near())
        return judge_.has_no_more() ? latch(ControlFault::hunting) : start_braked_kick(x);
      // A kick would only add to ringing that nothing shows, but a hold is for an axis that rests.
      if (cycle_.has_rung_out() || overdue) {
        mode_ = Mode::hold;
        held_ = 0;
      }
    }
    return give_on_spring();
  }
  [[gnu::cold, gnu::noinline]] Scalar give_on_spring() noexcept {
    return give(cycle_.whole_steps(spring_.force_N() + braked_->force_step_N / 2));
  }

  std::int32_t long_braked_hold() const noexcept { return 8 * braked_->patient_periods; }
  // What leaves a hold without a new target has been pushed, or did not rest. A long hold tells the one from the other.
  void note_holding(std::int32_t long_hold) noexcept {
    if (held_ > long_hold) return;
    if (++held_ == long_hold) judge_.forget();
  }

  // A period in which the move does not set off yet. One that waits does not stick.
  Scalar wait() noexcept {
    plan_.wait();
    cycle_.forget_patience();
    return give(0);
  }

  bool gets_stuck(Scalar x) noexcept {
    if constexpr (Parts::by_work) {
      return cycle_.driven_to_and_fro();
    } else {
      return progress_.hardly_gets_on(x);
    }
  }

  Scalar approach_to_brake(Scalar x, Reading reading = Reading::there) noexcept {
    if (plan_.waits()) return wait();
    const bool arrived = plan_.see(x, cycle_.interval().middle_N(), last_force_N_, reading);
    if (!(std::abs(plan_.velocity_m_s()) <= largest)) return latch(ControlFault::not_a_number);
    if (arrived) {
      mode_ = Mode::coast;
      cycle_.brake(plan_.heading(), plan_.braking_periods());
      return give(0);
    }
    const bool is_read = reading == Reading::there;
    // It seems to stick, or the plan does not lead there.
    if (is_read && (cycle_.patient() || plan_.turned_often() || gets_stuck(x))) {
      // Only without a force can rest be proved.
      mode_ = Mode::coast;
      cycle_.forget_patience();
      cycle_.release(plan_.braking_periods());
      return give(0);
    }
    const Scalar force_N = is_read || plan_.reckons() ? plan_.force_N() : Scalar{0};
    return give_freely(cycle_.whole_steps(force_N + braked_->force_step_N / 2));
  }

  void expect_kick() noexcept {
    if constexpr (!Parts::by_work) {
      if (judge_.expects()) judge_.expect(p_, cycle_, fine_);
    }
  }

  ControlFault judge_kick(Scalar x) noexcept {
    if constexpr (Parts::by_work)
      return judge_.judge_work(p_, x);
    else
      return judge_.judge(p_, x, cycle_, fine_);
  }

  // The axis rests: holds it there, or kicks it.
  Scalar conclude(Scalar x) noexcept {
    // What its kicks show says nothing against an axis that they led near enough, the last of all that it may have,
    // too.
    const bool was_kicked = judge_.awaits_result();
    const ControlFault proved = judge_kick(x);
    if (proved != ControlFault::none && !is_near_enough(x)) return latch(proved);
    fine_.learn(x, cycle_.pulse_N());
    const bool near_enough = is_near_enough(x);
    if constexpr (!Parts::by_work) {
      if (spring_.is_there() && (near_enough || spring_.reaches(x))) return begin_on_spring(x);
    }
    if (near_enough) {
      mode_ = Mode::hold;
      held_ = 0;
      cycle_.release(0);
      return give(0);
    }
    // A fine stage chooses its next kick a period later: this one has work enough with what the last has shown.
    if (was_kicked && fine_.chooses_a_period_later()) return give(0);
    if (!(std::abs(x) > kicks_begin_m_) || !judge_.approach_may_help()) return start_braked_kick(x);
    // A slow approach leads nearer on an axis that a fast one drives to and fro; one that was in motion as its target
    // moved may have passed it only.
    return approach_again(!plan_.began_in_motion());
  }

  // By its reading; or because the kicks before are sure to have led the axis as near as such a reading promises,
  // though it shows up to half a count more.
  bool is_near_enough(Scalar x) const noexcept {
    if constexpr (Parts::by_work)
      return std::abs(x) <= fine_.tolerance_m();
    else
      return is_led_near_enough(std::abs(x));
  }
  bool is_led_near_enough(Scalar error_m) const noexcept {
    const Scalar tolerance_m = fine_.tolerance_m(), promised_m = tolerance_m + p_.encoder_resolution_m / 2;
    if (!(error_m <= promised_m)) return false;
    return error_m <= tolerance_m || judge_.at_most_m() <= promised_m;
  }

  [[gnu::cold, gnu::noinline]] Scalar approach_again(bool slowly) noexcept {
    start_approach();
    if (slowly) plan_.go_slowly();
    return give(0);
  }

  Scalar start_braked_kick(Scalar x) noexcept {
    if constexpr (Parts::by_work) {
      if (const ControlFault why_not = fine_.refusal(x); why_not != ControlFault::none) return latch(why_not);
    }
    spring_.stop();
    judge_.kicked(x);
    mode_ = Mode::coast;
    const Scalar towards = x > 0 ? Scalar{-1} : Scalar{1};
    if constexpr (Parts::by_work)
      cycle_.kick(towards, std::abs(x), fine_.pulse(x));
    else
      cycle_.kick(towards, fine_.pulse(x));
    return give(0);
  }

  Scalar braked_without_sample() noexcept {
    expect_kick();
    if constexpr (Parts::by_work) cycle_.skip();
    if (mode_ == Mode::approach) return approach_to_brake(newest_m_, Reading::lost);
    return give(cycle_.whole_steps(last_force_N_ + braked_->force_step_N / 2));
  }

  // free_steps: of the force where no kick is under way.
  Scalar give(std::int32_t free_steps) noexcept {
    const std::int32_t steps = cycle_.next_steps(free_steps);
    if (mode_ != Mode::hold && mode_ != Mode::approach) mode_ = cycle_.pulsed() ? Mode::kick : Mode::coast;
    return given(static_cast<Scalar>(steps) * braked_->force_step_N);
  }
  // The same in an approach, and in a hold.
  Scalar give_freely(std::int32_t steps) noexcept {
    return given(static_cast<Scalar>(cycle_.next_free_steps(steps)) * braked_->force_step_N);
  }

  // Leaving hold needs one count more than entering it, so that a reading between two counts does not toggle the mode.
  bool beyond_tolerance(Scalar x) const noexcept {
    return std::abs(x) > fine_.tolerance_m() + p_.unseen_m() * Scalar(1.5);
  }

  ControlOutput<Scalar> enter_hold(Scalar x, Scalar v) noexcept {
    if (const ControlFault proved = judge_unless_exact(x); proved != ControlFault::none) return fail(proved);
    mode_ = Mode::hold;
    held_ = 0;
    return output(pd_.feedback_N(p_, x, v));
  }

  // rest_m: from which distance a kick from rest is as strong.
  ControlOutput<Scalar> start_kick(Scalar x, Scalar rest_m) noexcept {
    if (const ControlFault proved = judge_unless_exact(x); proved != ControlFault::none) return fail(proved);
    // The last of them may have led into a hold that the axis left.
    if (judge_.has_no_more() && !p_.exact()) return fail(ControlFault::hunting);
    judge_.kicked(x);
    if (p_.ideal()) {
      mode_ = Mode::coast;
      ControlOutput<Scalar> kick = output(-p_.stiffness_N_per_m * x);
      kick.impulse_Ns = x > 0 ? -pd_.impulse_Ns(x) : pd_.impulse_Ns(x);
      kick.kicked = true;
      return kick;
    }
    pd_.begin_pulse(p_, x, rest_m, judge_.futile());
    mode_ = Mode::kick;
    // The feedback at the start is that of rest: the table counts from there.
    ControlOutput<Scalar> first = pulse(-p_.stiffness_N_per_m * x);
    first.kicked = true;
    return first;
  }

  // One period of a pulse of the coast "pd".
  ControlOutput<Scalar> pulse(Scalar feedback_N) noexcept {
    const ControlOutput<Scalar> now = output(pd_.pulse_N() + feedback_N);
    if (pd_.pulse_ends(p_)) mode_ = Mode::coast;
    return now;
  }

  ControlOutput<Scalar> output(Scalar force_N) noexcept {
    return {given(force_N) + p_.feedforward_N, Scalar{0}, mode_, false};
  }
  ControlOutput<Scalar> braked_output(Scalar force_N) const noexcept {
    if (mode_ == Mode::fault) return nothing();
    return {force_N + p_.feedforward_N, Scalar{0}, mode_, cycle_.pulse_starts()};
  }
  Scalar given(Scalar force_N) noexcept {
    force_before_N_ = last_force_N_;
    last_force_N_ = limited(force_N, p_.max_force_N);
    return last_force_N_;
  }

  // What is read exactly shows the least motion, and the ideal law is proved to reach its target.
  ControlFault judge_unless_exact(Scalar x) noexcept { return p_.exact() ? ControlFault::none : judge_.judge(p_, x); }

  [[gnu::cold]] void restart() noexcept {
    judge_.forget();
    fine_.restart();
    start_approach();
  }
  [[gnu::noinline]] void start_approach() noexcept {
    cycle_.restart();
    spring_.stop();
    plan_.restart();
    progress_.restart();
    mode_ = fault_ == ControlFault::none ? Mode::approach : Mode::fault;
    judge_.forget_last();
    if (braked_ == nullptr) pd_.restart(p_);
  }

  Parameters p_{};
  PdCycle<Scalar> pd_;
  const Kicks* braked_ = nullptr;  // not of Coast::pd
  typename Parts::Cycle cycle_{};
  SpringStage<Scalar> spring_{};
  typename Parts::Aim fine_{p_.position_tolerance_m};
  typename Parts::Plan plan_{};
  KickJudge<Scalar> judge_;
  Scalar last_force_N_{};
  Scalar force_before_N_{};
  Scalar newest_m_{};  // readings under the brake, and the one before
  Scalar before_m_{};
  Scalar kicks_begin_m_ = largest;
  ApproachProgress<Scalar> progress_{};
  std::int32_t held_ = 0;  // periods
  Mode mode_ = Mode::approach;
  ControlFault fault_ = ControlFault::none;
};

}  // namespace breakaway::law
