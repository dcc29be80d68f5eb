// Drive: an ODrive (firmware 0.6, CANSimple) in torque mode, as the control loop sees it. Force goes in, position comes
// out; it models hal::MotorDrive and firmware::BusDrive.
//
// It puts three parts together: DriveNode sets the drive up, leads and watches it; TurnsScale turns turns into counts;
// TorqueGrid turns newtons into torque. Drive units exist only inside. Counts are in the axis' direction, and so is
// force: with invert_direction they are the drive's with the sign changed.
//
//   Drive<float> drive{{.node_id = 1, .force_per_torque_N_per_Nm = 50, .max_torque_Nm = 1, .counts_per_turn = 125664},
//                      {.period = 1ms}, {1e-6F, 50}};
//
//   once a period:
//     for every received frame: drive.on_frame(received);
//     drive.update(now);
//     drive.feedback(); drive.command(force_N);
//     send what drive.next_command_frame() hands out, and what drive.next_poll_frame() does until it says false;
//     send what drive.next_acyclic_frame() hands out, as far as the bus has room.
//
// There is no SYNC. A command acts when it arrives and until the next; one goes out every period, so that without a new
// command() the next carries zero torque, and so that the drive's watchdog is fed. A sample is the newest estimate: the
// drive takes it by a clock of its own (cyclic), or when it is asked, right behind the command (polled). The torque
// that goes with it is reported as 0 when its report is older than three periods.
//
// A position or torque that is no number, and a position that is coarser than a count, is a fault: the sample is not
// used, and the drive is stopped. So is a drive that follows and tells its position and for ten periods no torque:
// nothing would show an axis that does not move under its force, or a force that nobody commanded. A drive that leaves
// closed loop control by itself stays off until request_enable().
//
// It owns no port, holds no pointers and may be copied. It never blocks or allocates, and is for one thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/hal/network_config.hpp"
#include "breakaway/odrive/drive_config.hpp"
#include "breakaway/odrive/drive_node.hpp"
#include "breakaway/odrive/fault_code.hpp"
#include "breakaway/odrive/master.hpp"
#include "breakaway/odrive/messages.hpp"
#include "breakaway/odrive/setup_status.hpp"
#include "breakaway/odrive/torque_grid.hpp"
#include "breakaway/odrive/turns_scale.hpp"

namespace breakaway::odrive {

template <class Scalar>
class Drive {
 public:
  using Config = DriveConfig<Scalar>;
  using Master = odrive::Master;

  // A drive with what check() does not accept is unusable for good and sends nothing.
  [[gnu::cold]] Drive(const Config& config, const hal::NetworkConfig& network,
                      const hal::AxisScale<Scalar>& scale) noexcept
      : config_{config},
        period_{network.period},
        scale_{scale},
        config_error_{check(config, network, scale)},
        turns_scale_{config.counts_per_turn},
        torque_grid_{config.max_torque_Nm, config.force_per_torque_N_per_Nm, scale.max_force_N},
        own_status_{own_status()},
        sign_{config.invert_direction ? -1 : 1},
        node_{settings(config, network)},
        home_wanted_{config.home_here && !config.absolute_encoder} {}

  // Takes any frame that the bus brought; those of other nodes are passed over.
  void on_frame(const hal::ReceivedFrame& received) noexcept {
    if (own_status_ != SetupStatus::ready || node_id_of(received.frame.id) != config_.node_id) return;
    if (const auto estimates = as_estimates(received.frame)) return on_estimate(estimates->first, received.time);
    if (const auto torques = as_torques(received.frame)) return on_torque(torques->second, received.time);
    node_.on_frame(received);
  }
  // There is none.
  void on_sync(hal::Time /*time*/) noexcept {}

  // Moves on by one period, after the frames.
  void update(hal::Time now) noexcept {
    if (own_status_ != SetupStatus::ready) return;
    doubled_ = std::exchange(samples_, 0U) > samples_per_period() ? std::min(doubled_ + 1, conflict_periods) : 0;
    node_.update(now);
    if (node_.take_reboot()) on_reboot();
    if (torque_ && now - torque_time_ > 3 * period_) torque_.reset();
    if (node_.follows() && fresh_ && now - torque_time_ > mute_periods * period_)
      node_.fail(OwnFault::torque_not_reported);
    polls_ = config_.estimates == Estimates::polled && node_.heard() ? 0 : polls;
  }

  // Returns true and fills `frame` when something is to be told or asked, at most one a call. It must then be sent.
  bool next_acyclic_frame(hal::CanFrame& frame, hal::Time now) noexcept {
    return own_status_ == SetupStatus::ready && node_.next_frame(frame, now);
  }

  // Returns true and fills `frame` with the torque of this period; false until the drive was heard. Uses the force up.
  bool next_command_frame(hal::CanFrame& frame) noexcept {
    const Scalar force_N = std::exchange(force_N_, Scalar{0});
    if (own_status_ != SetupStatus::ready || !node_.hears() || node_.refused()) return false;
    frame = torque_frame(config_.node_id, node_.follows() ? torque_grid_.torque_Nm(in_direction(force_N)) : 0.0F);
    return true;
  }

  // Returns true and fills `frame` with the next question of this period; false when there is none.
  bool next_poll_frame(hal::CanFrame& frame) noexcept {
    if (own_status_ != SetupStatus::ready || polls_ >= polls) return false;
    frame = request_frame(config_.node_id, polls_++ == 0 ? Command::get_encoder_estimates : Command::get_torques);
    return true;
  }

  // MotorDrive; see hal/motor_drive.hpp for what the calls promise.

  hal::DriveFeedback<Scalar> feedback() noexcept {
    const auto offset = static_cast<std::int32_t>(static_cast<std::uint32_t>(counts_) - datum_counts_);
    return {.state = state(),
            .position_offset_m = to_metres(offset),
            .position_m = to_metres(counts_),
            .travel_m = to_metres(static_cast<std::int32_t>(std::exchange(travel_counts_, 0U))),
            .force_N = torque_ ? in_direction(torque_grid_.force_N(static_cast<Scalar>(*torque_))) : Scalar{0},
            .sample_time = sample_time_,
            .fresh = std::exchange(fresh_, false),
            .ever_valid = ever_valid_,
            .stop_not_obeyed = node_.stop_not_obeyed(),
            .homing_failed = false,
            .fault_code = node_.code(),
            .force_step_N = torque_grid_.step_N()};
  }
  void command(Scalar force_N) noexcept { force_N_ = force_N; }
  void set_datum_counts(std::int32_t counts) noexcept { datum_counts_ = static_cast<std::uint32_t>(counts); }
  // The newest sample was taken at this count.
  void set_reference_counts(std::int32_t counts) noexcept {
    origin_counts_ += static_cast<std::uint32_t>(counts) - static_cast<std::uint32_t>(counts_);
    counts_ = counts;
    reference_lost_ = home_wanted_ = false;
    node_.note_reference();
  }
  void request_enable() noexcept {
    if (!node_.ready() || node_.has_force() || !ever_valid_) return;
    if (home_wanted_) set_reference_counts(config_.home_counts);
    node_.request_enable();
  }
  void request_stop() noexcept { node_.request_stop(); }
  void reset_fault() noexcept {
    node_.reset_fault();
    if (config_.home_here && std::exchange(reference_lost_, false)) home_wanted_ = true;
  }
  Scalar max_force_N() const noexcept { return torque_grid_.max_force_N(); }
  SetupStatus setup_status() const noexcept { return own_status_ == SetupStatus::ready ? node_.status() : own_status_; }

  std::uint8_t node_id() const noexcept { return config_.node_id; }
  Scalar encoder_resolution_m() const noexcept { return scale_.encoder_resolution_m; }

  // The rest is for the supervisor and for display.

  DriveConfigError config_error() const noexcept { return config_error_; }
  bool heartbeat_lost() const noexcept { return node_.heartbeat_lost(); }
  // What it is in fault for (fault_code.hpp), and the first such that appeared since the last call; 0: none.
  std::uint16_t last_error_code() const noexcept { return node_.code(); }
  std::uint16_t take_emergency() noexcept { return node_.take_new_code(); }
  static constexpr std::string_view fault_text(std::uint16_t code) noexcept { return odrive::fault_text(code); }
  bool node_id_conflict() const noexcept { return doubled_ >= conflict_periods; }
  // The drive may have booted anew, its encoder is incremental, and nobody has said yet where the axis stands.
  bool reference_lost() const noexcept { return reference_lost_; }
  std::int32_t position_counts() const noexcept { return counts_; }
  AxisState axis_state() const noexcept { return node_.axis_state(); }

 private:
  static constexpr unsigned conflict_periods = 5;  // in a row
  static constexpr unsigned polls = 2;             // a period
  // So many reports of torque in a row do not get lost.
  static constexpr int mute_periods = 10;

  static NodeSettings settings(const Config& c, const hal::NetworkConfig& network) noexcept {
    return {.node_id = c.node_id,
            .polled = c.estimates == Estimates::polled,
            .velocity_limit_turns_s = c.velocity_limit_turns_s,
            .current_limit_A = c.current_limit_A,
            .period = network.period,
            .heartbeat_period = c.heartbeat_period,
            .heartbeat_timeout = c.heartbeat_timeout};
  }

  SetupStatus own_status() const noexcept {
    if (config_error_ != DriveConfigError::none) return SetupStatus::config_invalid;
    return torque_grid_.max_force_N() > 0 ? SetupStatus::ready : SetupStatus::force_step_too_coarse;
  }

  // One drive cannot send more than this in period after period.
  unsigned samples_per_period() const noexcept {
    if (config_.estimates == Estimates::polled) return 1;
    return static_cast<unsigned>((period_ + config_.estimate_period - hal::Duration{1}) / config_.estimate_period);
  }

  void on_estimate(float turns, hal::Time time) noexcept {
    ++samples_;
    node_.on_estimate(time);
    const auto shown = turns_scale_.counts(turns);
    if (!shown) {
      return node_.fail(std::isfinite(turns) ? OwnFault::position_too_coarse : OwnFault::position_not_a_number);
    }
    const auto read = static_cast<std::uint32_t>(*shown);
    const std::uint32_t counts = (sign_ < 0 ? 0U - read : read) + origin_counts_;
    if (counted_) travel_counts_ += counts - static_cast<std::uint32_t>(counts_);
    counts_ = static_cast<std::int32_t>(counts);
    sample_time_ = time;
    fresh_ = ever_valid_ = counted_ = true;
  }

  // A twentieth of the motor's torque may be noise of a current measurement. What is no number as a force is none.
  void on_torque(float torque_Nm, hal::Time time) noexcept {
    const bool finite = std::isfinite(torque_grid_.force_N(static_cast<Scalar>(torque_Nm)));
    node_.on_torque(!finite || std::abs(static_cast<Scalar>(torque_Nm)) > config_.max_torque_Nm / 20, time);
    if (!finite) return node_.fail(OwnFault::torque_not_a_number);
    torque_ = torque_Nm;
    torque_time_ = time;
  }

  void on_reboot() noexcept {
    ever_valid_ = counted_ = fresh_ = false;
    torque_.reset();
    reference_lost_ = !config_.absolute_encoder;
  }

  hal::DriveState state() const noexcept {
    using hal::DriveState;
    if (own_status_ != SetupStatus::ready || node_.refused()) return DriveState::unusable;
    if (node_.stop_not_obeyed()) return DriveState::stopping;
    if (node_.has_force() && !node_.wished()) return DriveState::stopping;
    if (!node_.ready()) return DriveState::configuring;
    if (node_.wished()) return node_.follows() ? DriveState::enabled : DriveState::enabling;
    return node_.code() != 0 ? DriveState::fault : DriveState::disabled;
  }

  Scalar in_direction(Scalar value) const noexcept { return sign_ < 0 ? -value : value; }
  Scalar to_metres(std::int32_t counts) const noexcept {
    return static_cast<Scalar>(counts) * scale_.encoder_resolution_m;
  }

  Config config_;
  hal::Duration period_;
  hal::AxisScale<Scalar> scale_;
  DriveConfigError config_error_;
  TurnsScale turns_scale_;
  TorqueGrid<Scalar> torque_grid_;
  SetupStatus own_status_;  // `ready`: nothing is wrong here, and the rest is for node_ to say
  int sign_;
  DriveNode node_;

  Scalar force_N_{0};
  std::optional<float> torque_;  // as reported, while it is young
  hal::Time torque_time_{}, sample_time_{};
  std::uint32_t datum_counts_ = 0;
  std::uint32_t origin_counts_ = 0;  // where the drive shows 0
  std::int32_t counts_ = 0;
  std::uint32_t travel_counts_ = 0;  // since the last feedback(), modulo 2^32
  unsigned samples_ = 0;             // since the last update()
  unsigned doubled_ = 0;             // periods in a row with too many
  unsigned polls_ = polls;           // that were handed out in this period
  bool fresh_ = false;
  bool ever_valid_ = false;
  bool counted_ = false;  // counts_ is of this power-up
  bool reference_lost_ = false;
  bool home_wanted_;  // before the next force
};

static_assert(hal::MotorDrive<Drive<float>, float>);
static_assert(hal::MotorDrive<Drive<double>, double>);

}  // namespace breakaway::odrive
