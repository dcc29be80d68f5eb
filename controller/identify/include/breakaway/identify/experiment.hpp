// Experiment: moves an axis of which neither mass nor friction is known so that its record tells both.
//
// It takes the place of a law in a control loop: a position in, a force out, once a period, and so every guard of the
// loop stays. Small comes before large: pulses of two periods grow until the axis moves either way; slow ramps say
// where it breaks away; pairs of accelerating and braking by the same force grow until such a pair is short; then the
// axis sweeps its travel in both directions by hops, each a ramp, a push and a coast-down. What the record of
// positions and forces says is for a PC to compute: breakaway/evaluation.
//
// At any moment it brakes rather than leave its travel (TravelGuard), whatever mass and friction are. A force that acts
// beside the drive's is outside what it can know; one that exceeds the friction ends it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "breakaway/identify/experiment_parameters.hpp"
#include "breakaway/identify/motion_watch.hpp"
#include "breakaway/identify/travel_guard.hpp"
#include "breakaway/law/control_types.hpp"

namespace breakaway::identify {

template <class Scalar>
class Experiment {
 public:
  using Parameters = ExperimentParameters<Scalar>;

  explicit Experiment(const Parameters& parameters) noexcept
      : p_{parameters}, watch_{p_.period_s, p_.encoder_resolution_m}, guard_{new_guard()} {}

  law::ControlOutput<Scalar> update(const law::Measurement<Scalar>& z) noexcept {
    const Scalar force_N = whole_steps(next_force_N(z));
    guard_.command(force_N);
    greatest_N_ = std::max(greatest_N_, std::abs(force_N));
    return {force_N, Scalar{0}, mode(), false};
  }

  // It brakes, and then rests.
  void request_end() noexcept { end(Ending::asked); }

  Stage stage() const noexcept { return stage_; }
  Ending ending() const noexcept { return ending_; }
  // It rests, or does not come to rest by braking, and no force will follow.
  bool finished() const noexcept {
    const bool named = fault() != law::ControlFault::none;  // the loop stops the axis
    return stage_ == Stage::over && (named || at_rest_ || action_s() > longest_halt_s);
  }
  std::uint32_t periods() const noexcept { return periods_; }

  // As a law in the loop

  void shift_target(Scalar shift_m) noexcept {
    p_.lowest_m -= shift_m, p_.highest_m -= shift_m;
    begin_m_ -= shift_m, start_m_ -= shift_m, furthest_m_ -= shift_m;
    watch_.shift_origin(shift_m);
    guard_.shift_origin(shift_m);
  }
  void limit_force(Scalar force_N) noexcept { p_.max_force_N = std::min(p_.max_force_N, force_N); }
  // It begins anew, from wherever the axis stands.
  void reset() noexcept { *this = Experiment{p_}; }
  law::ControlFault fault() const noexcept {
    switch (ending_) {
      case Ending::jammed:
        return law::ControlFault::jammed;
      case Ending::drifting:
      case Ending::noisy:
        return law::ControlFault::drifting;
      case Ending::not_a_number:
        return law::ControlFault::not_a_number;
      default:
        return law::ControlFault::none;
    }
  }
  law::Mode mode() const noexcept {
    if (fault() != law::ControlFault::none) return law::Mode::fault;
    return finished() ? law::Mode::hold : law::Mode::approach;
  }
  Scalar period_s() const noexcept { return p_.period_s; }
  Scalar encoder_resolution_m() const noexcept { return p_.encoder_resolution_m; }
  Scalar max_force_N() const noexcept { return p_.max_force_N; }

 private:
  enum class Action : std::uint8_t { wait, pulse, bend, unbend, ramp, push, coast, brake, halt };

  // In counts: seen to move by a pulse; moved at the end of a ramp; moved by something else than the drive.
  static constexpr Scalar pulse_counts = 3, ramp_counts = 8, drift_counts = 3;
  static constexpr Scalar share_of_force = Scalar(0.9), share_of_speed = Scalar(0.4);
  static constexpr Scalar hops = 12;  // of a sweep
  static constexpr Scalar longest_halt_s = 2;
  static constexpr std::uint32_t good_pairs = 8, most_pairs = 40;
  static constexpr Scalar bends_a_second = 4;

  // Time in which whatever the drive was told has happened.
  std::size_t reach() const noexcept {
    return static_cast<std::size_t>(std::clamp(Scalar(0.006) / p_.period_s, Scalar{8}, most_reach));
  }
  Scalar reach_s() const noexcept { return static_cast<Scalar>(reach()) * p_.period_s; }
  static constexpr Scalar most_reach = static_cast<Scalar>(TravelGuard<Scalar>::most_reach);
  Scalar travel_m() const noexcept { return p_.highest_m - p_.lowest_m; }
  Scalar counts_m(Scalar counts) const noexcept { return counts * p_.encoder_resolution_m; }
  TravelGuard<Scalar> new_guard() const noexcept {
    // A load leads its motor on its spring.
    const Scalar margin_m = std::max(counts_m(20), travel_m() * (p_.load_on_spring ? Scalar(0.03) : Scalar(0.01)));
    return {p_.lowest_m, p_.highest_m, margin_m, reach_s(), reach()};
  }
  std::uint32_t in_periods(Scalar seconds, std::uint32_t least) const noexcept {
    return std::max(least, static_cast<std::uint32_t>(seconds / p_.period_s));
  }
  Scalar whole_steps(Scalar force_N) const noexcept {
    const Scalar most = std::floor(p_.max_force_N / p_.force_step_N * (1 + 4 * std::numeric_limits<Scalar>::epsilon()));
    return p_.force_step_N * law::limited(std::round(force_N / p_.force_step_N), most);
  }

  Scalar next_force_N(const law::Measurement<Scalar>& z) noexcept {
    if (!take(z)) return 0;
    if (stage_ == Stage::over) return act();
    if (++periods_ >= in_periods(p_.duration_s - 1, 1)) end(Ending::out_of_time);
    const bool moved = std::abs(watch_.position_m() - begin_m_) > counts_m(drift_counts);
    if (stage_ == Stage::rest && moved && action_periods_ >= wait_periods_) end_restless();
    if (action_ != Action::halt && must_brake()) begin(Action::halt), interrupted_ = true;
    const Scalar force_N = act();
    return fault() == law::ControlFault::none ? force_N : Scalar{0};  // which acting on may have brought
  }

  bool take(const law::Measurement<Scalar>& z) noexcept {
    if (fault() != law::ControlFault::none) return false;
    if (!z.fresh) {
      if (begun_) watch_.skip();
    } else if (!std::isfinite(z.position_error_m)) {
      end(Ending::not_a_number);
      return false;
    } else if (begun_) {
      watch_.sample(z.position_error_m);
    } else {
      set_off(z.position_error_m);
    }
    guard_.moved(watch_.last_step_m());
    if (watch_.still_periods() >= patience()) guard_.restart();
    return begun_;
  }

  void set_off(Scalar position_m) noexcept {
    begun_ = true;
    watch_.begin(position_m);
    begin_m_ = position_m;
    wait(in_periods(Scalar(0.1), 50));
    pulse_N_ = p_.max_force_N / 200;
    const bool inside = guard_.room_m(position_m, 1) > 0 && guard_.room_m(position_m, -1) > 0;
    if (!inside || !(travel_m() >= counts_m(1000))) end(Ending::no_room);
  }

  // An axis that stood still for so long rests, for friction stops what is slower than a count within.
  // Where a load swings, it is a whole swing at 20 Hz.
  std::uint32_t patience() const noexcept { return in_periods(Scalar(p_.load_on_spring ? 0.05 : 0.01), 20); }
  bool still() const noexcept { return watch_.still_periods() >= patience(); }

  // Braking

  Scalar braking_N() const noexcept {
    if (p_.load_on_spring && highest_breakaway_N_ > 0)
      return std::min(3 * highest_breakaway_N_, share_of_force * p_.max_force_N);
    return mass_kg_ > 0 ? share_of_force * p_.max_force_N : std::max(greatest_N_, p_.force_step_N);
  }
  bool must_brake() const noexcept {
    return guard_.must_brake(watch_.position_m(), watch_.speed_now_m_s(), watch_.acceleration_m_s2(), braking_N());
  }
  // Against the motion, and less the slower it is, so that what acts late does not turn it round.
  Scalar force_to_rest_N() noexcept {
    if (still()) at_rest_ = true;
    if (at_rest_ || action_s() > longest_halt_s) return 0;
    if (p_.load_on_spring || !(mass_kg_ > 0)) return one_way_to_rest_N();
    return -law::limited(mass_kg_ * watch_.speed_now_m_s() / (2 * reach_s()), braking_N());
  }

  // A force that followed the motor's swings late would drive them, and so would one that follows late where an axis of
  // unknown mass turns. So there is one against the motion as it was until the axis turns, and again only where it gets
  // further than where it turned.
  Scalar one_way_to_rest_N() noexcept {
    const Scalar speed_m_s = watch_.speed_m_s(), here_m = watch_.position_m();
    if (halted_way_ == 0 && speed_m_s != 0) halted_way_ = std::copysign(Scalar{1}, speed_m_s);
    if (turned_ && halted_way_ * (here_m - furthest_m_) > counts_m(8) && must_brake()) turned_ = false;
    if (!turned_ && halted_way_ * speed_m_s < 0) turned_ = true, furthest_m_ = watch_.furthest_m(halted_way_);
    return turned_ ? Scalar{0} : -halted_way_ * braking_N();
  }

  void end(Ending ending) noexcept {
    if (stage_ == Stage::over) return;
    stage_ = Stage::over;
    ending_ = ending;
    begin(Action::halt);
  }

  // It is not still though no force is given.
  void end_restless() noexcept { end(watch_.jumps() ? Ending::noisy : Ending::drifting); }

  // Actions: each gives the force of a period, and says what comes next when it is over.

  void begin(Action action) noexcept {
    action_ = action;
    action_periods_ = 0;
    start_m_ = watch_.position_m();
    at_rest_ = turned_ = false;
    halted_way_ = 0;
  }
  void wait(std::uint32_t periods) noexcept {
    begin(Action::wait);
    wait_periods_ = periods;
    watch_.expect_no_jump();
  }
  Scalar action_s() const noexcept { return static_cast<Scalar>(action_periods_) * p_.period_s; }
  Scalar moved_m() const noexcept { return std::abs(watch_.position_m() - start_m_); }

  Scalar act() noexcept {
    ++action_periods_;
    switch (action_) {
      case Action::wait:
        return act_wait();
      case Action::pulse:
        if (action_periods_ >= pulse_periods_) wait(patience());
        return direction_ * pulse_N_;
      case Action::bend:
        return act_bend();
      case Action::unbend:
        return act_unbend();
      case Action::ramp:
        return act_ramp();
      case Action::push:
        if (pushed_enough()) note_push(), go_on();
        return direction_ * push_N_;
      case Action::coast:
        if (still() || action_s() > 1) go_on();
        return 0;
      case Action::brake:
        if (braked_enough()) wait(patience());
        return -direction_ * push_N_;
      case Action::halt: {
        const Scalar force_N = force_to_rest_N();
        if (stage_ != Stage::over && (at_rest_ || action_s() > longest_halt_s)) wait(patience());
        return force_N;
      }
    }
    return 0;
  }

  Scalar act_wait() noexcept {
    if (watch_.still_periods() >= wait_periods_ && action_periods_ >= wait_periods_)
      go_on();
    else if (action_s() > 10)
      end_restless();
    return 0;
  }

  // One that bends before it slides follows the ramp slowly. A motor leads its load by less than it moves here.
  bool slides() const noexcept {
    constexpr auto span = static_cast<Scalar>(MotionWatch<Scalar>::span);
    const bool fast = std::abs(watch_.speed_m_s()) * span * p_.period_s >= counts_m(2);
    const Scalar least_m = counts_m(ramp_counts);
    return fast && moved_m() >= (p_.load_on_spring ? std::max(travel_m() / 200, least_m) : least_m);
  }

  // The motor creeps on along the spring, and then back, under a force that the load holds.
  Scalar bending_N() const noexcept { return Scalar(0.85) * std::min(breakaway_N_[0], breakaway_N_[1]); }
  Scalar act_bend() noexcept {
    const Scalar force_N = bends_a_second * bending_N() * action_s();
    if (slides()) return end_of_bend();
    if (force_N >= bending_N()) begin(Action::unbend);
    return direction_ * force_N;
  }
  Scalar act_unbend() noexcept {
    const Scalar force_N = bending_N() * (1 - bends_a_second * action_s());
    if (slides()) return end_of_bend();
    if (force_N <= -bending_N()) begin(Action::ramp);
    return direction_ * force_N;
  }
  // The load broke away as well: the next hop does without.
  Scalar end_of_bend() noexcept {
    bends_ = false;
    begin(Action::halt);
    return 0;
  }

  // From half of the least force that broke the axis away in this direction so far.
  Scalar act_ramp() noexcept {
    const Scalar known_N = breakaway_N();
    const Scalar rate_N_s = known_N > 0 ? known_N : pulse_N_ / 2;
    const Scalar force_N = known_N / 2 + rate_N_s * action_s();
    if (slides()) {
      breakaway_N() = known_N > 0 ? std::min(known_N, force_N) : force_N;
      highest_breakaway_N_ = std::max(highest_breakaway_N_, force_N);
      go_on();
    } else if (force_N > p_.max_force_N) {
      end(Ending::jammed);
    }
    return direction_ * force_N;
  }

  bool pushed_enough() const noexcept {
    return moved_m() >= push_m_ || direction_ * watch_.speed_now_m_s() >= share_of_speed * p_.max_speed_m_s ||
           action_s() > 1;
  }
  // Friction while it slides is seldom above that at rest, so the axis is seldom lighter.
  void note_push() noexcept {
    push_periods_ = action_periods_;
    const Scalar a_m_s2 = direction_ * watch_.acceleration_m_s2();
    const bool settled = action_periods_ > 2 * MotionWatch<Scalar>::span + reach();
    if (settled && a_m_s2 > 0) mass_kg_ = std::max(push_N_ - highest_breakaway_N_, push_N_ / 8) / a_m_s2;
  }
  bool braked_enough() const noexcept {
    const Scalar slowed_m_s = mass_kg_ > 0 ? (push_N_ + highest_breakaway_N_) / mass_kg_ * reach_s() / 2 : Scalar{0};
    return direction_ * watch_.speed_now_m_s() <= slowed_m_s;
  }

  // The plan

  void go_on() noexcept {
    switch (stage_) {
      case Stage::rest:
        stage_ = Stage::pulses;
        return begin_pulse();
      case Stage::pulses:
        return after_pulse();
      case Stage::ramps:
        return after_ramp();
      case Stage::pairs:
        return action_ == Action::push ? begin(Action::brake) : next_pair();
      case Stage::sweep:
        return next_of_hop();
      case Stage::over:
        return;
    }
  }

  void after_pulse() noexcept {
    if (std::abs(watch_.position_m() - pulse_start_m_) >= counts_m(pulse_counts)) pulsed(direction_) = true;
    if (pulsed(1) && pulsed(-1)) {
      stage_ = Stage::ramps;
      direction_ = 1;
      return begin(Action::ramp);
    }
    do {  // twice at most: one direction is left
      if (direction_ < 0 && !grow_pulse()) return end(Ending::jammed);
      direction_ = -direction_;
    } while (pulsed(direction_));
    begin_pulse();
  }
  void begin_pulse() noexcept {
    pulse_start_m_ = watch_.position_m();
    begin(Action::pulse);
  }
  // False: there is no greater one.
  bool grow_pulse() noexcept {
    if (pulse_N_ >= p_.max_force_N) {
      pulse_periods_ *= 2;
      pulse_N_ = p_.max_force_N / 4;
    } else {
      pulse_N_ = std::min(pulse_N_ * Scalar(1.3), p_.max_force_N);
    }
    return pulse_periods_ <= 64;
  }

  void after_ramp() noexcept {
    if (action_ == Action::ramp) return wait(patience());
    if (direction_ > 0) {
      direction_ = -1;
      return begin(Action::ramp);
    }
    if (p_.load_on_spring) return begin_sweep();
    stage_ = Stage::pairs;
    push_N_ = whole_steps(std::min(Scalar(1.5) * highest_breakaway_N_, share_of_force * p_.max_force_N));
    next_pair();
  }

  void next_pair() noexcept {
    const bool whole = !interrupted_;
    interrupted_ = false;
    if (pairs_ > 0 && growing_ && whole)
      grow_pair();
    else if (!growing_ && whole)
      ++repeated_;
    if (repeated_ > good_pairs || ++pairs_ > most_pairs) return begin_sweep();
    direction_ =
        guard_.room_m(watch_.position_m(), 1) > guard_.room_m(watch_.position_m(), -1) ? Scalar{1} : Scalar{-1};
    push_m_ = travel_m() / 8;
    begin(Action::push);
  }
  // Until a pair is short, for then friction has no room to change in it; but it must be long enough for a speed.
  void grow_pair() noexcept {
    const Scalar most_N = share_of_force * p_.max_force_N;
    const bool too_short = push_periods_ < 40 && push_N_ > Scalar(1.6) * highest_breakaway_N_;
    growing_ = !too_short && push_periods_ > 60 && push_N_ < Scalar(0.98) * most_N;
    if (too_short) push_N_ /= Scalar(1.4);
    if (growing_) push_N_ = std::min(Scalar(1.5) * push_N_, most_N);
    push_N_ = whole_steps(push_N_);
  }

  // To the nearer end, to the other one, and back to where it began.
  void begin_sweep() noexcept {
    stage_ = Stage::sweep;
    const Scalar here_m = watch_.position_m();
    direction_ = guard_.room_m(here_m, 1) < guard_.room_m(here_m, -1) ? Scalar{1} : Scalar{-1};
    sweep_start_m_ = here_m;
    push_N_ = whole_steps(std::min(3 * highest_breakaway_N_, share_of_force * p_.max_force_N));
    // A push by this share of a hop has the energy for the rest.
    push_m_ = travel_m() / hops * highest_breakaway_N_ / push_N_;
    start_hop();
  }
  void start_hop() noexcept {
    const bool at_end = interrupted_ || guard_.room_m(watch_.position_m(), direction_) < travel_m() / hops / 2;
    interrupted_ = false;
    if (at_end) {
      direction_ = -direction_;
      ++turns_;
    }
    if (turns_ > 2 || (turns_ == 2 && direction_ * (watch_.position_m() - sweep_start_m_) >= 0))
      return end(Ending::complete);
    begin(p_.load_on_spring && bends_ ? Action::bend : Action::ramp);
    bends_ = true;
  }
  void next_of_hop() noexcept {
    if (action_ == Action::ramp) return begin(Action::push);
    if (action_ == Action::push) return begin(Action::coast);
    if (action_ == Action::coast && !still()) return begin(Action::brake);
    if (action_ == Action::coast) return wait(patience());
    start_hop();
  }

  Scalar& breakaway_N() noexcept { return breakaway_N_[direction_ > 0 ? 1 : 0]; }
  bool& pulsed(Scalar direction) noexcept { return pulsed_[direction > 0 ? 1 : 0]; }

  Parameters p_;
  MotionWatch<Scalar> watch_;
  TravelGuard<Scalar> guard_;
  Stage stage_ = Stage::rest;
  Ending ending_ = Ending::none;
  Action action_ = Action::wait;
  bool begun_ = false, at_rest_ = false, interrupted_ = false, growing_ = true;
  bool pulsed_[2] = {false, false};
  bool turned_ = false;  // since it halts
  bool bends_ = true;    // the next hop begins by that
  Scalar direction_ = 1, halted_way_ = 0;
  std::uint32_t periods_ = 0, action_periods_ = 0, wait_periods_ = 0;
  std::uint32_t pulse_periods_ = 2, push_periods_ = 0, pairs_ = 0, repeated_ = 0, turns_ = 0;
  Scalar begin_m_{}, start_m_{}, furthest_m_{}, pulse_start_m_{}, sweep_start_m_{};
  Scalar pulse_N_{}, push_N_{}, push_m_{};
  Scalar greatest_N_{};             // commanded so far
  Scalar breakaway_N_[2] = {0, 0};  // the least that a ramp took, downwards and upwards
  Scalar highest_breakaway_N_{};    // either way
  Scalar mass_kg_{};                // a rough value for braking; 0: unknown
};

}  // namespace breakaway::identify
