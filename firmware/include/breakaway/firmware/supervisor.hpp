// Supervisor: watches one axis and decides, once a period, whether it may go on.
//
// A fault is latched: it names the first thing that went wrong and stays until reset(). What follows from it, zero
// force and a stop request to the drive, is the ControlLoop's, in the same step.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "breakaway/firmware/commanded_force.hpp"
#include "breakaway/firmware/motion_under_force.hpp"
#include "breakaway/firmware/motion_without_force.hpp"
#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/law/control_types.hpp"

namespace breakaway::firmware {

enum class AxisFault : std::uint8_t {
  none,
  feedback_stale,      // no new position for longer than feedback_timeout
  heartbeat_lost,      // the drive's heartbeat stopped
  emergency,           // the drive sent an EMCY message with an error code
  drive_fault,         // the drive's state machine went to fault
  drive_left_enabled,  // the drive left Operation enabled, or rebooted, without being asked
  position_limit,
  speed_limit,      // also what an encoder that jumps looks like
  force_limit,      // the drive reports more force than it was allowed
  following_error,  // the error grew beyond what it was at the target change by more than the limit
  not_a_number,     // feedback was NaN or infinite
  axis_jammed,
  position_diverging,
  bus_off,               // the CAN controller left the bus
  drive_unusable,        // set-up failed
  stopped_with_another,  // another axis of the node has a fault, and the node stops them together
  axis_hunting,
  axis_drifting,              // it does not stop without force
  axis_not_as_told,           // its kicks show friction outside what the law was told
  stop_not_obeyed,            // the drive was told to stop and was not seen without force within the time that it takes
  force_not_commanded,        // the drive reports a force that it was not told to give
  no_motion_under_force,      // the encoder shows nothing under a force that must move the axis
  enable_timed_out,           // the drive was told to enable and did not within the time that it takes
  commander_lost,             // the node that commands this one fell silent
  another_master,             // somebody else sends SYNC, our heartbeat, or commands the drive
  node_id_conflict,           // every SYNC is answered by two drives of one node id
  reference_lost,             // the drive booted anew, and what it counts from is not known
  target_not_reached,         // the axis came no nearer to its target for long, and does not hold there
  watchdog_reset,             // the controller's watchdog ended its last run
  less_force_than_commanded,  // the drive reports less force than it was told to give
  homing_failed,              // the drive looked for its zero by itself, and did not find it
  axis_at_spring_limit,       // it rests nearer to its target than what its spring may add to a kick
  axis_below_floor,           // it rests nearer to its target than a kick is sure to move its load by
  external_motion,            // the axis was held, and went where no force of its drive can have taken it
};

constexpr std::string_view to_string(AxisFault fault) noexcept {
  switch (fault) {
    case AxisFault::none:
      return "none";
    case AxisFault::feedback_stale:
      return "feedback stale";
    case AxisFault::heartbeat_lost:
      return "heartbeat lost";
    case AxisFault::emergency:
      return "drive emergency";
    case AxisFault::drive_fault:
      return "drive fault";
    case AxisFault::drive_left_enabled:
      return "drive left operation enabled";
    case AxisFault::position_limit:
      return "position limit";
    case AxisFault::speed_limit:
      return "speed limit";
    case AxisFault::force_limit:
      return "force limit";
    case AxisFault::following_error:
      return "following error";
    case AxisFault::not_a_number:
      return "feedback is not a number";
    case AxisFault::axis_jammed:
      return "axis jammed";
    case AxisFault::position_diverging:
      return "position diverging";
    case AxisFault::bus_off:
      return "bus off";
    case AxisFault::drive_unusable:
      return "drive unusable";
    case AxisFault::stopped_with_another:
      return "stopped with another axis";
    case AxisFault::axis_hunting:
      return "axis hunting";
    case AxisFault::axis_drifting:
      return "axis drifting";
    case AxisFault::axis_not_as_told:
      return "axis not as told";
    case AxisFault::stop_not_obeyed:
      return "stop not obeyed";
    case AxisFault::force_not_commanded:
      return "force not commanded";
    case AxisFault::no_motion_under_force:
      return "no motion under force";
    case AxisFault::enable_timed_out:
      return "enable timed out";
    case AxisFault::commander_lost:
      return "commander lost";
    case AxisFault::another_master:
      return "another master on the bus";
    case AxisFault::node_id_conflict:
      return "node id conflict";
    case AxisFault::reference_lost:
      return "reference lost";
    case AxisFault::target_not_reached:
      return "target not reached";
    case AxisFault::watchdog_reset:
      return "reset by the watchdog";
    case AxisFault::less_force_than_commanded:
      return "less force than commanded";
    case AxisFault::homing_failed:
      return "homing failed";
    case AxisFault::axis_at_spring_limit:
      return "axis at spring limit";
    case AxisFault::axis_below_floor:
      return "axis below floor";
    case AxisFault::external_motion:
      return "external motion";
  }
  return "unknown axis fault";
}

template <class Scalar>
struct AxisLimits {
  static constexpr Scalar unlimited = std::numeric_limits<Scalar>::infinity();
  static constexpr Scalar largest = std::numeric_limits<Scalar>::max();
  Scalar position_min_m = -unlimited;
  Scalar position_max_m = unlimited;
  Scalar speed_m_s = unlimited;
  // Of the force that the drive reports. The loop takes `unlimited` for a fifth above what the law commands: so far a
  // current loop may overshoot.
  Scalar force_N = unlimited;
  Scalar following_error_m = unlimited;
  hal::Duration feedback_timeout{};  // age of the newest sample; one lost frame makes two periods
  // In which an axis that runs comes nearer to its target. A slow one with a coarse encoder may lawfully take longer.
  hal::Duration progress_timeout = std::chrono::seconds{60};
};

// What is known of the axis' force and motion; what is not known is not watched.
template <class Scalar>
struct AxisModel {
  Scalar max_force_N = AxisLimits<Scalar>::unlimited;  // that its law commands
  Scalar slow_lag = 0;  // share of a change of force that is left after a period behind its slowest current loop
  Scalar mass_kg = 1;
  Scalar breakaway_N = AxisLimits<Scalar>::unlimited;  // a greater force moves the axis for certain,
  Scalar lost_motion_m = 0;                            // of which the encoder need not show so much
  Scalar feedforward_N = 0;                            // share of the force that a constant force on the axis takes up
  Scalar encoder_resolution_m = 1;
  Scalar unseen_m = 0;  // by which the travel between two readings may be off, for counts and noise
  law::HeldAxis<Scalar> held{};
};

// The supervisor looks at these, beside the feedback.
struct AxisHealth {
  bool heartbeat_lost = false;
  std::uint16_t emergency_code = 0;  // of an EMCY message that came in this period; 0000 means that an error went away
  bool bus_off = false;
  law::ControlFault control_fault = law::ControlFault::none;
  bool another_master = false;
  bool node_id_conflict = false;
  bool reference_lost = false;
  bool on_its_way = false;  // the law has its target to reach, and does not hold there yet
  bool holds = false;       // the law has proved that the axis rests at its target
};

template <class Scalar>
class Supervisor {
 public:
  // An axis that holds for so many samples holds for long.
  static constexpr std::uint16_t long_rest = 1000;
  // While a drive finds its zero, so many samples in a row that are too fast are no jump to it.
  static constexpr int homing_jump_samples = 3;

  constexpr explicit Supervisor(const AxisLimits<Scalar>& limits, const AxisModel<Scalar>& model = {}) noexcept
      : limits_{limits},
        commanded_{model.max_force_N, model.slow_lag},
        motion_{model.mass_kg, model.breakaway_N, model.encoder_resolution_m, model.lost_motion_m},
        external_{model.held, model.encoder_resolution_m},
        feedforward_N_{model.feedforward_N},
        unseen_m_{model.unseen_m} {
    // A drive reports whole steps of force, which are the limit but for rounding.
    limits_.force_N *= Scalar{1} + 8 * std::numeric_limits<Scalar>::epsilon();
  }

  // The drive was just enabled, or the target just moved: the error may be this large from now on.
  void begin_motion(Scalar position_error_m) noexcept {
    allowed_error_m_ = std::abs(position_error_m) + limits_.following_error_m;
    rested_samples_ = long_rest;
  }

  // The axis was just enabled at this position, and nothing was commanded yet. One that stands beyond a limit of
  // position may come back from there, and go no further out.
  void begin_commands(Scalar position_m = 0) noexcept {
    has_previous_ = false;  // what it did while it was off says nothing of its forces
    too_far_m_ = 0;
    commanded_.restart();
    motion_.restart();
    external_.restart();
    lowest_m_ = std::min(limits_.position_min_m, position_m);
    highest_m_ = std::max(limits_.position_max_m, position_m);
  }
  // The drive is told this force in this period.
  void command(Scalar force_N) noexcept {
    commanded_.command(force_N);
    external_.force(force_N - feedforward_N_);
  }

  // To be called once a period while the axis is meant to be enabled. Returns the latched fault.
  AxisFault check(const hal::DriveFeedback<Scalar>& feedback, const AxisHealth& health, hal::Time now) noexcept {
    if (feedback.fresh) {
      commanded_.report(feedback.force_N, feedback.force_step_N);
      motion_.sample(feedback.travel_m, feedback.force_N - feedforward_N_, since_previous_s(feedback));
      external_.sample(feedback.travel_m, health.holds);
      external_.force(feedback.force_N - feedforward_N_);
      if (has_previous_) watch_speed(feedback);
      note_progress(std::abs(feedback.position_offset_m), health.on_its_way, now);
    }
    if (fault_ == AxisFault::none) {
      const std::uint16_t code = health.emergency_code != 0 ? health.emergency_code : feedback.fault_code;
      latch(first_violation(feedback, health, now), code, now);
    }
    if (feedback.fresh) remember(feedback);
    return fault_;
  }

  // The same while an axis that is wanted does not run yet.
  void check_idle(const AxisHealth& health, hal::Time now) noexcept {
    latch(of_the_bus(health), 0, now);
    if (health.heartbeat_lost) latch(AxisFault::heartbeat_lost, 0, now);
  }

  // The same while a drive finds its zero by itself. Where it stands is not known, and its position jumps when it has
  // found it: so position is not watched, and one sample that is too fast says nothing. `against_a_stop`: it looks for
  // a place where it does not move.
  void check_homing(const hal::DriveFeedback<Scalar>& feedback, const AxisHealth& health, hal::Time now,
                    bool against_a_stop = false) noexcept {
    check_idle(health, now);
    latch(health.emergency_code != 0 ? AxisFault::emergency : AxisFault::none, health.emergency_code, now);
    if (is_stale(feedback, now)) latch(AxisFault::feedback_stale, 0, now);
    if (!(std::abs(feedback.force_N) <= limits_.force_N)) latch(AxisFault::force_limit, 0, now);
    if (feedback.fresh) watch_homing_motion(feedback, against_a_stop, now);
  }

  // Latches a fault; the first one stays. `code` is 603Fh or the EMCY error code, 0 if there is none. One that is read
  // after its fault was seen is taken in.
  void latch(AxisFault fault, std::uint16_t code, hal::Time now) noexcept {
    if (fault == AxisFault::none) return;
    if (fault == fault_ && fault_code_ == 0) fault_code_ = code;
    if (fault_ != AxisFault::none) return;
    fault_ = fault;
    fault_code_ = code;
    fault_time_ = now;
  }

  void reset() noexcept {
    fault_ = AxisFault::none;
    fault_code_ = 0;
    begin_commands();
    allowed_error_m_ = AxisLimits<Scalar>::unlimited;
  }

  // The newest position is too old to say where the axis is now.
  bool is_stale(const hal::DriveFeedback<Scalar>& feedback, hal::Time now) const noexcept {
    return now - feedback.sample_time > limits_.feedback_timeout;
  }

  AxisFault fault() const noexcept { return fault_; }
  hal::Time fault_time() const noexcept { return fault_time_; }
  std::uint16_t fault_code() const noexcept { return fault_code_; }

 private:
  using Feedback = hal::DriveFeedback<Scalar>;

  // The order matters: what comes first explains what comes after it.
  AxisFault first_violation(const Feedback& f, const AxisHealth& health, hal::Time now) const noexcept {
    if (const AxisFault fault = of_the_bus(health); fault != AxisFault::none) return fault;
    if (health.emergency_code != 0) return AxisFault::emergency;
    if (f.faulty || f.state == hal::DriveState::fault) return AxisFault::drive_fault;
    if (health.heartbeat_lost) return AxisFault::heartbeat_lost;
    if (f.state != hal::DriveState::enabled) return AxisFault::drive_left_enabled;
    if (f.ever_valid && is_stale(f, now)) return AxisFault::feedback_stale;
    if (health.on_its_way && rested_samples_ == 0 && now - progress_time_ > limits_.progress_timeout)
      return AxisFault::target_not_reached;
    if (f.fresh) return measured_violation(f, health);
    return AxisFault::none;
  }

  // The reference is one of them, because it goes with what the drive lost of its set-up.
  static AxisFault of_the_bus(const AxisHealth& health) noexcept {
    if (health.bus_off) return AxisFault::bus_off;
    if (health.another_master) return AxisFault::another_master;
    if (health.node_id_conflict) return AxisFault::node_id_conflict;
    if (health.reference_lost) return AxisFault::reference_lost;
    return AxisFault::none;
  }

  AxisFault measured_violation(const Feedback& f, const AxisHealth& health) const noexcept {
    const bool finite = std::isfinite(f.position_offset_m) && std::isfinite(f.position_m) &&
                        std::isfinite(f.travel_m) && std::isfinite(f.force_N);
    if (!finite) return AxisFault::not_a_number;
    if (health.control_fault != law::ControlFault::none) return named(health.control_fault);
    if (f.position_m < lowest_m_ || f.position_m > highest_m_) return AxisFault::position_limit;
    if (std::abs(too_far_m_) > unseen_m_ + timing_share * allowed_travel_m(f)) return AxisFault::speed_limit;
    if (std::abs(f.force_N) > limits_.force_N) return AxisFault::force_limit;
    if (commanded_.exceeded()) return AxisFault::force_not_commanded;
    if (commanded_.fallen_short()) return AxisFault::less_force_than_commanded;
    if (motion_.missing()) return AxisFault::no_motion_under_force;
    if (external_.seen()) return AxisFault::external_motion;
    if (std::abs(f.position_offset_m) > allowed_error_m_) return AxisFault::following_error;
    return AxisFault::none;
  }

  static constexpr AxisFault named(law::ControlFault fault) noexcept {
    switch (fault) {
      case law::ControlFault::none:
        return AxisFault::none;
      case law::ControlFault::not_a_number:
        return AxisFault::not_a_number;
      case law::ControlFault::jammed:
        return AxisFault::axis_jammed;
      case law::ControlFault::diverging:
        return AxisFault::position_diverging;
      case law::ControlFault::hunting:
        return AxisFault::axis_hunting;
      case law::ControlFault::drifting:
        return AxisFault::axis_drifting;
      case law::ControlFault::contradicted:
        return AxisFault::axis_not_as_told;
      case law::ControlFault::spring_limit:
        return AxisFault::axis_at_spring_limit;
      case law::ControlFault::below_floor:
        return AxisFault::axis_below_floor;
    }
    return AxisFault::not_a_number;
  }

  // What was sampled before the drive began is of another motion.
  [[gnu::cold]] void watch_homing_motion(const Feedback& f, bool against_a_stop, hal::Time now) noexcept {
    const bool goes_on = has_previous_ && f.sample_time - previous_time_ <= limits_.feedback_timeout;
    if (goes_on) {
      motion_.sample(f.travel_m, f.force_N - feedforward_N_, since_previous_s(f));
      homing_too_fast_ = std::abs(f.travel_m) > allowed_travel_m(f) + unseen_m_ ? homing_too_fast_ + 1 : 0;
    } else {
      motion_.restart();
      homing_too_fast_ = 0;
    }
    if (homing_too_fast_ >= homing_jump_samples) latch(AxisFault::speed_limit, 0, now);
    if (motion_.missing() && !against_a_stop) latch(AxisFault::no_motion_under_force, 0, now);
    previous_time_ = f.sample_time;
    has_previous_ = true;
  }

  // By so much of a period samples may be off: a frame that was on the wire when SYNC was due, of whatever node, makes
  // one late by up to its length, and so does the jitter that a certificate allows. Over any number of periods an axis
  // that keeps its limit goes no further beyond what the limit allows in them, but for what its readings are off.
  static constexpr Scalar timing_share = Scalar(0.5);

  // With its sign, because noise leads readings to and fro.
  void watch_speed(const Feedback& f) noexcept {
    const Scalar gone_m = too_far_m_ + f.travel_m;
    too_far_m_ = gone_m - law::limited(gone_m, allowed_travel_m(f));
  }

  Scalar allowed_travel_m(const Feedback& f) const noexcept { return limits_.speed_m_s * since_previous_s(f); }

  // The time of a frame that came late may lie after that of the next sample's SYNC. No time is less than none.
  Scalar since_previous_s(const Feedback& f) const noexcept {
    return has_previous_ ? std::max(hal::seconds_as<Scalar>(f.sample_time - previous_time_), Scalar{0}) : Scalar{0};
  }

  // An axis that held, or waited before it set off, has all its time before it. One that noise leads in and out of its
  // hold again and again did not hold.
  [[gnu::noinline]] void note_progress(Scalar error_m, bool on_its_way, hal::Time now) noexcept {
    if (!on_its_way) {
      if (rested_samples_ < long_rest) ++rested_samples_;
      return;
    }
    if (rested_samples_ == long_rest || error_m < least_error_m_) {
      least_error_m_ = error_m;
      progress_time_ = now;
    }
    rested_samples_ = 0;
  }

  void remember(const Feedback& f) noexcept {
    lowest_m_ = std::min(limits_.position_min_m, std::max(lowest_m_, f.position_m));
    highest_m_ = std::max(limits_.position_max_m, std::min(highest_m_, f.position_m));
    previous_time_ = f.sample_time;
    has_previous_ = true;
  }

  AxisLimits<Scalar> limits_;
  CommandedForce<Scalar> commanded_;
  MotionUnderForce<Scalar> motion_;
  MotionWithoutForce<Scalar> external_;
  Scalar feedforward_N_;
  Scalar unseen_m_;
  Scalar too_far_m_{};  // beyond what the speed limit allows, in the periods up to now
  Scalar allowed_error_m_ = AxisLimits<Scalar>::unlimited;
  Scalar least_error_m_{};  // since the target moved or the axis held for long
  Scalar lowest_m_ = limits_.position_min_m, highest_m_ = limits_.position_max_m;
  hal::Time progress_time_{};
  std::uint16_t rested_samples_ = long_rest;  // since it was on its way; as if for long where that begins anew
  hal::Time previous_time_{};
  hal::Time fault_time_{};
  std::uint16_t fault_code_ = 0;
  AxisFault fault_ = AxisFault::none;
  bool has_previous_ = false;
  int homing_too_fast_ = 0;  // samples in a row
};

}  // namespace breakaway::firmware
