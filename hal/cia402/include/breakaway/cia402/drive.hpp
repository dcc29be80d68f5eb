// A CiA 402 drive in cyclic synchronous torque mode, as the control loop sees it: force in, position out.
//
//   each period: on_frame for every received frame; update(now); feedback(); command(force);
//                on_sync(time of the SYNC); send what next_command_frame and next_acyclic_frame hand out.
//
// Drive units exist only inside. Encoder counts, too, are in the axis' direction: with invert_direction they are the
// drive's with the sign changed. A drive that leaves Operation enabled by itself, or reboots, stays off until
// request_enable.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/pdo.hpp"
#include "breakaway/canopen/sync.hpp"
#include "breakaway/cia402/drive_node.hpp"
#include "breakaway/cia402/pdo_layout.hpp"
#include "breakaway/cia402/state_machine.hpp"
#include "breakaway/cia402/torque_scale.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/motor_drive.hpp"

namespace breakaway::cia402 {

template <class Scalar>
struct DriveConfig {
  std::uint8_t node_id = 1;            // 1..127
  Scalar encoder_resolution_m{};       // metres of travel a count, above 0
  Scalar force_per_torque_N_per_Nm{};  // force at the axis for one Nm at the motor, above 0 (1 / lever)
  Scalar max_force_N{};                // the axis' own limit, above 0; the drive's (6072h) counts besides
  hal::Duration heartbeat_period = std::chrono::milliseconds{100};
  hal::Duration heartbeat_timeout = std::chrono::milliseconds{250};
  hal::Duration sdo_timeout = std::chrono::milliseconds{50};
  hal::Duration period = std::chrono::milliseconds{1};  // of control and SYNC
  bool invert_direction = false;                        // the drive's positive direction is the axis' negative one
  std::uint8_t master_node_id = 127;                    // who sends the heartbeats that the drive supervises

  NodeConfig node() const noexcept {
    return {node_id, master_node_id, heartbeat_period, heartbeat_timeout, sdo_timeout, period};
  }
};

// As check(NodeConfig), and 7: encoder_resolution_m, 8: force_per_torque_N_per_Nm, 9: max_force_N.
template <class Scalar>
hal::Status check(const DriveConfig<Scalar>& config) noexcept {
  constexpr auto positive = [](Scalar value) { return value > 0 && std::isfinite(value); };
  if (const hal::Status status = check(config.node()); !status.ok()) return status;
  if (!positive(config.encoder_resolution_m)) return {hal::StatusCode::invalid_argument, 7};
  if (!positive(config.force_per_torque_N_per_Nm)) return {hal::StatusCode::invalid_argument, 8};
  if (!positive(config.max_force_N)) return {hal::StatusCode::invalid_argument, 9};
  return {};
}

template <class Scalar>
class Drive {
 public:
  explicit Drive(const DriveConfig<Scalar>& config) noexcept
      : config_{config},
        config_status_{check(config)},
        sign_{config.invert_direction ? Scalar{-1} : Scalar{1}},
        command_pdo_{command_pdo(config.node_id)},
        feedback_pdo_{feedback_pdo(config.node_id)},
        node_{config.node()} {}

  // Every frame that the bus brings; those of other nodes are passed over.
  void on_frame(const hal::ReceivedFrame& received) noexcept {
    if (canopen::is_sync(received.frame)) on_sync(received.time);
    node_.on_frame(received);
    if (node_.operational()) on_feedback_pdo(received);
  }
  // A node does not receive its own frames: whoever sends SYNC says when.
  void on_sync(hal::Time time) noexcept { sync_time_ = time; }

  // Once a period, after the frames.
  void update(hal::Time now) noexcept {
    if (!config_status_.ok()) return;
    const bool was_ready = node_.ready();
    const std::uint32_t reboots = node_.reboots();
    node_.update(now);
    if (node_.reboots() != reboots) ever_valid_ = false;
    if (was_ready && !node_.ready()) machine_.restart();
    if (!was_ready && node_.ready()) adopt_rating();
    if (!node_.ready()) return;
    machine_.update(now);
    follow_fault();
  }

  // At most one NMT or SDO frame that is to be sent now; false when there is none.
  bool next_acyclic_frame(hal::CanFrame& frame, hal::Time now) noexcept {
    return config_status_.ok() && node_.next_frame(frame, now);
  }

  // The RPDO of this period; false while the node is not NMT operational. Uses the force up: without a new command()
  // the next one carries zero torque.
  bool next_command_frame(hal::CanFrame& frame) noexcept {
    const Scalar force_N = std::exchange(force_N_, Scalar{0});
    if (!usable() || !node_.operational()) return false;
    const bool follows = node_.ready() && machine_.follows();
    const std::int16_t torque = follows ? scale_.per_mille(sign_ * force_N) : std::int16_t{0};
    const std::array<std::uint64_t, 2> values{machine_.controlword(), static_cast<std::uint16_t>(torque)};
    frame = canopen::pack_pdo(command_pdo_, values);
    return true;
  }

  // MotorDrive

  hal::DriveFeedback<Scalar> feedback() noexcept {
    // Unsigned subtraction wraps as the drive's counter does, so an axis may travel across the end of the range.
    const auto offset = static_cast<std::int32_t>(static_cast<std::uint32_t>(counts_) - datum_counts_);
    return {.state = state(),
            .position_offset_m = to_metres(offset),
            .position_m = to_metres(counts_),
            .force_N = sign_ * scale_.force_N(torque_),
            .sample_time = sample_time_,
            .fresh = std::exchange(fresh_, false),
            .ever_valid = ever_valid_,
            .fault_code = fault_code()};
  }
  void command(Scalar force_N) noexcept { force_N_ = force_N; }
  void set_datum_counts(std::int32_t counts) noexcept { datum_counts_ = static_cast<std::uint32_t>(counts); }
  void request_enable() noexcept { machine_.request_enable(); }
  void request_stop() noexcept { machine_.request_stop(); }
  void reset_fault() noexcept { machine_.reset_fault(); }
  // The configured limit until the drive's own is known, then the lower of the two, in whole quanta.
  Scalar max_force_N() const noexcept {
    return scale_.limit_per_mille() > 0 ? scale_.max_force_N() : config_.max_force_N;
  }
  // As DriveNode::status; invalid_argument as check(DriveConfig), with detail 9 also when max_force_N is less than one
  // quantum of this drive.
  hal::Status setup_status() const noexcept { return config_status_.ok() ? node_.status() : config_status_; }

  std::uint8_t node_id() const noexcept { return config_.node_id; }

  // For the supervisor and for display

  std::uint32_t setup_object() const noexcept { return node_.setup_object(); }
  std::optional<canopen::NmtState> nmt_state() const noexcept { return node_.nmt_state(); }
  bool heartbeat_lost() const noexcept { return node_.heartbeat_lost(); }
  const canopen::Emcy& last_emcy() const noexcept { return node_.emcy().last(); }
  std::uint32_t emcy_count() const noexcept { return node_.emcy().count(); }
  std::uint32_t reboots() const noexcept { return node_.reboots(); }
  std::uint16_t statusword() const noexcept { return statusword_; }
  std::optional<State> cia402_state() const noexcept { return machine_.state(); }
  std::int32_t position_counts() const noexcept { return counts_; }
  const DriveRating& rating() const noexcept { return node_.rating(); }
  // Force of one per mille of the rated torque; 0 until the drive is set up.
  Scalar torque_quantum_N() const noexcept { return scale_.quantum_N(); }
  // The count nearest to a position, to set the datum by; saturates.
  std::int32_t counts_at(Scalar position_m) const noexcept {
    constexpr auto lowest = std::numeric_limits<std::int32_t>::min();
    const Scalar counts = std::round(position_m / config_.encoder_resolution_m);
    if (!(counts > static_cast<Scalar>(lowest))) return lowest;
    if (counts >= -static_cast<Scalar>(lowest)) return std::numeric_limits<std::int32_t>::max();
    return static_cast<std::int32_t>(counts);
  }

 private:
  void on_feedback_pdo(const hal::ReceivedFrame& received) noexcept {
    std::array<std::uint64_t, 3> values{};
    if (!canopen::unpack_pdo(feedback_pdo_, received.frame, values)) return;
    statusword_ = static_cast<std::uint16_t>(values[0]);
    const auto counts = static_cast<std::uint32_t>(values[1]);
    counts_ = static_cast<std::int32_t>(config_.invert_direction ? 0U - counts : counts);
    torque_ = static_cast<std::int16_t>(static_cast<std::uint16_t>(values[2]));
    machine_.on_statusword(statusword_);
    const bool answers_sync =
        sync_time_ && *sync_time_ <= received.time && received.time - *sync_time_ <= config_.period;
    sample_time_ = answers_sync ? *sync_time_ : received.time;
    fresh_ = ever_valid_ = true;
  }

  void adopt_rating() noexcept {
    const DriveRating& rating = node_.rating();
    scale_ = TorqueScale<Scalar>{rating.rated_torque_mNm, rating.max_torque_per_mille,
                                 config_.force_per_torque_N_per_Nm, config_.max_force_N};
    if (scale_.limit_per_mille() == 0) config_status_ = {hal::StatusCode::invalid_argument, 9};
  }

  void follow_fault() noexcept {
    const bool faulty = machine_.state() == State::fault;
    if (faulty && !was_faulty_ && !node_.emcy().active()) node_.request_error_code();
    if (!faulty && was_faulty_) node_.forget_errors();
    was_faulty_ = faulty;
  }

  bool usable() const noexcept { return config_status_.ok() && node_.phase() != SetupPhase::refused; }

  hal::DriveState state() const noexcept {
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
    if (state() != hal::DriveState::fault) return 0;
    return node_.emcy().active() ? node_.emcy().last().code : node_.error_code();
  }

  Scalar to_metres(std::int32_t counts) const noexcept {
    return static_cast<Scalar>(counts) * config_.encoder_resolution_m;
  }

  DriveConfig<Scalar> config_;
  hal::Status config_status_;
  Scalar sign_;
  canopen::PdoMapping command_pdo_;
  canopen::PdoMapping feedback_pdo_;
  DriveNode node_;
  StateMachine machine_;
  TorqueScale<Scalar> scale_;

  Scalar force_N_{0};
  std::uint32_t datum_counts_ = 0;
  std::uint16_t statusword_ = 0;
  std::int32_t counts_ = 0;
  std::int16_t torque_ = 0;
  bool fresh_ = false;
  bool ever_valid_ = false;
  bool was_faulty_ = false;
  std::optional<hal::Time> sync_time_;
  hal::Time sample_time_{};
};

static_assert(hal::MotorDrive<Drive<float>, float>);
static_assert(hal::MotorDrive<Drive<double>, double>);

}  // namespace breakaway::cia402
