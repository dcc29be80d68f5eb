// KickCoordinator: axes that push each other are brought near their targets together, let go, and kicked to them one
// after another.
//
//   approach  every axis: u = -P z - D (z - z before)/T, until none of them moves and each is within its gate
//   release   u = 0, until the machine is sure to rest
//   pulse     the kicked axis: a force towards its target for whole periods; every other one: k (F - (A + B)/2), which
//             takes the middle of what the kick asks of it off its friction
//   coast     the kicked axis: its brake; every other one: -k (B + b)/2
//   rest      u = 0, until the readings are of the machine at rest
//   hold      every axis is within its tolerance: u = 0
//
// What breakaway::stability::certify_machine() certifies is this, with these numbers. No kick looks at a measurement
// after its start. What is chosen once the last axis was asked acts from the next period on, for all axes alike: a
// hold-off force that came a period before its kick would itself move the axis. The work of a period is bounded;
// nothing is allocated.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "breakaway/law/control_types.hpp"

namespace breakaway::law {

// One axis of a machine. SI units; A, B and b as in Theorem S: least and greatest friction with all that acts beside
// it.
template <class Scalar>
struct CoordinatedAxisParameters {
  Scalar position_gain_N_per_m{};   // P
  Scalar velocity_gain_Ns_per_m{};  // D
  Scalar mass_kg{};                 // the least that it may be, M_ii
  Scalar lower_N{};                 // A > brake_N
  Scalar upper_N{};                 // B >= A
  Scalar sure_N{};                  // > B, a force that is sure to move the axis
  Scalar brake_N{};                 // b >= 0
  Scalar kick_N{};                  // the most that a kick may have; 0: the axis is never kicked
  Scalar max_force_N{};
  Scalar gate_m{};       // a reading within it lets the release begin
  Scalar tolerance_m{};  // of the reading
  Scalar resolution_m{};
};

// The first `count` of the axes are there. hold_off[i][j] is k_j of a kick of axis i.
template <class Scalar, std::size_t Axes>
struct CoordinatorParameters {
  Scalar period_s{};
  std::uint8_t count = Axes;
  std::uint8_t settling_periods = 2;  // from a force to a reading of what it has done: latency, and the current loops
  std::uint8_t still_periods = 8;
  std::uint16_t release_periods = 0;
  std::uint32_t most_kicks = 0;  // from one release to the hold
  std::array<CoordinatedAxisParameters<Scalar>, Axes> axes{};
  std::array<std::array<Scalar, Axes>, Axes> hold_off{};
};

enum class CoordinatorPhase : std::uint8_t { approach, release, pulse, coast, rest, hold, fault };

// How a hold was reached.
enum class CoordinatorEnd : std::uint8_t {
  none,         // not yet
  on_target,    // every axis is within its tolerance
  below_floor,  // an axis is not, and no force that is sure to move it goes as little as that
};

template <class Scalar, std::size_t Axes>
class KickCoordinator {
 public:
  using Parameters = CoordinatorParameters<Scalar, Axes>;

  // `parameters` must outlive it.
  explicit KickCoordinator(const Parameters& parameters) noexcept
      : p_{&parameters},
        count_{std::min<std::size_t>(parameters.count, Axes)},
        all_{count_ < 32 ? (std::uint32_t{1} << count_) - 1 : ~std::uint32_t{0}} {
    for (std::size_t i = 0; i < count_; ++i) prepare(i);
  }

  // Takes the reading of one axis, and gives its force of the next period. To be called once a period for every axis,
  // in their order.
  ControlOutput<Scalar> update(std::size_t axis, const Measurement<Scalar>& z) noexcept {
    if (axis >= count_) return {};
    take_turn(axis);
    see(axis, z);
    const ControlOutput<Scalar> output = output_of(axis);
    if (seen_ == all_) {
      decide();
      seen_ = 0;
      fresh_ = true;
    }
    return output;
  }

  void shift_target(std::size_t axis, Scalar shift_m) noexcept {
    if (axis >= count_) return;
    state_[axis].reading_m -= shift_m;
    if (fault_ == ControlFault::none) approach();
  }

  void reset(std::size_t axis) noexcept {
    if (axis >= count_) return;
    state_[axis].primed = false;
    state_[axis].force_N = 0;
    state_[axis].limit_N = p_->axes[axis].max_force_N;
    fault_ = ControlFault::none;
    approach();
    start_again();
  }

  void limit_force(std::size_t axis, Scalar force_N) noexcept {
    if (axis < count_) state_[axis].limit_N = std::min(state_[axis].limit_N, force_N);
  }

  CoordinatorPhase phase() const noexcept { return phase_; }
  CoordinatorEnd end() const noexcept { return end_; }
  ControlFault fault() const noexcept { return fault_; }
  std::size_t kicked() const noexcept { return kicked_; }  // the axis of the last kick
  // Which axis showed the fault `contradicted`: the kicked one went beyond its target, or another one moved.
  std::size_t moved() const noexcept { return moved_; }
  std::uint32_t kicks() const noexcept { return kicks_; }  // since the last release
  const Parameters& parameters() const noexcept { return *p_; }

 private:
  struct State {
    Scalar reading_m{};
    Scalar change_m{};
    Scalar force_N{};  // of the last period in the approach, and of the next one in all that follows
    Scalar limit_N{};
    Scalar at_kick_m{};
    Scalar per_one_period_m{};  // 1 / the way of the largest kick of one period
    bool primed = false;
  };

  void prepare(std::size_t i) noexcept {
    const auto& a = p_->axes[i];
    State& s = state_[i];
    s.limit_N = a.max_force_N;
    const Scalar way_m = (a.kick_N - a.lower_N) * (a.kick_N + a.brake_N) * p_->period_s * p_->period_s /
                         (2 * a.mass_kg * (a.lower_N + a.brake_N));
    s.per_one_period_m = way_m > 0 ? 1 / way_m : Scalar{0};
  }

  // A period begins with the first axis. Where one is left out, or asked before those in front of it, it does not run
  // with the others, and all go back to the approach.
  void take_turn(std::size_t axis) noexcept {
    const std::uint32_t bit = std::uint32_t{1} << axis;
    if (seen_ != bit - 1) start_again();
    if (seen_ == bit - 1) seen_ |= bit;
  }

  void see(std::size_t axis, const Measurement<Scalar>& z) noexcept {
    State& s = state_[axis];
    if (!z.fresh) {
      fresh_ = false;
      return;
    }
    if (!(std::abs(z.position_error_m) <= std::numeric_limits<Scalar>::max())) return fail(ControlFault::not_a_number);
    s.change_m = s.primed ? z.position_error_m - s.reading_m : Scalar{0};
    s.reading_m = z.position_error_m;
    s.primed = true;
    if (phase_ != CoordinatorPhase::approach) return;
    const auto& a = p_->axes[axis];
    s.force_N = limited(-a.position_gain_N_per_m * s.reading_m - a.velocity_gain_Ns_per_m * s.change_m / p_->period_s,
                        s.limit_N);
    // Another count may show at the edge of one; two do not.
    const bool still = std::abs(s.change_m) <= a.resolution_m * Scalar(1.5) && std::abs(s.reading_m) <= a.gate_m;
    all_still_ = all_still_ && still;
  }

  ControlOutput<Scalar> output_of(std::size_t axis) const noexcept {
    if (fault_ != ControlFault::none) return {Scalar{0}, Scalar{0}, Mode::fault, false};
    const bool pulse = phase_ == CoordinatorPhase::pulse && axis == kicked_;
    return {state_[axis].force_N, Scalar{0}, mode_of(pulse), pulse && pulse_starts_};
  }

  Mode mode_of(bool pulse) const noexcept {
    if (phase_ == CoordinatorPhase::approach) return Mode::approach;
    if (phase_ == CoordinatorPhase::hold) return Mode::hold;
    return pulse ? Mode::kick : Mode::coast;
  }

  // Of the next period, once every axis was seen.
  void decide() noexcept {
    pulse_starts_ = false;
    switch (phase_) {
      case CoordinatorPhase::approach:
        return watch_approach();
      case CoordinatorPhase::release:
        if (elapsed()) choose();
        return;
      case CoordinatorPhase::pulse:
        if (elapsed()) coast();
        return;
      case CoordinatorPhase::coast:
        if (elapsed()) rest();
        return;
      case CoordinatorPhase::rest:
        if (elapsed() && fresh_) judge_kick();
        return;
      case CoordinatorPhase::hold:
        if (fresh_) watch_hold();
        return;
      case CoordinatorPhase::fault:
        return;
    }
  }

  bool elapsed() noexcept {
    if (left_ > 0) --left_;
    return left_ == 0;
  }

  void approach() noexcept {
    phase_ = CoordinatorPhase::approach;
    end_ = CoordinatorEnd::none;
    still_ = 0;
    all_still_ = true;
    pulse_starts_ = false;
  }

  void start_again() noexcept {
    seen_ = 0;
    fresh_ = true;
    if (fault_ == ControlFault::none && phase_ != CoordinatorPhase::approach) approach();
    still_ = 0;
    all_still_ = true;
  }

  void watch_approach() noexcept {
    still_ = all_still_ && fresh_ ? still_ + 1 : 0;
    all_still_ = true;
    if (still_ < p_->still_periods) return;
    let_go();
    kicks_ = 0;
    left_ = std::max<std::uint32_t>(p_->release_periods, 1);
    phase_ = CoordinatorPhase::release;
  }

  void let_go() noexcept {
    for (std::size_t i = 0; i < count_; ++i) state_[i].force_N = 0;
  }

  bool outside_tolerance(std::size_t i) const noexcept {
    return p_->axes[i].kick_N > 0 && std::abs(state_[i].reading_m) > p_->axes[i].tolerance_m;
  }

  // Something pushed an axis that was held.
  void watch_hold() noexcept {
    bool outside = false, far = false;
    for (std::size_t i = 0; i < count_; ++i) {
      const bool out = outside_tolerance(i) && end_ == CoordinatorEnd::on_target;
      outside = outside || out;
      far = far || std::abs(state_[i].reading_m) > p_->axes[i].gate_m;
    }
    if (far) return approach();
    if (!outside) return;
    kicks_ = 0;
    choose();
  }

  // The axis that was kicked goes on until it is there, and then the next one has its turn.
  void choose() noexcept {
    end_ = CoordinatorEnd::on_target;
    for (std::size_t turn = 0; turn < count_; ++turn) {
      const std::size_t i = kicked_ + turn < count_ ? kicked_ + turn : kicked_ + turn - count_;
      if (outside_tolerance(i) && kick(i)) return;
      if (fault_ != ControlFault::none) return;
    }
    let_go();
    phase_ = CoordinatorPhase::hold;
  }

  // False where no force that is sure to move the axis goes as little.
  bool kick(std::size_t i) noexcept {
    const auto& a = p_->axes[i];
    const Scalar aim_m = std::abs(state_[i].reading_m) - a.resolution_m / 2;
    std::uint8_t n = periods_for(std::sqrt(aim_m * state_[i].per_one_period_m));
    const Scalar g = a.lower_N + a.brake_N, time_s = n * p_->period_s;
    Scalar wanted_N = ((a.lower_N - a.brake_N) + std::sqrt(g * g + 8 * a.mass_kg * g * aim_m / (time_s * time_s))) / 2;
    // So many periods need less force than is sure to move the axis: one less with all that there is stops short.
    if (wanted_N < a.sure_N && n > 1) {
      --n;
      wanted_N = a.kick_N;
    }
    const Scalar force_N = std::min({wanted_N, a.kick_N, state_[i].limit_N});
    if (!(force_N >= a.sure_N)) {
      if (!(wanted_N >= a.sure_N)) end_ = CoordinatorEnd::below_floor;
      if (wanted_N >= a.sure_N) fail(ControlFault::jammed);  // the drive no longer gives what moves the axis
      return false;
    }
    if (kicks_ >= p_->most_kicks) {
      fail(ControlFault::hunting);
      return false;
    }
    ++kicks_;
    kicked_ = i;
    direction_ = state_[i].reading_m > 0 ? Scalar{-1} : Scalar{1};
    coast_periods_ = whole((force_N - a.lower_N) * n / g) + p_->settling_periods;
    push(force_N, force_N - (a.lower_N + a.upper_N) / 2);
    left_ = n;
    pulse_starts_ = true;
    phase_ = CoordinatorPhase::pulse;
    return true;
  }

  // The force of the kicked axis, and of the others for each unit of k.
  void push(Scalar force_N, Scalar held_N) noexcept {
    for (std::size_t j = 0; j < count_; ++j) {
      state_[j].force_N = limited(direction_ * held_N * p_->hold_off[kicked_][j], state_[j].limit_N);
      if (phase_ != CoordinatorPhase::coast) state_[j].at_kick_m = state_[j].reading_m;
    }
    state_[kicked_].force_N = direction_ * force_N;
  }

  void coast() noexcept {
    const auto& a = p_->axes[kicked_];
    phase_ = CoordinatorPhase::coast;
    left_ = coast_periods_;
    push(-a.brake_N, -(a.upper_N + a.brake_N) / 2);
  }

  void rest() noexcept {
    let_go();
    left_ = p_->settling_periods;
    phase_ = CoordinatorPhase::rest;
  }

  // No other axis moved, and none went beyond: else the machine is not what was certified.
  void judge_kick() noexcept {
    for (std::size_t j = 0; j < count_; ++j) {
      const State& s = state_[j];
      const Scalar most_m = p_->axes[j].resolution_m * Scalar(1.5);
      const bool held = std::abs(s.reading_m - s.at_kick_m) <= most_m;
      const bool lawful = j == kicked_ ? s.reading_m * direction_ <= most_m : held;
      if (lawful) continue;
      moved_ = j;
      return fail(ControlFault::contradicted);
    }
    choose();
  }

  void fail(ControlFault fault) noexcept {
    if (fault_ == ControlFault::none) fault_ = fault;
    phase_ = CoordinatorPhase::fault;
    let_go();
  }

  static std::uint8_t periods_for(Scalar exact) noexcept {
    constexpr Scalar most = 255;
    if (!(exact > 1)) return 1;
    return exact < most ? static_cast<std::uint8_t>(whole(exact)) : std::uint8_t{255};
  }
  // Rounds up.
  static std::uint32_t whole(Scalar periods) noexcept {
    constexpr Scalar most = 65535;
    if (!(periods < most)) return 65535;
    const auto down = static_cast<std::uint32_t>(periods);
    return static_cast<Scalar>(down) < periods ? down + 1 : down;
  }

  const Parameters* p_;
  std::size_t count_;
  std::uint32_t all_;
  std::uint32_t seen_ = 0;  // bit i: axis i was asked in this period, and all in front of it
  std::array<State, Axes> state_{};
  CoordinatorPhase phase_ = CoordinatorPhase::approach;
  CoordinatorEnd end_ = CoordinatorEnd::none;
  ControlFault fault_ = ControlFault::none;
  std::size_t kicked_ = 0, moved_ = 0;
  Scalar direction_ = 1;
  std::uint32_t left_ = 0, coast_periods_ = 0, kicks_ = 0, still_ = 0;
  bool all_still_ = true, fresh_ = true, pulse_starts_ = false;
};

// One axis of a coordinator, as the law that a control loop asks. The coordinator must outlive it.
template <class Scalar, std::size_t Axes>
class CoordinatedAxis {
 public:
  using Coordinator = KickCoordinator<Scalar, Axes>;

  CoordinatedAxis(Coordinator& coordinator, std::size_t axis) noexcept
      : coordinator_{&coordinator}, axis_{axis < Axes ? axis : 0} {}

  ControlOutput<Scalar> update(const Measurement<Scalar>& z) noexcept { return coordinator_->update(axis_, z); }
  void shift_target(Scalar shift_m) noexcept { coordinator_->shift_target(axis_, shift_m); }
  void reset() noexcept { coordinator_->reset(axis_); }
  void limit_force(Scalar force_N) noexcept { coordinator_->limit_force(axis_, force_N); }

  Scalar period_s() const noexcept { return coordinator_->parameters().period_s; }
  Scalar encoder_resolution_m() const noexcept { return mine().resolution_m; }
  Scalar max_force_N() const noexcept { return mine().max_force_N; }
  ControlFault fault() const noexcept { return coordinator_->fault(); }
  Mode mode() const noexcept {
    if (fault() != ControlFault::none) return Mode::fault;
    const CoordinatorPhase phase = coordinator_->phase();
    if (phase == CoordinatorPhase::hold) return Mode::hold;
    return phase == CoordinatorPhase::approach ? Mode::approach : Mode::coast;
  }
  const Coordinator& coordinator() const noexcept { return *coordinator_; }

 private:
  const CoordinatedAxisParameters<Scalar>& mine() const noexcept { return coordinator_->parameters().axes[axis_]; }

  Coordinator* coordinator_;
  std::size_t axis_;
};

}  // namespace breakaway::law
