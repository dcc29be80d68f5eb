// Drive: a CiA 402 drive in cyclic synchronous torque mode, as the control loop sees it. Force goes in, position comes
// out; it models hal::MotorDrive and firmware::BusDrive.
//
// It puts four parts together: DriveNode sets the drive up over the bus and watches it, StateMachine walks it through
// the states of CiA 402, TorqueScale turns newtons into per mille of the rated torque, and the two PDOs carry command
// and sample. Drive units exist only inside. Encoder counts, too, are in the axis' direction: with invert_direction
// they are the drive's with the sign changed.
//
//   Drive<float> drive{{.node_id = 1, .force_per_torque_N_per_Nm = 50}, {.period = 1ms}, {1e-6F, 50}};
//
//   once a period:
//     for every received frame: drive.on_frame(received);
//     drive.update(now);
//     drive.feedback(); drive.command(force_N);
//     send what drive.next_command_frame() hands out, then SYNC, and say so by drive.on_sync(now);
//     send what drive.next_acyclic_frame() hands out, as far as the bus has room.
//
// The RPDO leaves before its SYNC, at which the drive acts on it and takes the next sample; so a force acts one period
// after the sample that it was computed from. A command is used up by the frame that carries it: without a new one the
// next carries zero torque.
//
// A drive that leaves Operation enabled by itself, or reboots, stays off until request_enable(). One that cannot be
// used is `unusable`, sends no command, and setup_status() says why. One that is energised against our wish, whoever
// wished it and however far its set-up is, is told by other means than PDOs until it is seen without force
// (forced_stop.hpp), and is `stopping` all that time and until it was seen without force in five looks; then it is
// `configuring`. It is kept from PDOs until reset_fault().
//
// An axis whose file says how it gets its zero gets it when it is enabled first, and again after a reset that
// acknowledges that it was lost; a drive that finds its home by itself is `homing` meanwhile (homing.hpp), and wants
// another request_enable() after it.
//
// It owns no port, holds no pointers and may be copied. It never blocks or allocates, and is for one thread.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/master.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/object_address.hpp"
#include "breakaway/canopen/pdo.hpp"
#include "breakaway/canopen/sync.hpp"
#include "breakaway/cia402/drive_config.hpp"
#include "breakaway/cia402/drive_node.hpp"
#include "breakaway/cia402/force_watch.hpp"
#include "breakaway/cia402/homing.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/pdo_layout.hpp"
#include "breakaway/cia402/setup_plan.hpp"
#include "breakaway/cia402/setup_status.hpp"
#include "breakaway/cia402/state.hpp"
#include "breakaway/cia402/state_machine.hpp"
#include "breakaway/cia402/torque_scale.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/hal/network_config.hpp"

namespace breakaway::cia402 {

template <class Scalar>
class Drive {
 public:
  using Config = DriveConfig<Scalar>;
  using Master = canopen::Master;

  // A drive in Operation enabled leaves it within this of a stop, or does not obey. Drives read a controlword once in
  // some milliseconds.
  static constexpr hal::Duration stop_time = std::chrono::milliseconds{20};
  static constexpr int stop_periods = 10;  // where the period is longer than 2 ms
  // Its set-up sends a frame in so many, because the master's heartbeat may take the place in every other one.
  static constexpr int setup_periods = 2 * static_cast<int>(SetupPlan::most_steps);

  // A drive with what check() does not accept is unusable for good and sends nothing.
  // Cold, as all that runs once at the start: where memory for code is short the step shall have it.
  [[gnu::cold]] Drive(const Config& config, const hal::NetworkConfig& network,
                      const hal::AxisScale<Scalar>& scale) noexcept
      : config_{config},
        period_{network.period},
        scale_{scale},
        config_error_{check(config, network, scale)},
        own_status_{config_error_ == DriveConfigError::none ? SetupStatus::ready : SetupStatus::config_invalid},
        sign_{config.invert_direction ? Scalar{-1} : Scalar{1}},
        command_pdo_{command_pdo(config.node_id)},
        feedback_pdo_{feedback_pdo(config.node_id)},
        node_{config, network, scale.max_force_N},
        homing_{config.homing},
        home_wanted_{homes()} {}

  // Takes any frame that the bus brought; those of other nodes are passed over.
  void on_frame(const hal::ReceivedFrame& received) noexcept {
    if (canopen::is_sync(received.frame)) on_sync(received.time);
    node_.on_frame(received, config_.emcy_information);
    if (node_.operational()) on_feedback_pdo(received);
  }
  // SYNC was sent at `time`. A node does not receive its own frames, so whoever sends SYNC says when.
  void on_sync(hal::Time time) noexcept { sync_time_ = time; }

  // Moves on by one period, after the frames.
  void update(hal::Time now) noexcept {
    if (own_status_ == SetupStatus::config_invalid) return;
    const bool was_ready = node_.ready(), was_forced = node_.forcing_stop();
    const std::uint32_t reboots = node_.reboots();
    node_.update(now);
    if (was_ready && !node_.ready()) forget_commands();
    if (node_.reboots() != reboots) on_reboot();
    if (const auto statusword = node_.take_statusword()) on_statusword(*statusword);
    if (was_forced && !node_.forcing_stop()) force_.forget();
    force_.update();
    if (!may_have_force() && std::abs(torque_) <= ForcedStop::most_idle_torque) node_.on_quiet_pdo(now);
    watch_samples(now);
    if (node_.ready() && node_.heartbeat_lost() && !may_have_force()) set_up_anew(now);
    if (reset_asked_) begin_reset(now);
    if (!was_ready && node_.ready()) adopt_rating();
    if (homing_.active()) lead_home(now);
    if (node_.ready() && pdo_seen_) follow(now);
    watch_stop(now);  // by what is wished now
  }

  // Returns true and fills `frame` when an NMT command or an SDO frame is to be sent now, at most one a call. The frame
  // must then be sent.
  bool next_acyclic_frame(hal::CanFrame& frame, hal::Time now) noexcept {
    return own_status_ != SetupStatus::config_invalid && node_.next_frame(frame, now);
  }

  // Returns true and fills `frame` with the RPDO of this period; false while the node is not NMT operational, unless it
  // only says that it no longer is, which may be wrong. Uses the force up: without a new command() the next one carries
  // zero torque.
  bool next_command_frame(hal::CanFrame& frame) noexcept {
    const Scalar force_N = std::exchange(force_N_, Scalar{0});
    if (!usable() || !(node_.operational() || node_.restarts())) return false;
    // A drive whose state no PDO shows is not led anywhere.
    const bool led = node_.ready() && pdo_seen_;
    const bool homing = homing_.active();
    const std::int16_t torque =
        led && machine_.follows() && !homing ? torque_scale_.per_mille(sign_ * force_N) : std::int16_t{0};
    const bool seeks = homing_.stage() == Homing::Stage::seeking && machine_.follows();
    const unsigned word = machine_.controlword() | (seeks ? control::start_homing : 0U);
    const std::array<std::uint64_t, 2> values{led ? word : control::disable_voltage,
                                              static_cast<std::uint16_t>(torque)};
    frame = canopen::pack_pdo(command_pdo_, values);
    return true;
  }

  // MotorDrive; see hal/motor_drive.hpp for what the calls promise.

  hal::DriveFeedback<Scalar> feedback() noexcept {
    // Unsigned subtraction wraps as the drive's counter does, so an axis may travel across the end of the range.
    const auto offset = static_cast<std::int32_t>(static_cast<std::uint32_t>(counts_) - datum_counts_);
    return {.state = state(),
            .position_offset_m = to_metres(offset),
            .position_m = to_metres(counts_),
            .travel_m = to_metres(static_cast<std::int32_t>(std::exchange(travel_counts_, 0U))),
            .force_N = sign_ * torque_scale_.force_N(torque_),
            .sample_time = sample_time_,
            .fresh = std::exchange(fresh_, false),
            .ever_valid = ever_valid_,
            .stop_not_obeyed = node_.forcing_stop(),
            .homing_failed = homing_.failed(),
            .faulty = machine_.state() == State::fault || machine_.state() == State::fault_reaction_active,
            .fault_code = fault_code(),
            .force_step_N = torque_scale_.quantum_N()};
  }
  void command(Scalar force_N) noexcept { force_N_ = force_N; }
  void set_datum_counts(std::int32_t counts) noexcept { datum_counts_ = static_cast<std::uint32_t>(counts); }
  // The newest sample was taken at this count.
  void set_reference_counts(std::int32_t counts) noexcept {
    origin_counts_ += static_cast<std::uint32_t>(counts) - static_cast<std::uint32_t>(counts_);
    counts_ = counts;
    reference_lost_ = home_wanted_ = false;
  }
  [[gnu::cold]] void request_enable() noexcept {
    if (node_.forcing_stop() || homing_.active()) return;
    if (!home_wanted_) return machine_.request_enable();
    if (!node_.ready() || !pdo_seen_) return;
    if (config_.homing.home == Home::by_drive) return homing_.begin();
    set_reference_counts(config_.homing.position_counts);
    machine_.request_enable();
  }
  void request_stop() noexcept {
    homing_.stop();
    machine_.request_stop();
  }
  // The drive is set up anew before its fault is reset, because what brought the fault may be its set-up, which another
  // tool changed.
  void reset_fault() noexcept {
    reset_asked_ = true;
    homing_.forget_failure();
    if (homes() && std::exchange(reference_lost_, false)) home_wanted_ = true;
  }
  // The axis' limit until the drive's own is known; then the lower of the two, in whole quanta.
  Scalar max_force_N() const noexcept {
    return torque_scale_.limit_per_mille() > 0 ? torque_scale_.max_force_N() : scale_.max_force_N;
  }
  SetupStatus setup_status() const noexcept { return own_status_ == SetupStatus::ready ? node_.status() : own_status_; }

  std::uint8_t node_id() const noexcept { return config_.node_id; }
  Scalar encoder_resolution_m() const noexcept { return scale_.encoder_resolution_m; }

  // The rest is for the supervisor and for display.

  // The field that makes setup_status() config_invalid; `none` otherwise.
  DriveConfigError config_error() const noexcept { return config_error_; }
  // The object at which the set-up stands, was not answered, or was refused; index 0 when none is concerned.
  canopen::ObjectAddress setup_object() const noexcept { return node_.setup_object(); }
  // Why the drive refuses that object, when setup_status() is object_refused; SdoAbort::none otherwise.
  canopen::SdoAbort setup_abort_code() const noexcept { return node_.setup_abort_code(); }
  // What its set-up takes beside what another drive's does, because it is slow to answer.
  hal::Duration extra_setup_time() const noexcept { return node_.extra_time(); }
  std::optional<canopen::NmtState> nmt_state() const noexcept { return node_.nmt_state(); }
  bool heartbeat_lost() const noexcept { return node_.heartbeat_lost(); }
  // The newest EMCY message, also one that is information only, and the newest that is an error, or says that it is
  // gone.
  const canopen::Emcy& last_emcy() const noexcept { return node_.emcy().last(); }
  const canopen::Emcy& last_error() const noexcept { return node_.emcy().error(); }
  std::uint16_t last_error_code() const noexcept { return last_error().code; }
  // The first error code of an EMCY message since the last call; 0: none came that is an error.
  std::uint16_t take_emergency() noexcept { return node_.take_emergency(); }
  // Every SYNC is answered twice.
  bool node_id_conflict() const noexcept { return doubled_ >= conflict_periods; }
  // Methods below 0 are the vendor's; among them are those that press against a stop until nothing moves.
  bool homes_against_a_stop() const noexcept { return config_.homing.method < 0; }
  // The drive booted anew, its encoder is incremental, and nobody has said yet where the axis stands.
  bool reference_lost() const noexcept { return reference_lost_; }
  std::uint32_t reboots() const noexcept { return node_.reboots(); }
  std::uint16_t statusword() const noexcept { return statusword_; }
  std::optional<State> cia402_state() const noexcept { return machine_.state(); }
  // The position of the newest sample.
  std::int32_t position_counts() const noexcept { return counts_; }
  const DriveRating& rating() const noexcept { return node_.rating(); }
  // Force of one per mille of the rated torque; 0 until the drive is set up.
  Scalar torque_quantum_N() const noexcept { return torque_scale_.quantum_N(); }
  // The count nearest to a position, to set the datum by. It saturates.
  std::int32_t counts_at(Scalar position_m) const noexcept {
    constexpr auto lowest = std::numeric_limits<std::int32_t>::min();
    const Scalar counts = std::round(position_m / scale_.encoder_resolution_m);
    if (!(counts > static_cast<Scalar>(lowest))) return lowest;
    if (counts >= -static_cast<Scalar>(lowest)) return std::numeric_limits<std::int32_t>::max();
    return static_cast<std::int32_t>(counts);
  }

 private:
  void on_feedback_pdo(const hal::ReceivedFrame& received) noexcept {
    std::array<std::uint64_t, 3> values{};
    if (!canopen::unpack_pdo(feedback_pdo_, received.frame, values)) return;
    on_statusword(static_cast<std::uint16_t>(values[0]));
    const auto shown = static_cast<std::uint32_t>(values[1]);
    const std::uint32_t counts = (config_.invert_direction ? 0U - shown : shown) + origin_counts_;
    ++samples_;
    if (counted_) travel_counts_ += counts - static_cast<std::uint32_t>(counts_);
    counts_ = static_cast<std::int32_t>(counts);
    torque_ = static_cast<std::int16_t>(static_cast<std::uint16_t>(values[2]));
    pdo_seen_ = node_.ready();
    force_.on_torque(statusword_, torque_, received.time);
    // A port without stamps says when it was read, which a loop that wakes late does after the next SYNC was due.
    const hal::Duration answer_time = period_ + period_ / 2;
    const bool answers_sync = sync_time_ && *sync_time_ <= received.time && received.time - *sync_time_ <= answer_time;
    sample_time_ = answers_sync ? *sync_time_ : received.time;
    fresh_ = ever_valid_ = counted_ = true;
  }

  [[gnu::cold]] void on_reboot() noexcept {
    ever_valid_ = counted_ = false;
    force_.forget();
    unwished_for_.reset();
    doubt_ = {};
    reference_lost_ = !config_.absolute_encoder;
  }

  // A drive without force that does not answer SYNC may have been switched on by somebody else unseen. Late samples
  // come in pairs, too, but then none came in the period before.
  void watch_samples(hal::Time now) noexcept {
    const unsigned samples = std::exchange(samples_, 0U);
    doubled_ = samples > 1 ? std::min(doubled_ + 1, conflict_periods) : 0;
    const bool answers = samples > 0 || !node_.operational() || node_.forcing_stop();
    if (answers || may_have_force() || !answered_at_) answered_at_ = now;
    if (now - *answered_at_ > obeys_within()) set_up_anew(now);
  }

  hal::Duration obeys_within() const noexcept { return std::max(stop_time, stop_periods * period_); }

  // Takes a statusword that a PDO or an SDO brought.
  void on_statusword(std::uint16_t statusword) noexcept {
    statusword_ = statusword;
    machine_.on_statusword(statusword);
    force_.on_statusword(statusword);
  }

  // The file says how the axis gets its zero.
  bool homes() const noexcept { return config_.homing.home != Home::none && !config_.absolute_encoder; }

  [[gnu::cold]] void lead_home(hal::Time now) noexcept {
    const bool led = node_.ready() && pdo_seen_;
    if (!node_.in_mode(Mode::homing) && !node_.in_mode(Mode::cyclic_torque)) return homing_.lose();
    switch (homing_.stage()) {
      case Homing::Stage::idle:
        return;
      case Homing::Stage::selecting:
        if (led && node_.in_mode(Mode::cyclic_torque)) return select_mode(Mode::homing, now);
        if (!led) return;
        machine_.request_enable();
        return homing_.on_selected(now);
      case Homing::Stage::seeking:
        if (!node_.in_mode(Mode::homing)) return homing_.lose();
        if (homing_.seek(statusword_, machine_.enable_wished(), machine_.follows(), now)) machine_.request_stop();
        return;
      case Homing::Stage::stopping:
        if (!led || !machine_.without_force()) return;
        if (homing_.on_stopped()) count_from_home();
        return select_mode(Mode::cyclic_torque, now);
      case Homing::Stage::returning:
        if (node_.ready()) homing_.on_returned();
        return;
    }
  }

  // The drive's own position is the axis' now; it jumped there.
  void count_from_home() noexcept {
    origin_counts_ = 0;
    counted_ = home_wanted_ = reference_lost_ = false;
  }

  void select_mode(Mode mode, hal::Time now) noexcept {
    forget_commands();
    node_.select_mode(mode, now);
  }

  void follow(hal::Time now) noexcept {
    if (std::exchange(reset_pending_, false)) machine_.reset_fault();
    machine_.update(now);
    follow_fault();
  }

  [[gnu::cold]] void adopt_rating() noexcept {
    const DriveRating& rating = node_.rating();
    torque_scale_ = TorqueScale<Scalar>{rating.rated_torque_mNm, rating.max_torque_per_mille,
                                        config_.force_per_torque_N_per_Nm, scale_.max_force_N, config_.torque_base};
    own_status_ = torque_scale_.limit_per_mille() == 0 ? SetupStatus::force_step_too_coarse : SetupStatus::ready;
  }

  // A drive that fell silent may have rebooted unheard, and then knows nothing of its set-up.
  [[gnu::cold]] void set_up_anew(hal::Time now) noexcept {
    forget_commands();
    node_.set_up_anew(now);
  }

  void forget_commands() noexcept {
    machine_.restart();
    pdo_seen_ = was_faulty_ = false;
  }

  // A drive that is enabled, or on its way, has no fault to reset, and one that shows that it has none keeps what comes
  // later, in its set-up or after it. One that is being set up already, or is not heard, is reset after it, unless its
  // heartbeat was lost on the way: that set-up would bring its fault back at once.
  [[gnu::cold]] void begin_reset(hal::Time now) noexcept {
    reset_asked_ = false;
    if (may_have_force() || machine_.enable_wished()) return;
    const bool shows_none = machine_.state() && machine_.state() != State::fault;
    reset_pending_ = !shows_none;
    own_status_ = SetupStatus::ready;  // what the drive is rated for is read again
    const bool set_up = node_.ready() || node_.held() || node_.phase() == SetupPhase::refused;
    if (set_up || node_.heartbeat_lost_in_setup()) set_up_anew(now);
    node_.forget_heartbeat_loss();
  }

  void follow_fault() noexcept {
    const bool faulty = machine_.state() == State::fault;
    if (faulty && !was_faulty_ && !node_.emcy().active()) node_.request_error_code();
    if (!faulty && was_faulty_) node_.forget_errors();
    was_faulty_ = faulty;
  }

  // A drive that is energised against our wish for longer than a stop takes is forced to it. It is given the time of a
  // quick stop while it says that it is stopping by itself. One that falls silent is seen as it was last, and nobody
  // wishes force of one that is not set up. A statusword without force between others, by whatever sends it, proves
  // nothing: only a drive that shows no force for as long as it has for a stop has obeyed. One that is held has been
  // told already. A period that came late is a fault of the loop's: what the drive did in it was not heard, and it had
  // no SYNC to act at.
  void watch_stop(hal::Time now) noexcept {
    const hal::Duration passed = std::min<hal::Duration>(now - watched_at_, 2 * period_);
    watched_at_ = now;
    const bool shown = may_have_force() || node_.forcing_stop();
    doubt_ = shown ? obeys_within() : std::max<hal::Duration>(doubt_ - passed, {});
    // A quick stop is nobody's wish, also where it came before Operation enabled was seen.
    const bool wished = node_.ready() && machine_.enable_wished() && machine_.state() != State::quick_stop_active;
    if (wished || node_.forcing_stop() || doubt_ == hal::Duration{}) return unwished_for_.reset();
    unwished_for_ = unwished_for_ ? *unwished_for_ + passed : hal::Duration{};
    if (!may_have_force()) return;
    // It is told twice, to stop and then to be without voltage.
    const hal::Duration quick_stop =
        force_.stops_by_itself() ? StateMachine::quick_stop_time + obeys_within() : hal::Duration{};
    if (!node_.held() && *unwished_for_ <= obeys_within() + quick_stop) return;
    unwished_for_.reset();
    forget_commands();
    node_.force_stop(now);
  }

  bool may_have_force() const noexcept { return force_.may_have_force(); }

  static constexpr unsigned conflict_periods = 5;  // in a row

  bool usable() const noexcept { return own_status_ == SetupStatus::ready && node_.phase() != SetupPhase::refused; }

  hal::DriveState state() const noexcept {
    if (node_.forcing_stop()) return hal::DriveState::stopping;
    if (usable() && homing_.active() && machine_.state() != State::fault) return hal::DriveState::homing;
    if (unwished_for_ || node_.quietens()) return hal::DriveState::stopping;
    if (!usable()) return hal::DriveState::unusable;
    if (!node_.ready() || !machine_.state()) return hal::DriveState::configuring;
    const bool wished = machine_.enable_wished();
    switch (*machine_.state()) {
      case State::operation_enabled:
        return wished ? hal::DriveState::enabled : hal::DriveState::stopping;
      case State::quick_stop_active:
      case State::fault_reaction_active:
        return hal::DriveState::stopping;
      case State::fault:
        return hal::DriveState::fault;
      case State::not_ready_to_switch_on:
      case State::switch_on_disabled:
      case State::ready_to_switch_on:
      case State::switched_on:
        break;
    }
    return wished ? hal::DriveState::enabling : hal::DriveState::disabled;
  }

  std::uint16_t fault_code() const noexcept {
    if (machine_.state() != State::fault) return 0;
    return node_.emcy().active() ? last_error_code() : node_.error_code();
  }

  Scalar to_metres(std::int32_t counts) const noexcept {
    return static_cast<Scalar>(counts) * scale_.encoder_resolution_m;
  }

  Config config_;
  hal::Duration period_;
  hal::AxisScale<Scalar> scale_;
  DriveConfigError config_error_;
  SetupStatus own_status_;  // `ready`: nothing is wrong here, and the rest is for node_ to say
  Scalar sign_;
  canopen::PdoMapping command_pdo_;
  canopen::PdoMapping feedback_pdo_;
  DriveNode node_;
  StateMachine machine_;
  TorqueScale<Scalar> torque_scale_;
  Homing homing_;
  ForceWatch force_;

  Scalar force_N_{0};
  std::uint32_t datum_counts_ = 0;
  std::uint32_t origin_counts_ = 0;  // where the drive shows 0
  std::uint16_t statusword_ = 0;
  std::int32_t counts_ = 0;
  std::int16_t torque_ = 0;
  std::uint32_t travel_counts_ = 0;  // since the last feedback(), modulo 2^32
  bool fresh_ = false;
  bool ever_valid_ = false;
  bool counted_ = false;   // counts_ is of this power-up
  bool pdo_seen_ = false;  // since the node is ready
  bool was_faulty_ = false;
  bool reset_asked_ = false;
  bool reference_lost_ = false;
  bool home_wanted_;      // before the next force
  unsigned samples_ = 0;  // since the last update()
  unsigned doubled_ = 0;  // periods in a row with more than one
  std::optional<hal::Time> answered_at_;
  bool reset_pending_ = false;  // the fault is reset once the drive is set up
  std::optional<hal::Time> sync_time_;
  std::optional<hal::Duration> unwished_for_;  // so long the drive has shown force that nobody here wishes
  hal::Duration doubt_{};                      // so long what was shown says that it may still have force
  hal::Time watched_at_{};
  hal::Time sample_time_{};
};

static_assert(hal::MotorDrive<Drive<float>, float>);
static_assert(hal::MotorDrive<Drive<double>, double>);

}  // namespace breakaway::cia402
