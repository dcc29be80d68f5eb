// ControlLoop: receive, supervise, control, send; once a period, for up to MaxAxes axes on one bus.
//
// The frames of a step leave in the order command of every axis, SYNC where the protocol has one, questions where it
// has them, then one acyclic frame. With SYNC every drive acts on its new command and takes its next sample at that
// SYNC; the samples have the rest of the period to come back. So a force computed in step k from the sample of SYNC k-1
// acts from SYNC k to SYNC k+1: the latency is one period, and a pulse of n steps lasts n periods. Without SYNC a
// command acts when it arrives, and the sample is the newest that came.
//
// A SYNC that followed the commands at once would move with the stuff bits of theirs and with the time that the step
// took, and a pulse would last that much longer or shorter than whole periods. So the step has two halves, and who runs
// the loop lets the SYNC of every period wait until the same time after its start.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/canopen/master.hpp"
#include "breakaway/firmware/axis_status.hpp"
#include "breakaway/firmware/law_model.hpp"
#include "breakaway/firmware/loop_concepts.hpp"
#include "breakaway/firmware/loop_config.hpp"
#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/firmware/timing_statistics.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/law/control_types.hpp"

namespace breakaway::firmware {

// The loop is for one thread. Axes are named by the AxisId that add_axis() gives: a call with one of
// another loop, or of an axis that was refused, changes nothing.
template <hal::CanPort Port, class Drive, class Controller, class Scalar, std::size_t MaxAxes = 8>
requires BusDrive<Drive, Scalar> && AxisLaw<Controller, Scalar>
class ControlLoop {
 public:
  class AxisId {
   public:
    constexpr std::size_t index() const noexcept { return index_; }  // in the order in which the axes were added
    friend constexpr bool operator==(AxisId, AxisId) = default;

   private:
    friend class ControlLoop;
    constexpr explicit AxisId(std::size_t index) noexcept : index_{index} {}
    std::size_t index_;
  };

  struct AddedAxis {
    std::optional<AxisId> id;  // nothing: it was refused
    AxisError error = AxisError::none;
  };

  ControlLoop(Port& port, const LoopConfig& config) noexcept
      : port_{&port}, config_{config}, statistics_{config.network.period}, master_{config.network} {}

  // Takes an axis in; to be called before the first step. The drive is made for this loop's network and the
  // controller's scale, so that nothing is said twice. A limits.feedback_timeout of 0 means two and a half periods, so
  // that two samples lost in a row stop the axis; a limits.force_N that is not given, a fifth above the law's limit.
  AddedAxis add_axis(const typename Drive::Config& drive, const Controller& controller,
                     AxisLimits<Scalar> limits) noexcept {
    if (count_ == MaxAxes) return {{}, AxisError::no_room};
    const auto period_s = hal::seconds_as<Scalar>(config_.network.period);
    if (!(std::abs(controller.period_s() - period_s) <= Scalar(1e-6) * period_s))
      return {{}, AxisError::period_differs};
    if (taken(drive.node_id)) return {{}, AxisError::node_id_taken};
    if (limits.feedback_timeout == hal::Duration::zero()) limits.feedback_timeout = config_.network.period * 5 / 2;
    if (!(limits.force_N < AxisLimits<Scalar>::unlimited))
      limits.force_N = controller.max_force_N() + controller.max_force_N() / 5;
    const hal::AxisScale<Scalar> scale{controller.encoder_resolution_m(), controller.max_force_N()};
    axes_[count_].emplace(drive, config_.network, scale, controller, limits);
    return {AxisId{count_++}};
  }

  // Says whether this many axes at this rate fit the bus; canopen::bus_budget() gives the figures. Of another protocol
  // its own room says it, as odrive::bus_budget() does.
  canopen::BusFit check_bus() const noexcept requires std::same_as<typename Drive::Master, canopen::Master> {
    return canopen::check_bus_budget(static_cast<unsigned>(count_), config_.network.period, config_.network.bit_rate);
  }

  // Returns the axis that was added at this place, for a caller who has a number only.
  std::optional<AxisId> axis(std::size_t index) const noexcept {
    if (index < count_) return AxisId{index};
    return {};
  }

  // The axis is to be enabled as soon as its drive is set up, and kept enabled.
  void request_enable(AxisId id) noexcept {
    if (Axis* const a = find(id)) a->wanted = true;
  }

  // The axis is to stop and stay disabled. Cannot fail: an axis that there is stops, and there is no other.
  void request_stop(AxisId id) noexcept {
    if (Axis* const a = find(id)) {
      a->wanted = a->status.running = false;  // an axis that stops as asked has no fault
      a->drive.request_stop();
    }
  }

  // The axis is to stop because of a fault that its caller saw. One that is not wanted has none.
  void stop_with(AxisId id, AxisFault fault, hal::Time now) noexcept {
    Axis* const a = find(id);
    if (a == nullptr) return;
    if (a->wanted) a->supervisor.latch(fault, 0, now);
    request_stop(id);
  }

  // The axis has this fault from its start on, wanted or not: what ended the last run of its controller.
  void start_with(AxisId id, AxisFault fault, hal::Time now) noexcept {
    Axis* const a = find(id);
    if (a == nullptr) return;
    a->supervisor.latch(fault, 0, now);
    request_stop(id);
  }

  // The axis stands at this encoder count: for an incremental encoder whose drive booted anew, and for a zero of its
  // own. Returns false, and does nothing, while the axis may have force, and where no sample came or none comes any
  // more: since the newest one the axis may have moved.
  bool set_reference_counts(AxisId id, std::int32_t counts) noexcept {
    Axis* const a = find(id);
    if (a == nullptr || may_have_force(a->status.feedback) || !a->status.feedback.ever_valid) return false;
    if (a->supervisor.is_stale(a->status.feedback, a->controlled_at)) return false;
    a->drive.set_reference_counts(counts);
    return true;
  }

  // Acknowledges a latched fault; the drive is set up anew, and enabled again if it is still wanted. Returns false, and
  // does nothing, until the drive was seen without force after the stop that the fault brought.
  [[gnu::cold]] bool reset_fault(AxisId id) noexcept {
    Axis* const a = find(id);
    if (a == nullptr || may_have_force(a->status.feedback)) return false;
    if (a->status.fault != AxisFault::none) {
      a->drive.reset_fault();
      a->unfulfilled_since.reset();
    }
    a->supervisor.reset();
    a->controller.reset();
    a->standing_fault = AxisFault::none;
    a->status.stop_not_obeyed = false;
    waiting_ = any_standing_fault();
    a->reset_periods = std::max(static_cast<std::int32_t>(reset_time / config_.network.period), least_reset_periods);
    return true;
  }

  // Returns how long the set-up of an axis' drive may take, where the axis is wanted, before that is a fault.
  hal::Duration time_to_set_up(AxisId id) const noexcept { return time_to_set_up(drive(id)); }

  // Sets the target as an encoder count, which is exact at any distance from zero, in any scalar type. May be called at
  // any time.
  void set_target_counts(AxisId id, std::int32_t counts) noexcept {
    if (Axis* const a = find(id)) move_target(*a, counts);
  }

  // Sets the target in metres, rounded to the nearest encoder count.
  void set_target_m(AxisId id, Scalar target_m) noexcept {
    constexpr Scalar most = Scalar(2147483520);  // the largest float below 2^31
    Axis* const a = find(id);
    if (a == nullptr) return;
    move_target(*a,
                static_cast<std::int32_t>(law::limited(std::round(target_m / a->drive.encoder_resolution_m()), most)));
  }

  // Does the work of one period but what begins with SYNC. `now` is the time at which the period starts; nothing in it
  // waits.
  void command(hal::Time now) noexcept {
    statistics_.begin(now);
    receive();
    if (config_.moves_end == MovesEnd::together) end_together();
    for (std::size_t i = 0; i < count_; ++i) control(*axes_[i], now);
    if (config_.fault_scope == FaultScope::all_axes) stop_together(now);
    send_commands(now);
  }

  // When the period's SYNC is to leave. Nothing: no command() came since the last one.
  std::optional<hal::Time> sync_due() const noexcept {
    if (!commanded_at_) return {};
    return *commanded_at_ + Master::sync_offset(static_cast<unsigned>(count_), config_.network);
  }

  // Sends SYNC and what follows it in a period; at sync_due(), or as soon after as may be.
  void sync(hal::Time now) noexcept {
    if (!commanded_at_) return;
    const hal::Time deadline = *commanded_at_ + config_.network.period;
    send_sync(now, deadline);
    send_acyclic(*commanded_at_, deadline);
    commanded_at_.reset();
  }

  // Both at once, for who cannot wait within a period or has nothing to wait for.
  void step(hal::Time now) noexcept {
    command(now);
    sync(now);
  }

  std::size_t axes() const noexcept { return count_; }
  // An id of another loop shows the first axis.
  const AxisStatus<Scalar>& status(AxisId id) const noexcept { return shown(id).status; }
  const Drive& drive(AxisId id) const noexcept { return shown(id).drive; }
  // The axis was to be enabled, and not to stop since. With a fault it waits for a reset.
  bool is_wanted(AxisId id) const noexcept { return shown(id).wanted; }
  std::int32_t target_counts(AxisId id) const noexcept { return shown(id).target_counts; }
  const Controller& controller(AxisId id) const noexcept { return shown(id).controller; }
  const Supervisor<Scalar>& supervisor(AxisId id) const noexcept { return shown(id).supervisor; }
  const TimingStatistics& statistics() const noexcept { return statistics_; }
  std::uint64_t refused_frames() const noexcept { return refused_frames_; }

 private:
  using Master = typename Drive::Master;

  struct Axis {
    // The drive is made in its place: a stack has little room for another one.
    Axis(const typename Drive::Config& d, const hal::NetworkConfig& network, const hal::AxisScale<Scalar>& scale,
         const Controller& c, const AxisLimits<Scalar>& limits) noexcept
        : drive{d, network, scale}, controller{c}, supervisor{limits, model_of<Scalar>(c)} {}
    Drive drive;
    Controller controller;
    Supervisor<Scalar> supervisor;
    Scalar last_error_m{};
    std::int32_t target_counts = 0;
    bool another_master = false;
    hal::Time controlled_at{};                   // by the newest step
    std::optional<hal::Time> unfulfilled_since;  // it is wanted and does not run
    hal::Time enabling_since{};
    std::int32_t reset_periods = 0;              // that the drive still has to leave its fault
    AxisFault standing_fault = AxisFault::none;  // where axes stop together: seen by an earlier step and not reset
    bool wanted = false;
    bool sets_off = false;  // its target moved, or it was enabled, and no step has matched its move with the others'
    AxisStatus<Scalar> status{};
  };

  static constexpr hal::Duration reset_time = std::chrono::seconds{1};
  // An edge takes several, and so does the answer.
  static constexpr std::int32_t least_reset_periods = 20;
  // A power stage may have to charge its capacitors and to open a brake first.
  static constexpr hal::Duration enable_time = std::chrono::seconds{5};
  // To be set up, too: the mode of operation alone may take ten seconds.
  static constexpr hal::Duration set_up_time = std::chrono::seconds{20};

  // The axes take turns.
  hal::Duration time_to_set_up(const Drive& drive) const noexcept {
    hal::Duration time = set_up_time;
    if constexpr (requires { Drive::setup_periods; })
      time += Drive::setup_periods * static_cast<int>(count_) * config_.network.period;
    if constexpr (requires { drive.extra_setup_time(); }) time += drive.extra_setup_time();
    return time;
  }

  static bool homes_against_a_stop(const Drive& drive) noexcept {
    if constexpr (requires { drive.homes_against_a_stop(); }) return drive.homes_against_a_stop();
    return false;
  }

  static bool may_have_force(const hal::DriveFeedback<Scalar>& f) noexcept {
    return f.stop_not_obeyed || f.state == hal::DriveState::enabled || f.state == hal::DriveState::stopping ||
           f.state == hal::DriveState::homing;
  }

  // A step takes in at most what a full bus can bring in a period of 10 ms at 1 Mbit/s; the rest waits in the port.
  static constexpr int max_frames_per_step = 256;

  const Axis& shown(AxisId id) const noexcept { return *axes_[id.index_ < count_ ? id.index_ : 0]; }
  Axis* find(AxisId id) noexcept { return id.index_ < count_ ? &*axes_[id.index_] : nullptr; }

  bool taken(std::uint8_t node_id) const noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (axes_[i]->drive.node_id() == node_id) return true;
    }
    return node_id == config_.network.node_id;
  }

  [[gnu::cold]] void move_target(Axis& a, std::int32_t counts) noexcept {
    // The drive's offsets are modulo 2^32 counts, and so is this.
    const auto shift =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(counts) - static_cast<std::uint32_t>(a.target_counts));
    const Scalar shift_m = static_cast<Scalar>(shift) * a.drive.encoder_resolution_m();
    a.target_counts = counts;
    a.sets_off = true;
    a.drive.set_datum_counts(counts);
    a.controller.shift_target(shift_m);
    a.supervisor.begin_motion(a.last_error_m - shift_m);
    a.last_error_m -= shift_m;
  }

  static Scalar move_time_s(const Axis& a) noexcept {
    if constexpr (requires { a.controller.move_time_s(a.last_error_m); })
      return a.sets_off && a.status.running ? a.controller.move_time_s(std::abs(a.last_error_m)) : Scalar{0};
    return 0;
  }

  // Those that set off as fast as the slowest of them lets them.
  [[gnu::noinline, gnu::cold]] void end_together() noexcept {
    Scalar longest_s = 0;
    for (std::size_t i = 0; i < count_; ++i) longest_s = std::max(longest_s, move_time_s(*axes_[i]));
    for (std::size_t i = 0; i < count_; ++i) {
      Axis& a = *axes_[i];
      if constexpr (requires { a.controller.take_time(longest_s, a.last_error_m); }) {
        if (a.sets_off && a.status.running) a.controller.take_time(longest_s, std::abs(a.last_error_m));
      }
      a.sets_off = a.sets_off && !a.status.running;
    }
  }

  // Kept out of command(), as send_commands() is: there g++ 12 has too few registers for all three, and a step costs
  // more.
  [[gnu::noinline]] void receive() noexcept {
    hal::ReceivedFrame received;
    for (int n = 0; n < max_frames_per_step && port_->receive(received); ++n) {
      const std::uint8_t node = Master::node_of(received.frame);
      const bool for_all = master_.is_own(received.frame);
      for (std::size_t i = 0; i < count_; ++i) {
        Axis& a = *axes_[i];
        if (for_all || Master::is_command(received.frame, a.drive.node_id())) a.another_master = true;
        if (a.drive.node_id() == node) a.drive.on_frame(received);
      }
    }
  }

  void control(Axis& a, hal::Time now) noexcept {
    a.drive.update(now);
    const hal::DriveFeedback<Scalar> feedback = a.drive.feedback();
    const bool was_running = a.status.running;
    a.status.feedback = feedback;
    a.controlled_at = now;
    a.status.output = {};
    a.status.running = supervise(a, feedback, was_running, now);
    if (!a.status.running) return;
    if (feedback.fresh) a.last_error_m = feedback.position_offset_m;
    if (!was_running) begin(a);
    // Where moves end together, that of an axis that starts is matched with the others' before its first force.
    if (was_running || config_.moves_end == MovesEnd::each)
      a.status.output = a.controller.update({feedback.position_offset_m, Scalar{0}, feedback.fresh});
    a.drive.command(a.status.output.force_N);
    a.supervisor.command(a.status.output.force_N);
  }

  // Returns true when the axis is enabled and may be given force in this period.
  bool supervise(Axis& a, const hal::DriveFeedback<Scalar>& feedback, bool was_running, hal::Time now) noexcept {
    const AxisHealth health{.heartbeat_lost = a.drive.heartbeat_lost(),
                            .emergency_code = a.drive.take_emergency(),
                            .bus_off = port_->bus_state() == hal::BusState::bus_off,
                            .control_fault = a.controller.fault(),
                            .another_master = std::exchange(a.another_master, false),
                            .node_id_conflict = a.drive.node_id_conflict(),
                            .reference_lost = a.drive.reference_lost(),
                            .on_its_way = is_on_its_way(a.controller),
                            .holds = a.controller.mode() == law::Mode::hold};
    const AxisFault before = a.supervisor.fault();
    if (feedback.stop_not_obeyed) {
      a.supervisor.latch(AxisFault::stop_not_obeyed, 0, now);
      a.status.stop_not_obeyed = true;
    }
    if (feedback.state == hal::DriveState::unusable)
      a.supervisor.latch(AxisFault::drive_unusable, 0, now);
    else if (was_running)
      a.supervisor.check(feedback, health, now);
    else
      watch_idle(a, feedback, health, now);
    a.status.fault = a.supervisor.fault();
    if (a.status.fault != before) {
      a.drive.request_stop();
      port_->purge_transmit_queue();
    }
    if (a.status.fault != AxisFault::none) return false;
    if (feedback.state == hal::DriveState::disabled && a.wanted && !waiting_) a.drive.request_enable();
    return a.wanted && feedback.state == hal::DriveState::enabled && feedback.ever_valid &&
           (was_running || (feedback.fresh && !waiting_));
  }

  // A fault that an earlier step saw and that was not reset.
  bool any_standing_fault() const noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (axes_[i]->standing_fault != AxisFault::none) return true;
    }
    return false;
  }

  // A new fault of one axis stops all that are wanted. None starts again before every fault was reset; the resets may
  // come one by one.
  [[gnu::noinline]] void stop_together(hal::Time now) noexcept {
    bool any_new = false;
    for (std::size_t i = 0; i < count_; ++i) {
      const Axis& a = *axes_[i];
      any_new = any_new || (a.standing_fault == AxisFault::none && a.status.fault != AxisFault::none);
    }
    for (std::size_t i = 0; i < count_; ++i) {
      if (any_new) stop_with_another(*axes_[i], now);
      axes_[i]->standing_fault = axes_[i]->status.fault;
    }
    waiting_ = any_standing_fault();
  }

  [[gnu::cold]] void stop_with_another(Axis& a, hal::Time now) noexcept {
    if (!a.wanted || a.status.fault != AxisFault::none) return;
    a.supervisor.latch(AxisFault::stopped_with_another, 0, now);
    a.drive.request_stop();
    a.status.fault = AxisFault::stopped_with_another;
    a.status.output = {};
    a.status.running = false;
  }

  // A drive that is in fault before it ever ran, or that a reset did not help, is named as well; so is whatever keeps
  // an axis that is wanted from running.
  [[gnu::cold]] void watch_idle(Axis& a, const hal::DriveFeedback<Scalar>& feedback, const AxisHealth& health,
                                hal::Time now) noexcept {
    if (a.reset_periods > 0 && feedback.state != hal::DriveState::configuring) --a.reset_periods;
    if (feedback.state == hal::DriveState::fault && a.reset_periods == 0) {
      a.supervisor.latch(AxisFault::drive_fault, feedback.fault_code, now);
    }
    // What the drive tells of at the same time is why.
    if (feedback.homing_failed && a.wanted && health.emergency_code != 0)
      a.supervisor.latch(AxisFault::emergency, health.emergency_code, now);
    if (feedback.homing_failed) a.supervisor.latch(AxisFault::homing_failed, 0, now);
    if (feedback.state == hal::DriveState::homing && a.wanted)
      a.supervisor.check_homing(feedback, health, now, homes_against_a_stop(a.drive));
    // The period in which it is first seen energised is not yet one that runs.
    if (feedback.state == hal::DriveState::enabled && a.wanted && health.emergency_code != 0)
      a.supervisor.latch(AxisFault::emergency, health.emergency_code, now);
    // A drive that finds its zero has a time limit of its own.
    if (!a.wanted || waiting_ || feedback.state == hal::DriveState::homing) return a.unfulfilled_since.reset();
    a.supervisor.check_idle(health, now);
    if (!a.unfulfilled_since) a.unfulfilled_since = a.enabling_since = now;
    if (feedback.state != hal::DriveState::enabling) a.enabling_since = now;
    if (now - a.enabling_since <= enable_time && now - *a.unfulfilled_since <= time_to_set_up(a.drive)) return;
    // An error that the drive told of says more than that it does not come.
    const std::uint16_t code = a.drive.last_error_code();
    a.supervisor.latch(code != 0 ? AxisFault::emergency : AxisFault::enable_timed_out, code, now);
  }

  [[gnu::cold]] void begin(Axis& a) noexcept {
    a.controller.reset();
    a.controller.limit_force(a.drive.max_force_N());
    a.sets_off = true;
    a.supervisor.begin_motion(a.last_error_m);
    a.supervisor.begin_commands(a.status.feedback.position_m);
    a.unfulfilled_since.reset();
  }

  // Frames still queued when the next step starts are stale by then: the port drops them.
  [[gnu::noinline]] void send_commands(hal::Time now) noexcept {
    const hal::Time deadline = now + config_.network.period;
    hal::CanFrame frame;
    for (std::size_t i = 0; i < count_; ++i) {
      if (axes_[i]->drive.next_command_frame(frame)) transmit(frame, deadline);
    }
    commanded_at_ = now;
  }

  void send_sync(hal::Time now, hal::Time deadline) noexcept {
    for (std::size_t i = 0; i < count_; ++i) axes_[i]->drive.on_sync(now);
    hal::CanFrame frame;
    if (master_.next_sync(frame)) transmit(frame, deadline);
    ask(deadline);
  }

  // What leaves when is decided by the start of the period, which is the same on every target; SYNC may be late.
  [[gnu::noinline]] void send_acyclic(hal::Time begin, hal::Time deadline) noexcept {
    hal::CanFrame frame;
    if (master_.next_heartbeat(frame, begin)) {
      transmit(frame, deadline);
      return;
    }
    // One acyclic frame a period keeps set-up from crowding out the cyclic traffic; the axes take turns.
    for (std::size_t i = 0; i < count_; ++i) {
      next_acyclic_ = next_acyclic_ + 1 < count_ ? next_acyclic_ + 1 : 0;
      if (!axes_[next_acyclic_]->drive.next_acyclic_frame(frame, begin)) continue;
      transmit(frame, deadline);
      break;
    }
  }

  // The questions of a protocol whose drives are asked for their samples.
  void ask(hal::Time deadline) noexcept {
    if constexpr (requires(Drive & drive, hal::CanFrame & frame) { drive.next_poll_frame(frame); }) {
      hal::CanFrame frame;
      for (std::size_t i = 0; i < count_; ++i)
        while (axes_[i]->drive.next_poll_frame(frame)) transmit(frame, deadline);
    }
  }

  void transmit(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    if (port_->send(frame, deadline) != hal::SendResult::queued) ++refused_frames_;
  }

  Port* port_;
  LoopConfig config_;
  TimingStatistics statistics_;
  Master master_;
  std::array<std::optional<Axis>, MaxAxes> axes_{};
  std::size_t count_ = 0;
  std::size_t next_acyclic_ = 0;
  std::optional<hal::Time> commanded_at_;  // by the command() whose SYNC did not leave yet
  bool waiting_ = false;                   // nobody starts: an axis of those that stop together still has a fault
  std::uint64_t refused_frames_ = 0;
};

}  // namespace breakaway::firmware
