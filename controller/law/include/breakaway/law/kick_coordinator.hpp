// KickCoordinator: axes that push each other are brought near their targets together, let go, and kicked to them one
// after another.
//
//   gather    u = 0, until every axis was asked in one period
//   approach  every axis: u = -P z - D (z - z before)/T, until none of them moves and each is within its gate; one that
//             stays beyond it while none moves is jammed, or its encoder shows nothing
//   release   u = 0, until the machine is sure to rest
//   choice    u = 0; of the axes that are off their targets one is looked at in a period, each in its turn
//   pulse     the kicked axis: a force towards its target for whole periods; every other one: k (F - (A + B)/2), which
//             takes the middle of what the kick asks of it off its friction
//   coast     the kicked axis: its brake; every other one: -k (B + b)/2
//   rest      u = 0, until the readings are of the machine at rest
//   hold      every axis is within its tolerance: u = 0
//
// The axes move together or not at all: where one of them is not asked in its turn, because it was stopped, or has a
// fault of its own, the others get no force from then on, until all are asked again.
//
// What breakaway::stability::certify_machine() certifies is this, with these numbers. No kick looks at a measurement
// after its start. What is chosen once the last axis was asked acts from the next period on, for all axes alike: a
// hold-off force that came a period before its kick would itself move the axis. The work of a period is bounded: each
// axis does its own in its own turn, and closing the period takes as long for eight axes as for one. Nothing is
// allocated.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "breakaway/law/control_types.hpp"
#include "breakaway/law/coordinator_parameters.hpp"

namespace breakaway::law {

enum class CoordinatorPhase : std::uint8_t { gather, approach, release, choice, pulse, coast, rest, hold, fault };

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
  static_assert(Axes >= 1 && Axes <= 32, "each axis has a bit of a word");

  // `parameters` must outlive it.
  explicit KickCoordinator(const Parameters& parameters) noexcept
      : p_{&parameters},
        count_{std::min<std::size_t>(parameters.count, Axes)},
        all_{count_ < 32 ? bit(count_) - 1 : ~Word{0}} {
    for (std::size_t i = 0; i < count_; ++i) prepare(i);
    patience_ = whole(4 * slowest_s_ / p_->period_s) + 2 * std::uint32_t{p_->release_periods} + p_->still_periods;
  }

  // Takes the reading of one axis, and gives its force of the next period. To be called once a period for every axis,
  // in their order.
  ControlOutput<Scalar> update(std::size_t axis, const Measurement<Scalar>& z) noexcept {
    if (axis >= count_) return {};
    const Word before = bit(axis) - 1;
    if (seen_ != before) lose_step();
    if (seen_ == before) seen_ |= bit(axis);
    const ControlOutput<Scalar> output = own_step(axis, z);
    if (seen_ == all_) close_period();
    return output;
  }

  void shift_target(std::size_t axis, Scalar shift_m) noexcept {
    if (axis >= count_) return;
    state_[axis].reading_m -= shift_m;
    if (fault_ == ControlFault::none && phase_ != CoordinatorPhase::gather) approach();
  }

  void reset(std::size_t axis) noexcept {
    if (axis >= count_) return;
    primed_ &= ~bit(axis);
    weak_ &= ~bit(axis);
    state_[axis].limit_N = p_->axes[axis].max_force_N;
    fault_ = shown_fault_ = ControlFault::none;
    gather();
  }

  void limit_force(std::size_t axis, Scalar force_N) noexcept {
    if (axis >= count_) return;
    state_[axis].limit_N = std::min(state_[axis].limit_N, force_N);
    for (std::size_t kicked = 0; kicked < count_; ++kicked) {
      const auto& a = p_->axes[kicked];
      if (a.kick_N > 0 && std::abs(a.hold_off[axis]) * internal::largest_hold_off_N(a) > force_N) weak_ |= bit(axis);
    }
  }

  CoordinatorPhase phase() const noexcept { return phase_; }
  CoordinatorEnd end() const noexcept { return end_; }
  ControlFault fault() const noexcept { return fault_; }
  // The same from the end of the period in which it was seen, so that all axes show it at once: where one fails in its
  // turn, the next one in the same period would be named for it.
  ControlFault shown_fault() const noexcept { return shown_fault_; }
  std::size_t kicked() const noexcept { return kicked_; }  // the axis of the last kick
  // Which axis showed the fault `contradicted`: the kicked one went beyond its target, or another one moved.
  std::size_t moved() const noexcept { return moved_; }
  std::uint32_t kicks() const noexcept { return kicks_; }  // since the last release
  const Parameters& parameters() const noexcept { return *p_; }

 private:
  using Word = std::uint32_t;  // bit i is of axis i

  // Of an axis, in every period.
  struct State {
    Scalar reading_m{};
    Scalar force_N{};  // of the approach
    Scalar limit_N{};
    Scalar stood_m{};            // as its kick began; in the approach, where it was seen to leave
    Scalar stiffness_N_per_m{};  // P
    Scalar damping_N_per_m{};    // D/T
    Scalar gate_m{};
    Scalar count_m{};          // another count may show at the edge of one; this is less than two
    Scalar allowed_m{};        // the tolerance; none where the axis is never kicked
    std::uint32_t stands = 0;  // periods in which it did not leave its place beyond its gate
  };

  // What was rounded on the way to a force is less than this, so that no kick goes further than it aims.
  static constexpr Scalar rounded_down = 1 - 8 * std::numeric_limits<Scalar>::epsilon();

  // What its kicks need of an axis' parameters, once for all.
  struct Prepared {
    Scalar per_one_period_m{};  // 1 / the way of the largest kick of one period
    Scalar half_N{};            // (A - b)/2
    Scalar square_N2{};         // (g/2)^2, g = A + b
    Scalar per_metre_N2{};      // 2 m g/T^2
    Scalar per_g_N{};           // 1/g
    Scalar middle_N{};          // (A + B)/2
    Scalar coast_N{};           // -(B + b)/2
  };

  static constexpr Word bit(std::size_t axis) noexcept { return Word{1} << axis; }
  static void mark(Word& word, Word mine, bool marked) noexcept { word = marked ? word | mine : word & ~mine; }

  void prepare(std::size_t i) noexcept {
    const auto& a = p_->axes[i];
    const Scalar period_s = p_->period_s, g = a.lower_N + a.brake_N;
    const Scalar way_m = (a.kick_N - a.lower_N) * (a.kick_N + a.brake_N) * period_s * period_s / (2 * a.mass_kg * g);
    State& s = state_[i];
    s.limit_N = a.max_force_N;
    s.stiffness_N_per_m = a.position_gain_N_per_m;
    s.damping_N_per_m = a.velocity_gain_Ns_per_m / period_s;
    s.gate_m = a.gate_m;
    s.count_m = a.resolution_m * Scalar(1.5);
    s.allowed_m = a.kick_N > 0 ? a.tolerance_m : std::numeric_limits<Scalar>::max();
    prepared_[i] = {.per_one_period_m = way_m > 0 ? 1 / way_m : Scalar{0},
                    .half_N = (a.lower_N - a.brake_N) / 2,
                    .square_N2 = g * g / 4,
                    .per_metre_N2 = 2 * a.mass_kg * g / (period_s * period_s),
                    .per_g_N = 1 / g,
                    .middle_N = (a.lower_N + a.upper_N) / 2,
                    .coast_N = -(a.upper_N + a.brake_N) / 2};
    if (!(a.position_gain_N_per_m > 0)) return;
    const Scalar swing_s = std::sqrt(a.mass_kg / a.position_gain_N_per_m);
    slowest_s_ = std::max({slowest_s_, swing_s, a.velocity_gain_Ns_per_m / a.position_gain_N_per_m});
  }

  // A period begins with the first axis. Where one is left out, or asked before those in front of it, it does not run
  // with the others, and none of them has force.
  void lose_step() noexcept {
    if (fault_ == ControlFault::none) gather();
    shown_fault_ = fault_;
    seen_ = 0;
  }

  // What an axis does in its own turn.

  static bool is_number(Scalar reading_m) noexcept { return std::abs(reading_m) <= std::numeric_limits<Scalar>::max(); }

  ControlOutput<Scalar> draw_near(State& s, Word mine, const Measurement<Scalar>& z) noexcept {
    if (!z.fresh) return {(driven_ & mine) != 0 ? s.force_N : Scalar{0}, Scalar{0}, Mode::approach, false};
    if (!is_number(z.position_error_m)) return failed(ControlFault::not_a_number);
    const Scalar change_m = (primed_ & mine) != 0 ? z.position_error_m - s.reading_m : Scalar{0};
    s.reading_m = z.position_error_m;
    s.force_N = limited(-s.stiffness_N_per_m * s.reading_m - s.damping_N_per_m * change_m, s.limit_N);
    const bool begun = (driven_ & mine) != 0;
    primed_ |= mine;
    driven_ |= mine;
    heard_ |= mine;
    const bool beyond = !(std::abs(s.reading_m) <= s.gate_m);
    if (beyond || !(std::abs(change_m) <= s.count_m)) all_still_ = false;
    if (!begun || std::abs(s.reading_m - s.stood_m) > s.count_m) {
      s.stood_m = s.reading_m;
      stands_ = s.stands = 0;
    } else if (beyond && ++s.stands > 3 * patience_) {
      return failed(ControlFault::jammed);
    }
    return {s.force_N, Scalar{0}, Mode::approach, false};
  }

  // While a kick is under way no sample changes what happens.
  ControlOutput<Scalar> take_part(State& s, std::size_t axis, const Measurement<Scalar>& z) noexcept {
    if (z.fresh) {
      if (!is_number(z.position_error_m)) return failed(ControlFault::not_a_number);
      s.reading_m = z.position_error_m;
    }
    if (pulse_starts_) s.stood_m = s.reading_m;
    if (axis != kicked_)
      return {limited(held_N_ * p_->axes[kicked_].hold_off[axis], s.limit_N), Scalar{0}, Mode::coast, false};
    return {force_N_, Scalar{0}, phase_ == CoordinatorPhase::pulse ? Mode::kick : Mode::coast, pulse_starts_};
  }

  ControlOutput<Scalar> stand(State& s, std::size_t axis, const Measurement<Scalar>& z) noexcept {
    if (z.fresh) {
      if (!is_number(z.position_error_m)) return failed(ControlFault::not_a_number);
      look(s, axis, z.position_error_m);
    }
    return {Scalar{0}, Scalar{0}, standing_mode(), false};
  }

  void look(State& s, std::size_t axis, Scalar reading_m) noexcept {
    const Word mine = bit(axis);
    s.reading_m = reading_m;
    primed_ |= mine;
    heard_ |= mine;
    mark(outside_, mine, std::abs(reading_m) > s.allowed_m);
    if (phase_ == CoordinatorPhase::rest) mark(unlawful_, mine, !is_lawful(s, axis));
    if (phase_ == CoordinatorPhase::hold) mark(far_, mine, std::abs(reading_m) > s.gate_m);
  }

  // After a kick: no other axis moved, and the kicked one did not go beyond. Else the machine is not what was
  // certified.
  bool is_lawful(const State& s, std::size_t axis) const noexcept {
    return axis == kicked_ ? s.reading_m * direction_ <= s.count_m : std::abs(s.reading_m - s.stood_m) <= s.count_m;
  }

  Mode standing_mode() const noexcept {
    if (phase_ == CoordinatorPhase::hold) return Mode::hold;
    if (phase_ == CoordinatorPhase::fault) return Mode::fault;
    return phase_ == CoordinatorPhase::gather ? Mode::approach : Mode::coast;
  }

  ControlOutput<Scalar> failed(ControlFault fault) noexcept {
    fail(fault);
    return {Scalar{0}, Scalar{0}, Mode::fault, false};
  }

  ControlOutput<Scalar> own_step(std::size_t axis, const Measurement<Scalar>& z) noexcept {
    State& s = state_[axis];
    if (phase_ == CoordinatorPhase::approach) return draw_near(s, bit(axis), z);
    if (phase_ == CoordinatorPhase::pulse || phase_ == CoordinatorPhase::coast) return take_part(s, axis, z);
    return stand(s, axis, z);
  }

  // Every axis was seen: what the next period is.
  void close_period() noexcept {
    seen_ = 0;
    pulse_starts_ = false;
    decide();
    shown_fault_ = fault_;
  }

  void decide() noexcept {
    switch (phase_) {
      case CoordinatorPhase::gather:
        return approach();
      case CoordinatorPhase::approach:
        return watch_approach();
      case CoordinatorPhase::release:
        if (elapsed_and_heard()) begin_choice();
        return;
      case CoordinatorPhase::choice:
        return choose();
      case CoordinatorPhase::pulse:
        if (elapsed()) coast();
        return;
      case CoordinatorPhase::coast:
        if (elapsed()) rest();
        return;
      case CoordinatorPhase::rest:
        if (elapsed_and_heard()) judge_kick();
        return;
      case CoordinatorPhase::hold:
        if (all_heard()) watch_hold();
        return;
      case CoordinatorPhase::fault:
        return;
    }
  }

  bool elapsed() noexcept {
    if (left_ > 0) --left_;
    return left_ == 0;
  }
  // Every axis gave a reading since the last time that all had. Samples are lost of one axis and of another, and those
  // of one period may never come together.
  bool all_heard() noexcept {
    if (heard_ != all_) return false;
    heard_ = 0;
    return true;
  }
  bool elapsed_and_heard() noexcept {
    if (elapsed()) return all_heard();
    heard_ = 0;  // what is read before is of a machine that may move
    return false;
  }

  void gather() noexcept {
    phase_ = CoordinatorPhase::gather;
    end_ = CoordinatorEnd::none;
    seen_ = 0;
    pulse_starts_ = false;
  }

  void approach() noexcept {
    phase_ = CoordinatorPhase::approach;
    end_ = CoordinatorEnd::none;
    still_ = stands_ = 0;
    all_still_ = true;
    pulse_starts_ = false;
    driven_ = heard_ = 0;
  }

  void watch_approach() noexcept {
    if (!all_still_)
      still_ = heard_ = 0;
    else if (all_heard())
      ++still_;
    // Wherever the machine can rest is within its gates: an encoder that stands still, or an axis that is held. Axes
    // that still move may hold another one for a while; see draw_near().
    if (!all_still_ && ++stands_ > patience_) return fail(ControlFault::jammed);
    all_still_ = true;
    if (still_ < p_->still_periods) return;
    kicks_ = 0;
    outside_ = 0;
    left_ = std::max<std::uint32_t>(p_->release_periods, 1);
    phase_ = CoordinatorPhase::release;
  }

  // Something may have pushed an axis that was held.
  void watch_hold() noexcept {
    if (far_ != 0) return approach();
    if (outside_ == 0 || end_ != CoordinatorEnd::on_target) return;
    kicks_ = 0;
    begin_choice();
  }

  void begin_choice() noexcept {
    end_ = CoordinatorEnd::on_target;
    candidates_ = outside_;
    choose();
  }

  // The axis that was kicked goes on until it is there, and then the next one has its turn.
  void choose() noexcept {
    phase_ = CoordinatorPhase::choice;
    candidates_ &= outside_;
    if (candidates_ == 0) {
      phase_ = CoordinatorPhase::hold;
      far_ = heard_ = 0;
      return;
    }
    const Word ahead = candidates_ >> kicked_;
    const std::size_t next = ahead != 0 ? kicked_ + first_of(ahead) : first_of(candidates_);
    candidates_ &= ~bit(next);
    kick(next);
  }

  static std::size_t first_of(Word word) noexcept { return static_cast<std::size_t>(std::countr_zero(word)); }

  // Starts a kick, but where no force that is sure to move the axis goes as little.
  void kick(std::size_t i) noexcept {
    const auto& a = p_->axes[i];
    const Prepared& c = prepared_[i];
    const Scalar aim_m = std::abs(state_[i].reading_m) - a.resolution_m / 2;
    std::uint8_t n = periods_for(std::sqrt(aim_m * c.per_one_period_m));
    Scalar wanted_N =
        (c.half_N + std::sqrt(c.square_N2 + c.per_metre_N2 * aim_m / static_cast<Scalar>(n * n))) * rounded_down;
    // So many periods need less force than is sure to move the axis: one less with all that there is stops short.
    if (wanted_N < a.sure_N && n > 1) {
      --n;
      wanted_N = std::max(a.kick_N * rounded_down, a.sure_N);
    }
    const Scalar force_N = std::min({wanted_N, a.kick_N, state_[i].limit_N});
    if (!(wanted_N >= a.sure_N)) {
      end_ = CoordinatorEnd::below_floor;
      return;
    }
    // A drive no longer gives what moves its axis, or what holds it while another one is kicked.
    if (!(force_N >= a.sure_N) || (weak_ & ~bit(i)) != 0) return fail(ControlFault::jammed);
    if (kicks_ >= p_->most_kicks) return fail(ControlFault::hunting);
    ++kicks_;
    kicked_ = i;
    direction_ = state_[i].reading_m > 0 ? Scalar{-1} : Scalar{1};
    coast_periods_ = whole((force_N - a.lower_N) * n * c.per_g_N) + p_->settling_periods;
    force_N_ = direction_ * force_N;
    held_N_ = direction_ * (force_N - c.middle_N);
    left_ = n;
    pulse_starts_ = true;
    phase_ = CoordinatorPhase::pulse;
  }

  void coast() noexcept {
    force_N_ = -direction_ * p_->axes[kicked_].brake_N;
    held_N_ = direction_ * prepared_[kicked_].coast_N;
    left_ = coast_periods_;
    phase_ = CoordinatorPhase::coast;
  }

  void rest() noexcept {
    left_ = p_->settling_periods;
    unlawful_ = heard_ = 0;
    phase_ = CoordinatorPhase::rest;
  }

  void judge_kick() noexcept {
    if (unlawful_ == 0) return begin_choice();
    moved_ = first_of(unlawful_);
    fail(ControlFault::contradicted);
  }

  void fail(ControlFault fault) noexcept {
    if (fault_ == ControlFault::none) fault_ = fault;
    phase_ = CoordinatorPhase::fault;
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
  Word all_;
  Word seen_ = 0;        // asked in this period, and all in front of it
  Word primed_ = 0;      // gave a reading
  Word driven_ = 0;      // got a force of this approach
  Word outside_ = 0;     // off their targets
  Word far_ = 0;         // beyond their gates, in the hold
  Word unlawful_ = 0;    // did what no kick may make them do
  Word heard_ = 0;       // gave a reading since all of them last had
  Word weak_ = 0;        // their drives give less than kicks of another axis may ask of them
  Word candidates_ = 0;  // still to be looked at in this choice
  std::array<State, Axes> state_{};
  std::array<Prepared, Axes> prepared_{};
  CoordinatorPhase phase_ = CoordinatorPhase::gather;
  CoordinatorEnd end_ = CoordinatorEnd::none;
  ControlFault fault_ = ControlFault::none, shown_fault_ = ControlFault::none;
  std::size_t kicked_ = 0, moved_ = 0;
  Scalar direction_ = 1;
  Scalar force_N_{};  // of the kicked axis
  Scalar held_N_{};   // of the others for each unit of k
  std::uint32_t left_ = 0, coast_periods_ = 0, kicks_ = 0, still_ = 0;
  std::uint32_t stands_ = 0, patience_ = 0;  // periods in which no axis leaves its place, though one is beyond its gate
  Scalar slowest_s_{};                       // of all axes, sqrt(m/P) or D/P
  bool all_still_ = true, pulse_starts_ = false;
};

}  // namespace breakaway::law
